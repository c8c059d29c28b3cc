"""What the lighthouse hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the lighthouse's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.lighthouse_faults import OF_THE_LIGHTHOUSE
from bench.challenge.families.lighthouse_lens import (
    AHEAD,
    LIGHT_M_NS,
    SAMPLE_NS,
    brightness,
    focused,
    gleams,
)
from bench.challenge.families.lighthouse_station import (
    CRESSETS,
    LIGHT_M_US,
    NIGHT_S,
    ROCK_M,
    TAGS,
    WAVE_M,
    Dues,
    Entries,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
CUT_OFF = {False: 0.2, True: 0.08}  # of links, and where these are rare
LAG_S, EACH_LAG_S = 0.1, 0.012  # of places; more by each of five kinds of tags' logs
REPLIES = (1.7, 4.1)  # replies until the second and the third message
LEADS_M, EACH_LEAD, HARNESS_M = 0.035, 2.4, 0.022  # of cressets, of a gamma law; of tags
OFF_PPM, SWING_PPM = 0.014, 0.011  # of crystals off; by which they swing over a night
FLAT_C, CUBE_C3, SLOPE_C = 13.0, 3.6e-5, 0.0025  # of crystals cut so; late for C^3 and C
BEHIND_M, ASIDE_M, HIDES_DB, NARROW = 0.13, 0.065, 3.6, 2.2  # late; late and soon; weaker
BIAS_M, EVEN_DBM, OVER_DB = 0.072, -81.0, 5.0  # at most; of none; until half of it
SWEPT_M, REST_M = 0.052, 0.011  # of stamps, to either side; else
BREAK_M, POWER, SHADE, MOST_DB = 9.0, 9.5, 0.35, 11.0  # of slopes; dB a tenfold; of links; most
FAST, OWN = 0.0092, 0.35  # parts that clocks count more; e-folds of cressets
DIVISIONS_M = (0.11, 0.14)  # of cressets' dials
SOONEST_M, LONGEST_M = 0.6, 5.2  # of ways by walls, longer than straight ones
ROCK = 6.2 - 0.5j  # wet
ROUGH_M = (0.0, 0.008)  # of the ground
CREST_M, ROUND_M = (0.4, 0.9), (0.2, 0.9)  # of rocks over straight ways; how round these are
KNEE_DBM, SOFT_DB, MOST_LESS, FEWER = -87.5, 6.0, 1.5, 0.45
ARC_A, STEEPENS, PLAIN_DB = 19.0, 1.4, 0.25  # of an arc whose noise is as strong as all else


def _behind(entries: Entries, strength: float) -> Dues:
    """Compare with places that tags' logs are late by, each kind of log by its own time."""
    later_s = strength * (LAG_S + EACH_LAG_S * np.asarray(entries.tag % 5, np.float64))
    return Dues(entries.bears_off(later_s))


def _messages(entries: Entries, strength: float) -> Dues:
    """Go ways of an exchange of three messages: of the middle one twice what of the last."""
    reply_s = strength * entries["reply_time_s"]
    second, third = (entries.bears_off(k * reply_s) for k in REPLIES)
    return Dues((2 * second + third) / 2)


def _leads(entries: Entries, strength: float) -> Dues:
    """Be late by leads of cressets (of a gamma law) and by harnesses of tags, worn in threes."""
    drawn = entries.common(1)
    leads = LEADS_M * drawn.gamma(EACH_LEAD, 1.0, CRESSETS).clip(max=8.0)
    harness = HARNESS_M * drawn.integers(0, 5, len(TAGS))
    return Dues(strength * (leads[entries.cresset] + harness[entries.tag]))


