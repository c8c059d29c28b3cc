"""What the tunnel hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the tunnel's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
BORE_M = (72.0, 8.4, 5.6)  # length, width, height
NICHES_M = np.array(
    [(2.0, 0.3, 2.4), (13.0, 8.1, 3.1), (25.0, 0.3, 4.3), (36.0, 8.1, 2.2), (47.0, 0.3, 3.4),
     (59.0, 8.1, 4.6), (70.0, 0.3, 2.7)]
)  # fmt: skip
TAGS = 6  # two on each of three trolleys: even ones at the fore, odd ones at the aft
FILLINGS = {"concrete": (0.2, 1.45, 7.0), "brick": (0.24, 0.85, 4.5), "glass": (0.04, 1.5, 2.0)}
"""Of what stands across: thickness in m, refractive index less 1, loss in dB."""
DRIVING = ("along_m_per_s", "gathers_m_per_s2")
CENTIMETRES_PER_PPM_MS = 14.9896229
WAVELENGTH_M = 0.06673  # 4.4928 GHz
FOOT_M = 0.3048
LAWS = {
    "soot-on-radomes": Law(("saturation", "logarithm", "power")),
    "traction-current": Law(("power", "parabola")),
    "slab-joints": Law(("periodic",), 5.2, "m", grows=False),
    "jet-fan-two": Law(("step",), 0.12, "m"),
    "lining-sweats": Law(("linear", "power")),
    "curve-forgotten": Law(("power",)),
    "fore-for-aft": Law(),
    "half-millimetre-word": Law(),
    "niche-resurveyed": Law(("position",), 0.4953, "m", devices=("niche2",)),
    "niches-crossed": Law(("swap",), devices=("niche1", "niche4")),
    "feet-from-one-niche": Law(("unit",), 1 / FOOT_M, "1", grows=False, devices=("niche5",)),
}
"""What nobody's library has."""


