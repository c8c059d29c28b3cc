"""Names of which recordings determine no size, or tell none from zero."""

from __future__ import annotations

from bench.discrepancy.select.verdict import LeftOut


def untold(option: LeftOut) -> bool:
    """Return whether nothing of an effect is told from zero: no value, nor its gain.

    What bears a mark of its own needs neither.
    """
    if type(option.effect).marked or option.gain.likely_above_zero:
        return False
    known = {p.name: p.null for p in option.effect.parameters()}
    nulls = [(one, known.get(one.name, 0.0)) for one in option.parameters]
    sizes = [(one, null) for one, null in nulls if null is not None]
    return bool(sizes) and not any(
        one.determined and not one.low <= null <= one.high for one, null in sizes
    )


def undetermined(option: LeftOut) -> bool:
    """Return whether recordings leave every size of an effect anywhere within its bounds.

    Whatever it gains, something else would gain as much: a level that is off everywhere, say.
    """
    known = {p.name: p.null for p in option.effect.parameters()}
    sizes = [one for one in option.parameters if known.get(one.name) is not None]
    together = [one for one in option.parameters if one.name not in known]  # a step per wall
    return bool(sizes) and not any(one.determined for one in (*sizes, *together))
