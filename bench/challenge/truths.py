"""True parameters of hidden effects, in the terms of the effects that were named.

The generator has functional forms of its own, so the true values of library parameters are those
that bring the library's effects nearest to what was hidden, without noise (the pseudo-true values
of White 1982): least squares over all rows of the case. All that is rightly named is brought near
together, as it was fitted: where one cause changes another (a gain the level that a bias goes by),
what the forms cannot follow falls to whichever can.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from bench.challenge.alone import SAME_M, shift_of
from bench.challenge.cases import Case
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.bootstrap import latent_values
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.search import revalued
from bench.discrepancy.method import Diagnosis
from bench.discrepancy.select.verdict import Ambiguous, LeftOut
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.fitted.pattern_curve import PatternCurve
from bench.physics.effects.fitted.power_curve import PowerCurve
from bench.physics.simulator import Simulator

Floats = NDArray[np.float64]
RANDOM = ("blocked-path", "timestamp-jitter", "obstructed-path", "late-detection")
PASSES = 3  # over effects that are brought near together: few, so that what cannot be told apart (a
# constant of two) stays where each has it by itself
FIELDS: dict[type[Effect], str] = {
    DeviceClock: "offsets_ppm",
    DeviceDelay: "delays_ns",
    PatternCurve: "bias_m",
    PowerCurve: "bias_m",
}
DETERMINED = 0.5  # an interval wider than this share of the bounds says: not determined


@dataclass(frozen=True)
class Compared:
    """One parameter of a rightly named effect: covered by its 90 % interval, relative error."""

    name: str
    covered: bool
    error: float


def compared(case: Case, found: Diagnosis) -> list[Compared]:
    """Return every determined parameter of every rightly named effect beside its true value.

    Cases whose amplitudes were rescaled to equal the simulator's histogram have no true
    amplitude and give none; nor has what is drawn at random, or acts on the waveform.
    """
    if case.drawn.concealed == "aggregate":
        return []
    shifts = [(option, shift_of(case, option.names[0])) for option in _rightly_named(case, found)]
    able = [(o, shift) for o, shift in shifts if shift is not None and np.abs(shift).max() > 0]
    truths = true_values(_whole(case), [o for o, _ in able], [shift for _, shift in able])
    return [one for (o, _), truth in zip(able, truths, strict=True) for one in _beside(o, truth)]


def true_values(
    whole: View, options: Sequence[LeftOut], shifts_m: Sequence[Floats]
) -> list[dict[str, float]]:
    """Return the true value of every parameter by name, for effects that shift ranges so [n].

    First each by itself; then each by what the others leave of all shifts. What rounds is taken to
    do its shift, of which it has a mark alone.
    """
    made = [_truth(whole, o, shift) for o, shift in zip(options, shifts_m, strict=True)]
    free = [number for number, o in enumerate(options) if not type(o.effect).marked]
    for number in set(range(len(options))) - set(free):
        made[number] = made[number][0], shifts_m[number]
    for _ in range(PASSES if len(options) > 1 else 0):
        for number in free:
            others = [one for one in range(len(options)) if one != number]
            left = np.sum(shifts_m, axis=0) - sum(made[one][1] for one in others)
            made[number] = _truth(whole, options[number], left)
    return [values for values, _ in made]


def _rightly_named(case: Case, found: Diagnosis) -> list[LeftOut]:
    """Return every named effect that is hidden, but those of which each row draws anew."""
    firsts = [v.options[0] if isinstance(v, Ambiguous) else v for v in found.selection.verdicts]
    named = [one for one in firsts if isinstance(one, LeftOut)]
    return [v for v in named if v.names[0] in case.drawn.hidden and v.names[0] not in RANDOM]


def _whole(case: Case) -> View:
    """Return a view of every recorded row."""
    frame = case.recorded.frame
    rows = np.arange(len(frame))
    return view(frame, link_codes(frame), rows, Window(), ("error_m",), False)


def _truth(whole: View, option: LeftOut, shift_m: Floats) -> tuple[dict[str, float], Floats]:
    """Return the true value of every parameter by name, and the shift of such an effect [n]."""
    latent = latent_values(whole, option.effect)
    if latent is None:
        return _nearest(whole, option, shift_m)
    names, _, values = latent
    found = values(np.arange(len(shift_m)), shift_m, True)
    effect = _holding(whole, option.effect, found, shift_m)
    return dict(zip(names, found.tolist(), strict=True)), change_m(whole, effect)


def _holding(whole: View, effect: Effect, values: Floats, shift_m: Floats) -> Effect:
    """Return an effect with other values; those that no row tells are as those beside them."""
    if type(effect) not in FIELDS:
        return type(effect).fit_values(whole.frame, shift_m) or effect
    place, known = np.arange(len(values)), np.isfinite(values)
    whole_values = np.interp(place, place[known], values[known]) if known.any() else 0.0 * place
    plain: dict[str, tuple[float, ...]] = {
        one: () for one in ("knots_s", "wander_ppm", "gain_db") if hasattr(effect, one)
    }
    if hasattr(effect, "drifts_ppm_per_hour"):
        plain["drifts_ppm_per_hour"] = (0.0,) * len(values)
    return replace(effect, **{FIELDS[type(effect)]: tuple(whole_values.tolist())}, **plain)


def _nearest(whole: View, option: LeftOut, shift_m: Floats) -> tuple[dict[str, float], Floats]:
    """Return the determined parameters with which the effect is nearest to a shift, and its own.

    What leaves ranges as they are (a gain, a loss) has no truth in a shift of them. Where not all
    that moves ranges is determined, the effect can be anything, and is taken to do the shift.
    """
    bounds = {p.name: (p.low, p.high) for p in type(option.effect).parameters()}
    start = {p.name: p.value for p in option.parameters}

    def shifted(**values: float) -> Floats:
        return change_m(whole, revalued(option.effect, start | values))

    ends = [(p, shifted(**{p.name: p.low}), shifted(**{p.name: p.high})) for p in option.parameters]
    moving = [p for p, low, high in ends if np.abs(high - low).max() > SAME_M]
    free = [p for p in moving if determined(p, *bounds[p.name])]
    if not free:
        return {}, shift_m
    low, high = (np.array([bounds[p.name][i] for p in free]) for i in (0, 1))
    first = np.clip([p.value for p in free], low + 1e-9, high - 1e-9)

    def named(values: Floats) -> dict[str, float]:
        return {p.name: float(v) for p, v in zip(free, values, strict=True)}

    def left(values: Floats) -> Floats:
        return shifted(**named(values)) - shift_m

    made = least_squares(left, first, bounds=(low, high), x_scale=high - low)
    return named(made.x), shifted(**named(made.x)) if free == moving else shift_m


def change_m(whole: View, effect: Effect) -> Floats:
    """Return what an effect does to the range of every row, without noise [n], in metres."""
    ranges = []
    for effects in ((effect,), ()):
        made = Simulator(Base(), effects, 0).observe(whole.scene, 0, cir=False)
        assert made.range_m is not None
        ranges.append(np.asarray(made.range_m, np.float64))
    return np.asarray(ranges[0] - ranges[1])


def determined(item: ParameterEstimate, low: float, high: float) -> bool:
    """Return whether the recordings determine a parameter at all."""
    return not item.at_bound and item.high - item.low < DETERMINED * (high - low)


def _beside(option: LeftOut, truth: dict[str, float]) -> list[Compared]:
    """Return estimates beside the truth; errors relative to the rms of parameters of one kind."""
    known = [p for p in option.parameters if np.isfinite(truth.get(p.name, np.nan))]
    size: dict[str, list[float]] = {}
    for p in known:
        size.setdefault(p.name.split("[")[0], []).append(truth[p.name] ** 2)
    rms = {kind: max(float(np.sqrt(np.mean(values))), 1e-9) for kind, values in size.items()}
    return [
        Compared(
            p.name,
            bool(p.low <= truth[p.name] <= p.high),
            abs(p.value - truth[p.name]) / rms[p.name.split("[")[0]],
        )
        for p in known
    ]
