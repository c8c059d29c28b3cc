"""Effect 13: the diffuse multipath tail."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.loops import compiled, decay_rows
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import C_M_PER_NS, Complexes, Floats, Reals, amplitude, decibel

_CLUSTERS = 6  # at most, the one of the straight line included
_REFERENCE_M = 5.0
_MEAN_FREE_NS = 9.1  # 4 V / (c S) of a room of 5 x 5 x 2.8 m


@dataclass(frozen=True)
class DiffuseTail(Effect):
    """Adds Saleh-Valenzuela clusters of dense rays behind the straight line.

    Clusters arrive with rate `cluster_rate` and decay with `cluster_decay_ns`; the rays in each
    decay with `ray_decay_ns`, one complex Gaussian tap per sample. Total power is `level_db` over
    the free-space level at 1 m (of a reverberant room: 16 pi over its absorbing area in m2, 1 dB
    where that is 40) and falls as distance^-`distance_exponent` (0: a reverberant room, 2: follows
    the straight path). Clusters are drawn per link; `static` of a tap's power is the same in all
    rows of a link, the rest changes from row to row as the tag moves.
    Both decays grow with the distance over 5 m to the power of `delay_exponent`, and with the mean
    free path of the row's room to that of `room_scaling`; rows in the open (room columns there, but
    empty) have `open_space_db` more.
    """

    name = "diffuse-tail"
    number = 13
    stage = "propagation"
    stackable = True
    dies_away = True
    source = "Molisch et al., IEEE 802.15.4a channel model final report (2004); room scaling: "
    source += "Andersen et al., IEEE Antennas Propag. Mag. 49 (2007) 27; distance: Greenstein et "
    source += "al., IEEE Trans. Veh. Technol. 46 (1997) 477"
    signature = "slope and level of the median log power-delay profile; RMS delay spread"
    needs = (("cir",),)
    resembles = "specular-reflections"
    begins = tuple(
        # one dense cluster that follows the straight path: other simulators' tails are as plain
        {"distance_exponent": 2.0, "ray_decay_ns": decay_ns, "cluster_rate": 0.001}
        | {"cluster_sigma_db": 0.0, "static": kept, "room_scaling": 0.0}
        for decay_ns in (8.0, 15.0, 28.0)
        for kept in (0.2, 0.7)
    )

    level_db: float = parameter(-14, "dB", -60, 3, "total power over free space at 1 m", null=-60)
    distance_exponent: float = parameter(0.5, "1", 0, 6, "how the level falls with distance")
    ray_decay_ns: float = parameter(9, "ns", 1, 120, "of the rays in a cluster (gamma)")
    cluster_decay_ns: float = parameter(12, "ns", 1, 200, "of the clusters (Gamma)")
    cluster_rate: float = parameter(0.05, "1/ns", 0.001, 1, "arrivals of clusters (Lambda)")
    cluster_sigma_db: float = parameter(3, "dB", 0, 10, "shadowing of each cluster")
    static: float = parameter(0.3, "ratio", 0, 1, "of a tap's power that a link keeps")
    delay_exponent: float = parameter(0, "1", -1, 1, "how decays grow with distance")
    room_scaling: float = parameter(1, "1", 0, 1, "how decays grow with the size of the room")
    open_space_db: float = parameter(
        -15, "dB", -60, 0, "level where there is no room", fitted=False
    )
    length_ns: float = parameter(165, "ns", 10, 1000, "where the tail is cut", fitted=False)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Add the tail's taps, the first at the straight line's delay; none at -60 dB."""
        if self.level_db <= -60:
            return batch
        taps = max(2, int(self.length_ns / batch.sample_period_ns))
        scale = self._decay_scale(batch.rows)
        profile = self._amplitudes(batch, draws, taps, scale)
        made = draws.complex_normal(len(batch), taps)
        if self.static > 0:
            kept = draws.group_complex(batch.rows.group("link"), taps)
            kept *= np.float32(np.sqrt(self.static))
            made *= np.float32(np.sqrt(1 - self.static))
            made += kept
        profile *= self._total(batch)[:, None]
        made *= profile
        return batch.with_tail(made, np.zeros(len(batch)))

    def _total(self, batch: Batch) -> Reals:
        """Return the root of the tail's total power [n] in sqrt(mW)."""
        truth = batch.rows.true_range_m
        at_1m = decibel(np.abs(_reference(batch)) ** 2) + 20 * np.log10(truth)
        fall = 10 * self.distance_exponent * np.log10(np.maximum(truth, 0.3))
        indoors = np.where(in_the_open(batch.rows), self.open_space_db, 0.0)
        return amplitude(at_1m + self.level_db + indoors - fall).astype(np.float32)

    def _decay_scale(self, rows: Scene) -> Floats:
        """Return each row's decays over those of the reference room at 5 m [n]."""
        far = np.maximum(rows.true_range_m, 0.3) / _REFERENCE_M
        return np.asarray(far**self.delay_exponent * _rooms(rows) ** self.room_scaling)

    def _amplitudes(self, batch: Batch, draws: Draws, taps: int, scale: Floats) -> Reals:
        """Return the root of each tap's mean share of the power [n, taps]; alike within a link."""
        links, place = draws.groups(batch.rows.group("link"))
        first = np.zeros(len(links), np.intp)
        first[place[::-1]] = np.arange(len(place))[::-1]
        period = batch.sample_period_ns
        starts = np.zeros((len(links), taps))
        arrival = np.zeros(len(links))
        drawn = draws.group_uniforms(links, range(2 * _CLUSTERS))
        level = 10 ** (self.cluster_sigma_db * ndtri(drawn[::2]) / 10)
        gap = -np.log(drawn[1::2]) / self.cluster_rate
        for cluster in range(_CLUSTERS):
            power = np.exp(-arrival / (self.cluster_decay_ns * scale[first]))
            at = np.minimum(arrival / period, taps - 1).astype(np.intp)
            starts[np.arange(len(links)), at] += power * level[cluster]
            arrival = arrival + gap[cluster]
        power = _decayed(starts, self.ray_decay_ns * scale[first] / period)
        power /= np.sum(power, axis=1, keepdims=True)
        return np.sqrt(power, out=power)[place]


def _rooms(rows: Scene) -> Floats:
    """Return each room's mean free path over the reference room's [n], 1 where none is known."""
    size = [rows.number(f"room_{axis}_m", np.nan) for axis in "xyz"]
    surface = 2 * (size[0] * size[1] + size[1] * size[2] + size[0] * size[2])
    free_ns = 4 * size[0] * size[1] * size[2] / surface / C_M_PER_NS
    return np.where(np.isfinite(free_ns), free_ns / _MEAN_FREE_NS, 1.0)


def in_the_open(rows: Scene) -> NDArray[np.bool_]:
    """Return the rows [n] of a table with room columns that have no room."""
    if not rows.has("room_x_m"):
        return np.zeros(len(rows), bool)
    return np.isnan(rows.number("room_x_m", np.nan))


def _decayed(starts: Floats, decay_taps: Floats) -> Reals:
    """Return each row of `starts` followed by exponential decay over `decay_taps` [n] taps."""
    made = np.empty(starts.shape, np.float32)
    compiled(decay_rows)(made, starts, np.exp(-1 / decay_taps))
    return made


def _reference(batch: Batch) -> Complexes:
    """Return the straight path's gain in free space [n]."""
    if batch.free_gain is not None:
        return batch.free_gain
    return np.asarray(np.sqrt(10 ** (batch.path_power_dbm() / 10)), np.complex64)
