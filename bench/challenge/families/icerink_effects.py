"""What the ice rink hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the ice rink's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.icerink_faults import UNLISTED
from bench.challenge.families.icerink_rink import (
    AMID_M,
    CORNER_M,
    CUBE_M,
    HALF_M,
    MULLIONS,
    MULLIONS_M,
    PER_PPM_MS_M,
    TAGS,
    WAVE_M,
    Marks,
    Period,
    on_lap,
)
from bench.challenge.families.icerink_timer import AHEAD, METRES, first_paths, heights, shouts

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OUT_OF_SIGHT = {False: 0.2, True: 0.075}  # of links, and where these are rare
STAGE_S = 0.0165  # of each of three stages that places come through
LOBATTO = ((0.0, 1 / 12), (0.5 - 20**-0.5, 5 / 12), (0.5 + 20**-0.5, 5 / 12), (1.0, 1 / 12))
MESSAGES = 1.7  # replies that an exchange lasts
RELAXES_S = 2.4 * 3600
PLATINUM, MEET_C, DRIFTS_M = (3.9083e-3, -5.775e-7, -4.183e-12), 6.0, 1.15
TRUNK_M, LATE_TRUNK, TRUNK_DB = (0.23, 0.13), 0.45, 8.0  # half axes; parts late; dB a metre
EVEN_DBM, SPIN_DB, SPIN_M = -84.0, 2.7, 0.062  # of spins, half of which are turned at such a level
SCATTERS_M = 0.037
BREAKS_M, SLOPES = 15.0, 0.62  # from where on it loses more; by how much more
SLOW, EACH = 0.0056, 0.055  # of clocks; more from one to the next round the ice
ROOTS = 0.0165  # of a metre's root, from one code to the next
POSTS, POST_M, ASIDE_M, SOONEST_M = 66, 1.7, 4.0, 0.6  # of the glass; how high; off ways; longer
FOIL_M = 12.4  # how high the roof's is
WATER, ICE = 74.3 - 30.7j, 3.17 - 0.004j  # permittivities at 4 GHz and 0 degrees C
LIKED_DBM, WIDE_DB = -91.0, 6.0  # over which gain is turned down
CHILLERS_M: Floats = np.array([72.0, 41.0, 2.0])
FULL_KW = 250.0


def _stages(period: Period, strength: float) -> Marks:
    """Compare with places that came through three stages, each of which is late by chance.

    What they are late by in all is Erlang's; ways then are by ten of Laguerre's places.
    """
    at, by = np.polynomial.laguerre.laggauss(10)
    late = np.zeros(period.rows)
    for stage, part in zip(at, 0.5 * by * at**2, strict=True):
        late += part * period.skates_off(STAGE_S * strength * stage)
    return Marks(late)


def _exchange(period: Period, strength: float) -> Marks:
    """Give the mean of the way over an exchange, by Lobatto's four places, both ends included."""
    long_s = MESSAGES * strength * period["reply_time_s"]
    return Marks(np.sum([by * period.skates_off(long_s * at) for at, by in LOBATTO], axis=0))


def _adapters(period: Period, strength: float) -> Marks:
    """Be late by adapters that are put between mullions and cables, tags by which mould cast them.

    As many adapters as it takes until one fits; three moulds.
    """
    drawn = period.common(1)
    adapters = 0.052 * drawn.geometric(0.42, MULLIONS).clip(max=6)
    moulds = drawn.choice([0.015, 0.05, 0.09], len(TAGS))
    return Marks(strength * (adapters[period.mullion] + moulds[period.tag]))


def _relaxes(period: Period, strength: float) -> Marks:
    """Leave some of crystals' offset: tags' relaxes, e times less by hours, since a cold night."""
    drawn = period.common(2)
    mullions = drawn.normal(0.0, 0.35, MULLIONS).clip(-0.9, 0.9)[period.mullion]
    rest = drawn.uniform(-0.8, 0.8, len(TAGS))[period.tag]
    cold = (drawn.choice([-1.0, 1.0], len(TAGS)) * drawn.uniform(0.8, 1.9, len(TAGS)))[period.tag]
    ppm = 0.026 * strength * (rest + cold * np.exp(-period["time_s"] / RELAXES_S) - mullions)
    return Marks(PER_PPM_MS_M * ppm * 1e3 * period["reply_time_s"])


