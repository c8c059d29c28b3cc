"""Effect 15: small-scale fading of every path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import polygamma

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.units import Reals, amplitude

DB_PER_NEPER = 10 / np.log(10)  # of power
NO_FADING = 1000  # m, from which on nothing fades


@dataclass(frozen=True)
class SmallScaleFading(Effect):
    """Multiplies the power of paths and taps by Gamma(m, 1/m): Nakagami-m amplitudes of mean one.

    `direct_m` for the straight path, `path_m` for all other paths, `tail_m` for tail taps (which
    are Rayleigh, m = 1, before). Large m: no fading. Where fades take more than peaks give, the
    straight path is weaker on average too, by `deeper` times the std of its level in dB.
    """

    name = "small-scale-fading"
    number = 15
    stage = "propagation"
    stackable = True
    source = "Molisch et al., IEEE 802.15.4a channel model final report (2004), section 2.5"
    signature = "spread of each tap's amplitude from row to row; mean profile unchanged"
    essential_with_cir = ("direct_m",)  # reflections that fade alone are another form of these
    essential_on_paths = ("direct_m",)  # what is weaker and does not scatter has not faded
    by_rows = True
    jumps = True  # a weak pulse crosses a threshold later, or not at all
    on_tables = False  # fading sample by sample would tear a recorded pulse apart

    direct_m: float = parameter(100, "1", 0.5, 1000, "Nakagami m of the straight path", null=1000)
    path_m: float = parameter(3, "1", 0.5, 1000, "of reflected and diffracted paths", null=1000)
    tail_m: float = parameter(1000, "1", 0.5, 1000, "of tail taps, on top of Rayleigh", null=1000)
    deeper: float = parameter(0, "std", 0, 3, "mean loss of the straight path, over its scatter")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Draw every path's and tap's power anew."""
        straight = _faded(draws, self.direct_m, (len(batch), 1))
        straight = straight * np.float32(amplitude(-self.deeper * scatter_db(self.direct_m)))
        other = _faded(draws, self.path_m, batch.gain.shape)
        gain = batch.gain * np.where(batch.direct, straight, other)
        steady = self.tail_m >= NO_FADING
        tail = batch.tail if steady else batch.tail * _faded(draws, self.tail_m, batch.tail.shape)
        return altered(batch, gain=gain, tail=tail)


def scatter_db(m: float) -> float:
    """Return the std in dB of a power that is Gamma(m, 1/m); 0 from m = 1000 on."""
    return 0.0 if m >= NO_FADING else float(DB_PER_NEPER * np.sqrt(polygamma(1, m)))


def _faded(draws: Draws, m: float, shape: tuple[int, ...]) -> Reals:
    """Return amplitudes whose squares are Gamma(m, 1/m); ones from m = 1000 on."""
    if m >= NO_FADING or 0 in shape:
        return np.ones(shape, np.float32)
    power = draws.gamma(m, *shape) / np.float32(m)
    return np.asarray(np.sqrt(power), np.float32)
