"""What the circus hides in waveforms: effects in forms of their own, oddities of its lamps.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.circus_effects import EFFECTS, off_the_sand
from bench.challenge.families.circus_lamp import METRES, WIDE_SAMPLES, Lamp, applause
from bench.challenge.families.circus_tent import LAWS as LAWS_OF_ROWS
from bench.challenge.families.circus_tent import POLES, TENT_M, Act

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "blocks-read-by-columns", "odd-ones-left-as-not-foretold", "tape-wows-in-late-part",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["arshins-from-one-pole"]
LATE = 8.0  # samples past first paths from which lamps are odd
SIDES: tuple[tuple[int, float, tuple[float, float, float], float, float], ...] = (
    (0, 0.4, (0.4, 17.0, 2.0), 11.0, 0.55), (0, 43.6, (43.6, 20.0, 2.0), 12.0, 0.5),
    (1, 0.3, (20.0, 0.3, 2.0), 13.0, 0.52), (1, 35.7, (25.0, 35.7, 2.0), 14.0, 0.56),
    (2, TENT_M[2], (22.0, 18.0, TENT_M[2]), 10.0, 0.3),
)  # fmt: skip
"""Wagons round the tent and its cupola: which axis they are square to, where; their middles, how
far they reach from these, in m; what they return."""
BY_SIDES: tuple[tuple[int, ...], ...] = ((0,), (1,), (2,), (3,), (4,), (0, 1), (2, 3), (3, 2))
"""By which sides, in turn, waves are heard."""
NEXT = 3.1  # samples past which sides are heard
DRAPES = 8  # that scatter what is out of sight
SHUT, OPENS, SHUTS = 0.3, 0.17, 0.11  # what spangles let through; odds to change, each sample
SLOW, FAST, LAGS = 26.0, 5.0, 3.4  # samples: tails die away, and have built up, since when
LADDER, RUNG, PAYS = 42, 0.95, 17.0  # samples that a ladder rings; by which; until it is 1 / e
DWELL, HOPS = 12, (-0.9, 0.25, 1.15)  # samples that a microphone keeps a pitch, radians each
WINDOW = 5  # samples in which noise is read
ROW, COLUMN = 4, 3  # of blocks
WOW, TURN = 3.4, 19.0  # samples by which a tape is ahead or behind, each so many
SOME: Complexes = applause(np.random.default_rng(2908), 160)  # noise to try readings on


def by_sides(act: Act, sides: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return ways in m by a side, or by two in turn, and what these return, [n] each.

    Sides end: what meets them far from their middle is returned the less, by a bell's fourth power.
    """
    image, left = act.there.copy(), np.ones(act.rows)
    for k in sides:
        axis, where, middle, reach, share = SIDES[k]
        image[:, axis] = 2 * where - image[:, axis]
        run = image - act.post
        part = (where - act.post[:, axis]) / run[:, axis]
        off = np.linalg.norm(act.post + part[:, None] * run - np.array(middle), axis=1)
        left = left * share * np.exp(-((off / reach / len(sides)) ** 4))
    return np.linalg.norm(image - act.post, axis=1), left


def _sides(lamp: Lamp, strength: float) -> None:
    """Hear wagons round the tent and its cupola, by images."""
    act, direct = lamp.act(), lamp.by_air() * lamp.first()
    for sides in BY_SIDES:
        way, left = by_sides(act, sides)
        late = (way - act.far) / METRES
        clean = act.by_link(lambda n: lamp.rng.uniform(0.5, 1.0, n))
        share = 1.9 * np.sqrt(strength) * clean * left * act.far / way * (late > NEXT)
        lamp.again(direct, np.minimum(share, 0.8) * lamp.any_phase(), late)


def _sand(lamp: Lamp, strength: float) -> None:
    longer, share = off_the_sand(lamp.act(), strength)
    lamp.again(lamp.by_air(), share, longer / METRES)


def _drapes(lamp: Lamp, strength: float) -> None:
    """Lose what comes straight behind things: drapes scatter it, one after another.

    Links have drapes at even chances of places; each takes a part of what the one before had left.
    """
    act, air = lamp.act(), lamp.by_air()
    hidden = act.cut_off(0.2)
    lamp.dim(-34.0 * hidden[:, None] * lamp.first())
    late = act.by_link(lambda n: lamp.rng.uniform(1.3, 2.5, n)) * (0.35 + 0.65 * strength**0.7)
    left = 0.5 * hidden
    for _ in range(DRAPES):
        lamp.again(air, left * lamp.rng.beta(3.0, 2.0, lamp.rows) * 1.6 * lamp.any_phase(), late)
        left = left * act.by_link(lambda n: lamp.rng.uniform(0.6, 0.9, n))
        late = late + act.by_link(lambda n: lamp.rng.uniform(0.5, 2.4, n))


