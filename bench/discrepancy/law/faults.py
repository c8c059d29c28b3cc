"""Faults of the set-up as structures: a position, a swap of two devices, a unit."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.matching import link_means
from bench.discrepancy.law.forms import Named
from bench.discrepancy.law.likelihood import fixed, iterated, linear
from bench.discrepancy.law.material import Factor, Material
from bench.discrepancy.law.settings import (
    LAW_DEVICE_ROWS,
    LAW_EVERY_RATE,
    LAW_OWN_RATE,
    LAW_RATIO_DOUBT,
    LAW_RATIOS,
    LAW_SAME_PLACE_M,
)
from bench.discrepancy.law.structures import Fitted, Structure
from bench.discrepancy.law.swaps import FAR_END, Swap, swaps

Floats = NDArray[np.float64]
UNDETERMINED = "an undetermined length"


def faults(given: Material) -> Iterator[Position | Swap | Unit]:
    """Yield every fault of the set-up that the rows say anything about."""
    yield from units(given)
    if given.ends and given.devices:
        yield from positions(given)
        yield from swaps(given)


@dataclass(frozen=True)
class Position:
    """A device stands elsewhere than the plan says; `device` "" is every device at one end."""

    device: str
    ends: tuple[str, ...]
    axes: tuple[int, ...]
    known: str
    choices: int
    form: str = "position"
    fault: str = "position"

    @property
    def free(self) -> int:
        """How many coordinates it fits."""
        return len(self.axes)

    @property
    def columns(self) -> tuple[str, ...]:
        """The positions' columns."""
        return tuple(f"{end}_{axis}_m" for end in self.ends for axis in self.known)

    @property
    def where(self) -> str:
        """The device."""
        return self.device

    @property
    def expression(self) -> str:
        """The true distance with the device moved, minus that without."""
        return " + ".join(self._at(end) for end in self.ends)

    def _at(self, end: str) -> str:
        """Return the expression of the rows with the device at one end."""
        gaps = [f"{end}_{a}_m - {FAR_END[end]}_{a}_m" for a in self.known]
        gaps = [f"{g} + d{'xyz'[i]}" if i in self.axes else g for i, g in enumerate(gaps)]
        far = " + ".join(f"({gap}) ** 2" for gap in gaps)
        moved = f"(sqrt({far}) - true_range_m)"
        return f"({end} == {json.dumps(self.device)}) * {moved}" if self.device else moved

    def fitted(self, given: Material) -> Fitted:
        """Return the shift along each axis in metres, by reweighted Gauss-Newton steps."""
        start = np.zeros(len(self.axes))
        fit = iterated(lambda d: self._moved(given, d), start, given.residual_m)
        constants = [
            (f"d{'xyz'[a]}", float(v), "m") for a, v in zip(self.axes, fit.values, strict=True)
        ]
        return Fitted(tuple(constants), fit)

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what it says of other rows."""
        return self._moved(given, np.array([value for _, value, _ in constants]))[0]

    def slopes(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what a metre more along each axis does to rows [n, axes]."""
        return self._moved(given, np.array([value for _, value, _ in constants]))[1]

    def _moved(self, given: Material, shift: Floats) -> tuple[Floats, Floats]:
        """Return what ranges gain [n] and its slopes [n, axes]."""
        total = np.zeros(len(given.residual_m))
        slopes = np.zeros((len(total), len(self.axes)))
        for end in self.ends:
            gap = given.ends[end] - given.ends[FAR_END[end]]
            gap[:, self.axes] += shift
            far = np.maximum(np.linalg.norm(gap, axis=1), 1e-9)
            here = given.devices[end] == self.device if self.device else np.ones(len(far), bool)
            total += np.where(here, far - given.true_range_m, 0.0)
            slopes += np.where(here, 1.0, 0.0)[:, None] * (gap / far[:, None])[:, self.axes]
        return total, slopes

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        who = f"device {self.device}" if self.device else f"every {self.ends[0]}"
        said = {axis: shown[f"d{axis}"] for axis in self.axis_names}
        elsewhere = f"{who} stands elsewhere than its position says"
        if set(said.values()) == {UNDETERMINED}:
            return f"{elsewhere}; how far, these recordings do not determine"
        return f"{elsewhere}, by {', '.join(f'{by} along {axis}' for axis, by in said.items())}"

    @property
    def axis_names(self) -> str:
        """The axes, as letters."""
        return "".join("xyz"[a] for a in self.axes)


def positions(given: Material) -> Iterator[Position]:
    """Yield a moved position for every device that stands still, and for all at one end together.

    A name that is recorded at several places is a part (anchor, tag), not one thing that stands.
    """
    ends = {
        name: tuple(e for e in ("tx", "rx") if (given.devices[e] == name).any())
        for name in sorted({*given.devices.get("tx", ()), *given.devices.get("rx", ())})
        if set(given.devices) == {"tx", "rx"}
    }
    seen = {
        n: at for n, at in ends.items()
        if _rows_of(given, n, at).sum() >= LAW_DEVICE_ROWS and _stands(given, n, at)
    }  # fmt: skip
    flat = not any(np.ptp(given.ends[end][:, 2]) for end in given.ends)
    for axes in ((0, 1),) if flat else ((0, 1), (0, 1, 2)):
        for name, at in seen.items():
            yield Position(name, at, axes, given.axes, len(seen) + 1)
        yield Position("", ("rx",), axes, given.axes, len(seen) + 1)


