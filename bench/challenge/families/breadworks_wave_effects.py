"""What the breadworks hides in waveforms: effects in forms of its own, oddities of its balances.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.breadworks_balance import (
    METRES,
    WIDE_SAMPLES,
    Balance,
    heights,
    kneading,
)
from bench.challenge.families.breadworks_effects import EFFECTS, SIDES, off_the_floor
from bench.challenge.families.breadworks_hall import CORBELS, Bake
from bench.challenge.families.breadworks_hall import LAWS as LAWS_OF_ROWS
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
OF_LATE_SIZES = (
    "late-sizes-dealt-by-a-prime", "late-sizes-left-companded", "gain-pumps-in-late-part",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | dict.fromkeys(OF_LATE_SIZES, Law())
del LAWS["brazas-from-one-corbel"]
LATE = 8.0  # samples past first paths from which balances are odd
TILED, NEXT = 0.62, 4.6  # what tiled walls return; samples past which these are heard
PARTS, APART = 8, 1.5  # of what comes round racks; samples from one to the next in the mean
ALIKE_FOR, ALPHA, MU = 5, 1.7, 1.15  # samples from chance to chance; of Yacoub's law
BEGINS, TAIL = 4.2, 0.026  # samples past first paths of a tail; its height, in power
ROOMS = ((1.0, 8.0), (0.3, 33.0))  # their shares, and samples until they die away
BEATS, TUNED, FED, RINGS = 0.11, 0.9, 3, 100  # radians a sample; samples: until fed; its last
TUNE, DRIFTS = (0.75, 1.05), 0.0021  # radians a sample of dryers; by how much more a sample
LAG = 3  # samples apart of which noise is read
PRIME, DEALT = 67, 12  # samples that are dealt; every which one
STEEP, FOLLOWS, EVENS = 7.0, 0.9, 0.6  # of a compander; of a gain: how slow it is, how much it does
SOME: Complexes = kneading(np.random.default_rng(3707), 160)  # noise to try readings on


def by_images(bake: Bake) -> list[tuple[Floats, Floats]]:
    """Return ways in m by each wall and the ceiling, and by two walls at corners; their shares."""
    mirrors: list[tuple[tuple[int, float], ...]] = [(one,) for one in SIDES]
    mirrors += [(one, other) for one in SIDES[:2] for other in SIDES[2:4]]
    made = []
    for some in mirrors:
        image = bake.tag_m.copy()
        for axis, where in some:
            image[:, axis] = 2 * where - image[:, axis]
        way = np.linalg.norm(image - bake.corbel_m, axis=1)
        made.append((way, TILED ** len(some) * bake.apart / way))
    return made


def _tiled(balance: Balance, strength: float) -> None:
    """Hear tiled walls by images, and corners by images of images."""
    bake, direct = balance.bake(), balance.came() * balance.first()
    for way, left in by_images(bake):
        late = (way - bake.apart) / METRES
        free = bake.by_link(lambda n: balance.rng.triangular(0.2, 0.8, 1.0, n))
        share = np.minimum(1.3 * np.sqrt(strength) * free * left, 0.75) * (late > NEXT)
        balance.again(direct, share * balance.turned(), late)


def _floor(balance: Balance, strength: float) -> None:
    longer, share = off_the_floor(balance.bake(), strength)
    balance.again(balance.came(), share, longer / METRES)


def _round_racks(balance: Balance, strength: float) -> None:
    """Lose what comes straight behind things: waves come round racks, one part after another.

    Parts come by chance as calls do (Poisson), ever weaker.
    """
    bake, air, rng = balance.bake(), balance.came(), balance.rng
    cut = bake.cut_off(0.2)
    balance.fainter(-32.0 * cut[:, None] * balance.first())
    late = bake.by_link(lambda n: rng.uniform(2.0, 3.3, n)) * (0.45 + 0.55 * strength**0.7)
    for k in range(PARTS):
        size = 0.6 * cut * np.exp(-k / 4.5) * rng.gamma(3.0, 1 / 3.0, balance.rows)
        balance.again(air, size * balance.turned(), late)
        late = late + bake.by_link(lambda n: rng.exponential(APART, n))


def yacoub(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance of power 1 [rows, k]: roots, of an order, of gamma's (Yacoub 2007).

    From knot to knot they go by half a cosine.
    """
    knots = rng.gamma(MU, 1 / MU, (rows, WIDE_SAMPLES // ALIKE_FOR + 2)) ** (1 / ALPHA)
    knot, part = np.divmod(np.arange(WIDE_SAMPLES), ALIKE_FOR)
    by = 0.5 - 0.5 * np.cos(np.pi * part / ALIKE_FOR)
    sizes = (1 - by) * knots[:, knot] + by * knots[:, knot + 1]
    return np.asarray(sizes / np.sqrt((sizes**2).mean()))


def _fades(balance: Balance, strength: float) -> None:
    """Fade amid racks and steam; of what comes straight, all alike."""
    size = yacoub(balance.rng, balance.rows) ** min(0.95 * strength**0.5, 1.6)
    first = balance.first()
    top = np.rint(balance.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)[:, None]
    size = first * np.take_along_axis(size, top, axis=1).clip(0.25) + (1 - first) * size
    balance.wave = balance.wave + balance.came() * (size / np.sqrt((size**2).mean()) - 1)


def of_rooms(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: two rooms' that share a door.

    The one is damp and soon still; of the other, which is of steel, ever more is left.
    """
    late = since.clip(0.0)
    return np.asarray(sum(share * np.exp(-late / dies) for share, dies in ROOMS))


def _rooms(balance: Balance, strength: float) -> None:
    power = TAIL * of_rooms(balance.since - BEGINS) * balance.from_on(BEGINS)
    balance.knead(np.sqrt(0.5 * strength * power) * heights(balance.wave, balance.at)[:, None])


def beating() -> Complexes:
    """Return how one bowl of two rings that hang beside each other, of power 1 [RINGS].

    What the other was struck by comes over to it and goes back.
    """
    since = (np.arange(RINGS) - FED).clip(0)
    made = np.exp(-since / 21.0 + 1j * TUNED * since) * np.sin(BEATS * since)
    return np.asarray(made / np.sqrt((np.abs(made) ** 2).sum()))


def rung(waves: Complexes) -> Complexes:
    """Return what two bowls make of waveforms [n, k]."""
    long = WIDE_SAMPLES + RINGS
    both = np.fft.fft(waves, long, axis=1) * np.fft.fft(beating(), long)
    return np.asarray(np.fft.ifft(both, axis=1)[:, :WIDE_SAMPLES])


def _bowls(balance: Balance, strength: float) -> None:
    """Ring as two mixing bowls do that hang beside a corbel."""
    part = 0.4 * min(strength, 2.4) ** 0.8 * np.exp(2j * np.pi * balance.shared(1).random())
    balance.wave = balance.wave + part * rung(balance.came())


def _mixers(balance: Balance, strength: float) -> None:
    does = EFFECTS["noise-floor"](balance.bake(), strength)
    balance.louder_noise(np.zeros(balance.rows) + does.noise_db)


def spread(waves: Complexes) -> float:
    """Return how sizes differ that are LAG samples apart, as balances tell of noise."""
    sizes = np.abs(waves)
    return float(np.sqrt(0.5 * ((sizes[:, LAG:] - sizes[:, :-LAG]) ** 2).mean()))


def _tell(balance: Balance, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes differ as tried, at what is `of` a row [n]."""
    by = np.array([spread(made(one)) for one in tried.tolist()]) / spread(SOME)
    balance.noise_by = balance.noise_by * np.interp(of, tried, by).clip(0.04)


def drifting(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers of size 1 whose pitch drifts evenly, from any phase [rows, k]."""
    place = np.arange(WIDE_SAMPLES)
    start, pitch = rng.uniform(0.0, 2 * np.pi, (rows, 1)), rng.uniform(*TUNE, (rows, 1))
    return np.asarray(np.exp(1j * (start + pitch * place + 0.5 * DRIFTS * place**2)))


def _dryers(balance: Balance, strength: float) -> None:
    """Hear a harmonic of dryers' generators, whose load lets it drift; some corbels more."""
    near = (0.5 + 1.2 * balance.shared(2).beta(1.5, 2.5, CORBELS))[balance.bake().corbel]
    size = 1.75 * strength * near
    balance.wave = balance.wave + (size * balance.sigma)[:, None] * drifting(
        balance.rng, balance.rows
    )
    tone = drifting(np.random.default_rng(3708), len(SOME))
    _tell(balance, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tone)
    balance.sigma = balance.sigma * np.sqrt(1 + size**2 / 2)


def amid_steps(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of whose parts the middles of steps are kept, so that none is 0 [n, k]."""
    real, imag = (step * (np.floor(part / step) + 0.5) for part in (waves.real, waves.imag))
    return np.asarray(real + 1j * imag)


def _amid_steps(balance: Balance, strength: float) -> None:
    step = 0.9 * strength * float(np.median(balance.sigma))
    balance.wave = amid_steps(balance.wave, step)
    tried = np.geomspace(0.04, 14.0, 64)
    _tell(balance, step / balance.sigma, tried, lambda one: amid_steps(SOME, one))


def _deaf(balance: Balance, strength: float) -> None:
    """Ask more of what is weighed, as where a slicer was once too near."""
    balance.deaf = strength


def dealt(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] of which PRIME from `begin` [n] on are dealt, each DEALT after the last.

    They go round and round until all are dealt, as a prime has it.
    """
    made = sizes.copy()
    order = DEALT * np.arange(PRIME) % PRIME
    for row, first in enumerate(begin):
        made[row, first : first + PRIME] = sizes[row, first + order]
    return made


def companded(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that are left from `begin` [n] on as a telephone's law has them.

    Small ones are larger next to the largest, as nobody undid the logarithm (mu law, G.711).
    """
    late = np.arange(sizes.shape[1]) > begin[:, None]
    most = np.where(late, sizes, 0.0).max(axis=1, keepdims=True).clip(1e-9)
    made = most * np.log1p(STEEP * sizes / most) / np.log1p(STEEP)
    return np.asarray(np.where(late, made, sizes))


def pumped(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that a gain evens from `begin` [n] on by a power of what came lately."""
    made = sizes.copy()
    lately = np.array([one[k : k + 8].mean() for one, k in zip(sizes, begin, strict=True)])
    meant = lately.copy()
    for k in range(sizes.shape[1]):
        late = k > begin
        lately = np.where(late, FOLLOWS * lately + (1 - FOLLOWS) * sizes[:, k], lately)
        gain = (meant / lately.clip(1e-9)) ** EVENS
        made[:, k] = np.where(late, sizes[:, k] * gain, sizes[:, k])
    return made


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(balance: Balance, strength: float) -> None:
        sizes = np.abs(balance.wave)
        begin = np.ceil(balance.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - PRIME)
        by = made(sizes, begin) / sizes.clip(1e-9)
        part = min(most * strength, 1.0) * balance.from_on(LATE)
        balance.wave = balance.wave * (1 + part * (by - 1))

    return act


WAVES: dict[str, Callable[[Balance, float], None]] = {
    "obstructed-path": _round_racks, "specular-reflections": _tiled, "ground-bounce": _floor,
    "small-scale-fading": _fades, "diffuse-tail": _rooms, "pulse-ringing": _bowls,
    "noise-floor": _mixers, "narrowband-interference": _dryers,
    OF_LATE_SIZES[0]: _odd(dealt, 0.45), OF_LATE_SIZES[1]: _odd(companded, 0.35),
    OF_LATE_SIZES[2]: _odd(pumped, 0.4), "quantisation": _amid_steps, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows get what they do once waves have been IN_THE_HALL, before corbels hear them."""
IN_THE_HALL = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the breadworks's tables of ranges."""


def put_in(balance: Balance, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what rows get, and what balances do."""
    of_waves = [name for name in WAVES if name in names]
    for name in (one for one in of_waves if one in IN_THE_HALL):
        WAVES[name](balance, strength)
    for name in sorted({*names} - {*WAVES}):
        balance.take(EFFECTS[name](balance.bake(), strength))
    for name in (one for one in of_waves if one not in IN_THE_HALL):
        WAVES[name](balance, strength)
