"""What the laundry hides in ranges and levels: effects in forms of its own.

numpy alone; shared by the laundry's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.laundry_faults import UNLISTED
from bench.challenge.families.laundry_meter import METRES, RISE, crest, lobe, steepness
from bench.challenge.families.laundry_plan import (
    LOUVRES,
    LOUVRES_M,
    PER_PPM_M,
    TAGS,
    WASHERS_M,
    WAVE_M,
    Change,
    Errand,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
UNSEEN = {False: 0.2, True: 0.075}  # of links, and where these are rare
FRAMES: tuple[tuple[float, float], ...] = (
    (-1 / 16, 1 / 2), (9 / 16, 5 / 6), (9 / 16, 7 / 6), (-1 / 16, 3 / 2)
)  # fmt: skip
"""Weights of four frames of a film and how old they are, in parts of the lag."""
LEGENDRE = ((5 / 18, 0.5 - 0.15**0.5), (8 / 18, 0.5), (5 / 18, 0.5 + 0.15**0.5))
"""Weights of three places of an exchange, and where in it they are."""
BENDS, BEND_M, WASHED_M, WASHES = 6, 0.044, 0.125, 70.0  # of ducts' cables; of tags, in the end
CHAINS, TAKEN_OVER = 3, 0.74  # of louvres' clocks; of an offset, by the next of a chain
COOL_S = 5400.0  # until tags' crystals are e times nearer to what they settle at
QUANTA_K, CALIBRATED_C = 700.0, 24.0
STEP_M, FARTHER = 0.125, 0.12  # of ranges; by how much of it even words reach farther
TAPES = (0.0068, 0.0118)  # how short the tapes of the west and of the east are
DRY, WATER = 1.4, (9.3, 146.0, -76.7)  # permittivity of linen; of its water, by powers
FLOOR, FILM = 5.24 - 0.55j, 72.6 - 24.0j  # concrete and water at 6.5 GHz
EXTRACTORS_M: Floats = np.array([(18.0, WASHERS_M), (33.0, WASHERS_M)])
SPIN_S = 260.0  # from one spin to the next
DUCTS_M = (
    (0, 1.2, 5.3), (0, 13.6, 6.1), (0, 26.7, 5.4), (0, 8.4, 4.4), (0, 19.4, 4.4),
    (1, 1.2, 4.2), (1, 15.5, 5.6), (1, 31.0, 5.6), (1, 44.8, 5.3),
)  # fmt: skip
"""Ducts and rails of steel: along which axis, where on the other one, and how high."""


def _film(errand: Errand, strength: float) -> Change:
    """Compare with places that a film's four frames give by a cubic between them, all old."""
    parts = [by * errand.longer_in(0.13 * strength * old) for by, old in FRAMES]
    return Change(np.sum(parts, axis=0))


def _legendre(errand: Errand, strength: float) -> Change:
    """Give the mean of the way over an exchange, by Gauss's rule of three places."""
    whole_s = 2.2 * strength * errand.read("reply_time_s")
    return Change(np.sum([by * errand.longer_in(at * whole_s) for by, at in LEGENDRE], axis=0))


def _bent_and_washed(errand: Errand, strength: float) -> Change:
    """Be late by bends that pinch louvres' cables; by how often tags were washed, ever less."""
    drawn = errand.common(1)
    louvres = BEND_M * drawn.binomial(BENDS, 0.45, LOUVRES)[errand.louvre]
    washed = drawn.uniform(0.0, 220.0, len(TAGS))[errand.tag]
    return Change(strength * (louvres - WASHED_M * np.expm1(-washed / WASHES) + 0.015))