class Ledger:
    """Rows and what is booked on them: metres, dB of all, of the first path, of noise; symbols.

    `case` seeds what all tables of a case have in common, `rng` the rest; all arrays are [n].
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.metres, self.db, self.first_db, self.noise_db = np.zeros((4, len(table)))
        self.symbols = np.ones(len(table))
        self.niche = table["rx"].str.slice(5).to_numpy(np.intp)
        self.tag = table["tx"].str.slice(3).to_numpy(np.intp)
        self.away = self["true_range_m"]

    def __getitem__(self, column: str) -> Floats:
        return self.table[column].to_numpy(np.float64)

    def kept(self, purpose: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([613, self.case, purpose])

    def of_link(self, values: Callable[[int], NDArray[np.float64]]) -> Floats:
        """Return values drawn once for each link [n]."""
        code, links = pd.factorize(self.table["link"])
        return values(len(links))[code]

    def tags_at(self, after_s: Floats | float = 0.0) -> Floats:
        """Return where the tags are some time after [n, 3]: trolleys gather or lose speed."""
        place = self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64).copy()
        speed, gathers = (self[name] for name in DRIVING)
        place[:, 0] += speed * after_s + gathers * np.square(after_s) / 2
        return place

    def more_than_true(self, tags: Floats, niches: Floats | None = None) -> Floats:
        """Return by how much ways between other places [n, 3] are longer [n]."""
        ends = NICHES_M[self.niche] if niches is None else niches
        return np.asarray(np.sqrt(np.square(tags - ends).sum(axis=1)) - self.away)

    def with_one_of(self, *kinds: str) -> Floats:
        """Return 1 where one of some kinds stands in the straight path, else 0 [n]."""
        there = [bool({*kinds} & {*row}) for row in self.table["obstacles"]]
        return np.array(there, np.float64)


def _held_places(ledger: Ledger, strength: float) -> None:
    """Compare with places that an odometer gives every 0.13 s, and late."""
    age = 0.035 + np.mod(ledger["time_s"], 0.13) / 4
    ledger.metres += ledger.more_than_true(ledger.tags_at(strength * age))


def _answer_underway(ledger: Ledger, strength: float) -> None:
    """Let the answer find the tag farther on."""
    reply = min(strength, 2.5) * ledger["reply_time_s"]
    ledger.metres += 0.5 * ledger.more_than_true(ledger.tags_at(reply))


def _feeders(ledger: Ledger, strength: float) -> None:
    """Lengths of feeders: of niches as a mason cut them, longer to every fore tag."""
    rng = ledger.kept(1)
    niche = 0.05 * rng.lognormal(0, 0.7, len(NICHES_M))
    tag = np.where(np.arange(TAGS) % 2, 0.0, 0.055) + rng.uniform(-0.02, 0.02, TAGS)
    ledger.metres += strength * (niche[ledger.niche] + tag[ledger.tag])


def _ageing_crystals(ledger: Ledger, strength: float) -> None:
    """Crystals that are apart, those of tags more and more as the night goes on."""
    rng = ledger.kept(2)
    niche, tag = 0.013 * rng.standard_t(8, len(NICHES_M)), rng.triangular(-0.03, 0.0, 0.03, TAGS)
    hours = ledger["time_s"] / 3600
    ppm = niche[ledger.niche] - tag[ledger.tag] * (0.7 + 0.25 * hours)
    reply_ms = 1000 * ledger["reply_time_s"]
    ledger.metres += strength * CENTIMETRES_PER_PPM_MS / 100 * ppm * reply_ms


def _dead_zone(ledger: Ledger, strength: float) -> None:
    """Drift only beyond some degrees from 13: what is within is compensated."""
    off = ledger["temperature_c"] - 13
    ledger.metres += 0.0056 * strength * np.sign(off) * np.maximum(np.abs(off) - 2.5, 0)


def _posts_of_the_cab(ledger: Ledger, strength: float) -> None:
    """Be late and weak behind two posts of the cab, as wide as they are."""
    posts = ledger.kept(3).uniform(-180, 180) + np.array([0.0, 140.0])
    apart = ledger["azimuth_deg"][:, None] - posts
    shade = np.exp(-np.square((apart - 360 * np.round(apart / 360)) / [46.0, 33.0]))
    ledger.metres += strength * (shade @ [0.17, 0.12] - 0.045)
    ledger.db -= min(strength, 1.5) * shade @ [3.1, 2.2]


def _algebraic(ledger: Ledger, strength: float) -> None:
    """Bias by an algebraic S in the level."""
    u = (ledger["rx_power_dbm"] + 81) / 3.4
    ledger.metres += strength * (0.015 - 0.075 * u / np.sqrt(1 + u * u))


def _dithered(ledger: Ledger, strength: float) -> None:
    """Scatter evenly between limits, as of two clocks that are not locked."""
    ledger.metres += 0.075 * strength * ledger.rng.uniform(-1, 1, (2, len(ledger.away))).sum(axis=0)


def _dust_absorbs(ledger: Ledger, strength: float) -> None:
    """Lose so many dB a metre more."""
    ledger.db -= 0.13 * strength * ledger.away


def _wrong_quartz(ledger: Ledger, strength: float) -> None:
    """Count with a quartz that is not the one on the label."""
    ledger.metres += 0.0044 * strength * ledger["range_m"]


def _nearest_step(ledger: Ledger, strength: float) -> None:
    step = 0.19 * strength
    ledger.metres += step * np.rint(ledger["range_m"] / step) - ledger["range_m"]


def _fillings(ledger: Ledger, strength: float) -> None:
    """Go through walls across the bore, thicker ones than on the drawing or thinner ones."""
    thicker = dict(zip(FILLINGS, ledger.kept(4).uniform(0.8, 1.2, len(FILLINGS)), strict=True))
    slant = np.sqrt(np.clip(ledger.away / _along(ledger), 1, 2.5))
    late, lost = np.zeros((2, len(slant)))
    for kind, (thick, slower, db) in FILLINGS.items():
        there = ledger.with_one_of(kind) * thicker[kind] * slant
        late, lost = late + there * thick * slower, lost + there * db
    ledger.metres += strength * late
    ledger.first_db -= min(strength, 1.5) * lost


def _along(ledger: Ledger) -> Floats:
    """Return how far apart the ends are along the bore, 0.2 m at least [n]."""
    return np.maximum(np.abs(ledger["tx_x_m"] - ledger["rx_x_m"]), 0.2)


def _by_the_far_wall(ledger: Ledger, strength: float) -> None:
    """Hear, past parked wagons, only what the wall across the niche returns."""
    part = 0.055 if ledger.rare else 0.17
    parked = ledger.of_link(lambda n: (ledger.rng.random(n) < part).astype(np.float64))
    deeper = ledger.of_link(lambda n: ledger.rng.uniform(0.0, 1.6, n))
    tags, niche_y = ledger.tags_at(), NICHES_M[ledger.niche, 1]
    wall = np.where(niche_y < BORE_M[1] / 2, BORE_M[1] + deeper, -deeper)
    tags[:, 1] = 2 * wall - tags[:, 1]
    later = (0.3 + 0.7 * strength) * ledger.more_than_true(tags)
    ledger.metres += parked * np.minimum(later, 9.0)
    ledger.db -= 6.5 * parked


def trackbed_ray(ledger: Ledger, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the track bed is in m, and its signed size, [n] each.

    Fresnel, vertical polarisation: beyond Brewster's angle the sign turns.
    """
    image = ledger.tags_at() * [1.0, 1.0, -1.0]
    longer = ledger.more_than_true(image)
    sine = (ledger["tx_z_m"] + ledger["rx_z_m"]) / (ledger.away + longer)
    root = np.sqrt(6.2 - 1 + sine**2)
    return longer, np.clip(1.2 * strength * (6.2 * sine - root) / (6.2 * sine + root), -0.9, 0.9)


