"""A search for smaller networks -> its page and picture. Knows the file, never networks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import msgspec
import numpy as np

from reports.believe import believed
from reports.document import Bullets, Cell, Column, Document, Heading, Image, Paragraph, Table
from reports.errors import ReportError
from reports.numbers import metres, significant
from reports.pareto import pareto_front
from reports.plain import tame
from reports.ranking.paired import Interval, Paired, difference_m

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA_VERSION = 1
REFERENCE = "remnet"
KINDS = ("nlos", "los")
NOT_WORSE, CYCLES, FLASH = 0.02, 0.25, 0.5
"""The bar: worse by at most 2 % of REMnet's MAE, a quarter of its cycles, half its flash."""


@dataclass(frozen=True)
class Cycles:
    """Typical cycles of one call with the table's low and high ends."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Judged:
    """Sums of |residual| (m) and rows by link, and the MAE (m)."""

    mae_m: float
    links: tuple[int, ...]
    sums_m: tuple[float, ...]
    rows: tuple[int, ...]


@dataclass(frozen=True)
class Final:
    """A finalist's 8-bit C: counted, and judged on the test rows.

    `equal` of `rows` emulated answers were this machine's bit by bit.
    """

    cycles: Cycles
    flash_bytes: int
    ram_bytes: int
    equal: int
    rows: int
    nlos: Judged | None
    los: Judged | None


@dataclass(frozen=True)
class Tried:
    """A network as the search last saw it; cost ESTIMATED, error on held-out training links."""

    name: str
    epochs: int
    mae_m: float
    macs: int
    estimated_cycles: float
    estimated_flash_bytes: float
    finalist: bool


@dataclass(frozen=True)
class SearchFile:
    """One search as it was written."""

    kind: Literal["search"]
    schema_version: Literal[1]
    data: str
    data_fingerprint: str
    simulated: bool
    split: str
    fold: str
    settings: Mapping[str, Any]
    space: Mapping[str, tuple[int | bool, ...]]
    worst_cycles: float
    worst_flash: float
    tried: tuple[Tried, ...]
    finals: Mapping[str, Final]
    declined: Mapping[str, str]
    commit: str
    created_utc: str

    @property
    def label(self) -> str:
        """The recordings, marked where simulated."""
        return f"{self.data} (SIMULATED)" if self.simulated else self.data


def read_search(path: Path) -> SearchFile:
    """Return a search. Raises ReportError where the file is absent, damaged or another kind."""
    try:
        found = msgspec.convert(believed(path, SCHEMA_VERSION), SearchFile)
        if REFERENCE not in found.finals:
            raise ValueError(f"no {REFERENCE} among the finalists")
    except (OSError, ValueError, RecursionError) as problem:
        raise ReportError(f"{path}: cannot be read as a search: {problem}") from problem
    return found


def minus_reference(found: SearchFile, name: str, kind: str) -> Interval | None:
    """Return MAE minus REMnet's on the same links (m) with its interval; None without such rows."""
    one, other = (getattr(found.finals[who], kind) for who in (name, REFERENCE))
    if one is None or other is None:
        return None
    sums = np.array([one.sums_m, other.sums_m], np.float64)
    paired = Paired((name, REFERENCE), sums, np.array(other.rows, np.float64))
    return difference_m(paired, name, REFERENCE)


def meets(found: SearchFile, name: str) -> bool:
    """Return True where a network is not worse, at a quarter of the cycles and half the flash."""
    one, other = found.finals[name], found.finals[REFERENCE]
    small = one.cycles.value <= CYCLES * other.cycles.value
    return small and one.flash_bytes <= FLASH * other.flash_bytes and not_worse(found, name)


def not_worse(found: SearchFile, name: str) -> bool:
    """Return True where no difference to REMnet reaches above 2 % of its MAE."""
    for kind in KINDS:
        gap, reference = minus_reference(found, name, kind), getattr(found.finals[REFERENCE], kind)
        if gap is not None:
            upper = gap.value if gap.high is None else gap.high
            if upper > NOT_WORSE * reference.mae_m:
                return False
    return True


def search_page(found: SearchFile, picture: str | None) -> Document:
    """Return the page; `picture` is the front's, by relative path."""
    document: Document = [
        Heading(f"Smaller networks on {found.label}", 1),
        Paragraph(
            "Error against cycles and flash. Networks were chosen on held-out training links by "
            "ESTIMATED cost; figures below are of finalists trained on all training rows: 8-bit C, "
            f"COUNTED on {found.settings['device']}, judged once on the test rows "
            f"({found.split}, fold {found.fold})."
        ),
        _table(found),
        Paragraph(
            "Names: k samples, f filters x taps / stride, b halving blocks, a attention, h hidden "
            "units, taught by REMnet. Differences: MAE minus REMnet's on the same rows (m), with "
            "95 % intervals over links. Brackets of cycles: low and high ends of the core's table."
        ),
        Bullets(tuple(_verdicts(found))),
    ]
    if picture is not None:
        document.append(Image(picture, "MAE against counted cycles"))
    return [*document, Heading("How it was searched", 2), Bullets(tuple(_facts(found)))]


