"""What the colliery hides in waveforms: effects in forms of its own, oddities of its geophones.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.colliery_effects import EFFECTS, off_the_floor
from bench.challenge.families.colliery_geophone import METRES, WIDE_SAMPLES, Geophone, trickling
from bench.challenge.families.colliery_pit import HALL_M, PROPS, WAVE_M, Tally
from bench.challenge.families.colliery_pit import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "late-sizes-left-as-steps-up-and-down", "halves-of-late-words-swapped",
    "strong-late-sizes-by-the-weak-channel",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["lachters-from-one-prop"]
LATE = 8.0  # samples past first paths from which geophones are odd
SIDES: tuple[tuple[int, float], ...] = (
    (0, 0.2), (0, 61.7), (1, 0.3), (1, 43.8), (2, HALL_M[2] - 0.4),
)  # fmt: skip
"""Sides of rock and the roof: square to which axis, and where, in m."""
ROCK, ROUGH_M = 5.6 - 0.35j, 0.008  # permittivity of shale; how its heights scatter
NEXT = 3.3  # samples past which sides are heard
CRACKS, EACH = 9, 0.74  # ways through a pack; what each leaves of the one before
KNOTS, LAPLACE_DB = 6, 3.1  # samples between chances of fades; by how much these scatter
MIDST, BROAD, LEAVES = 11.0, 0.95, 2.5  # samples: a tail's bell of logarithms; since when
MODES = ((2.0, 0.5, 15.0), (3.0, 0.34, 10.0), (5.0, 0.24, 6.0))  # of a box: squares, share, decay
PITCH, FED = 0.62, 3.0  # radians a sample for a root of 1; samples until a box is fed
BARKER: Floats = np.array([1, -1, 1, 1, -1, 1, 1, 1, -1, -1, -1], np.float64)
CHIP, TUNE = 2, 0.9  # samples of a chip; radians a sample of its carrier
WINDOW = 6  # samples in which noise is read
STEP, LASTS = 0.3, 70  # of late sizes' mean, up or down; samples that this mean is of
WORD = 16.0  # by which words count that a late mean has; halves are four bits
SWITCHED, WEAK = 1.15, 0.42  # of late sizes' mean: from where on; what the weak channel shows
SOME: Complexes = trickling(np.random.default_rng(3407), 160)  # noise to try readings on


def by_side(tally: Tally, side: tuple[int, float]) -> tuple[Floats, Floats]:
    """Return ways in m by a side of rock, and what it returns in size, [n] each.

    Of waves that lie level (Fresnel), less what its heights take, which are a bell's.
    """
    axis, where = side
    image = tally.sends.copy()
    image[:, axis] = 2 * where - image[:, axis]
    way = np.linalg.norm(image - tally.stands, axis=1)
    sine = np.abs(image - tally.stands)[:, axis] / way
    root = np.sqrt(ROCK - 1 + sine**2)
    left = np.exp(-2 * (2 * np.pi * ROUGH_M * sine / WAVE_M) ** 2)
    return way, np.abs((sine - root) / (sine + root)) * left


def _sides(phone: Geophone, strength: float) -> None:
    """Hear sides of rock and the roof, by images."""
    tally, direct = phone.tally(), phone.by_air() * phone.straight()
    for side in SIDES:
        way, left = by_side(tally, side)
        late = (way - tally.far) / METRES
        bare = tally.by_link(lambda n: phone.rng.uniform(0.35, 1.0, n))
        share = 2.3 * np.sqrt(strength) * bare * left * tally.far / way * (late > NEXT)
        phone.echo(direct, np.minimum(share, 0.78) * phone.phases(), late)


def _floor(phone: Geophone, strength: float) -> None:
    longer, share = off_the_floor(phone.tally(), strength)
    phone.echo(phone.by_air(), share, longer / METRES)


def _cracks(phone: Geophone, strength: float) -> None:
    """Lose what comes straight behind things: it comes by cracks, ever farther apart.

    The k-th is as late as k times k says, and leaves EACH of the one before.
    """
    tally, air = phone.tally(), phone.by_air()
    cut = tally.cut_off(0.2)
    phone.weaken(-32.0 * cut[:, None] * phone.straight())
    link, rng = tally.by_link, phone.rng
    late = link(lambda n: rng.uniform(2.1, 3.4, n)) * (0.45 + 0.55 * strength**0.7)
    wide = link(lambda n: rng.uniform(0.1, 0.24, n))
    for k in range(CRACKS):
        size = 0.42 * cut * EACH**k * rng.rayleigh(0.7, phone.rows)
        phone.echo(air, size * phone.phases(), late + wide * k**2)


def double_exponential(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes of chance of power 1 [rows, k], whose dB are Laplace's (1774) at knots."""
    knots = rng.laplace(0.0, LAPLACE_DB / np.sqrt(2), (rows, WIDE_SAMPLES // KNOTS + 2))
    knot, part = np.divmod(np.arange(WIDE_SAMPLES), KNOTS)
    by = part / KNOTS
    db = (1 - by) * knots[:, knot] + by * knots[:, knot + 1]
    sizes = 10 ** (db.clip(-20.0, 9.0) / 20)
    return np.asarray(sizes / np.sqrt(np.mean(sizes**2)))


def _fades(phone: Geophone, strength: float) -> None:
    """Fade among pillars: dB by Laplace's law; what comes straight, all of it alike."""
    size = double_exponential(phone.rng, phone.rows) ** min(strength**0.5, 1.6)
    straight = phone.straight()
    top = np.rint(phone.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)[:, None]
    size = straight * np.take_along_axis(size, top, axis=1) + (1 - straight) * size
    phone.wave = phone.wave + phone.by_air() * (size / np.sqrt(np.mean(size**2)) - 1)


def _galleries(phone: Geophone, strength: float) -> None:
    """Reverberate in galleries of any length: by a bell of the logarithm of how late."""
    since = (phone.since - LEAVES).clip(0.05, 250.0)
    power = 0.013 * np.exp(-0.5 * (np.log(since / MIDST) / BROAD) ** 2) * phone.after(LEAVES)
    phone.add_noise(np.sqrt(0.5 * strength * power) * phone.height()[:, None])


def boxed(waves: Complexes, part: complex) -> Complexes:
    """Return what a box of steel adds: modes whose pitches go as roots of 2, 3 and 5."""
    made = np.zeros_like(waves)
    for square, share, lasts in MODES:
        turn = np.exp(1j * PITCH * np.sqrt(square) - 1 / lasts)
        state = np.zeros(len(waves), np.complex128)
        for k in range(waves.shape[1]):
            fed = waves[:, k - int(FED)] if k >= FED else 0.0
            state = state * turn + fed
            made[:, k] += share * state
    return made * part


def _box(phone: Geophone, strength: float) -> None:
    """Ring in the box of steel that a radio is in, as rules of the pit ask for."""
    part = complex(0.2 * min(strength, 2.4) ** 0.8 * np.exp(2j * np.pi * phone.common(1).random()))
    phone.wave = phone.wave + boxed(phone.by_air(), part)


def _drills(phone: Geophone, strength: float) -> None:
    noise_db = np.asarray(EFFECTS["noise-floor"](phone.tally(), strength).noise_db)
    phone.drown(np.zeros(phone.rows) + noise_db)


def spread(waves: Complexes) -> float:
    """Return how sizes scatter in windows of WINDOW, as geophones tell of noise."""
    count = waves.shape[1] // WINDOW
    lots = np.abs(waves)[:, : count * WINDOW].reshape(len(waves), count, WINDOW)
    return float(np.sqrt(lots.var(axis=2, ddof=1).mean()))


def _tell(phone: Geophone, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    by = [spread(made(float(one))) / spread(SOME) for one in tried]
    phone.told_noise = phone.told_noise * np.interp(of, tried, by).clip(0.04)


def barker(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers of size 1 that eleven chips turn over, and bits all of these [rows, k]."""
    since = np.arange(WIDE_SAMPLES) + rng.integers(0, 11 * CHIP, (rows, 1))
    chip = since // CHIP
    bits = 1 - 2 * rng.integers(0, 2, (rows, WIDE_SAMPLES // (11 * CHIP) + 3))
    sign = np.take_along_axis(bits, chip // 11, axis=1) * BARKER[chip % 11]
    start = rng.uniform(0.0, 2 * np.pi, (rows, 1))
    return np.asarray(sign * np.exp(1j * (start + TUNE * np.arange(WIDE_SAMPLES))))


def _leaky_feeder(phone: Geophone, strength: float) -> None:
    """Hear a mixing product of the leaky feeder's link, which spreads bits; near it the more."""
    near = phone.common(2).gamma(7.0, 1 / 7.0, PROPS).clip(0.4, 1.8)
    size = 1.9 * strength * near[phone.tally().prop]
    phone.wave = phone.wave + (size * phone.sigma)[:, None] * barker(phone.rng, phone.rows)
    tone = barker(np.random.default_rng(3408), len(SOME))
    _tell(phone, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tone)
    phone.sigma = phone.sigma * np.sqrt(1 + size**2 / 2)


def hexagonal(waves: Complexes, step: float | Floats) -> Complexes:
    """Return the nearest points of a lattice of triangles whose sides are `step` long.

    It is of two lattices of rectangles, of which each is amid the other.
    """
    wide, high = np.asarray(step), np.asarray(step) * np.sqrt(3.0)
    near = []
    for off in (0.0, 0.5):
        real = wide * (np.rint(waves.real / wide - off) + off)
        imag = high * (np.rint(waves.imag / high - off) + off)
        near.append(real + 1j * imag)
    first = np.abs(waves - near[0]) <= np.abs(waves - near[1])
    return np.asarray(np.where(first, near[0], near[1]))


def _lattice(phone: Geophone, strength: float) -> None:
    """Keep the nearest points of a lattice of triangles, as a code for both parts at once."""
    step = 1.7 * strength * float(np.median(phone.sigma))
    phone.wave = hexagonal(phone.wave, step)
    _tell(phone, step / phone.sigma, np.geomspace(0.04, 14.0, 64), lambda one: hexagonal(SOME, one))


def _deaf(phone: Geophone, strength: float) -> None:
    """Ask more of first tops, as where shots were once fired."""
    phone.deaf = strength


def _odd(phone: Geophone, made: Callable[[Floats, Integers], Floats], part: float) -> None:
    """Let late sizes be others by a part; phases stay. `made` has them of sizes, and from where."""
    sizes = np.abs(phone.wave)
    begin = np.asarray(np.ceil(phone.at + LATE), np.int64)[:, None]
    by = made(sizes, begin) / np.maximum(sizes, 1e-9)
    phone.wave = phone.wave * (1 + min(part, 1.0) * phone.after(LATE) * (by - 1))


def late(sizes: Floats, begin: Integers) -> NDArray[np.bool_]:
    """Return which samples are not before `begin` [n, 1], [n, k]."""
    return np.asarray(np.arange(sizes.shape[1]) >= begin, np.bool_)


def late_mean(sizes: Floats, begin: Integers) -> Floats:
    """Return means of LASTS sizes [n, k] from `begin` [n, 1] on, [n, 1]."""
    there = late(sizes, begin) & ~late(sizes, begin + LASTS)
    return np.asarray((sizes * there).sum(axis=1) / there.sum(axis=1).clip(1))[:, None]


def by_steps(sizes: Floats, begin: Integers, step: Floats) -> Floats:
    """Return sizes [n, k] as a code has them that goes up or down by a step [n] (de Jager 1952)."""
    there, made = late(sizes, begin), sizes.copy()
    for k in range(1, sizes.shape[1]):
        gone = made[:, k - 1] + np.where(sizes[:, k] > made[:, k - 1], step, -step)
        made[:, k] = np.where(there[:, k], np.abs(gone), sizes[:, k])
    return made


def swapped(sizes: Floats, begin: Integers, unit: Floats) -> Floats:
    """Return sizes [n, k] as words of eight bits in units [n, 1] whose halves are swapped."""
    words = np.floor(sizes / unit).clip(0.0, 255.0)
    high, low = np.divmod(words, 16.0)
    return np.where(late(sizes, begin), (16 * low + high) * unit, sizes)


def switched(sizes: Floats, begin: Integers, over: Floats) -> Floats:
    """Return sizes [n, k], of which late ones over a size [n, 1] are read by a weaker channel."""
    return np.where(late(sizes, begin) & (sizes > over), WEAK * sizes, sizes)


def _by_steps(phone: Geophone, strength: float) -> None:
    """Leave late sizes as a code of steps up and down has them."""

    def made(sizes: Floats, begin: Integers) -> Floats:
        return by_steps(sizes, begin, STEP * late_mean(sizes, begin)[:, 0])

    _odd(phone, made, 0.5 * strength)


def _swapped(phone: Geophone, strength: float) -> None:
    """Write late sizes in words whose halves are swapped, some of it."""

    def made(sizes: Floats, begin: Integers) -> Floats:
        return swapped(sizes, begin, late_mean(sizes, begin) / WORD)

    _odd(phone, made, 0.1 * strength)


def _switched(phone: Geophone, strength: float) -> None:
    """Read strong late sizes by the weak channel, without what that lacks."""

    def made(sizes: Floats, begin: Integers) -> Floats:
        return switched(sizes, begin, SWITCHED * late_mean(sizes, begin))

    _odd(phone, made, strength)


WAVES: dict[str, Callable[[Geophone, float], None]] = {
    "obstructed-path": _cracks, "specular-reflections": _sides, "ground-bounce": _floor,
    "small-scale-fading": _fades, "diffuse-tail": _galleries, "pulse-ringing": _box,
    "noise-floor": _drills, "narrowband-interference": _leaky_feeder,
    IN_LATE_SIZES[0]: _by_steps, IN_LATE_SIZES[1]: _swapped, IN_LATE_SIZES[2]: _switched,
    "quantisation": _lattice, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows bear what they do once waves have been IN_THE_HALL, before props hear them."""
IN_THE_HALL = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the colliery's tables of ranges."""


def put_in(phone: Geophone, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what rows bear, and what geophones do."""
    hall = [name for name in IN_THE_HALL if name in names]
    last = [name for name in WAVES if name in names and name not in hall]
    for name in hall:
        WAVES[name](phone, strength)
    for name in sorted({*names} - {*WAVES}):
        phone.bear(EFFECTS[name](phone.tally(), strength))
    for name in last:
        WAVES[name](phone, strength)
