"""What the attic hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the attic's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
HOUSE_M = (18.4, 9.2, 3.3)  # length, width, and height of the ridge
EAVES_M = 0.7
BEAMS_M = np.array(
    [(0.6, 4.4, 2.6), (5.2, 1.6, 1.3), (9.1, 7.4, 1.5), (17.6, 5.0, 2.4), (13.2, 1.4, 1.2),
     (3.4, 7.9, 1.1), (15.0, 6.8, 1.7)]
)  # fmt: skip
CRAWLERS = 6
LAYERS = {  # what each costs straight through: metres late, dB
    "brick": (0.16, 6.0),
    "plasterboard": (0.03, 0.9),
    "chipboard": (0.07, 2.4),
    "wood": (0.09, 2.0),
}
STEERING = ("pace_m_per_s", "turn_rad_per_s", "heading_rad")
HALF_LIGHT = 149.896229  # metres per ppm and second of reply
WAVELENGTH_M = 0.0667  # 4.49 GHz
LAWS = {
    "swollen-timber": Law(("linear", "power")),
    "rain-on-slates": Law(("logarithm", "saturation", "power")),
    "fan-shakes": Law(("power", "parabola")),
    "wool-spread": Law(("step",), 0.11, "m"),
    "drum-off-centre": Law(("periodic",), 7.3, "m", grows=False),
    "rows-exchanged": Law(),
    "no-less-than": Law(),
    "beam-sagged": Law(("position",), 0.4514, "m", devices=("beam2",)),
    "beams-mixed-up": Law(("swap",), devices=("beam1", "beam5")),
    "decimetres-from-one-beam": Law(("unit",), 10.0, "1", grows=False, devices=("beam4",)),
}
"""What nobody's library has."""


class Toll(NamedTuple):
    """What rows gain [n]: metres, dB of all and of the first path; factors of noise, symbols."""

    m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    hiss: Floats | float = 1.0
    symbols: Floats | float = 1.0


