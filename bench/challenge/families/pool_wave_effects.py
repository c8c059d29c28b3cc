"""What the swimming hall hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.pool_basin import BEACONS_M
from bench.challenge.families.pool_basin import LAWS as RANGE_LAWS
from bench.challenge.families.pool_effects import EFFECTS, WALLS, image_m, water_ray
from bench.challenge.families.pool_tap import METRES, WIDE_SAMPLES, Tap, delayed, hum

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "time-lag",
)  # fmt: skip
"""Effects that are those of the hall's tables of ranges."""
ODD = ("taps-lost", "carrier-leaks", "late-half-slips")
LAWS = {
    **{name: law for name, law in RANGE_LAWS.items() if law.forms and "unit" not in law.forms},
    **{name: Law() for name in ODD},
}
"""What nobody's library has."""


def _lamps(tap: Tap, strength: float) -> None:
    tap.hiss(EFFECTS["noise-floor"](tap.swims(), strength).hiss * np.ones(len(tap.table)))


def _resonates(tap: Tap, strength: float) -> None:
    """Ring as a resonator that every pulse strikes: decaying, off the carrier by some MHz."""
    pole = 0.86 * np.exp(1j * tap.kept(1).choice([-1.0, 1.0]) * 0.5)
    taps = np.zeros(WIDE_SAMPLES, np.complex128)
    taps[3:60] = 0.12 * min(strength, 2.5) * pole ** np.arange(57)
    spectrum = np.fft.fft(taps, 2 * WIDE_SAMPLES)
    rung = np.fft.ifft(np.fft.fft(tap.there(), 2 * WIDE_SAMPLES, axis=1) * spectrum, axis=1)
    tap.waves = tap.waves + rung[:, :WIDE_SAMPLES]


def _tiled_walls(tap: Tap, strength: float) -> None:
    """Reverberate between hard walls: by a power law at first, that absorption ends."""
    after = np.maximum(tap.since - 3.5, 0)
    power = strength * 0.022 * (1 + after / 9) ** -0.8 * np.exp(-after / 65) * (after > 0)
    lumpy = tap.rng.gamma(2.0, 0.5, power.shape)
    tap.waves = tap.waves + tap.crest()[:, None] * np.sqrt(power / 2 * lumpy) * hum(
        tap.rng, len(power)
    )


def _all_images(tap: Tap, strength: float) -> None:
    """Hear walls and the ceiling, each by its own coefficient; pillars hide one now and then."""
    swims, heard = tap.swims(), tap.there() * (tap.since < 7)
    size = np.min([0.75 * strength**0.5, 0.95]) * tap.kept(2).uniform(0.5, 1.0, len(WALLS))
    for (axis, wall), returned in zip(WALLS, size, strict=True):
        way = image_m(swims.swum(), swims.hung(), axis, wall)
        open_ = swims.by_link(lambda n: 1.0 * (tap.rng.random(n) < 0.85))
        echo = returned * open_ * swims.far / way * tap.phases()
        tap.waves = tap.waves + echo[:, None] * delayed(heard, (way - swims.far) / METRES)


def _hopping_tone(tap: Tap, strength: float) -> None:
    """Hear a transmitter that hops between four frequencies, louder at some beacons."""
    hops = tap.kept(3).uniform(-0.4, 0.4, 4)
    near = tap.kept(4).uniform(0.5, 1.5, len(BEACONS_M))[tap.swims().number("rx")]
    loud = 1.5 * strength * near
    turns = hops[tap.rng.integers(0, 4, len(near))][:, None] * np.arange(WIDE_SAMPLES)
    tone = (loud * tap.sigma * tap.phases())[:, None] * np.exp(2j * np.pi * turns)
    tap.waves = tap.waves + tone
    tap.noisier = tap.noisier * _spread(loud) / _spread(0 * loud)
    tap.sigma = tap.sigma * np.sqrt(1 + np.square(loud) / 2)


def _spread(loud: Floats) -> Floats:
    """Return how sizes of noise scatter beside a tone of such a size [n], by trial."""
    noise = np.random.default_rng(743).normal(size=(8000, 2)) @ [1, 1j]
    tried = np.linspace(0, 12, 61)
    return np.asarray(np.interp(loud, tried, [np.abs(noise + one).std() for one in tried]))


