"""Pictures of a diagnosis: profile before and after, residual over a covariate, the ladder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import LIKELIHOOD
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.confirm import Confirmed
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.select.candidates import Contender
from bench.discrepancy.select.settings import RANK_BINS
from bench.discrepancy.settings import (
    FEW_POINTS,
    FIGURE_BINS,
    FIGURE_CENTRE,
    FIGURE_MORE,
    LEAST_SCATTER_M,
    ONE_SIDED_95,
)
from bench.files import atomic_path
from bench.forked import forking, in_forks
from bench.text import unmarked

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]
RECORDED, BEFORE, AFTER = "#222222", "#c44e52", "#4c72b0"


def draw(diagnosis: Diagnosis, folder: Path) -> list[tuple[str, str]]:
    """Write every figure that the diagnosis supports; return (file name, caption) of each."""
    made = [
        ("residual.png", residual_figure, "Recorded minus simulated range error on confirm links"),
        ("ladder.png", ladder_figure, "What each added effect gained on held-out links"),
        ("ranks.png", ranks_figure, "Ranks of the recorded error in the ensemble: flat is right"),
    ]
    if not diagnosis.added:
        made = [one for one in made if one[0] != "ladder.png"]  # nothing was added: no steps
    if any(name.startswith("profile_db") for name in diagnosis.confirmed.before.names):
        made.insert(0, ("profile.png", profile_figure, "Median power-delay profile, confirm links"))
    with forking(True):
        in_forks(lambda one: _save(folder / one[0], one[1], diagnosis, one[2]), made)
    return [(name, caption) for name, _, caption in made]


def _save(path: Path, figure: Any, diagnosis: Diagnosis, caption: str) -> None:
    """Draw one figure without a display and write it atomically."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    canvas: Any = FigureCanvasAgg(Figure(figsize=(7, 4), dpi=110, layout="constrained"))
    axes = canvas.figure.add_subplot()
    figure(axes, diagnosis)
    axes.set_title(unmarked(caption), fontsize=10)
    with atomic_path(path) as scratch:
        canvas.print_png(scratch)  # `savefig` draws everything twice


def profile_figure(axes: Axes, diagnosis: Diagnosis) -> None:
    """Median power per delay bin: recorded, simulated before, simulated after."""
    seen = diagnosis.confirmed
    which = [i for i, name in enumerate(seen.before.names) if name.startswith("profile_db")]
    labels = [seen.before.names[i][11:-1] for i in which]
    for values, colour, label in _medians(diagnosis, which):
        axes.plot(range(len(which)), values, "o-", color=colour, label=label)
    axes.set_xticks(range(len(which)), labels, rotation=60, fontsize=7)
    axes.set_xlabel("delay after the detected first path (ns)")
    axes.set_ylabel("power in the bin / energy of the CIR (dB)")
    axes.legend()


def _medians(diagnosis: Diagnosis, which: list[int]) -> list[tuple[Floats, str, str]]:
    """Return the medians of recorded, before and after for some observables."""
    recorded = diagnosis.confirmed.before.recorded[:, which]
    out = [(np.nanmedian(recorded, axis=0), RECORDED, "recorded")]
    for made, colour, label in _stages(diagnosis):
        middle = np.nanmedian(made.simulated[..., which], axis=(0, 1))
        out.append((middle, colour, f"SIMULATED {label}"))
    return out


def _stages(diagnosis: Diagnosis) -> list[tuple[Ensemble, str, str]]:
    """Return what was simulated before and, where anything was added, after."""
    seen = diagnosis.confirmed
    if not diagnosis.added:
        return [(seen.before, BEFORE, "(nothing was added)")]
    return [(seen.before, BEFORE, "before"), (seen.after, AFTER, "after")]


def residual_figure(axes: Axes, diagnosis: Diagnosis) -> None:
    """Residual of the range error over the covariate that the search found first."""
    seen = diagnosis.confirmed
    column = responsible(diagnosis)
    value = _covariate(seen, column)
    if value is None:
        value, column = np.arange(len(seen.before.links), dtype=np.float64), "row"
    size = 7 if len(value) <= FEW_POINTS else 3
    for ensemble, colour, label in _stages(diagnosis):
        axes.plot(value, _residual(ensemble), ".", ms=size, alpha=0.4, color=colour, label=label)
    axes.axhline(0, color=RECORDED, lw=0.8)
    _cut_outliers(axes, [_residual(seen.before), _residual(seen.after)])
    axes.set_xlabel(unmarked(column))
    axes.set_ylabel(f"recorded - simulated {_first(seen.before)}")
    axes.legend()


def _cut_outliers(axes: Axes, values: list[Floats]) -> None:
    """Show the central 98 % and say how many points lie beyond."""
    every = np.concatenate([one[np.isfinite(one)] for one in values])
    if not len(every):
        return
    low, high = np.quantile(every, FIGURE_CENTRE)
    room = 0.3 * max(high - low, LEAST_SCATTER_M)
    low, high = low - room, high + room
    beyond = int(((every < low) | (every > high)).sum())
    axes.set_ylim(low, high)
    if beyond:
        axes.text(0.99, 0.01, f"{beyond} points beyond", ha="right", transform=axes.transAxes)