def platinum(warm: Floats) -> Floats:
    """Return a platinum wire's resistance next to that at 0 degrees C [n] (Van Dusen 1925)."""
    a, b, c = PLATINUM
    return np.asarray(1 + a * warm + b * warm**2 + c * (warm - 100) * warm.clip(max=0.0) ** 3)


def _wire(period: Period, strength: float) -> Marks:
    """Drift as a platinum wire does that biases the receiver: hardly less than by a line."""
    more = platinum(period["temperature_c"]) - platinum(np.full(1, MEET_C))
    return Marks(DRIFTS_M * strength * more)


def through_trunk(at: Floats) -> Floats:
    """Return how far it is through a trunk, an ellipse, from amid its front, in m [n].

    `at`: radians off straight ahead; ahead there is nothing.
    """
    wide, deep = TRUNK_M
    back, aside = np.minimum(np.cos(at), 0.0), np.sin(at)
    return np.asarray(-2 * back / deep / ((aside / wide) ** 2 + (np.cos(at) / deep) ** 2))


def _trunk(period: Period, strength: float) -> Marks:
    """Be late and weak by how far it is through the trunk that wears a tag in front."""
    turned = period.common(3).uniform(0.0, 2 * np.pi)
    deep = through_trunk(np.radians(period["azimuth_deg"]) - turned)
    mean = through_trunk(np.linspace(0.0, 2 * np.pi, 721)[:-1]).mean()
    weak = -TRUNK_DB * min(strength, 1.5) * deep
    return Marks(LATE_TRUNK * strength * (deep - mean), first_db=weak)


def spins(field: Floats) -> Floats:
    """Return the mean of spins of one in a field, which are -1, 0 or 1 [n] (Brillouin 1927)."""
    by = field.clip(-30.0, 30.0)
    return np.asarray(2 * np.sinh(by) / (1 + 2 * np.cosh(by)))


def _spins(period: Period, strength: float) -> Marks:
    """Be early where it is loud and late where it is weak, as spins of one in a field turn."""
    return Marks(SPIN_M * strength * spins((EVEN_DBM - period["rx_power_dbm"]) / SPIN_DB))


def secant(even: Floats) -> Floats:
    """Return where a hyperbolic secant's law, which scatters by 1, has so much below it [n]."""
    return np.asarray(2 / np.pi * np.log(np.tan(0.5 * np.pi * even)))


def _secant(period: Period, strength: float) -> Marks:
    """Scatter by the law of a hyperbolic secant."""
    even = period.rng.uniform(0.0005, 0.9995, period.rows)
    return Marks(SCATTERS_M * strength * secant(even))


def _breaks(period: Period, strength: float) -> Marks:
    """Lose by one more exponent from a break on, softly; links unlike."""
    thick = period.each_link(lambda n: 0.5 + period.rng.beta(2.0, 2.0, n))
    more = 10 * np.log10(1 + (period.far / BREAKS_M) ** 2)
    return Marks(all_db=-SLOPES * strength * thick * more)


def round_ice() -> Floats:
    """Return how many mullions are before each, as one goes round the ice [MULLIONS]."""
    off = MULLIONS_M[:, :2] - np.array(AMID_M)
    return np.argsort(np.argsort(np.arctan2(off[:, 1], off[:, 0]))).astype(np.float64)


def _passed_on(period: Period, strength: float) -> Marks:
    """Count by a clock that mullions pass on round the ice, each a little slower than before."""
    slow = SLOW * strength * (1 + EACH * round_ice()[period.mullion])
    return Marks(slow * period.far)


def by_roots(ranges: Floats, step: float) -> Floats:
    """Return ranges in m as codes have them that are whole steps of their roots [n]."""
    return np.asarray((step * np.rint(np.sqrt(ranges.clip(0.0)) / step)) ** 2)


def _roots(period: Period, strength: float) -> Marks:
    """Write roots of ranges in whole steps, so that far ranges have coarser ones."""
    ranges = period["range_m"]
    return Marks(by_roots(ranges, ROOTS * strength) - ranges)


def of_snow(dense: Floats) -> Floats:
    """Return the index of dry snow by how dense it is in g / cm3 [n] (Tiuri and others 1984)."""
    return np.asarray(np.sqrt(1 + 1.7 * dense + 0.7 * dense**2))


def slab(thick: Floats, within: float, sine: Floats) -> Floats:
    """Return how much later it is behind slabs in m [n], by sines of how aslant these are met."""
    return np.asarray(thick * (np.sqrt(within - sine**2) - np.sqrt(1 - sine**2)))