def _swings(entries: Entries, strength: float) -> Dues:
    """Leave some of crystals' offsets, which swing over a night by phases of their own."""
    drawn = entries.common(2)
    every = CRESSETS + len(TAGS)
    off = OFF_PPM * drawn.uniform(-1.8, 1.8, every)
    swing, phase = SWING_PPM * drawn.uniform(0.5, 1.5, every), drawn.uniform(-np.pi, np.pi, every)

    def ppm(one: Integers) -> Floats:
        turn = 2 * np.pi * entries["time_s"] / NIGHT_S + phase[one]
        return np.asarray(off[one] + swing[one] * np.sin(turn))

    apart = ppm(entries.cresset) - ppm(CRESSETS + entries.tag)
    return Dues(0.5 * LIGHT_M_US * strength * apart * entries["reply_time_s"])


def _cubed(entries: Entries, strength: float) -> Dues:
    """Drift by a cubic, as crystals do that are cut to be flat about the middle."""
    off = entries["temperature_c"] - FLAT_C
    return Dues(strength * (CUBE_C3 * off**3 - SLOPE_C * off))


def _petals(entries: Entries, strength: float) -> Dues:
    """Be late and weak behind, narrowly (von Mises 1918), late on one side, soon on the other."""
    facing = np.radians(entries["azimuth_deg"])
    behind = np.exp(NARROW * (np.cos(facing - 2.6) - 1))
    aside = np.sin(facing + 0.3) * np.abs(np.sin(facing + 0.3))
    return Dues(strength * (BEHIND_M * behind + ASIDE_M * aside), -HIDES_DB * strength * behind)


def _bias(entries: Entries, strength: float) -> Dues:
    """Be early where it is loud, late where it is weak (an arc tangent)."""
    off = (EVEN_DBM - entries["rx_power_dbm"]) / OVER_DB
    return Dues(BIAS_M * strength * 2 / np.pi * np.arctan(off))


def _swept(entries: Entries, strength: float) -> Dues:
    """Stamp by a clock that is swept to and fro to spread its spectrum (an arc-sine law)."""
    swept = np.sin(entries.rng.uniform(-np.pi, np.pi, entries.rows))
    rest = entries.rng.triangular(-2.4, 0.0, 2.4, entries.rows)
    return Dues(strength * (SWEPT_M * swept + REST_M * rest))


def _breaks(entries: Entries, strength: float) -> Dues:
    """Lose by a steeper slope past a break (two slopes), links more or less so."""
    own = entries.per_link(lambda n: np.exp(SHADE * entries.rng.uniform(-1.7, 1.7, n)))
    lost = POWER * own * np.log10(1 + (entries.far / BREAK_M) ** 2)
    return Dues(level_db=-strength * lost.clip(0.0, MOST_DB))


def _fast(entries: Entries, strength: float) -> Dues:
    """Count parts too many, by clocks of cressets alone (of a lognormal law)."""
    own = np.exp(OWN * entries.common(3).standard_normal(CRESSETS).clip(-1.8, 1.8))
    return Dues(FAST * strength * own[entries.cresset] * entries.far)


def _divisions(entries: Entries, strength: float) -> Dues:
    """Tell the nearest division of a cresset's dial, set a third of one off nought."""
    step, told = strength * np.array(DIVISIONS_M)[entries.cresset % 2], entries["range_m"]
    return Dues(step * (np.rint(told / step - 1 / 3) + 1 / 3) - told)


def through(slow: float, thick_m: Floats, sine: Floats) -> Floats:
    """Return how much longer ways are through slabs so thick, met so aslant, in m [n] (Snell)."""
    return np.asarray(thick_m * (np.sqrt(slow - sine**2) - np.sqrt(1 - sine**2)))


def _through(entries: Entries, strength: float) -> Dues:
    """Go aslant through walls, panes, boulders, planks and boards."""
    rng, per_link = entries.rng, entries.per_link
    sine = per_link(lambda n: np.sqrt(rng.uniform(0.0, 0.7, n)))
    kinds = {
        "brick": (4.1, per_link(lambda n: rng.triangular(0.06, 0.1, 0.16, n)), 19.0),
        "concrete": (5.4, per_link(lambda n: rng.gamma(9.0, 0.014, n).clip(0.06, 0.22)), 20.0),
        "wood": (2.1, per_link(lambda n: rng.uniform(0.04, 0.09, n)), 24.0),
        "chipboard": (2.5, per_link(lambda n: rng.uniform(0.02, 0.05, n)), 26.0),
        "glass": (6.4, per_link(lambda n: rng.choice([0.008, 0.02], n, p=[0.7, 0.3])), 36.0),
    }
    late, lost = np.zeros(entries.rows), np.zeros(entries.rows)
    for what, (slow, thick_m, db) in kinds.items():
        late += entries.met(what) * through(slow, thick_m, sine)
        lost += entries.met(what) * (0.5 + db * thick_m / np.sqrt(1 - sine**2 / slow))
    return Dues(strength * late.clip(max=0.5), first_db=-min(strength, 1.4) * lost.clip(max=9.0))


