"""What the gasworks hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the gasworks' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.gasworks_faults import OF_THE_GASWORKS
from bench.challenge.families.gasworks_meter import (
    AHEAD,
    LIGHT_M_NS,
    SAMPLE_NS,
    heights,
    metered,
    puffs,
)
from bench.challenge.families.gasworks_yard import (
    BRACKETS,
    DAY_S,
    LIGHT_M_US,
    TAGS,
    TANKS_M,
    WAVE_M,
    Bill,
    Charge,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
SHUT_IN = {False: 0.2, True: 0.08}  # of links, and where these are rare
STALE_S, PULSES_S = 0.08, 0.05  # of places: at least; at which they come
REPLY = 2.7  # replies from message to message
CABLES_M, CABLES_BY, STEMS_M = (
    0.085,
    0.45,
    0.03,
)  # late by brackets; e-folds; by each of tags' stems
OFF_PPM, JUMPS, JUMP_PPM = 0.013, 4, 0.014  # of crystals off; how often a day they jump, by which
TURNS_C, EACH_C2 = 22.0, 4.2e-4  # of crystals that turn over; late for each square
PETAL_M, BACK_M, LOBE_DB = 0.14, 0.07, 3.4  # late; soon; weaker at most
BIAS_M, EVEN_DBM, OVER_DB = 0.058, -81.5, 5.5  # at most; of none; until most of it
SLIP_M, SLIPS, REST_M = 0.07, 0.36, 0.012  # of stamps, a tick; how often to either side; else
SOAKS_DB, SHADE, MOST_DB = 0.26, 0.4, 10.0  # for each m; how links scatter; at most
FAST, OWN = 0.0085, 0.22  # parts that clocks count more; how ends scatter
STEPS_M = (0.06, 0.09, 0.11)  # of tags' trades
SOONEST_M, LONGEST_M = 0.5, 5.0  # of ways by tanks, longer than straight ones
TURNS: Floats = np.linspace(-np.pi, np.pi, 181)[:-1]
BREEZE, BRICK, DEEP_M = 2.6 - 0.35j, 4.4 - 0.1j, 0.03  # coke breeze on bricks, and how deep
HEAP_M, RIDGE_M = (0.45, 0.95), (0.5, 1.4)  # of heaps over straight ways; how wide their tops
KNEE_DBM, BENDS_DB, FLATTER, FEWER = -87.0, 7.0, 0.42, 0.45
EACH_SPARK, PLAIN_DB = 0.055, 0.3  # of noise's power for each spark a second


def _stale(charge: Charge, strength: float) -> Bill:
    """Compare with places that came by pulses, each of some age by now."""
    age_s = strength * (STALE_S + charge["time_s"] % PULSES_S)
    return Bill(charge.gets_away(age_s))


def _messages(charge: Charge, strength: float) -> Bill:
    """Go ways of an exchange of four messages, the later three of them later."""
    reply_s = REPLY * strength * charge["reply_time_s"]
    return Bill(sum(charge.gets_away(k * reply_s) for k in (1, 2, 3)) / 6)


def _cables(charge: Charge, strength: float) -> Bill:
    """Be late by cables of brackets (of a lognormal law) and by stems of tags, some of several."""
    drawn = charge.common(1)
    cables = CABLES_M * np.exp(CABLES_BY * drawn.standard_normal(BRACKETS).clip(-2.0, 2.0))
    stems = STEMS_M * drawn.binomial(4, 0.5, len(TAGS))
    return Bill(strength * (cables[charge.bracket] + stems[charge.tag]))


def _jumps(charge: Charge, strength: float) -> Bill:
    """Leave some of crystals' offsets, which jump now and then and stay so."""
    drawn = charge.common(2)
    every = BRACKETS + len(TAGS)
    off = OFF_PPM * drawn.standard_normal(every).clip(-2.0, 2.0)
    when = drawn.uniform(0.0, DAY_S, (every, JUMPS))
    by = JUMP_PPM * drawn.choice([-1.0, 1.0], (every, JUMPS))

    def ppm(one: Integers) -> Floats:
        return np.asarray(off[one] + (by[one] * (charge["time_s"][:, None] > when[one])).sum(1))

    apart = ppm(charge.bracket) - ppm(BRACKETS + charge.tag)
    return Bill(0.5 * LIGHT_M_US * strength * apart * charge["reply_time_s"])


