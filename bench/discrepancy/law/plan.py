"""A whole plan that is turned, stretched or aslant: what a survey or a drawing does to all places.

Ranges tell of one end against the other: anchors that are turned about a point and tags that are
turned back read the same. What both ends have in common turns and shifts nothing, but a drawing
that is stretched or aslant is so for all that was measured on it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.discrepancy.law.forms import Named
from bench.discrepancy.law.likelihood import iterated
from bench.discrepancy.law.material import Floats, Material
from bench.discrepancy.law.settings import (
    LAW_FLAT_PLAN,
    LAW_PLAN_PLACES,
    LAW_SAME_PLACE_M,
    MIRRORED,
)
from bench.discrepancy.law.structures import Fitted
from bench.discrepancy.law.swaps import FAR_END
from bench.physics.formula.units import factor_of

PLAN = "plan"
TURN, STRETCH_X, STRETCH_Y, SLANT_X, SLANT_Y = "turn", "sx", "sy", "kx", "ky"
OF_ONE = (
    (TURN,), (STRETCH_X,), (STRETCH_Y,), (SLANT_X,), (SLANT_Y,), (STRETCH_X, STRETCH_Y),
    (STRETCH_X, SLANT_Y), (STRETCH_Y, SLANT_X), (STRETCH_X, STRETCH_Y, SLANT_X, SLANT_Y),
)  # fmt: skip
OF_BOTH = ((STRETCH_X,), (STRETCH_Y,), (SLANT_X,), (SLANT_Y,))  # along both axes it is a scale
UNITS = {TURN: "deg", **dict.fromkeys((STRETCH_X, STRETCH_Y, SLANT_X, SLANT_Y), "%")}
UNITS |= dict.fromkeys(("dx", "dy"), "m")
WORDS = {
    TURN: "turned by {} against that of {far}, from x toward y",
    STRETCH_X: "stretched along x by {}",
    STRETCH_Y: "stretched along y by {}",
    SLANT_X: "aslant, x by {} of y",
    SLANT_Y: "aslant, y by {} of x",
}


@dataclass(frozen=True)
class Plan:
    """True positions of `ends` are those of the plan, turned or stretched by `parts`.

    About `middle` in metres; of one end alone it is moved, too, by `dx` and `dy`.
    """

    ends: tuple[str, ...]
    parts: tuple[str, ...]
    middle: tuple[float, float]
    known: str
    choices: int
    form: str = PLAN
    fault: str = PLAN
    where: str = ""

    @property
    def of_one(self) -> bool:
        """Whether the places of one end alone are off."""
        return len(self.ends) == 1

    @property
    def free(self) -> int:
        """How many constants it fits."""
        return len(self.parts) + 2 * self.of_one

    @property
    def columns(self) -> tuple[str, ...]:
        """The positions' columns."""
        return tuple(f"{end}_{axis}_m" for end in self.ends for axis in "xy")

    @property
    def expression(self) -> str:
        """The true distance with the places as they are, minus that of the plan."""
        end, far = self.ends[0], FAR_END[self.ends[0]]
        if self.of_one:
            x, y = self._moved(f"({end}_x_m - cx)", f"({end}_y_m - cy)")
            gaps = [f"cx + dx + {x} - {far}_x_m", f"cy + dy + {y} - {far}_y_m"]
        else:
            gaps = list(self._moved(f"({end}_x_m - {far}_x_m)", f"({end}_y_m - {far}_y_m)"))
        gaps += [f"{end}_z_m - {far}_z_m"] if "z" in self.known else []
        return f"sqrt({' + '.join(f'({gap}) ** 2' for gap in gaps)}) - true_range_m"

    def _moved(self, x: str, y: str) -> tuple[str, str]:
        """Return the expressions of two coordinates, turned or stretched."""
        if TURN in self.parts:
            return f"{x} * cos(turn) - {y} * sin(turn)", f"{x} * sin(turn) + {y} * cos(turn)"
        own = {part: f" + {part} * " for part in self.parts}
        more = [
            "".join(own[part] + what for part, what in some if part in own)
            for some in (((STRETCH_X, x), (SLANT_X, y)), ((STRETCH_Y, y), (SLANT_Y, x)))
        ]
        return f"{x}{more[0]}", f"{y}{more[1]}"

    def fitted(self, given: Material) -> Fitted:
        """Return it with its constants, by reweighted Gauss-Newton steps."""
        fit = iterated(lambda v: self._longer(given, v), np.zeros(self.free), given.residual_m)
        names = (*self.parts, *(("dx", "dy") if self.of_one else ()))
        found = [
            (n, float(v) / factor_of(UNITS[n]), UNITS[n])
            for n, v in zip(names, fit.values, strict=True)
        ]
        about = [(n, c, "m") for n, c in zip(("cx", "cy"), self.middle, strict=True)]
        return Fitted((*found, *(about if self.of_one else ())), fit)

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what it says of other rows."""
        return self._longer(given, self._values(constants))[0]

    def slopes(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what more of each constant does to rows [n, free]."""
        return self._longer(given, self._values(constants))[1]

    def _values(self, constants: tuple[Named, ...]) -> Floats:
        return np.array([value * factor_of(unit) for _, value, unit in constants[: self.free]])

    def _longer(self, given: Material, values: Floats) -> tuple[Floats, Floats]:
        """Return what ranges gain [n] and its slopes [n, free]."""
        end = self.ends[0]
        near, far = (given.ends[one] for one in (end, FAR_END[end]))
        from_m = near[:, :2] - (self.middle if self.of_one else far[:, :2])
        moved, ways = _turned(from_m, self.parts, values)
        gap = near - far
        gap[:, :2] += moved - from_m
        if self.of_one:
            gap[:, :2] += values[-2:]
            ways += [np.broadcast_to(axis, from_m.shape) for axis in np.eye(2)]
        away = np.maximum(np.linalg.norm(gap, axis=1), 1e-9)
        slopes = np.stack([(gap[:, :2] * way).sum(axis=1) / away for way in ways], axis=1)
        return away - given.true_range_m, slopes

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        end = self.ends[0]
        what = f"of every {end}" if self.of_one else "of both ends"
        said = [_said(part, shown[part], f"every {FAR_END[end]}") for part in self.parts]
        plan = f"the plan {what} is {' and '.join(said)}"
        if not self.of_one:
            return plan
        about = f"about x = {shown['cx']}, y = {shown['cy']}"
        return f"{plan} {about}, and moved by {shown['dx']} along x, {shown['dy']} along y"


