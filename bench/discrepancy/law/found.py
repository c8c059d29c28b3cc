"""What a search for laws found, as data: for the report, scores and the next measurement."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from re import sub
from typing import Any

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.law.settings import LAW_DIGITS
from bench.physics.effects.ranging.law import Law, with_constants
from bench.text import significant

FAULT, LAW = "a fault of the set-up", "a law"
UNNAMED = ", which is not named: "  # between an effect and why it is not said


def _in_words(unit: str) -> str:
    """Return a unit as it is said: m/s/V/V is m per s and V^2."""
    top, *below = unit.split("/")
    powers = [f"{one}^{count}" if count > 1 else one for one, count in Counter(below).items()]
    return f"{top} per {' and '.join(powers)}" if powers else top


@dataclass(frozen=True)
class LawConstant:
    """A constant of a law: value, 90 % interval (equal where it was given, not fitted), unit."""

    name: str
    value: float
    low: float
    high: float
    unit: str

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {_in_words(self.unit)}"
        if self.low == self.high:
            return f"{significant(self.value, 4)}{unit}"
        every = self.value, self.low, self.high
        texts = [[significant(one, digits) for one in every] for digits in LAW_DIGITS]
        value, low, high = next((text for text in texts if text[1] != text[2]), texts[0])
        return f"{value} ({low}..{high}){unit}"


@dataclass(frozen=True)
class Rival:
    """A law that the recordings do not exclude: in words, `behind` the best in nats.

    `listed`: it is an effect of the library, which is said before laws that do as well.
    """

    words: str
    form: str
    columns: tuple[str, ...]
    behind: float
    listed: bool = False


@dataclass(frozen=True)
class FoundLaw:
    """A law that sealed links bear out.

    `form`: constant, linear, power, inverse, inverse square, logarithm, parabola, saturation,
    relaxation, step, periodic, rounding, or position, plan, swap, unit, floor,
    ceiling;     `columns`: its covariates;
    `where`: the device, category or column that it is multiplied with, "" where none. `words`: the
    law with figures and units; `nats`: its lead over no law on working links, complexity paid;
    `fault`: the kind of fault of the set-up that it is, or "";
    `gain_nats`: log-likelihood gained per row on sealed links; `nearer_m`: how much smaller
    |recorded - simulated| is there. `rivals` are not excluded. `of_library`: the effects of the
    library of whose form it is, and why these are not named, "" where it is of none. `beside`: that
    of another device, at the same time.
    """

    form: str
    columns: tuple[str, ...]
    where: str
    words: str
    looks_like: str
    expression: str
    constants: tuple[LawConstant, ...]
    nats: float
    gain_nats: Estimate
    nearer_m: Estimate
    rivals: tuple[Rival, ...] = ()
    fault: str = ""
    of_library: str = ""
    beside: FoundLaw | None = None

    @property
    def whole(self) -> Law:
        """The law with that of another device beside it, as one effect of the simulator."""
        if self.beside is None:
            return self.effect
        other, own = self.beside.expression, [(c.name, c.value, c.unit) for c in self.constants]
        for one in self.beside.constants:
            other = sub(rf"\b{one.name}\b", f"{one.name}_2", other)
            own.append((f"{one.name}_2", one.value, one.unit))
        return with_constants(f"{self.expression} + {other}", own)

    @property
    def effect(self) -> Law:
        """The law as an effect of the simulator."""
        return with_constants(self.expression, ((c.name, c.value, c.unit) for c in self.constants))

    @property
    def nearest(self) -> str:
        """What is not excluded, in words: names of the library, else the likeliest; "" if none."""
        if listed := [rival.words for rival in self.rivals if rival.listed]:
            return f"; or {' or '.join(listed)}: these recordings cannot tell"
        rival = min(self.rivals, key=lambda one: one.behind, default=None)
        return f"; not excluded: {rival.words}" if rival else ""

    def __str__(self) -> str:
        name, _, why = self.of_library.partition(UNNAMED)
        what = f"{LAW} of the form of {name}" if name else f"{LAW} without a name"
        what = FAULT if self.fault else what
        unnamed = f" ({name} is not named: {why})" if why and not self.fault else ""
        other = f"; and another beside it: {self.beside.words}" if self.beside else ""
        return f"{what}: {self.words}; looks like: {self.looks_like}{unnamed}{other}"


@dataclass(frozen=True)
class SetupFault:
    """A fault of the set-up: `kind` is position, plan, swap, unit, floor, ceiling or time shift.

    `devices` are those concerned (none: all); `size`: what it measures, e.g. the shift along x, y
    and z in metres.
    """

    kind: str
    devices: tuple[str, ...]
    words: str
    size: tuple[LawConstant, ...] = ()

    def __str__(self) -> str:
        return f"{FAULT}: {self.words}"


def law_dict(law: FoundLaw | None) -> dict[str, Any] | None:
    """Return a law as plain data."""
    if law is None:
        return None
    return {
        "words": str(law),
        "form": law.form,
        "columns": list(law.columns),
        "where": law.where,
        "of_library": law.of_library,
        "looks_like": law.looks_like,
        "expression": law.expression,
        "constants": [vars(c) for c in law.constants],
        "nats": law.nats,
        "sealed_gain_nats_per_row": vars(law.gain_nats),
        "sealed_nearer_m": vars(law.nearer_m),
        "beside": law_dict(law.beside),
        "not_excluded": [vars(r) | {"columns": list(r.columns)} for r in law.rivals],
    }


def fault_dict(fault: SetupFault | None) -> dict[str, Any] | None:
    """Return a fault of the set-up as plain data."""
    if fault is None:
        return None
    size = [vars(c) for c in fault.size]
    return {
        "kind": fault.kind, "devices": list(fault.devices), "words": str(fault), "size": size,
    }  # fmt: skip
