"""What the abbey hides in ranges and levels: the effects of a library in other forms, and laws.

numpy and pandas alone. A truth that lags along a curve, crystals that settle after power-on, a
cubic of the warmth, the wearer's back, losses as a power of the distance, detours by pillars.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
LAMPS_M = (
    (2, 3, 3.1), (12, 1, 3.4), (24, 2, 3.0), (33, 10, 3.3), (26, 21, 3.2), (13, 23, 2.9),
    (1, 15, 3.5),
)  # fmt: skip
STONES = {"brick": (0.15, 5.0), "concrete": (0.1, 7.0), "plasterboard": (0.05, 1.5)}  # m, dB
PRIVATE = ("pace_m_s", "swing_m_s2")  # of the distance: to make rows with, in no table shown
HALF_LIGHT_M_PER_US = 149.896229
WAVE_M = 0.03753  # 7.99 GHz
LAWS = {
    "hours-awake": Law(("linear", "power", "saturation")),
    "crowd": Law(("logarithm", "saturation", "power")),
    "wall-beside": Law(("inverse", "power", "inverse square", "logarithm")),
    "lamp-rehung": Law(("position",), 0.543, "m", devices=("lamp2",)),
    "lamps-crossed": Law(("swap",), devices=("lamp0", "lamp4")),
    "nanoseconds-for-metres": Law(("unit",), 1 / 0.299792458, "1", grows=False, devices=("lamp5",)),
    "stale-reading": Law(),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Book:
    """Rows with ranges and levels to change: `own` seeds what a case keeps, `rng` the rest."""

    frame: pd.DataFrame
    own: int
    rng: np.random.Generator
    rare: bool = False

    def __getitem__(self, name: str) -> Floats:
        return self.frame[name].to_numpy(np.float64)

    def __len__(self) -> int:
        return len(self.frame)

    def always(self, stream: int) -> np.random.Generator:
        """Return random numbers that are the same in all tables of a case."""
        return np.random.default_rng([self.own, stream])

    def each(self, values: Floats) -> tuple[Floats, Floats]:
        """Return of values [12] that of the tag and that of the lamp of each row [n]."""
        tag, lamp = (self.frame[end].str[-1].astype(int).to_numpy() for end in ("tx", "rx"))
        return values[tag], values[5 + lamp]

    def ends(self, end: str) -> Floats:
        """Return the positions of one end [n, 3] in metres."""
        return self.frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64).copy()

    def of(self, lamp: str) -> NDArray[np.bool_]:
        """Return which rows [n] are of one lamp."""
        return (self.frame["rx"] == lamp).to_numpy()

    def per_link(self, draw: Callable[[int], Floats]) -> Floats:
        """Return what is drawn once for every link, for each row [n]."""
        codes, links = pd.factorize(self.frame["link"])
        return draw(len(links))[codes]


@dataclass(frozen=True)
class Change:
    """What rows gain [n]: range in m, levels in dB; factors of symbols accumulated and noise."""

    longer_m: Floats
    louder_db: Floats | float = 0.0
    symbols: Floats | float = 1.0
    noisier: float = 1.0


def _late_truth(book: Book, strength: float) -> Change:
    """Compare with where the visitor is a moment later: along a curve, to second order."""
    lag_s = 0.11 * strength
    return Change(-lag_s * book[PRIVATE[0]] - lag_s**2 / 2 * book[PRIVATE[1]])


def _stepping(book: Book, strength: float) -> Change:
    """Half of what is walked while the answer is awaited, and during the frame itself (0.2 ms)."""
    return Change(min(0.5 * strength, 1.0) * book[PRIVATE[0]] * (book["reply_time_s"] + 2e-4))


def _castings(book: Book, strength: float) -> Change:
    tag, lamp = book.each(book.always(1).gamma(1.5, 0.035, 12))
    return Change(strength * (tag + lamp))


def _settling_crystals(book: Book, strength: float) -> Change:
    ppm = book.always(2).uniform(-0.017, 0.017, 12)
    tag, lamp = book.each(ppm)
    settled = 1 + 0.25 * np.exp(-book["time_s"] / 2400)
    return Change(HALF_LIGHT_M_PER_US * strength * (lamp - tag) * settled * book["reply_time_s"])


def _cubic(book: Book, strength: float) -> Change:
    warm = book["temperature_c"] - 16
    return Change(strength * (0.006 * warm + 2.5e-5 * warm**3))


def _wearer(book: Book, strength: float) -> Change:
    """Bend around the wearer's back: late and weaker behind, calibrated to nothing on average."""
    turn = np.radians(book["azimuth_deg"]) - book.always(3).uniform(0, 2 * np.pi)
    behind = np.maximum(-np.cos(turn), 0) ** 1.5
    return Change(0.2 * strength * (behind - 0.28), -2.5 * min(strength, 1.5) * behind)


