"""What the harbour hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the harbour's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Gained = dict[str, Floats]
CRANES_M = np.array(
    [(4.0, 2.5, 12.0), (27.0, 3.0, 15.5), (52.0, 2.0, 13.0), (86.0, 3.5, 16.0), (89.0, 30.0, 9.5),
     (63.0, 39.0, 11.0), (33.0, 38.0, 8.5), (3.0, 36.0, 10.5)]
)  # fmt: skip
CARRIERS = 5
CARGO = {"concrete": (0.19, 7.5), "glass": (0.11, 2.5), "wood": (0.13, 3.2)}  # m late, dB
MOTION = ("now_x_m_per_s", "now_y_m_per_s", "brake_s")
PER_PPM_S = 149.896229  # metres: half the way of light in a second, times 1e-6
WAVE_M = 0.0462  # 6.49 GHz
FATHOM_M = 1.8288
LAWS = {
    "salt-crust": Law(("saturation", "logarithm", "power")),
    "boom-in-the-wind": Law(("power", "parabola")),
    "seiche": Law(("periodic",), 2820.0, "s", grows=False),
    "twistlocks-closed": Law(("step",), 0.13, "m"),
    "flattened-by-firmware": Law(("inverse", "power", "inverse square")),
    "stuck-bit": Law(),
    "crane-clock-late": Law(),
    "crane-rolled-on": Law(("position",), 0.5944, "m", devices=("crane5",)),
    "cranes-renumbered": Law(("swap",), devices=("crane0", "crane6")),
    "fathoms-from-one-crane": Law(
        ("unit",), 1 / FATHOM_M, "1", grows=False, devices=("crane3",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Log:
    """Rows as they are logged: `own` seeds what all tables of a case share, `rng` the rest."""

    frame: pd.DataFrame
    own: int
    rng: np.random.Generator
    seldom: bool = False

    def of(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.frame[column].to_numpy(np.float64)

    def shared(self, stream: str) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.own, *stream.encode()])

    def crane(self) -> NDArray[np.intp]:
        """Return the number of the crane of each row [n]."""
        return self.frame["tx"].str.removeprefix("crane").to_numpy(np.intp)

    def carrier(self) -> NDArray[np.intp]:
        """Return the number of the carrier of each row [n]."""
        return self.frame["rx"].str.removeprefix("carrier").to_numpy(np.intp)

    def carriers_at(self, after_s: Floats | float = 0.0) -> Floats:
        """Return where the carriers of the rows are some time after [n, 3]."""
        place = np.stack([self.of(f"rx_{axis}_m") for axis in "xyz"], axis=1)
        x, y, brake = (self.of(name) for name in MOTION)
        rolls = brake * -np.expm1(-np.asarray(after_s) / brake)
        return place + np.stack([x * rolls, y * rolls, 0 * x], axis=1)

    def longer(self, carrier: Floats, crane: Floats | None = None) -> Floats:
        """Return by how much the way is longer between other places [n, 3] of the ends [n]."""
        gap = carrier - (CRANES_M[self.crane()] if crane is None else crane)
        return np.asarray(np.sqrt((gap**2).sum(axis=1)) - self.of("true_range_m"))

    def once_a_link(self, draw: Callable[[int], NDArray[np.floating]]) -> Floats:
        """Return values [n] that are drawn once for each link."""
        place, names = pd.factorize(self.frame["link"], sort=True)
        return np.asarray(draw(len(names))[place], np.float64)


def _loose_truth(log: Log, strength: float) -> Gained:
    """Compare with a truth whose age differs a little from row to row."""
    age = 0.085 * strength * log.rng.gamma(40, 1 / 40, len(log.frame))
    return {"m": log.longer(log.carriers_at(age))}


def _rolling(log: Log, strength: float) -> Gained:
    """Roll on during the exchange: what is measured is the mean of the way meanwhile."""
    reply = log.of("reply_time_s") * min(strength, 2.0)
    return {"m": np.mean([log.longer(log.carriers_at(reply * p)) for p in (0.1, 0.5, 0.9)], axis=0)}


def _patch_cables(log: Log, strength: float) -> Gained:
    """So many short cables too many at each crane, and carriers that differ."""
    rng = log.shared("cables")
    crane, carrier = 0.036 * rng.poisson(1.6, len(CRANES_M)), 0.1 * rng.beta(1.5, 4, CARRIERS)
    return {"m": strength * (crane[log.crane()] + carrier[log.carrier()])}


def _cold_start(log: Log, strength: float) -> Gained:
    """Crystals that are apart, and farther apart soon after the shift began."""
    rng = log.shared("crystals")
    crane, carrier = rng.normal(0, 0.014, len(CRANES_M)), rng.uniform(-0.024, 0.024, CARRIERS)
    ppm = crane[log.crane()] - carrier[log.carrier()]
    ppm = ppm * (1 + 0.6 * np.exp(-log.of("time_s") / 2400))
    return {"m": PER_PPM_S * strength * ppm * log.of("reply_time_s")}


def _steeper_off_calm(log: Log, strength: float) -> Gained:
    """Drift the more steeply the farther from 14 degrees C, to both sides."""
    off = log.of("temperature_c") - 14
    return {"m": strength * (0.0032 * off + 1.4e-4 * off * np.abs(off))}


def _heart_shaped(log: Log, strength: float) -> Gained:
    """Late to the front like a power of a cardioid, and weak to the back."""
    turn = np.radians(log.of("azimuth_deg")) - log.shared("front").uniform(0, 2 * np.pi)
    front = (0.5 + 0.5 * np.cos(turn)) ** 1.5
    return {"m": 0.16 * strength * (front - 0.42), "db": 2.6 * min(strength, 1.5) * (front - 1)}


def _gompertz(log: Log, strength: float) -> Gained:
    """Double exponential in the level: falls quickly from weak on, slowly to strong."""
    rise = np.exp(-np.exp(-(log.of("rx_power_dbm") + 86) / 2.8))
    return {"m": strength * (0.05 - 0.14 * rise)}


def _heavy_tailed(log: Log, strength: float) -> Gained:
    return {"m": 0.036 * strength * log.rng.standard_t(4, len(log.frame))}


def _rain(log: Log, strength: float) -> Gained:
    """Lose as a root of the way, in gusts of rain."""
    return {"db": -0.95 * strength * np.sqrt(np.maximum(log.of("true_range_m") - 3, 0))}


def _wrong_light(log: Log, strength: float) -> Gained:
    """Take a wrong speed of light, in radios whose clocks are wrong by some more."""
    each = 0.0036 * log.shared("light").uniform(0.85, 1.15, len(CRANES_M))
    return {"m": strength * each[log.crane()] * log.of("range_m")}


def _cut_off(log: Log, strength: float) -> Gained:
    """Cut digits off."""
    step, range_m = 0.2 * strength, log.of("range_m")
    return {"m": -np.mod(range_m, step)}


def _cargo(log: Log, strength: float) -> Gained:
    """Go through cargo and walls, which are thicker on some links."""
    kinds = log.frame["obstacles"]
    late, lost = (
        np.array([sum(CARGO[one][part] for one in row if one in CARGO) for row in kinds])
        for part in (0, 1)
    )
    thick = log.once_a_link(lambda n: log.rng.gamma(14, 1 / 14, n))
    return {"m": strength * late * thick, "edge_db": -min(strength, 1.5) * lost * thick}


def _off_a_stack(log: Log, strength: float) -> Gained:
    """Hear only what a wall of containers beside the lane returns."""
    share = 0.06 if log.seldom else 0.15
    lost = log.once_a_link(lambda n: (log.rng.random(n) < share) * 1.0)
    beside = log.once_a_link(lambda n: np.asarray(5.5 * log.rng.weibull(2.5, n), np.float64)) * (
        0.35 + 0.65 * strength
    )
    crane, carrier = CRANES_M[log.crane()], log.carriers_at()
    wall = np.maximum(crane[:, 1], carrier[:, 1]) + np.minimum(beside, 12.0)
    mirrored = carrier.copy()
    mirrored[:, 1] = 2 * wall - carrier[:, 1]
    return {"m": lost * log.longer(mirrored), "db": -5.5 * lost}


def tarmac_ray(log: Log, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the ground is in m, and its relative size, [n] each."""
    high, far = log.of("tx_z_m") + log.of("rx_z_m"), log.of("true_range_m")
    flat = np.hypot(*(log.of(f"tx_{a}_m") - log.of(f"rx_{a}_m") for a in "xy"))
    longer = np.hypot(flat, high) - far
    steep = np.arctan2(high, flat)
    return longer, min(0.75 * strength, 0.92) * (1 - np.sin(steep)) ** 1.5


