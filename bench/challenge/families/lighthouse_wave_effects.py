"""What the lighthouse hides in waveforms: effects in forms of its own, and its oddities.

numpy alone; oddities are in `lighthouse_oddities`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.lighthouse_effects import EFFECTS, by_walls, off_the_rock
from bench.challenge.families.lighthouse_lens import (
    PLACES,
    WIDE_SAMPLES,
    Lens,
    breaking,
    brightness,
    ebbed,
)
from bench.challenge.families.lighthouse_oddities import ODDITIES
from bench.challenge.families.lighthouse_station import CRESSETS
from bench.challenge.families.lighthouse_station import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "fathoms-from-one-cresset"}
LAWS |= {name: Law() for name in ODDITIES}
RETURNS, NEXT = 2.6, 6.4  # of walls' shares; samples from which these are heard
ROUND_M, AFTER_M, AFTERS = (0.5, 1.5), 0.5, 7  # ways round; between those that follow; of these
ROUND_HIGH, ROUND_KEEPS = 0.43, 0.82  # of the first way round; part each next keeps
KEEPS, MEAN = 0.72, 0.85  # of fades from sample to sample; of what does not fade, next to a part
TAIL, BEGINS, SOON, LONG = 0.021, 4.0, 13.0, 70.0  # power; samples until; to 1 / e of both parts
PANES, PANE_AT, PANE_EACH, TURNS, DIES = 9, 4.8, 1.6, (1.0, -2.1), 0.76
"""Echoes in panes; samples to the first and between; radians each of two modes; part each keeps."""
PITCH, SLIDES, HUM, DEPTH = (0.3, 1.9), 0.004, (0.08, 0.2), 0.6  # of tones, radians a sample
SOME: Complexes = breaking(np.random.default_rng(9307), 150)  # noise to try readings on


def _walls(lens: Lens, strength: float) -> None:
    """Hear walls and corners of the rock's precinct, more or less overgrown, links alike."""
    entries = lens.entries()
    first = lens.arrived() * lens.straight()
    for longer, share in zip(*by_walls(entries), strict=True):
        bare = entries.per_link(lambda n: np.sqrt(lens.rng.random(n)))
        size = np.where(longer > NEXT * lens.metres, RETURNS * np.sqrt(strength) * bare * share, 0)
        lens.once_more(first, size.clip(max=0.85) * lens.turned(), longer / lens.metres)


def _ground(lens: Lens, strength: float) -> None:
    longer, share = off_the_rock(lens.entries(), strength)
    lens.once_more(lens.arrived(), share, longer / lens.metres)


def _rounds(lens: Lens, strength: float) -> None:
    """Lose what comes straight behind things; one way round comes whole, others after it.

    Each keeps a part of the one before.
    """
    entries, rng, arrived = lens.entries(), lens.rng, lens.arrived()
    shut = entries.cut_off(0.2)
    lens.darken(-34.0 * shut[:, None] * lens.straight())
    first_m = entries.per_link(lambda n: rng.triangular(ROUND_M[0], 0.8, ROUND_M[1], n))
    first_m = first_m * (0.55 + 0.45 * strength**0.8)
    for way in range(AFTERS + 1):
        since_m = AFTER_M * way * entries.per_link(lambda n: rng.uniform(0.7, 1.3, n))
        fades = 1.0 if way == 0 else np.sqrt(rng.gamma(2.0, 0.5, entries.rows))
        size = np.asarray(shut * ROUND_HIGH * ROUND_KEEPS**way * fades)
        lens.once_more(arrived, size.clip(max=0.8) * lens.turned(), (first_m + since_m)
                       / lens.metres)  # fmt: skip


