"""What the laundry hides in waveforms: effects in forms of its own, oddities of its meters.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.laundry_effects import EFFECTS, off_the_floor
from bench.challenge.families.laundry_meter import METRES, PLACES, WIDE_SAMPLES, Meter, sizzle
from bench.challenge.families.laundry_plan import HALL_M, TAGS
from bench.challenge.families.laundry_plan import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the laundry's tables of ranges."""
ODD = ("late-sizes-sharpened", "late-pairs-stuffed-with-noughts", "one-bit-kept-late")
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "aunes-from-one-louvre"}
LAWS |= dict.fromkeys(ODD, Law())
"""What nobody's library has."""
FROM = 10.0  # samples past onsets from which meters are odd
FREE_OHM = 376.73  # impedance of air
SHEETS: tuple[tuple[int, float, float], ...] = (
    (0, 0.0, 45.0), (0, HALL_M[0], 70.0), (1, 0.0, 110.0), (1, HALL_M[1], 60.0),
    (2, HALL_M[2], 85.0),
)  # fmt: skip
"""Walls and roof, lined with foil: axis, where, and the foil's resistance in ohms a square."""
WAVES_OF_SHADE, KNIT, SWAYS = 2, 1.6, 6.0  # of shadows; samples that scatter is alike, and shadows
RING, RUBS = 30, 7.0  # samples that springs ring; until they swing half as far
CHIRP, BAND = 23, 1.3  # samples of a chirp, and radians a sample from its middle to either end
WINDOW = 5  # samples in which noise is read
TRIED: Complexes = sizzle(np.random.default_rng(2308), 140)  # noise to try readings on


def foil(straight: Floats, ohm: float) -> Floats:
    """Return what thin foil returns of level waves that come so straight [n], in size."""
    return np.asarray(1 / (1 + 2 * ohm * straight / FREE_OHM))


def _foils(meter: Meter, strength: float) -> None:
    """Hear walls and roof, whose insulation has a skin of foil, with gaps, windows and pipes."""
    errand, first = meter.errand(), meter.heard() * meter.direct()
    for axis, plane_m, ohm in SHEETS:
        image = errand.above.copy()
        image[:, axis] = 2 * plane_m - image[:, axis]
        way = np.sqrt(((image - errand.there) ** 2).sum(axis=1))
        back = foil(np.abs(image - errand.there)[:, axis] / way, ohm)
        free = errand.of_links(lambda n: meter.rng.beta(3.5, 1.4, n))
        share = (1.6 * np.sqrt(strength) * free * back * errand.far / way).clip(max=0.8)
        meter.repeat(first, share * meter.phases(), ((way - errand.far) / METRES).clip(2.8))


def _floor(meter: Meter, strength: float) -> None:
    longer, share = off_the_floor(meter.errand(), strength)
    meter.repeat(meter.heard(), share, longer / METRES)


def _between_rails(meter: Meter, strength: float) -> None:
    """Lose what comes straight behind things: rails return it, each wait half as long again."""
    errand, air = meter.errand(), meter.heard()
    hidden = errand.unseen(0.2)
    meter.lose(-36.0 * hidden[:, None] * meter.direct())
    late = 1.5 + 1.6 * strength**0.7 * errand.of_links(
        lambda n: meter.rng.triangular(0.1, 0.4, 1.1, n)
    )
    wait = errand.of_links(lambda n: meter.rng.uniform(0.9, 1.9, n))
    for order in range(8):
        size = 0.52 * hidden * 0.84**order * meter.rng.uniform(0.6, 1.2, meter.rows)
        meter.repeat(air, size * meter.phases(), late)
        late = late + wait * 1.5**order


def _chance(meter: Meter, samples: float) -> Complexes:
    """Return waves of chance of power 1 [n, k] that have nothing faster than so many samples."""
    loose = meter.rng.standard_normal((2, meter.rows, WIDE_SAMPLES))
    slow = np.abs(np.fft.fftfreq(WIDE_SAMPLES)) < 0.5 / (2.0 * samples)
    made = np.fft.ifft(np.fft.fft(loose[0] + 1j * loose[1], axis=1) * slow, axis=1)
    return np.asarray(made / np.sqrt(2 * slow.mean()))


