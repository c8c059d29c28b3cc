"""Names of which recordings determine no size, tell none from zero, or next to nothing, or less."""

from __future__ import annotations

from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.settings import LEAST_ADDED_DB
from bench.discrepancy.select.verdict import LeftOut
from bench.physics.effect import Effect


def untold(option: LeftOut) -> bool:
    """Return whether nothing of an effect is told from zero: no value, nor its gain.

    What bears a mark of its own needs neither.
    """
    if type(option.effect).marked or option.gain.likely_above_zero:
        return False
    sizes = _sizes(option)
    return bool(sizes) and not any(_told(*one) for one in sizes)


def hardly_more(option: LeftOut, rounded: bool = False) -> str:
    """Return in words that hardly more of something is recorded than simulated, "" where much is.

    Nor anything else of it is told from zero, as the colour of noise may be: not where samples are
    `rounded`, which has a colour of its own.
    """
    adds, sizes = type(option.effect).adds, _sizes(option)
    added = [(one, null) for one, null in sizes if one.name == adds]
    others = () if rounded else (one for one in sizes if one not in added)
    if not added or any(_told(*one) for one in others):
        return ""
    one, null = added[0]
    if not 0 <= one.value - null < LEAST_ADDED_DB:
        return ""
    return f"{one.value - null:.1g} {one.unit} more is what rounding, spurs or a formula make"


def taken_away(effect: Effect) -> str:
    """Return in words that less is recorded than simulated of what an effect can only add, or "".

    Noise is added by every part of a receiver; less of it than simulated says that the simulator
    has too much, or that something takes small samples away: a threshold, a mean taken off.
    """
    added = next((p for p in effect.parameters() if p.name == type(effect).adds), None)
    if added is None or getattr(effect, added.name) >= (added.null or 0.0):
        return ""
    value = f"{-getattr(effect, added.name):.2g} {added.unit}"
    return (
        f"less is recorded than simulated, by {value}: the simulator has too much of it, or "
        "something takes small samples away"
    )


def _sizes(option: LeftOut) -> list[tuple[ParameterEstimate, float]]:
    """Return the parameters of an effect that have a value at which it does nothing, with that."""
    known = {p.name: p.null for p in option.effect.parameters()}
    nulls = [(one, known.get(one.name, 0.0)) for one in option.parameters]
    return [(one, null) for one, null in nulls if null is not None]


def _told(one: ParameterEstimate, null: float) -> bool:
    return one.determined and not one.low <= null <= one.high


def undetermined(option: LeftOut) -> bool:
    """Return whether recordings leave every size of an effect anywhere within its bounds.

    Whatever it gains, something else would gain as much: a level that is off everywhere, say.
    """
    known = {p.name: p.null for p in option.effect.parameters()}
    sizes = [one for one in option.parameters if known.get(one.name) is not None]
    together = [one for one in option.parameters if one.name not in known]  # a step per wall
    return bool(sizes) and not any(one.determined for one in (*sizes, *together))