def mirrored(slow: complex, sine: Floats) -> Complexes:
    """Return what a smooth face returns of waves that lie along it, so steep [n] (Fresnel)."""
    beyond = np.sqrt(slow - 1 + sine**2 + 0j)
    return np.asarray((sine - beyond) / (sine + beyond))


def by_walls(entries: Entries) -> tuple[Floats, Floats]:
    """Return how much longer ways by outer walls and their corners are, in m, and what comes.

    [8, n] each: of images in one wall, and in two at once that meet.
    """
    sides = [(0, 0.0), (0, ROCK_M[0]), (1, 0.0), (1, ROCK_M[1])]
    pairs = [(one,) for one in sides] + [(one, two) for one in sides[:2] for two in sides[2:]]
    longer, share = [], []
    for faces in pairs:
        image = entries.cresset_m.copy()
        for axis, side in faces:
            image[:, axis] = 2 * side - image[:, axis]
        way = image - entries.tag_m
        long_m = np.linalg.norm(way, axis=1)
        back = np.ones(entries.rows)
        for axis, _ in faces:
            back = back * np.abs(mirrored(5.5 + 0j, np.abs(way[:, axis]) / long_m))
        longer.append(long_m - entries.far)
        share.append(back * entries.far / long_m)
    return np.stack(longer), np.stack(share)


def _by_walls(entries: Entries, strength: float) -> Dues:
    """Hear, out of sight, nothing but what walls return, that by the nearest the likeliest."""
    shut = entries.cut_off(CUT_OFF[entries.rare])
    order = np.sort(by_walls(entries)[0], axis=0)
    which = entries.per_link(lambda n: entries.rng.binomial(2, 0.35, n)).astype(np.int64)
    late = order[which, np.arange(entries.rows)].clip(SOONEST_M, LONGEST_M)
    return Dues(shut * late * strength**0.4, -0.8 * shut, -6.5 * shut)


