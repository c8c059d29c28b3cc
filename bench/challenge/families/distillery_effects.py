"""What the distillery hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the distillery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.distillery_faults import UNHEARD_OF
from bench.challenge.families.distillery_house import (
    LIGHT_M_US,
    LINTELS,
    POTS_M,
    TAGS,
    WAVE_M,
    Duty,
    Run,
)
from bench.challenge.families.distillery_safe import AHEAD, METRES, drops, matched, tellings

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
SHUT_OFF = {False: 0.2, True: 0.075}  # of links, and where these are rare
FORGETS_S = 0.115  # to 1 / e of places that a tracker keeps
LATER = (1.2, 4.0)  # replies between which ways are gone
COUNTED_M: Floats = np.array([12.0, 0.6, 3.0])  # where cables of lintels come together
CABLE, PLUG_M, TAGS_M = 0.0058, 0.03, 0.1  # late for each m; by plugs; tags, up to
WANDERS_S = 2.1 * 3600  # of crystals, to and fro
OFF_PPM, WANDER_PPM = 0.014, 0.016  # crystals off; these wander
CUT_C, SPAN_C, CUT_M, BENT = 21.0, 17.0, 0.1, 0.35  # of crystals' cubic; of which one is even
BEHIND_M, BEHIND_DB, NARROW = 0.115, 6.0, 1.6  # late, weak behind a strap; how narrow that is
BIAS_M, EVEN_DBM, OVER_DB = 0.05, -84.5, 9.0  # at most; of none; until it is that
TICKS_M = 0.098  # of either of two stamps
EACH_M_DB, WET_DB, MOST_DB = 0.31, 1.2, 10.0  # lost each m; how links scatter; at most
GROWS = 0.0092  # parts that clocks of tags count more
STEPS_M = (0.13, 0.18)  # of tags of even and odd numbers
SOONEST_M, LONGEST_M = 0.6, 3.9  # of ways by pots, longer than straight ones
WET_FLOOR, LOSSY = 6.2, 0.6  # permittivity of wet floors
POT_M = (0.45, 0.95)  # of what ways creep round, in m
STEP_DB, EVERY_DB, FROM_DBM = 1.4, 4.0, -89.0  # off for each such; from where on
ENOUGH_DBM = -82.0  # above which fewer symbols do
BOILER_M: Floats = np.array([29.0, 12.0, 1.5])
FULL_KW, BURNS_DB, NEAR_M = 24.0, 7.0, 11.0


def _forgets(run: Run, strength: float) -> Duty:
    """Compare with places that are forgotten evenly, of some time that has just gone (Laguerre)."""
    ages, weights = np.polynomial.laguerre.laggauss(3)
    gone = [run.draws_away(FORGETS_S * strength * age) for age in ages.tolist()]
    return Duty(weights @ np.stack(gone))


def _meanwhile(run: Run, strength: float) -> Duty:
    """Go ways of the first and the last message of an exchange, in the mean."""
    reply_s = strength * run["reply_time_s"]
    return Duty(0.5 * sum(run.draws_away(by * reply_s) for by in LATER))


def _cables(run: Run, strength: float) -> Duty:
    """Be late by cables that go along and across to where these come together, and by tags."""
    drawn = run.shared(1)
    long_m = np.abs(run.lintel_m - COUNTED_M).sum(axis=1)
    plugs = PLUG_M * drawn.binomial(3, 0.4, LINTELS)
    tags = TAGS_M * drawn.random(len(TAGS))
    return Duty(strength * (CABLE * long_m + plugs[run.lintel] + tags[run.tag]))


def _wander(run: Run, strength: float) -> Duty:
    """Leave some of crystals' offset, which wanders to and fro, all at phases of their own."""
    drawn = run.shared(2)
    every = LINTELS + len(TAGS)
    off = drawn.laplace(0.0, OFF_PPM / np.sqrt(2), every).clip(-0.05, 0.05)
    phase = drawn.uniform(-np.pi, np.pi, every)

    def ppm(one: NDArray[np.int64]) -> Floats:
        turn = 2 * np.pi * run["time_s"] / WANDERS_S + phase[one]
        return np.asarray(off[one] + WANDER_PPM * np.sin(turn))

    apart = ppm(run.lintel) - ppm(LINTELS + run.tag)
    return Duty(0.5 * LIGHT_M_US * strength * apart * run["reply_time_s"])


def of_a_cut(warm: Floats) -> Floats:
    """Return how crystals of a cut drift by warmth in deg C, 1 at SPAN_C over CUT_C [n]."""
    by = (warm - CUT_C) / SPAN_C
    return np.asarray(BENT * by + (1 - BENT) * by**3)


