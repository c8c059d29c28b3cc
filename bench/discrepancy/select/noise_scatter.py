"""Scatter of ranges that a logged noise floor makes is no jitter.

An edge is timed the worse the more noise there is beside the signal: its standard deviation goes
with the square root of noise over signal (Kay 1993, section 3.11). Clocks scatter every range
alike. Where a receiver logs a noise that is louder than simulated, both are put to ranges.
"""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.logged import logs
from bench.discrepancy.select.scatter_alone import within
from bench.discrepancy.select.settings import EXTRA_SCATTER_M
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import versions
from bench.discrepancy.settings import LEAD_NATS, LEAST_SCATTER_M
from bench.physics.effect import Effect
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.units import Floats

NOTE = "it scatters as the noise does that is logged"


def beyond_noise(search: Search, added: Added, effect: Effect) -> Adequacy:
    """Return whether independent scatter is told from that which a logged noise floor makes.

    Of rows beside their link: that of clocks must be likelier by 3 nats than one whose variance
    goes with the noise that was not simulated over the signal.
    """
    asked = type(effect).independent and not type(effect).marked and search.work is not None
    if not asked or not any(isinstance(one, NoiseFloor) for one in search.logged):
        return Adequacy(True)
    assert search.work is not None
    made = versions(search.comparison, search.work, without(added, effect))
    if RANGE not in made.names:
        return Adequacy(True)
    left, simulated = within(made)
    louder = np.maximum(10 ** (logs(search, search.work).noise_db / 10) - 1, 0)
    noise = louder * 10 ** (-numeric(search.work.frame, LEVEL) / 10)
    known = np.isfinite(left) & np.isfinite(noise)
    if not noise[known].any():
        return Adequacy(True)
    own = max(float(np.nanmean(simulated**2)), LEAST_SCATTER_M**2)
    even, of_noise = (
        likeliest(left[known], own, one[known] / one[known].mean())
        for one in (np.ones(len(left)), noise)
    )
    return Adequacy(True) if even > of_noise + LEAD_NATS else Adequacy(False, 1.0, note=NOTE)


def likeliest(left_m: Floats, own_m2: float, goes: Floats) -> float:
    """Return the largest log likelihood of normal ranges [n] whose extra variance goes with [n]."""
    sizes_m = np.array([0.0, *np.geomspace(*EXTRA_SCATTER_M)])
    every = own_m2 + np.square(sizes_m)[:, None] * goes
    return float((-0.5 * (left_m**2 / every + np.log(every))).sum(axis=1).max())
