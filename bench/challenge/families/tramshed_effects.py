"""What the tram shed hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the tram shed's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.tramshed_bell import (
    AHEAD,
    LIGHT_M_NS,
    SAMPLE_NS,
    loudness,
    peals,
    rung,
)
from bench.challenge.families.tramshed_depot import (
    ARCADE_X,
    ARCADE_Y,
    ARCHES_X,
    LIGHT_M_US,
    ROSETTES,
    SHED_M,
    TAGS,
    WAVE_M,
    Fares,
    Fine,
    lengths,
)
from bench.challenge.families.tramshed_faults import OF_THE_TRAMSHED

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
SHUT = {False: 0.2, True: 0.08}  # of links, and where these are rare
QUEUE_S, EACH_S = 0.09, 0.0022  # of places; more for each rosette that is asked before
VOLLEY = 6  # messages of an exchange, ranges of which are averaged, a reply apart
REELS_M: Floats = np.array([0.04, 0.07, 0.11, 0.18, 0.29])  # of rosettes' leads, cut off reels
STRAPS_M = 0.035  # of tags' straps, of an exponential law
OFF_PPM, AGES_PPM, AGES_S = 0.012, 0.011, 2400.0  # of crystals; as the logarithm of time on
BASE_C, SOFT_C, EACH_C = 12.0, 5.0, 0.0062  # where delays begin to grow; how softly; m a degree
LOBES_M, HIDES_DB = (0.048, 0.03), 3.4  # late by one lobe and by three; weaker
BIAS_M, EVEN_DBM, SOFT_DB = 0.074, -87.0, 4.5  # at most; of none; until 0.7 of it
EDGES_M, BIN_M = 0.031, 0.024  # off by either edge of a clock; of bins, to either side
MOST_DB, FOLD_M, OWN = 9.0, 14.0, 0.3  # lost at most; until 1 - 1 / e; e-folds of links
FAST, SHAPE = 0.0071, 5.0  # parts counted more; of a gamma law, of rosettes and of tags
STEPS_M = (0.13, 0.1)  # that tags of even and odd numbers write
MOIST_N = 8.9  # of water
SOONEST_M, LONGEST_M = 0.5, 5.0  # of ways by arches, longer than straight ones
SETTS = 5.4 - 0.35j
WAVY_M, SLANT = (0.0, 0.007), (0.2, 0.9)  # of the floor; radians of antennas off level
OVER_M, WIDE_M = (0.35, 0.75), (1.6, 2.4)  # trams' roofs over straight ways; how wide these are
KNEE_DBM, GIVES_DB, MOST_LESS, FEWER = -92.0, 9.0, 1.5, 0.4
HUM_DB, EACH_A = 0.9, 0.024  # of noise: as the root of motors' A; power of each A


def _queued(fares: Fares, strength: float) -> Fine:
    """Compare with places that are late by a queue, the longer the higher a rosette's number."""
    return Fine(fares.moves_off(strength * (QUEUE_S + EACH_S * fares.rosette.astype(np.float64))))


def _volley(fares: Fares, strength: float) -> Fine:
    """Average ranges of a volley of messages, each a reply later than the one before."""
    reply_s = strength * fares["reply_time_s"]
    return Fine(np.mean([fares.moves_off(k * reply_s) for k in range(1, VOLLEY + 1)], axis=0))


def _reels(fares: Fares, strength: float) -> Fine:
    """Be late by leads of rosettes, cut off a few reels, and by straps of tags."""
    drawn = fares.alike(1)
    reels = drawn.choice(REELS_M, ROSETTES)
    straps = STRAPS_M * drawn.standard_exponential(len(TAGS)).clip(max=3.0)
    return Fine(strength * (reels[fares.rosette] + straps[fares.tag]))


