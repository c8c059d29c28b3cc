"""The state that effects act on: a struct of arrays over a block of rows.

Propagation works on paths (`excess_ns`, `gain`, `kind`) and on the dense diffuse `tail`; the
receiver on the sampled `waveform` and `noise`; ranging on `range_m`. Delays are relative to the
straight line between the antennas, so a path of 1 ns excess is 0.30 m longer than the truth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bench.physics.scene import Scene
from bench.physics.shaped import first_share, noise_left, shifted, smooth, with_pulse
from bench.physics.units import C_M_PER_NS, Complexes, Floats, Reals, decibel, scaled

__all__ = ["Batch", "altered"]

NO_PATH, DIRECT, SPECULAR, DIFFRACTED = 0, 1, 2, 3
REPORTED_LEVELS = ("rx_power_dbm", "first_path_power_dbm")


@dataclass(frozen=True)
class Batch:
    """Rows under simulation; n rows, P paths, G tail taps, S samples.

    Propagation: `excess_ns` [n, P], `gain` [n, P] (complex, sqrt(mW) at the receiver), `kind`
    [n, P] (`DIRECT`, `SPECULAR`, `DIFFRACTED`, or `NO_PATH` for padding), `tail` [n, G] complex
    taps one sample apart from `tail_start_ns` [n] on, bare unless `tail_fwhm` > 0: then they are
    a CIR as given, with a pulse of that width in samples in it (see `bench.physics.foreign`), and
    of its noise `own_noise` [n, G] is left, in amplitude, where effects took taps away (None: all),
    `free_gain` [n] what the straight path would have with nothing in its way.
    Receiver: `waveform` [n, S] (counts, signal alone) and `noise` [n, S] (counts), the excess
    delay `start_ns` [n] of sample 0, `symbols` [n] accumulated, `threshold` [n] (multiple of the
    noise's standard deviation), `level_dbm` [n] true receive level, `reported_db` [n] what levels
    are reported too high by, whatever the samples say. All None without a CIR, except `symbols`
    and `level_dbm`.
    `noise_power` [n] is the mean |noise|^2 of one sample, `steady_power` [n] what tones and offsets
    hold of it, where the samples cannot tell (None: nothing). `as_given`: the waveform came from a
    table, with its noise in it; `noise` holds only what effects add. `peak_held`: it was scaled
    to a height that no gain changes. `begin` [n]: the sample before which the table's own detector
    finds no path (None: it looks at all); `at_threshold`: that one times an edge where it crosses.
    Ranging: `magnitude` [n, S] of signal and noise, `first_path` [n] (samples from sample 0),
    `range_m` [n], the chip's `rx_power_dbm` and `first_path_power_dbm` [n], `noise_std` [n] counts.
    `clock_offset_ppm` [n] where known.
    """

    rows: Scene
    centre_ghz: float
    sample_period_ns: float
    excess_ns: Reals
    gain: Complexes
    kind: NDArray[np.int8]
    tail: Complexes
    tail_start_ns: Reals
    free_gain: Complexes | None = None
    tail_fwhm: float = 0.0
    own_noise: Reals | None = None
    waveform: Complexes | None = None
    noise: Complexes | None = None
    start_ns: Reals | None = None
    symbols: Floats | None = None
    nominal_symbols: Floats | None = None
    agc_db: Floats | None = None
    reported_db: Floats | None = None
    threshold: Floats | None = None
    peak_fraction: float = 0.0
    begin: Floats | None = None
    at_threshold: bool = False
    noise_power: Floats | None = None
    steady_power: Floats | None = None
    as_given: bool = False
    peak_held: bool = False
    level_dbm: Floats | None = None
    magnitude: Reals | None = None
    first_path: Floats | None = None
    range_m: Floats | None = None
    rx_power_dbm: Floats | None = None
    first_path_power_dbm: Floats | None = None
    noise_std: Floats | None = None
    clock_offset_ppm: Floats | None = None

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def direct(self) -> NDArray[np.bool_]:
        """Which paths are the straight line [n, P]."""
        return np.asarray(self.kind == DIRECT)

    def path_power_dbm(self) -> Floats:
        """Return the total power of paths and tail [n] in dBm."""
        power = np.sum(np.abs(self.gain) ** 2, axis=1, dtype=np.float64)
        return decibel(power + np.sum(np.abs(self.tail) ** 2, axis=1, dtype=np.float64))

    def level(self) -> Floats:
        """Return the true receive level [n] in dBm, at whatever stage the batch is."""
        return self.path_power_dbm() if self.level_dbm is None else self.level_dbm

    def steadier(self, power: Floats, logged: bool = True) -> Batch:
        """Return the batch with noise of constant magnitude, of `power` [n], beside the other.

        Not `logged`: a log of noise tells power, which is as large as that of any noise.
        """
        whole = None if self.noise_power is None else self.noise_power + power
        if not logged:
            return altered(self, noise_power=whole)
        steady = power if self.steady_power is None else self.steady_power + power
        return altered(self, noise_power=whole, steady_power=steady if self.as_given else None)

    def louder(self, gain_db: Floats | float) -> Batch:
        """Return the batch with every path and the tail stronger by `gain_db` [n] or scalar."""
        ratio = np.asarray(10 ** (np.asarray(gain_db, np.float32) / 20), np.float32)
        ratio = np.broadcast_to(ratio, (len(self),))
        free = None if self.free_gain is None else self.free_gain * ratio
        gain, tail = scaled(self.gain, ratio), scaled(self.tail, ratio)
        return altered(self, gain=gain, tail=tail, free_gain=free)

    def told_louder(self, by_db: Floats) -> Batch:
        """Return the batch whose levels will be reported larger by `by_db` [n] than they arrive."""
        before = 0.0 if self.reported_db is None else self.reported_db
        return altered(self, reported_db=before + by_db)

    def reported_louder(self, gain_db: Floats) -> Batch:
        """Return the batch with the levels that are reported so far larger by `gain_db` [n]."""
        known = {name: getattr(self, name) for name in REPORTED_LEVELS}
        return altered(self, **{n: v + gain_db for n, v in known.items() if v is not None})

    def postponed(self, by_ns: Floats) -> Batch:
        """Return the batch with every path and the tail later by `by_ns` [n]."""
        later = np.asarray(by_ns, np.float32)
        excess = self.excess_ns + later[:, None]
        return altered(self, excess_ns=excess, tail_start_ns=self.tail_start_ns + later)

    def direct_changed(self, loss_db: Floats, delay_ns: Floats) -> Batch:
        """Return the batch with the straight path weaker by `loss_db` [n], later by `delay_ns`."""
        ratio = np.asarray(10 ** (-np.asarray(loss_db) / 20), np.float32)[:, None]
        later = np.asarray(delay_ns, np.float32)[:, None]
        gain = np.where(self.direct, self.gain * ratio, self.gain)
        excess = np.where(self.direct, self.excess_ns + later, self.excess_ns)
        made = self._first_changed(ratio, later[:, 0]) if self.tail_fwhm else self
        return altered(made, gain=gain, excess_ns=excess)

    def _first_changed(self, ratio: Reals, later_ns: Reals) -> Batch:
        """Return the batch with the first path of its tail, a CIR as given, weaker and later."""
        some = np.flatnonzero((ratio[:, 0] != 1) | (later_ns != 0))
        share, weaker = self._first_share(some), ratio[some]
        by = np.asarray(later_ns[some], np.float64) / self.sample_period_ns
        first = self.tail[some] * share
        tail, left = self.tail.copy(), np.ones(self.tail.shape, np.float32)
        tail[some] += shifted(first, by) * weaker - first
        left[some] = noise_left(share, weaker, by)
        return altered(self, tail=tail, own_noise=self._quieter(left))

    def _first_share(self, rows: NDArray[np.intp]) -> Reals:
        """Return which share of every tap of a CIR as given is the first path's, of some rows."""
        direct_ns = np.min(np.where(self.direct, self.excess_ns, np.inf)[rows], axis=1)
        peak_at = (direct_ns - self.tail_start_ns[rows]) / self.sample_period_ns
        return first_share(self.tail[rows], np.nan_to_num(peak_at), self.tail_fwhm)

    def _quieter(self, left: Reals) -> Reals:
        """Return what is left of the tail's own noise [n, G] where so much of that is left."""
        return left if self.own_noise is None else self.own_noise * left

    def with_paths(self, excess_ns: Floats | Reals, gain: Complexes, kind: int) -> Batch:
        """Return the batch with more paths, [n, Q] each; those of zero gain become padding."""
        fresh = np.where(gain == 0, NO_PATH, kind).astype(np.int8)
        return altered(
            self,
            excess_ns=np.concatenate([self.excess_ns, excess_ns.astype(np.float32)], axis=1),
            gain=np.concatenate([self.gain, gain.astype(np.complex64)], axis=1),
            kind=np.concatenate([self.kind, fresh], axis=1),
        )

    def with_tail(self, taps: Complexes, start_ns: Floats) -> Batch:
        """Return the batch with bare tail taps [n, G] from `start_ns` [n] on, a sample apart.

        Only the first tail decides the grid; a further one is added to it tap by tap.
        """
        if self.tail_fwhm:
            taps = with_pulse(taps, self.tail_fwhm)
        if not self.tail.shape[1]:
            return altered(self, tail=taps, tail_start_ns=np.asarray(start_ns, np.float32))
        columns = self.tail.shape[1]  # a CIR as given keeps its samples, a bare tail may grow
        columns = columns if self.tail_fwhm else max(columns, taps.shape[1])
        whole = np.zeros((len(self), columns), np.complex64)
        whole[:, : self.tail.shape[1]] = self.tail
        lag = np.rint((start_ns - self.tail_start_ns) / self.sample_period_ns).astype(np.intp)
        column = np.arange(whole.shape[1]) - lag[:, None]
        inside = (column >= 0) & (column < taps.shape[1])
        picked = np.take_along_axis(taps, np.clip(column, 0, taps.shape[1] - 1), axis=1)
        return altered(self, tail=whole + np.where(inside, picked, np.complex64(0)))

    def silenced(self, before_ns: Floats, direct: bool = True) -> Batch:
        """Return the batch with no path and no tap earlier than `before_ns` [n].

        With `direct` False the straight path stays.
        """
        limit = np.asarray(before_ns, np.float32)[:, None]
        gone = (self.excess_ns < limit) & (direct | ~self.direct)
        gain = np.where(gone, np.complex64(0), self.gain)
        kind = np.where(gone, np.int8(NO_PATH), self.kind)
        made = self._given_from(limit, direct) if self.tail_fwhm else self._tail_from(limit)
        return altered(made, gain=gain, kind=kind)

    def _tail_from(self, limit: Reals) -> Batch:
        """Return the batch with no tap earlier than `limit` [n, 1] in ns; most rows have none."""
        some = np.flatnonzero(self.tail_start_ns < limit[:, 0])
        early = self._tap_ns(some) < limit[some]
        made = self.tail.copy()
        made[some] = np.where(early, np.complex64(0), made[some])
        return altered(self, tail=made)

    def _given_from(self, limit: Reals, direct: bool) -> Batch:
        """Return the batch with nothing earlier than `limit` [n, 1] in ns in a CIR as given.

        Pulses fade in over their width there. Of the first path all of its pulse goes; it stays as
        it is without `direct`.
        """
        some = np.flatnonzero(self.tail_start_ns < limit[:, 0])
        late = (self._tap_ns(some) - limit[some]) / (self.tail_fwhm * self.sample_period_ns)
        stays, first = smooth(late + 0.5), self._first_share(some)
        gone = direct & (self.excess_ns[:, :1] < limit)[some]
        stays = np.where(gone, np.minimum(stays, 1 - first), np.maximum(stays, first))
        left = np.ones(self.tail.shape, np.float32)
        left[some] = stays
        return altered(self, tail=self.tail * left, own_noise=self._quieter(left))

    def _tap_ns(self, rows: NDArray[np.intp]) -> Reals:
        """Return the excess delay of every tap of some rows [m, G] in ns."""
        grid = np.arange(self.tail.shape[1], dtype=np.float32) * np.float32(self.sample_period_ns)
        return np.asarray(self.tail_start_ns[rows, None] + grid)

    def longer(self, by_m: Floats | float) -> Batch:
        """Return the batch with ranges longer by `by_m` metres, [n] or scalar."""
        if self.range_m is None:
            raise ValueError("ranges exist only at the ranging stage")
        return altered(self, range_m=self.range_m + by_m)

    def later(self, by_ns: Floats | float) -> Batch:
        """Return the batch with ranges longer by `by_ns` nanoseconds of one-way delay."""
        return self.longer(np.asarray(by_ns, np.float64) * C_M_PER_NS)


if TYPE_CHECKING:
    from dataclasses import replace as altered  # so that fields and their types are checked
else:

    def altered(batch: Batch, **fields: Any) -> Batch:
        """Return the batch with other values in some fields.

        As `dataclasses.replace`, which costs more than the arithmetic on some hundred rows.
        """
        if not fields.keys() <= batch.__dict__.keys():
            raise TypeError(f"a batch has no {', '.join(fields.keys() - batch.__dict__.keys())}")
        made = object.__new__(type(batch))
        made.__dict__.update(batch.__dict__, **fields)
        return made
