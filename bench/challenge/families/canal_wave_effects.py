"""What the ship lock hides in waveforms: effects in forms of its own, oddities of its staffs.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.canal_chamber import DAVITS, LOCK_M, Passage
from bench.challenge.families.canal_chamber import LAWS as LAWS_OF_ROWS
from bench.challenge.families.canal_effects import EFFECTS, off_the_floor
from bench.challenge.families.canal_staff import METRES, PLACES, WIDE_SAMPLES, Staff, swash
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
IN_LATE_SIZES = (
    "late-words-scrambled", "late-part-against-itself", "threes-lose-their-least",
)  # fmt: skip
LAWS = LAWS_OF_ROWS | {name: Law() for name in IN_LATE_SIZES}
del LAWS["roeden-from-one-davit"]
LATE = 7.0  # samples past first paths from which staffs are odd
WALLS: tuple[tuple[int, float, float, complex], ...] = (
    (0, 4.0, 7.4, 1e3j), (0, 52.5, 7.4, 1e3j), (0, 60.0, 11.0, 3.91), (1, 0.0, 6.2, 6.1),
    (1, 9.0, 6.2, 6.1), (1, -5.5, 9.5, 3.91), (1, 14.5, 12.5, 3.91),
)  # fmt: skip
"""Gates, a bridge's pier, copings' walls and sheds: axis, where, how high in m, permittivity."""
BOUNCES, LEFT = 7, 0.8  # between both walls; what each leaves
SLOW, RUSH = 30.0, 2.2  # samples for which two waves, and what is loose, are alike
PACE, STEEP = 8.0, 1.9  # samples; power by which tails fall past these
RING, BEAT, DIES = 28, 5.5, 14.0  # samples that lids ring; between beats; until e times less
HUM, AFLUTTER, SWELLS = 37.0, 0.14, 0.65  # samples of a hum; radians a sample; how far it swells
WINDOW = 5  # samples in which noise is read
BITS: Integers = np.array([8, 16, 32])  # of late words, that a register turns over
FEW = 3  # late sizes that lose their least
TRIED: Complexes = swash(np.random.default_rng(2508), 140)  # noise to try readings on


def fresnel(dense: complex, straight: Floats) -> Floats:
    """Return what walls return of waves that come so straight [n], in size, of both ways alike."""
    root = np.sqrt(dense - 1 + straight**2 + 0j)
    parts = [(a * straight - root) / (a * straight + root) for a in (1.0, dense)]
    return np.asarray(np.sqrt(np.mean(np.abs(parts) ** 2, axis=0)))


def by_a_wall(passage: Passage, axis: int, plane_m: float) -> tuple[Floats, Floats, Floats]:
    """Return ways by a wall in m, 0 where there is none, how high on it, and how straight [n]."""
    one, other = passage.afloat, passage.ashore
    off = np.stack([one[:, axis] - plane_m, other[:, axis] - plane_m])
    way = np.sqrt(passage.far**2 + 4 * (off[0] * off[1]).clip(0.0))
    part = np.abs(off[0]) / np.abs(off).sum(axis=0).clip(1e-6)
    high = one[:, 2] + part * (other[:, 2] - one[:, 2])
    return np.where(off[0] * off[1] > 0, way, 0.0), high, np.abs(off).sum(axis=0) / way


def _walls(staff: Staff, strength: float) -> None:
    """Hear gates of steel, walls of stone and of brick, where these are not behind things."""
    passage, direct = staff.passage(), staff.came() * staff.foremost()
    for axis, plane_m, high_m, dense in WALLS:
        way, high, straight = by_a_wall(passage, axis, plane_m)
        free = passage.each(lambda n: _bare(staff, n))
        back = 1.7 * np.sqrt(strength) * fresnel(dense, straight.clip(0.0, 1.0)) * free
        share = np.where((way > 0) & (high < high_m), back * passage.far / way.clip(1e-6), 0.0)
        late = ((way - passage.far) / METRES).clip(2.6)
        staff.return_(direct, share.clip(max=0.8) * staff.spun(), late)


def _bare(staff: Staff, count: int) -> Floats:
    """Return how much of walls is bare, by chance (Kumaraswamy 1980) [count]."""
    return np.asarray((1 - staff.rng.random(count) ** (1 / 1.5)) ** (1 / 3.0))


def _floor(staff: Staff, strength: float) -> None:
    longer, share = off_the_floor(staff.passage(), strength)
    staff.return_(staff.came(), share, longer / METRES)


def zigzags_m(far: Floats, bounces: int) -> Floats:
    """Return how much longer ways are that cross the chamber so many times, in m [n]."""
    return np.asarray(np.hypot(far, bounces * LOCK_M[1]) - far)


def _canyon(staff: Staff, strength: float) -> None:
    """Lose what comes straight behind things: what is left goes to and fro between both walls."""
    passage, air = staff.passage(), staff.came()
    hidden = passage.shut_off(0.2)
    staff.weaken(-36.0 * hidden[:, None] * staff.foremost())
    near = passage.each(lambda n: staff.rng.uniform(0.3, 0.7, n))
    for bounces in range(1, BOUNCES):
        late = near * zigzags_m(passage.far.clip(4.0, 24.0), bounces) * (0.4 + 0.6 * strength**0.7)
        loud = 0.7 * LEFT**bounces * staff.rng.triangular(0.5, 1.0, 1.2, staff.rows)
        staff.return_(air, hidden * loud * staff.spun(), 1.4 + late / METRES)


def _loose(staff: Staff, samples: float) -> Complexes:
    """Return waves of chance of power 1, alike for some samples [n, k]."""
    taps = np.hanning(2 * int(2 * samples) + 1)
    white = staff.rng.normal(size=(2, staff.rows, WIDE_SAMPLES + len(taps) - 1))
    long = white.shape[2]
    made = np.fft.ifft(
        np.fft.fft(white[0] + 1j * white[1], axis=1) * np.fft.fft(taps, long), axis=1
    )
    return np.asarray(made[:, len(taps) - 1 :] / np.sqrt(2 * (taps**2).sum()))


def _two_waves(staff: Staff, strength: float) -> None:
    """Fade as two waves do that pass each other, beside what is loose (Durgin and others 2002)."""
    loose = min(0.35 * strength**0.7, 0.7)
    other = min(0.55 * strength**0.5, 0.9)
    turn = np.angle(_loose(staff, SLOW)) + np.angle(staff.spun())[:, None]
    by = np.abs(1 + other * np.exp(1j * turn) + np.sqrt(2 * loose) * _loose(staff, RUSH))
    staff.wave = staff.wave + staff.came() * (by / np.sqrt((by**2).mean()) - 1)


def _power_law(staff: Staff, strength: float) -> None:
    """Reverberate between walls that lose ever less: by a power of how long it has been."""
    power = 0.062 * (1 + staff.since.clip(0.0) / PACE) ** -STEEP * staff.from_(2.4, 3.0)
    staff.hear(np.sqrt(0.5 * strength * power) * staff.tall()[:, None])


def _beats(staff: Staff, strength: float) -> None:
    """Ring as lids with two tones close to each other: now louder, now less."""
    pitch, turn, begun = staff.same(1).uniform((0.3, 0.0, 0.0), (1.5, 2 * np.pi, 0.9))
    lags = np.arange(RING)
    taps = 0.3 * min(strength, 2.4) ** 0.8 * np.exp(-lags / DIES) * (lags > 1)
    taps = taps * np.cos(np.pi * lags / BEAT - begun) * np.exp(1j * (turn + pitch * lags))
    air = np.pad(staff.came(), ((0, 0), (RING - 1, 0)))
    views = np.lib.stride_tricks.sliding_window_view(air, RING, axis=1)
    staff.wave = staff.wave + views @ taps[::-1]


def _pumps(staff: Staff, strength: float) -> None:
    staff.roar(EFFECTS["noise-floor"](staff.passage(), strength)["noise"] + np.zeros(staff.rows))


def read_noise(sizes: Floats) -> float:
    """Return how sizes [n, k] scatter within windows of WINDOW, as staffs tell of noise."""
    windows = np.lib.stride_tricks.sliding_window_view(sizes, WINDOW, axis=1)[:, ::WINDOW]
    return float(np.sqrt(windows.var(axis=-1).mean()))


def _tell(staff: Staff, of: Floats, tried: Floats, heard: Callable[[float], Complexes]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    found = [read_noise(np.abs(heard(float(one)))) for one in tried]
    by = np.interp(of, tried, np.array(found) / read_noise(np.abs(TRIED)))
    staff.by_noise = staff.by_noise * by.clip(0.04)


def _radiotelephone(staff: Staff, strength: float) -> None:
    """Hear a link of a tug's: a tone that swells with a hum, and whose phase walks about."""
    drawn = staff.same(2)
    pitch = drawn.uniform(-1.2, 1.2)
    near = np.exp(0.3 * drawn.normal(size=DAVITS))[staff.passage().davit]
    walk = np.cumsum(staff.rng.normal(0.0, AFLUTTER, (staff.rows, WIDE_SAMPLES)), axis=1)
    hum = np.cos(2 * np.pi * PLACES / HUM + np.angle(staff.spun(1)))
    tone = (1 + SWELLS * hum) / np.sqrt(1 + 0.5 * SWELLS**2) * np.exp(1j * (walk + pitch * PLACES))
    size, tone = 1.5 * strength * near, tone * staff.spun(1)
    staff.wave = staff.wave + (staff.sigma * size)[:, None] * tone
    some = np.resize(tone, TRIED.shape)
    _tell(staff, size, np.linspace(0.0, 16.0, 49), lambda one: TRIED + one * some)
    staff.sigma = staff.sigma * np.sqrt(1 + 0.5 * size**2)