def _ages(fares: Fares, strength: float) -> Fine:
    """Leave some of crystals' offsets, which age by the logarithm of the time that they are on."""
    drawn, every = fares.alike(2), ROSETTES + len(TAGS)
    off, age = OFF_PPM * drawn.uniform(-1.7, 1.7, every), AGES_PPM * drawn.uniform(-1, 1, every)
    on = np.log1p(fares["time_s"] / AGES_S)
    pair = (ROSETTES + fares.tag, fares.rosette)
    apart = off[pair[0]] - off[pair[1]] + (age[pair[0]] - age[pair[1]]) * on
    return Fine(0.5 * LIGHT_M_US * strength * apart * fares["reply_time_s"])


def _softly(fares: Fares, strength: float) -> Fine:
    """Be late by warmth over BASE_C, from which it grows softly (a soft plus)."""
    over = (fares["temperature_c"] - BASE_C) / SOFT_C
    return Fine(strength * EACH_C * SOFT_C * np.logaddexp(0.0, over))


def _lobes(fares: Fares, strength: float) -> Fine:
    """Be late by one broad lobe and three narrow ones, and weak in the broad one."""
    facing = np.radians(fares["azimuth_deg"])
    broad = 0.5 - 0.5 * np.cos(facing + 0.7)
    late = LOBES_M[0] * (2 * broad - 0.6) + LOBES_M[1] * np.sin(3 * facing - 0.4)
    return Fine(strength * late, -HIDES_DB * strength * broad**2)


def _leans(fares: Fares, strength: float) -> Fine:
    """Be early where it is loud, late where it is weak, ever less so (a hyperbola's branch)."""
    off = (EVEN_DBM - fares["rx_power_dbm"]) / SOFT_DB
    return Fine(BIAS_M * strength * off / np.hypot(1.0, off))


def _edges(fares: Fares, strength: float) -> Fine:
    """Stamp by either edge of a clock and by bins between."""
    edge = fares.rng.choice([-1.0, 1.0], fares.rows)
    return Fine(strength * (EDGES_M * edge + fares.rng.uniform(-BIN_M, BIN_M, fares.rows)))


def _soaks(fares: Fares, strength: float) -> Fine:
    """Lose by every metre a part of what is left to lose, links more or less so."""
    own = fares.each_link(lambda n: np.exp(OWN * fares.rng.uniform(-1.7, 1.7, n)))
    return Fine(level_db=MOST_DB * strength * (np.expm1(-fares.far * own / FOLD_M)).clip(-1.0))


def _fast(fares: Fares, strength: float) -> Fine:
    """Count parts too many, by clocks of both ends (of a gamma law)."""
    drawn = fares.alike(3)
    ends = [drawn.gamma(SHAPE, 1 / SHAPE, n).clip(0.3, 2.2) for n in (ROSETTES, len(TAGS))]
    return Fine(0.5 * FAST * strength * (ends[0][fares.rosette] + ends[1][fares.tag]) * fares.far)


def _steps(fares: Fares, strength: float) -> Fine:
    """Write the middle of the step that it is in, of steps as wide as a tag's number has it."""
    wide, told = strength * np.array(STEPS_M)[fares.tag % 2], fares["range_m"]
    return Fine(wide * (np.floor(told / wide) + 0.5) - told)


def mixed(dry: float, moist: Floats) -> Floats:
    """Return how many times slower it is in what holds a part of water (of Birchak 1974)."""
    return np.asarray((1 - moist) * np.sqrt(dry) + moist * MOIST_N)


def _moist(fares: Fares, strength: float) -> Fine:
    """Go through what is more or less moist, aslant."""
    rng, each_link = fares.rng, fares.each_link
    slant = each_link(lambda n: 1 / np.cos(rng.uniform(0.0, 0.8, n)))
    kinds = {
        "brick": (3.4, each_link(lambda n: rng.choice([0.11, 0.23], n, p=[0.75, 0.25])), 0.05, 18),
        "concrete": (4.6, each_link(lambda n: rng.uniform(0.06, 0.18, n)), 0.04, 20),
        "wood": (1.8, each_link(lambda n: rng.uniform(0.05, 0.12, n)), 0.06, 22),
        "chipboard": (2.2, each_link(lambda n: rng.uniform(0.02, 0.05, n)), 0.05, 26),
        "glass": (6.5, each_link(lambda n: rng.choice([0.01, 0.018], n)), 0.0, 40),
    }
    late, lost = np.zeros(fares.rows), np.zeros(fares.rows)
    for what, (dry, thick_m, most, db) in kinds.items():
        moist = most * each_link(rng.random)
        here = fares.through(what) * thick_m * slant
        late += here * (mixed(dry, moist) - 1)
        lost += here * (db + 90.0 * moist) + 0.6 * fares.through(what)
    return Fine(strength * late.clip(max=0.5), first_db=-min(strength, 1.4) * lost.clip(max=9.0))


