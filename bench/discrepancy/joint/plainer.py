"""Sets without the amplitudes that they do not need.

A fit follows means and scatter, and takes another form of an effect for scatter where that is at
hand: a path loss of two slopes for one slope and shadowing. The evidence, which lets forms differ,
tells whether it is needed (automatic Occam's razor: MacKay 1992).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from bench.discrepancy.compare.view import Added
from bench.discrepancy.fit.starts import free_parameters
from bench.discrepancy.joint.polish import Fit, fitted, in_rounds
from bench.discrepancy.joint.settings import NAME_NATS, NAME_SHARE, PASSES, STEPS
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.select.verdict import LeftOut
from bench.physics.effect import Effect
from bench.physics.effects.fitted.pattern_gain import PatternGain

Off = frozenset[tuple[int, str]]  # places of effects, and their parameters that do nothing


def plainer(given: Statistics, fit: Fit, evidence: Callable[[Fit], float]) -> Fit:
    """Return a set with all but its members' first amplitudes off, as far as `evidence` grows.

    What stays is fitted again, as it was fitted beside what is off now, and may need fewer then.
    """
    best, off = fit, Off()
    for _ in range(PASSES):
        fewer, now = _fewer(given, best, off, evidence)
        if now == off:
            break
        again = in_rounds(given, fewer, STEPS, _places(fewer.effects, now))
        best, off = replace(again, off=len(now)), now
    return best


def _fewer(
    given: Statistics, fit: Fit, off: Off, evidence: Callable[[Fit], float]
) -> tuple[Fit, Off]:
    """Return a set with more amplitudes off, one after the other, and which are."""
    best = fit
    for place, effect in enumerate(fit.effects):
        for item in [p for p in free_parameters(type(effect)) if p.null is not None][1:]:
            if (place, item.name) in off:
                continue
            other = replace(best.effects[place], **{item.name: item.null})
            made = fitted(given, _with(best.effects, place, other))
            made = made and replace(made, off=len(off) + 1)
            if made and evidence(made) > evidence(best):
                best, off = made, off | {(place, item.name)}
    return best, off


def _places(effects: Added, off: Off) -> list[int]:
    """Return where parameters, by the places of their effects and their names, stand among all."""
    free = [(at, p.name) for at, e in enumerate(effects) for p in free_parameters(type(e))]
    return [place for place, one in enumerate(free) if one in off]


def flat_gain(given: Statistics, fit: Fit, rest: Fit, evidence: Callable[[Fit], float]) -> bool:
    """Return whether what a set has beside its `rest` is a gain over the heading but for its waves.

    Its mean alone is so many decibels everywhere, which no table tells, and no pattern. Waves must
    bring what a name must, also as a share of what the gain does.
    """
    gains = [e for e in fit.effects if isinstance(e, PatternGain) and e.name not in rest.names]
    if not gains:
        return False
    flat = PatternGain(mean_db=gains[0].mean_db)
    made = fitted(given, _with(fit.effects, fit.effects.index(gains[0]), flat))
    least = max(NAME_NATS, NAME_SHARE * (evidence(fit) - evidence(rest)))
    return made is not None and evidence(fit) - evidence(made) < least


def without_waves(option: LeftOut) -> str:
    """Return in words that no wave of a gain over the heading is told from zero, "" else.

    What does as well as another cause by its mean alone is no pattern.
    """
    if not isinstance(option.effect, PatternGain):
        return ""
    waves = (one for one in option.parameters if one.name != "mean_db")
    told = any(one.determined and not one.low <= 0 <= one.high for one in waves)
    return "" if told else "none of its waves is told from zero"


def _with(effects: Added, place: int, other: Effect) -> Added:
    return (*effects[:place], other, *effects[place + 1 :])
