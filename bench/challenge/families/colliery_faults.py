"""Laws and faults of the set-up that the colliery hides, which no library has.

numpy alone; shared by the colliery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.colliery_pit import (
    FIREDAMP_PCT,
    HALL_M,
    IDLER_M,
    INCLINE_M,
    LACHTER_M,
    PROPS,
    PROPS_M,
    WOUND_S,
    Burden,
    Tally,
    along_m,
    on_incline,
    on_rails,
    up_m,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_NEPER_DB, BLUNT_M = -59.4, 8.2, 0.3  # of levels; added to ways
GIVES_M, GRAVITY, HEAD_M = 0.0072, 9.81, 6.0  # rope's stretch a metre; m/s2; rope past the incline
HUNTS_M, WAVE_M, LEANS = 0.105, 8.5, 0.35  # how far aside tubs hunt; each so far; and lean by it
RINGS_BPM, BROAD_BPM, SHAKES_M = 2150.0, 620.0, 0.15  # of booms: where they ring; how broadly
SINKS_M = 0.26  # by how much the roof has come down amid
TURNS_RAD = 0.00052  # that each station of a traverse turns too far
LEGS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11)  # props as the traverse goes


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]: a gallery guides waves a little."""
    return np.asarray(AT_A_METRE_DB - PER_NEPER_DB * np.log(far + BLUNT_M))


def _dust(tally: Tally, strength: float) -> Burden:
    """Come through stone dust on props: by a hyperbola that comes to an end (Monod 1949)."""
    return Burden(0.23 * strength * tally["dust_g"] / (tally["dust_g"] + 34.0))


def _drips(tally: Tally, strength: float) -> Burden:
    """Come through water that drips on covers: by a power."""
    return Burden(0.19 * strength * (tally["drip_ml"] / 60.0) ** 1.45)


def _conveyor(tally: Tally, strength: float) -> Burden:
    """Come past a conveyor's frame of steel, the later the closer: by one over how close."""
    return Burden(0.115 * strength / tally["belt_gap_m"])


def _soaks(tally: Tally, strength: float) -> Burden:
    """Come through covers that soak since they were hung, each day less: by a logarithm."""
    return Burden(0.043 * strength * np.log1p(tally["hung_d"] / 3.0))


def _chocks(tally: Tally, strength: float) -> Burden:
    """Come past chocks of timber, so much for each of these."""
    return Burden(0.0128 * strength * tally["chocks"])


def _idlers(tally: Tally, strength: float) -> Burden:
    """Read long and short as idlers of a belt pass."""
    return Burden(0.058 * strength * np.sin(2 * np.pi * tally["belt_m"] / IDLER_M - 0.5))


def _firedamp(tally: Tally, strength: float) -> Burden:
    """Read longer while drives are cut off, since there is firedamp, and lamps run on cells."""
    return Burden(np.where(tally["ch4_pct"] > FIREDAMP_PCT, 0.097 * strength, 0.0))


def _haze(tally: Tally, strength: float) -> Burden:
    """Come through haze that a draught clears: by how much there is, e times less by a draught."""
    left = np.exp(-tally["draught_ms"] / 2.4)
    return Burden(0.3 * strength * tally["haze_pct"] / 100.0 * left)


def _rope(tally: Tally, strength: float) -> Burden:
    """Have skips lower on a rope that stretches: by its length, and by what pulls at it."""
    course, own = tally.course, tally.are("skip")
    part = (course["begins"] + tally.gone_s) / WOUND_S
    gains = INCLINE_M * 2 * np.pi / WOUND_S**2 * np.sin(2 * np.pi * part) * (course["goes"] > 0)
    up = up_m(course, tally.gone_s)
    pulls = 1 + np.where(course["lane"] > 0, gains, -gains) / GRAVITY
    down = GIVES_M * strength * own * (INCLINE_M + HEAD_M - up) * pulls
    lane, tall = course["lane"], course["tall"]
    moved = on_incline(up - down, lane, tall) - on_incline(up, lane, tall)
    return Burden(np.where(own, tally.lengthens(moved), 0.0))


