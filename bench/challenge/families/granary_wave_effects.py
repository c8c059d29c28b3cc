"""What the granary hides in waveforms: effects in forms of its own, oddities of its sieves.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.granary_bins import HALL_M, SPOUTS, Docket
from bench.challenge.families.granary_bins import LAWS as LAWS_OF_ROWS
from bench.challenge.families.granary_effects import EFFECTS, off_the_grain
from bench.challenge.families.granary_sieve import METRES, WIDE_SAMPLES, Sieve, pouring

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "eights-left-in-order-of-size", "late-sizes-evened-by-rank",
    "late-pairs-left-as-sums-and-differences",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["famnar-from-one-spout"]
LATE = 8.0  # samples past first paths from which sieves are odd
SIDES: tuple[tuple[int, float, complex], ...] = (
    (0, 0.0, 6.4 - 0.4j), (0, HALL_M[0], 6.4 - 0.4j), (1, 0.0, 3.91 - 0.2j),
    (1, HALL_M[1], 3.91 - 0.2j), (2, HALL_M[2] - 0.8, 2.1 - 0.1j),
)  # fmt: skip
"""Sides square to which axis, where, in m, and permittivities: of limestone, brick, and wood."""
NEXT = 3.4  # samples past which sides are heard
PIERS_M, OPEN = 5.4, 0.36  # from one window to the next; how much of that is window
CHINKS, APART = 7, 1.55  # ways through a bin; samples from one to the next
STEPS, KNOTS, STRAYS_RAD = 4, 6, 1.9  # waves of equal size; samples in which phases go so far
HUMP, PLANCKS = 0.013, 9.0  # of a tail, in power; samples that a unit of its curve is
ORDER, RIPPLE, LOW = 4, 0.22, 0.42  # of a filter; how narrow its ellipse is; radians a sample
FED, RINGS = 3, 90  # samples until filters are fed; how long they are looked at
LONG, ROOT, TUNE = 63, 25, 0.75  # of a sequence; which of these; radians a sample of its carrier
WINDOW = 8  # samples in which noise is read
EIGHT, LASTS = 8, 72  # late sizes in a row that are sorted; that ranks and means are of
SOME: Complexes = pouring(np.random.default_rng(3507), 160)  # noise to try readings on


def off_side(docket: Docket, side: tuple[int, float, complex]) -> tuple[Floats, Floats]:
    """Return ways in m by a side, and what it returns in size, [n] each.

    Waves stand upright: walls have them across (Fresnel), the roof along, and at one angle
    nothing (Brewster 1815).
    """
    axis, where, within = side
    image = docket.from_m.copy()
    image[:, axis] = 2 * where - image[:, axis]
    way = np.linalg.norm(image - docket.to_m, axis=1)
    sine = np.abs(image - docket.to_m)[:, axis] / way
    by = within if axis == 2 else 1.0
    root = np.sqrt(within - 1 + sine**2)
    return way, np.abs((by * sine - root) / (by * sine + root))


def on_stone(docket: Docket, side: tuple[int, float, complex]) -> Floats:
    """Return 1 where ways meet stone of a wall, 0 where a window, [n]; roofs have none."""
    axis, where, _ = side
    if axis == 2:
        return np.ones(docket.count)
    off = [np.abs(one[:, axis] - where) for one in (docket.from_m, docket.to_m)]
    part = off[0] / (off[0] + off[1])
    at = docket.from_m[:, 1 - axis] * (1 - part) + docket.to_m[:, 1 - axis] * part
    return np.asarray(np.mod(at / PIERS_M, 1.0) > OPEN, np.float64)


def _sides(sieve: Sieve, strength: float) -> None:
    """Hear walls between their windows, and the roof, by images."""
    docket, direct = sieve.docket(), sieve.arrived() * sieve.first_part()
    for side in SIDES:
        way, left = off_side(docket, side)
        late = (way - docket.far) / METRES
        bare = docket.per_link(lambda n: sieve.rng.uniform(0.5, 1.0, n)) * on_stone(docket, side)
        share = 2.4 * np.sqrt(strength) * bare * left * docket.far / way * (late > NEXT)
        sieve.again(direct, np.minimum(share, 0.78) * sieve.turns(), late)


def _floor(sieve: Sieve, strength: float) -> None:
    longer, share = off_the_grain(sieve.docket(), strength)
    sieve.again(sieve.arrived(), share, longer / METRES)


def catalan(count: int) -> Floats:
    """Return in how many of all walks one is back for the first time, by steps [count].

    After twice 1, 2 and so on steps, of which each is forth or back: Catalan's numbers.
    """
    made = np.cumprod([0.5, *((2 * k - 1) / (2 * k + 2) for k in range(1, count))])
    return np.asarray(made, np.float64)


def _chinks(sieve: Sieve, strength: float) -> None:
    """Lose what comes straight behind things: it walks to and fro in a bin until it is out."""
    docket, air = sieve.docket(), sieve.arrived()
    cut = docket.hidden_links(0.2)
    sieve.dim(-32.0 * cut[:, None] * sieve.first_part())
    link, rng = docket.per_link, sieve.rng
    late = link(lambda n: 2.2 + 1.2 * rng.beta(2.0, 2.0, n)) * (0.45 + 0.55 * strength**0.7)
    apart = APART * link(lambda n: rng.uniform(0.8, 1.25, n))
    for k, share in enumerate(np.sqrt(2 * catalan(CHINKS))):
        size = 0.4 * share * cut * np.sqrt(rng.gamma(2.0, 0.5, sieve.count))
        sieve.again(air, size * sieve.turns(), late + apart * k)


def walked(rng: np.random.Generator, rows: int) -> Complexes:
    """Return sums of STEPS waves of equal size, of power 1 (Pearson 1905) [rows, k].

    Their phases wander, by straight lines from knot to knot.
    """
    turns = rng.normal(0.0, STRAYS_RAD, (STEPS, rows, WIDE_SAMPLES // KNOTS + 2))
    turns[:, :, 0] = rng.uniform(-np.pi, np.pi, (STEPS, rows))
    knots = turns.cumsum(axis=2)
    knot, part = np.divmod(np.arange(WIDE_SAMPLES), KNOTS)
    turn = (1 - part / KNOTS) * knots[:, :, knot] + part / KNOTS * knots[:, :, knot + 1]
    return np.asarray(np.exp(1j * turn).sum(axis=0) / np.sqrt(STEPS))


def _fades(sieve: Sieve, strength: float) -> None:
    """Fade by a walk of a few equal steps; what comes straight, all of it alike."""
    size = np.abs(walked(sieve.rng, sieve.count)).clip(0.15) ** min(strength**0.5, 1.6)
    straight = sieve.first_part()
    top = np.rint(sieve.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)[:, None]
    size = straight * np.take_along_axis(size, top, axis=1) + (1 - straight) * size
    sieve.wave = sieve.wave + sieve.arrived() * (size / np.sqrt((size**2).mean()) - 1)


def planck(of: Floats) -> Floats:
    """Return Planck's curve (1900) of parts > 0, whose highest is 1 [...]."""
    return np.asarray(of**3 / np.expm1(of) / 1.4214354)