def _tarmac(log: Log, strength: float) -> Gained:
    """Group delay of two rays at the middle of the band, which the pulse blurs."""
    longer, size = tarmac_ray(log, strength)
    size = size * np.exp(-longer / 1.1)
    turn = np.cos(2 * np.pi * longer / WAVE_M)
    power = 1 + size**2 - 2 * size * turn
    late = longer * (size**2 - size * turn) / np.maximum(power, 0.08)
    return {"m": np.clip(late, -0.5, 0.5), "db": 10 * np.log10(np.maximum(power, 0.08))}


def _containers(log: Log, strength: float) -> Gained:
    """Around a stack of containers: a loss that saturates, and the detour by its corner."""
    iron = np.array([row == ["metal"] for row in log.frame["obstacles"]]) * 1.0
    aside = log.once_a_link(lambda n: log.rng.uniform(0.5, 1.7, n)) * strength**0.5
    share = log.once_a_link(lambda n: log.rng.beta(3, 3, n))
    far = log.of("true_range_m")
    first, second = far * share, far * (1 - share)
    detour = np.hypot(first, aside) + np.hypot(second, aside) - far
    lost = 5 + 18 * -np.expm1(-np.sqrt(detour / WAVE_M) / 2.2)
    return {"m": iron * detour, "edge_db": -iron * lost * min(strength, 1.0) ** 0.5}


