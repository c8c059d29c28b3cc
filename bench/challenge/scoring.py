"""Scores of blind cases: what was said against what was hidden."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from bench.challenge.cases import LIMIT_Z, Case
from bench.challenge.law_score import law_score
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.select.verdict import NoMismatch, Unknown

RIGHT = ("right", "ambiguous")


@dataclass(frozen=True)
class Outcome:
    """One case: what was hidden, what was said, and how that is scored.

    `hidden` names of effects, `outside` those of them that no library effect can be given for,
    `forms` the forms of law or faults of the set-up that say it. `strength_z` as in `Case`;
    `alarm_z` is the search's largest statistic over its family-wise 5 % threshold. `removed` and
    `removable`: the fall of the sealed mismatch by the diagnosis and by the truth (see `removal`);
    `better`: the sealed links fit better after, and ranges no worse. `covered` and
    `parameter_errors`: see `truths`. `detected` maps multiples of the stated detectable shift to
    whether it was seen when planted. `stated_law`: what the diagnosis says of a law without a name
    or a fault of the set-up; `form_right`, `value_right`: see `law_score`. `seconds`: CPU time of
    the diagnosis.
    """

    number: int
    mode: str
    family: str
    hidden: list[str]
    outside: list[str]
    forms: list[str]
    strength: float
    ratio: int
    paired: bool
    same_mix: bool
    listed: bool
    counted: bool
    concealed: str
    verdict: str
    names: list[list[str]]
    score: str
    strength_z: float
    alarm_z: float
    removed: float = 0.0
    removable: float = 0.0
    better: bool = True
    recommended: bool = True
    covered: list[bool] = field(default_factory=list)
    parameter_errors: list[float] = field(default_factory=list)
    detected: dict[str, bool] = field(default_factory=dict)
    stated_law: str = ""
    form_right: bool | None = None
    value_right: bool | None = None
    seconds: float = 0.0
    headline: str = ""

    @property
    def above_limit(self) -> bool:
        """True where the weakest hidden effect is above the detection limit."""
        return self.strength_z >= LIMIT_Z

    @property
    def fraction(self) -> float:
        """What was removed as a fraction of what the truth removes."""
        return self.removed / self.removable if self.removable > 0 else float("nan")


def outcome(case: Case, found: Diagnosis, number: int) -> Outcome:
    """Return what a case tells: what was said, how it scores, how loud the search was."""
    located = found.selection.rounds[0].located
    return replace(
        blank(case, number, scored(case, found), "; ".join(map(str, found.selection.verdicts))),
        names=[list(group) for group in found.selection.names],
        alarm_z=located.z / located.threshold,
        better=found.confirmed.gain.value > 0 if found.added else True,
        recommended=found.recommended or not found.added,
        headline=found.headline,
        **law_score(case, found),
    )


def blank(case: Case, number: int, score: str, words: str) -> Outcome:
    """Return an outcome with what is known before a diagnosis: `score` says why there is none."""
    drawn = case.drawn
    return Outcome(
        number=number,
        mode=case.turn.mode,
        family=case.turn.family,
        hidden=list(drawn.hidden),
        outside=list(case.outside),
        forms=list(case.law.forms),
        strength=drawn.strength,
        ratio=drawn.ratio,
        paired=drawn.paired,
        same_mix=drawn.same_mix,
        listed=drawn.listed,
        counted=drawn.counted,
        concealed=drawn.concealed,
        verdict=words,
        names=[],
        score=score,
        strength_z=case.strength_z,
        alarm_z=0.0,
    )


def scored(case: Case, found: Diagnosis) -> str:
    """Return right, ambiguous, partly, wrong, unknown, missed, or (empty cases) clean, alarm.

    Something without a name beside the right ones is true where something is outside the library,
    and where errors were bent into another histogram, which no effect does. A hidden effect of the
    library that could not be tried (into another simulator's table not every one can be put) need
    not be named; a class that has it is no wrong name.
    """
    verdicts = found.selection.verdicts
    said = {name for group in found.selection.names for name in group}
    silent = isinstance(verdicts[0], NoMismatch)
    if not case.drawn.hidden:
        return "clean" if silent else "alarm"
    if silent:
        return "missed"
    if not said:
        return "unknown"
    truth = set(case.drawn.hidden) - set(case.outside)
    side = _side(case) | set(case.outside)
    if any(not (truth | side) & set(group) for group in found.selection.names):
        return "wrong"
    if not truth <= said or len(found.selection.names) < len(truth):
        return "partly"
    unknown = any(isinstance(v, Unknown) for v in verdicts)
    alone = all(len(group) == 1 for group in found.selection.names)
    left = bool(case.outside) or case.drawn.concealed == "aggregate"
    return "right" if alone and (not unknown or left) else "ambiguous"


def _side(case: Case) -> set[str]:
    """Return what a concealment itself does: also true where it is said.

    To cancel every aggregate, a constant was really taken off and the scatter made smaller.
    """
    aggregate = case.drawn.concealed == "aggregate"
    return {"timestamp-jitter", "antenna-delay"} if aggregate else set()