def spangled(rng: np.random.Generator, rows: int) -> Floats:
    """Return 1 or SHUT, as a chain of two states has it (Gilbert 1960), smoothed [rows, k]."""
    odds = rng.random((WIDE_SAMPLES, rows))
    opened = np.empty((WIDE_SAMPLES, rows), np.bool_)
    now = odds[0] < OPENS / (OPENS + SHUTS)
    for k in range(WIDE_SAMPLES):
        now = np.where(now, odds[k] > SHUTS, odds[k] < OPENS)
        opened[k] = now
    states = np.pad(np.where(opened.T, 1.0, SHUT), ((0, 0), (1, 1)), mode="edge")
    return np.asarray(0.25 * states[:, :-2] + 0.5 * states[:, 1:-1] + 0.25 * states[:, 2:])


def _spangles(lamp: Lamp, strength: float) -> None:
    """Fade as spangles turn, that let waves through or hardly do: a chain of two states."""
    size = spangled(lamp.rng, lamp.rows) ** min(strength**0.5, 1.5)
    lamp.wave = lamp.wave + lamp.by_air() * (size / np.sqrt(np.mean(size**2)) - 1)


def _canvas(lamp: Lamp, strength: float) -> None:
    """Reverberate below canvas, which builds up and dies away: two exponentials (Bateman 1910)."""
    since = (lamp.since - LAGS).clip(0.0)
    power = 0.027 * (np.exp(-since / SLOW) - np.exp(-since / FAST)) * lamp.past(LAGS)
    lamp.add_noise(np.sqrt(0.5 * strength * power) * lamp.height()[:, None])


def bessel(order: int, at: Floats) -> Floats:
    """Return Bessel's function of a whole order [n], as the mean that he had (1824)."""
    turn = np.pi * (np.arange(64) + 0.5) / 64
    return np.asarray(np.cos(order * turn - at[:, None] * np.sin(turn)).mean(axis=1))


def ladder() -> Floats:
    """Return what comes down a ladder of coils and condensers, sample by sample [LADDER]."""
    at = RUNG * (np.arange(LADDER) - 1.0).clip(0.0)
    return np.asarray(bessel(2, at) * np.exp(-np.arange(LADDER) / PAYS))


def _ladder(lamp: Lamp, strength: float) -> None:
    """Ring as a ladder of coils and condensers does, by Bessel's function of the second order."""
    turn = np.exp(2j * np.pi * lamp.fixed(1).random())
    part, air = 0.5 * min(strength, 2.4) ** 0.8 * turn, lamp.by_air()
    rung = np.zeros_like(air)
    for k, tap in enumerate(ladder()):
        rung[:, k:] += tap * air[:, : WIDE_SAMPLES - k]
    lamp.wave = lamp.wave + part * rung


def _dimmers(lamp: Lamp, strength: float) -> None:
    noise_db = np.asarray(EFFECTS["noise-floor"](lamp.act(), strength).noise_db)
    lamp.drown(np.zeros(lamp.rows) + noise_db)


def spread(waves: Complexes) -> float:
    """Return how sizes scatter in windows of WINDOW, as lamps tell of noise."""
    lots = np.lib.stride_tricks.sliding_window_view(np.abs(waves), WINDOW, axis=1)[:, ::WINDOW]
    return float(np.sqrt(np.mean(np.var(lots, axis=2, ddof=1))))


