"""Effect 18: the receiver holds its level: gain control and early end of accumulation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.effects.fitted.device_values import as_tuples
from bench.physics.own_noise import with_own_noise
from bench.physics.randomness import Draws
from bench.physics.units import Floats, amplitude, scaled, squared

SEEN_SHARES = (1.0, 0.5, 0.0)  # of an attenuation, that samples may show [convention]


@dataclass(frozen=True)
class LevelControl(Effect):
    """Strong signals are attenuated and accumulated for fewer symbols; the peak stays near 18 000.

    The reported level over the true one follows the DW1000 User Manual's figure for 64 MHz PRF
    (-60 dBm reads -77.5), and no peak exceeds `peak_counts`. The share of symbols accumulated
    follows recorded accumulators (28 % above -80 dBm reported, all of them below -92). `in_samples`
    of the attenuation in dB is seen in the samples too (a gain that is turned down); the rest is in
    the reported level alone (an estimate that saturates). A receiver with a curve of its own turns
    down by `curve_db` at `curve_dbm` (less `shift_db`), linear between and level beyond.
    """

    name = "level-control"
    number = 18
    stage = "receiver"
    stackable = True
    source = "DW1000 User Manual 2.11, figure 22; counts measured on Zenodo 10.5281/zenodo.4742391"
    signature = "reported level flattens near -78 dBm as the distance falls; the count falls too"
    needs = (("preamble_count",),)  # a level alone is shifted by many things
    essential_with_cir = ("accumulation",)
    own_curve = True
    held = ("curve_dbm", "curve_db")

    compression: float = parameter(1, "ratio", 0, 1.5, "of the deviation in dB", null=0)
    accumulation: float = parameter(1, "ratio", 0, 1.2, "of the measured fall of the count", null=0)
    peak_counts: float = parameter(20000, "counts", 1000, 1e9, "highest peak let through", null=1e9)
    shift_db: float = parameter(0, "dB", -20, 20, "the true level at which both curves start")
    in_samples: float = parameter(1, "ratio", 0, 1, "of the attenuation in dB, that samples show")
    curve_dbm: tuple[float, ...] = ()
    curve_db: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        as_tuples(self, curve_dbm=None, curve_db=len(self.curve_dbm))

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Attenuate signals and shorten the accumulation of every row."""
        if batch.symbols is None or batch.nominal_symbols is None:
            return batch
        level = batch.level() - self.shift_db
        read = level - self.compression * self._deviation_db(level)
        share = 1 - self.accumulation * (1 - accumulated_share(read))
        symbols = np.maximum(np.rint(batch.nominal_symbols * np.clip(share, 0.05, 1)), 1.0)
        longer = symbols / batch.symbols
        power = None if batch.noise_power is None else batch.noise_power * longer
        made = altered(batch, symbols=symbols, agc_db=read - level, noise_power=power)
        if batch.waveform is None or batch.noise is None:
            return made
        if batch.peak_held:  # samples show nothing of a gain
            return made.told_louder(read - level)
        seen_db, told_db = np.multiply.outer([self.in_samples, 1 - self.in_samples], read - level)
        made = altered(made, reported_db=told_db if self.in_samples < 1 else batch.reported_db)
        signal = (longer * amplitude(seen_db)).astype(np.float32)
        peak = np.sqrt(np.max(squared(batch.waveform), axis=1)) * signal
        signal *= np.minimum(1, np.float32(self.peak_counts) / np.maximum(peak, 1e-9))
        noise = scaled(batch.noise, np.sqrt(longer).astype(np.float32))
        waveform = scaled(batch.waveform, signal)
        if batch.as_given and power is not None:  # noise is in a table's samples: no gain moves it
            drawn = draws.complex_normal(*waveform.shape)
            first = batch.rows.number("first_path_index", np.nan)
            waveform = with_own_noise(waveform, signal / np.sqrt(longer), power, drawn, first)
        return altered(made, waveform=waveform, noise=noise)

    def _deviation_db(self, level_dbm: Floats) -> Floats:
        """Return by how many dB the level that is read falls behind the true one [n]."""
        if self.curve_dbm:
            return np.interp(level_dbm, self.curve_dbm, self.curve_db)
        return np.asarray(level_dbm - reported_dbm(level_dbm))

    def forms(self) -> tuple[Effect, ...]:
        """Return it as seen in the samples, in half, and in the reported level alone."""
        shares = dict.fromkeys((self.in_samples, *SEEN_SHARES))
        return tuple(replace(self, in_samples=share) for share in shares)


def reported_dbm(true_dbm: Floats) -> Floats:
    """Return the level the chip reports for a true receive level, both in dBm."""
    true = [-90.0, -86.5, -83.5, -80.0, -72.5, -60.0]
    read = [-90.0, -87.5, -85.0, -82.5, -80.0, -77.5]
    inside = np.interp(true_dbm, true, read)
    weak = np.minimum(np.asarray(true_dbm) - true[0], 0)
    return np.asarray(inside + weak + 0.2 * np.maximum(np.asarray(true_dbm) - true[-1], 0))


def accumulated_share(reported: Floats) -> Floats:
    """Return the share of the preamble's symbols accumulated at a reported level in dBm."""
    level = [-92.5, -88.5, -85.5, -83.0, -81.0, -79.0]
    count = [1.0, 754 / 1024, 639 / 1024, 539 / 1024, 352 / 1024, 280 / 1024]
    return np.asarray(np.interp(reported, level, count))
