"""What the velodrome hides in waveforms: effects in forms of its own, oddities of its cameras.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.velodrome_camera import METRES, WIDE_SAMPLES, Camera, humming
from bench.challenge.families.velodrome_effects import EFFECTS, eased, off_the_floor
from bench.challenge.families.velodrome_track import HALL_M, POSTS, Race
from bench.challenge.families.velodrome_track import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "odd-samples-of-the-frame-before", "tops-shaved-that-are-narrow", "pen-has-play-in-late-part",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["endazes-from-one-post"]
LATE = 8.0  # samples past first paths from which cameras are odd
SHEETS: tuple[tuple[int, float, float], ...] = (
    (0, 0.3, 0.62), (0, 71.7, 0.58), (1, 0.4, 0.66), (1, 53.6, 0.64), (2, HALL_M[2], 0.5),
)  # fmt: skip
"""Stands' backs of sheets and the roof: square to which axis, where, what they return at most."""
NEXT = 3.2  # samples past which sheets are heard
SPOKES = 16  # that what is out of sight comes round by
KNOTS = 5  # samples from one chance of fades to the next
FISK = 3.4  # of fades: the larger, the less they fade
RUSHES, STARTS, LEAVES = 30.0, 0.22, 2.5  # samples: tails run out; how soon; since when
STRING, SOFT = 6, 0.31  # samples of a string; what is handed on of either of two
BIT, TUNE = 7, 0.7  # samples of half a bit; radians a sample of its carrier
WINDOW = 5  # samples in which noise is read
BENT = 0.09  # by how much codes are wider with each sigma
PLAY = 0.3  # of late sizes' mean that a pen has play
SOME: Complexes = humming(np.random.default_rng(3306), 160)  # noise to try readings on


def by_sheet(race: Race, sheet: tuple[int, float, float]) -> tuple[Floats, Floats]:
    """Return ways in m by a sheet, and what it returns: the less, by a parabola, the straighter."""
    axis, where, share = sheet
    image = race.rider.copy()
    image[:, axis] = 2 * where - image[:, axis]
    way = np.linalg.norm(image - race.hears, axis=1)
    straight = np.abs(image - race.hears)[:, axis] / way
    return way, share * (1 - 0.4 * straight**2)


def _sheets(camera: Camera, strength: float) -> None:
    """Hear stands' backs and the roof, by images."""
    race, direct = camera.race(), camera.on_air() * camera.straight()
    for sheet in SHEETS:
        way, left = by_sheet(race, sheet)
        late = (way - race.far) / METRES
        bare = race.per_link(lambda n: camera.rng.beta(4.0, 2.0, n))
        share = 2.0 * np.sqrt(strength) * bare * left * race.far / way * (late > NEXT)
        camera.repeat(direct, np.minimum(share, 0.78) * camera.turned(), late)


def _floor(camera: Camera, strength: float) -> None:
    longer, share = off_the_floor(camera.race(), strength)
    camera.repeat(camera.on_air(), share, longer / METRES)


def _spokes(camera: Camera, strength: float) -> None:
    """Lose what comes straight behind things: it comes round by spokes of wheels, turn by turn.

    These are even round a wheel, so that ways by them crowd where they are shortest and longest.
    """
    race, air = camera.race(), camera.on_air()
    cut = race.hidden(0.2)
    camera.weaken(-33.0 * cut[:, None] * camera.straight())
    link, rng = race.per_link, camera.rng
    late = link(lambda n: rng.uniform(1.9, 3.0, n)) * (0.4 + 0.6 * strength**0.7)
    wide, turn = link(lambda n: rng.uniform(1.5, 5.0, n)), link(lambda n: rng.random(n))
    for k in range(SPOKES):
        round_ = 0.5 - 0.5 * np.cos(2 * np.pi * (k + turn) / SPOKES)
        size = 0.3 * cut * rng.rayleigh(0.6, camera.rows) * np.exp(-0.8 * round_)
        camera.repeat(air, size * camera.turned(), late + wide * round_)