def dimming(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of power 1 (Rice 1945).

    What fades follows itself from sample to sample (of the first order).
    """
    even = rng.standard_normal((rows, WIDE_SAMPLES, 2)) @ np.array([1.0, 1.0j])
    fades = np.empty(even.shape, np.complex128)
    fades[:, 0] = even[:, 0]
    for k in range(1, WIDE_SAMPLES):
        fades[:, k] = KEEPS * fades[:, k - 1] + np.sqrt(1 - KEEPS**2) * even[:, k]
    size = np.abs(MEAN + fades)
    return np.asarray(size / np.sqrt((size**2).mean()))


def _dims(lens: Lens, strength: float) -> None:
    """Fade smoothly; of what comes straight, all alike."""
    size = dimming(lens.rng, lens.rows) ** min(np.sqrt(strength), 1.6)
    top = np.rint(lens.at + 1.5).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    straight = lens.straight()
    first = np.take_along_axis(size, top[:, None], axis=1).clip(0.4, 2.3)
    size = straight * first + (1 - straight) * size
    lens.wave = lens.wave + (size / np.sqrt((size**2).mean()) - 1) * lens.arrived()


def dying(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: soon, then long (two rooms)."""
    part = since.clip(0.0)
    return np.asarray(np.where(since > 0, 0.65 * np.exp(-part / SOON)
                               + 0.35 * np.exp(-part / LONG), 0.0))  # fmt: skip


def _tail(lens: Lens, strength: float) -> None:
    """Hear all else of a tower and a cove that are coupled."""
    high = brightness(lens.wave, lens.at, lens.sigma)[:, None]
    power = TAIL * strength * dying(PLACES - lens.at[:, None] - BEGINS)
    lens.murmurs(high * np.sqrt(power) * lens.since(BEGINS))


def paned(waves: Complexes) -> Complexes:
    """Return what rings after waveforms in lanterns' panes: by two modes, ever less."""
    made = np.zeros(waves.shape, np.complex128)
    for k in range(PANES):
        share = DIES**k * (np.exp(1j * TURNS[0] * k) + np.exp(1j * TURNS[1] * k)) / 2
        made += share * ebbed(waves, np.full(len(waves), PANE_AT + k * PANE_EACH))
    return made


def _panes(lens: Lens, strength: float) -> None:
    turn = np.exp(1j * lens.common(5).uniform(-np.pi, np.pi))
    lens.wave = lens.wave + 0.3 * min(strength, 2.2) ** 0.8 * turn * paned(lens.arrived())


def _arc(lens: Lens, strength: float) -> None:
    lens.glare(np.zeros(lens.rows) + EFFECTS["noise-floor"](lens.entries(), strength).noise_db)


def of_noise(waves: Complexes) -> float:
    """Return how sizes scatter within fives, as lenses say of noise."""
    sizes = np.abs(waves)[:, : waves.shape[1] // 5 * 5]
    return float(np.sqrt(sizes.reshape(-1, 5).var(axis=1, ddof=1).mean()))


def _say(lens: Lens, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([of_noise(made(float(one))) for one in tried]) / of_noise(SOME)
    lens.noise_by = lens.noise_by * np.interp(of, tried, by).clip(0.05)


def humming(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of power 1 that hum louder and lower, and slide [rows, WIDE_SAMPLES]."""
    pitch, hum = rng.uniform(*PITCH, (rows, 1)), rng.uniform(*HUM, (rows, 1))
    begins, other = rng.uniform(-np.pi, np.pi, (2, rows, 1))
    slides = rng.uniform(-SLIDES, SLIDES, (rows, 1))
    loud = 1 + DEPTH * np.cos(hum * PLACES + other)
    loud /= np.sqrt((loud**2).mean(axis=1, keepdims=True))
    return np.asarray(loud * np.exp(1j * (begins + pitch * PLACES + 0.5 * slides * PLACES**2)))


def _hums(lens: Lens, strength: float) -> None:
    """Hear the magneto that feeds the arc; cressets the more, the nearer by."""
    near = lens.common(6).uniform(0.6, 1.5, CRESSETS)[lens.entries().cresset]
    size = 1.15 * strength * near
    lens.wave = lens.wave + (size * lens.sigma)[:, None] * humming(lens.rng, lens.rows)
    tones = humming(np.random.default_rng(9308), len(SOME))
    _say(lens, size, np.linspace(0.0, 8.0, 33), lambda one: SOME + one * tones)
    lens.sigma = lens.sigma * np.sqrt(1 + 0.5 * size**2)


def in_ticks(waves: Complexes, tick: float) -> Complexes:
    """Return waveforms whose both parts are told by whole ticks [n, k]."""
    return np.asarray(tick * (np.rint(waves.real / tick) + 1j * np.rint(waves.imag / tick)))


def _ticks(lens: Lens, strength: float) -> None:
    tick = 1.15 * strength * float(np.median(lens.sigma))
    lens.wave = in_ticks(lens.wave, tick)
    _say(lens, tick / lens.sigma, np.geomspace(0.03, 12.0, 50), lambda one: in_ticks(SOME, one))


def _dim(lens: Lens, strength: float) -> None:
    """Ask a larger part of the most of what is heard, as lenses do that are salted over."""
    lens.dim = strength


WAVES: dict[str, Callable[[Lens, float], None]] = {
    "obstructed-path": _rounds, "specular-reflections": _walls, "ground-bounce": _ground,
    "small-scale-fading": _dims, "diffuse-tail": _tail, "pulse-ringing": _panes,
    "noise-floor": _arc, "narrowband-interference": _hums,
    **ODDITIES,
    "quantisation": _ticks, "late-detection": _dim,
}  # fmt: skip
"""In turn; rows pay what they owe once waves were ON_THE_WAY, before lenses hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the lighthouse's tables of ranges."""


def hide(lens: Lens, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what rows owe, and what lenses do."""
    for name in ON_THE_WAY:
        if name in names:
            WAVES[name](lens, strength)
    for name in sorted({*names} - {*WAVES}):
        lens.collect(EFFECTS[name](lens.entries(), strength))
    for name in (one for one in WAVES if one in names and one not in ON_THE_WAY):
        WAVES[name](lens, strength)
