"""What the cowshed hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the cowshed's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.cowshed_barn import (
    COWS,
    FALL,
    M_PER_PPM_S,
    RAFTERS_M,
    RIDGE_M,
    SCRAPE_S,
    SHED_M,
    VARA_M,
    WALLS,
    WATER,
    WAVE_M,
    Herd,
    Trouble,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
HUNG = len(RAFTERS_M)
SLATS, ROUGH_M = 6.8, 0.0035  # permittivity of wet concrete; how uneven it is
WIDE_M, EARLY_PART = 0.33, 0.2  # of a pulse; of its energy, at which it is timed
HIDDEN_SHARE = {False: 0.17, True: 0.05}  # of links behind bales, and where that is rare


def _camera_by_camera(herd: Herd, strength: float) -> Trouble:
    """Compare with places of four cameras in a row, each a hop farther from the computer."""
    section = np.clip(herd.col("tx_y_m") // (SHED_M[1] / 4), 0, 3)
    return Trouble(herd.farther(strength * (0.1 + 0.025 * section)))


def _four_messages(herd: Herd, strength: float) -> Trouble:
    """Give the mean of the ways of four messages, each after twice the wait before it."""
    wait = 0.7 * min(strength, 2.0) * herd.col("reply_time_s")
    return Trouble(0.25 * (herd.farther(wait) + herd.farther(2 * wait) + herd.farther(4 * wait)))


def _from_three_sheds(herd: Herd, strength: float) -> Trouble:
    """Be of rafters' radios that three other sheds had before; collars' potting differs."""
    shed = herd.lasting(1).permutation(np.array([0.02, 0.02, 0.02, 0.09, 0.09, 0.09, 0.17, 0.17]))
    potting = 0.02 + 0.04 * np.abs(herd.lasting(2).normal(size=COWS)).clip(max=2.5)
    return Trouble(strength * (shed[herd.rafter] + potting[herd.cow]))


def _warm_necks(herd: Herd, strength: float) -> Trouble:
    """Leave some of what crystals are off by: a line in warmth each, and necks warm collars."""
    rng, warm = herd.lasting(3), herd.col("temperature_c")
    slope, off = rng.normal(0, 0.06, HUNG + COWS), rng.normal(0, 1.1, HUNG + COWS)
    above, cow = herd.rafter, HUNG + herd.cow
    draught, neck = off[above] + slope[above] * (warm - 25), off[cow] + slope[cow] * 0.35 * warm
    reply_s = herd.col("reply_time_s")
    return Trouble(0.016 * strength * M_PER_PPM_S * (draught - neck) * reply_s)


def _arrhenius(herd: Herd, strength: float) -> Trouble:
    """Drift as what is activated by warmth does: exponentially by one over kelvins (Arrhenius)."""
    kelvin = 273.15 + herd.col("temperature_c")
    return Trouble(0.12 * strength * np.expm1(3300.0 * (1 / 288.15 - 1 / kelvin)))


def _two_ears(herd: Herd, strength: float) -> Trouble:
    """Be late and weak past two ears with tags of brass: a wrapped Cauchy's bell for each."""
    turn = np.radians(herd.col("azimuth_deg")) - herd.lasting(4).uniform(0, 2 * np.pi)
    bells = [0.6975 / (1.3025 - 1.1 * np.cos(turn - ear)) for ear in (-0.85, 0.85)]
    past = 0.5 * (bells[0] + bells[1])  # 1 on average
    return Trouble(0.085 * strength * (past - 1), all_db=-1.5 * min(strength, 1.5) * past)


def _langevin(herd: Herd, strength: float) -> Trouble:
    """Be late where it is weak: by Langevin's function of the level, coth x - 1 / x."""
    x = (-86.0 - herd.col("rx_power_dbm")) / 1.9
    x = np.where(np.abs(x) < 1e-3, 1e-3, x)
    return Trouble(0.078 * strength * (1 / np.tanh(x) - 1 / x))