def _in_chains(errand: Errand, strength: float) -> Change:
    """Leave some of crystals' offset: louvres take most of theirs from the one before in a chain.

    Tags' settle as they cool down from the wash.
    """
    drawn = errand.common(2)
    own = drawn.normal(0.0, 0.8, (LOUVRES // CHAINS, CHAINS))
    for k in range(1, len(own)):
        own[k] = TAKEN_OVER * own[k - 1] + np.sqrt(1 - TAKEN_OVER**2) * own[k]
    louvres = own.T.ravel()[errand.louvre]
    tags = drawn.uniform(-1.3, 1.3, len(TAGS))[errand.tag]
    tags = tags * (1 + 0.3 * np.exp(-errand.read("time_s") / COOL_S))
    ppm = 0.0185 * strength * (tags - louvres)
    return Change(PER_PPM_M * ppm * errand.read("reply_time_s"))


def _quanta(errand: Errand, strength: float) -> Change:
    """Drift by what a lattice's swings hold, which take quanta up (Einstein 1907)."""
    kelvins = errand.read("temperature_c") + 273.15
    held, usual = (1 / np.expm1(QUANTA_K / one) for one in (kelvins, CALIBRATED_C + 273.15))
    return Change(4.4 * strength * (held - usual))


def _parabolic(errand: Errand, strength: float) -> Change:
    """Be late and weak through a fold of wet linen: a parabola over some of all directions."""
    middle = errand.common(3).uniform(0.0, 360.0)
    off = (errand.read("azimuth_deg") - middle + 180.0) % 360.0 - 180.0
    shade = (1 - (off / 95.0) ** 2).clip(0.0)
    return Change(strength * (0.168 * shade - 0.036), first_db=-5.0 * min(strength, 1.5) * shade)


def _growth(errand: Errand, strength: float) -> Change:
    """Be late where it is weak: by a curve of growth (Chapman 1961) of how far below a level."""
    below = (-60.5 - errand.read("rx_power_dbm")).clip(0.0)
    return Change(strength * (0.196 * (-np.expm1(-below / 11.0)) ** 5.3 - 0.1))


def _sinh(errand: Errand, strength: float) -> Change:
    """Scatter by a hyperbolic sine of a bell: heavy at both ends (Johnson 1949)."""
    bent = np.sinh(errand.rng.normal(0.0, 0.5, errand.rows))
    return Change(0.049 * strength * bent / np.sqrt(0.5 * np.expm1(0.5)))


def _filled(errand: Errand, strength: float) -> Change:
    """Lose what a hall full of steam and linen takes: much at first, and in the end no more."""
    thick = errand.of_links(lambda n: errand.rng.triangular(0.5, 1.0, 1.5, n))
    return Change(all_db=9.2 * strength * thick * np.expm1(-errand.far / 13.0))


def _two_tapes(errand: Errand, strength: float) -> Change:
    """Be surveyed, in the west and in the east, with two tapes, both of them short."""
    short = np.where(LOUVRES_M[:, 0] < 23.0, *TAPES)[errand.louvre]
    return Change(strength * short * errand.far)


def _even_words(errand: Errand, strength: float) -> Change:
    """Write whole steps, of which even ones reach farther than odd ones."""
    step = STEP_M * strength
    fine = errand.read("range_m") / step
    word = np.rint(fine)
    yields = (np.mod(word, 2) == 1) & (np.abs(fine - word) > 0.5 - FARTHER)
    return Change(step * (np.where(yields, word + np.sign(fine - word), word) - fine))


def _damp_linen(errand: Errand, strength: float) -> Change:
    """Go through linen by a cubic of its water, as soils do (Topp, Davis and Annan 1980).

    Through chords of pillars, partitions and panes.
    """
    drawn = errand.rng
    deep = errand.of_links(lambda n: drawn.triangular(0.08, 0.17, 0.34, n))
    water = errand.of_links(lambda n: 0.15 * drawn.beta(2.0, 4.0, n))
    dense = DRY + sum(by * water**k for k, by in enumerate(WATER, 1))
    off = errand.of_links(lambda n: drawn.uniform(0.0, 0.9, n))
    sheets = errand.of_links(lambda n: drawn.uniform(0.05, 0.125, n))
    panes = errand.of_links(lambda n: drawn.uniform(0.01, 0.03, n))
    through: list[tuple[str, Floats, Floats | float]] = [
        ("linen", deep * (np.sqrt(dense) - 1), 0.8 + 7.0 * deep * (1 + 16.0 * water)),
        ("concrete", 0.29 * np.sqrt(1 - off**2) * (np.sqrt(5.24) - 1), 4.9),
        ("plasterboard", sheets * (np.sqrt(2.73) - 1), 1.6),
        ("glass", panes * (np.sqrt(6.31) - 1), 1.4),
    ]
    late, lost = np.zeros(errand.rows), np.zeros(errand.rows)
    for what, metres, db in through:
        late += errand.goes_through(what) * metres
        lost += errand.goes_through(what) * db
    return Change(strength * late, first_db=-min(strength, 1.5) * lost)


def _off_ducts(errand: Errand, strength: float) -> Change:
    """Hear, out of sight, nothing but what the best placed of ducts and rails returns."""
    hidden = errand.unseen(UNSEEN[errand.rare])
    best = np.full(errand.rows, np.inf)
    for axis, aside_m, high_m in DUCTS_M:
        reach = [
            np.hypot(end[:, 1 - axis] - aside_m, end[:, 2] - high_m)
            for end in (errand.there, errand.above)
        ]
        along = errand.there[:, axis] - errand.above[:, axis]
        detour = np.hypot(along, reach[0] + reach[1]) - errand.far
        best = np.where(detour > 0.44, np.minimum(best, detour), best)
    late = best.clip(max=3.3) * (0.42 + 0.58 * strength)
    return Change(hidden * late, -1.6 * hidden, -4.0 * hidden)


def off_the_floor(errand: Errand, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Waves are upright as much as level, as tags hang; water stands on more of the floor or less.
    """
    low, high = errand.there[:, 2], errand.above[:, 2]
    way = np.sqrt(errand.far**2 + 4 * low * high)
    down = (low + high) / way
    drawn = errand.rng
    wet, upright = (errand.of_links(lambda n: drawn.beta(1.3, 1.3, n)) for _ in range(2))
    back: Complexes = np.zeros(errand.rows, np.complex128)
    for dense, part in ((FLOOR, 1 - wet), (FILM, wet)):
        root = np.sqrt(dense - 1 + down**2)
        level, steep = (down - root) / (down + root), (dense * down - root) / (dense * down + root)
        back += part * (upright * steep + (1 - upright) * level)
    free = errand.of_links(lambda n: drawn.triangular(0.45, 0.95, 1.0, n))
    share = 2.2 * np.sqrt(strength) * free * back * errand.far / way
    share = share * np.exp(-2j * np.pi * (way - errand.far) / WAVE_M)
    return way - errand.far, share / np.maximum(1.0, np.abs(share) / 0.86)


def _both_steep(errand: Errand, strength: float) -> Change:
    """Be where both pulses together rise most at first: that of the floor comes later."""
    longer, share = off_the_floor(errand, strength)
    step = 1 / 20
    at = np.arange(-10.0, 8.0, step)
    size = np.abs(lobe(at) + share[:, None] * lobe(at - longer[:, None] / METRES))
    rise = steepness(size, step)
    tops = (rise[:, 1:-1] > rise[:, :-2]) & (rise[:, 1:-1] >= rise[:, 2:])
    tops &= rise[:, 1:-1] > 0.3 * rise.max(axis=1)[:, None]
    place = at[0] + step * crest(rise, 1 + tops.argmax(axis=1))
    added = np.abs(1 + share * lobe(longer / METRES)).clip(min=0.42)
    return Change((1.2 * METRES * (place + RISE)).clip(-0.25, 0.3), 20 * np.log10(added))


def screened_db(detour: Floats, thick: Floats) -> Floats:
    """Return what something thick with two edges takes in dB [n], by ISO 9613-2 (1996, 7.4)."""
    edges = (5 * WAVE_M / thick) ** 2
    return np.asarray(10 * np.log10(3 + 20 / WAVE_M * (1 + edges) / (1 / 3 + edges) * detour))


def _over_a_drier(errand: Errand, strength: float) -> Change:
    """Bend over both edges of a drier's roof, and creep along its seams."""
    steel, drawn = errand.goes_through("metal"), errand.rng
    thick = errand.of_links(lambda n: drawn.uniform(0.5, 1.4, n)).clip(max=0.4 * errand.far)
    cut = errand.of_links(lambda n: drawn.uniform(0.2, 0.8, n))
    high = np.sqrt(strength) * errand.of_links(lambda n: drawn.triangular(0.02, 0.15, 0.6, n))
    legs = [(errand.far - thick) * part for part in (cut, 1 - cut)]
    detour = sum(np.hypot(high, leg) for leg in legs) + thick - errand.far
    creeps = strength * errand.of_links(lambda n: drawn.uniform(0.03, 0.13, n))
    lost = screened_db(detour, thick).clip(max=12.0)
    return Change(steel * (detour + creeps).clip(0.0, 0.46), first_db=-steel * lost)


def _half_cosine(errand: Errand, strength: float) -> Change:
    """Turn gain down between two levels, by half a cosine; count the fewer symbols."""
    part = ((errand.read("rx_power_dbm") + 94.5) / 25.0).clip(0.0, 1.0)
    less = 5.9 * min(strength, 2.2) * np.sin(0.5 * np.pi * part) ** 2
    return Change(all_db=-less, count_db=-1.12 * less)


def _extractors(errand: Errand, strength: float) -> Change:
    """Hear drives of extractors as they spin up and down, by the angle that these fill."""
    drawn = errand.common(4)
    own = drawn.uniform(0.5, 1.4, len(TAGS))[errand.tag]
    phase = np.mod(errand.read("time_s") / SPIN_S + drawn.random(), 1.0)
    spins = (1 - np.abs(phase - 0.5) / 0.36).clip(0.0)
    apart = errand.there[:, None, :2] - EXTRACTORS_M
    near = np.sqrt((apart**2).sum(axis=2)).min(axis=1)
    db = strength * (own + 8.4 * spins * np.arctan(6.0 / near.clip(0.5)) * 2 / np.pi)
    weak = 10 ** ((-87.0 - errand.read("rx_power_dbm")) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Change(0.016 * weak.clip(max=8.0) * errand.rng.normal(size=errand.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Errand, float], Change]] = {
    "antenna-delay": _bent_and_washed,
    "antenna-pattern": _parabolic,
    "blocked-path": _off_ducts,
    "clock-offset": _in_chains,
    "diffraction": _over_a_drier,
    "exchange-motion": _legendre,
    "ground-bounce": _both_steep,
    "level-control": _half_cosine,
    "material-delay": _damp_linen,
    "noise-floor": _extractors,
    "path-loss": _filled,
    "power-bias": _growth,
    "range-rounding": _even_words,
    "range-scale": _two_tapes,
    "temperature-drift": _quanta,
    "time-lag": _film,
    "timestamp-jitter": _sinh,
    **UNLISTED,
}