def _turned(from_m: Floats, parts: tuple[str, ...], values: Floats) -> tuple[Floats, list[Floats]]:
    """Return places [n, 2] about a middle as they are, and how they go with each part."""
    x, y = from_m.T
    if TURN in parts:
        cos, sin = np.cos(values[0]), np.sin(values[0])
        moved = np.stack([x * cos - y * sin, x * sin + y * cos], axis=1)
        return moved, [np.stack([-moved[:, 1], moved[:, 0]], axis=1)]
    none = np.zeros(len(x))
    way = {STRETCH_X: (x, none), STRETCH_Y: (none, y), SLANT_X: (y, none), SLANT_Y: (none, x)}
    ways = [np.stack(way[part], axis=1) for part in parts]
    return from_m + sum(v * w for v, w in zip(values, ways, strict=False)), ways


def plans(given: Material) -> Iterator[Plan]:
    """Yield every plan that may be off: of an end whose places lie in a plane, or of both."""
    flat = [end for end in FAR_END if end in given.ends and _wide(given.ends[end][:, :2])]
    if set(given.ends) != set(FAR_END) or "x" not in given.axes or "y" not in given.axes:
        return
    count = 2 * len(OF_ONE) + len(OF_BOTH)
    for end in flat:
        places = np.unique(given.ends[end][:, :2], axis=0)
        middle = tuple(float(v) for v in np.round(places.mean(axis=0), 1))
        for parts in OF_ONE:
            if parts != (TURN,) or end == flat[-1]:
                yield Plan((end,), parts, (middle[0], middle[1]), given.axes, count)
    if len(flat) == len(FAR_END):
        yield from (Plan(("rx", "tx"), parts, (0.0, 0.0), given.axes, count) for parts in OF_BOTH)


def _wide(places_m: Floats) -> bool:
    """Return whether places [n, 2] are several and not all on a line."""
    places = np.unique(np.round(places_m / LAW_SAME_PLACE_M), axis=0)
    if len(places) < LAW_PLAN_PLACES:
        return False
    sizes = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    return bool(sizes[-1] > LAW_FLAT_PLAN * sizes[0])


def _said(part: str, shown: str, far: str) -> str:
    """Return what is done to a plan, in words: what is stretched past zero is mirrored."""
    words = WORDS[part].format(shown, far=far)
    mirrored = part in (STRETCH_X, STRETCH_Y) and float(shown.split()[0].rstrip("%")) < MIRRORED
    return f"mirrored ({words})" if mirrored else words
