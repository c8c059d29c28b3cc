"""What the attic hides in waveforms: effects in forms of its own, and oddities of receivers.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.attic_effects import (
    BEAMS_M,
    EAVES_M,
    EFFECTS,
    HOUSE_M,
    WAVELENGTH_M,
    boards_ray,
)
from bench.challenge.families.attic_effects import LAWS as RANGE_LAWS
from bench.challenge.families.attic_receiver import WIDE_SAMPLES, Reception, pulse
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "antenna-pattern", "power-bias", "timestamp-jitter",
    "path-loss", "range-scale", "range-rounding", "material-delay", "diffraction",
    "level-control",
)  # fmt: skip
"""Effects that are those of the attic's tables of ranges."""
LAWS = {
    name: law
    for name, law in RANGE_LAWS.items()
    if name
    in ("swollen-timber", "rain-on-slates", "fan-shakes", "wool-spread", "beam-sagged",
        "beams-mixed-up")
} | {"skipped-samples": Law(), "median-of-three": Law(), "pumping-supply": Law()}  # fmt: skip
"""What nobody's library has."""


def _hot(reception: Reception, strength: float) -> None:
    reception.hotter(EFFECTS["noise-floor"](reception.slate(), strength).hiss + 0.0 * reception.was)


def _dispersion(reception: Reception, strength: float) -> None:
    """Let a part of the signal come late by the antenna's foot, its high frequencies the most."""
    turns = 2 * np.pi * np.fft.fftfreq(WIDE_SAMPLES + 130)
    late = 0.42 * min(strength, 2.2) * np.exp(-1j * (2.2 * turns + 1.5 * turns**3))
    spectrum = np.fft.fft(reception.signal(), WIDE_SAMPLES + 130, axis=1) * late
    turned = np.exp(2j * np.pi * reception.always(2).random())
    reception.add(turned * np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def _mirrors(places: Floats) -> list[Floats]:
    """Return the images of places [n, 3] in both slopes of the roof and both gables."""
    rise = np.array([HOUSE_M[1] / 2, HOUSE_M[2] - EAVES_M])
    out = []
    for eaves_y, side in ((0.0, 1.0), (HOUSE_M[1], -1.0)):
        normal = np.array([0.0, -side * rise[1], rise[0]]) / np.hypot(*rise)
        away = (places - np.array([0.0, eaves_y, EAVES_M])) @ normal
        out.append(places - 2 * away[:, None] * normal)
    for gable in (0.0, HOUSE_M[0]):
        image = places.copy()
        image[:, 0] = 2 * gable - image[:, 0]
        out.append(image)
    return out


def _foil_on_rafters(reception: Reception, strength: float) -> None:
    """Foil under the slopes and on the gables returns a part, and a part of that again."""
    slate, there = reception.slate(), reception.signal()
    beams, size = BEAMS_M[slate.beam], 0.36 * min(strength, 2.2)
    once = _mirrors(slate.crawlers())
    for image in once:
        far = slate.gap(image)
        reception.echo(far - slate.far, size * reception.turns() * slate.far / far, there)
    for image in _mirrors(once[0])[1:]:
        far = np.linalg.norm(image - beams, axis=1)
        part = size**2 * reception.turns() * slate.far / far
        reception.echo(np.maximum(far - slate.far, 0), part, there)


def _reverberation(reception: Reception, strength: float) -> None:
    """Let the room ring on: it sets in only after some samples, and falls by one slope."""
    after = reception.behind - 5.5
    power = 0.009 * strength * np.exp(-np.maximum(after, 0) / 15) / (1 + np.exp(-1.6 * after))
    rough = np.sqrt(power / 2) * reception.hiss() * reception.first_height()[:, None]
    kernel = pulse(np.array([WIDE_SAMPLES // 2 + 0.0]))[0, WIDE_SAMPLES // 2 - 6 :][:13]
    kernel = kernel / np.sqrt((kernel**2).sum())
    reception.add(np.stack([np.convolve(row, kernel, "same") for row in rough]))


def _wobbling_tone(reception: Reception, strength: float) -> None:
    """Hear a carrier whose frequency wobbles, as strong in all frames but for a few dB."""
    sample, rng = np.arange(WIDE_SAMPLES), reception.always(1)
    middle, swing = rng.uniform(0.08, 0.3) * rng.choice([-1, 1]), rng.uniform(0.6, 1.4)
    begins = reception.rng.random((2, len(reception.waves), 1)) * 2 * np.pi
    phase = 2 * np.pi * middle * sample + begins[0] + swing * np.sin(sample / 9 + begins[1])
    size = 1.05 * strength * 10 ** (reception.rng.uniform(-3, 3, len(reception.waves)) / 20)
    reception.add((size * reception.sigma)[:, None] * np.exp(1j * phase))
    reception.logged = reception.logged * _scatter_with(size)
    reception.sigma = reception.sigma * np.sqrt(1 + size**2 / 2)


def _scatter_with(size: Floats) -> Floats:
    """Return by what factors sizes of noise scatter more with a carrier of some size [n]."""
    grid = np.linspace(0, 9, 46)
    draws = np.random.default_rng(31).normal(size=(12000, 2))
    spread = [np.hypot(draws[:, 0] + one, draws[:, 1]).std() for one in grid]
    return np.asarray(np.interp(size, grid, np.divide(spread, spread[0])))


def _by_the_rafters(reception: Reception, strength: float) -> None:
    """Hear nothing straight on some links: a swarm of small ways that swells and ebbs, later."""
    slate = reception.slate()
    struck = slate.per_link(lambda n: np.where(slate.rng.random(n) < 0.24, 1.0, 0.0))
    late = slate.per_link(lambda n: slate.rng.gamma(5.0, 0.75, n)) * (0.5 + 0.5 * strength)
    height = reception.first_height()
    begun = np.clip((reception.behind + 6) / 2, 0, 1) * np.clip((8 - reception.behind) / 2, 0, 1)
    reception.weigh(1 - 0.985 * struck[:, None] * begun)
    for _ in range(14):
        more = reception.rng.gamma(1.6, 1.3, len(late))
        size = 0.3 * height * struck * reception.rng.rayleigh(0.7, len(late)) * np.exp(-more / 6)
        middle = np.minimum(reception.was + 0.8 + late + more, WIDE_SAMPLES - 8)
        reception.add((size * reception.turns())[:, None] * pulse(middle))


def _few_sizes(reception: Reception, strength: float) -> None:
    """Round sizes to steps of a multiple of the noise; phases stay."""
    step = 1.9 * strength
    unit = step * reception.sigma[:, None]
    size = np.abs(reception.waves)
    reception.waves = reception.waves / np.maximum(size, 1e-9) * unit * np.rint(size / unit)
    tried = np.hypot(*np.random.default_rng(32).normal(size=(2, 20000)))
    factor = float((step * np.rint(tried / step)).std() / tried.std())
    reception.logged = reception.logged * max(factor, 0.05)


def _two_waves(reception: Reception, strength: float) -> None:
    """In every second sample two waves of any phase add up, of which one is smaller."""
    count, half = len(reception.waves), WIDE_SAMPLES // 2 + 1
    depth = min(0.3 * np.sqrt(strength), 0.85)
    knots = 1 + depth * np.exp(2j * np.pi * reception.rng.random((count, half)))
    size = np.abs(knots) / np.sqrt(1 + depth**2)
    gain = np.repeat(size, 2, axis=1)[:, :WIDE_SAMPLES]
    gain[:, 1:-1] = (gain[:, :-2] + 2 * gain[:, 1:-1] + gain[:, 2:]) / 4
    reception.weigh(np.where(reception.behind > -5, gain, 1.0))


def _off_the_boards(reception: Reception, strength: float) -> None:
    longer, size = boards_ray(reception.slate(), strength)
    turned = -size * np.exp(-2j * np.pi * longer / WAVELENGTH_M)
    reception.echo(longer, turned, reception.signal())


def _thick_skinned(reception: Reception, strength: float) -> None:
    """Take for a first path only what is stronger than it had to be."""
    reception.nerve = reception.nerve * (1 + 2.6 * strength)


def _skipped(reception: Reception, strength: float) -> None:
    """Read out a sample too few in every so many, after the first path."""
    skipped = np.floor(np.maximum(reception.behind + 1, 0) * min(strength, 3) / 4).astype(int)
    source = np.minimum(np.arange(WIDE_SAMPLES) + skipped, WIDE_SAMPLES - 1)
    reception.waves = np.take_along_axis(reception.waves, source, axis=1)


def _median(reception: Reception, strength: float) -> None:
    """Give the median of three sizes, in some of the frames."""
    size = np.abs(reception.waves)
    three = np.stack([size[:, :-2], size[:, 1:-1], size[:, 2:]])
    smooth = size.copy()
    smooth[:, 1:-1] = np.median(three, axis=0)
    struck = reception.rng.random(len(size)) < min(0.55 * strength, 1.0)
    factor = np.where(struck[:, None], smooth / np.maximum(size, 1e-9), 1.0)
    reception.waves = reception.waves * factor


def _pumping(reception: Reception, strength: float) -> None:
    """Let the supply sway with a pump's strokes: signals and noise alike go up and down."""
    when = reception.table["time_s"].to_numpy(np.float64)
    gain = 10 ** (2.8 * strength * np.sin(2 * np.pi * when / 1.37) / 20)
    reception.waves = reception.waves * gain[:, None]
    reception.sigma, reception.logged = reception.sigma * gain, reception.logged * gain


WAVES: dict[str, Callable[[Reception, float], None]] = {
    "noise-floor": _hot,
    "pulse-ringing": _dispersion,
    "specular-reflections": _foil_on_rafters,
    "diffuse-tail": _reverberation,
    "narrowband-interference": _wobbling_tone,
    "obstructed-path": _by_the_rafters,
    "quantisation": _few_sizes,
    "small-scale-fading": _two_waves,
    "ground-bounce": _off_the_boards,
    "late-detection": _thick_skinned,
    "skipped-samples": _skipped,
    "median-of-three": _median,
    "pumping-supply": _pumping,
}
IN_THE_BOX = (
    "noise-floor", "narrowband-interference", "power-bias", "level-control", "pumping-supply",
    "quantisation", "median-of-three", "skipped-samples", "range-rounding", "late-detection",
)  # fmt: skip
"""What happens in the receiver, in its order; what is not here happened before."""


def befall(reception: Reception, names: tuple[str, ...], strength: float) -> None:
    """Let effects befall what is received."""
    outside = [name for name in names if name not in IN_THE_BOX]
    for name in [*outside, *(name for name in IN_THE_BOX if name in names)]:
        if wave := WAVES.get(name):
            wave(reception, strength)
        else:
            reception.pay(EFFECTS[name](reception.slate(), strength))