def _turns_over(charge: Charge, strength: float) -> Bill:
    """Drift by a parabola, as tuning forks of quartz do about where they turn over."""
    return Bill(EACH_C2 * strength * (charge["temperature_c"] - TURNS_C) ** 2)


def _petals(charge: Charge, strength: float) -> Bill:
    """Be late and weak behind, by a power of a cardioid, and soon at three petals."""
    facing = np.radians(charge["azimuth_deg"])
    behind = np.sin(0.5 * (facing - 0.9)) ** 4
    petals = np.cos(1.5 * (facing + 0.4)) ** 2
    return Bill(strength * (PETAL_M * behind - BACK_M * petals), -LOBE_DB * strength * behind)


def _bias(charge: Charge, strength: float) -> Bill:
    """Be early where it is loud, late where it is weak (a hyperbolic tangent)."""
    return Bill(BIAS_M * strength * np.tanh((EVEN_DBM - charge["rx_power_dbm"]) / OVER_DB))


def _slips(charge: Charge, strength: float) -> Bill:
    """Tell stamps that are a tick soon or late now and then, where edges are too close."""
    slips = charge.rng.choice(
        [-1.0, 0.0, 1.0], charge.rows, p=[0.5 * SLIPS, 1 - SLIPS, 0.5 * SLIPS]
    )
    rest = charge.rng.standard_normal(charge.rows).clip(-3.0, 3.0)
    return Bill(strength * (SLIP_M * slips + REST_M * rest))


def _soaks(charge: Charge, strength: float) -> Bill:
    """Lose so much each metre, as what is soaked up does (Bouguer 1729), links more or less so."""
    own = charge.per_link(lambda n: np.exp(SHADE * charge.rng.standard_normal(n).clip(-2.0, 2.0)))
    return Bill(level_db=-strength * (SOAKS_DB * own * charge.far).clip(0.0, MOST_DB))


def _fast(charge: Charge, strength: float) -> Bill:
    """Count parts too many, by the clocks of both ends."""
    own = charge.common(3).uniform(-OWN, OWN, BRACKETS + len(TAGS))
    both = 1 + own[charge.bracket] + own[BRACKETS + charge.tag]
    return Bill(FAST * strength * both * charge.far)


def _whole_steps(charge: Charge, strength: float) -> Bill:
    """Tell the last whole step that was left behind, of a tag's trade."""
    step, told = strength * np.array(STEPS_M)[charge.tag % 3], charge["range_m"]
    return Bill(step * np.floor(told / step) - told)


def damp(slow: float, wet: Floats) -> Floats:
    """Return how much slower waves are than in air, in stuff with parts of water [n] (CRIM)."""
    return np.asarray((1 - wet) * np.sqrt(slow) + wet * np.sqrt(78.0) - 1)


def _through(charge: Charge, strength: float) -> Bill:
    """Go through walls, sheds, bays, lanterns and staging, that are more or less damp."""
    rng, per_link = charge.rng, charge.per_link
    wet = per_link(lambda n: 0.05 * rng.beta(1.3, 2.4, n))
    kinds = {
        "brick": (3.91, per_link(lambda n: rng.choice([0.11, 0.22], n, p=[0.6, 0.4])), 14.0),
        "concrete": (5.24, per_link(lambda n: rng.uniform(0.1, 0.2, n)), 22.0),
        "wood": (1.99, per_link(lambda n: rng.uniform(0.03, 0.07, n)), 28.0),
        "chipboard": (2.58, per_link(lambda n: rng.uniform(0.03, 0.06, n)), 24.0),
        "glass": (6.31, per_link(lambda n: rng.uniform(0.006, 0.016, n)), 40.0),
    }
    late, lost = np.zeros(charge.rows), np.zeros(charge.rows)
    for what, (slow, thick_m, db) in kinds.items():
        soaks = 0.2 if what == "glass" else 1.0
        late += charge.met(what) * thick_m * damp(slow, soaks * wet)
        lost += charge.met(what) * (0.6 + db * thick_m * (1 + 6 * soaks * wet))
    return Bill(strength * late.clip(max=0.6), first_db=-min(strength, 1.4) * lost.clip(max=9.0))