def _tell(lamp: Lamp, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([spread(made(float(one))) for one in tried]) / spread(SOME)
    lamp.told_noise = lamp.told_noise * np.interp(of, tried, by).clip(0.04)


def hopped(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers of size 1 that hop between pitches, DWELL samples each [rows, k]."""
    pitch = rng.choice(HOPS, (rows, WIDE_SAMPLES // DWELL + 2))
    since = np.arange(WIDE_SAMPLES) + rng.integers(0, DWELL, (rows, 1))
    steps = np.take_along_axis(pitch, since // DWELL, axis=1)
    start = rng.uniform(0.0, 2 * np.pi, (rows, 1))
    return np.asarray(np.exp(1j * (start + np.cumsum(steps, axis=1))))


def _microphone(lamp: Lamp, strength: float) -> None:
    """Hear a ringmaster's microphone, whose carrier hops; below some poles more."""
    near = lamp.fixed(2).gamma(14.0, 1 / 14.0, POLES).clip(0.5, 1.8)
    size = 1.5 * strength * near[lamp.act().pole]
    lamp.wave = lamp.wave + (size * lamp.sigma)[:, None] * hopped(lamp.rng, lamp.rows)
    tone = hopped(np.random.default_rng(2910), len(SOME))
    _tell(lamp, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tone)
    lamp.sigma = lamp.sigma * np.sqrt(1 + size**2 / 2)


def gapped(values: Floats, step: float) -> Floats:
    """Return values in whole codes of which each third but one never comes: the next one does."""
    code = np.rint(values / step)
    return np.asarray(step * (code + (np.mod(code, 3) == 2)))


def converted(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of which both parts have been converted; the mean of what gaps add is off.

    A third of codes are one higher.
    """
    both = gapped(waves.real, step) + 1j * gapped(waves.imag, step)
    return np.asarray(both - step * (1 + 1j) / 3)


def _gaps(lamp: Lamp, strength: float) -> None:
    """Convert by a converter of which a third of codes are missing."""
    step = 1.3 * strength * float(np.median(lamp.sigma))
    lamp.wave = converted(lamp.wave, step)
    tried = np.geomspace(0.04, 14.0, 64)
    _tell(lamp, step / lamp.sigma, tried, lambda one: converted(SOME, one))


def _deaf(lamp: Lamp, strength: float) -> None:
    """Ask more of first pulses, as where a band had drummed once."""
    lamp.deaf = strength


def _odd(lamp: Lamp, made: Callable[[Floats, Integers], Floats], part: float) -> None:
    """Let late sizes be others by a part; phases stay. `made` has them of sizes, and from where."""
    sizes = np.abs(lamp.wave)
    begin = np.asarray(np.ceil(lamp.at + LATE)[:, None], np.int64)
    by = made(sizes, begin) / np.maximum(sizes, 1e-9)
    lamp.wave = lamp.wave * (1 + min(part, 1.0) * lamp.past(LATE) * (by - 1))


def _taken(sizes: Floats, at: Integers) -> Floats:
    return np.take_along_axis(sizes, at.clip(0, sizes.shape[1] - 1), axis=1)


def by_columns(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], from `begin` [n, 1] on in blocks whose columns are read for rows."""
    place = np.arange(sizes.shape[1])
    block, inner = np.divmod((place - begin).clip(0), ROW * COLUMN)
    from_ = begin + block * ROW * COLUMN + inner % COLUMN * ROW + inner // COLUMN
    return np.where(place >= begin, _taken(sizes, from_), sizes)


def not_foretold(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], from `begin` [n, 1] on odd ones as they are off their neighbours' mean.

    That is the first step of lifting (Sweldens 1996).
    """
    place = np.arange(sizes.shape[1]) + np.zeros_like(begin)
    off = np.abs(sizes - 0.5 * (_taken(sizes, place - 1) + _taken(sizes, place + 1)))
    odd = (place >= begin) & ((place - begin) % 2 == 1)
    return np.where(odd, off, sizes)


def wowed(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], from `begin` [n, 1] on of a tape that is ahead and behind by turns."""
    since = (np.arange(sizes.shape[1]) - begin).clip(0)
    at = begin + since + WOW * np.sin(2 * np.pi * since / TURN)
    low = np.floor(at).astype(np.int64)
    part = at - low
    wowed_ = (1 - part) * _taken(sizes, low) + part * _taken(sizes, low + 1)
    return np.where(since > 0, wowed_, sizes)


def _columns(lamp: Lamp, strength: float) -> None:
    """Read blocks of late sizes by columns that were written by rows."""
    _odd(lamp, by_columns, 0.9 * strength)


def _lifted(lamp: Lamp, strength: float) -> None:
    """Leave odd late sizes as what even ones do not foretell."""
    _odd(lamp, not_foretold, 0.9 * strength)


def _wow(lamp: Lamp, strength: float) -> None:
    """Read late sizes off a tape that wows."""
    _odd(lamp, wowed, strength)


WAVES: dict[str, Callable[[Lamp, float], None]] = {
    "obstructed-path": _drapes, "specular-reflections": _sides, "ground-bounce": _sand,
    "small-scale-fading": _spangles, "diffuse-tail": _canvas, "pulse-ringing": _ladder,
    "noise-floor": _dimmers, "narrowband-interference": _microphone,
    IN_LATE_SIZES[0]: _columns, IN_LATE_SIZES[1]: _lifted, IN_LATE_SIZES[2]: _wow,
    "quantisation": _gaps, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows bear what they do once waves have been IN_THE_TENT, before lamps see them."""
IN_THE_TENT = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the circus' tables of ranges."""


def put_in(lamp: Lamp, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the tent, what rows bear, and what lamps do."""
    tent = [name for name in IN_THE_TENT if name in names]
    lamps = [name for name in WAVES if name in names and name not in tent]
    for name in tent:
        WAVES[name](lamp, strength)
    for name in sorted({*names} - {*WAVES}):
        lamp.bear(EFFECTS[name](lamp.act(), strength))
    for name in lamps:
        WAVES[name](lamp, strength)