def _bins(sieve: Sieve, strength: float) -> None:
    """Reverberate among bins: it swells by a cube, and dies away, as black bodies shine."""
    since = (sieve.since - 2.0).clip(1e-3, 250.0)
    power = HUMP * planck(since / PLANCKS) * sieve.past(2.0)
    sieve.pour(np.sqrt(0.5 * strength * power) * sieve.high()[:, None])


def chebyshev() -> Complexes:
    """Return how a filter rings on whose poles are on an ellipse (Chebyshev) [RINGS].

    Of power 1, from FED samples on.
    """
    at = np.pi * (2 * np.arange(ORDER) + 1) / (2 * ORDER)
    poles = LOW * (-np.sinh(RIPPLE) * np.sin(at) + 1j * np.cosh(RIPPLE) * np.cos(at))
    apart = poles[:, None] - poles + np.eye(ORDER)
    parts = np.exp(poles[:, None] * np.arange(RINGS)) / apart.prod(axis=1)[:, None]
    made = np.append(np.zeros(FED), parts.sum(axis=0))[:RINGS].astype(np.complex128)
    return np.asarray(made / np.sqrt((np.abs(made) ** 2).sum()))


def rung(waves: Complexes) -> Complexes:
    """Return what a filter makes of waveforms [n, k]."""
    long = WIDE_SAMPLES + RINGS
    spectrum = np.fft.fft(waves, long, axis=1) * np.fft.fft(chebyshev(), long)
    return np.asarray(np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def _filter(sieve: Sieve, strength: float) -> None:
    """Ring as a filter of the spout's, whose edges are too steep."""
    part = 0.27 * min(strength, 2.4) ** 0.8 * np.exp(2j * np.pi * sieve.shared(1).random())
    sieve.wave = sieve.wave + part * rung(sieve.arrived())


def _mill(sieve: Sieve, strength: float) -> None:
    noise_db = np.asarray(EFFECTS["noise-floor"](sieve.docket(), strength).noise_db)
    sieve.roar(np.zeros(sieve.count) + noise_db)


def scattered(waves: Complexes) -> float:
    """Return how sizes scatter in windows of WINDOW, as sieves tell of noise."""
    count = waves.shape[1] // WINDOW
    lots = np.abs(waves[:, : count * WINDOW]).reshape(len(waves), count, WINDOW)
    return float(np.sqrt(lots.var(axis=2, ddof=1).mean()))


def _tell(sieve: Sieve, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    quiet = scattered(SOME)
    by = [scattered(made(float(one))) / quiet for one in tried]
    sieve.told_noise = sieve.told_noise * np.interp(of, tried, by).clip(0.04)


def zadoff(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers of size 1, whose phases are parabolas that begin anew (Chu 1972) [rows, k].

    Two samples for each of LONG places, each row from any of them.
    """
    since = np.arange(WIDE_SAMPLES) + rng.integers(0, 2 * LONG, (rows, 1))
    place = since // 2 % LONG
    turn = np.pi * ROOT * place * (place + 1) / LONG
    start = rng.uniform(0.0, 2 * np.pi, (rows, 1))
    return np.asarray(np.exp(1j * (start - turn + TUNE * np.arange(WIDE_SAMPLES))))


def _guidance(sieve: Sieve, strength: float) -> None:
    """Hear the sequence that a link for driverless tractors begins with; some spouts more."""
    near = sieve.shared(2).uniform(0.45, 1.55, SPOUTS)
    size = 1.9 * strength * near[sieve.docket().spout]
    sieve.wave = sieve.wave + (size * sieve.sigma)[:, None] * zadoff(sieve.rng, sieve.count)
    tone = zadoff(np.random.default_rng(3508), len(SOME))
    _tell(sieve, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tone)
    sieve.sigma = sieve.sigma * np.sqrt(1 + size**2 / 2)


def by_lot(waves: Complexes, step: float | Floats, rng: np.random.Generator) -> Complexes:
    """Return whole steps below or above both parts, the nearer ones the more often [n, k]."""
    lots = rng.random((2, *waves.shape))
    parts = [np.floor(one / step + lot) for one, lot in zip((waves.real, waves.imag), lots,
                                                            strict=True)]  # fmt: skip
    return np.asarray(step * (parts[0] + 1j * parts[1]))


def _by_lot(sieve: Sieve, strength: float) -> None:
    """Keep whole steps of both parts, up or down by lot."""
    step = 1.3 * strength * float(np.median(sieve.sigma))
    sieve.wave = by_lot(sieve.wave, step, sieve.rng)

    def made(one: float) -> Complexes:
        return by_lot(SOME, one, np.random.default_rng(3509))

    _tell(sieve, step / sieve.sigma, np.geomspace(0.04, 14.0, 64), made)


def _deaf(sieve: Sieve, strength: float) -> None:
    """Ask more of first sums, as where a hammer mill once was in the way."""
    sieve.deaf = strength


def in_order(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], of which each EIGHT in a row from `begin` [n] on are sorted."""
    made = sizes.copy()
    for row, first in enumerate(begin):
        count = (sizes.shape[1] - first) // EIGHT
        eights = sizes[row, first : first + count * EIGHT].reshape(count, EIGHT)
        made[row, first : first + count * EIGHT] = np.sort(eights, axis=1).ravel()
    return made


def evened(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], of which LASTS from `begin` [n] on go by ranks.

    Evenly, from nothing to twice their mean.
    """
    made = sizes.copy()
    for row, first in enumerate(begin):
        some = sizes[row, first : first + LASTS]
        rank = some.argsort().argsort()
        made[row, first : first + LASTS] = 2 * some.mean() * (rank + 0.5) / len(some)
    return made


def haar(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], of which pairs from `begin` [n] on are half sums, and differences."""
    made = sizes.copy()
    for row, first in enumerate(begin):
        pairs = sizes[row, first : first + (sizes.shape[1] - first) // 2 * 2].reshape(-1, 2)
        both = np.stack([pairs.mean(axis=1), np.abs(pairs[:, 0] - pairs[:, 1])], axis=1)
        made[row, first : first + both.size] = both.ravel()
    return made


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(sieve: Sieve, strength: float) -> None:
        sizes = np.abs(sieve.wave)
        by = made(sizes, np.ceil(sieve.at + LATE).astype(np.int64)) / np.maximum(sizes, 1e-9)
        sieve.wave = sieve.wave * (1 + min(most * strength, 1.0) * sieve.past(LATE) * (by - 1))

    return act


WAVES: dict[str, Callable[[Sieve, float], None]] = {
    "obstructed-path": _chinks, "specular-reflections": _sides, "ground-bounce": _floor,
    "small-scale-fading": _fades, "diffuse-tail": _bins, "pulse-ringing": _filter,
    "noise-floor": _mill, "narrowband-interference": _guidance,
    IN_LATE_SIZES[0]: _odd(in_order, 0.7), IN_LATE_SIZES[1]: _odd(evened, 0.9),
    IN_LATE_SIZES[2]: _odd(haar, 0.6), "quantisation": _by_lot, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows carry what they do once waves have been AMONG_BINS, before spouts hear them."""
AMONG_BINS = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the granary's tables of ranges."""


def put_in(sieve: Sieve, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is among bins, what rows carry, and what sieves do."""
    among = [name for name in AMONG_BINS if name in names]
    for name in among:
        WAVES[name](sieve, strength)
    for name in sorted({*names} - {*WAVES}):
        sieve.carry(EFFECTS[name](sieve.docket(), strength))
    for name in WAVES:
        if name in names and name not in among:
            WAVES[name](sieve, strength)