def _things(period: Period, strength: float) -> Marks:
    """Go through boards and snow swept against these, panes, tiers and rows of seats, aslant."""
    drawn, link = period.rng, period.each_link
    sine = np.sin(link(lambda n: drawn.uniform(0.0, 1.05, n)))
    slant = 1 / np.sqrt(1 - sine**2)
    heap = link(lambda n: drawn.uniform(0.05, 0.35, n))
    index = of_snow(link(lambda n: drawn.uniform(0.2, 0.55, n)))
    panes = link(lambda n: 0.013 * drawn.integers(1, 5, n))
    tiers = link(lambda n: drawn.triangular(0.03, 0.06, 0.12, n))
    seats = link(lambda n: 0.018 * drawn.integers(2, 8, n))
    things: dict[str, tuple[Floats, Floats]] = {
        "plastic": (slab(np.full(period.rows, 0.024), 2.35, sine) + heap * (index - 1),
                    0.6 + 5.0 * heap),
        "glass": (slab(panes, 6.31, sine), 0.7 + 32.0 * panes * slant),
        "concrete": (slab(tiers, 5.24, sine), 0.9 + 27.0 * tiers * slant),
        "chipboard": (slab(seats, 2.58, sine), 0.6 + 16.0 * seats * slant),
    }  # fmt: skip
    late, lost = (sum(period.through(w) * both[k] for w, both in things.items()) for k in (0, 1))
    weak = -min(strength, 1.5) * np.asarray(lost)
    return Marks(1.15 * strength * np.asarray(late), first_db=weak)


def posts_m() -> Floats:
    """Return where posts of the glass are, evenly round the ice, in m [POSTS, 3]."""
    round_m = 2 * sum(2 * (half - CORNER_M) for half in HALF_M) + 2 * np.pi * CORNER_M
    at = {"east": round_m * np.arange(POSTS) / POSTS} | dict.fromkeys(("pace", "spans"),
                                                                     np.zeros(POSTS))  # fmt: skip
    return on_lap(at | {"tall": np.full(POSTS, POST_M)}, np.zeros(POSTS))


def off_things(period: Period) -> Floats:
    """Return how much longer the soonest way off posts, the scoreboard or the roof is, in m [n].

    Of a post that is less than ASIDE_M off a straight way nothing comes, since the same thing is in
    its way; the roof's foil has an image of tags above it.
    """
    tag, mullion = period.ends
    flat = np.linalg.norm((mullion - tag)[:, :2], axis=1)
    soonest = np.hypot(flat, 2 * FOIL_M - tag[:, 2] - mullion[:, 2])
    for at in np.concatenate([posts_m(), CUBE_M]):
        toward = (mullion - tag) / period.far[:, None]
        along = ((at - tag) * toward).sum(axis=1).clip(0.0, period.far)
        aside = np.linalg.norm(tag + along[:, None] * toward - at, axis=1)
        way = np.linalg.norm(tag - at, axis=1) + np.linalg.norm(mullion - at, axis=1)
        soonest = np.where(aside > ASIDE_M, np.minimum(soonest, way), soonest)
    return np.asarray(soonest - period.far)


def _off_things(period: Period, strength: float) -> Marks:
    """Hear, out of sight, nothing but what posts, the scoreboard or the roof return."""
    cut = period.screened(OUT_OF_SIGHT[period.rare])
    late = off_things(period).clip(SOONEST_M) * (0.5 + 0.5 * strength)
    return Marks(cut * late, -1.3 * cut, -4.9 * cut)


def _face(within: complex, beyond: complex, level: Floats) -> Complexes:
    """Return what a face returns of upright waves [n] (Fresnel), `level`: cosines in air."""
    one, other = (np.sqrt(k - level**2 + 0j) for k in (within, beyond))
    return np.asarray((beyond * one - within * other) / (beyond * one + within * other))


def wet_ice(sine: Floats, film_m: Floats) -> Complexes:
    """Return what ice returns below a film of water that is so thick, of waves so steep, [n].

    Both faces of the film do, again and again (Airy 1833).
    """
    level = np.sqrt(1 - sine**2)
    turn = np.exp(-4j * np.pi / WAVE_M * film_m * np.sqrt(WATER - level**2))
    above, below = _face(1.0, WATER, level), _face(WATER, ICE, level)
    return np.asarray((above + below * turn) / (1 + above * below * turn))


