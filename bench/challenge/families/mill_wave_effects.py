"""What the mill hides in waveforms: a library's effects in other forms, and faults of radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.mill_effects import EFFECTS, WAVE_M, floor_ray
from bench.challenge.families.mill_effects import LAWS as RANGE_LAWS
from bench.challenge.families.mill_trace import PULSE, SAMPLE_M, Trace, later

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "temperature-drift", "power-bias", "path-loss", "range-scale",
    "timestamp-jitter", "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the mill's tables of ranges."""
LAWS = {
    name: RANGE_LAWS[name]
    for name in ("flour-dust", "belt-load", "sluice-open", "post-sunk", "posts-confused")
} | {"rippled-gain": Law(), "words-exchanged": Law(), "companded-samples": Law()}
"""What nobody's library has."""


def _noisy(trace: Trace, strength: float) -> None:
    change = EFFECTS["noise-floor"](trace.rows(), strength)
    trace.noisier(change.noisier * np.ones(len(trace.cir)))


def _mismatched_cable(trace: Trace, strength: float) -> None:
    """Back and forth in a cable: weaker and weaker copies, always as late."""
    there = trace.signal()
    turned = np.exp(1j * np.random.default_rng([trace.own, 1]).uniform(0, 2 * np.pi))
    for times in range(1, 5):
        size = (min(0.26 * strength, 0.55) * turned) ** times
        trace.cir = trace.cir + size * later(there, np.full(len(there), 3.4 * times))


def _images(trace: Trace, strength: float) -> None:
    """Return from the walls, and from each corner of two walls."""
    rows = trace.rows()
    ends, room = (rows.at("tx"), rows.at("rx")), rows.frame[["room_x_m", "room_y_m"]].to_numpy()
    there, far = trace.signal(), rows["true_range_m"]
    for x in (None, 0, 1):
        for y in (None, 0, 1):
            mirror = ends[0].copy()
            for axis, wall in ((0, x), (1, y)):
                if wall is not None:
                    mirror[:, axis] = 2 * wall * room[:, axis] - mirror[:, axis]
            length = np.linalg.norm(mirror - ends[1], axis=1)
            bounces = (x is not None) + (y is not None)
            if bounces:
                _echo(
                    trace, there, length - far, (0.3 * min(strength, 2.2)) ** bounces * far / length
                )


def _echo(trace: Trace, there: NDArray[np.complex128], longer_m: Floats, size: Floats) -> None:
    """Add a copy that comes later by metres [n], of a size [n] and any phase."""
    turned = size * np.exp(2j * np.pi * trace.rng.random(len(there)))
    trace.cir = trace.cir + turned[:, None] * later(there, longer_m / SAMPLE_M)


def _stretched_tail(trace: Trace, strength: float) -> None:
    """Machines everywhere: a tail that falls as a stretched exponential, one for each row."""
    after = np.maximum(trace.since() - 1, 0)
    fall = np.sqrt(0.011 * strength) * np.exp(-((after / 9.0) ** 0.7) / 2) * (after > 0)
    rough = trace.noise(trace.height()[:, None] * fall / np.sqrt(2))
    pulse = 1 / np.cosh(np.arange(-6, 7) / PULSE)
    pulse = pulse / np.sqrt((pulse**2).sum())
    trace.cir = trace.cir + np.array([np.convolve(row, pulse, "same") for row in rough])


def _sweeping(trace: Trace, strength: float) -> None:
    """Hear a carrier that sweeps slowly, in most frames."""
    samples, count = np.arange(trace.cir.shape[1]), len(trace.cir)
    base = np.random.default_rng([trace.own, 2]).uniform(0.04, 0.4)
    turns = base + trace.rng.normal(0, 0.006, count)
    size = 1.5 * strength * trace.rng.lognormal(0, 0.35, count) * (trace.rng.random(count) < 0.8)
    phase = turns[:, None] * samples + 4e-5 * samples**2 + trace.rng.random(count)[:, None]
    now = trace.sigma * trace.hiss
    trace.cir = trace.cir + (size * now)[:, None] * np.exp(2j * np.pi * phase)
    trace.hiss = trace.hiss * np.sqrt(1 + size**2 / 2)
    # the logged noise is the scatter of sizes, which a carrier makes larger only to a limit
    trace.told = trace.told * np.sqrt((1 - 0.5708 * np.exp(-(size**2) / 4)) / 0.4292)


