"""What the saw mill hides in waveforms: effects in forms of its own, oddities of its decoders.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.sawmill_decoder import AT, METRES, WIDE_SAMPLES, Decoder, rasp
from bench.challenge.families.sawmill_effects import EFFECTS, PLATES, off_the_ground
from bench.challenge.families.sawmill_yard import BRACES, HALL_M, WAVE_M
from bench.challenge.families.sawmill_yard import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the saw mill's tables of ranges."""
ODD = ("largest-of-five-shown", "eights-left-as-walsh", "sums-begun-anew-each-dozen")
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "yards-from-one-brace"}
LAWS |= dict.fromkeys(ODD, Law())
"""What nobody's library has."""
FROM = 10.0  # samples past onsets from which decoders are odd
RIBS_M = 0.016  # half as high as ribs of steel sheets are
MODES, GUIDE = 9, 10.4  # between boards; as which mode nothing goes any more
RUBS = 26.0  # samples until friction has stopped a blade
SIZES = np.array([-7.0, -5.0, -3.0, -1.0, 1.0, 3.0, 5.0, 7.0]) / np.sqrt(21.0)
PILOT, SYMBOL = 0.45, 6.0  # of a camera's link: a steady part; samples a symbol
WINDOW = 6  # samples in which noise is read
TRIED: Complexes = rasp(np.random.default_rng(2208), 140)  # noise to try readings on


def bessel(of: Floats) -> Floats:
    """Return Bessel's J of order 0 [n]: the mean of what a sine's ribs add up to."""
    turn = np.pi * (np.arange(48) + 0.5) / 48
    return np.asarray(np.cos(of[:, None] * np.sin(turn)).mean(axis=1))


def _ribbed(decoder: Decoder, strength: float) -> None:
    """Hear the hall's sides and roof and fronts of kilns, all of ribbed steel (Rayleigh 1907).

    Only what is met between both ends, of what both ends of a way are before.
    """
    stint, first = decoder.stint(), decoder.aloft() * decoder.straight()
    for axis, plane_m, (begin_m, end_m), _ in (*PLATES[:5], (2, HALL_M[4], HALL_M[:2], 0.0)):
        off = [end[:, axis] - plane_m for end in (stint.there, stint.fixed)]
        part = off[0] / np.where(np.abs(off[0] + off[1]) < 1e-6, 1e-6, off[0] + off[1])
        across = 1 if axis == 0 else 0
        met = (1 - part) * stint.there[:, across] + part * stint.fixed[:, across]
        meets = (off[0] * off[1] > 0) & (met > begin_m) & (met < end_m)
        way = np.sqrt(stint.far**2 + 4 * np.abs(off[0] * off[1]))
        straight = np.abs(off[0] + off[1]) / way
        back = np.abs(bessel(4 * np.pi * RIBS_M / WAVE_M * straight))
        free = stint.by_link(lambda n: decoder.rng.beta(3.0, 1.2, n))
        size = meets * (1.25 * np.sqrt(strength) * free * back * stint.far / way).clip(max=0.8)
        decoder.again(first, size * decoder.turns(), ((way - stint.far) / METRES).clip(2.8))


def _ground(decoder: Decoder, strength: float) -> None:
    longer, share = off_the_ground(decoder.stint(), strength)
    decoder.again(decoder.aloft(), share, longer / METRES)


def _between_boards(decoder: Decoder, strength: float) -> None:
    """Lose what comes straight behind stacks: it is guided between boards, high modes slower."""
    stint, air = decoder.stint(), decoder.aloft()
    hidden = stint.out_of_sight(0.2)
    decoder.dim(-36.0 * hidden[:, None] * decoder.straight())
    soonest = 1.4 + 1.5 * strength**0.7 * stint.by_link(
        lambda n: decoder.rng.triangular(0.1, 0.4, 1.1, n)
    )
    long = stint.by_link(lambda n: decoder.rng.uniform(14.0, 30.0, n))
    for mode in range(1, MODES):
        slower = 1 / np.sqrt(1 - (mode / GUIDE) ** 2) - 1
        size = 0.5 * hidden / mode**0.45 * decoder.rng.uniform(0.6, 1.2, decoder.n)
        decoder.again(air, size * decoder.turns(), soonest + long * slower)