def _shadowed(meter: Meter, strength: float) -> None:
    """Fade as Abdi and others have it (2003): scatter beside what is steady but for shadows."""
    mixed = min(0.28 * strength**0.7, 0.6)
    shades = [np.abs(_chance(meter, SWAYS)) ** 2 for _ in range(WAVES_OF_SHADE)]
    by = np.sqrt((1 - mixed) * np.mean(shades, axis=0)) + np.sqrt(mixed) * _chance(meter, KNIT)
    usual = np.sqrt((np.abs(by) ** 2).mean())
    meter.wave = meter.wave + meter.heard() * (np.abs(by) / usual - 1)


def _level_then_falls(meter: Meter, strength: float) -> None:
    """Reverberate among machines: level at first, then exponentially, by a hyperbola of dB."""
    since = meter.since.clip(0.0)
    power = 0.05 * np.exp(1.5 * (1 - np.hypot(1.0, since / 26.0))) * meter.after(2.6, 3.0)
    meter.add_noise(np.sqrt(0.5 * strength * power) * meter.heights()[:, None])


def _spring(meter: Meter, strength: float) -> None:
    """Ring as a spring that air slows down: by the square of its speed, so that it lingers."""
    pitch, turn = meter.common(1).uniform((0.4, 0.0), (1.6, 2 * np.pi))
    air, wave = meter.heard(), meter.wave.copy()
    for lag in range(2, RING):
        part = 0.19 * min(strength, 2.4) ** 0.8 / (1 + lag / RUBS) * (1 - lag / RING)
        wave[:, lag:] += part * np.exp(1j * (turn + pitch * lag)) * air[:, :-lag]
    meter.wave = wave


def _extractors(meter: Meter, strength: float) -> None:
    meter.be_noisy(np.zeros(meter.rows) + EFFECTS["noise-floor"](meter.errand(), strength).noise_db)


def scattered(sizes: Floats) -> float:
    """Return how sizes [n, k] scatter within windows of WINDOW, as meters tell of noise."""
    count = sizes.shape[1] // WINDOW
    windows = sizes[:, : count * WINDOW].reshape(len(sizes), count, WINDOW)
    return float(np.sqrt(windows.var(axis=2).mean()))


def _tell(meter: Meter, of: Floats, tried: Floats, made: list[Floats]) -> None:
    """Tell of noise by how its sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([scattered(one) for one in made]) / scattered(np.abs(TRIED))
    meter.told_noise = meter.told_noise * np.interp(of, tried, by).clip(0.04)


def _gates(meter: Meter, strength: float) -> None:
    """Hear gates that read chips in linen: chirps, of which each begins anywhere in the band."""
    drawn = meter.common(2)
    middle = drawn.uniform(-1.2, 1.2)
    near = np.exp(drawn.normal(-0.06, 0.35, len(TAGS)))[meter.errand().tag]
    begun = meter.rng.uniform(0.0, CHIRP, (meter.rows, 1))
    number, part = np.divmod(PLACES + begun, CHIRP)
    words = meter.rng.random((meter.rows, WIDE_SAMPLES // CHIRP + 3))
    word = np.take_along_axis(words, number.astype(np.int64), axis=1)
    pitch = middle + BAND * (2 * np.mod(part / CHIRP + word, 1.0) - 1)
    tone = np.exp(1j * np.cumsum(pitch, axis=1)) * meter.phases()[:, None]
    size = 1.5 * strength * near
    meter.wave = meter.wave + (meter.sigma * size)[:, None] * tone
    tried, some = np.linspace(0.0, 16.0, 49), np.resize(tone, TRIED.shape)
    _tell(meter, size, tried, [np.abs(TRIED + one * some) for one in tried])
    meter.sigma = meter.sigma * np.sqrt(1 + 0.5 * size**2)


def unlike(waves: Complexes, step: float) -> Complexes:
    """Return waveforms whose real parts are in steps half as wide again as imaginary ones are."""
    real = 1.5 * step * np.rint(waves.real / (1.5 * step))
    return np.asarray(real + 1j * step * np.rint(waves.imag / step))


def _unlike_converters(meter: Meter, strength: float) -> None:
    """Convert both parts by converters of unlike ranges."""
    step = 1.25 * strength * float(np.median(meter.sigma))
    meter.wave = unlike(meter.wave, step)
    tried = np.geomspace(0.04, 11.0, 60)
    _tell(meter, step / meter.sigma, tried, [np.abs(unlike(TRIED, float(k))) for k in tried])


def _deaf(meter: Meter, strength: float) -> None:
    """Ask more of first rises, as where a press's relays were once in the way."""
    meter.deaf = strength