def _early_stop(log: Log, strength: float) -> Gained:
    """Stop to accumulate the sooner the stronger: by a power, not by a line."""
    over = np.maximum(log.of("rx_power_dbm") + 91, 0) / 10
    return {"count_db": -3.0 * strength * over**1.4, "db": -1.6 * min(strength, 2.0) * over**1.4}


def _drives(log: Log, strength: float) -> Gained:
    """Noise of motor drives, of every crane its own; weak rows scatter more."""
    hiss = strength * log.shared("drives").uniform(0.7, 2.6, len(CRANES_M))[log.crane()]
    weak = 10 ** ((-89 - log.of("rx_power_dbm")) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return {"hiss_db": hiss, "m": 0.03 * weak * log.rng.laplace(0, 0.7, len(weak))}


def _salt(log: Log, strength: float) -> Gained:
    return {"m": -0.2 * strength * np.expm1(-log.of("salt_g_m2") / 2.5)}


def _wind(log: Log, strength: float) -> Gained:
    return {"m": 0.00085 * strength * log.of("wind_m_per_s") ** 2}


def _seiche(log: Log, strength: float) -> Gained:
    """Slow swinging of the water in the basin, and of what floats on it."""
    return {"m": 0.09 * strength * np.cos(2 * np.pi * log.of("time_s") / 2820 - 1.1)}


def _twistlocks(log: Log, strength: float) -> Gained:
    return {"m": np.where(log.of("hook_load_t") > 19, 0.13 * strength, 0.0)}


def _flattened(log: Log, strength: float) -> Gained:
    """Firmware that takes ranges for slant ones from a height, and gives the one on the ground."""
    range_m = np.maximum(log.of("range_m"), 6.0)
    return {"m": np.sqrt(range_m**2 - 5.0 * strength) - range_m}


def _stuck(log: Log, strength: float) -> Gained:
    """One bit of a counter of 4.69 mm is always set."""
    bit = 32 * 0.00469 * strength
    return {"m": bit * (np.floor(log.of("range_m") / bit) % 2 == 0)}


def _late_clock(log: Log, strength: float) -> Gained:
    """One crane's clock is behind: its ranges are put beside places of another time."""
    there = log.longer(log.carriers_at(0.24 * strength))
    return {"m": np.where(log.crane() == 2, there, 0.0)}


def _really_at(log: Log, cranes: Floats) -> Gained:
    """Return what rows gain where cranes really are at [n, 3]."""
    longer = log.longer(log.carriers_at(), cranes)
    return {"m": longer, "db": -20 * np.log10(1 + longer / log.of("true_range_m"))}


def _rolled_on(log: Log, strength: float) -> Gained:
    moved = strength * np.array([0.41, -0.37, 0.22]) * (log.crane() == 5)[:, None]
    return _really_at(log, CRANES_M[log.crane()] + moved)


def _renumbered(log: Log, _: float) -> Gained:
    real = np.array([6, 1, 2, 3, 4, 5, 0, 7])
    return _really_at(log, CRANES_M[real[log.crane()]])


def _fathoms(log: Log, _: float) -> Gained:
    return {"m": (log.crane() == 3) * log.of("range_m") * (1 / FATHOM_M - 1)}


EFFECTS: dict[str, Callable[[Log, float], Gained]] = {
    "time-lag": _loose_truth,
    "exchange-motion": _rolling,
    "antenna-delay": _patch_cables,
    "clock-offset": _cold_start,
    "temperature-drift": _steeper_off_calm,
    "antenna-pattern": _heart_shaped,
    "power-bias": _gompertz,
    "timestamp-jitter": _heavy_tailed,
    "path-loss": _rain,
    "range-scale": _wrong_light,
    "range-rounding": _cut_off,
    "material-delay": _cargo,
    "blocked-path": _off_a_stack,
    "ground-bounce": _tarmac,
    "diffraction": _containers,
    "level-control": _early_stop,
    "noise-floor": _drives,
    "salt-crust": _salt,
    "boom-in-the-wind": _wind,
    "seiche": _seiche,
    "twistlocks-closed": _twistlocks,
    "flattened-by-firmware": _flattened,
    "stuck-bit": _stuck,
    "crane-clock-late": _late_clock,
    "crane-rolled-on": _rolled_on,
    "cranes-renumbered": _renumbered,
    "fathoms-from-one-crane": _fathoms,
}