def _under_water(tap: Tap, strength: float) -> None:
    """Lose, on some links, the way through a body under water: what goes around it comes later."""
    swims, heard = tap.swims(), tap.there()
    sunk = swims.by_link(lambda n: 1.0 * (tap.rng.random(n) < 0.22))[:, None]
    late = swims.by_link(lambda n: tap.rng.uniform(2.0, 7.0, n)) * (0.5 + 0.5 * strength)
    early = np.clip(tap.since / 3 + 2.2, 0, 1) * np.clip(2.8 - tap.since / 4, 0, 1)
    tap.fade(1 - sunk * 0.98 * early)
    for more in (0.0, 1.7, 3.1, 4.9, 8.2, 12.5):
        echo = 0.3 * np.exp(-more / 9) * tap.rng.rayleigh(0.8, len(late)) * tap.phases()
        tap.waves = tap.waves + sunk * echo[:, None] * delayed(heard, late + more)


def _few_bits(tap: Tap, strength: float) -> None:
    """Drop low bits toward zero, of both components, all rows by the same step."""
    step = 1.5 * strength * float(np.median(tap.sigma))
    drop = np.trunc(tap.waves.real / step) + 1j * np.trunc(tap.waves.imag / step)
    rows = tap.since < -6
    was = [_quiet(np.abs(one), rows) for one in (tap.waves, step * drop)]
    tap.waves = step * drop
    tap.noisier = tap.noisier * np.maximum(was[1] / was[0], 0.05)


def _quiet(size: Floats, rows: NDArray[np.bool_]) -> float:
    return float(size[rows].std())


def _many_ways(tap: Tap, strength: float) -> None:
    """Fade resolved ways as m does: gamma powers, alike over a pulse, drawn for every row."""
    shape = 3.2 / max(strength, 0.2)
    cells = tap.rng.gamma(shape, 1 / shape, (len(tap.table), WIDE_SAMPLES // 4 + 2))
    knots = np.arange(cells.shape[1]) * 4.0
    grid = np.arange(WIDE_SAMPLES)
    gain = np.sqrt(np.stack([np.interp(grid, knots, row) for row in cells]))
    tap.fade(np.where(tap.since > -7, gain, 1.0))


def _by_the_water(tap: Tap, strength: float) -> None:
    longer, ray = water_ray(tap.swims(), strength)
    tap.waves = tap.waves + ray[:, None] * delayed(tap.there(), longer / METRES)


def _sterner(tap: Tap, strength: float) -> None:
    """Time first paths nearer to their crests."""
    tap.stern = 1 + 1.1 * strength


def _lost(tap: Tap, strength: float) -> None:
    """Lose one of every few samples of the memory: it is zero."""
    every = max(round(7 / strength), 2)
    begin = tap.rng.integers(0, every, (len(tap.table), 1))  # memory starts anywhere
    kept = (np.arange(WIDE_SAMPLES) - begin) % every != 0
    tap.waves = np.where(kept, tap.waves, 0.0)


def _leaks(tap: Tap, strength: float) -> None:
    """Add the own carrier, which leaks into the mixer: a constant, of a beacon's own phase."""
    which = tap.swims().number("rx")
    turn = np.exp(2j * np.pi * tap.kept(6).random(len(BEACONS_M)))[which]
    tap.waves = tap.waves + (1.6 * strength * tap.sigma * turn)[:, None]


def _slips(tap: Tap, strength: float) -> None:
    """Read a memory that skips a few samples somewhere after the first path, now and then."""
    struck = tap.rng.random(len(tap.table)) < min(0.45 * strength, 0.9)
    at = tap.rng.uniform(4, 30, len(struck))
    skip = np.where(struck, tap.rng.integers(3, 12, len(struck)), 0)[:, None]
    read = np.arange(WIDE_SAMPLES) + skip * (tap.since > at[:, None])
    tap.waves = np.take_along_axis(tap.waves, np.mod(read, WIDE_SAMPLES), axis=1)


WAVES: dict[str, Callable[[Tap, float], None]] = {
    "specular-reflections": _all_images,
    "small-scale-fading": _many_ways,
    "ground-bounce": _by_the_water,
    "obstructed-path": _under_water,
    "diffuse-tail": _tiled_walls,
    "pulse-ringing": _resonates,
    "noise-floor": _lamps,
    "narrowband-interference": _hopping_tone,
    "carrier-leaks": _leaks,
    "quantisation": _few_bits,
    "taps-lost": _lost,
    "late-half-slips": _slips,
    "late-detection": _sterner,
}
"""In the order in which they befall a waveform, from the hall to the memory."""
BEFORE = ("pulse-ringing", "noise-floor")  # of the radio: what rows undergo comes before these


def immerse(tap: Tap, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms undergo effects: those of the hall, those of rows, those of the radio."""
    order = [*WAVES]
    radio = order.index(BEFORE[0])
    rows = [name for name in names if name not in WAVES]
    for name in [*order[:radio], *rows, *order[radio:]]:
        if name in WAVES and name in names:
            WAVES[name](tap, strength)
        elif name in rows:
            tap.befall(EFFECTS[name](tap.swims(), strength))