class Slate:
    """Rows that are about to change; `case` seeds what all tables of a case have in common."""

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, seldom: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.seldom = table, case, rng, seldom
        numbers = {name: table[name].to_numpy(np.float64) for name in STEERING}
        self.pace, self.turn, self.heading = numbers.values()
        self.far = table["true_range_m"].to_numpy(np.float64)
        self.level = table["rx_power_dbm"].to_numpy(np.float64)
        self.beam = np.array([int(name[4:]) for name in table["rx"]])
        self.crawler = np.array([int(name[7:]) for name in table["tx"]])

    def __call__(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    def warmth(self) -> Floats:
        """Return degrees C [n]; where none are logged it is 17 everywhere."""
        return self("temperature_c") if "temperature_c" in self.table else 17.0 + 0 * self.far

    def always(self, stream: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([stream, 513, self.case])

    def per_link(self, draw: Callable[[int], Floats]) -> Floats:
        """Return one value for each link [n]."""
        which, links = pd.factorize(self.table["link"])
        return np.asarray(draw(len(links)), np.float64)[which]

    def crawlers(self, late_s: Floats | float = 0.0) -> Floats:
        """Return where crawlers are so much later, on the arcs that they crawl [n, 3]."""
        here = self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64).copy()
        after = self.heading + self.turn * late_s
        here[:, 0] += self.pace / self.turn * (np.sin(after) - np.sin(self.heading))
        here[:, 1] -= self.pace / self.turn * (np.cos(after) - np.cos(self.heading))
        return here

    def gap(self, crawlers: Floats, beams: Floats | None = None) -> Floats:
        """Return the distances between crawlers and beams [n, 3], theirs unless given, [n]."""
        to = BEAMS_M[self.beam] if beams is None else beams
        return np.asarray(np.linalg.norm(crawlers - to, axis=1))

    def iron(self) -> Floats:
        """Return 1 for rows with a tank in the straight path, else 0 [n]."""
        return np.array([1.0 if "metal" in row else 0.0 for row in self.table["obstacles"]])


def _camera_behind(slate: Slate, strength: float) -> Toll:
    """Compare with a camera's places, that are a mean over some frames before."""
    ages = 0.19 * strength * np.array([0.4, 0.8, 1.2, 1.6])
    return Toll(np.mean([slate.gap(slate.crawlers(age)) for age in ages], axis=0) - slate.far)


def _crawling_on(slate: Slate, strength: float) -> Toll:
    """Measure the way of the answer alone where the crawler is by then."""
    later = slate.gap(slate.crawlers(slate("reply_time_s") * min(strength, 2.0)))
    return Toll((later - slate.far) / 2)


def _matching_coils(slate: Slate, strength: float) -> Toll:
    """Coils that detune: some beams' are good, some crawlers' are bad."""
    rng = slate.always(1)
    beams, crawlers = 0.06 * rng.weibull(1.3, len(BEAMS_M)), rng.normal(0.01, 0.03, CRAWLERS)
    return Toll(strength * (beams[slate.beam] + crawlers[slate.crawler]))


def _soft_crystals(slate: Slate, strength: float) -> Toll:
    """Crystals that are apart, the farther the hotter it is, by a factor e every 40 degrees."""
    rng = slate.always(2)
    apart = rng.laplace(0, 0.01, CRAWLERS)[slate.crawler] - 0.004
    apart = apart + rng.normal(0, 0.008, len(BEAMS_M))[slate.beam]
    hotter = np.exp((slate.warmth() - 15) / 40)
    return Toll(HALF_LIGHT * strength * apart * hotter * slate("reply_time_s"))


def _logistic_warmth(slate: Slate, strength: float) -> Toll:
    """Go over from one delay to another around 19 degrees C."""
    return Toll(0.12 * strength * (1 / (1 + np.exp((19 - slate("temperature_c")) / 6)) - 0.4))


def _whip(slate: Slate, strength: float) -> Toll:
    """Bend a whip: late to one side and early to the other, with two flat maxima."""
    side = np.radians(slate("azimuth_deg")) - slate.always(3).uniform(0, 2 * np.pi)
    bent = np.tanh(2.2 * np.sin(side)) + 0.4 * np.sin(2 * side)
    return Toll(0.06 * strength * bent, 1.1 * min(strength, 1.5) * (np.cos(2 * side) - 1))


def _steps_of_gain(slate: Slate, strength: float) -> Toll:
    """Add a bias for each setting of an amplifier: stairs in the level, with round edges."""
    edges, heights = (-90.0, -83.0, -76.0), (-0.035, -0.06, -0.04)
    stairs = sum(
        h / (1 + np.exp((e - slate.level) / 0.7)) for e, h in zip(edges, heights, strict=True)
    )
    return Toll(strength * (0.05 + stairs))


def _lopsided(slate: Slate, strength: float) -> Toll:
    """Scatter to the long side more than to the short one, none on average."""
    return Toll(0.042 * strength * (slate.rng.gamma(2.0, 1.0, len(slate.far)) - 2.0))


def _foil(slate: Slate, strength: float) -> Toll:
    """Lose more along foil: as the square of the logarithm of the way."""
    return Toll(all_db=-6.2 * strength * np.log10(1 + slate.far) ** 2)


def _counts_before_delays(slate: Slate, strength: float) -> Toll:
    """Scale counts before what cables add is taken off."""
    return Toll(0.0085 * strength * (slate("range_m") + 0.9))


def _by_chance(slate: Slate, strength: float) -> Toll:
    """Round up or down by chance, the nearer the likelier."""
    step = 0.16 * strength
    ratio = slate("range_m") / step
    down = np.floor(ratio)
    up = slate.rng.random(len(ratio)) < ratio - down
    return Toll(step * (down + up) - slate("range_m"))


def _layers(slate: Slate, strength: float) -> Toll:
    """Go through layers along the ridge or across: longer where they are met aslant."""
    cost = [np.sum([LAYERS[k] for k in row if k in LAYERS] + [(0.0, 0.0)], axis=0)
            for row in slate.table["obstacles"]]  # fmt: skip
    late, lost = np.array(cost).T
    across = np.abs(slate.crawlers() - BEAMS_M[slate.beam])[:, :2].max(axis=1) / slate.far
    slant = np.minimum(1 + 0.45 * (1 / np.maximum(across, 0.3) - 1), 1.7)
    return Toll(strength * late * slant, first_db=-min(strength, 1.5) * lost * slant)


def _over_the_ridge(slate: Slate, strength: float) -> Toll:
    """Hear only what comes by a plate at the ridge, somewhere along it."""
    share = 0.06 if slate.seldom else 0.16
    struck = slate.per_link(lambda n: np.where(slate.rng.random(n) < share, 1.0, 0.0))
    along = slate.per_link(lambda n: slate.rng.uniform(-2.5, 2.5, n)) * strength
    crawlers, beams = slate.crawlers(), BEAMS_M[slate.beam]
    plate = (crawlers + beams) / 2 + along[:, None] * [1.0, 0.0, 0.0]
    plate[:, 1:] = HOUSE_M[1] / 2, HOUSE_M[2]
    by = np.linalg.norm(crawlers - plate, axis=1) + np.linalg.norm(beams - plate, axis=1)
    return Toll(struck * (by - slate.far), -8.0 * struck)


def boards_ray(slate: Slate, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the boards of the floor is in m, and its size [n]."""
    down = slate("tx_z_m") * slate("rx_z_m")
    longer = 4 * down / (slate.far + np.sqrt(slate.far**2 + 4 * down))
    angle = np.arcsin(np.clip((slate("tx_z_m") + slate("rx_z_m")) / (slate.far + longer), 0, 1))
    return longer, min(0.7 * strength, 0.9) * np.exp(-angle / 0.55)


def _boards(slate: Slate, strength: float) -> Toll:
    """Shift the top of the sum of two bell-shaped pulses, looked for on a grid."""
    longer, size = boards_ray(slate, strength)
    grid = np.arange(-0.5, 0.7, 0.01)
    turn = -size * np.exp(-2j * np.pi * longer / WAVELENGTH_M)
    both = np.cosh(grid / 0.26)[None] ** -2.0 + 0j
    both = both + turn[:, None] * np.cosh((grid - longer[:, None]) / 0.26) ** -2.0
    power = np.abs(both) ** 2
    alone = (np.cosh(grid / 0.26) ** -4.0).sum()
    return Toll(0.7 * grid[power.argmax(axis=1)], 10 * np.log10(power.sum(axis=1) / alone))


def _tanks(slate: Slate, strength: float) -> Toll:
    """Creep around a round tank: two tangents and an arc, and a loss that the arc makes."""
    radius = slate.per_link(lambda n: slate.rng.uniform(0.3, 0.6, n)) * strength**0.5
    radius = np.minimum(radius, 0.3 * slate.far)
    beside = slate.per_link(lambda n: slate.rng.uniform(0.0, 0.8, n)) * radius
    half = slate.far / 2
    reach = np.hypot(half, beside)
    arc = 2 * (np.arccos(beside / reach) - np.arccos(radius / reach))
    arc = np.maximum(arc, 0.0)
    longer = 2 * np.sqrt(reach**2 - radius**2) + radius * arc - slate.far
    lost = 4.5 + 7.5 * arc * (2 * np.pi * radius / WAVELENGTH_M) ** (1 / 3)
    tank = slate.iron() * min(strength, 1.0) ** 0.5
    return Toll(slate.iron() * np.maximum(longer, 0), first_db=-tank * np.minimum(lost, 23))


def _gain_loop(slate: Slate, strength: float) -> Toll:
    """Hold symbols back with the exponential of the level, and squeeze the level softly."""
    strong = np.logaddexp(0, (slate.level + 79) / 2.5)
    symbols = np.exp(-0.11 * strength * strong)
    return Toll(all_db=-0.6 * min(strength, 2.0) * strong, symbols=np.maximum(symbols, 0.08))


def _hot_receivers(slate: Slate, strength: float) -> Toll:
    """Noise that grows with the heat of the beams, which is not the same to all."""
    heat = np.maximum(slate.warmth() + 25, 2)
    gain = 0.011 * slate.always(4).uniform(0.6, 1.5, len(BEAMS_M))[slate.beam]
    hiss = (1 + gain * heat) ** strength
    weak = 10 ** ((-87 - slate.level) / 20) * np.sqrt(hiss**2 - 1)
    return Toll(0.028 * weak * slate.rng.triangular(-2, 0, 2, len(weak)), hiss=hiss)


def _timber(slate: Slate, strength: float) -> Toll:
    return Toll(0.0125 * strength * (slate("damp_pct") - 8))


def _wet_slates(slate: Slate, strength: float) -> Toll:
    return Toll(0.075 * strength * np.log1p(slate("rain_mm_h") / 0.9))


def _fan(slate: Slate, strength: float) -> Toll:
    return Toll(0.17 * strength * (slate("fan_rpm") / 1500) ** 2.4)


def _wool(slate: Slate, strength: float) -> Toll:
    return Toll(np.where(slate("wool_cm") >= 21, 0.11 * strength, 0.0))


def _drum(slate: Slate, strength: float) -> Toll:
    """Odometry by a cable whose drum is off its centre, once a turn of 7.3 m."""
    return Toll(0.08 * strength * np.sin(2 * np.pi * slate("cable_out_m") / 7.3 + 2.3))


def _exchanged(slate: Slate, strength: float) -> Toll:
    """Write the ranges of two polls in a row into each other's rows, now and then."""
    range_m = slate("range_m")
    first = np.arange(0, len(range_m) - 1, 2)
    first = first[slate.rng.random(len(first)) < min(0.06 * strength, 0.25)]
    written = range_m.copy()
    written[first], written[first + 1] = range_m[first + 1], range_m[first]
    return Toll(written - range_m)


def _no_less(slate: Slate, strength: float) -> Toll:
    """Firmware gives no range below a least one."""
    least = 2.4 + 0.8 * strength
    return Toll(np.maximum(least - slate("range_m"), 0.0))


def _truly(slate: Slate, beams: Floats) -> Toll:
    """Return the toll where beams are truly at [n, 3]."""
    far = slate.gap(slate.crawlers(), beams)
    return Toll(far - slate.far, 20 * np.log10(slate.far / far))


def _sagged(slate: Slate, strength: float) -> Toll:
    beams = BEAMS_M.copy()
    beams[2] += strength * np.array([0.18, -0.25, -0.33])
    return _truly(slate, beams[slate.beam])


def _mixed_up(slate: Slate, _: float) -> Toll:
    beams = BEAMS_M[[0, 5, 2, 3, 4, 1, 6]]
    return _truly(slate, beams[slate.beam])


def _decimetres(slate: Slate, _: float) -> Toll:
    return Toll(np.where(slate.beam == 4, 9.0 * slate("range_m"), 0.0))


EFFECTS: dict[str, Callable[[Slate, float], Toll]] = {
    "time-lag": _camera_behind,
    "exchange-motion": _crawling_on,
    "antenna-delay": _matching_coils,
    "clock-offset": _soft_crystals,
    "temperature-drift": _logistic_warmth,
    "antenna-pattern": _whip,
    "power-bias": _steps_of_gain,
    "timestamp-jitter": _lopsided,
    "path-loss": _foil,
    "range-scale": _counts_before_delays,
    "range-rounding": _by_chance,
    "material-delay": _layers,
    "blocked-path": _over_the_ridge,
    "ground-bounce": _boards,
    "diffraction": _tanks,
    "level-control": _gain_loop,
    "noise-floor": _hot_receivers,
    "swollen-timber": _timber,
    "rain-on-slates": _wet_slates,
    "fan-shakes": _fan,
    "wool-spread": _wool,
    "drum-off-centre": _drum,
    "rows-exchanged": _exchanged,
    "no-less-than": _no_less,
    "beam-sagged": _sagged,
    "beams-mixed-up": _mixed_up,
    "decimetres-from-one-beam": _decimetres,
}
