"""What the depot hides in waveforms: a library's effects in other forms, and faults of radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.depot_effects import EFFECTS, WAVE_M, concrete_floor
from bench.challenge.families.depot_effects import LAWS as RANGE_LAWS
from bench.challenge.families.depot_scope import METRES, WIDE_SAMPLES, Scope, delayed, pulse_at

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "power-bias", "path-loss",
    "range-scale", "timestamp-jitter", "material-delay", "diffraction",
    "level-control",
)  # fmt: skip
"""Effects that are those of the depot's tables of ranges."""
LAWS = {
    name: RANGE_LAWS[name]
    for name in ("frosted-over", "stacked-high", "fork-raised", "gate-bumped", "gates-relabelled")
} | {"spur-each-eighth": Law(), "held-samples": Law(), "late-quadrature": Law()}
"""What nobody's library has."""


def _noise(scope: Scope, strength: float) -> None:
    sheet = scope.sheet()
    EFFECTS["noise-floor"](sheet, strength)
    scope.hiss(10 ** (np.maximum(sheet.gained["noise_db"], 0) / 20))


def _after_ring(scope: Scope, strength: float) -> None:
    """Let the antenna swing on: an oscillation that dies away, begun two samples late."""
    turned = scope.same(1).uniform(0, 2 * np.pi)
    there = scope.heard.copy()
    for late in range(2, 15):
        size = 0.26 * min(strength, 2.5) * np.exp(-(late - 2) / 3.5) * np.cos(1.3 * late + turned)
        scope.add(size * delayed(there, np.full(len(there), float(late))))


def _large_faces(scope: Scope, strength: float) -> None:
    """Return from the roof and the two long walls, better the flatter."""
    sheet, there = scope.sheet(), scope.heard.copy()
    far = sheet.column("true_range_m")
    for axis, place in (("z", "room_z_m"), ("y", "room_y_m"), ("y", "")):
        wall = sheet.column(place) if place else np.zeros(len(far))
        gaps = [np.abs(wall - sheet.column(f"{end}_{axis}_m")) for end in ("tx", "rx")]
        length = np.sqrt(far**2 + 4 * gaps[0] * gaps[1])
        size = 0.5 * min(strength, 1.8) * (1 - (gaps[0] + gaps[1]) / (length + 9)) * far / length
        turned = size * np.exp(2j * np.pi * scope.rng.random(len(far)))
        scope.add(turned[:, None] * delayed(there, (length - far) / METRES))


def _scattered(scope: Scope, strength: float) -> None:
    """Many small things: rays at random, fewer and weaker as a power of the delay."""
    count, height = len(scope.waves), scope.tallest * np.sqrt(0.028 * strength)
    for _ in range(60):
        late = 14 * (scope.rng.random(count) ** -0.55 - 1) + 0.8
        size = height * (1 + late / 12) ** -0.6 * np.sqrt(scope.rng.gamma(0.8, 1.25, count))
        turned = size * np.exp(2j * np.pi * scope.rng.random(count))
        scope.add(turned[:, None] * pulse_at(scope.began + 1.2 + np.minimum(late, 190)))


def _two_tones(scope: Scope, strength: float) -> None:
    """Two carriers a little apart, which beat; other phases and sizes in each frame."""
    sample, count = np.arange(WIDE_SAMPLES), len(scope.waves)
    low = scope.same(2).uniform(0.1, 0.35)
    size = 0.85 * strength * scope.rng.gamma(4.0, 0.25, count)
    phases = scope.rng.random((2, count))
    both = sum(np.exp(2j * np.pi * (at * sample + phase[:, None]))
               for at, phase in zip((low, low + 0.31), phases, strict=True))  # fmt: skip
    scope.add(both * (size * scope.sigma)[:, None])
    scope.told = scope.told * _beaten(size)
    scope.sigma = scope.sigma * np.sqrt(1 + size**2)


def _beaten(size: Floats) -> Floats:
    """Return how much more sizes of noise scatter with two carriers [n] in it, by trying it."""
    rng, tried = np.random.default_rng(9), np.linspace(0, 12, 49)
    noise = rng.normal(size=6000) + 1j * rng.normal(size=6000)
    both = 1 + np.exp(2j * np.pi * rng.random(6000))
    found = [np.std(np.abs(noise + one * both)) for one in tried]
    return np.asarray(np.interp(size, tried, np.array(found) / found[0]))


def _behind_loads(scope: Scope, strength: float) -> None:
    """Nothing straight on some links, but three ways round the load."""
    sheet, there = scope.sheet(), scope.heard.copy()
    lost = sheet.each_link(lambda n: (scope.rng.random(n) < 0.24).astype(np.float64))
    late = sheet.each_link(lambda n: scope.rng.uniform(1.2, 6.0, n)) * (0.5 + 0.5 * strength)
    early = np.clip((scope.after + 6) / 2, 0, 1) * np.clip((8 - scope.after) / 2, 0, 1)
    scope.scale(1 - 0.992 * lost[:, None] * early)
    for number, size in enumerate((0.4, 0.3, 0.24)):
        turned = lost * size * np.exp(2j * np.pi * scope.rng.random(len(late)))
        scope.add(turned[:, None] * delayed(there, late * (1 + 0.6 * number)))