def without_nought(waves: Complexes, step: float) -> Complexes:
    """Return waveforms both of whose parts are in the middles of steps, of which none is 0."""
    parts = [step * (np.floor(one / step) + 0.5) for one in (waves.real, waves.imag)]
    return np.asarray(parts[0] + 1j * parts[1])


def _without_nought(staff: Staff, strength: float) -> None:
    """Convert by a converter that has no nought."""
    step = 0.95 * strength * float(np.median(staff.sigma))
    staff.wave = without_nought(staff.wave, step)
    _tell(
        staff, step / staff.sigma, np.geomspace(0.05, 9.0, 60), lambda k: without_nought(TRIED, k)
    )


def _deaf(staff: Staff, strength: float) -> None:
    """Ask more of first tops, as where a siren once was in the way."""
    staff.deaf = strength


def _shown(staff: Staff, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    late = min(part, 1.0) * staff.from_(LATE)
    staff.wave = staff.wave * (1 - late + late * sizes / np.abs(staff.wave).clip(1e-9))


def register(count: int) -> Integers:
    """Return numbers below 8 that a shift register of seven bits runs through [count]."""
    made, state = [], 1
    for _ in range(count):
        state = (state << 1 | (state >> 6 ^ state >> 5) & 1) & 127
        made.append(state & 7)
    return np.array(made)


def scrambled(sizes: Floats, unit: Floats) -> Floats:
    """Return sizes in units [n], of whose words [n, k] a register turns some bits over."""
    words = np.rint(sizes / unit[:, None]).astype(np.int64)
    turned = (register(sizes.shape[1])[:, None] >> np.arange(3) & 1) @ BITS
    return np.asarray((words ^ turned) * unit[:, None], np.float64)


def _scrambled(staff: Staff, strength: float) -> None:
    """Leave late words as a scrambler made them that was to keep a bus from humming."""
    _shown(staff, scrambled(np.abs(staff.wave), staff.sigma / 9.0), 0.8 * strength)


def against_itself(sizes: Floats) -> Floats:
    """Return roots of how alike sizes are to themselves later on, as high as these [n, k]."""
    spectrum = np.fft.rfft(sizes, 2 * sizes.shape[1], axis=1)
    alike = np.fft.irfft(np.abs(spectrum) ** 2, axis=1)[:, : sizes.shape[1]]
    share = (alike / alike[:, :1].clip(1e-300)).clip(0.0)
    return np.asarray(np.sqrt(share) * sizes.max(axis=1, keepdims=True))


def _against_itself(staff: Staff, strength: float) -> None:
    """Show, of what is late, a function that was meant for finding periods."""
    begin = int(np.median(staff.at) + LATE)
    made = np.abs(staff.wave)
    made[:, begin:] = against_itself(made[:, begin:])
    _shown(staff, made, 0.9 * strength)


def without_least(sizes: Floats) -> Floats:
    """Return sizes less a fifth more than the least of each FEW, 0 at the least [n, k]."""
    whole = -sizes.shape[1] % FEW
    parts = np.pad(sizes, ((0, 0), (0, whole)), "edge").reshape(len(sizes), -1, FEW)
    made = (parts - 1.2 * parts.min(axis=2, keepdims=True)).clip(0.0).reshape(len(sizes), -1)
    return np.asarray(made[:, : sizes.shape[1]])


def _without_least(staff: Staff, strength: float) -> None:
    """Take the least of each three off late sizes, as if that were a floor."""
    _shown(staff, without_least(np.abs(staff.wave)), strength)


WAVES: dict[str, Callable[[Staff, float], None]] = {
    "obstructed-path": _canyon, "specular-reflections": _walls, "ground-bounce": _floor,
    "small-scale-fading": _two_waves, "diffuse-tail": _power_law, "pulse-ringing": _beats,
    "noise-floor": _pumps, "narrowband-interference": _radiotelephone,
    IN_LATE_SIZES[0]: _scrambled, IN_LATE_SIZES[1]: _against_itself,
    IN_LATE_SIZES[2]: _without_least, "quantisation": _without_nought, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows bear what they have to once waves have been AT_THE_LOCK, before staffs see them."""
AT_THE_LOCK = tuple(WAVES)[:5]
OF_RANGES = tuple(
    name for name in EFFECTS
    if name not in (*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding")
)  # fmt: skip
"""Effects that are those of the lock's tables of ranges."""


def put_in(staff: Staff, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is at the lock, what rows have to bear, and what staffs do."""
    hidden = [name for name in WAVES if name in names]
    early = [name for name in hidden if name in AT_THE_LOCK]
    for name in early:
        WAVES[name](staff, strength)
    for name in sorted({*names} - {*hidden}):
        staff.pay(EFFECTS[name](staff.passage(), strength))
    for name in hidden[len(early) :]:
        WAVES[name](staff, strength)
