"""What the mill hides in ranges and levels: a library's effects in other forms, laws and faults.

numpy and pandas alone; shared by the mill's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
POSTS_M = np.array(
    [(1.0, 1.5, 4.2), (9.5, 0.6, 2.4), (18.0, 1.1, 5.0), (25.2, 5.0, 3.6), (24.6, 12.8, 4.6),
     (15.5, 13.4, 2.2), (7.0, 13.1, 5.2), (0.8, 8.8, 3.0)]
)  # fmt: skip
HALL_M = (26.0, 14.0, 6.5)
SACKS = 7
FABRIC = {  # refractive index, thickness in m, loss in dB
    "brick": (1.95, 0.15, 5.5),
    "concrete": (2.3, 0.12, 8.0),
    "wood": (1.45, 0.14, 1.4),
}
PRIVATE = ("sway_x_m", "sway_y_m", "sway_z_m", "beat_rad_s", "turned_rad")
METRES_PER_PPM_S = 149.896229  # half the speed of light times 1e-6
WAVE_M = 0.0751  # 3.99 GHz
LAWS = {
    "flour-dust": Law(("saturation", "logarithm", "power")),
    "wheel-turns": Law(("periodic",), 37.0, "s", grows=False),
    "belt-load": Law(("power", "parabola")),
    "sluice-open": Law(("step",), 0.14, "m"),
    "neighbour-answers": Law(),
    "post-sunk": Law(("position",), 0.631, "m", devices=("post3",)),
    "posts-confused": Law(("swap",), devices=("post1", "post6")),
    "there-and-back": Law(("unit",), 2.0, "1", grows=False, devices=("post4",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Change:
    """What rows gain [n]: range in m; levels in dB, of all or the straight path; factors."""

    longer_m: Floats | float = 0.0
    louder_db: Floats | float = 0.0
    straight_db: Floats | float = 0.0
    symbols: Floats | float = 1.0
    noisier: Floats | float = 1.0


@dataclass(frozen=True)
class Rows:
    """Rows to change: `own` seeds what all tables of a case have in common, `rng` the rest."""

    frame: pd.DataFrame
    own: int
    rng: np.random.Generator
    rare: bool = False

    def __getitem__(self, name: str) -> Floats:
        return self.frame[name].to_numpy(np.float64)

    def __len__(self) -> int:
        return len(self.frame)

    def common(self, stream: int) -> np.random.Generator:
        """Return random numbers that are the same in all tables of a case."""
        return np.random.default_rng([self.own, 7, stream])

    def number(self, end: str) -> NDArray[np.intp]:
        """Return the number of the sack or post of each row."""
        return self.frame[end].str.extract(r"(\d+)$")[0].to_numpy(np.intp)

    def at(self, end: str) -> Floats:
        """Return the positions of one end [n, 3] in metres."""
        return self.frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64).copy()

    def from_post(self, sack: Floats) -> Floats:
        """Return how far positions [n, 3] are from the posts of the rows [n]."""
        return np.asarray(np.linalg.norm(sack - self.at("rx"), axis=1))

    def swung(self, ahead: Floats, larger: Floats | float = 1.0) -> Floats:
        """Return sacks' positions [n, 3] at another phase of their swing, and of a larger one."""
        sway = self.frame[list(PRIVATE[:3])].to_numpy(np.float64)
        turned = self["turned_rad"]
        step = larger * np.sin(turned + ahead) - np.sin(turned)
        return self.at("tx") + sway * step[:, None]

    def by_link(self, draw: Callable[[int], Floats]) -> Floats:
        """Return one drawn value per link, for each row [n]."""
        codes, links = pd.factorize(self.frame["link"])
        return draw(len(links))[codes]

    def with_in(self, kind: str) -> Floats:
        """Return 1 for rows with something of a kind in the straight path, else 0 [n]."""
        return np.array([float(kind in row) for row in self.frame["obstacles"]])


Effect = Callable[[Rows, float], Change]


def _filtered_truth(rows: Rows, strength: float) -> Change:
    """Compare with a reference that a first-order filter makes late and too calm."""
    slow = rows["beat_rad_s"] * 0.13 * strength
    real = rows.swung(np.arctan(slow), np.hypot(1, slow))
    return Change(rows.from_post(real) - rows["true_range_m"])


def _swing_on(rows: Rows, strength: float) -> Change:
    """Half of the way between poll and answer."""
    later = rows.swung(rows["beat_rad_s"] * rows["reply_time_s"])
    return Change(min(0.5 * strength, 1.0) * (rows.from_post(later) - rows["true_range_m"]))


def _two_batches(rows: Rows, strength: float) -> Change:
    """Draw posts from two batches of boards, and sacks that differ a little."""
    rng = rows.common(1)
    post = np.where(rng.random(len(POSTS_M)) < 0.4, 0.13, 0.02)
    post = post + rng.normal(0, 0.015, len(POSTS_M))
    sack = rng.triangular(-0.03, 0.02, 0.1, SACKS)
    return Change(strength * (post[rows.number("rx")] + sack[rows.number("tx")]))


