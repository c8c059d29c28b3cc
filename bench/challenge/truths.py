"""True parameters of hidden effects, in the terms of the effect that was named.

The generator has functional forms of its own, so the true value of a library parameter is the one
that brings the library's effect nearest to what was hidden, without noise (the pseudo-true value
of White 1982): least squares over all rows of the case.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from bench.challenge.alone import shift_of
from bench.challenge.cases import Case
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.fit.bootstrap import latent_values
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.search import revalued
from bench.discrepancy.select.verdict import Ambiguous, LeftOut
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.simulator import Simulator

Floats = NDArray[np.float64]
RANDOM = ("blocked-path", "timestamp-jitter", "obstructed-path", "late-detection")
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
    whole = _whole(case)
    out: list[Compared] = []
    for option in _rightly_named(case, found):
        shift = shift_of(case, option.names[0])
        if shift is not None and np.abs(shift).max() > 0:
            out += _beside(option, _truth(whole, option, shift))
    return out


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


def _truth(whole: View, option: LeftOut, shift: Floats) -> dict[str, float]:
    """Return the true value of every parameter by name."""
    latent = latent_values(whole, option.effect)
    if latent is not None:
        names, _, values = latent
        return dict(zip(names, values(np.arange(len(shift)), shift, True).tolist(), strict=True))
    return _nearest(whole, option, shift)


def _nearest(whole: View, option: LeftOut, shift: Floats) -> dict[str, float]:
    """Return the determined parameters with which the effect is nearest to the shift."""
    bounds = {p.name: (p.low, p.high) for p in type(option.effect).parameters()}
    own = [p for p in option.parameters if p.name in bounds]  # not what they do together
    free = [p for p in own if determined(p, *bounds[p.name])]
    if not free:
        return {}
    start = {p.name: p.value for p in own}
    low, high = (np.array([bounds[p.name][i] for p in free]) for i in (0, 1))
    first = np.clip([p.value for p in free], low + 1e-9, high - 1e-9)

    def left(values: Floats) -> Floats:
        now = start | {p.name: float(v) for p, v in zip(free, values, strict=True)}
        return change_m(whole, revalued(option.effect, now)) - shift

    made = least_squares(left, first, bounds=(low, high), x_scale=high - low)
    return {p.name: float(v) for p, v in zip(free, made.x, strict=True)}


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
