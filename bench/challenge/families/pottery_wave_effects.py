"""What the pottery hides in waveforms: effects in forms of its own, and its oddities.

numpy alone; oddities are in `pottery_oddities`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.pottery_cone import (
    PLACES,
    WIDE_SAMPLES,
    Cone,
    blunging,
    cast_later,
    weight,
)
from bench.challenge.families.pottery_day import RACKS_X
from bench.challenge.families.pottery_effects import EFFECTS, off_the_tiles
from bench.challenge.families.pottery_floor import LAWS as LAWS_OF_ROWS
from bench.challenge.families.pottery_floor import PURLINS, WORKS_M, Firing, lengths
from bench.challenge.families.pottery_oddities import ODDITIES

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "ells-from-one-purlin"}
LAWS |= {name: Law() for name in ODDITIES}
FACES, BRICK, IRON = 1.5, 3.8, 0.8  # of shares of faces; slowness squared; what trays return
NEXT = 6.2  # samples from which faces are heard
ROUND_M, ROUND_HIGH, ROUNDS, ROUND_KEEPS, APART_M = (0.5, 1.4), 0.4, 7, 0.82, (0.3, 0.8)
"""Of ways round: m to the first; how high it is; how many; part each next keeps; m between."""
SHADE, SMOOTHED = 1.5, 4  # of a K law; samples over which shades are alike
TAIL, BEGINS, ONSET, LASTS, STRETCH = 0.014, 4.5, 3.0, 17.0, 0.62
"""Of a tail: power; samples until, of its onset, to 1 / e; Kohlrausch's exponent."""
RING, RING_AT, RING_EACH = 12, 4.6, 1.3  # of a lid: echoes; samples to the first and between
MODES, RING_RAD, RING_DIES = (1.0, 1.594, 2.136), 0.95, 3.6  # of a drum's head; radians; echoes
SWEEP, PITCH = (0.004, 0.011), (0.3, 1.4)  # radians a sample squared; a sample
UNEQUAL = 1.25  # steps of one part next to those of the other
SOME: Complexes = blunging(np.random.default_rng(9607), 150)  # noise to try readings on


def brick_returns(cosine: Floats) -> Floats:
    """Return what brick returns, in the mean of both ways that waves may lie [...] (Fresnel)."""
    under = np.sqrt(BRICK - 1 + cosine**2)
    level = np.abs((cosine - under) / (cosine + under))
    upright = np.abs((BRICK * cosine - under) / (BRICK * cosine + under))
    return np.asarray(np.sqrt(0.5 * (level**2 + upright**2)))


def by_faces(firing: Firing) -> tuple[Floats, Floats]:
    """Return how much longer ways by faces are, in m, and what comes by these [6, n].

    Four walls of brick, and racks of trays on the aisles that are farthest from one another, where
    both ends are on one side of these.
    """
    sides = [(0, 0.0, False), (0, WORKS_M[0], False), (1, 0.0, False), (1, WORKS_M[1], False),
             (0, RACKS_X[0], True), (0, RACKS_X[-1], True)]  # fmt: skip
    longer, share = [], []
    for axis, at, racks in sides:
        image = firing.purlin_m.copy()
        image[:, axis] = 2 * at - image[:, axis]
        way = image - firing.tag_m
        long_m = lengths(way)
        one_side = (firing.purlin_m[:, axis] - at) * (firing.tag_m[:, axis] - at) > 0
        back = IRON * one_side if racks else brick_returns(np.abs(way[:, axis]) / long_m)
        longer.append(long_m - firing.far)
        share.append(back * firing.far / long_m)
    return np.stack(longer), np.stack(share)


def _faces(cone: Cone, strength: float) -> None:
    """Hear walls of brick and racks of iron, links alike, more or less hidden by ware."""
    firing, came = cone.firing(), cone.arrived() * cone.straight()
    for longer, share in zip(*by_faces(firing), strict=True):
        bare = firing.each_link(lambda n: cone.rng.triangular(0.2, 0.9, 1.0, n))
        heard = longer > NEXT * cone.metres
        size = (FACES * np.sqrt(strength) * bare * share * heard).clip(max=0.85)
        cone.repeat(came, size * cone.turns(), longer / cone.metres)