def by_tanks(charge: Charge) -> tuple[Floats, Floats]:
    """Return how much longer ways by upright tanks are, in m, and what share comes [tanks, n].

    The shortest by a point of each one's side (Fermat 1662); what comes is spread by its roundness
    (Keller 1953). Endless by tanks that ends are in or that are on the way.
    """
    one, other = charge.tag_m, charge.bracket_m
    rise = other[:, 2] - one[:, 2]
    level = np.linalg.norm((other - one)[:, :2], axis=1)
    longer, share = [], []
    for east, north, radius in TANKS_M.tolist():
        side = np.array([east, north]) + radius * np.stack([np.cos(TURNS), np.sin(TURNS)], axis=1)
        legs = [np.linalg.norm(end[:, None, :2] - side, axis=2) for end in (one, other)]
        best = (legs[0] + legs[1]).argmin(axis=1)[:, None]
        near, far = (np.take_along_axis(leg, best, axis=1)[:, 0] for leg in legs)
        aims = (near**2 + far**2 - level**2) / (2 * near * far).clip(1e-9)
        slant = np.sqrt(0.5 * (1 + aims.clip(-1.0, 1.0)))
        ends = np.stack([one, other])[:, :, :2] - [east, north]
        within = np.linalg.norm(ends, axis=2).min(axis=0) < radius + 0.05
        way = np.hypot(near + far, rise)
        spread = 1 + 2 * near * far / ((near + far) * radius * slant.clip(0.08))
        lost = within | (slant < 0.06)
        longer.append(np.where(lost, np.inf, way - charge.far))
        share.append(np.where(lost, 0.0, charge.far / way / np.sqrt(spread)))
    return np.stack(longer), np.stack(share)


def _by_tanks(charge: Charge, strength: float) -> Bill:
    """Hear, out of sight, nothing but what one of the four nearest tanks returns."""
    shut = charge.shut_in(SHUT_IN[charge.rare])
    order = np.sort(by_tanks(charge)[0], axis=0)
    which = charge.per_link(lambda n: charge.rng.choice(4, n, p=[0.1, 0.3, 0.3, 0.3]))
    late = order[which.astype(np.int64), np.arange(charge.rows)].clip(SOONEST_M, LONGEST_M)
    return Bill(shut * late * strength**0.4, -0.7 * shut, -6.0 * shut)


def of_layers(sine: Floats) -> Complexes:
    """Return what breeze on bricks returns of waves that lie, so steep [n] (Airy 1833)."""
    slant = 1 - sine**2
    air, upper, lower = (np.sqrt(one - slant + 0j) for one in (1.0, BREEZE, BRICK))
    first, second = (air - upper) / (air + upper), (upper - lower) / (upper + lower)
    there = second * np.exp(-4j * np.pi * DEEP_M * upper / WAVE_M)
    return np.asarray((first + there) / (1 + first * there))


