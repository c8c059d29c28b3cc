"""What the tram shed hides in waveforms: effects in forms of its own, and its oddities.

numpy alone; oddities are in `tramshed_oddities`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.tramshed_bell import (
    PLACES,
    WIDE_SAMPLES,
    Bell,
    arcing,
    loudness,
    tolled_later,
)
from bench.challenge.families.tramshed_depot import LAWS as LAWS_OF_ROWS
from bench.challenge.families.tramshed_depot import ROSETTES, SHED_M, Fares, lengths
from bench.challenge.families.tramshed_effects import EFFECTS, off_the_setts
from bench.challenge.families.tramshed_oddities import ODDITIES

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "braccia-from-one-rosette"}
LAWS |= {name: Law() for name in ODDITIES}
FACES, IRON_SLIPS = 2.3, 0.18  # of shares of faces; of what iron returns, by how steep it is met
NEXT = 6.6  # samples from which faces are heard
ROUND_M, ROUND_HIGH, ROUNDS, ROUND_KEEPS, APART_M = (0.5, 1.5), 0.42, 8, 0.8, (0.3, 0.75)
"""Of ways round: m to the first; how high it is; how many; part each next keeps; m between."""
SHADE, SMOOTHED = 1.3, 3.0  # of Nakagami's law; samples over which fades are alike
TAIL, BEGINS, RISES, DIES = 0.012, 4.0, 9.0, 26.0  # power; samples until; to its rise; to 1 / e
RING, RING_AT, RING_EACH, RING_RAD, RING_DIES = 11, 4.7, 1.45, 2.0, 4.2
"""Of hangers' wires: echoes; samples to the first and between; radians each; echoes to 1 / e."""
PITCH, BESIDE, WEAKER = (0.35, 1.8), (0.06, 0.25), 0.7  # radians a sample; off; of the second
SOME: Complexes = arcing(np.random.default_rng(9507), 150)  # noise to try readings on


def by_faces(fares: Fares) -> tuple[Floats, Floats]:
    """Return how much longer ways by walls and roof are, in m, and what comes by these [5, n].

    Iron returns nearly all but for how its ribs scatter, the more the steeper it is met.
    """
    made = []
    for axis, side in ((0, 0.0), (0, SHED_M[0]), (1, 0.0), (1, SHED_M[1]), (2, SHED_M[2])):
        image = fares.rosette_m.copy()
        image[:, axis] = 2 * side - image[:, axis]
        way = image - fares.tag_m
        long_m = lengths(way)
        steep = np.abs(way[:, axis]) / long_m
        made.append((long_m - fares.far, fares.far / long_m * np.exp(-steep / IRON_SLIPS / 8)))
    return np.stack([longer for longer, _ in made]), np.stack([share for _, share in made])


def _faces(bell: Bell, strength: float) -> None:
    """Hear the shed's iron walls and roof, more or less hung with things, links alike."""
    fares, direct = bell.fares(), bell.came() * bell.direct()
    for longer, share in zip(*by_faces(fares), strict=True):
        bare = fares.each_link(lambda n: bell.rng.beta(2.0, 1.5, n))
        size = FACES * np.sqrt(strength) * bare * share * (longer > NEXT * bell.metres)
        bell.again(direct, size.clip(max=0.85) * bell.phases(), longer / bell.metres)


def _setts(bell: Bell, strength: float) -> None:
    longer, share = off_the_setts(bell.fares(), strength)
    bell.again(bell.came(), share, longer / bell.metres)


def _round(bell: Bell, strength: float) -> None:
    """Lose what comes straight behind things; ways round come one by one, ever lower."""
    fares, rng, came = bell.fares(), bell.rng, bell.came()
    shut = fares.shut_off(0.2)
    bell.muffle(-34.0 * shut[:, None] * bell.direct())
    late_m = fares.each_link(lambda n: rng.uniform(*ROUND_M, n)) * (0.5 + 0.5 * strength**0.8)
    for way in range(ROUNDS):
        fades = np.ones(bell.rows) if way == 0 else rng.rayleigh(0.75, bell.rows)
        size = (shut * ROUND_HIGH * ROUND_KEEPS**way * fades).clip(max=0.8)
        bell.again(came, size * bell.phases(), late_m / bell.metres)
        late_m = late_m + fares.each_link(lambda n: rng.uniform(*APART_M, n))