def _turning_points(rows: Rows, strength: float) -> Change:
    """Crystals that are apart by an offset, and slowest at a warmth of their own."""
    rng = rows.common(2)
    post, sack = rng.normal(0, 0.012, len(POSTS_M)), rng.normal(0.005, 0.012, SACKS)
    bend = rng.uniform(1e-5, 4e-5, SACKS)[rows.number("tx")]
    ppm = post[rows.number("rx")] - sack[rows.number("tx")]
    ppm = ppm + bend * (rows["temperature_c"] - 25) ** 2
    return Change(METRES_PER_PPM_S * strength * ppm * rows["reply_time_s"])


def _hinge(rows: Rows, strength: float) -> Change:
    """Little below 24 degrees C, and more and more linear above."""
    warm = rows["temperature_c"] - 24
    return Change(strength * (0.0012 * warm + 0.0045 * 4 * np.logaddexp(0, warm / 4) - 0.02))


def _three_lobes(rows: Rows, strength: float) -> Change:
    turn = np.radians(rows["azimuth_deg"])
    one, three = rows.common(3).uniform(0, 2 * np.pi, 2)
    lobes = np.cos(turn - one) + 0.35 * np.cos(3 * turn - three)
    return Change(0.075 * strength * lobes, 1.2 * min(strength, 1.5) * (lobes / 1.35 - 1))


def _arctangent(rows: Rows, strength: float) -> Change:
    over = (rows["rx_power_dbm"] + 80) / 2.2
    return Change(-0.075 * strength * np.arctan(over) + 0.02 * strength)


def _now_and_then(rows: Rows, strength: float) -> Change:
    """Mostly a small scatter, and a larger one now and then."""
    wide = np.where(rows.rng.random(len(rows)) < 0.2, 3.0, 1.0)
    return Change(0.035 * strength * wide * rows.rng.normal(size=len(rows)))


def _beyond(rows: Rows, strength: float) -> Change:
    """Fall faster beyond a break, which is soft."""
    ratio = rows["true_range_m"] / 7
    return Change(louder_db=-17 * strength * np.log10(1 + ratio**3) / 3)


def _wrong_divider(rows: Rows, strength: float) -> Change:
    part = 0.0055 * strength
    return Change(rows["range_m"] * part / (1 - part))


def _cell_middles(rows: Rows, strength: float) -> Change:
    """Write the middle of the cell that a range falls in."""
    step = 0.22 * strength
    return Change(step * (np.floor(rows["range_m"] / step) + 0.5) - rows["range_m"])


def _fabric(rows: Rows, strength: float) -> Change:
    """Go slower in walls along the axes of the building, for longer where they are met aslant."""
    kinds = [[FABRIC[k] for k in row if k in FABRIC] for row in rows.frame["obstacles"]]
    late = np.array([sum((index - 1) * thick for index, thick, _ in row) for row in kinds])
    loss = np.array([sum(db for *_, db in row) for row in kinds])
    way = np.abs(rows.at("tx") - rows.at("rx"))
    aslant = np.minimum(np.linalg.norm(way, axis=1) / np.maximum(way[:, :2].max(axis=1), 0.1), 1.8)
    return Change(strength * late * aslant, straight_db=-min(strength, 1.5) * loss * aslant)


def _by_the_wall(rows: Rows, strength: float) -> Change:
    """Hear only what a wall of machines along the hall returns, at a depth that links differ in."""
    share = 0.06 if rows.rare else 0.16
    struck = rows.by_link(lambda n: (rows.rng.random(n) < share).astype(np.float64))
    depth = rows.by_link(lambda n: rows.rng.gamma(4.0, 0.8, n))
    depth = np.minimum(depth * (0.4 + 0.6 * strength), 7.0)
    far = rows["true_range_m"]
    return Change(struck * (np.hypot(far, 2 * depth) - far), -7.0 * struck)