def _seven_inverters(herd: Herd, strength: float) -> Trouble:
    """Time by a ring of seven inverters that are not alike: one of seven values, as it comes."""
    ring = np.sort(herd.lasting(5).uniform(-0.075, 0.075, 7))
    return Trouble(strength * (ring - ring.mean())[herd.rng.integers(7, size=herd.size)])


def _breath(herd: Herd, strength: float) -> Trouble:
    """Lose in damp warm air nothing near, and far off so many dB a metre: a hyperbola between."""
    return Trouble(0 * herd.far, all_db=-0.3 * strength * (np.hypot(herd.far, 8.0) - 8.0))


def _stretched_tape(herd: Herd, strength: float) -> Trouble:
    """Be wrong in proportion from a hook on, 0.7 m out: a tape was stretched that surveyed it."""
    return Trouble(0.0055 * strength * (herd.col("range_m") - 0.7))


def _root_code(herd: Herd, strength: float) -> Trouble:
    """Keep roots in whole steps: so many words for near ranges, and few for far ones."""
    step, written = 0.017 * strength, herd.col("range_m")
    return Trouble(np.square(step * np.rint(np.sqrt(np.maximum(written, 0)) / step)) - written)


def _damp_walls(herd: Herd, strength: float) -> Trouble:
    """Go through what is damp: drops of water in a solid mix as spheres do (Maxwell Garnett)."""
    late, lost = np.zeros(herd.size), np.zeros(herd.size)
    for kind, (thick_m, dry, db) in WALLS.items():
        damp = herd.per_link(lambda n: herd.rng.triangular(0.0, 0.01, 0.045, n))
        contrast = damp * (WATER - dry) / (WATER + 2 * dry)
        inside = np.sqrt(dry * (1 + 2 * contrast) / (1 - contrast))
        crossed = herd.crosses(kind)
        late, lost = late + crossed * thick_m * (inside - 1), lost + crossed * db * (1 + 9 * damp)
    return Trouble(1.3 * strength * late, edge_db=-min(strength, 1.5) * lost)


def roof_ways(herd: Herd) -> tuple[Floats, Floats]:
    """Return how long ways by both sides of the roof are, in m, and cosines of incidence [2, n].

    By images in planes that fall from the ridge.
    """
    normals = [np.array([side * FALL, 0.0, 1.0]) / np.hypot(FALL, 1.0) for side in (-1.0, 1.0)]
    ridge, ways, cosines = np.array([RIDGE_M, 0.0, SHED_M[2]]), [], []
    for normal in normals:
        below = [(ridge - place) @ normal for place in (herd.collars(), herd.aerials())]
        image = herd.collars() + 2 * below[0][:, None] * normal
        ways.append(np.linalg.norm(image - herd.aerials(), axis=1))
        cosines.append(np.clip((below[0] + below[1]) / ways[-1], 0.0, 1.0))
    return np.array(ways), np.array(cosines)


def _by_the_roof(herd: Herd, strength: float) -> Trouble:
    """Hear, behind bales, nothing but what the nearer side of the gabled roof returns."""
    share = HIDDEN_SHARE[herd.scarce]
    bales = herd.per_link(lambda n: np.where(herd.rng.random(n) < share, 1.0, 0.0))
    detour = np.clip(roof_ways(herd)[0].min(axis=0) - herd.far, 0.33, 3.9)
    return Trouble(bales * detour * (0.45 + 0.55 * strength), all_db=-5.2 * bales)