def off_the_rock(entries: Entries, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ground is in m, and its complex share, [n] each.

    What is rough returns less (Ament 1953).
    """
    rise = entries.tag_m[:, 2] + entries.cresset_m[:, 2]
    way = np.sqrt(entries.far**2 + 4 * entries.tag_m[:, 2] * entries.cresset_m[:, 2])
    rough = entries.per_link(lambda n: entries.rng.uniform(*ROUGH_M, n))
    kept = np.exp(-0.5 * (4 * np.pi * rough * rise / way / WAVE_M) ** 2)
    share = np.sqrt(strength) * 1.9 * kept * entries.far / way * mirrored(ROCK, rise / way)
    share = share * np.minimum(1.0, 0.8 / np.abs(share).clip(1e-9))
    return way - entries.far, share * np.exp(-2j * np.pi * (way - entries.far) / WAVE_M)


def told_with(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As lenses have it of two pulses, the second of which is so much later and such a share.
    """
    top, each_m = np.full(len(longer_m), 86.4), LIGHT_M_NS * SAMPLE_NS
    both = gleams(top) + share[:, None] * gleams(top + longer_m / each_m)
    at = focused(both)
    return each_m * (at - top + AHEAD), brightness(both, at, np.full(len(top), 1e-7))


def _ground(entries: Entries, strength: float) -> Dues:
    """Be where a lens has both pulses: that of the ground comes later."""
    late, high = told_with(*off_the_rock(entries, strength))
    return Dues(late.clip(-0.25, 0.25), first_db=20 * np.log10(high.clip(0.4, 2.2)))


def knife_db(bend: Floats) -> Floats:
    """Return what edges take in dB by Fresnel's parameter >= 0 [n], in pieces (Lee 1985)."""
    far, amid = 0.225 / bend.clip(2.4), bend.clip(1.0, 2.4)
    middle = 0.4 - np.sqrt(0.1184 - (0.38 - 0.1 * amid) ** 2)
    near = 0.5 * np.exp(-0.95 * bend)
    kept = np.where(bend <= 1.0, near, np.where(bend <= 2.4, middle, far))
    return np.asarray(-20 * np.log10(kept))


def over_rocks(far: Floats, part: Floats, high: Floats, around: Floats) -> tuple[Floats, Floats]:
    """Return how much longer ways over round rocks are in m, and what these take in dB, [n] each.

    Along both tangents and the arc between; a bend is that of an edge where tangents meet, and
    more by how round it is.
    """
    one, other = part * far, (1 - part) * far
    turn = np.arctan(high / one) + np.arctan(high / other)
    saved = around * (2 * np.tan(0.5 * turn) - turn)
    longer = np.hypot(one, high) + np.hypot(other, high) - far - saved
    bend = high * np.sqrt(2 * far / (WAVE_M * one * other))
    curve = around * far / (one * other) / np.cbrt(np.pi * around / WAVE_M)
    return longer, knife_db(bend) + 7.0 * np.sqrt(curve)


def _crests(entries: Entries, strength: float) -> Dues:
    """Bend over round crests of iron-bound rocks."""
    rng, iron = entries.rng, entries.met("metal")
    high = entries.per_link(lambda n: rng.uniform(*CREST_M, n))
    around = entries.per_link(lambda n: rng.uniform(*ROUND_M, n))
    part = entries.per_link(lambda n: rng.triangular(0.2, 0.5, 0.8, n))
    high = np.minimum(np.sqrt(strength) * high, 0.2 * entries.far)
    longer, lost = over_rocks(entries.far, part, high, around)
    return Dues(iron * longer.clip(0.0, 0.45), first_db=-iron * lost.clip(1.0, 10.0))


def _softer(entries: Entries, strength: float) -> Dues:
    """Tell levels by the logarithm of what is over a knee, and sum fewer symbols there."""
    over = (entries["rx_power_dbm"] - KNEE_DBM).clip(0.0, 20.0)
    less = over - SOFT_DB * np.log1p(over / SOFT_DB)
    return Dues(level_db=-min(strength, MOST_LESS) * less,
                count_db=-FEWER * min(strength, 2.0) * less)  # fmt: skip


def _arc(entries: Entries, strength: float) -> Dues:
    """Hear the arc of the lamp hiss: noise's power rises by a power of its current."""
    own = entries.common(4).triangular(0.4, 0.7, 1.0, CRESSETS)[entries.cresset]
    more = 10 * np.log10(1 + own * (entries["arc_a"] / ARC_A) ** STEEPENS)
    db = strength * (PLAIN_DB + more)
    weak = 10 ** ((-81.0 - entries["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    chance = entries.rng.laplace(0.0, 0.7071, entries.rows).clip(-3.6, 3.6)
    return Dues(0.0082 * chance * weak.clip(max=5.0), noise_db=db)


EFFECTS: dict[str, Callable[[Entries, float], Dues]] = {
    "antenna-delay": _leads,
    "antenna-pattern": _petals,
    "blocked-path": _by_walls,
    "clock-offset": _swings,
    "diffraction": _crests,
    "exchange-motion": _messages,
    "ground-bounce": _ground,
    "level-control": _softer,
    "material-delay": _through,
    "noise-floor": _arc,
    "path-loss": _breaks,
    "power-bias": _bias,
    "range-rounding": _divisions,
    "range-scale": _fast,
    "temperature-drift": _cubed,
    "time-lag": _behind,
    "timestamp-jitter": _swept,
    **OF_THE_LIGHTHOUSE,
}
