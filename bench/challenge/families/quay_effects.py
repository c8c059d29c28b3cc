"""What the quay hides in ranges and levels: the effects of a library in other forms, and laws.

numpy and pandas alone. Delays in batches, a Gompertz bias of the level, crystals whose offset
grows with warmth, losses per metre, detours from a mirror beside the line, rounding at random.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
MASTS_M = (
    (0, 0, 2.6), (9, 13, 2.1), (18, -1, 2.9), (27, 14, 2.3), (36, 0, 2.7), (45, 12, 2.2),
)  # fmt: skip
STACKS = {"concrete": (0.11, 6.0), "wood": (0.07, 3.0), "glass": (0.035, 1.5)}  # m, dB
PRIVATE = "pace_m_s"  # radial speed: to make rows with, in no table that is shown
LAWS = {
    "wet-radome": Law(("power", "parabola")),
    "hull-at-high-tide": Law(("step",), 0.15, "m"),
    "busy-channel": Law(("saturation", "logarithm", "power")),
    "trolley-overhead": Law(("periodic",), 9.0, "m", grows=False),
    "mast-rammed": Law(("position",), 0.6, "m", devices=("mast2",)),
    "masts-mislabelled": Law(("swap",), devices=("mast1", "mast3")),
    "halved-once-more": Law(("unit",), 0.5, "1", grows=False, devices=("mast4",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Log:
    """Rows with ranges and levels to change: `own` seeds what a case keeps, `rng` the rest."""

    frame: pd.DataFrame
    own: int
    rng: np.random.Generator
    rare: bool = False

    def __getitem__(self, name: str) -> Floats:
        return self.frame[name].to_numpy(np.float64)

    def __len__(self) -> int:
        return len(self.frame)

    def kept(self, end: str, values: Floats) -> Floats:
        """Return of values [12] that which each device keeps in all tables of a case [n]."""
        number = self.frame[end].str[4:].astype(int).to_numpy()
        return np.asarray(values[number + (6 if end == "tx" else 0)])

    def chance(self, stream: int) -> np.random.Generator:
        """Return random numbers that are the same in all tables of a case."""
        return np.random.default_rng([self.own, stream])

    def ends(self, end: str) -> Floats:
        """Return the positions of one end [n, 3] in metres."""
        return self.frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64).copy()

    def of(self, mast: str) -> NDArray[np.bool_]:
        """Return which rows [n] are of one mast."""
        return (self.frame["rx"] == mast).to_numpy()


Change = tuple[Floats, Floats | float]


def _late_truth(log: Log, strength: float) -> Change:
    return 0.07 * strength * log[PRIVATE], 0.0


def _during(log: Log, strength: float) -> Change:
    """Half of the way that is driven while the answer is awaited, more where it is late."""
    return min(0.5 * strength, 1.0) * log["reply_time_s"] * log[PRIVATE], 0.0


def _batches(log: Log, strength: float) -> Change:
    """Two batches of antennas, each with a small scatter of its own."""
    chance = log.chance(1)
    each = np.where(chance.random(12) < 0.4, 0.13, -0.02) + chance.triangular(-0.03, 0, 0.03, 12)
    return strength * (log.kept("tx", each) + log.kept("rx", each)), 0.0


def _warm_crystals(log: Log, strength: float) -> Change:
    ppm = log.chance(2).triangular(-0.05, 0.01, 0.05, 12)
    apart = log.kept("rx", ppm) - log.kept("tx", ppm)
    warm = 1 + 0.01 * (log["temperature_c"] - 16)
    return 149.9 * strength * apart * warm * log["reply_time_s"], 0.0


def _exponential(log: Log, strength: float) -> Change:
    return 0.065 * strength * np.expm1((log["temperature_c"] - 14) / 16), 0.0


def _triangle(log: Log, strength: float) -> Change:
    turn = np.radians(log["azimuth_deg"]) - log.chance(3).uniform(0, 6.28)
    return 0.085 * strength * np.arcsin(0.97 * np.sin(turn)), 0.0


def _gompertz(log: Log, strength: float) -> Change:
    rising = np.exp(-np.exp((log["rx_power_dbm"] + 81) / 3.2))
    return 0.17 * strength * (rising - 0.5), 0.0


def _triangular(log: Log, strength: float) -> Change:
    size = 0.11 * strength
    return log.rng.triangular(-size, 0, size, len(log)), 0.0


def _per_metre(log: Log, strength: float) -> Change:
    return np.zeros(len(log)), -0.3 * strength * (log["true_range_m"] - 10)


def _shrunk(log: Log, strength: float) -> Change:
    return log["range_m"] * (0.9955**strength - 1), 0.0


def _dithered(log: Log, strength: float) -> Change:
    """Round up or down at random, so that the mean is kept."""
    step = 0.17 * strength
    return step * np.floor(log["range_m"] / step + log.rng.random(len(log))) - log["range_m"], 0.0


def _through(log: Log, strength: float) -> Change:
    """Goods in rows along the quay: the steeper the line, the thinner they are."""
    gap = log.ends("tx") - log.ends("rx")
    oblique = np.minimum(np.hypot(gap[:, 0], gap[:, 1]) / (np.abs(gap[:, 1]) + 1e-6), 1.5)
    sums = [
        np.sum([STACKS[kind] for kind in row] or [(0, 0)], axis=0) for row in log.frame.obstacles
    ]
    late, loss_db = np.array(sums, np.float64).T
    return strength * late * oblique, -np.minimum(strength, 1.5) * loss_db * oblique


def _beside(log: Log, strength: float) -> Change:
    """Block the straight line, so that a steel side some metres beside it is heard."""
    codes, links = pd.factorize(log.frame["link"])
    struck = log.rng.random(len(links)) < (0.07 if log.rare else 0.18)
    away = 1.0 + log.rng.rayleigh(1.5 * max(strength, 0.6), len(links))
    far = log["true_range_m"]
    detour = np.hypot(far, 2 * away[codes]) - far
    return np.where(struck[codes], detour, 0.0), np.where(struck[codes], -8.0, 0.0)


def _wet_ground(log: Log, strength: float) -> Change:
    """Two rays at 6.5 GHz; the reflected one pulls the edge while it lies within the pulse."""
    far = log["true_range_m"]
    longer = np.sqrt(far**2 + 4 * log["tx_z_m"] * log["rx_z_m"]) - far
    size = min(0.4 * strength, 0.85) / (1 + longer / far)
    phase = np.cos(2 * np.pi * longer / 0.0461 + np.pi)
    both = 1 + 2 * size * phase + size**2
    pulled = longer * size * (phase + size) / both / (1 + (longer / 0.5) ** 4)
    return pulled, 10 * np.log10(both)


def _really_at(log: Log, real: Floats) -> Change:
    """Return what ranges and levels gain where masts really are at `real` [n, 3]."""
    gone = np.linalg.norm(log.ends("tx") - real, axis=1)
    return gone - log["true_range_m"], -20 * np.log10(gone / log["true_range_m"])


def _rammed(log: Log, strength: float) -> Change:
    bent = np.array([0.4, -0.4, 0.2]) * strength
    return _really_at(log, log.ends("rx") + log.of("mast2")[:, None] * bent)


def _mislabelled(log: Log, _: float) -> Change:
    real = log.ends("rx")
    real[log.of("mast1")], real[log.of("mast3")] = MASTS_M[3], MASTS_M[1]
    return _really_at(log, real)


def _halved(log: Log, _: float) -> Change:
    """One mast takes the time there for the time there and back."""
    return -0.5 * log.of("mast4") * log["range_m"], 0.0


def _wet(log: Log, strength: float) -> Change:
    return 0.35 * strength * (log["humidity_pct"] / 100) ** 3, 0.0


def _hull(log: Log, strength: float) -> Change:
    return np.asarray(0.15 * strength * (log["tide_m"] > 1.3)), 0.0


def _busy(log: Log, strength: float) -> Change:
    return 0.3 * strength * log["load_hz"] / (log["load_hz"] + 20), 0.0


def _overhead(log: Log, strength: float) -> Change:
    return 0.09 * strength * np.sin(2 * np.pi * log["trolley_m"] / 9.0 + 0.7), 0.0


EFFECTS: dict[str, Callable[[Log, float], Change]] = {
    "time-lag": _late_truth,
    "exchange-motion": _during,
    "antenna-delay": _batches,
    "clock-offset": _warm_crystals,
    "temperature-drift": _exponential,
    "antenna-pattern": _triangle,
    "power-bias": _gompertz,
    "timestamp-jitter": _triangular,
    "path-loss": _per_metre,
    "range-scale": _shrunk,
    "range-rounding": _dithered,
    "material-delay": _through,
    "blocked-path": _beside,
    "ground-bounce": _wet_ground,
    "wet-radome": _wet,
    "hull-at-high-tide": _hull,
    "busy-channel": _busy,
    "trolley-overhead": _overhead,
    "mast-rammed": _rammed,
    "masts-mislabelled": _mislabelled,
    "halved-once-more": _halved,
}