def _tiles(cone: Cone, strength: float) -> None:
    longer, share = off_the_tiles(cone.firing(), strength)
    cone.repeat(cone.arrived(), share, longer / cone.metres)


def _round(cone: Cone, strength: float) -> None:
    """Lose what comes straight behind things; ways round come one by one, ever lower."""
    firing, rng, came = cone.firing(), cone.rng, cone.arrived()
    shut = firing.shut_off(0.2)
    cone.dull(-34.0 * shut[:, None] * cone.straight())
    late_m = firing.each_link(lambda n: rng.uniform(*ROUND_M, n)) * (0.45 + 0.55 * strength**0.8)
    for way in range(ROUNDS):
        fades = np.sqrt(rng.gamma(2.0, 0.5, cone.rows)) if way else np.ones(cone.rows)
        size = (shut * ROUND_HIGH * ROUND_KEEPS**way * fades).clip(max=0.8)
        cone.repeat(came, size * cone.turns(), late_m / cone.metres)
        late_m = late_m + firing.each_link(lambda n: rng.uniform(*APART_M, n))


def shading(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of power 1: a K law's (Jakeman, Pusey 1976).

    Rayleigh's sizes, smoothed, of powers that are themselves of a gamma law, alike for longer.
    """
    taps = np.hanning(2 * SMOOTHED + 3)[1:-1]
    even = rng.standard_normal((2, rows, WIDE_SAMPLES + len(taps) - 1))
    speckle = sum(tap * even[:, :, k : k + WIDE_SAMPLES] for k, tap in enumerate(taps))
    knots = np.arange(0, WIDE_SAMPLES + 24, 12)
    texture = rng.gamma(SHADE, 1 / SHADE, (rows, len(knots)))
    smooth = np.stack([np.interp(PLACES, knots, one) for one in texture])
    size = np.sqrt(smooth * (np.asarray(speckle) ** 2).sum(axis=0))
    return np.asarray(size / np.sqrt((size**2).mean()))


def _shades(cone: Cone, strength: float) -> None:
    """Fade as amid racks on the move; of what comes straight, all alike."""
    size = shading(cone.rng, cone.rows) ** min(0.8 * np.sqrt(strength), 1.4)
    top = np.rint(cone.at + 1.85).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    one = size[np.arange(cone.rows), top][:, None].clip(0.4, 2.2)
    size = size + cone.straight() * (one - size)
    cone.wave = cone.wave + (size / np.sqrt((size**2).mean()) - 1) * cone.arrived()


def stretched(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: soon there, long in going."""
    gone = np.maximum(since, 0.0)
    return np.asarray(np.exp(-((gone / LASTS) ** STRETCH)) * gone**2 / (gone**2 + ONSET**2))


def _tail(cone: Cone, strength: float) -> None:
    """Hear all else of a works in which some of what comes is held for long."""
    high = weight(cone.wave, cone.at, cone.sigma)[:, None]
    power = TAIL * strength * stretched(PLACES - cone.at[:, None] - BEGINS)
    cone.hiss(high * np.sqrt(power) * cone.past(BEGINS))


def drummed(waves: Complexes) -> Complexes:
    """Return what rings after waveforms in a saggar's lid: by modes of a drum's head (Rayleigh)."""
    made = np.zeros_like(waves)
    for k in range(RING):
        share = sum(np.exp(1j * RING_RAD * mode * k) / len(MODES) for mode in MODES)
        at = np.full(len(waves), RING_AT + RING_EACH * k)
        made += share * np.exp(-k / RING_DIES) * cast_later(waves, at)
    return made


def _lids(cone: Cone, strength: float) -> None:
    turn = np.exp(2j * np.pi * cone.common(5).random())
    cone.wave = cone.wave + 0.42 * min(strength, 2.2) ** 0.8 * turn * drummed(cone.arrived())


def _elements(cone: Cone, strength: float) -> None:
    cone.rumble(np.zeros(cone.rows) + EFFECTS["noise-floor"](cone.firing(), strength).noise_db)


def reading(waves: Complexes) -> float:
    """Return how sizes scatter, as cones say of noise."""
    return float(np.abs(waves).std(axis=1, ddof=1).mean())


def _reread(cone: Cone, at: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise what it reads as tried, at what is `at` a row [n], next to what it read."""
    by = np.array([reading(made(float(one))) for one in tried]) / reading(SOME)
    cone.noise_by = cone.noise_by * np.maximum(np.interp(at, tried, by), 0.05)


def sweeping(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of size 1 whose pitch rises or falls evenly [rows, WIDE_SAMPLES]."""
    pitch = rng.uniform(*PITCH, (rows, 1)) * rng.choice([-1.0, 1.0], (rows, 1))
    sweep = rng.uniform(*SWEEP, (rows, 1)) * rng.choice([-1.0, 1.0], (rows, 1))
    begun = rng.uniform(-np.pi, np.pi, (rows, 1))
    return np.asarray(np.exp(1j * (begun + pitch * PLACES + 0.5 * sweep * PLACES**2)))


def _sweeps(cone: Cone, strength: float) -> None:
    """Hear a level radar over a slip tank, whose pitch sweeps; by purlins more or less."""
    near = cone.common(6).uniform(0.6, 1.5, PURLINS)[cone.firing().purlin]
    size = 1.15 * strength * near
    cone.wave = cone.wave + (size * cone.sigma)[:, None] * sweeping(cone.rng, cone.rows)
    tones = sweeping(np.random.default_rng(9608), len(SOME))
    _reread(cone, size, np.linspace(0.0, 8.0, 33), lambda one: SOME + one * tones)
    cone.sigma = cone.sigma * np.sqrt(1 + 0.5 * size**2)


def in_steps(waves: Complexes, step: float) -> Complexes:
    """Return waveforms whose parts are told in whole steps, those of one part wider [n, k]."""
    other = UNEQUAL * step
    return np.asarray(step * np.rint(waves.real / step) + 1j * other * np.rint(waves.imag / other))


def _steps(cone: Cone, strength: float) -> None:
    step = 1.3 * strength * float(np.median(cone.sigma))
    cone.wave = in_steps(cone.wave, step)
    _reread(cone, step / cone.sigma, np.geomspace(0.03, 12.0, 50),
            lambda one: in_steps(SOME, one))  # fmt: skip


def _cold(cone: Cone, strength: float) -> None:
    """Ask a larger part of the most of what is heard, as cones do that are not yet warm."""
    cone.cold = strength


WAVES: dict[str, Callable[[Cone, float], None]] = {
    "obstructed-path": _round, "specular-reflections": _faces, "ground-bounce": _tiles,
    "small-scale-fading": _shades, "diffuse-tail": _tail, "pulse-ringing": _lids,
    "noise-floor": _elements, "narrowband-interference": _sweeps,
    **ODDITIES,
    "quantisation": _steps, "late-detection": _cold,
}  # fmt: skip
"""In turn; rows pay once waves were ON_THE_WAY, before cones hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail")  # fmt: skip
OF_RANGES = tuple(name for name in EFFECTS if name not in {
    *LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"})  # fmt: skip
"""Effects that are those of the pottery's tables of ranges."""


def hide(cone: Cone, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what rows pay, and what cones do."""
    for name in (one for one in ON_THE_WAY if one in names):
        WAVES[name](cone, strength)
    for name in sorted(set(names) - set(WAVES)):
        cone.pay(EFFECTS[name](cone.firing(), strength))
    for name in (one for one in WAVES if one in names and one not in ON_THE_WAY):
        WAVES[name](cone, strength)
