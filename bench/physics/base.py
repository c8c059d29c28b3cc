"""The base of every simulator: straight line, free space, pulse, sampling, noise, detection.

Sources: Friis for the link budget, -41.3 dBm/MHz over 500 MHz for the transmit level (ETSI EN 302
065), the DW1000 User Manual 4.7 for the powers the chip reports, detection in
`bench.physics.detection`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.special import ive

from bench.errors import BenchError
from bench.physics.batch import DIRECT, NO_PATH, Batch, altered
from bench.physics.detection import HALF, crossed_level, edge_offset, first_path
from bench.physics.effect import check_bounds, parameter
from bench.physics.loops import compiled, crop_rows, magnitude_rows, parts
from bench.physics.randomness import Draws
from bench.physics.sampling import sampled
from bench.physics.scene import Scene
from bench.physics.units import (
    C_M_PER_NS,
    CENTRE_GHZ,
    POWER_OFFSET_DB,
    Complexes,
    Floats,
    Reals,
    amplitude,
    decibel,
    scaled,
    wavelength_m,
)

T = TypeVar("T", bound=np.generic)
F = TypeVar("F", float, Floats)
LEAD_SAMPLES = 16  # simulated before the straight path, so that an early edge can be found
LATE_SAMPLES = 36  # after it, so that an edge 10 m late still has its whole CIR
RAYLEIGH_STD = float(np.sqrt(2 - np.pi / 2))  # std of |n| per std of its real part


def power_of_noise(std: F) -> F:
    """Return mean |noise|^2 of complex noise whose magnitudes have a standard deviation `std`."""
    return 2 * (std / RAYLEIGH_STD) ** 2


@dataclass(frozen=True)
class Base:
    """Geometry, free-space link budget, pulse, sampling, noise, first-path detection, ranging.

    `channel` and `prf_mhz` are DW1000 settings (channel 9: DW3000). `keep_count`: 1 uses each row's
    recorded `preamble_count` where known, 0 always accumulates `preamble_symbols`.
    """

    channel: int = parameter(2, "channel", 1, 9, "1, 2, 3, 4, 5, 7 or 9 (DW3000)")
    prf_mhz: int = parameter(64, "MHz", 16, 64, "pulse repetition: 16 or 64")
    tx_power_dbm: float = parameter(-14.3, "dBm", -50, 10, "radiated, where rows do not tell")
    preamble_symbols: float = parameter(1024, "symbols", 16, 4096, "accumulated without AGC")
    keep_count: int = parameter(1, "0 or 1", 0, 1, "take preamble_count from the rows")
    noise_per_symbol: float = parameter(4.5, "counts", 0.01, 100, "std of |noise| of one symbol")
    threshold: float = parameter(12.5, "noise std", 2, 60, "first-path threshold (NTM)")
    pulse_fwhm: float = parameter(2.5, "samples", 1.2, 5.0, "pulse width at half magnitude")
    sample_period_ns: float = parameter(1.0016, "ns", 0.25, 4, "accumulator sample period")
    cir_samples: int = parameter(157, "samples", 8, 1024, "CIR values per row")
    cir_lead: int = parameter(5, "samples", 0, 1000, "of them before the detected first path")

    def __post_init__(self) -> None:
        check_bounds("base", self)
        if self.channel not in CENTRE_GHZ or self.prf_mhz not in POWER_OFFSET_DB:
            raise BenchError("base: channel must be 1, 2, 3, 4, 5, 7 or 9 and prf_mhz 16 or 64")

    @property
    def samples(self) -> int:
        """How many samples are simulated per row."""
        return max(LEAD_SAMPLES, self.cir_lead + 8) + self.cir_samples + LATE_SAMPLES

    @property
    def power_offset_db(self) -> float:
        """The manual's constant A."""
        return POWER_OFFSET_DB[self.prf_mhz]

    def paths(self, rows: Scene) -> Batch:
        """Return a batch with the straight path alone: Friis loss, carrier phase."""
        centre = CENTRE_GHZ[self.channel]
        turns = rows.true_range_m / wavelength_m(centre)
        loss = decibel((4 * np.pi * turns) ** 2)
        gain = amplitude(rows.number("tx_power_dbm", self.tx_power_dbm) - loss) * np.exp(
            -2j * np.pi * (turns % 1.0)
        )
        one = (len(rows), 1)
        return Batch(
            rows=rows,
            centre_ghz=centre,
            sample_period_ns=self.sample_period_ns,
            excess_ns=np.zeros(one, np.float32),
            gain=gain.astype(np.complex64)[:, None],
            free_gain=gain.astype(np.complex64),
            kind=np.full(one, DIRECT, np.int8),
            tail=np.zeros((len(rows), 0), np.complex64),
            tail_start_ns=np.zeros(len(rows), np.float32),
        )

    def counted(self, batch: Batch) -> Batch:
        """Return the batch with count, true level, noise power and threshold, but no waveform."""
        nominal = batch.rows.number("preamble_symbols", float(self.preamble_symbols))
        recorded = batch.rows.number("preamble_count", np.nan)
        kept = np.isfinite(recorded) & bool(self.keep_count)
        symbols = np.where(kept, recorded, nominal)
        return altered(
            batch,
            symbols=symbols,
            nominal_symbols=nominal,
            level_dbm=batch.path_power_dbm(),
            noise_power=self.noise_power(symbols),
            threshold=np.full(len(batch), float(self.threshold)),
        )

    def received(self, batch: Batch, draws: Draws) -> Batch:
        """Return the batch with waveform and white noise, in counts, at a random alignment."""
        batch = self.counted(batch)
        lead = max(LEAD_SAMPLES, self.cir_lead + 8)
        start = -(lead + draws.uniform(len(batch))) * np.float32(self.sample_period_ns)
        per_root_mw = amplitude(self.power_offset_db) * there(batch.symbols)
        signal = sampled(batch, start, self.samples, self.pulse_fwhm)
        scaled(signal, per_root_mw.astype(np.float32), signal)
        noise = draws.complex_normal(len(batch), self.samples)
        scaled(noise, np.sqrt(there(batch.noise_power)).astype(np.float32), noise)
        return altered(batch, waveform=signal, noise=noise, start_ns=start)

    def noise_power(self, symbols: Floats) -> Floats:
        """Return mean |noise|^2 [n] in counts^2; the noise grows as the root of the count."""
        return power_of_noise(self.noise_per_symbol) * symbols

    def detected(self, batch: Batch) -> Batch:
        """Return the batch with first path, range and what the chip reports."""
        if batch.waveform is None or batch.noise is None or batch.start_ns is None:
            return self._detected_paths(batch)
        magnitude, energy, highest, noise_std, noise_power = _measured(batch)
        # The threshold follows the noise's power: a tone in it raises it too.
        noise_level = RAYLEIGH_STD * np.sqrt(noise_power / 2)
        threshold = there(batch.threshold) * np.maximum(noise_level, 1e-9)
        timed = batch.peak_fraction * highest
        limit, part = np.maximum(threshold, timed), HALF
        if batch.at_threshold:
            limit = timed = crossed_level(threshold, highest, batch.peak_fraction)
            part = 0.0
        found = first_path(magnitude, limit, timed, batch.begin, part)
        late = batch.start_ns + (found + edge_offset(self.pulse_fwhm)) * self.sample_period_ns
        symbols = there(batch.symbols)
        energy = np.maximum(energy - magnitude.shape[1] * noise_power, 0.05 * energy)
        more_db = 0.0 if batch.reported_db is None else batch.reported_db
        return altered(
            batch,
            magnitude=magnitude,
            first_path=found,
            noise_std=noise_std,
            range_m=batch.rows.true_range_m + C_M_PER_NS * late,
            rx_power_dbm=decibel(energy / symbols**2) - self.power_offset_db + more_db,
            first_path_power_dbm=self._first_power(magnitude, found, symbols) + more_db,
        )

    def _first_power(self, magnitude: Reals, found: Floats, symbols: Floats) -> Floats:
        """Return 10 log10((F1^2 + F2^2 + F3^2) / N^2) - A, F at floor(first path) + 1, 2, 3."""
        near = np.floor(found).astype(np.intp)[:, None] + np.arange(1, 4)
        near = np.minimum(near, magnitude.shape[1] - 1)
        power = np.sum(np.take_along_axis(magnitude, near, axis=1).astype(np.float64) ** 2, axis=1)
        return decibel(power / symbols**2) - self.power_offset_db

    def _detected_paths(self, batch: Batch) -> Batch:
        """Range from the paths alone (no waveform): the earliest one above the threshold."""
        symbols = there(batch.symbols)
        noise_std, _ = _noise(batch)
        counts = np.abs(batch.gain) * (amplitude(self.power_offset_db) * symbols)[:, None]
        path = batch.kind != NO_PATH
        strongest = np.max(np.where(path, counts, 0), axis=1, keepdims=True)
        limit = np.minimum((there(batch.threshold) * noise_std)[:, None], strongest)
        seen = path & (counts >= limit)
        excess = np.min(np.where(seen, batch.excess_ns, np.inf), axis=1)
        at_first = seen & (batch.excess_ns <= excess[:, None] + 1.0)
        agc_db = np.zeros(len(batch)) if batch.agc_db is None else batch.agc_db
        first = np.sum(np.where(at_first, np.abs(batch.gain), 0) ** 2, axis=1, dtype=np.float64)
        return altered(
            batch,
            noise_std=noise_std,
            range_m=batch.rows.true_range_m + C_M_PER_NS * excess,
            rx_power_dbm=there(batch.level_dbm) + agc_db,
            first_path_power_dbm=decibel(first) + agc_db,
        )

    def cropped(self, batch: Batch) -> tuple[Reals, Floats] | None:
        """Return the CIR's magnitude [n, K] around the detected path and its index in it [n]."""
        if batch.magnitude is None:
            return None
        start = self._crop(batch)
        whole = np.empty((len(batch), self.cir_samples), np.float32)
        compiled(crop_rows)(whole, batch.magnitude, start)
        return whole, there(batch.first_path) - start

    def cropped_complex(self, batch: Batch) -> Complexes | None:
        """Return the complex CIR [n, K] around the detected path, None without a waveform."""
        if batch.waveform is None or batch.noise is None:
            return None
        column = self._crop(batch)[:, None] + np.arange(self.cir_samples)
        signal = np.take_along_axis(batch.waveform, column, axis=1)
        return signal + np.take_along_axis(batch.noise, column, axis=1)

    def _crop(self, batch: Batch) -> NDArray[np.intp]:
        """Return the sample [n] at which each row's CIR begins."""
        first = np.floor(there(batch.first_path)).astype(np.intp) - self.cir_lead
        return np.clip(first, 0, self.samples - self.cir_samples)


