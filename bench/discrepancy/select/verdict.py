"""What a diagnosis says, as data: every verdict with the figures it rests on."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.settings import UNUSUAL_P
from bench.physics.effect import Effect

UNTRIED = "it could not be tried"  # how notes on such effects begin
NEEDS = f"{UNTRIED}: it needs "  # the same where it is known what for


@dataclass(frozen=True)
class Control:
    """The negative control of an effect: where it must vanish, what is seen there.

    `left` is the mean residual in the observable's unit on rows where the effect must do nothing;
    `passed` is None where there are no such rows, or where they do not decide.
    """

    words: str
    passed: bool | None
    rows: int = 0
    left: Estimate | None = None


@dataclass(frozen=True)
class LeftOut:
    """The simulator leaves out one effect of the library; `judged`: what `gain` was counted in."""

    effect: Effect
    parameters: tuple[ParameterEstimate, ...]
    gain: Estimate
    share: float
    control: Control
    findings: tuple[Finding, ...] = ()
    note: str = ""
    judged: str = "gain on held-out links"

    @property
    def names(self) -> tuple[str, ...]:
        """The name of the physics, as a tuple of one."""
        return (self.effect.physics,)

    @property
    def tried(self) -> bool:
        """Whether it was fitted: what needs more than a table tells was not, as its note says."""
        return not self.note.startswith(UNTRIED)

    def __str__(self) -> str:
        return f"left out: {self.names[0]} ({type(self.effect).signature})"


def not_tried(said: LeftOut, effect: Effect, note: str) -> LeftOut:
    """Return an effect that could not be tried, beside one that was; `note` says what it needs."""
    unknown = Control(type(effect).control, None)
    return replace(said, effect=effect, parameters=(), control=unknown, note=note)


@dataclass(frozen=True)
class Ambiguous:
    """Several effects explain it equally well on held-out links; best first."""

    options: tuple[LeftOut, ...]
    separate: str

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the equivalence class, best first."""
        return tuple(option.names[0] for option in self.options)

    def __str__(self) -> str:
        return f"{' or '.join(self.names)}: these recordings cannot tell; {self.separate}"


@dataclass(frozen=True)
class Unknown:
    """Something is there that no known effect explains; `cause`: what marks say it is.

    `beside`: names of the effects that were simulated when `findings` were seen.
    """

    findings: tuple[Finding, ...]
    removable: Estimate
    tried: dict[str, float] = field(default_factory=dict)
    note: str = ""
    cause: str = ""
    beside: tuple[str, ...] = ()

    names: tuple[str, ...] = ()

    @property
    def told(self) -> str:
        """The note, and beside what the differences were seen."""
        names = " and ".join(dict.fromkeys(self.beside))
        seen = f"the differences are those left with {names} in the simulator" if names else ""
        return "; ".join(filter(None, (self.note, seen)))

    def __str__(self) -> str:
        what = self.cause or (self.findings[0].told if self.findings else "the held-out score")
        return f"something is there that no known effect explains: {what}"


@dataclass(frozen=True)
class NoMismatch:
    """Nothing significant; `detectable` is the smallest shift per observable that would show.

    `p` is that of the first search; where several share 5 %, or a witness is asked, less is needed.
    """

    detectable: dict[str, float]
    p: float

    names: tuple[str, ...] = ()

    def __str__(self) -> str:
        seen = self.detectable.get("error_m")
        shared = ", not enough, as several searches share 5 %" * (self.p <= UNUSUAL_P)
        found = f"p = {self.p:.2g}{shared}"
        if seen is None:
            return f"no mismatch found ({found})"
        least = f"; a range shift of {seen:.2g} m would have been seen every second time"
        if not isfinite(seen):
            least = "; no shift of all ranges would have been seen: too few links or simulated rows"
        return f"no mismatch found ({found}){least}"


Verdict = LeftOut | Ambiguous | Unknown | NoMismatch


def options_of(said: Verdict) -> tuple[LeftOut, ...]:
    """Return the effects of a verdict: none, one, or those that do as well, best first."""
    if isinstance(said, Ambiguous):
        return said.options
    return (said,) if isinstance(said, LeftOut) else ()


def as_dict(verdict: Verdict) -> dict[str, Any]:
    """Return a verdict as plain data for JSON."""
    kind = {LeftOut: "left out", Ambiguous: "ambiguous", Unknown: "unknown"}
    out: dict[str, Any] = {
        "verdict": kind.get(type(verdict), "no mismatch"),
        "names": list(verdict.names),
        "words": str(verdict),
    }
    if isinstance(verdict, NoMismatch):
        return out | {"detectable": verdict.detectable, "p": verdict.p}
    if isinstance(verdict, Unknown):
        removable = vars(verdict.removable)
        return out | {
            "note": verdict.note,
            "beside": list(verdict.beside),
            "findings": [str(one.told) for one in verdict.findings],
            "located": [_located(one.told) for one in verdict.findings],
            "removable": removable,
        }
    if isinstance(verdict, Ambiguous):
        options = [_option(option) for option in verdict.options]
        return out | {"separate": verdict.separate, "options": options}
    return out | {"options": [_option(verdict)]}


def _located(found: Finding) -> dict[str, Any]:
    """Return what differs, where and by how much, as plain data."""
    place, effect = found.cell.place, vars(found.effect)
    cell = {"observable": found.cell.observable, "moment": found.cell.moment}
    said = {"what": found.what, "where": place.where(), **cell, **vars(place), "effect": effect}
    return said | {"z": found.z, "p": found.p, "rows": found.rows, "links": found.links}


def _option(option: LeftOut) -> dict[str, Any]:
    """Return one named effect as plain data; without values and evidence where it was not tried."""
    own = {"values": dict(vars(option.effect)), "gain": vars(option.gain)}
    return {
        "effect": option.effect.name,
        **(own if option.tried else {"values": {}, "gain": None}),
        "parameters": [vars(p) for p in option.parameters],
        "share_of_removable": option.share if option.tried else None,
        "control": {"words": option.control.words, "passed": option.control.passed},
        "note": option.note,
    }