def _stands(given: Material, device: str, ends: tuple[str, ...]) -> bool:
    """Return whether a device is recorded at one place."""
    places = np.concatenate([given.ends[end][given.devices[end] == device] for end in ends])
    return bool(np.ptp(places, axis=0).max() <= LAW_SAME_PLACE_M)


def _rows_of(given: Material, device: str, ends: tuple[str, ...]) -> NDArray[np.bool_]:
    """Return the rows [n] that a device takes part in."""
    return np.asarray(np.any([given.devices[end] == device for end in ends], axis=0))


@dataclass(frozen=True)
class Unit:
    """Another unit than metres: measured = ratio x true, plus a constant or not."""

    ratio: float
    meaning: str
    by: int
    offset: bool
    names: tuple[str, str]  # text and words of the factor
    choices: int
    form: str = "unit"
    fault: str = "unit"

    @property
    def free(self) -> int:
        """How many constants it fits."""
        return int(self.offset)

    @property
    def columns(self) -> tuple[str, ...]:
        """The true range."""
        return ("true_range_m",)

    @property
    def where(self) -> str:
        """Which device or category has the other unit, "" where all have."""
        return self.names[1]

    @property
    def expression(self) -> str:
        """Its expression."""
        body = "(ratio - 1) * true_range_m" + (" + b" if self.offset else "")
        return f"{self.names[0]} * ({body})" if self.by else body

    def fitted(self, given: Material) -> Fitted:
        """Return it with its constant fitted, if it has one."""
        constants: list[Named] = [("ratio", self.ratio, "1")]
        if not self.offset:
            return Fitted(tuple(constants), fixed(self._scaled(given), given.residual_m))
        mask = given.factors[self.by].weights[:, None]
        found = linear(mask, given.residual_m - self._scaled(given))
        constants.append(("b", float(found.values[0]), "m"))
        shift = self.shift_m(given, tuple(constants))
        return Fitted(tuple(constants), fixed(shift, given.residual_m))

    def _scaled(self, given: Material) -> Floats:
        return (self.ratio - 1) * given.true_range_m * given.factors[self.by].weights

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what it says of rows."""
        more = constants[1][1] if self.offset else 0.0
        return self._scaled(given) + more * given.factors[self.by].weights

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        who = f", where {self.names[1]}" if self.by else ""
        more = f", plus {shown['b']}" if self.offset else ""
        return f"{self.meaning} (measured = {self.ratio:.4g} x true range{more}){who}"


def units(given: Material) -> Iterator[Unit]:
    """Yield every confusion of units, of all rows and of every device or category."""
    groups = [(i, f) for i, f in enumerate(given.factors) if i == 0 or f.group]
    for by, factor in groups:
        if _off(given, factor):
            doubts = {offset: _slope_doubt(given, factor, offset) for offset in (False, True)}
            for ratio, meaning in LAW_RATIOS.items():
                for offset, doubt in doubts.items():
                    if not doubt < LAW_RATIO_DOUBT * abs(ratio - 1):
                        continue
                    names = (factor.text, factor.words)
                    count = 2 * len(LAW_RATIOS) * (len(groups) if by else 1)
                    yield Unit(ratio, meaning, by, offset, names, count)


def _slope_doubt(given: Material, factor: Factor, offset: bool) -> float:
    """Return the standard error of a free slope over links; infinite where it cannot be told.

    A slope that is known badly is a unit's by coincidence.
    """
    mine = factor.weights > 0
    far, error = (
        link_means(one[mine], given.links[mine]) for one in (given.true_range_m, given.residual_m)
    )
    design = np.column_stack([far, np.ones(len(far))] if offset else [far])
    spread = float(np.linalg.norm(far - far.mean() if offset else far))
    if len(far) <= design.shape[1] or not spread:
        return np.inf
    return linear(design, error).scale_m / spread


def _off(given: Material, factor: Factor) -> bool:
    """Return whether measured ranges of a group are far from true ones, as in another unit."""
    mine = factor.weights > 0
    size = np.abs(given.residual_m[mine]) / np.maximum(given.true_range_m[mine], 1e-9)
    least = min(abs(ratio - 1) for ratio in LAW_RATIOS) / 2
    return bool(mine.any() and np.median(size) > least)


def of_a_rate(structure: Structure, values: Sequence[float]) -> bool:
    """Return whether a law of such constants says that ranges are in a unit that nobody listed.

    In proportion to the true range and nothing beside it, by more than crystals and light can be
    off (see `LAW_OWN_RATE`, `LAW_EVERY_RATE`): of all rows, or of one device's.
    """
    own = structure.where.startswith(("tx is ", "rx is "))
    if structure.form != "linear" or structure.columns != ("true_range_m",) or len(values) > 1:
        return False
    least = LAW_OWN_RATE if own else LAW_EVERY_RATE
    return (own or not structure.where) and abs(values[0]) >= least
