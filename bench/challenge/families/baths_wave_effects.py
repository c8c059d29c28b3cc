"""What the baths hide in waveforms: effects in forms of their own, oddities of their probes.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.baths_effects import EFFECTS, off_the_water
from bench.challenge.families.baths_hall import ARCHES, BATHS_M, Heat
from bench.challenge.families.baths_hall import LAWS as LAWS_OF_ROWS
from bench.challenge.families.baths_probe import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Probe,
    gurgle,
)
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "every-fifth-size-skipped", "twelves-left-as-cosines", "late-part-averaged-with-its-mirror",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["passi-from-one-arch"]
LATE = 8.0  # samples past first paths from which probes are odd
WALLS: tuple[tuple[int, float, float], ...] = (
    (0, 0.0, 0.36), (0, BATHS_M[0], 0.43), (1, 0.0, 0.43), (1, BATHS_M[1], 0.33),
    (2, BATHS_M[2], 0.26),
)  # fmt: skip
"""Which axis walls and the roof are square to, where they are in m, what they return head on."""
FLUTTERS: tuple[tuple[int, ...], ...] = (
    (0,),
    (1,),
    (2,),
    (3,),
    (4,),
    (2, 3),
    (3, 2),
    (0, 1),
    (1, 0),
)
"""By which walls, in turn, waves are heard."""
NEXT = 3.0  # samples past which walls are heard
JETS, CALMS = 9, 2.3  # jets of water that scatter; nepers until the last
WEARS = 1.0  # how unlike powers are (Birnbaum, Saunders)
STAYS = 0.76  # of what is unlike from one sample to the next
HARD, SOFT = 30.0, 9.0  # samples: tiles return for so long; water takes a power of time
RING, DIES, CAUSTIC = 40, 12.0, 0.85  # samples; to 1 / e; samples by which Airy's swings are
HOLDS, LEVELS = 9, (0.35, 0.8, 1.25, 1.7)  # samples that a level of a time code is held
WINDOW = 6  # samples in which noise is read
CARRY = 0.34  # of a step that carries weigh too much, each four codes
TRIED: Complexes = gurgle(np.random.default_rng(2808), 150)  # noise to try readings on


def schlick(head_on: float, straight: Floats) -> Floats:
    """Return what walls return of waves that come so straight [n], in size (Schlick 1994)."""
    power = head_on**2
    return np.asarray(np.sqrt(power + (1 - power) * (1 - straight.clip(0.0, 1.0)) ** 5))


def fluttered(heat: Heat, walls: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return ways in m by a wall, or to and fro between two, and what is returned, [n] each."""
    image, left = heat.low.copy(), np.ones(heat.rows)
    for axis, where, _ in (WALLS[k] for k in walls):
        image[:, axis] = 2 * where - image[:, axis]
    run = heat.high - image
    way = np.linalg.norm(run, axis=1)
    for axis, _, head_on in (WALLS[k] for k in walls):
        left = left * schlick(head_on, np.abs(run[:, axis]) / way)
    return way, left


def _walls(probe: Probe, strength: float) -> None:
    """Hear four walls and the roof, and flutter to and fro between two, by images.

    What a wall right behind an antenna returns is its antenna's own.
    """
    heat, direct = probe.heat(), probe.heard() * probe.front()
    for walls in FLUTTERS:
        way, left = fluttered(heat, walls)
        bare = heat.each_link(lambda n: probe.rng.triangular(0.2, 0.8, 1.0, n))
        late = (way - heat.far) / METRES
        share = 1.35 * np.sqrt(strength) * bare * left * heat.far / way * (late > NEXT)
        probe.lap(direct, share.clip(max=0.8) * probe.turns(), late)


def _water(probe: Probe, strength: float) -> None:
    longer, share = off_the_water(probe.heat(), strength)
    probe.lap(probe.heard(), share, longer / METRES)


def _jets(probe: Probe, strength: float) -> None:
    """Lose what comes straight behind things: jets of water scatter it, near ones and far ones.

    Links have jets, each so far away by chance; in rows they are as loud as they splash.
    """
    heat, air = probe.heat(), probe.heard()
    hidden = heat.unseen(0.2)
    probe.sink(-35.0 * hidden[:, None] * probe.front())
    late = heat.each_link(lambda n: probe.rng.uniform(1.2, 2.4, n)) * (0.4 + 0.6 * strength**0.7)
    for jet in range(JETS):
        loud = hidden * 0.5 * np.exp(-CALMS * jet / JETS) * probe.rng.weibull(2.6, probe.rows)
        probe.lap(air, loud * probe.turns(), late)
        late = late + heat.each_link(lambda n: probe.rng.gamma(2.0, 0.7, n))