def _hidden_hoists(trace: Trace, strength: float) -> None:
    """Hear hardly anything straight on some links, but what comes round a hoist."""
    rows, there = trace.rows(), trace.signal()
    struck = rows.by_link(lambda n: (rows.rng.random(n) < 0.25).astype(np.float64))
    longer = rows.by_link(lambda n: 1.0 + rows.rng.gamma(3.0, 1.1, n)) * (0.4 + 0.6 * strength)
    early = np.clip((trace.since() + 7) / 2, 0, 1) * (trace.since() < 6)
    trace.times(1 - 0.99 * struck[:, None] * early)
    _echo(trace, there, longer * SAMPLE_M, 0.45 * struck)


def _coarse(trace: Trace, strength: float) -> None:
    """Round both components to the next multiple of some times the noise."""
    step = 1.7 * strength * trace.sigma * trace.hiss
    unit = step[:, None]
    trace.cir = unit * (np.rint(trace.cir.real / unit) + 1j * np.rint(trace.cir.imag / unit))
    known = np.random.default_rng(8).normal(size=(2, 20000))
    rounded = np.rint(known / (1.7 * strength)) * 1.7 * strength
    trace.told = trace.told * np.std(np.hypot(*rounded)) / np.std(np.hypot(*known))
    trace.hiss = trace.hiss * np.std(rounded) / np.std(known)


def _weibull(trace: Trace, strength: float) -> None:
    """Fading of the sizes, other every two samples."""
    count, most = trace.cir.shape
    knots = np.arange(0, most + 2, 2)
    drawn = trace.rng.weibull(4.5 / np.sqrt(strength), (count, len(knots)))
    drawn = drawn / drawn.mean()
    size = np.array([np.interp(np.arange(most), knots, row) for row in drawn])
    trace.times(np.where(trace.since() > -6, size, 1.0))


def _on_wet_ground(trace: Trace, strength: float) -> None:
    longer, size = floor_ray(trace.rows(), strength)
    turned = -size * np.exp(-2j * np.pi * longer / WAVE_M)
    trace.cir = trace.cir + turned[:, None] * later(trace.signal(), longer / SAMPLE_M)


def _hard_of_hearing(trace: Trace, strength: float) -> None:
    """See only what stands out more than it had to."""
    trace.deaf = 1 + 4 * strength


def _ripple(trace: Trace, strength: float) -> None:
    """Let the gain go up and down with the number of the sample."""
    depth = min(0.33 * strength, 0.85)
    gain = 1 + depth * np.sin(2 * np.pi * np.arange(trace.cir.shape[1]) / 17 + 0.6)
    trace.cir = trace.cir * gain


def _exchanged_words(trace: Trace, strength: float) -> None:
    """Read out some frames with every second sample before the one it follows."""
    struck = trace.rng.random(len(trace.cir)) < min(0.45 * strength, 0.95)
    other = np.arange(trace.cir.shape[1]) ^ 1
    trace.cir = np.where(struck[:, None], trace.cir[:, other], trace.cir)


def _companded(trace: Trace, strength: float) -> None:
    """Sizes written as a root of what they are, next to the largest."""
    size = np.maximum(np.abs(trace.cir), 1e-9)
    factor = (size / size.max(axis=1, keepdims=True)) ** (-0.11 * strength)
    quiet = factor[:, :20].mean(axis=1)
    trace.cir = trace.cir * factor
    trace.hiss, trace.told = trace.hiss * quiet, trace.told * quiet


WAVES: dict[str, Callable[[Trace, float], None]] = {
    "noise-floor": _noisy,
    "pulse-ringing": _mismatched_cable,
    "specular-reflections": _images,
    "diffuse-tail": _stretched_tail,
    "narrowband-interference": _sweeping,
    "obstructed-path": _hidden_hoists,
    "quantisation": _coarse,
    "small-scale-fading": _weibull,
    "ground-bounce": _on_wet_ground,
    "late-detection": _hard_of_hearing,
    "rippled-gain": _ripple,
    "words-exchanged": _exchanged_words,
    "companded-samples": _companded,
}
LAST = (
    "noise-floor", "narrowband-interference", "power-bias", "level-control", "rippled-gain",
    "companded-samples", "quantisation", "words-exchanged", "late-detection",
)  # fmt: skip
"""What the receiver does, after all that happens on the way to it, in its order."""


def change(trace: Trace, name: str, strength: float) -> None:
    """Let one effect happen."""
    if name in WAVES:
        return WAVES[name](trace, strength)
    return trace.take(EFFECTS[name](trace.rows(), strength))