def responsible(diagnosis: Diagnosis) -> str:
    """Return the numeric covariate of a finding over which the range residual varies most.

    The true range, unless another tells clearly more.
    """
    seen = diagnosis.confirmed
    every = [f for turn in diagnosis.selection.rounds for f in turn.located.findings]
    findings = [f for f in every if f.cell.observable == RANGE] or every
    places = [f.cell.place.covariate for f in findings]
    names = dict.fromkeys(name for name in places if name and name != "time_s")
    known = {name: _covariate(seen, name) for name in names}
    share = {n: _explained(v, _residual(seen.before)) for n, v in known.items() if v is not None}
    plain = _covariate(seen, "true_range_m")
    least = _explained(plain, _residual(seen.before)) + FIGURE_MORE if plain is not None else 0.0
    telling = {name: value for name, value in share.items() if value > least}
    return max(telling, key=lambda name: telling[name], default="true_range_m")


def _covariate(seen: Confirmed, name: str) -> Floats | None:
    """Return a known number or a recorded observable of the confirm rows [n], None if neither."""
    value = seen.view.covariates.numbers.get(name)
    if value is None and name in seen.before.names:
        value = seen.before.recorded_of(name)
    return value


def _explained(value: Floats, residual: Floats, bins: int = FIGURE_BINS) -> float:
    """Return the share of the residual's variance between quantile bins of a covariate."""
    known = np.isfinite(value) & np.isfinite(residual)
    if known.sum() < bins or np.var(residual[known]) == 0:
        return 0.0
    edges = np.quantile(value[known], np.linspace(0, 1, bins + 1)[1:-1])
    place = np.searchsorted(edges, value[known])
    count = np.maximum(np.bincount(place, minlength=bins), 1)
    means = np.bincount(place, residual[known], minlength=bins) / count
    return float(np.var(means[place]) / np.var(residual[known]))


def _first(ensemble: Ensemble) -> str:
    name = "error_m" if "error_m" in ensemble.names else ensemble.names[0]
    words = "range error" if name == RANGE else name
    return f"{words} ({ensemble.units[ensemble.names.index(name)]})"


def _residual(ensemble: Ensemble) -> Floats:
    name = "error_m" if "error_m" in ensemble.names else ensemble.names[0]
    return np.asarray(ensemble.residual[:, ensemble.names.index(name)])


def ladder_figure(axes: Axes, diagnosis: Diagnosis) -> None:
    """Held-out gain of every effect in the order it was added, with 95 % intervals.

    Small marks: what the others would have gained in its place. What a likelihood speaks for has
    nats of its own, on the upper axis: one of them is not one of the score.
    """
    turns = [t for t in diagnosis.selection.rounds if t.added is not None and t.explanation]
    steps = [turn.explanation.contenders for turn in turns if turn.explanation]
    scored = [place for place, step in enumerate(steps) if step[0].gain.unit != LIKELIHOOD]
    judged = [place for place in range(len(steps)) if place not in scored]
    if scored or not steps:
        _gains(axes, steps, scored, AFTER)
        marks = "; marks: others in its place" * any(len(steps[place]) > 1 for place in scored)
        axes.set_xlabel(f"gain on held-out links (nats of log CRPS){marks}")
    if judged:
        likely = axes.twiny() if scored else axes
        _gains(likely, steps, judged, RECORDED)
        likely.set_xlabel("evidence of links, grey (nats of likelihood)")
    axes.set_ylim(max(len(steps), 1) - 0.5, -0.5)  # an empty ladder has the height of one step
    axes.set_yticks(range(len(steps)), [step[0].name for step in steps])
    if not steps:
        axes.text(0.5, 0.5, "nothing was added", ha="center", transform=axes.transAxes)


def _gains(
    axes: Axes, steps: Sequence[tuple[Contender, ...]], places: Sequence[int], colour: str
) -> None:
    """Draw the gains of some steps of the ladder, others in their place as marks."""
    gains = [steps[place][0].gain for place in places]
    edges = np.array([[g.value - g.low, g.high - g.value] for g in gains]).reshape(-1, 2).T
    error = np.abs(edges) if gains else None
    axes.barh(places, [gain.value for gain in gains], color=colour, alpha=0.4, xerr=error)
    for place in places:
        for number, other in enumerate(steps[place][1:4]):
            _mark(axes, max(other.gain.value, 0.0), place + 0.18 * number, other.name)


def _mark(axes: Axes, value: float, place: float, name: str) -> None:
    """Mark what another effect would have gained at a step of the ladder."""
    axes.plot(value, place + 0.3, "v", ms=4, color=BEFORE)
    axes.text(value, place + 0.25, f"  {name}", fontsize=6, color=BEFORE)


def ranks_figure(axes: Axes, diagnosis: Diagnosis) -> None:
    """Histogram of ensemble ranks, before and after, with what chance makes of even ones."""
    half = 0.0
    for ensemble, colour, label in _stages(diagnosis):
        name = "error_m" if "error_m" in ensemble.names else ensemble.names[0]
        ranks = ensemble.ranks()[:, ensemble.names.index(name)]
        kept = ranks[np.isfinite(ranks)]
        axes.hist(kept, bins=RANK_BINS, range=(0, 1), density=True, histtype="step", color=colour,
                  label=label)  # fmt: skip
        half = chance_of_ranks(len(np.unique(ensemble.links)))
    axes.axhspan(max(0.0, 1 - half), 1 + half, color=RECORDED, alpha=0.12, lw=0,
                 label="nine in ten by chance, rows of a link alike")  # fmt: skip
    axes.axhline(1, color=RECORDED, lw=0.8)
    axes.set_xlabel("rank of the recorded error among simulated ones (0..1)")
    axes.set_ylabel("density")
    axes.legend()


def chance_of_ranks(links: int) -> float:
    """Return how far nine in ten densities of even ranks are from one at most, each link one draw.

    Rows of a link that are not alike stay nearer.
    """
    return float(ONE_SIDED_95 * np.sqrt((RANK_BINS - 1) / max(links, 1)))