def fisk(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes of chance of power 1 [rows, k]: log-logistic (Fisk 1961).

    Their logarithms are eased from knot to knot.
    """
    even = rng.uniform(0.004, 0.98, (rows, WIDE_SAMPLES // KNOTS + 2))
    logs = np.log(even / (1 - even)) / FISK
    knot, part = np.divmod(np.arange(WIDE_SAMPLES), KNOTS)
    by = eased(part / KNOTS)
    sizes = np.exp((1 - by) * logs[:, knot] + by * logs[:, knot + 1])
    return np.asarray(sizes / np.sqrt(np.mean(sizes**2)))


def _fades(camera: Camera, strength: float) -> None:
    """Fade among wheels: by Fisk's law; what comes straight, all of it alike."""
    size = fisk(camera.rng, camera.rows) ** min(strength**0.5, 1.6)
    straight = camera.straight()
    top = np.rint(camera.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)[:, None]
    size = straight * np.take_along_axis(size, top, axis=1) + (1 - straight) * size
    camera.wave = camera.wave + camera.on_air() * (size / np.sqrt(np.mean(size**2)) - 1)


def _stands(camera: Camera, strength: float) -> None:
    """Reverberate between stands, ever faster less: by Gompertz's law."""
    since = (camera.since - LEAVES).clip(0.0, 250.0)
    power = 0.014 * np.exp(-STARTS * np.expm1(since / RUSHES)) * camera.after(LEAVES)
    camera.add_noise(np.sqrt(0.5 * strength * power) * camera.height()[:, None])


def plucked(waves: Complexes, part: complex) -> Complexes:
    """Return what a string of STRING samples adds: what it has had, smoothed (Karplus, Strong)."""
    made = np.zeros_like(waves)
    for k in range(STRING + 1, waves.shape[1]):
        before = waves[:, k - STRING - 1 : k - STRING + 1] * part
        made[:, k] = SOFT * (before + made[:, k - STRING - 1 : k - STRING + 1]).sum(axis=1)
    return made


def _string(camera: Camera, strength: float) -> None:
    """Ring as a stay of the post does that waves pluck."""
    part = complex(0.8 * min(strength, 2.4) ** 0.8 * np.exp(2j * np.pi * camera.same(1).random()))
    camera.wave = camera.wave + plucked(camera.on_air(), part)


def _ignitions(camera: Camera, strength: float) -> None:
    noise_db = np.asarray(EFFECTS["noise-floor"](camera.race(), strength).noise_db)
    camera.drown(np.zeros(camera.rows) + noise_db)


def spread(waves: Complexes) -> float:
    """Return how sizes scatter in windows of WINDOW, as cameras tell of noise."""
    count = waves.shape[1] // WINDOW
    lots = np.abs(waves)[:, : count * WINDOW].reshape(len(waves), count, WINDOW)
    return float(np.sqrt(lots.var(axis=2, ddof=1).mean()))


def _tell(camera: Camera, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    by = [spread(made(float(one))) / spread(SOME) for one in tried]
    camera.told_noise = camera.told_noise * np.interp(of, tried, by).clip(0.04)


def split_bits(rng: np.random.Generator, rows: int) -> Complexes:
    """Return carriers of power 1, on for one half of each bit: which half is the bit [rows, k].

    That is Manchester's code, keyed on and off.
    """
    since = np.arange(WIDE_SAMPLES) + rng.integers(0, 2 * BIT, (rows, 1))
    half = since // BIT
    bits = rng.integers(0, 2, (rows, WIDE_SAMPLES // (2 * BIT) + 3))
    on = np.take_along_axis(bits, half // 2, axis=1) == half % 2
    start = rng.uniform(0.0, 2 * np.pi, (rows, 1))
    return np.asarray(np.sqrt(2.0) * on * np.exp(1j * (start + TUNE * np.arange(WIDE_SAMPLES))))


def _chips(camera: Camera, strength: float) -> None:
    """Hear a harmonic of riders' timing chips, which send bits in halves; at some posts more."""
    near = camera.same(2).beta(5.0, 5.0, POSTS) + 0.5
    size = 2.0 * strength * near[camera.race().post]
    camera.wave = camera.wave + (size * camera.sigma)[:, None] * split_bits(camera.rng, camera.rows)
    tone = split_bits(np.random.default_rng(3307), len(SOME))
    _tell(camera, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tone)
    camera.sigma = camera.sigma * np.sqrt(1 + size**2 / 2)


def bent(values: Floats, step: float | Floats, bends: float | Floats) -> Floats:
    """Return values in codes that are `step` wide at 0 and wider off it (mu-law, G.711)."""
    code = np.rint(np.log1p(bends * np.abs(values)) / (bends * step))
    return np.asarray(np.sign(values) * np.expm1(bends * step * code) / bends)


def _companded(camera: Camera, strength: float) -> None:
    """Convert by codes that are the wider the larger what they stand for is."""
    usual = float(np.median(camera.sigma))
    step, bends = 1.25 * strength * usual, BENT / usual
    both = (bent(one, step, bends) for one in (camera.wave.real, camera.wave.imag))
    camera.wave = np.asarray(next(both) + 1j * next(both))

    def tried(one: float) -> Complexes:
        part = BENT * one / (1.25 * strength)
        return np.asarray(bent(SOME.real, one, part) + 1j * bent(SOME.imag, one, part))

    _tell(camera, step / camera.sigma, np.geomspace(0.04, 14.0, 64), tried)


def _deaf(camera: Camera, strength: float) -> None:
    """Ask more of first tops, as where a bell once rang for the last lap."""
    camera.deaf = strength


def _odd(camera: Camera, made: Callable[[Floats, Integers], Floats], part: float) -> None:
    """Let late sizes be others by a part; phases stay. `made` has them of sizes, and from where."""
    sizes = np.abs(camera.wave)
    begin = np.asarray(np.ceil(camera.at + LATE), np.int64)[:, None]
    by = made(sizes, begin) / np.maximum(sizes, 1e-9)
    camera.wave = camera.wave * (1 + min(part, 1.0) * camera.after(LATE) * (by - 1))


def _since(sizes: Floats, begin: Integers) -> Integers:
    return np.asarray(np.arange(sizes.shape[1]) - begin, np.int64)


def interlaced(sizes: Floats, begin: Integers, before: Integers) -> Floats:
    """Return sizes [n, k] whose odd ones, from `begin` [n, 1] on, are of rows before [n]."""
    since = _since(sizes, begin)
    from_ = (begin[before] + since).clip(0, sizes.shape[1] - 1)
    other = np.take_along_axis(sizes[before], from_, axis=1)
    return np.where((since >= 0) & (since % 2 == 1), other, sizes)


def shaved(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k], from `begin` [n, 1] on the most of the least of three (Serra 1982)."""
    least = np.lib.stride_tricks.sliding_window_view(
        np.pad(sizes, ((0, 0), (1, 1)), mode="edge"), 3, axis=1
    ).min(axis=2)
    most = np.lib.stride_tricks.sliding_window_view(
        np.pad(least, ((0, 0), (1, 1)), mode="edge"), 3, axis=1
    ).max(axis=2)
    return np.where(_since(sizes, begin) >= 0, most, sizes)


def with_play(sizes: Floats, begin: Integers, play: Floats) -> Floats:
    """Return sizes [n, k] as a pen draws them, from `begin` [n, 1] on, that has some play [n]."""
    since, made = _since(sizes, begin), sizes.copy()
    for k in range(1, sizes.shape[1]):
        dragged = made[:, k - 1].clip(sizes[:, k] - play, sizes[:, k] + play)
        made[:, k] = np.where(since[:, k] >= 0, dragged, sizes[:, k])
    return made


def frames_before(table: pd.DataFrame) -> Integers:
    """Return which row of its link came before each; of first ones themselves [n]."""
    row = pd.Series(np.arange(len(table)))
    before = row.groupby(table["link"].to_numpy()).shift(1)
    return np.asarray(before.fillna(row), np.int64)


def _interlaced(camera: Camera, strength: float) -> None:
    """Show odd late samples of the frame before, as a line camera's halves."""
    before = frames_before(camera.table)
    _odd(camera, lambda sizes, begin: interlaced(sizes, begin, before), 0.9 * strength)


def _shaved(camera: Camera, strength: float) -> None:
    """Shave tops off late sizes that are narrower than a slit."""
    _odd(camera, shaved, 0.95 * strength)


def _play(camera: Camera, strength: float) -> None:
    """Draw late sizes by a pen that has play."""

    def made(sizes: Floats, begin: Integers) -> Floats:
        late = np.where(_since(sizes, begin) < 0, 0.0, sizes)
        play = 1.7 * PLAY * late.sum(axis=1) / (late > 0).sum(axis=1)
        return with_play(sizes, begin, play)

    _odd(camera, made, strength)


WAVES: dict[str, Callable[[Camera, float], None]] = {
    "obstructed-path": _spokes, "specular-reflections": _sheets, "ground-bounce": _floor,
    "small-scale-fading": _fades, "diffuse-tail": _stands, "pulse-ringing": _string,
    "noise-floor": _ignitions, "narrowband-interference": _chips,
    IN_LATE_SIZES[0]: _interlaced, IN_LATE_SIZES[1]: _shaved, IN_LATE_SIZES[2]: _play,
    "quantisation": _companded, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows bear what they do once waves have been IN_THE_HALL, before posts see them."""
IN_THE_HALL = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
)  # fmt: skip
"""Effects that are those of the velodrome's tables of ranges."""


def put_in(camera: Camera, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what rows bear, and what cameras do."""
    hall = [name for name in IN_THE_HALL if name in names]
    last = [name for name in WAVES if name in names and name not in hall]
    for name in hall:
        WAVES[name](camera, strength)
    for name in sorted({*names} - {*WAVES}):
        camera.bear(EFFECTS[name](camera.race(), strength))
    for name in last:
        WAVES[name](camera, strength)
