"""What the ice rink hides in waveforms: effects in forms of its own, oddities of its timers.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.icerink_effects import EFFECTS, off_the_ice
from bench.challenge.families.icerink_rink import HALL_M, MULLIONS, PANE_M, Period
from bench.challenge.families.icerink_rink import LAWS as LAWS_OF_ROWS
from bench.challenge.families.icerink_timer import METRES, WIDE_SAMPLES, Timer, scraping

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "swept-gain-left-on", "late-words-left-as-exclusive-ors", "late-halves-riffled",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["lokte-from-one-mullion"]
LATE = 8.0  # samples past first paths from which timers are odd
SIDES: tuple[tuple[int, float, float], ...] = (
    (0, 0.3, 0.013), (0, HALL_M[0] - 0.3, 0.013), (1, 0.4, 0.021), (1, HALL_M[1] - 0.4, 0.021),
    (2, HALL_M[2] - 0.6, 0.006),
)  # fmt: skip
"""Sheets of steel and the roof's foil: square to which axis, where, and how uneven, in m."""
STEEL, NEXT = 0.88, 3.3  # what sheets return; samples past which these are heard
EDGES, OFF_M = 9, (0.9, 1.8)  # edges of panes; how far aside of the nearest, in m
ALIKE_FOR, SHAPES = 6, (2.2, 3.4)  # samples from chance to chance; of Fisher's and Snedecor's law
SOFT, DIES, TAIL = 6.0, 17.0, 0.031  # samples: a tail's rise and decay; its height, in power
COILS, FED, RINGS = 0.78, 3, 100  # radians a sample of a ladder; samples until it is fed; its last
SWINGS, TONE, TUNE = 1.6, 0.23, 0.8  # radians by which phases swing; radians a sample of both
WINDOW = 7  # samples in which noise is read
GAIN_DB, HIGHEST_DB = 0.16, 9.0  # a sample, and in all
WORD, HALF = 24.0, 34  # by which words count that a late mean has; samples of half a deck
SOME: Complexes = scraping(np.random.default_rng(3607), 160)  # noise to try readings on


def by_sheet(period: Period, side: tuple[int, float, float]) -> tuple[Floats, Floats]:
    """Return ways in m by a sheet, and what it returns in size, [n] each.

    Ribs of sheets are uneven: they return the less, the more squarely they are met (Rayleigh).
    """
    axis, where, uneven = side
    tag, mullion = period.ends
    image = tag.copy()
    image[:, axis] = 2 * where - tag[:, axis]
    way = np.linalg.norm(image - mullion, axis=1)
    sine = np.abs(image - mullion)[:, axis] / way
    return way, STEEL / (1 + (4 * np.pi * uneven * sine * 3.9936 / 0.299792458) ** 2)


def _sheets(timer: Timer, strength: float) -> None:
    """Hear sheets of the walls, and the roof's foil, by images."""
    period, direct = timer.period(), timer.by_air() * timer.straight()
    for side in SIDES:
        way, left = by_sheet(period, side)
        late = (way - period.far) / METRES
        bare = period.each_link(lambda n: timer.rng.beta(3.0, 1.5, n))
        share = 3.4 * np.sqrt(strength) * bare * left * period.far / way * (late > NEXT)
        timer.return_of(direct, np.minimum(share, 0.78) * timer.phases(), late)


def _ice(timer: Timer, strength: float) -> None:
    longer, share = off_the_ice(timer.period(), strength)
    timer.return_of(timer.by_air(), share, longer / METRES)


def past_edges_m(aside: Floats, far: Floats) -> Floats:
    """Return how much longer ways by edges of panes are, in m [EDGES, n].

    Edges are a pane apart, the nearest so far aside, amid a way so long.
    """
    off = aside + PANE_M * np.arange(EDGES)[:, None]
    return np.asarray(2 * np.hypot(0.5 * far, off) - far)


def _edges(timer: Timer, strength: float) -> None:
    """Lose what comes straight behind things: edges of panes bend it, ever farther aside.

    Each the less, by how far aside it is.
    """
    period, air = timer.period(), timer.by_air()
    cut = period.screened(0.2)
    timer.weaken(-32.0 * cut[:, None] * timer.straight())
    link, rng = period.each_link, timer.rng
    aside = link(lambda n: rng.uniform(*OFF_M, n))
    ways = past_edges_m(aside, link(lambda n: rng.uniform(9.0, 15.0, n)))
    first = link(lambda n: rng.uniform(2.0, 3.3, n)) * (0.45 + 0.55 * strength**0.7)
    for k, way in enumerate(ways):
        size = 0.62 * cut / (1 + k * PANE_M / aside) ** 0.75 * rng.weibull(2.2, timer.rows)
        timer.return_of(air, size * timer.phases(), first + (way - ways[0]) / METRES)