def _cut(run: Run, strength: float) -> Duty:
    """Drift as crystals do: the faster the farther off (Bechmann 1956)."""
    return Duty(CUT_M * strength * of_a_cut(run["temperature_c"]))


def strapped(bearing: Floats) -> Floats:
    """Return how far bearings in radians are in a strap's shadow [...]: 1 right behind it."""
    return np.exp(NARROW * (-np.cos(bearing) - 1))


def _strap(run: Run, strength: float) -> Duty:
    """Be late and weak behind the strap that a tag hangs by (von Mises 1918)."""
    shade = strength * strapped(np.radians(run["azimuth_deg"]))
    return Duty(BEHIND_M * shade, -BEHIND_DB * shade)


def _bias(run: Run, strength: float) -> Duty:
    """Be early where it is loud, late where it is weak, by half a wave between."""
    over = ((EVEN_DBM - run["rx_power_dbm"]) / OVER_DB).clip(-1.0, 1.0)
    return Duty(BIAS_M * strength * np.sin(0.5 * np.pi * over))


def _stamps(run: Run, strength: float) -> Duty:
    """Tell when both stamps were by whole ticks, so that these differ by chance (Simpson)."""
    one, other = run.rng.random((2, run.rows))
    return Duty(TICKS_M * strength * (one - other))


def _wet_air(run: Run, strength: float) -> Duty:
    """Lose so much each metre, links more or less so."""
    own = run.by_link(lambda n: np.exp(0.25 * run.rng.standard_normal(n).clip(-2, 2)))
    more = run.by_link(lambda n: WET_DB * run.rng.random(n))
    lost = (EACH_M_DB * own * run.far + more - 0.5 * WET_DB).clip(0.0, MOST_DB)
    return Duty(level_db=-strength * lost)


def _counts(run: Run, strength: float) -> Duty:
    """Count parts too many, by the clock of the tag."""
    own = 1 + 0.2 * run.shared(3).standard_normal(len(TAGS)).clip(-2.0, 2.0)
    return Duty(GROWS * strength * own[run.tag] * run.far)


def _steps(run: Run, strength: float) -> Duty:
    """Tell ranges in whole steps, of which tags have either."""
    step = strength * np.array(STEPS_M)[run.tag % 2]
    told = run["range_m"]
    return Duty(step * np.floor(told / step + 0.5) - told)


def slab(slow: float, thick_m: Floats, sine: Floats) -> Floats:
    """Return how much longer ways are through slabs of a permittivity, met so aslant, in m [n]."""
    return np.asarray(thick_m * (np.sqrt(slow - sine**2) - np.sqrt(1 - sine**2)))


def _through(run: Run, strength: float) -> Duty:
    """Go through casks' staves, bins, sashes and walls, as slabs are gone through."""
    rng, by_link = run.rng, run.by_link
    sine = by_link(lambda n: 0.85 * np.sqrt(rng.random(n)))
    through = {
        "wood": (2.4, 0.03, by_link(lambda n: 2.0 * rng.geometric(0.5, n).clip(max=4)), 18.0),
        "plywood": (2.71, 0.022, by_link(lambda n: 1.0 + rng.integers(1, 7, n)), 20.0),
        "glass": (6.31, 0.008, by_link(lambda n: rng.integers(2, 6, n)), 30.0),
        "brick": (3.91, 0.22, by_link(lambda n: rng.integers(1, 3, n)), 12.0),
    }
    late, lost = np.zeros(run.rows), np.zeros(run.rows)
    for what, (slow, thick_m, count, each_db) in through.items():
        there = run.through(what) * count
        late += there * slab(slow, np.full(run.rows, thick_m), sine)
        lost += there * (0.25 + each_db * thick_m)
    return Duty(strength * late.clip(max=0.6), first_db=-min(strength, 1.5) * lost.clip(max=9.0))


def by_pots(run: Run) -> Floats:
    """Return how much longer ways by some pot's shoulder are, in m [n]."""
    pot = POTS_M[run.by_link(lambda n: run.rng.integers(0, len(POTS_M), n)).astype(np.int64)]
    way = np.linalg.norm(run.tag_m - pot, axis=1) + np.linalg.norm(run.lintel_m - pot, axis=1)
    return np.asarray((way - run.far).clip(SOONEST_M, LONGEST_M))


def _by_pots(run: Run, strength: float) -> Duty:
    """Hear, out of sight, nothing but what shoulders of pots return."""
    shut = run.shut_off(SHUT_OFF[run.rare])
    return Duty(shut * by_pots(run) * strength**0.45, -1.2 * shut, -5.5 * shut)


def level_waves(sine: Floats, slow: Complexes | complex) -> Complexes:
    """Return what a floor of such a permittivity returns of level waves so steep [n] (Fresnel)."""
    root = np.sqrt(slow - 1 + sine**2 + 0j)
    return np.asarray((sine - root) / (sine + root))