def off_the_ground(charge: Charge, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ground is in m, and its complex share, [n] each."""
    high = charge.tag_m[:, 2] + charge.bracket_m[:, 2]
    way = np.sqrt(charge.far**2 + 4 * charge.tag_m[:, 2] * charge.bracket_m[:, 2])
    bare = charge.per_link(lambda n: charge.rng.triangular(0.4, 0.8, 1.0, n))
    share = np.sqrt(strength) * 1.5 * bare * charge.far / way * of_layers(high / way)
    share = share * np.minimum(1.0, 0.77 / np.abs(share).clip(1e-9))
    return way - charge.far, share * np.exp(-2j * np.pi * (way - charge.far) / WAVE_M)


def told_with(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As meters have it of two pulses, the second of which is so much later and such a share.
    """
    top, each_m = np.full(len(longer_m), 84.3), LIGHT_M_NS * SAMPLE_NS
    both = puffs(top) + share[:, None] * puffs(top + longer_m / each_m)
    at = metered(both)
    return each_m * (at - top + AHEAD), heights(both, at, np.full(len(top), 1e-7))


def _ground(charge: Charge, strength: float) -> Bill:
    """Be where a meter has both pulses: that of the ground comes later."""
    late, high = told_with(*off_the_ground(charge, strength))
    return Bill(late.clip(-0.24, 0.24), first_db=20 * np.log10(high.clip(0.4, 2.2)))


def edge_db(one: Floats, other: Floats, high: Floats) -> Floats:
    """Return what an edge takes in dB that stands so high between ends so far off, in m [n]."""
    bend = high * np.sqrt(2 * (one + other) / (WAVE_M * one * other)) - 0.1
    return np.asarray(6.9 + 20 * np.log10(np.sqrt(bend**2 + 1) + bend))


def over_heaps(far: Floats, part: Floats, high: Floats, wide: Floats) -> tuple[Floats, Floats]:
    """Return how much longer ways over flat heaps are in m, and what these take in dB, [n] each.

    By either edge of tops, from the end to the other edge (Epstein and Peterson 1953).
    """
    wide = np.minimum(wide, 0.3 * far)
    one, other = part * (far - wide), (1 - part) * (far - wide)
    longer = np.hypot(one, high) + wide + np.hypot(other, high) - far
    first = edge_db(one, wide, high * wide / (one + wide))
    return longer, first + edge_db(wide, other, high * wide / (other + wide))


def _heaps(charge: Charge, strength: float) -> Bill:
    """Bend over both edges of iron bins' tops."""
    rng, iron = charge.rng, charge.met("metal")
    high = charge.per_link(lambda n: rng.uniform(*HEAP_M, n))
    wide = charge.per_link(lambda n: rng.uniform(*RIDGE_M, n))
    part = charge.per_link(lambda n: rng.uniform(0.3, 0.7, n))
    high = np.minimum(np.sqrt(strength) * high, 0.28 * charge.far)
    longer, lost = over_heaps(charge.far, part, high, wide)
    return Bill(iron * longer.clip(0.0, 0.45), first_db=-iron * lost.clip(1.0, 10.0))


def _flatter(charge: Charge, strength: float) -> Bill:
    """Tell levels by less the further they are over a knee, and sum fewer symbols there."""
    over = (charge["rx_power_dbm"] - KNEE_DBM).clip(0.0, 20.0)
    bent = over**2 / (over + BENDS_DB)
    return Bill(level_db=-min(FLATTER * strength, 0.8) * bent,
                count_db=-FEWER * min(strength, 2.0) * bent)  # fmt: skip


def _sparks(charge: Charge, strength: float) -> Bill:
    """Hear sparks that light burners: noise's power rises by each, by tags more or less so."""
    own = charge.common(4).uniform(0.35, 1.0, len(TAGS))[charge.tag]
    db = strength * (PLAIN_DB + 10 * np.log10(1 + EACH_SPARK * own * charge["sparks_hz"]))
    weak = 10 ** ((-82.0 - charge["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    chance = charge.rng.logistic(0.0, 0.5513, charge.rows).clip(-3.5, 3.5)
    return Bill(0.0085 * chance * weak.clip(max=5.0), noise_db=db)


EFFECTS: dict[str, Callable[[Charge, float], Bill]] = {
    "antenna-delay": _cables,
    "antenna-pattern": _petals,
    "blocked-path": _by_tanks,
    "clock-offset": _jumps,
    "diffraction": _heaps,
    "exchange-motion": _messages,
    "ground-bounce": _ground,
    "level-control": _flatter,
    "material-delay": _through,
    "noise-floor": _sparks,
    "path-loss": _soaks,
    "power-bias": _bias,
    "range-rounding": _whole_steps,
    "range-scale": _fast,
    "temperature-drift": _turns_over,
    "time-lag": _stale,
    "timestamp-jitter": _slips,
    **OF_THE_GASWORKS,
}