def snedecor(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance of power 1 [rows, k], whose powers are Fisher's and Snedecor's.

    What scatters is one gamma law, what shades another; straight in decibels from knot to knot.
    """
    knots = (rows, WIDE_SAMPLES // ALIKE_FOR + 2)
    power = rng.gamma(SHAPES[0], 1.0, knots) / rng.gamma(SHAPES[1], 1.0, knots)
    knot, part = np.divmod(np.arange(WIDE_SAMPLES), ALIKE_FOR)
    by, logs = part / ALIKE_FOR, np.log(power).clip(-5.0, 2.5)
    sizes = np.exp(0.5 * ((1 - by) * logs[:, knot] + by * logs[:, knot + 1]))
    return np.asarray(sizes / np.sqrt((sizes**2).mean()))


def _fades(timer: Timer, strength: float) -> None:
    """Fade amid skaters, who scatter and shade; what comes straight, all of it alike."""
    size = snedecor(timer.rng, timer.rows) ** min(0.85 * strength**0.5, 1.5)
    straight = timer.straight()
    top = np.rint(timer.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)[:, None]
    size = straight * np.take_along_axis(size, top, axis=1) + (1 - straight) * size
    timer.wave = timer.wave + timer.by_air() * (size / np.sqrt((size**2).mean()) - 1)


def softly(since: Floats) -> Floats:
    """Return a tail's power, whose highest is about 1, by samples since it began [...].

    It rises and dies away by exponentials, as IEEE 802.15.4a has it out of sight.
    """
    late = since.clip(0.0)
    return np.asarray(1.6 * -np.expm1(-late / SOFT) * np.exp(-late / DIES))


def _hall(timer: Timer, strength: float) -> None:
    """Reverberate in a hall of steel over ice: its tail rises softly before it dies away."""
    power = TAIL * softly(timer.since - 2.0) * timer.after(2.0)
    timer.scrape(np.sqrt(0.5 * strength * power) * timer.height()[:, None])


def bessel(order: int, of: Floats) -> Floats:
    """Return Bessel's function of an order of numbers [n]: a mean of cosines (Bessel 1824)."""
    turn = np.pi * (np.arange(200) + 0.5) / 200
    return np.asarray(np.cos(order * turn - of[:, None] * np.sin(turn)).mean(axis=1))


def ladder() -> Floats:
    """Return how an endless ladder of coils rings, from FED samples on, of power 1 [RINGS]."""
    since = (np.arange(RINGS) - FED).clip(0.0)
    made = np.where(np.arange(RINGS) > FED, bessel(1, COILS * since) / since.clip(0.5) ** 0.5, 0.0)
    made = made * np.exp(-since / 22.0)
    return np.asarray(made / np.sqrt((made**2).sum()))


def rung(waves: Complexes) -> Complexes:
    """Return what a ladder of coils makes of waveforms [n, k]."""
    long = WIDE_SAMPLES + RINGS
    spectrum = np.fft.fft(waves, long, axis=1) * np.fft.fft(ladder(), long)
    return np.asarray(np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def _ladder(timer: Timer, strength: float) -> None:
    """Ring as a ladder of coils in a mullion does, which is to hold off the chillers' surges."""
    part = 0.26 * min(strength, 2.4) ** 0.8 * np.exp(2j * np.pi * timer.common(1).random())
    timer.wave = timer.wave + part * rung(timer.by_air())


def _chillers(timer: Timer, strength: float) -> None:
    noise_db = np.asarray(EFFECTS["noise-floor"](timer.period(), strength).noise_db)
    timer.drown(np.zeros(timer.rows) + noise_db)


def spread(waves: Complexes) -> float:
    """Return how sizes scatter in windows of WINDOW, as timers tell of noise."""
    count = waves.shape[1] // WINDOW
    lots = np.abs(waves)[:, : count * WINDOW].reshape(-1, WINDOW)
    return float(np.sqrt(lots.var(axis=1, ddof=1).mean()))


def _tell(timer: Timer, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([spread(made(float(one))) for one in tried]) / spread(SOME)
    timer.noise_by = timer.noise_by * np.interp(of, tried, by).clip(0.04)


def whistled(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers of size 1 whose phases a tone swings, from any phase of both [rows, k]."""
    place = np.arange(WIDE_SAMPLES)
    start = rng.uniform(0.0, 2 * np.pi, (2, rows, 1))
    return np.asarray(np.exp(1j * (start[0] + TUNE * place + SWINGS * np.sin(
        start[1] + TONE * place))))  # fmt: skip


def _referees(timer: Timer, strength: float) -> None:
    """Hear a harmonic of the referees' radio, whose carrier a voice swings; some mullions more."""
    near = timer.common(2).triangular(0.4, 0.9, 1.7, MULLIONS)
    size = 1.9 * strength * near[timer.period().mullion]
    timer.wave = timer.wave + (size * timer.sigma)[:, None] * whistled(timer.rng, timer.rows)
    tone = whistled(np.random.default_rng(3608), len(SOME))
    _tell(timer, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tone)
    timer.sigma = timer.sigma * np.sqrt(1 + size**2 / 2)


def cut_off(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of whose parts whole steps are kept, and the rest is cut off [n, k]."""
    return np.asarray(step * (np.trunc(waves.real / step) + 1j * np.trunc(waves.imag / step)))


def _cut_off(timer: Timer, strength: float) -> None:
    """Keep whole steps of both parts, as who drops the lowest bits of a sign and a size."""
    step = 0.95 * strength * float(np.median(timer.sigma))
    timer.wave = cut_off(timer.wave, step)
    _tell(timer, step / timer.sigma, np.geomspace(0.04, 14.0, 64), lambda one: cut_off(SOME, one))


def _deaf(timer: Timer, strength: float) -> None:
    """Ask more of first tops, as where the hooter was once too near."""
    timer.deaf = strength


def swept(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that are turned up from `begin` [n] on, as sonars do, up to a limit."""
    since = (np.arange(sizes.shape[1]) - begin[:, None]).clip(0)
    return np.asarray(sizes * 10 ** (np.minimum(GAIN_DB * since, HIGHEST_DB) / 20))


def late_means(sizes: Floats, begin: Integers) -> Floats:
    """Return means of sizes from `begin` [n] on, over two halves of a deck [n]."""
    return np.array([one[k : k + 2 * HALF].mean() for one, k in zip(sizes, begin, strict=True)])


def exclusive(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] as words of eight bits, from `begin` [n] on each against the last's.

    So they are packed, as bits that are alike are nought.
    """
    unit = late_means(sizes, begin)[:, None] / WORD
    words = np.floor(sizes / unit).clip(0, 255).astype(np.int64)
    against = words.copy()
    against[:, 1:] ^= words[:, :-1]
    late = np.arange(sizes.shape[1]) > begin[:, None]
    return np.asarray(np.where(late, against * unit, sizes))


def riffled(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] of which two halves of a deck from `begin` [n] on are riffled."""
    made = sizes.copy()
    for row, first in enumerate(begin):
        deck = sizes[row, first : first + 2 * HALF]
        half = len(deck) // 2
        made[row, first : first + 2 * half : 2] = deck[:half]
        made[row, first + 1 : first + 2 * half : 2] = deck[half : 2 * half]
    return made


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(timer: Timer, strength: float) -> None:
        sizes = np.abs(timer.wave)
        begin = np.ceil(timer.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 2 * HALF)
        by = made(sizes, begin) / np.maximum(sizes, 1e-9)
        part = min(most * strength, 1.0) * timer.after(LATE)
        timer.wave = timer.wave * (1 + part * (by - 1))

    return act


WAVES: dict[str, Callable[[Timer, float], None]] = {
    "obstructed-path": _edges, "specular-reflections": _sheets, "ground-bounce": _ice,
    "small-scale-fading": _fades, "diffuse-tail": _hall, "pulse-ringing": _ladder,
    "noise-floor": _chillers, "narrowband-interference": _referees,
    IN_LATE_SIZES[0]: _odd(swept, 0.5), IN_LATE_SIZES[1]: _odd(exclusive, 0.4),
    IN_LATE_SIZES[2]: _odd(riffled, 0.5), "quantisation": _cut_off, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows get what they do once waves have been IN_THE_HALL, before mullions hear them."""
IN_THE_HALL = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the ice rink's tables of ranges."""


def put_in(timer: Timer, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what rows get, and what timers do."""
    hall = [name for name in IN_THE_HALL if name in names]
    for name in hall:
        WAVES[name](timer, strength)
    for name in sorted({*names} - {*WAVES}):
        timer.mark(EFFECTS[name](timer.period(), strength))
    for name in WAVES:
        if name in names and name not in hall:
            WAVES[name](timer, strength)