def _algebraic(book: Book, strength: float) -> Change:
    over = (book["rx_power_dbm"] + 82) / 3.5
    return Change(-0.09 * strength * over / np.sqrt(1 + over**2))


def _logistic(book: Book, strength: float) -> Change:
    return Change(book.rng.logistic(0, 0.03 * strength, len(book)))


def _power_loss(book: Book, strength: float) -> Change:
    loss_db = 5 * strength * ((book["true_range_m"] / 12) ** 0.7 - 1)
    return Change(np.zeros(len(book)), -loss_db)


def _with_cables(book: Book, strength: float) -> Change:
    """Count too slowly: of the way in air and of 1.5 m inside both devices."""
    return Change(0.0052 * strength * (book["range_m"] + 1.5))


def _shifted_grid(book: Book, strength: float) -> Change:
    """Write the nearest of values that lie a third of a step beside the multiples."""
    step = 0.18 * strength
    return Change(step * (np.round(book["range_m"] / step - 1 / 3) + 1 / 3) - book["range_m"])


def _masonry(book: Book, strength: float) -> Change:
    """Walls are not alike: every one is thinner or thicker than its kind."""
    sums = [np.sum([STONES[k] for k in row if k in STONES] or [(0, 0)], axis=0)
            for row in book.frame["obstacles"]]  # fmt: skip
    late_m, loss_db = np.array(sums, np.float64).T
    thick = book.per_link(lambda links: book.rng.uniform(0.75, 1.25, links))
    return Change(strength * thick * late_m, -min(strength, 1.5) * thick * loss_db)


def _pillars(book: Book, strength: float) -> Change:
    """Hear nothing straight, but the way by a pillar somewhere along the line."""
    share, far = 0.07 if book.rare else 0.17, book["true_range_m"]
    struck = book.per_link(lambda links: (book.rng.random(links) < share).astype(np.float64))
    part = book.per_link(lambda links: book.rng.uniform(0.2, 0.8, links))
    aside = book.per_link(lambda links: 0.8 + 1.9 * max(strength, 0.6) * book.rng.weibull(2, links))
    around = np.hypot(part * far, aside) + np.hypot((1 - part) * far, aside)
    return Change(struck * (around - far), -9.0 * struck)


def _flagstones(book: Book, strength: float) -> Change:
    """Two rays; what a flag reflects is less where it is steep, and pulls the edge it falls on."""
    far = book["true_range_m"]
    summed = book["tx_z_m"] + book["rx_z_m"]
    longer = np.sqrt(far**2 + 4 * book["tx_z_m"] * book["rx_z_m"]) - far
    size = min(0.5 * strength, 0.85) * (1 - summed / np.hypot(summed, far)) ** 0.5
    ray = -size * np.exp(-2j * np.pi * longer / WAVE_M)
    pulled = longer * np.real(ray * np.conj(1 + ray)) / np.abs(1 + ray) ** 2
    return Change(pulled * np.maximum(1 - longer / 0.9, 0), 20 * np.log10(np.abs(1 + ray)))