def there(values: NDArray[T] | None) -> NDArray[T]:
    """Return `values`, which some stage must have set. Raises ValueError where none did."""
    if values is None:
        raise ValueError("the batch has not reached that stage yet")
    return values


def _measured(batch: Batch) -> tuple[Reals, Floats, Floats, Floats, Floats]:
    """Return the magnitude [n, S] with its energy and highest sample [n], and `_noise` [n] each."""
    signal, noise = parts(there(batch.waveform)), parts(there(batch.noise))
    magnitude = np.empty((len(batch), signal.shape[1] // 2), np.float32)
    sums = np.empty((len(batch), 4))
    compiled(magnitude_rows)(magnitude, signal, noise, sums)
    energy, highest, total, power = sums.T
    if batch.as_given:
        return magnitude, energy, highest, *_noise(batch)
    mean, power = total / magnitude.shape[1], power / magnitude.shape[1]
    return magnitude, energy, highest, np.sqrt(np.maximum(power - mean**2, 0)), power


def _noise(batch: Batch) -> tuple[Floats, Floats]:
    """Return std of |noise| [n] in counts and mean |noise|^2 [n], as its power says."""
    power = there(batch.noise_power)
    if batch.steady_power is None:
        return RAYLEIGH_STD * np.sqrt(power / 2), power
    return _rice_std(power, batch.steady_power), power


def _rice_std(power: Floats, steady: Floats) -> Floats:
    """Return the std of a magnitude [n] of mean square `power`, `steady` of it a tone's (Rice).

    A tone raises the magnitude, but hardly its scatter; without one this is Rayleigh's.
    """
    steady = np.minimum(steady, power)
    half = np.maximum((power - steady) / 2, 1e-30)
    x = steady / (4 * half)
    mean = np.sqrt(np.pi * half / 2) * ((1 + 2 * x) * ive(0, x) + 2 * x * ive(1, x))
    return np.asarray(np.sqrt(np.maximum(power - mean**2, 0)))