def by_arches(fares: Fares) -> Floats:
    """Return how much longer ways are by points in arches and round both ends of the arcade.

    In m [points, n]; at the height at which straight ways are amid.
    """
    at_x = [0.5 * (ARCADE_X[0] - 1.0), *(0.5 * (a + b) for a, b in ARCHES_X), 43.5]
    high = 0.5 * (fares.tag_m[:, 2] + fares.rosette_m[:, 2])
    made = []
    for x in at_x:
        by = np.column_stack([np.full(fares.rows, x), np.full(fares.rows, ARCADE_Y), high])
        made.append(lengths(fares.tag_m - by) + lengths(by - fares.rosette_m) - fares.far)
    return np.stack(made)


def _arches(fares: Fares, strength: float) -> Fine:
    """Hear, out of sight, nothing but what comes by arches or the roof, whichever is sooner."""
    shut = fares.shut_off(SHUT[fares.rare])
    up = fares.rosette_m * [1.0, 1.0, -1.0] + [0.0, 0.0, 2 * SHED_M[2]]
    roof = lengths(fares.tag_m - up) - fares.far
    later = fares.each_link(lambda n: fares.rng.gamma(2.0, 0.35, n))
    late = (np.minimum(by_arches(fares).min(axis=0), roof) + later).clip(SOONEST_M, LONGEST_M)
    return Fine(shut * late * strength**0.4, -1.0 * shut, -6.0 * shut)


def flat_back(slow: complex, sine: Floats, slant: Floats) -> Complexes:
    """Return what a floor returns of waves so steep, of antennas so far off level [n] (Fresnel)."""
    under = np.sqrt(slow - 1 + sine**2 + 0j)
    level, upright = (sine - under) / (sine + under), (slow * sine - under) / (slow * sine + under)
    return np.asarray(np.cos(slant) ** 2 * level + np.sin(slant) ** 2 * upright)