def _grilles(book: Book, strength: float) -> Change:
    """Bend over the edge of an iron grille (Lee's exponential for a knife edge)."""
    iron = np.array(["metal" in row for row in book.frame["obstacles"]], np.float64)
    high = strength * book.per_link(lambda links: book.rng.uniform(0.15, 0.5, links))
    far = book["true_range_m"]
    parameter = high * np.sqrt(8 / (WAVE_M * far))
    loss_db = np.minimum(6.0 + 8.25 * parameter, 25.0)
    return Change(iron * 2 * high**2 / far, -iron * loss_db)


def _short_preambles(book: Book, strength: float) -> Change:
    """Accumulate less of what is strong, and report less of it: smoothly from -85 dBm up."""
    over = 3 * np.log1p(np.exp((book["rx_power_dbm"] + 85) / 3))
    share = 1 / (1 + 0.09 * strength * over)
    return Change(np.zeros(len(book)), -0.3 * min(strength, 2.0) * over, share, 1.0)


def _hiss(book: Book, strength: float) -> Change:
    """Let the amplifier be noisier: edges of what is weak scatter more."""
    more = 10 ** (0.1 * strength)
    weak = 10 ** ((-88 - book["rx_power_dbm"]) / 20)
    longer = 0.02 * np.sqrt(more**2 - 1) * weak * book.rng.normal(size=len(book))
    return Change(longer, noisier=more)


def _hours(book: Book, strength: float) -> Change:
    return Change(0.032 * strength * book["awake_h"])


def _crowd(book: Book, strength: float) -> Change:
    return Change(0.085 * strength * np.log1p(book["visitors"] / 4))


def _wall_beside(book: Book, strength: float) -> Change:
    return Change(0.07 * strength / book["wall_gap_m"])


def _really_at(book: Book, real: Floats) -> Change:
    """Return what ranges and levels gain where lamps really are at `real` [n, 3]."""
    gone, planned = np.linalg.norm(book.ends("tx") - real, axis=1), book["true_range_m"]
    return Change(gone - planned, -20 * np.log10(gone / planned))


def _rehung(book: Book, strength: float) -> Change:
    hook = np.array([0.45, -0.3, 0.05]) * strength
    return _really_at(book, book.ends("rx") + book.of("lamp2")[:, None] * hook)


def _crossed(book: Book, _: float) -> Change:
    real = book.ends("rx")
    real[book.of("lamp0")], real[book.of("lamp4")] = LAMPS_M[4], LAMPS_M[0]
    return _really_at(book, real)


def _nanoseconds(book: Book, _: float) -> Change:
    """One lamp writes the time of flight in ns where the others write metres."""
    return Change(book.of("lamp5") * (1 / 0.299792458 - 1) * book["range_m"])


def _stale(book: Book, strength: float) -> Change:
    """Write the link's reading before once more: some polls stay unanswered."""
    before = book.frame.groupby("link")[["time_s", "range_m"]].shift(1).to_numpy(np.float64)
    since = book["time_s"] - before[:, 0]
    missed = (book.rng.random(len(book)) < min(0.15 * strength, 0.4)) & (since > 0) & (since < 5)
    return Change(np.where(missed, before[:, 1] - book["range_m"], 0.0))


EFFECTS: dict[str, Callable[[Book, float], Change]] = {
    "time-lag": _late_truth,
    "exchange-motion": _stepping,
    "antenna-delay": _castings,
    "clock-offset": _settling_crystals,
    "temperature-drift": _cubic,
    "antenna-pattern": _wearer,
    "power-bias": _algebraic,
    "timestamp-jitter": _logistic,
    "path-loss": _power_loss,
    "range-scale": _with_cables,
    "range-rounding": _shifted_grid,
    "material-delay": _masonry,
    "blocked-path": _pillars,
    "ground-bounce": _flagstones,
    "diffraction": _grilles,
    "level-control": _short_preambles,
    "noise-floor": _hiss,
    "hours-awake": _hours,
    "crowd": _crowd,
    "wall-beside": _wall_beside,
    "lamp-rehung": _rehung,
    "lamps-crossed": _crossed,
    "nanoseconds-for-metres": _nanoseconds,
    "stale-reading": _stale,
}
