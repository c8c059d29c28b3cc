"""Runs the diagnosis on concealed cases and scores it. Answers are sealed: hash before the run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd

from bench.challenge.generator import JITTER_M, LINKS, OUTSIDE, ROWS, Hidden, conceal, draw_case
from bench.challenge.generator import geometry as draw_geometry
from bench.discrepancy.study import Options, Study, study
from bench.discrepancy.verdict import NoMismatch, Unknown
from bench.errors import BenchError
from bench.files import write_atomically
from bench.physics.base import Base
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

Way = Literal["resimulated", "paired table", "unpaired table"]
WAYS: tuple[Way, ...] = ("resimulated", "paired table", "resimulated", "unpaired table")
Tell = Callable[[str], None]
DETECTION_LIMIT_M = JITTER_M  # rms of a hidden effect that counts as above the detection limit
SCATTER = 6.0  # jitter is this much larger under concealment by scatter


@dataclass(frozen=True)
class Outcome:
    """One case: what was hidden, what was said, and how that is scored."""

    number: int
    way: Way
    hidden: Hidden
    verdict: str
    names: list[list[str]]
    score: str
    above_limit: bool
    removed: float
    p: float


def simulator_of(hidden: Hidden, seed: int) -> Simulator:
    """Return the simulator under diagnosis: the base with its jitter."""
    scale = SCATTER if hidden.conceal == "scatter" and hidden.names else 1.0
    jitter = TimestampJitter(jitter_samples=0.08 * scale)
    return Simulator(Base(), (jitter,), seed, "challenge")


def make_case(number: int, seed: int) -> tuple[Hidden, Recordings, Simulator | Recordings, Way]:
    """Return a case: the hidden answer, the recorded table, and the simulated side."""
    hidden = draw_case(number, seed)
    way = WAYS[(number // 3) % len(WAYS)]
    base = simulator_of(hidden, 7)
    frame = draw_geometry(seed * 10_000 + number)
    recorded = conceal(_simulated(base, frame, 1000 + number), hidden, seed * 10_000 + number)
    table = Recordings(recorded.drop(columns="clock_offset_ppm", errors="ignore"), f"case {number}")
    if way == "resimulated":
        return hidden, table, base, way
    other = frame if way == "paired table" else draw_geometry(seed * 10_000 + number + 5000)
    made = pd.concat([_simulated(base, other, 2000 + number + i) for i in range(3)])
    if way == "unpaired table":
        made["link"] = "other " + made["link"].astype(str)
    return hidden, table, Recordings(made.reset_index(drop=True), "simulated", simulator="x"), way


def _simulated(base: Simulator, frame: pd.DataFrame, seed: int) -> pd.DataFrame:
    """Return the frame with simulated ranges, from the paths alone."""
    return base.observe(scene(frame), seed, cir=False).table(frame)


def run_case(number: int, seed: int) -> Outcome:
    """Diagnose one case and score it."""
    hidden, table, simulated, way = make_case(number, seed)
    options = Options(seed, search_rows=400, fit_rows=200, observables=("error_m",), waveform=False)
    found = study(table, simulated, options)
    names = [list(group) for group in found.diagnosis.names]
    first = found.diagnosis.verdicts[0]
    above = bool(hidden.strengths_m) and rms_m(hidden) >= DETECTION_LIMIT_M
    return Outcome(
        number=number,
        way=way,
        hidden=hidden,
        verdict=str(first),
        names=names,
        score=scored(hidden, found),
        above_limit=above,
        removed=_removed(found),
        p=found.diagnosis.rounds[0].located.p,
    )


def rms_m(hidden: Hidden) -> float:
    """Return the smallest rms of the hidden effects in metres over the scatter it hides under."""
    under = SCATTER if hidden.conceal == "scatter" else 1.0
    over = np.sqrt(0.1) if hidden.conceal == "sparse" else 1.0
    return float(min(hidden.strengths_m) / under * over)


def _removed(found: Study) -> float:
    """Return the share of the mean abs. range mismatch on confirm links that was removed."""
    seen = found.confirmed
    return 1 - seen.mae_after_m.value / max(seen.mae_before_m.value, 1e-12)


def scored(hidden: Hidden, found: Study) -> str:
    """Return right, ambiguous, partly, wrong, unknown, missed, or (empty cases) clean, alarm."""
    verdicts = found.diagnosis.verdicts
    said = {name for group in found.diagnosis.names for name in group}
    silent = isinstance(verdicts[0], NoMismatch)
    if not hidden.names:
        return "clean" if silent else "alarm"
    if silent:
        return "missed"
    if not said:
        return "unknown"
    truth = set(hidden.names)
    if truth & set(OUTSIDE):
        return "wrong"
    # Equal histograms make the recorded scatter really smaller than the simulator's.
    side = {"timestamp-jitter"} if hidden.conceal == "aggregate" else set()
    if any(not (truth | side) & set(group) for group in found.diagnosis.names):
        return "wrong"
    if not truth <= said:
        return "partly"
    unknown = any(isinstance(v, Unknown) for v in verdicts)
    alone = all(len(group) == 1 for group in found.diagnosis.names)
    return "right" if alone and not unknown else "ambiguous"


def seal(cases: int, seed: int) -> str:
    """Return the hash of every answer, to be published before the run."""
    answers = [asdict(draw_case(number, seed)) for number in range(cases)]
    return hashlib.sha256(json.dumps(answers, sort_keys=True).encode()).hexdigest()


def run_blind(cases: int, seed: int, folder: Path, tell: Tell) -> list[Outcome]:
    """Run (or resume) the blind challenge; one JSON file per case in `folder`/cases.

    Raises BenchError where the folder holds a challenge of another seed.
    """
    seal_path = folder / "sealed.json"
    sealed = {"seed": seed, "cases": cases, "sha256": seal(cases, seed)}
    if seal_path.exists():
        before = json.loads(seal_path.read_text())
        if before["seed"] != seed:
            raise BenchError(f"{folder} holds a challenge of seed {before['seed']}, not {seed}")
    write_atomically(seal_path, json.dumps(sealed, indent=1) + "\n")
    out = []
    for number in range(cases):
        path = folder / "cases" / f"{number:04d}.json"
        if not path.exists():
            tell(f"case {number + 1} of {cases}")
            made = run_case(number, seed)
            write_atomically(path, json.dumps(asdict(made), indent=1, default=float) + "\n")
        out.append(_read(json.loads(path.read_text())))
    return out


def _read(data: dict[str, Any]) -> Outcome:
    """Return an outcome read back from its file."""
    hidden = data["hidden"]
    kept: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in hidden.items()}
    answer: Any = Hidden(**kept)
    return Outcome(**{**data, "hidden": answer})


@dataclass(frozen=True)
class Rate:
    """A share with its count and the bar it is held to (None: no bar)."""

    words: str
    hits: int
    cases: int
    bar: str = ""
    met: bool | None = None

    @property
    def value(self) -> float:
        """The share, NaN where there was no case."""
        return self.hits / self.cases if self.cases else float("nan")


def rates(outcomes: list[Outcome]) -> list[Rate]:
    """Return the scores of a challenge against its bars."""
    empty = [o for o in outcomes if not o.hidden.names]
    rest = [o for o in outcomes if o.hidden.names]
    outside = [o for o in rest if set(o.hidden.names) & set(OUTSIDE)]
    ours = [o for o in rest if o not in outside]
    above = [o for o in ours if o.above_limit]
    return [
        _rate("false alarms on empty cases", empty, ("alarm",), "at most 5 %", 0.05, most=True),
        _rate("wrong names on all others", rest, ("wrong",), "at most 5 %", 0.05, most=True),
        _rate(
            "right name, or a class that holds it, above the detection limit",
            above,
            ("right", "ambiguous"),
            "at least 90 %",
            0.9,
        ),
        _rate("of these, the right name alone", above, ("right",)),
        _rate("one of two effects named", above, ("partly",)),
        _rate("something is there, above the limit", above, ("unknown",)),
        _rate("missed, above the limit", above, ("missed",)),
        _rate("outside the library: reported unknown", outside, ("unknown",), "at least 90 %", 0.9),
    ]


def _rate(
    words: str,
    among: list[Outcome],
    scores: tuple[str, ...],
    bar: str = "",
    value: float | None = None,
    most: bool = False,
) -> Rate:
    """Return the share of outcomes with one of these scores."""
    hits = sum(o.score in scores for o in among)
    met = None
    if value is not None and among:
        met = hits / len(among) <= value if most else hits / len(among) >= value
    return Rate(words, hits, len(among), bar, met)


def blind_markdown(outcomes: list[Outcome], seed: int) -> list[str]:
    """Return the blind part of the report."""
    lines = [
        "## Blind cases",
        "",
        f"{len(outcomes)} cases, seed {seed}, {LINKS} links x {ROWS} rows each; ranges only, no "
        f"CIR. Answers sealed before the run: sha256 `{seal(len(outcomes), seed)}`.",
        "",
        "| score | value | bar | met |",
        "| --- | --- | --- | --- |",
    ]
    for rate in rates(outcomes):
        met = {True: "yes", False: "**no**", None: ""}[rate.met]
        share = f"{rate.hits}/{rate.cases}" + (f" = {rate.value:.0%}" if rate.cases else "")
        lines.append(f"| {rate.words} | {share} | {rate.bar} | {met} |")
    lines += ["", "| case | way | hidden | rms (mm) | concealed | said | score |"]
    lines.append("| --- | --- | --- | --- | --- | --- | --- |")
    for one in outcomes:
        said = "; ".join(" or ".join(group) for group in one.names) or one.verdict[:60]
        sizes = ", ".join(f"{1000 * s:.0f}" for s in one.hidden.strengths_m)
        lines.append(
            f"| {one.number} | {one.way} | {', '.join(one.hidden.names) or 'nothing'} | {sizes} "
            f"| {one.hidden.conceal} | {said} | {one.score} |"
        )
    return lines