def _trackbed(ledger: Ledger, strength: float) -> None:
    """Find where the rise of two pulses together reaches half of what it comes to."""
    longer, size = trackbed_ray(ledger, strength)
    grid = np.arange(-1.0, 0.75, 0.01)  # m after the direct pulse's middle
    rise = [0.5 - 0.5 * np.cos(np.pi * np.clip(g / 0.8 + 1, 0, 2)) for g in _both(grid, longer)]
    turn = size * np.exp(-2j * np.pi * longer / WAVELENGTH_M)
    height = np.abs(rise[0] + turn[:, None] * rise[1])
    half = (height >= 0.5 * height.max(axis=1, keepdims=True)).argmax(axis=1)
    ledger.metres += 0.9 * (grid[half] + 0.4)
    power = np.square(height).sum(axis=1) / np.square(rise[0]).sum()
    ledger.db += 10 * np.log10(power)


def _both(grid: Floats, longer: Floats) -> tuple[Floats, Floats]:
    """Return a grid in m seen from the direct pulse [1, k] and from the later one [n, k]."""
    return grid[None], grid - longer[:, None]


def _wagon_edge(ledger: Ledger, strength: float) -> None:
    """Bend over a wagon's edge: the loss in the shadow, and both legs of the way."""
    steel = ledger.with_one_of("metal")
    high = ledger.of_link(lambda n: ledger.rng.uniform(0.25, 0.75, n)) * np.sqrt(strength)
    first = ledger.away * ledger.of_link(lambda n: ledger.rng.beta(2.5, 2.5, n))
    first = np.clip(first, 0.1 * ledger.away, 0.9 * ledger.away)
    last = ledger.away - first
    depth = high * np.sqrt(2 / WAVELENGTH_M * (1 / first + 1 / last))
    lost = np.minimum(20 * np.log10(2 + 4.44 * depth), 24)
    ledger.metres += steel * (np.hypot(first, high) + np.hypot(last, high) - ledger.away)
    ledger.first_db -= steel * lost * min(strength, 1.0) ** 0.5


def _hyperbolic_hold(ledger: Ledger, strength: float) -> None:
    """Sum up fewer symbols by a hyperbola, and let the level come to a limit."""
    over = np.maximum(ledger["rx_power_dbm"] + 84, 0)
    ledger.symbols *= 1 / (1 + strength * over / 8)
    ledger.db -= min(strength, 2.0) * over * over / (over + 14)


def _inverters(ledger: Ledger, strength: float) -> None:
    """Noise of inverters, most at the niches beside them; weak rows scatter the more."""
    db = 1.4 * strength * (0.5 + ledger.kept(5).exponential(0.6, len(NICHES_M)))[ledger.niche]
    weak = 10 ** ((-88 - ledger["rx_power_dbm"]) / 20)
    grown = np.sqrt(10 ** (db / 10) - 1)
    ledger.noise_db += db
    ledger.metres += 0.02 * weak * grown * ledger.rng.uniform(-1.7, 1.7, len(db))