def _sway(decoder: Decoder, samples: float) -> Complexes:
    """Return waves of chance of power 1 [n, k], alike over so many samples: moving means."""
    long = int(6 * samples)
    taps = np.exp(-0.5 * ((np.arange(long) - 0.5 * long) / samples) ** 2)
    loose = decoder.rng.standard_normal((2, decoder.n, WIDE_SAMPLES))
    spectrum = np.fft.fft(loose[0] + 1j * loose[1], axis=1) * np.fft.fft(taps, WIDE_SAMPLES)
    return np.asarray(np.fft.ifft(spectrum, axis=1) / np.sqrt(2 * (taps**2).sum()))


def _in_two_states(decoder: Decoder, strength: float) -> None:
    """Fade as Lutz has it (1991): steady beside waves of chance, or these alone, and weaker."""
    mixed = min(0.16 * strength**0.7, 0.6)
    good = np.sqrt(1 - mixed) + np.sqrt(mixed) * _sway(decoder, 1.7)
    bad = 0.7 * _sway(decoder, 1.7)
    seldom = 0.18 * min(strength, 2.4) ** 0.5
    is_bad = np.abs(_sway(decoder, 3.6)) ** 2 < -np.log1p(-seldom)
    by = np.where(is_bad, bad, good)
    usual = np.sqrt((np.abs(by) ** 2).mean())
    decoder.wave = decoder.wave + decoder.aloft() * (np.abs(by) / usual - 1)


def _any_rate(decoder: Decoder, strength: float) -> None:
    """Reverberate among stacks that take waves at any rate, from fast to slow, as many of each."""
    since = (decoder.since - 2.5).clip(0.2)
    power = (np.exp(-since / 58.0) - np.exp(-since / 5.0)) / since
    power = 0.62 * power * decoder.past(2.5, 3.0)
    decoder.add_noise(np.sqrt(0.5 * strength * power) * decoder.heights()[:, None])


def _blade(decoder: Decoder, strength: float) -> None:
    """Ring as a blade of steel between guides of wood, which rub: it slows down by a line."""
    begun, pitch = decoder.shared(1).uniform((2.0, 0.35), (3.6, 1.5))
    air, wave = decoder.aloft(), decoder.wave.copy()
    for lag in range(2, int(RUBS)):
        part = 0.19 * min(strength, 2.4) ** 0.8 * (1 - lag / RUBS) * np.clip(lag - begun, 0, 1)
        wave[:, lag:] += part * np.exp(1j * pitch * lag) * air[:, :-lag]
    decoder.wave = wave


def _gang_saw(decoder: Decoder, strength: float) -> None:
    db = EFFECTS["noise-floor"](decoder.stint(), strength).noise_db
    decoder.rouse(np.ones(decoder.n) * db)


def spread(sizes: Floats) -> float:
    """Return how sizes [n, k] scatter within windows of WINDOW, as decoders tell of noise."""
    count = sizes.shape[1] // WINDOW * WINDOW
    windows = sizes[:, :count].reshape(len(sizes), -1, WINDOW)
    return float(np.sqrt(windows.var(axis=2).mean()))