def off_the_floor(run: Run, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each."""
    both = run.tag_m[:, 2], run.lintel_m[:, 2]
    way = np.sqrt(run.far**2 + 4 * both[0] * both[1])
    clear = run.by_link(lambda n: 0.35 + 0.5 * run.rng.beta(2.0, 2.0, n))
    gives = level_waves((both[0] + both[1]) / way, WET_FLOOR - 1j * LOSSY)
    share = 0.95 * strength**0.5 * clear * run.far / way * gives
    size = np.abs(share)
    share = share * np.minimum(1.0, 0.78 / size.clip(1e-9))
    return way - run.far, share * np.exp(-2j * np.pi * (way - run.far) / WAVE_M)


def told_of_two(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As safes have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(len(longer_m), 90.3)
    both = drops(top) + share[:, None] * drops(top + longer_m / METRES)
    at = tellings(both)
    return METRES * (at - top + AHEAD), matched(both, at, np.full(len(top), 1e-7))


def _floor(run: Run, strength: float) -> Duty:
    """Be where a safe has both pulses: that of the floor comes later."""
    late, high = told_of_two(*off_the_floor(run, strength))
    return Duty(late.clip(-0.24, 0.24), first_db=20 * np.log10(high.clip(0.4, 2.2)))


def creeping(far: Floats, before: Floats, thick: Floats) -> tuple[Floats, Floats]:
    """Return how much longer ways round cylinders are in m, and what these take in dB, [n] each.

    Ways would go through the middle of what is `thick` in radius, so far `before` from one end:
    they go straight to it, along it by an angle, and straight on; 6 dB and what creeping takes
    (Keller 1956).
    """
    rest = far - before
    angle = np.arcsin((thick / before).clip(max=0.95)) + np.arcsin((thick / rest).clip(max=0.95))
    straight = np.sqrt((before**2 - thick**2).clip(0.0)) + np.sqrt((rest**2 - thick**2).clip(0.0))
    losing = 8.686 * 1.01 * (np.pi * thick / WAVE_M) ** (1 / 3)
    return straight + thick * angle - far, 6.0 + losing * angle


def _copper(run: Run, strength: float) -> Duty:
    """Creep round the copper of a still's neck."""
    rng, copper = run.rng, run.through("metal")
    thick = np.sqrt(strength) * run.by_link(lambda n: rng.uniform(*POT_M, n))
    before = run.far * run.by_link(lambda n: 0.25 + 0.5 * rng.random(n))
    longer, lost = creeping(run.far, before, np.minimum(thick, 0.6 * before))
    return Duty(copper * longer.clip(0.0, 0.46), first_db=-copper * lost.clip(1.0, 11.5))


def _notches(run: Run, strength: float) -> Duty:
    """Turn gain down by notches, and stop summing sooner where it is loud."""
    over = (run["rx_power_dbm"] - FROM_DBM).clip(0.0)
    less = min(strength, 2.2) * STEP_DB * np.floor(over / EVERY_DB).clip(max=6)
    sooner = 0.55 * min(strength, 2.0) * (run["rx_power_dbm"] - ENOUGH_DBM).clip(0.0, 12.0)
    return Duty(level_db=-less, summed_db=-sooner)


def _boiler(run: Run, strength: float) -> Duty:
    """Hear a boiler's blower, lintels near it the more; all are a little noisier anyway."""
    own = run.shared(4).uniform(0.1, 0.9, LINTELS)[run.lintel]
    away = np.linalg.norm(run.lintel_m - BOILER_M, axis=1)
    burns = BURNS_DB * np.sqrt(run["boiler_kw"] / FULL_KW) / (1 + (away / NEAR_M) ** 2)
    db = strength * (own + burns)
    weak = 10 ** ((-88.0 - run["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    late = 0.013 * run.rng.standard_normal(run.rows).clip(-3.5, 3.5) * weak.clip(max=6.0)
    return Duty(late, noise_db=db)


EFFECTS: dict[str, Callable[[Run, float], Duty]] = {
    "antenna-delay": _cables,
    "antenna-pattern": _strap,
    "blocked-path": _by_pots,
    "clock-offset": _wander,
    "diffraction": _copper,
    "exchange-motion": _meanwhile,
    "ground-bounce": _floor,
    "level-control": _notches,
    "material-delay": _through,
    "noise-floor": _boiler,
    "path-loss": _wet_air,
    "power-bias": _bias,
    "range-rounding": _steps,
    "range-scale": _counts,
    "temperature-drift": _cut,
    "time-lag": _forgets,
    "timestamp-jitter": _stamps,
    **UNHEARD_OF,
}