def _table(found: SearchFile) -> Table:
    columns = (
        Column("Network", number=False),
        Column("Cycles (M)", "cost"),
        Column("Flash (KB)", "cost"),
        Column("RAM (KB)", "cost"),
        Column("NLoS MAE (m)", "error"),
        Column("minus REMnet", "error"),
        Column("LoS MAE (m)", "error"),
        Column("minus REMnet ", "error"),
        Column("Bar", number=False),
    )
    names = sorted(found.finals, key=lambda name: -found.finals[name].cycles.value)
    return Table(columns, tuple(tuple(_cells(found, name)) for name in names))


def _cells(found: SearchFile, name: str) -> Iterator[Cell]:
    one = found.finals[name]
    cycles = one.cycles
    yield Cell(name)
    yield Cell(
        significant(cycles.value / 1e6),
        (f"[{significant(cycles.low / 1e6)}, {significant(cycles.high / 1e6)}]",),
    )
    yield Cell(f"{one.flash_bytes / 1024:.1f}")
    yield Cell(f"{one.ram_bytes / 1024:.1f}")
    for kind in KINDS:
        judged = getattr(one, kind)
        yield Cell("–" if judged is None else metres(judged.mae_m))
        yield _gap(minus_reference(found, name, kind) if name != REFERENCE else None)
    yield Cell("" if name == REFERENCE else "met" if meets(found, name) else "missed")


def _gap(gap: Interval | None) -> Cell:
    if gap is None:
        return Cell("–")
    known = gap.low is not None and gap.high is not None
    return Cell(f"{gap.value:+.4f}", (f"[{gap.low:+.4f}, {gap.high:+.4f}]",) if known else ())


def _verdicts(found: SearchFile) -> Iterator[str]:
    others = [name for name in found.finals if name != REFERENCE]
    met = [name for name in others if meets(found, name)]
    bar = (
        f"a quarter of REMnet's cycles, half its flash, no difference's upper end above "
        f"{100 * NOT_WORSE:.0f} % of its MAE"
    )
    yield f"Bar ({bar}): " + (f"met by {', '.join(met)}." if met else "missed by every network.")
    limit = found.finals[REFERENCE].cycles.value
    within = [name for name in others if found.finals[name].cycles.value <= limit]
    if within:
        best = min(within, key=lambda name: _mae_m(found.finals[name]))
        yield f"Least error at no more than REMnet's own cycles: {best}."


def _mae_m(one: Final) -> float:
    """Return the MAE that decides: NLoS, or LoS where there is nothing else."""
    judged = one.nlos or one.los
    return float("inf") if judged is None else judged.mae_m


def _facts(found: SearchFile) -> Iterator[str]:
    settings = found.settings
    yield (
        "Space: "
        + "; ".join(f"{name} {', '.join(map(str, values))}" for name, values in found.space.items())
        + "."
    )
    yield (
        f"{settings['candidates']} networks drawn with seed {settings['seed']}, "
        f"{settings['levels']} levels up to {settings['epochs']} epochs, then "
        f"{len(found.finals) - 1} finalists of {settings['final_epochs']} epochs; one seed each."
    )
    yield (
        f"Estimated cost: fitted to {settings['calibrate']} counted networks, off by at most "
        f"{100 * found.worst_cycles:.0f} % (cycles) and {100 * found.worst_flash:.0f} % (flash) "
        "on these."
    )
    for name, why in found.declined.items():
        yield f"{name} has no 8-bit C: {why}."
    agreed = all(one.equal == one.rows for one in found.finals.values())
    yield (
        "Every emulated answer was this machine's bit by bit."
        if agreed
        else "Emulated answers were within a millimetre of this machine's."
    )
    yield f"Not searched: 4-bit weights, grouped convolutions (the C has neither). {found.commit}."


def search_picture(found: SearchFile) -> Figure:
    """Return the finalists, their front and REMnet: NLoS MAE against counted cycles."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes: Any = figure.add_subplot()
    points = {name: (one.cycles.value / 1e6, _mae_m(one)) for name, one in found.finals.items()}
    for name, (cycles, mae_m) in points.items():
        axes.plot(cycles, mae_m, "s" if name == REFERENCE else "o", color=_colour(found, name))
        axes.annotate(
            tame(name), (cycles, mae_m), fontsize=7, xytext=(4, 4), textcoords="offset points"
        )
    places = list(points.values())
    front = [places[at] for at in pareto_front(places)]
    axes.step([x for x, _ in front], [y for _, y in front], where="post", color="black", lw=1)
    axes.set_xscale("log")
    axes.grid(alpha=0.3, which="both")
    axes.set_title(
        tame(f"{found.label}: 8-bit C counted on {found.settings['device']}"), fontsize=10
    )
    axes.set_xlabel("counted cycles of one call (millions)")
    axes.set_ylabel("MAE (m)")
    return figure


def _colour(found: SearchFile, name: str) -> str:
    if name == REFERENCE:
        return "black"
    return "C2" if meets(found, name) else "C0"