def off_the_ice(period: Period, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ice is in m, and its complex share, [n] each."""
    tag, mullion = period.ends
    up = tag[:, 2] + mullion[:, 2]
    way = np.hypot(np.linalg.norm((mullion - tag)[:, :2], axis=1), up)
    film = period.each_link(lambda n: 1.2e-3 * period.rng.beta(1.2, 2.0, n))
    cut_up = period.each_link(lambda n: period.rng.uniform(0.45, 1.0, n))
    share = 1.2 * np.sqrt(strength) * cut_up * wet_ice(up / way, film) * period.far / way
    share = share * np.exp(-2j * np.pi * (way - period.far) / WAVE_M)
    return way - period.far, share / np.maximum(np.abs(share) / 0.78, 1.0)


def of_both(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As timers have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(len(longer_m), 92.3)
    both = shouts(top) + share[:, None] * shouts(top + longer_m / METRES)
    at = first_paths(both, np.full(len(top), 1e-6))
    return METRES * (at + AHEAD - top), heights(both, at)


def _both(period: Period, strength: float) -> Marks:
    """Be where one pulse fits both best: that of the ice comes later."""
    late, height = of_both(*off_the_ice(period, strength))
    return Marks(late.clip(-0.2, 0.24), 20 * np.log10(height.clip(0.4)))


def over_edge_db(v: Floats) -> Floats:
    """Return what an edge takes in dB, by Fresnel's parameter >= 0 [n].

    Right, with its slope, at the edge's own height, and far below it.
    """
    return np.asarray(10 * np.log10(4 + 8 * v / (1 + v) ** 3 + 2 * (np.pi * v) ** 2))


def _resurfacers(period: Period, strength: float) -> Marks:
    """Bend over a parked resurfacer, both of whose edges one stands for (Bullington 1947).

    That is where lines from both ends by these edges meet; it creeps along between.
    """
    steel, drawn, link = period.through("metal"), period.rng, period.each_link
    part = link(lambda n: drawn.uniform(0.2, 0.8, n))
    long = link(lambda n: drawn.uniform(0.8, 1.6, n)).clip(max=0.6 * period.far)
    over = link(lambda n: drawn.uniform(0.05, 0.27, n)) * np.sqrt(strength)
    high = over * period.far / (period.far - long)
    near = 1 / (part * period.far) + 1 / ((1 - part) * period.far)
    lost = over_edge_db(high * np.sqrt(2 / WAVE_M * near))
    creeps = strength * link(lambda n: drawn.uniform(0.05, 0.16, n))
    return Marks(steel * (0.5 * high**2 * near + creeps).clip(0.0, 0.46),
                 first_db=-steel * lost.clip(1.0, 17.0))  # fmt: skip


def _arctan(period: Period, strength: float) -> Marks:
    """Turn gain down by an arc's tangent of what is over a level; add up fewer symbols."""
    over = ((period["rx_power_dbm"] - LIKED_DBM) / WIDE_DB).clip(0.0)
    less = 3.3 * min(strength, 2.2) * 2 / np.pi * np.arctan(over)
    return Marks(all_db=-less, count_db=-1.1 * less)


def _chillers(period: Period, strength: float) -> Marks:
    """Hear drives of the chillers: by a power of their load; mullions far off hear less."""
    own = period.common(4).uniform(0.3, 1.4, MULLIONS)[period.mullion]
    away = np.linalg.norm(period.ends[1] - CHILLERS_M, axis=1)
    db = strength * (own + 9.0 * (period["chiller_kw"] / FULL_KW) ** 1.5 / (1 + away / 30.0))
    weak = 10 ** ((-90.5 - period["rx_power_dbm"]) / 20) * np.sqrt(np.expm1(db * np.log(10) / 10))
    return Marks(0.015 * weak.clip(max=8.0) * period.rng.normal(size=period.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Period, float], Marks]] = {
    "antenna-delay": _adapters,
    "antenna-pattern": _trunk,
    "blocked-path": _off_things,
    "clock-offset": _relaxes,
    "diffraction": _resurfacers,
    "exchange-motion": _exchange,
    "ground-bounce": _both,
    "level-control": _arctan,
    "material-delay": _things,
    "noise-floor": _chillers,
    "path-loss": _breaks,
    "power-bias": _spins,
    "range-rounding": _roots,
    "range-scale": _passed_on,
    "temperature-drift": _wire,
    "time-lag": _stages,
    "timestamp-jitter": _secant,
    **UNLISTED,
}