def off_the_setts(fares: Fares, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    What is wavy returns less, by a Bessel's I0 ever more slowly so (Miller and Brown 1984).
    """
    rise = fares.tag_m[:, 2] + fares.rosette_m[:, 2]
    way = np.hypot(rise, lengths((fares.tag_m - fares.rosette_m)[:, :2]))
    wavy = fares.each_link(lambda n: fares.rng.uniform(*WAVY_M, n))
    slant = fares.each_link(lambda n: fares.rng.uniform(*SLANT, n))
    rough = 0.5 * (4 * np.pi * wavy * rise / way / WAVE_M) ** 2
    kept = np.exp(-rough) * np.i0(rough)
    share = 2.1 * np.sqrt(strength) * kept * fares.far / way * flat_back(SETTS, rise / way, slant)
    share = share / np.maximum(1.0, np.abs(share) / 0.8)
    return way - fares.far, share * np.exp(-2j * np.pi * (way - fares.far) / WAVE_M)


def told_of_both(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As bells have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(np.shape(longer_m), 93.3)
    one = LIGHT_M_NS * SAMPLE_NS
    both = peals(top) + share[:, None] * peals(top + longer_m / one)
    told = rung(both)
    return one * (told + AHEAD - top), loudness(both, told, np.full(len(top), 1e-6))


def _ground(fares: Fares, strength: float) -> Fine:
    """Be where a bell has both pulses: that of the floor comes later."""
    late, high = told_of_both(*off_the_setts(fares, strength))
    return Fine(late.clip(-0.24, 0.24), first_db=20 * np.log10(high.clip(0.4, 2.2)))


def edge_db(bend: Floats) -> Floats:
    """Return what an edge takes in dB by Fresnel's parameter [n] (ITU-R P.526)."""
    off = bend - 0.1
    return np.asarray(6.9 + 20 * np.log10(np.hypot(off, 1.0) + off))


def over_roofs(far: Floats, part: Floats, high: Floats, wide: Floats) -> tuple[Floats, Floats]:
    """Return how much longer ways over flat roofs are in m, and what these take in dB, [n] each.

    Over both edges of a roof; each is bent over as if the other were where its ways end.
    """
    wide = np.minimum(wide, 0.4 * far)
    one, other = part * (far - wide), (1 - part) * (far - wide)
    longer = np.hypot(one, high) + np.hypot(other, high) + wide - far
    bends = [high * np.sqrt(2 * (side + wide) / (WAVE_M * side * wide)) * wide / (side + wide)
             + high * np.sqrt(2 / (WAVE_M * (side + wide))) for side in (one, other)]  # fmt: skip
    return longer, 0.5 * (edge_db(bends[0]) + edge_db(bends[1]))


def _roofs(fares: Fares, strength: float) -> Fine:
    """Bend over roofs of trams."""
    rng, iron = fares.rng, fares.through("metal")
    high = np.sqrt(strength) * fares.each_link(lambda n: rng.uniform(*OVER_M, n))
    wide = fares.each_link(lambda n: rng.uniform(*WIDE_M, n))
    part = fares.each_link(lambda n: rng.beta(3.0, 3.0, n).clip(0.2, 0.8))
    longer, lost = over_roofs(fares.far, part, np.minimum(high, 0.2 * fares.far), wide)
    return Fine(iron * longer.clip(0.0, 0.45), first_db=-iron * lost.clip(1.0, 9.5))


def _gives(fares: Fares, strength: float) -> Fine:
    """Tell levels over a knee by a hyperbolic tangent of these, and sum fewer symbols there."""
    over = (fares["rx_power_dbm"] - KNEE_DBM).clip(0.0, 25.0)
    less = over - GIVES_DB * np.tanh(over / GIVES_DB)
    return Fine(level_db=-min(strength, MOST_LESS) * less,
                count_db=-FEWER * min(strength, 2.0) * less)  # fmt: skip


def _motors(fares: Fares, strength: float) -> Fine:
    """Hear brushes of motors: noise's power rises with their current, by rosettes more or less."""
    own = fares.alike(4).uniform(0.5, 1.5, ROSETTES)[fares.rosette]
    amps = fares["motor_a"]
    db = strength * (HUM_DB * np.sqrt(amps / 35.0) + 10 * np.log10(1 + EACH_A * own * amps))
    weak = 10 ** ((EVEN_DBM - fares["rx_power_dbm"]) / 20) * np.sqrt(
        np.expm1(0.1 * np.log(10) * db)
    )
    chance = fares.rng.logistic(0.0, np.sqrt(3) / np.pi, fares.rows).clip(-3.5, 3.5)
    return Fine(0.0085 * chance * weak.clip(max=5.0), noise_db=db)


EFFECTS: dict[str, Callable[[Fares, float], Fine]] = {
    "antenna-delay": _reels,
    "antenna-pattern": _lobes,
    "blocked-path": _arches,
    "clock-offset": _ages,
    "diffraction": _roofs,
    "exchange-motion": _volley,
    "ground-bounce": _ground,
    "level-control": _gives,
    "material-delay": _moist,
    "noise-floor": _motors,
    "path-loss": _soaks,
    "power-bias": _leans,
    "range-rounding": _steps,
    "range-scale": _fast,
    "temperature-drift": _softly,
    "time-lag": _queued,
    "timestamp-jitter": _edges,
    **OF_THE_TRAMSHED,
}