def slat_ray(herd: Herd, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the slats is in m, and its complex share, [n] each.

    Fresnel's coefficient of wet concrete, less what is uneven (Ament 1953) and what falls through.
    """
    rise = herd.collars()[:, 2] + herd.aerials()[:, 2]
    way = np.sqrt(herd.far**2 + 4 * herd.collars()[:, 2] * herd.aerials()[:, 2])
    steep = rise / way
    root = np.sqrt(SLATS - 1 + steep**2)
    even = np.exp(-2 * (2 * np.pi * ROUGH_M * steep / WAVE_M) ** 2)
    solid = herd.per_link(lambda n: herd.rng.uniform(0.68, 1.0, n))
    size = min(1.2 * strength**0.5, 1.6) * even * solid * (root - steep) / (root + steep)
    return way - herd.far, -size * herd.far / way * np.exp(-2j * np.pi * (way - herd.far) / WAVE_M)


def _slats(herd: Herd, strength: float) -> Trouble:
    """Move when a part of the energy has come, of two bell-shaped pulses that add up."""
    longer, share = slat_ray(herd, strength)
    grid = np.linspace(-1.1, 0.9, 61)
    alone = np.exp(-np.square(grid / WIDE_M))[None, :]
    both = alone + share[:, None] * np.exp(-np.square((grid - longer[:, None]) / WIDE_M))
    moved = _when(grid, np.abs(both) ** 2) - _when(grid, alone**2)
    gain = np.sum(np.abs(both) ** 2, axis=1) / np.sum(alone**2)
    return Trouble(np.clip(moved, -0.3, 0.3), all_db=10 * np.log10(np.maximum(gain, 0.22)))


def _when(grid: Floats, power: Floats) -> Floats:
    """Return at which place of a grid [k] a part of the energy of [n, k] has come [n]."""
    come = np.cumsum(power, axis=1) / np.sum(power, axis=1, keepdims=True)
    past = np.clip(np.argmax(come >= EARLY_PART, axis=1), 1, len(grid) - 1)
    rows = np.arange(len(power))
    before, after = come[rows, past - 1], come[rows, past]
    part = (EARLY_PART - before) / np.maximum(after - before, 1e-12)
    return np.asarray(grid[past - 1] + np.clip(part, 0, 1) * (grid[1] - grid[0]))


def _over_the_trough(herd: Herd, strength: float) -> Trouble:
    """Bend over both edges of a trough of steel as over one that is higher (Bullington 1947).

    Limits of grazing and deep behind an edge are added for the loss.
    """
    steel, far = herd.crosses("metal"), herd.far
    deep = strength**0.5 * herd.per_link(lambda n: herd.rng.uniform(0.05, 0.32, n))
    near = far * herd.per_link(lambda n: herd.rng.uniform(0.2, 0.6, n))
    width = np.minimum(0.7, 0.2 * far)
    rest = far - near
    higher = deep * far / np.maximum(far - width, 0.5 * far)
    v = higher * np.sqrt(2 * far / (WAVE_M * near * rest))
    legs = np.hypot(near, higher) + np.hypot(rest, higher) - far
    along = 0.055 * strength * herd.per_link(lambda n: herd.rng.uniform(0.7, 1.35, n))
    db = np.clip(6.02 + 20 * np.log10(1 + 2.22 * v), 0.5, 13.0)
    return Trouble(steel * (legs + along), edge_db=-steel * db)


def _soft_knee(herd: Herd, strength: float) -> Trouble:
    """Turn gain down above a level: by a square at first, and by a line; fewer symbols as well."""
    over = np.clip(herd.col("rx_power_dbm") + 98.0, 0.0, 26.0)
    bent = over**2 / (over + 7.0)
    return Trouble(
        0 * over, all_db=-0.26 * min(strength, 2.2) * bent, count_db=-0.5 * strength * bent
    )


def _milk_pump(herd: Herd, strength: float) -> Trouble:
    """Hear the milk pump's feed along one long wall, as far as a bell reaches; some hear more."""
    bell = np.exp(-np.square((SHED_M[0] - RAFTERS_M[:, 0]) / 9.5))
    own = (0.7 + 2.9 * bell) * herd.lasting(6).gamma(30.0, 1 / 30.0, HUNG)
    hiss = strength * own[herd.rafter]
    weak = 10 ** (-(herd.col("rx_power_dbm") + 91) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Trouble(0.019 * weak * herd.rng.standard_normal(herd.size), noise_db=hiss)


def _muck(herd: Herd, strength: float) -> Trouble:
    muck = herd.col("muck_mm")
    return Trouble(0.27 * strength * muck / (muck + 1.6))


def _straw(herd: Herd, strength: float) -> Trouble:
    return Trouble(0.25 * strength * (herd.col("straw_kg") / 60.0) ** 1.8)


def _scrapers(herd: Herd, strength: float) -> Trouble:
    return Trouble(0.072 * strength * np.cos(2 * np.pi * herd.col("time_s") / SCRAPE_S + 2.3))


def _curtain(herd: Herd, strength: float) -> Trouble:
    return Trouble(0.131 * strength * np.heaviside(herd.col("curtain_percent") - 47.0, 0.0))


def _condenses(herd: Herd, strength: float) -> Trouble:
    return Trouble(0.073 * strength * np.log1p(herd.col("breath_g") / 4.1))


def _mangers(herd: Herd, strength: float) -> Trouble:
    return Trouble(0.0031 * strength * herd.col("feed_kg"))


def _collars(herd: Herd, strength: float) -> Trouble:
    """Hang the lower the thinner a neck is: what is left of a strap, by its round."""
    return Trouble(10.5 * strength / herd.col("neck_cm"))


def _heads(herd: Herd, strength: float) -> Trouble:
    """Lower heads to feed: who stands at the alley has a collar below where it is said to be."""
    truly = herd.collars()
    feeds = np.exp(-np.square((truly[:, 0] - RIDGE_M) / 4.0))
    truly[:, 2] = np.maximum(truly[:, 2] - 0.32 * strength * feeds, 0.08)
    return Trouble(herd.farther_from(truly))


def _underrated(herd: Herd, strength: float) -> Trouble:
    """Send only a part of how far a cow has gone since a link's first range, at all rafters."""
    first, now = herd.first_of_its_link(), herd.col("range_m")
    return Trouble((first - now) * (1 - 1 / (1 + 0.6 * strength)))


def _really_at(herd: Herd, rafters_m: Floats) -> Trouble:
    """Return what befalls rows whose rafters have their antennas at [8, 3] in truth."""
    truly = np.linalg.norm(rafters_m[herd.rafter] - herd.collars(), axis=1)
    return Trouble(truly - herd.far, all_db=18.6 * np.log10(herd.far / truly))


def _lifted(herd: Herd, strength: float) -> Trouble:
    away = np.outer(np.arange(HUNG) == 4, (-2.0, 6.0, 3.0)) / 7
    return _really_at(herd, RAFTERS_M + 0.53 * strength * away)


def _misnumbered(herd: Herd, _: float) -> Trouble:
    return _really_at(herd, RAFTERS_M[[0, 1, 6, 3, 4, 5, 2, 7]])


def _varas(herd: Herd, _: float) -> Trouble:
    """Show varas, at one rafter, as an old scale in the parlour does."""
    return Trouble((herd.rafter == 1) * (1 / VARA_M - 1) * herd.col("range_m"))


EFFECTS: dict[str, Callable[[Herd, float], Trouble]] = {
    "time-lag": _camera_by_camera,
    "exchange-motion": _four_messages,
    "antenna-delay": _from_three_sheds,
    "clock-offset": _warm_necks,
    "temperature-drift": _arrhenius,
    "antenna-pattern": _two_ears,
    "power-bias": _langevin,
    "timestamp-jitter": _seven_inverters,
    "path-loss": _breath,
    "range-scale": _stretched_tape,
    "range-rounding": _root_code,
    "material-delay": _damp_walls,
    "blocked-path": _by_the_roof,
    "ground-bounce": _slats,
    "diffraction": _over_the_trough,
    "level-control": _soft_knee,
    "noise-floor": _milk_pump,
    "muck-on-domes": _muck,
    "straw-piles-up": _straw,
    "scrapers-run": _scrapers,
    "curtain-lowered": _curtain,
    "breath-condenses": _condenses,
    "mangers-filled": _mangers,
    "collars-hang": _collars,
    "heads-lowered": _heads,
    "changes-underrated": _underrated,
    "rafter-lifted": _lifted,
    "rafters-misnumbered": _misnumbered,
    "varas-from-one-rafter": _varas,
}