def _read(decoder: Decoder, of: Floats, tried: Floats, made: list[Floats]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    wide = np.array([spread(one) for one in made]) / spread(np.abs(TRIED))
    decoder.noise_by = decoder.noise_by * np.interp(of, tried, wide).clip(0.04)


def _camera(decoder: Decoder, strength: float) -> None:
    """Hear a camera's link: a pilot, and a part of eight sizes, another with each symbol."""
    drawn = decoder.shared(2)
    pitch, near = drawn.uniform(-1.6, 1.6), drawn.weibull(2.2, BRACES)
    count = int(WIDE_SAMPLES / SYMBOL) + 3
    words = SIZES[decoder.rng.integers(8, size=(decoder.n, count))]
    at = AT / SYMBOL + decoder.rng.random((decoder.n, 1))
    now, part = at.astype(np.int64), 0.5 - 0.5 * np.cos(np.pi * (at % 1))
    one, other = (np.take_along_axis(words, now + k, axis=1) for k in (0, 1))
    sent = np.sqrt(1 - PILOT**2) * ((1 - part) * one + part * other) + PILOT
    tone = sent * np.exp(1j * pitch * AT) * decoder.turns()[:, None]
    tone = tone / np.sqrt((np.abs(tone) ** 2).mean())
    size = 1.55 * strength * near[decoder.stint().brace]
    decoder.wave = decoder.wave + (decoder.sigma * size)[:, None] * tone
    tried, some = np.linspace(0.0, 16.0, 49), np.resize(tone, TRIED.shape)
    _read(decoder, size, tried, [np.abs(TRIED + one * some) for one in tried])
    decoder.sigma = decoder.sigma * np.sqrt(1 + 0.5 * size**2)


def by_turns(waves: Complexes, step: float) -> Complexes:
    """Return waveforms in whole steps at even samples, and in twice as wide ones at odd ones."""
    steps = step * (1 + np.arange(waves.shape[1]) % 2)
    parts = waves / steps
    return np.asarray(steps * (np.rint(parts.real) + 1j * np.rint(parts.imag)))


def _two_converters(decoder: Decoder, strength: float) -> None:
    """Convert by two converters in turn, of which one has a bit less."""
    step = 1.05 * strength * float(np.median(decoder.sigma))
    decoder.wave = by_turns(decoder.wave, step)
    tried = np.geomspace(0.04, 11.0, 60)
    _read(decoder, step / decoder.sigma, tried, [np.abs(by_turns(TRIED, float(k))) for k in tried])


def _dull(decoder: Decoder, strength: float) -> None:
    """Ask more of first pulses, as where a saw's sparks were once in the way."""
    decoder.dull = strength


def _shown(decoder: Decoder, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    now = np.abs(decoder.wave).clip(1e-9)
    decoder.wave = decoder.wave * (1 + min(part, 1.0) * decoder.past(FROM) * (sizes / now - 1))


def _largest(decoder: Decoder, strength: float) -> None:
    """Show the largest of five late sizes for the middle one."""
    size = np.abs(decoder.wave)
    _shown(decoder, np.max([np.roll(size, k, axis=1) for k in range(-2, 3)], axis=0), strength)


def walsh(sizes: Floats) -> Floats:
    """Return what Walsh's steps (1923) make of eights of sizes, halved once, [n, k] both."""
    count = sizes.shape[1] // 8 * 8
    eights = sizes[:, :count].reshape(len(sizes), -1, 8)
    two = np.array([[1.0, 1.0], [1.0, -1.0]])
    steps = np.kron(two, np.kron(two, two)) / 2.0
    made = np.abs(eights @ steps.T).reshape(len(sizes), -1)
    return np.asarray(np.concatenate([made, sizes[:, count:]], axis=1))


def _walsh(decoder: Decoder, strength: float) -> None:
    """Leave late sizes as what packing makes of eights of them: Walsh's steps."""
    _shown(decoder, walsh(np.abs(decoder.wave)), 0.8 * min(strength, 1.0))


def begun_anew(sizes: Floats) -> Floats:
    """Return sums of sizes since each dozen of samples begins, by roots of counts, [n, k] both."""
    made = sizes.copy()
    for k in range(sizes.shape[1]):
        made[:, k] = sizes[:, k - k % 12 : k + 1].sum(axis=1) / np.sqrt(k % 12 + 1.0)
    return made


def _dozens(decoder: Decoder, strength: float) -> None:
    """Show sums of late sizes, which begin anew with every dozen of samples."""
    _shown(decoder, begun_anew(np.abs(decoder.wave)), 0.6 * min(strength, 1.0))


IN_THE_MILL: dict[str, Callable[[Decoder, float], None]] = {
    "obstructed-path": _between_boards,
    "specular-reflections": _ribbed,
    "ground-bounce": _ground,
    "small-scale-fading": _in_two_states,
    "diffuse-tail": _any_rate,
}
IN_DECODERS: dict[str, Callable[[Decoder, float], None]] = {
    "pulse-ringing": _blade,
    "noise-floor": _gang_saw,
    "narrowband-interference": _camera,
    "largest-of-five-shown": _largest,
    "eights-left-as-walsh": _walsh,
    "sums-begun-anew-each-dozen": _dozens,
    "quantisation": _two_converters,
    "late-detection": _dull,
}
WAVES = IN_THE_MILL | IN_DECODERS


def put_in(decoder: Decoder, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the mill, what becomes of rows, and what decoders do."""
    for name in (one for one in IN_THE_MILL if one in names):
        IN_THE_MILL[name](decoder, strength)
    for name in sorted(one for one in names if one not in WAVES):
        decoder.take(EFFECTS[name](decoder.stint(), strength))
    for name in (one for one in IN_DECODERS if one in names):
        IN_DECODERS[name](decoder, strength)