def shading(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of power 1 (Nakagami 1960).

    Powers of two even chances, smoothed by a bell, that a gamma law has been made of.
    """
    off = np.arange(-9, 10) / SMOOTHED
    bell = np.exp(-(off**2))
    power = rng.gamma(SHADE * (bell**2).sum() / bell.sum() ** 2, 1.0,
                      (rows, WIDE_SAMPLES + len(bell) - 1))  # fmt: skip
    smooth = sum(share * power[:, k : k + WIDE_SAMPLES] for k, share in enumerate(bell))
    size = np.sqrt(np.asarray(smooth))
    return np.asarray(size / np.sqrt((size**2).mean()))


def _shades(bell: Bell, strength: float) -> None:
    """Fade smoothly; of what comes straight, all alike."""
    size = shading(bell.rng, bell.rows) ** min(np.sqrt(strength), 1.6)
    top = np.rint(bell.at + 1.7).astype(np.int64)
    direct, one = bell.direct(), size[np.arange(bell.rows), top.clip(0, WIDE_SAMPLES - 1)]
    size = size + direct * (one[:, None].clip(0.4, 2.2) - size)
    bell.wave = bell.wave + (size / np.sqrt((size**2).mean()) - 1) * bell.came()


def swelling(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: it swells, then dies."""
    gone = np.maximum(since, 0.0)
    return np.asarray(-np.expm1(-gone / RISES) * np.exp(-gone / DIES) + 0.12 * np.exp(-gone / 90.0)
                      * (since > 0))  # fmt: skip


def _tail(bell: Bell, strength: float) -> None:
    """Hear all else of a shed whose far half answers later."""
    high = loudness(bell.wave, bell.at, bell.sigma)[:, None]
    power = TAIL * strength * swelling(PLACES - bell.at[:, None] - BEGINS)
    bell.hiss(high * np.sqrt(power) * bell.from_on(BEGINS))


def hung(waves: Complexes) -> Complexes:
    """Return what rings after waveforms in hangers' wires: one mode, that dies as a bell does."""
    made = np.zeros_like(waves)
    for k in range(RING):
        share = np.exp(1j * RING_RAD * k - (k / RING_DIES) ** 1.5)
        made += share * tolled_later(waves, np.full(len(waves), RING_AT + RING_EACH * k))
    return made


def _hangers(bell: Bell, strength: float) -> None:
    turn = np.exp(1j * bell.alike(5).uniform(-np.pi, np.pi))
    bell.wave = bell.wave + 0.3 * min(strength, 2.2) ** 0.8 * turn * hung(bell.came())


def _motors(bell: Bell, strength: float) -> None:
    fine = EFFECTS["noise-floor"](bell.fares(), strength)
    bell.crackle(np.zeros(bell.rows) + fine.noise_db)


def reading(waves: Complexes) -> float:
    """Return how sizes scatter from one to the next but three, as bells say of noise."""
    size = np.abs(waves)
    return float(np.sqrt(0.5 * ((size[:, 4:] - size[:, :-4]) ** 2).mean()))


def _retold(bell: Bell, at: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise what it reads as tried, at what is `at` a row [n], next to what it read."""
    by = np.array([reading(made(float(one))) for one in tried]) / reading(SOME)
    bell.noise_by = bell.noise_by * np.maximum(np.interp(at, tried, by), 0.05)


def beating(rng: np.random.Generator, rows: int) -> Complexes:
    """Return pairs of tones of power 1, close beside each other [rows, WIDE_SAMPLES]."""
    pitch = rng.uniform(*PITCH, (rows, 1)) * rng.choice([-1.0, 1.0], (rows, 1))
    off, begun = rng.uniform(*BESIDE, (rows, 1)), rng.uniform(-np.pi, np.pi, (2, rows, 1))
    both = np.exp(1j * (pitch * PLACES + begun[0]))
    both = both + WEAKER * np.exp(1j * ((pitch + off) * PLACES + begun[1]))
    return np.asarray(both / np.sqrt((np.abs(both) ** 2).mean(axis=1, keepdims=True)))


def _beats(bell: Bell, strength: float) -> None:
    """Hear choppers of two motors that beat; by rosettes more or less."""
    near = bell.alike(6).uniform(0.6, 1.5, ROSETTES)[bell.fares().rosette]
    size = 1.1 * strength * near
    bell.wave = bell.wave + (size * bell.sigma)[:, None] * beating(bell.rng, bell.rows)
    tones = beating(np.random.default_rng(9508), len(SOME))
    _retold(bell, size, np.linspace(0.0, 8.0, 33), lambda one: SOME + one * tones)
    bell.sigma = bell.sigma * np.sqrt(1 + 0.5 * size**2)


def in_treads(waves: Complexes, tread: float) -> Complexes:
    """Return waveforms whose both parts are told by middles of treads, none of nought [n, k]."""

    def middle(part: Floats) -> Floats:
        return np.asarray(tread * (np.floor(part / tread) + 0.5))

    return np.asarray(middle(waves.real) + 1j * middle(waves.imag))


def _treads(bell: Bell, strength: float) -> None:
    tread = 1.2 * strength * float(np.median(bell.sigma))
    bell.wave = in_treads(bell.wave, tread)
    _retold(bell, tread / bell.sigma, np.geomspace(0.03, 12.0, 50),
            lambda one: in_treads(SOME, one))  # fmt: skip


def _deaf(bell: Bell, strength: float) -> None:
    """Ask a larger part of the most of what is heard, as clogged bells do."""
    bell.deaf = strength


WAVES: dict[str, Callable[[Bell, float], None]] = {
    "obstructed-path": _round, "specular-reflections": _faces, "ground-bounce": _setts,
    "small-scale-fading": _shades, "diffuse-tail": _tail, "pulse-ringing": _hangers,
    "noise-floor": _motors, "narrowband-interference": _beats,
    **ODDITIES,
    "quantisation": _treads, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows are fined once waves were ON_THE_WAY, before bells hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail")  # fmt: skip
OF_RANGES = tuple(name for name in EFFECTS if name not in {
    *LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"})  # fmt: skip
"""Effects that are those of the tram shed's tables of ranges."""


def hide(bell: Bell, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what rows are fined, and what bells do."""
    first = [name for name in ON_THE_WAY if name in names]
    for name in first:
        WAVES[name](bell, strength)
    for name in sorted({*names} - {*WAVES}):
        bell.levy(EFFECTS[name](bell.fares(), strength))
    for name in WAVES:
        if name in names and name not in first:
            WAVES[name](bell, strength)