def floor_ray(rows: Rows, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the floor is in m, and its size, as of a dielectric."""
    far, summed = rows["true_range_m"], rows["tx_z_m"] + rows["rx_z_m"]
    longer = np.sqrt(far**2 + 4 * rows["tx_z_m"] * rows["rx_z_m"]) - far
    sine = summed / np.hypot(summed, far)
    root = np.sqrt(5.5 - (1 - sine**2))
    return longer, np.clip(0.8 * strength * np.abs((sine - root) / (sine + root)), 0, 0.88)


def _wet_floor(rows: Rows, strength: float) -> Change:
    """Shift the middle of the energy of two rays by half of what it moves."""
    longer, size = floor_ray(rows, strength)
    near = np.exp(-((longer / 0.55) ** 2))
    beat = size * np.cos(2 * np.pi * longer / WAVE_M) * near
    seen = size**2 * near
    power = np.maximum(1 + seen - 2 * beat, 0.05)
    return Change(0.5 * longer * (seen - beat) / power, 10 * np.log10(power))


def _machines(rows: Rows, strength: float) -> Change:
    """Bend around an iron machine somewhere along the way: a rational loss, and both detours."""
    iron, far = rows.with_in("metal"), rows["true_range_m"]
    high = rows.by_link(lambda n: rows.rng.triangular(0.15, 0.3, 0.6, n)) * np.sqrt(strength)
    place = rows.by_link(lambda n: rows.rng.uniform(0.25, 0.75, n))
    near, rest = place * far, (1 - place) * far
    bend = high * np.sqrt(2 * far / (WAVE_M * near * rest))
    loss = 10 * np.log10(4 + 2 * (np.pi * bend) ** 2)
    longer = np.hypot(near, high) + np.hypot(rest, high) - far
    return Change(iron * longer, straight_db=-iron * np.minimum(loss, 22) * min(strength, 1) ** 0.5)


def _hard_knee(rows: Rows, strength: float) -> Change:
    """Count fewer symbols of what is above a knee, and report it weaker."""
    over = np.maximum(rows["rx_power_dbm"] + 82, 0)
    return Change(
        louder_db=-0.25 * min(strength, 2) * over, symbols=10 ** (-0.025 * strength * over)
    )


def _noisy_posts(rows: Rows, strength: float) -> Change:
    """Noisier amplifiers in all posts, in some more: the ranges of weak rows scatter more."""
    more = 10 ** (0.09 * strength * rows.common(4).uniform(0.8, 1.3, len(POSTS_M)))
    factor = more[rows.number("rx")]
    weak = 10 ** ((-88 - rows["rx_power_dbm"]) / 20)
    longer = 0.022 * np.sqrt(factor**2 - 1) * weak * rows.rng.normal(size=len(rows))
    return Change(longer, noisier=factor)


def _dust(rows: Rows, strength: float) -> Change:
    return Change(0.24 * strength * rows["dust_g_m3"] / (rows["dust_g_m3"] + 6))


def _wheel(rows: Rows, strength: float) -> Change:
    return Change(0.085 * strength * np.sin(2 * np.pi * rows["time_s"] / 37 + 0.8))


def _load(rows: Rows, strength: float) -> Change:
    return Change(0.2 * strength * (rows["belt_load_kg"] / 240) ** 2)


def _sluice(rows: Rows, strength: float) -> Change:
    return Change(0.14 * strength * np.where(rows["sluice_cm"] > 31, 1.0, 0.0))


def _neighbour(rows: Rows, strength: float) -> Change:
    """Let the next post answer some polls in place of the one that was asked."""
    other = POSTS_M[(rows.number("rx") + 1) % len(POSTS_M)]
    far = np.linalg.norm(rows.at("tx") - other, axis=1)
    taken = rows.rng.random(len(rows)) < min(0.06 * strength, 0.2)
    return Change(taken * (far - rows["true_range_m"]))


def _moved(rows: Rows, real: Floats) -> Change:
    """Return what changes where posts really are at `real` [n, 3]."""
    gone = np.linalg.norm(rows.at("tx") - real, axis=1)
    return Change(
        np.asarray(gone - rows["true_range_m"]), -20 * np.log10(gone / rows["true_range_m"])
    )


def _sunk(rows: Rows, strength: float) -> Change:
    there = (rows.frame["rx"] == "post3").to_numpy()[:, None]
    return _moved(rows, rows.at("rx") + strength * there * np.array([-0.4, 0.35, -0.34]))


def _confused(rows: Rows, _: float) -> Change:
    real, number = rows.at("rx"), rows.number("rx")
    real[number == 1], real[number == 6] = POSTS_M[6], POSTS_M[1]
    return _moved(rows, real)


def _twice(rows: Rows, _: float) -> Change:
    return Change((rows.number("rx") == 4) * rows["range_m"])


EFFECTS: dict[str, Effect] = {
    "time-lag": _filtered_truth,
    "exchange-motion": _swing_on,
    "antenna-delay": _two_batches,
    "clock-offset": _turning_points,
    "temperature-drift": _hinge,
    "antenna-pattern": _three_lobes,
    "power-bias": _arctangent,
    "timestamp-jitter": _now_and_then,
    "path-loss": _beyond,
    "range-scale": _wrong_divider,
    "range-rounding": _cell_middles,
    "material-delay": _fabric,
    "blocked-path": _by_the_wall,
    "ground-bounce": _wet_floor,
    "diffraction": _machines,
    "level-control": _hard_knee,
    "noise-floor": _noisy_posts,
    "flour-dust": _dust,
    "wheel-turns": _wheel,
    "belt-load": _load,
    "sluice-open": _sluice,
    "neighbour-answers": _neighbour,
    "post-sunk": _sunk,
    "posts-confused": _confused,
    "there-and-back": _twice,
}
