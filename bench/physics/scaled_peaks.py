"""CIRs that another simulator, or whoever stored them, scaled to one height.

Their samples then say nothing of the level: what makes a signal weaker leaves their peaks alone.
The noise beside them tells when they were scaled: after it was added, where it grows as levels
fall.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.base import there
from bench.physics.batch import Batch, altered
from bench.physics.units import Floats, absolute

ALIKE = 0.02  # standard deviation of peaks over their mean, up to which they were scaled
VARIED_DB = 1.0  # standard deviation of levels from which peaks would differ
FOLLOWS = -0.5  # dB of noise a dB of level, from where on it was there before


@dataclass(frozen=True)
class ScaledPeaks:
    """How the CIRs of a table were scaled: not at all, or to one peak (`held`).

    `with_noise`: the receiver's noise along with them.
    """

    held: bool = False
    with_noise: bool = False

    @classmethod
    def of(cls, peaks: Floats, level_dbm: Floats, noise: Floats) -> ScaledPeaks:
        """Return what peaks [n] (counts), levels [n] and noise [n] (counts) of a table say."""
        known = np.isfinite(level_dbm)
        if known.sum() < 2 or np.std(level_dbm[known]) < VARIED_DB:
            return cls()
        if np.std(peaks) > ALIKE * np.mean(peaks):
            return cls()
        known &= np.isfinite(noise) & (noise > 0)
        if known.sum() < 2:
            return cls(True)
        slope = np.polyfit(level_dbm[known], 20 * np.log10(noise[known]), 1)[0]
        return cls(True, bool(slope < FOLLOWS))

    def again(self, batch: Batch, peaks: Floats) -> Batch:
        """Return a received batch with peaks as high as they were (`peaks` [n] in counts).

        Levels are reported as they arrive: whoever scales samples has read them before.
        """
        waveform = there(batch.waveform)
        now = absolute(waveform).max(axis=1)
        ratio = np.divide(peaks, now, out=np.ones(len(now)), where=now > 0)
        ratio = np.where(np.abs(ratio - 1) < 1e-6, 1.0, ratio)  # nothing was changed
        power = there(batch.noise_power) * (ratio**2 if self.with_noise else 1.0)
        scaled = waveform * ratio.astype(np.float32)[:, None]
        held = altered(batch, waveform=scaled, noise_power=power, peak_held=True)
        return held.told_louder(-20 * np.log10(ratio))