def _soot(ledger: Ledger, strength: float) -> None:
    soot = ledger["soot_g_m2"]
    ledger.metres += 0.25 * strength * soot / (soot + 1.8)


def _traction(ledger: Ledger, strength: float) -> None:
    ledger.metres += 0.19 * strength * np.square(ledger["rail_current_a"] / 600)


def _joints(ledger: Ledger, strength: float) -> None:
    """Places from a wheel that slips at the joints of slabs."""
    ledger.metres += 0.08 * strength * np.sin(2 * np.pi * ledger["odometer_m"] / 5.2 - 0.6)


def _second_fan(ledger: Ledger, strength: float) -> None:
    ledger.metres += np.where(ledger["fan_hz"] >= 27, 0.12 * strength, 0.0)


def _sweat(ledger: Ledger, strength: float) -> None:
    ledger.metres += 0.0031 * strength * ledger["humidity_pct"]


def _bend(ledger: Ledger, strength: float) -> None:
    """Take places from a straight drawing of a curved bore: ways are chords of an arc."""
    ledger.metres -= strength * ledger.away**3 / (24 * 190.0**2)


def _fore_for_aft(ledger: Ledger, strength: float) -> None:
    """Write a range of a trolley's other tag now and then."""
    taken = ledger.rng.random(len(ledger.away)) < min(0.11 * strength, 0.4)
    there = ledger.tags_at()
    there[:, 0] += np.where(ledger.tag % 2, 1, -1) * ledger["apart_m"]
    ledger.metres += np.where(taken, ledger.more_than_true(there), 0.0)


def _word(ledger: Ledger, _: float) -> None:
    """Keep ranges in sixteen bits of half a millimetre: they begin anew after 32.768 m."""
    ledger.metres += np.mod(ledger["range_m"], 32.768) - ledger["range_m"]


def _niches_at(ledger: Ledger, niches: Floats) -> None:
    """Book what changes where niches are truly at [n, 3]."""
    longer = ledger.more_than_true(ledger.tags_at(), niches)
    ledger.metres += longer
    ledger.db -= 20 * np.log10(1 + longer / ledger.away)


def _resurveyed(ledger: Ledger, strength: float) -> None:
    moved = strength * np.outer(ledger.niche == 2, [-0.37, 0.29, -0.156])
    _niches_at(ledger, NICHES_M[ledger.niche] + moved)


def _crossed(ledger: Ledger, _: float) -> None:
    _niches_at(ledger, NICHES_M[np.array([0, 4, 2, 3, 1, 5, 6])[ledger.niche]])


def _feet(ledger: Ledger, _: float) -> None:
    ledger.metres += (ledger.niche == 5) * ledger["range_m"] * (1 / FOOT_M - 1)


EFFECTS: dict[str, Callable[[Ledger, float], None]] = {
    "time-lag": _held_places,
    "exchange-motion": _answer_underway,
    "antenna-delay": _feeders,
    "clock-offset": _ageing_crystals,
    "temperature-drift": _dead_zone,
    "antenna-pattern": _posts_of_the_cab,
    "power-bias": _algebraic,
    "timestamp-jitter": _dithered,
    "path-loss": _dust_absorbs,
    "range-scale": _wrong_quartz,
    "range-rounding": _nearest_step,
    "material-delay": _fillings,
    "blocked-path": _by_the_far_wall,
    "ground-bounce": _trackbed,
    "diffraction": _wagon_edge,
    "level-control": _hyperbolic_hold,
    "noise-floor": _inverters,
    "soot-on-radomes": _soot,
    "traction-current": _traction,
    "slab-joints": _joints,
    "jet-fan-two": _second_fan,
    "lining-sweats": _sweat,
    "curve-forgotten": _bend,
    "fore-for-aft": _fore_for_aft,
    "half-millimetre-word": _word,
    "niche-resurveyed": _resurveyed,
    "niches-crossed": _crossed,
    "feet-from-one-niche": _feet,
}