def wandering(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances of a bell, of which STAYS stays from sample to sample [rows, k]."""
    fresh = rng.normal(size=(rows, WIDE_SAMPLES))
    fresh[:, 1:] *= np.sqrt(1 - STAYS**2)
    for place in range(1, WIDE_SAMPLES):
        fresh[:, place] += STAYS * fresh[:, place - 1]
    return fresh


def _worn(probe: Probe, strength: float) -> None:
    """Fade by the law of how long what swell wears lasts (Birnbaum, Saunders 1969)."""
    wears = min(WEARS * strength**0.5, 1.9)
    size = np.exp(np.arcsinh(0.5 * wears * wandering(probe.rng, probe.rows)))
    probe.wave = probe.wave + probe.heard() * (size / np.sqrt(np.mean(size**2)) - 1)


def _soft(probe: Probe, strength: float) -> None:
    """Reverberate between tiles, an exponential, over water, which takes by a power of time."""
    since = probe.since.clip(0.0)
    power = 0.045 * np.exp(-since / HARD) / (1 + (since / SOFT) ** 1.3)
    part = np.sqrt(0.5 * strength * power * probe.after(3.2, 3.4))
    probe.hiss(part * probe.crest()[:, None])


def caustic() -> Floats:
    """Return what swings past a caustic, sample by sample [RING]: Airy's function, and dies away.

    As it is far from its turning point: ever faster, by the power of three halves.
    """
    at = CAUSTIC * (np.arange(RING, dtype=np.float64) - 1.5)
    deep = at.clip(0.6)
    swing = np.sin(2 / 3 * deep**1.5 + np.pi / 4) / (np.sqrt(np.pi) * deep**0.25)
    return np.asarray((at > 0.6) * swing * np.exp(-np.arange(RING) / DIES))


def _caustic(probe: Probe, strength: float) -> None:
    """Ring as waves do past a caustic that a wet dome casts over its antenna (Airy 1838)."""
    part = 0.62 * min(strength, 2.4) ** 0.8 * np.exp(1j * probe.alike(1).uniform(-np.pi, np.pi))
    air = probe.heard()
    blows = np.concatenate([caustic(), np.zeros(WIDE_SAMPLES)])
    long = len(blows)
    rings = np.fft.ifft(np.fft.fft(air, long, axis=1) * np.fft.fft(blows), axis=1)
    probe.wave = probe.wave + part * rings[:, :WIDE_SAMPLES]


def _filters(probe: Probe, strength: float) -> None:
    noise_db = EFFECTS["noise-floor"](probe.heat(), strength).noise_db
    probe.churn(np.broadcast_to(np.asarray(noise_db), (probe.rows,)))


def scatter_of(sizes: Floats) -> float:
    """Return how sizes [n, k] scatter in windows of WINDOW, as probes tell of noise."""
    count = sizes.shape[1] // WINDOW
    lots = sizes[:, : count * WINDOW].reshape(len(sizes), count, WINDOW)
    return float(np.sqrt(lots.var(axis=2, ddof=1).mean()))


def _say(probe: Probe, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    plain = scatter_of(np.abs(TRIED))
    found = [scatter_of(np.abs(made(float(one)))) / plain for one in tried]
    probe.told_noise = probe.told_noise * np.maximum(np.interp(of, tried, found), 0.05)


def time_code(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers of one of four levels for HOLDS samples each, straight between [rows, k]."""
    count = WIDE_SAMPLES // HOLDS + 3
    levels = rng.choice(LEVELS, (rows, count))
    place = PLACES / HOLDS + rng.random((rows, 1))
    low = np.floor(place).astype(np.int64)
    part = ((place - low - 0.8) / 0.2).clip(0.0, 1.0)
    before, after = (np.take_along_axis(levels, low + k, axis=1) for k in (0, 1))
    turn = np.exp(1j * rng.uniform(-np.pi, np.pi, (rows, 1)))
    return np.asarray((before + part * (after - before)) * turn)


def _clock(probe: Probe, strength: float) -> None:
    """Hear a harmonic of the swim clock's link, which sends levels; below some arches more."""
    drawn = probe.alike(2)
    pitch, near = drawn.uniform(-1.3, 1.3), drawn.lognormal(-0.06, 0.3, ARCHES).clip(0.5, 1.8)
    size = 1.35 * strength * near[probe.heat().arch]
    tone = time_code(probe.rng, probe.rows) * np.exp(1j * pitch * PLACES)
    probe.wave = probe.wave + (size * probe.sigma)[:, None] * tone
    some = np.resize(tone, TRIED.shape)
    _say(probe, size, np.linspace(0.0, 15.0, 46), lambda one: TRIED + one * some)
    probe.sigma = probe.sigma * np.sqrt(1 + size**2 / 2 * np.mean(np.square(LEVELS)))


def carried_codes(values: Floats, step: float) -> Floats:
    """Return values by a converter whose carries from each fourth code on weigh too much."""
    code = np.rint(values / step)
    return np.asarray(step * (code + CARRY * (np.floor(code / 4) - code / 4 + 0.375)))


def coded(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of which both parts have been converted."""
    return np.asarray(carried_codes(waves.real, step) + 1j * carried_codes(waves.imag, step))


def _coded(probe: Probe, strength: float) -> None:
    """Convert by successive approximation whose weights do not match."""
    step = 1.5 * strength * float(np.median(probe.sigma))
    probe.wave = coded(probe.wave, step)
    _say(probe, step / probe.sigma, np.geomspace(0.05, 12.0, 60), lambda one: coded(TRIED, one))


def _deaf(probe: Probe, strength: float) -> None:
    """Ask more of first tops, as where whistles were too near once."""
    probe.deaf = strength


def _shown(probe: Probe, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    late = min(part, 1.0) * probe.after(LATE)
    by = sizes / np.maximum(np.abs(probe.wave), 1e-9)
    probe.wave = probe.wave * (1 + late * (by - 1))


def _from(probe: Probe) -> Integers:
    """Return from which samples on probes are odd [n, 1]."""
    return np.asarray(np.ceil(probe.at + LATE)[:, None], np.int64)


def skipped(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] of which, from `begin` [n, 1] on, each fifth is left out: others move up.

    What would be past the end is the last one.
    """
    place = np.arange(sizes.shape[1])
    since = (place - begin).clip(0)
    from_ = np.minimum(place + since // 4, sizes.shape[1] - 1)
    return np.take_along_axis(sizes, from_, axis=1)


def _skipped(probe: Probe, strength: float) -> None:
    """Read late sizes by a clock that is too slow for a fifth of them."""
    _shown(probe, skipped(np.abs(probe.wave), _from(probe)), strength)


def cosines() -> Floats:
    """Return cosines of twelve sizes, each of length 1 (Ahmed, Natarajan, Rao 1974) [12, 12]."""
    place = np.arange(12)
    made = np.cos(np.pi / 12 * place[:, None] * (place + 0.5)) * np.sqrt(2 / 12)
    made[0] /= np.sqrt(2.0)
    return np.asarray(made)


def as_cosines(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], from `begin` [n, 1] on as sizes of cosines of twelve and twelve."""
    long = -(-sizes.shape[1] // 12) * 12 + 12
    place = np.minimum(begin + np.arange(long), sizes.shape[1] - 1)
    lots = np.take_along_axis(sizes, place, axis=1).reshape(len(sizes), -1, 12)
    turned = np.abs(lots @ cosines().T).reshape(len(sizes), long)
    back = (np.arange(sizes.shape[1]) - begin).clip(0)
    there = np.arange(sizes.shape[1]) >= begin
    return np.where(there, np.take_along_axis(turned, back, axis=1), sizes)


def _cosines(probe: Probe, strength: float) -> None:
    """Leave late sizes as the cosines that they were packed by."""
    _shown(probe, as_cosines(np.abs(probe.wave), _from(probe)), 0.9 * strength)


def mirrored(sizes: Floats, begin: Integers, count: int) -> Floats:
    """Return sizes [n, k], in `count` from `begin` [n, 1] on means with what is as near the end."""
    place = np.arange(sizes.shape[1])
    other = (2 * begin + count - 1 - place).clip(0, sizes.shape[1] - 1)
    inside = (place >= begin) & (place < begin + count)
    return np.where(inside, 0.5 * (sizes + np.take_along_axis(sizes, other, axis=1)), sizes)


def _mirrored(probe: Probe, strength: float) -> None:
    """Read late sizes to and fro, as a line of water lets waves run back, and keep means."""
    _shown(probe, mirrored(np.abs(probe.wave), _from(probe), 90), strength)


WAVES: dict[str, Callable[[Probe, float], None]] = {
    "obstructed-path": _jets, "specular-reflections": _walls, "ground-bounce": _water,
    "small-scale-fading": _worn, "diffuse-tail": _soft, "pulse-ringing": _caustic,
    "noise-floor": _filters, "narrowband-interference": _clock,
    IN_LATE_SIZES[0]: _skipped, IN_LATE_SIZES[1]: _cosines, IN_LATE_SIZES[2]: _mirrored,
    "quantisation": _coded, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows bear what they do once waves have been IN_THE_BATHS, before probes see them."""
IN_THE_BATHS = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the baths' tables of ranges."""


def put_in(probe: Probe, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the baths, what rows bear, and what probes do."""
    waves = [name for name in WAVES if name in names]
    for name in waves:
        if name in IN_THE_BATHS:
            WAVES[name](probe, strength)
    for name in sorted({*names} - {*WAVES}):
        probe.suffer(EFFECTS[name](probe.heat(), strength))
    for name in waves:
        if name not in IN_THE_BATHS:
            WAVES[name](probe, strength)