def _blocks(scope: Scope, strength: float) -> None:
    """Round components to steps that are a share of the frame's largest size, within limits."""
    most = np.abs(scope.waves).max(axis=1)
    part = np.minimum(most / 40 / scope.sigma, 1.9) * strength
    step = (part * scope.sigma)[:, None]
    scope.waves = step * (np.rint(scope.waves.real / step) + 1j * np.rint(scope.waves.imag / step))
    noise, tried = np.random.default_rng(10).normal(size=(2, 8000)), np.linspace(0.05, 5, 34)
    sizes = [np.std(np.hypot(*(one * np.rint(noise / one)))) for one in tried]
    factor = np.interp(part, tried, np.array(sizes) / np.std(np.hypot(*noise)))
    scope.told, scope.sigma = scope.told * factor, scope.sigma * np.maximum(factor, 0.5)


def _scintillating(scope: Scope, strength: float) -> None:
    """Each sample fades by a complex factor that is like its neighbours'."""
    count, keep = len(scope.waves), 0.55
    drawn = scope.rng.normal(size=(2, count, WIDE_SAMPLES + 8)) / np.sqrt(2)
    rough = drawn[0] + 1j * drawn[1]
    for at in range(1, rough.shape[1]):
        rough[:, at] = keep * rough[:, at - 1] + np.sqrt(1 - keep**2) * rough[:, at]
    part = min(0.07 * strength, 0.5)
    factor = np.sqrt(1 - part) + np.sqrt(part) * rough[:, 8:]
    scope.scale(np.where(scope.after > -5, np.abs(factor), 1.0))


def _from_the_floor(scope: Scope, strength: float) -> None:
    longer, size = concrete_floor(scope.sheet(), strength)
    turned = -size * np.exp(-2j * np.pi * longer / WAVE_M)
    scope.add(turned[:, None] * delayed(scope.heard, longer / METRES))


def _of_the_largest(scope: Scope, strength: float) -> None:
    """Look for nothing below a larger share of the largest size."""
    scope.share = min(0.07 + 0.4 * strength, 0.95)


def _spur(scope: Scope, strength: float) -> None:
    """Let a clock divided by eight be heard in every eighth sample."""
    comb = (np.arange(WIDE_SAMPLES) % 8 == 3) * np.exp(0.7j)
    scope.add(3.0 * strength * scope.sigma[:, None] * comb)


def _held(scope: Scope, strength: float) -> None:
    """In some frames the readout waits: one sample stands where the next five should."""
    struck = scope.rng.random(len(scope.waves)) < min(0.4 * strength, 0.95)
    place = np.floor(scope.began).astype(int) + scope.rng.integers(0, 4, len(scope.waves))
    source = np.tile(np.arange(WIDE_SAMPLES), (len(scope.waves), 1))
    held = (source > place[:, None]) & (source <= place[:, None] + 5) & struck[:, None]
    source = np.where(held, place[:, None], source)
    scope.waves = np.take_along_axis(scope.waves, source, axis=1)


def _quadrature(scope: Scope, strength: float) -> None:
    """One component is sampled later than the other."""
    late = np.full(len(scope.waves), 0.55 * strength)
    scope.waves = scope.waves.real + 1j * delayed(scope.waves, late).imag


WAVES: dict[str, Callable[[Scope, float], None]] = {
    "noise-floor": _noise,
    "pulse-ringing": _after_ring,
    "specular-reflections": _large_faces,
    "diffuse-tail": _scattered,
    "narrowband-interference": _two_tones,
    "obstructed-path": _behind_loads,
    "quantisation": _blocks,
    "small-scale-fading": _scintillating,
    "ground-bounce": _from_the_floor,
    "late-detection": _of_the_largest,
    "spur-each-eighth": _spur,
    "held-samples": _held,
    "late-quadrature": _quadrature,
}
RECEIVER = (
    "noise-floor", "narrowband-interference", "power-bias", "level-control", "late-quadrature",
    "spur-each-eighth", "quantisation", "held-samples", "late-detection",
)  # fmt: skip
"""What the receiver does, in the order of its parts; all else comes before."""


def happen(scope: Scope, names: tuple[str, ...], strength: float) -> None:
    """Let effects happen, in the order of the way that a signal goes."""
    way = [name for name in names if name not in RECEIVER]
    for name in (*way, *(name for name in RECEIVER if name in names)):
        if name in WAVES:
            WAVES[name](scope, strength)
        else:
            sheet = scope.sheet()
            EFFECTS[name](sheet, strength)
            scope.apply(sheet)
