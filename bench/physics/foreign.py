"""Effects on the rows of another simulator's table, whose paths are not known.

The rows are taken as they are: the CIR stands in for paths and tail, the recorded range, first
path, powers, noise and count are the starting point, and every effect changes them by as much as
it would change a simulation. Without effects the table comes back unchanged.

What effects do here. Ranging: all of them, in full. Receiver: all; noise is in the CIR already, so
it can only be raised (`noise-floor`, `narrowband-interference`), and colouring applies to what is
raised; it stays where signals grow stronger or weaker. Propagation: `material-delay`,
`diffraction`, `blocked-path`, `path-loss`, `antenna-pattern` act on the CIR's first path, on what
comes before a detour, or on all of it; reflections and tails are added to it. `small-scale-fading`
would tear the pulse apart and is refused (`on_tables`). A table without phases is taken as real;
where an effect adds copies of samples or a tone (`with_phases`), every lobe of a row is given a
random phase, else noise would add up like a pulse, or beat with a tone as one wave. Without a CIR,
effects act on a single path.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
import pandas as pd

from bench.errors import BenchError
from bench.physics.base import RAYLEIGH_STD, Base, power_of_noise, there
from bench.physics.batch import Batch, altered
from bench.physics.detection import first_path
from bench.physics.effect import Effect
from bench.physics.first_top import first_top
from bench.physics.outcome import Outcome, joined
from bench.physics.own_base import noise_times, own_base, with_pulse
from bench.physics.own_detector import Crossing, crossing
from bench.physics.own_noise import louder_by, unit_noise, with_own_noise
from bench.physics.passed_over import begins
from bench.physics.pipeline import Change, Pipeline
from bench.physics.pulse import lobe_phases, peak
from bench.physics.randomness import BLOCK, Draws
from bench.physics.remembered import DrawMemory, RememberedDraws
from bench.physics.sampling import sampled
from bench.physics.scaled_peaks import ScaledPeaks
from bench.physics.scene import Scene, scene
from bench.physics.units import C_M_PER_NS, Complexes, Floats, absolute, amplitude


@dataclass(frozen=True)
class ForeignTable:
    """Another simulator's rows, ready for effects to act on.

    `frame` needs `true_range_m` (or positions) and `range_m` or `error_m`; `base` gives what the
    table does not tell (pulse width, threshold, noise). All rows must have CIRs of one length.
    `memory` holds random numbers that are drawn again; `like` is a table of the same simulator that
    tells how edges are timed, else these rows do.
    """

    frame: pd.DataFrame
    base: Base = field(default_factory=Base)
    source: str = "simulated table"
    memory: DrawMemory = field(default_factory=lambda: DrawMemory(0), compare=False)
    like: ForeignTable | None = field(default=None, compare=False)

    @cached_property
    def rows(self) -> Scene:
        """What is known of the rows. Raises BenchError where the true range is not."""
        return scene(self.frame, self.source)

    @cached_property
    def own(self) -> Base:
        """The base at the table's own sample period and with its own pulse."""
        base = own_base(self.base, self.rows)
        if self.like is not None:
            return replace(base, pulse_fwhm=self.like.own.pulse_fwhm)
        if self.cir is None:
            return base
        return with_pulse(base, absolute(self.cir), self._index(self.rows))

    @cached_property
    def range_m(self) -> Floats:
        """The table's ranges [n]. Raises BenchError where they are not known."""
        for name, offset in (("range_m", 0.0), ("error_m", self.rows.true_range_m)):
            if self.rows.has(name):
                return np.asarray(self.rows.numbers[name] + offset)
        raise BenchError(f"{self.source}: needs a column 'range_m' or 'error_m'")

    @cached_property
    def cir(self) -> Complexes | None:
        """The CIRs [n, K], complex where the table has both parts, None without any."""
        names = [("cir_i", "cir_q"), ("cir",)]
        found = next((part for part in names if set(part) <= set(self.frame)), None)
        if found is None:
            return None
        parts = [_stacked(self.frame[name], self.source) for name in found]
        whole = parts[0] + 1j * parts[1] if len(parts) == 2 else parts[0]
        return whole.astype(np.complex64)

    def observe(
        self, effects: tuple[Effect, ...], seed: int = 0, replicate: int = 0, *, cir: bool = True
    ) -> Outcome:
        """Return the table's rows with `effects` in them; with none, as they are.

        The CIR stays on the table's own samples; `first_path_index` moves where detection does.
        Without `cir` the outcome has none. Raises BenchError naming an effect that cannot act on a
        table.
        """
        check_on_tables(effects)
        starts = range(0, len(self.rows), BLOCK)
        keys = [(seed, replicate, "base", start // BLOCK) for start in starts]
        draws = [RememberedDraws(*key, self.memory) for key in keys]
        pairs = zip(starts, draws, self.plain, strict=True)
        return joined(
            [self.outcome(at, self._run(effects, at, key), plain, cir) for at, key, plain in pairs]
        )

    @cached_property
    def plain(self) -> list[Batch]:
        """The blocks of the table run through the receiver without any effect."""
        starts = range(0, len(self.rows), BLOCK)
        return [self._run((), start, Draws(0, 0, "base", 0)) for start in starts]

    def _run(self, effects: tuple[Effect, ...], start: int, draws: Draws) -> Batch:
        """Return one block after all stages; what comes before the ranging is remembered once."""
        early = tuple(effect for effect in effects if effect.stage != "ranging")
        key = (early, draws.seed, draws.replicate)
        kept, batch = self._detected.get(start, (None, None))
        if batch is None or kept != key:
            batch = self._detect(early, start, draws)
            self._detected[start] = key, batch
        pipeline = Pipeline(effects, self.own.counted, self.own.detected)
        return pipeline.ranged(batch, draws)

    @cached_property
    def _detected(self) -> dict[int, tuple[object, Batch]]:
        """The last detected batch of every block, with what decided it."""
        return {}

    def _detect(self, early: tuple[Effect, ...], start: int, draws: Draws) -> Batch:
        """Return one block up to detection."""
        phased = any(effect.with_phases for effect in early)
        part = slice(start, start + BLOCK)
        arriving = self.arriving(part, phased)
        pipeline = Pipeline(early, self.receiver(part, arriving), self.own.detected)
        return pipeline.detected(lambda: arriving, draws)

    def receiver(self, part: slice, arriving: Batch) -> Change:
        """Return what receives rows of which this arrives without effects."""
        given = arriving.rows.number("rx_power_dbm", np.nan) - arriving.path_power_dbm()
        offset_db = np.where(np.isfinite(given), given, 0.0)
        peaks, edge, begin = self._peaks[part], arriving.free_gain, self._begin[part]
        return partial(
            self._received, part=part, offset_db=offset_db, edge=edge, peaks=peaks, begin=begin
        )

    def arriving(self, part: slice, phased: bool = False) -> Batch:
        """Return rows before the receiver: the CIR as a tail in sqrt(mW), or one path."""
        batch = self.own.counted(self.own.paths(self.rows.slice(part.start, part.stop)))
        excess = ((self.range_m[part] - batch.rows.true_range_m) / C_M_PER_NS).astype(np.float32)
        batch = altered(batch, excess_ns=excess[:, None])
        if self.cir is None:
            given = batch.rows.number("first_path_power_dbm", np.nan)
            return batch.louder(np.nan_to_num(given - batch.level()))
        scale = amplitude(self.own.power_offset_db) * there(batch.symbols)
        cir = self._phased[part] if phased else self.cir[part]
        return self._as_tail(batch, (cir / scale[:, None]).astype(np.complex64))

    @cached_property
    def _phased(self) -> Complexes:
        """The CIRs with a random phase for every lobe, where the table has none."""
        cir = np.zeros((0, 0), np.complex64) if self.cir is None else self.cir
        whole = cir if np.any(cir.imag) else cir * lobe_phases(absolute(cir))
        return np.asarray(whole, np.complex64)

    @cached_property
    def _peaks(self) -> Floats:
        """The highest magnitude of every CIR [n] in counts; of none, empty."""
        whole = np.zeros((0, 1)) if self.cir is None else absolute(self.cir)
        return np.asarray(whole.max(axis=1), np.float64)

    @cached_property
    def _drawn(self) -> Complexes:
        """Noise of power one for every CIR [n, K]."""
        return unit_noise(self._peaks, 0 if self.cir is None else self.cir.shape[1])

    @cached_property
    def _scaled(self) -> ScaledPeaks:
        """Whether the CIRs were scaled to one peak."""
        level, noise = (self.rows.number(n, np.nan) for n in ("rx_power_dbm", "noise_std"))
        return ScaledPeaks.of(self._peaks, level, noise)

    @cached_property
    def _noise_times(self) -> float:
        """How many times the noise that the table tells its samples have, in power."""
        if self.cir is None or self._scaled.held:
            return 1.0
        stated = _noise_power(self.own.counted(self.own.paths(self.rows)))
        return noise_times(absolute(self.cir), self._index(self.rows), stated)

    @cached_property
    def timing(self) -> Crossing | None:
        """Where edges are timed, None where the table does not tell another way than the base's."""
        if self.like is not None or self.cir is None:
            return self.like.timing if self.like else None
        noise, limit = self._quiet
        seen, index = absolute(self.cir), self._index(self.rows)
        usual = first_path(seen, limit, begin=self._passed_over)
        return crossing(seen, noise * np.sqrt(self._noise_times), index, usual)

    @property
    def _begin(self) -> Floats:
        """Before which sample of every CIR no path is found [n]."""
        return self._passed_over if self.timing is None else np.zeros(len(self.rows))

    @cached_property
    def _passed_over(self) -> Floats:
        """The same of a detector like the base's [n]."""
        if self.cir is None:
            return np.zeros(len(self.rows))
        return begins(absolute(self.cir), self._quiet[1], self._index(self.rows))

    @cached_property
    def _quiet(self) -> tuple[Floats, Floats]:
        """What magnitudes of the noise that is told scatter, and the base's threshold [n each]."""
        batch = self.own.counted(self.own.paths(self.rows))
        noise = RAYLEIGH_STD * np.sqrt(_noise_power(batch) / 2)
        return noise, there(batch.threshold) * noise

    def _as_tail(self, batch: Batch, taps: Complexes) -> Batch:
        """Return the batch with the CIR `taps` in place of its path; new paths relate to its top.

        The path stays as a mark of where the first one arrives, with no power of its own.
        """
        width = self.own.pulse_fwhm
        centre, top = first_top(taps, self._index(batch.rows), width)
        start = batch.excess_ns[:, 0] - centre * self.own.sample_period_ns
        return altered(
            batch,
            gain=np.zeros_like(batch.gain),
            free_gain=(top / peak(width)).astype(np.complex64),
            tail=taps,
            tail_start_ns=start.astype(np.float32),
            tail_fwhm=width,
        )

    def _index(self, rows: Scene) -> Floats:
        """Return the first path's index in the table's CIRs [n]."""
        return rows.number("first_path_index", float(self.base.cir_lead))

    def _received(
        self,
        batch: Batch,
        part: slice,
        offset_db: Floats,
        edge: Complexes | None,
        peaks: Floats,
        begin: Floats,
    ) -> Batch:
        """Return the batch at the receiver: its own samples, no noise but its own.

        `offset_db` [n] is the recorded receive level over that of the CIR; `edge` [n] the gain of
        its first path, `peaks` [n] its highest magnitude, `begin` [n] where that is looked for.
        """
        batch = self.own.counted(batch)
        level = batch.level() + offset_db
        batch = altered(batch, level_dbm=level, nominal_symbols=batch.symbols, begin=begin)
        power = _noise_power(batch) * self._noise_times
        batch = altered(self._timed(batch), noise_power=power, as_given=True)
        if not batch.tail_fwhm:
            return batch
        scale = (amplitude(self.own.power_offset_db) * there(batch.symbols)).astype(np.float32)
        waveform = sampled(batch, batch.tail_start_ns, batch.tail.shape[1], self.own.pulse_fwhm)
        waveform *= scale[:, None]
        if not self._scaled.held or self._scaled.with_noise:
            louder, first = louder_by(batch, edge), self._index(batch.rows)
            drawn, left = self._drawn[part], batch.own_noise
            waveform = with_own_noise(waveform, louder, power, drawn, first, left)
        noise = np.zeros_like(waveform)
        batch = altered(batch, waveform=waveform, noise=noise, start_ns=batch.tail_start_ns)
        return self._scaled.again(batch, peaks) if self._scaled.held else batch

    def _timed(self, batch: Batch) -> Batch:
        """Return the batch with first paths timed as in the table, where that tells how."""
        own = self.timing
        if own is None:
            return batch
        threshold = np.full(len(batch), own.of_noise)
        return altered(batch, threshold=threshold, peak_fraction=own.of_peak, at_threshold=True)

    def outcome(self, start: int, changed: Batch, plain: Batch, cir: bool) -> Outcome:
        """Return the table's values plus what the effects changed in one block.

        A noise or a count that the table does not tell stays unknown: its samples are not scaled by
        one, and their noise is that before the path.
        """
        rows, part = changed.rows, slice(start, start + BLOCK)
        rx, first = (
            np.where(np.isfinite(given), given, there(getattr(plain, name)))
            for name in ("rx_power_dbm", "first_path_power_dbm")
            for given in [rows.number(name, np.nan)]
        )
        noise, count = (rows.number(name, np.nan) for name in ("noise_std", "preamble_count"))
        whole = None
        if cir and changed.waveform is not None and changed.noise is not None:
            whole = changed.waveform + changed.noise
        return Outcome(
            true_range_m=rows.true_range_m,
            range_m=self.range_m[part] + there(changed.range_m) - there(plain.range_m),
            rx_power_dbm=rx + there(changed.rx_power_dbm) - there(plain.rx_power_dbm),
            first_path_power_dbm=first
            + there(changed.first_path_power_dbm)
            - there(plain.first_path_power_dbm),
            noise_std=noise * there(changed.noise_std) / there(plain.noise_std),
            preamble_count=np.where(np.isfinite(count), there(changed.symbols), np.nan),
            cir=None if whole is None else changed.magnitude,
            cir_complex=whole,
            first_path_index=self._moved_index(changed, plain),
            clock_offset_ppm=changed.clock_offset_ppm,
            sample_period_ns=changed.sample_period_ns,
        )

    def _moved_index(self, changed: Batch, plain: Batch) -> Floats | None:
        """Return where detection finds the first path in the CIR [n], None without one."""
        if changed.first_path is None or plain.first_path is None:
            return None
        return self._index(changed.rows) + changed.first_path - plain.first_path


def _noise_power(batch: Batch) -> Floats:
    """Return mean |noise|^2 [n] in counts^2: as the table tells it, else the base's."""
    power = power_of_noise(batch.rows.number("noise_std", np.nan))
    return np.asarray(np.where(np.isfinite(power), power, there(batch.noise_power)))


def check_on_tables(effects: Sequence[Effect]) -> None:
    """Raise BenchError naming an effect that cannot act on a table."""
    for effect in effects:
        if not effect.on_tables:
            raise BenchError(f"effect {effect.name!r} needs the simulator, not its table")


def _stacked(column: pd.Series, source: str) -> Floats:
    """Return a column of CIRs as [n, K]. Raises BenchError where their lengths differ."""
    sizes = {len(cell) for cell in column}
    if len(sizes) != 1:
        raise BenchError(f"{source}: CIRs of {len(sizes)} different lengths; expected one")
    return np.asarray(np.stack(column.to_list()), np.float64)
