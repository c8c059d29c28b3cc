"""Effect 8: a weak straight path stays under the detection threshold."""

from __future__ import annotations

from dataclasses import dataclass

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.units import amplitude


@dataclass(frozen=True)
class LateDetection(Effect):
    """Raises the first-path threshold, so that the first edge above it may come too late.

    The threshold becomes `rise_db` above the base's multiple of the noise, and at least
    `peak_fraction` of the strongest sample; no edge is timed below that fraction, so that one of
    the strongest path is late by some of its own rise too (Guvenc and Sahinoglu 2005: thresholds
    relative to the peak). Rows simulated without a waveform take the first path above the raised
    threshold.
    """

    name = "late-detection"
    number = 8
    stage = "receiver"
    stackable = True
    source = "DW1000 User Manual 2.11, 7.2.47 (LDE_CFG1: NTM, PMULT); APS006 part 1"
    signature = "positive, jumps from frame to frame; energy before the detected first path"
    jumps = True

    rise_db: float = parameter(0, "dB", -6, 40, "of the threshold over the base's", null=0)
    peak_fraction: float = parameter(0, "ratio", 0, 0.9, "threshold over the highest peak", null=0)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Raise the threshold of every row."""
        if batch.threshold is None:
            return batch
        threshold = batch.threshold * amplitude(self.rise_db)
        fraction = max(batch.peak_fraction, self.peak_fraction)
        return altered(batch, threshold=threshold, peak_fraction=fraction)