def _hunting(tally: Tally, strength: float) -> Burden:
    """Have tubs hunt from rail to rail, as wheels on cones do, and lean with it (Klingel 1883)."""
    along, own = along_m(tally.course, tally.gone_s), tally.are("tub")
    aside: Floats = np.asarray(HUNTS_M * strength * own * np.sin(2 * np.pi * along / WAVE_M))
    tall = tally.course["tall"]
    moved = on_rails(along, aside, tall) - on_rails(along, 0.0, tall)
    moved[:, 2] = -LEANS * np.abs(aside)
    return Burden(np.where(own, tally.lengthens(moved), 0.0))


def _shakes(tally: Tally, strength: float) -> Burden:
    """Have drilling shake clocks of booms' tags: the most where booms ring, by Lorentz's line."""
    off = (tally["drill_bpm"] - RINGS_BPM) / BROAD_BPM
    return Burden(SHAKES_M * strength * tally.are("boom") / (1 + off**2))


def _sinks(tally: Tally, strength: float) -> Burden:
    """Have the roof come down amid the hall, and props with it, the more the higher these are."""
    x, y, z = (PROPS_M / np.array(HALL_M)).T
    down_m = np.zeros((PROPS, 3))
    down_m[:, 2] = -SINKS_M * strength * np.sqrt(np.sin(np.pi * x) * np.sin(np.pi * y)) * z
    return Burden(tally.lengthens(0.0, down_m[tally.prop]))


def traverse_m(strength: float) -> Floats:
    """Return by how much props are off whose traverse turned too far at each [PROPS, 3], in m."""
    legs = np.diff(PROPS_M[[*LEGS], :2], axis=0)
    turned = TURNS_RAD * strength * np.arange(1, len(LEGS))[:, None]
    aside = turned * np.stack([-legs[:, 1], legs[:, 0]], axis=1)
    off_m = np.zeros((PROPS, 3))
    off_m[[*LEGS[1:]], :2] = np.cumsum(aside, axis=0)
    return off_m


def _traverse(tally: Tally, strength: float) -> Burden:
    """Have props where a traverse set them that turns a little too far at each station."""
    return Burden(tally.lengthens(0.0, traverse_m(strength)[tally.prop]))


def _off(tally: Tally, off_m: Floats) -> Burden:
    """Return what rows bear whose props are off in truth [PROPS, 3], in m."""
    more = tally.lengthens(0.0, off_m[tally.prop])
    return Burden(more, open_db(tally.far + more) - open_db(tally.far))


def _rammed(tally: Tally, strength: float) -> Burden:
    off_m = np.zeros((PROPS, 3))
    off_m[8] = 0.46 * strength * np.array([2.0, -6.0, 3.0]) / 7.0
    return _off(tally, off_m)


def _crosswise(tally: Tally, _: float) -> Burden:
    off_m = np.zeros((PROPS, 3))
    off_m[[1, 6]] = PROPS_M[[6, 1]] - PROPS_M[[1, 6]]
    return _off(tally, off_m)


def _lachters(tally: Tally, _: float) -> Burden:
    """Write, of one prop, lachters of Freiberg."""
    in_lachters = tally["range_m"] / LACHTER_M - tally["range_m"]
    return Burden(np.where(tally.prop == 4, in_lachters, 0.0))


UNLISTED: dict[str, Callable[[Tally, float], Burden]] = {
    "stone-dust-lies-on-props": _dust,
    "roof-drips-on-covers": _drips,
    "conveyor-runs-close-by": _conveyor,
    "covers-soak-since-they-were-hung": _soaks,
    "chocks-stand-beside": _chocks,
    "belt-idlers-pass": _idlers,
    "drives-cut-off-at-firedamp": _firedamp,
    "haze-that-draught-clears": _haze,
    "winding-rope-stretches": _rope,
    "tubs-hunt-on-their-rails": _hunting,
    "drilling-shakes-booms": _shakes,
    "roof-comes-down-amid": _sinks,
    "traverse-turns-at-each-station": _traverse,
    "prop-rammed-by-a-tub": _rammed,
    "props-wired-crosswise": _crosswise,
    "lachters-from-one-prop": _lachters,
}