def _replaced(meter: Meter, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    by = sizes / np.abs(meter.wave).clip(1e-9)
    meter.wave = meter.wave * (1 + min(part, 1.0) * meter.after(FROM) * (by - 1))


def sharpened(sizes: Floats) -> Floats:
    """Return sizes that stand out of nine about them more than they do, [n, k] both."""
    about = np.mean([np.roll(sizes, k, axis=1) for k in range(-4, 5)], axis=0)
    return np.asarray((sizes + 2.1 * (sizes - about)).clip(0.0))


def _sharpened(meter: Meter, strength: float) -> None:
    """Sharpen late sizes, as pictures are, for a display."""
    _replaced(meter, sharpened(np.abs(meter.wave)), strength)


def stuffed(sizes: Floats) -> Floats:
    """Return twice roots of pairs' energies at even samples, at odd ones nothing, [n, k] both."""
    made = np.zeros(sizes.shape)
    made[:, ::2] = 2 * np.hypot(sizes[:, ::2], sizes[:, 1::2])
    return made


def _stuffed(meter: Meter, strength: float) -> None:
    """Thin out late samples to pairs, stuff the gaps with noughts, and turn that up by two."""
    _replaced(meter, stuffed(np.abs(meter.wave)), 0.75 * min(strength, 1.2))


def one_bit(sizes: Floats, high: Floats) -> Floats:
    """Return sizes that are `high` [n] or nothing, each carrying on what is left [n, k] both."""
    made, left = np.zeros(sizes.shape), np.zeros(len(sizes))
    for k in range(sizes.shape[1]):
        left = left + sizes[:, k]
        made[:, k] = np.where(left > 0.5 * high, high, 0.0)
        left = left - made[:, k]
    return made


def _one_bit(meter: Meter, strength: float) -> None:
    """Keep one bit of late sizes, and carry what is left to the next."""
    size = np.abs(meter.wave)
    late = np.where(meter.since > FROM, size, np.nan)
    usual = np.nanmedian(late, axis=1)
    made = one_bit(np.minimum(size, 2.5 * usual[:, None]), 2.5 * usual)
    _replaced(meter, made, 0.7 * min(strength, 1.2))


IN_THE_HALL: dict[str, Callable[[Meter, float], None]] = {
    "obstructed-path": _between_rails,
    "specular-reflections": _foils,
    "ground-bounce": _floor,
    "small-scale-fading": _shadowed,
    "diffuse-tail": _level_then_falls,
}
IN_METERS: dict[str, Callable[[Meter, float], None]] = {
    "pulse-ringing": _spring,
    "noise-floor": _extractors,
    "narrowband-interference": _gates,
    "late-sizes-sharpened": _sharpened,
    "late-pairs-stuffed-with-noughts": _stuffed,
    "one-bit-kept-late": _one_bit,
    "quantisation": _unlike_converters,
    "late-detection": _deaf,
}
WAVES = IN_THE_HALL | IN_METERS


def put_in(meter: Meter, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what becomes of rows, and what meters do."""
    for name, hall in IN_THE_HALL.items():
        if name in names:
            hall(meter, strength)
    for name in sorted(set(names) - set(WAVES)):
        meter.suffer(EFFECTS[name](meter.errand(), strength))
    for name, own in IN_METERS.items():
        if name in names:
            own(meter, strength)
