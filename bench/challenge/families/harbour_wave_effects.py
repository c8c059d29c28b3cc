"""What the harbour hides in waveforms: effects in forms of its own, and oddities of radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.harbour_effects import EFFECTS, WAVE_M, tarmac_ray
from bench.challenge.families.harbour_effects import LAWS as RANGE_LAWS
from bench.challenge.families.harbour_radio import (
    FADES,
    LOBE,
    SAMPLE_M,
    WIDE_SAMPLES,
    Frames,
    put_off,
)

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control",
)  # fmt: skip
"""Effects that are those of the harbour's tables of ranges."""
LAWS = {
    name: RANGE_LAWS[name]
    for name in (
        "salt-crust", "boom-in-the-wind", "twistlocks-closed", "crane-rolled-on",
        "cranes-renumbered",
    )
} | {"never-cleared": Law(), "brush-sparks": Law(), "sawtooth-baseline": Law()}  # fmt: skip
"""What nobody's library has."""


def _drives(frames: Frames, strength: float) -> None:
    got = EFFECTS["noise-floor"](frames.log(), strength)
    frames.hotter(10 ** (got["hiss_db"] / 20))


def _resonance(frames: Frames, strength: float) -> None:
    """Let the antenna resonate: it builds up, turns, and dies away."""
    there, turned = frames.wanted(), np.exp(2j * np.pi * frames.fixed("resonance").random())
    for late in range(2, 17):
        size = 0.3 * min(strength, 2.4) * (late / 4) * np.exp(1 - late / 4)
        turn = turned * np.exp(2j * np.pi * late / 6.5)
        frames.now = frames.now + size * turn * put_off(there, np.full(len(frames), late + 0.0))


def _clutter(frames: Frames, strength: float) -> None:
    """Scatter off ships and stacks: power falls with the square of the time since."""
    since = np.maximum(frames.late() - 2.0, 0)
    power = 0.016 * strength * (since > 0) / (1 + since / 11) ** 2.2
    rough = frames.white(frames.tall()[:, None] * np.sqrt(power / 2))
    at = np.arange(-5, 6)
    taps = np.sinc(at / LOBE) * np.exp(-((at / FADES) ** 2))
    taps = taps / np.sqrt((taps**2).sum())
    for shift, tap in zip(at, taps, strict=True):
        frames.now = frames.now + tap * np.roll(rough, shift, axis=1)


def _ships_radar(frames: Frames, strength: float) -> None:
    """Hear a ship's radar in most frames: a tone whose frequency is another in each."""
    sizes = 1.35 * strength * frames.rng.weibull(2.2, len(frames))
    sizes = sizes * (frames.rng.random(len(frames)) < 0.7)
    turns = frames.fixed("radar").uniform(-0.4, 0.4) + frames.rng.uniform(-0.03, 0.03, len(frames))
    tone = np.exp(2j * np.pi * np.outer(turns, np.arange(WIDE_SAMPLES)))
    frames.now = frames.now + (sizes * frames.spread * frames.any_phase())[:, None] * tone
    frames.told = frames.told * _with_tone(sizes)
    frames.spread = frames.spread * np.sqrt(1 + sizes**2 / 2)


def _with_tone(sizes: Floats) -> Floats:
    """Return how much more sizes scatter with a tone [n], in components' deviations, by trial."""
    rng, tried = np.random.default_rng(21), np.linspace(0, 14, 57)
    noise = rng.standard_normal(9000) + 1j * rng.standard_normal(9000)
    found = np.array([np.abs(noise + size).std() for size in tried])
    return np.asarray(np.interp(sizes, tried, found / found[0]))


def _behind_stacks(frames: Frames, strength: float) -> None:
    """Hear next to nothing straight on some links: many ways over and around the stack, later."""
    log, there = frames.log(), frames.wanted()
    lost = log.once_a_link(lambda n: (log.rng.random(n) < 0.23) * 1.0)
    late = log.once_a_link(lambda n: 1.4 + log.rng.rayleigh(2.2, n)) * (0.45 + 0.55 * strength)
    first = 1 / (1 + np.exp(3 * (frames.late() - 6.5))) / (1 + np.exp(-3 * (frames.late() + 6)))
    frames.fade(1 - 0.99 * lost[:, None] * first)
    for way in range(5):
        size = lost * 0.42 * 0.75**way * frames.any_phase()
        frames.now = frames.now + size[:, None] * put_off(there, late + 1.3 * way)


def _toward_zero(frames: Frames, strength: float) -> None:
    """Cut components off to steps, toward zero."""
    ratio = 1.15 * strength
    step = (ratio * frames.spread)[:, None]
    frames.now = step * (np.trunc(frames.now.real / step) + 1j * np.trunc(frames.now.imag / step))
    tried = np.random.default_rng(22).standard_normal((2, 30000))
    cut = ratio * np.trunc(tried / ratio)
    told = max(float(np.hypot(*cut).std() / np.hypot(*tried).std()), 0.02)
    frames.told, frames.spread = frames.told * told, frames.spread * max(float(cut.std()), 0.3)


def _waves_between(frames: Frames, strength: float) -> None:
    """Fade in dB, smoothly along the samples."""
    knots = frames.rng.normal(0, 2.3 * np.sqrt(strength), (len(frames), WIDE_SAMPLES // 3 + 2))
    place = np.arange(WIDE_SAMPLES) / 3
    low, rest = place.astype(np.intp), place % 1
    db = knots[:, low] * np.cos(np.pi / 2 * rest) + knots[:, low + 1] * np.sin(np.pi / 2 * rest)
    frames.fade(np.where(frames.late() > -6, 10 ** (db / 20), 1.0))


def _off_tarmac(frames: Frames, strength: float) -> None:
    longer, size = tarmac_ray(frames.log(), strength)
    turned = -size * np.exp(-2j * np.pi * longer / WAVE_M)
    frames.now = frames.now + turned[:, None] * put_off(frames.wanted(), longer / SAMPLE_M)


def _hard_to_wake(frames: Frames, strength: float) -> None:
    """Notice only what stands out several times more."""
    frames.harder = 1 + 5.5 * strength


def _never_cleared(frames: Frames, strength: float) -> None:
    """Keep a part of the frame before in the accumulator."""
    kept = min(0.3 * strength, 0.8)
    frames.now = frames.now + kept * np.roll(frames.now, 1, axis=0)


def _sparks(frames: Frames, strength: float) -> None:
    """Brushes of a motor spark in some frames: lone samples, before the first path too."""
    struck = frames.rng.random((len(frames), WIDE_SAMPLES)) < 0.035
    struck &= frames.rng.random((len(frames), 1)) < 0.6
    size = 3.4 * strength * frames.rng.exponential(1, struck.shape) * frames.spread[:, None]
    turn = np.exp(2j * np.pi * frames.rng.random(struck.shape))
    frames.now = frames.now + struck * np.minimum(size, 0.5 * frames.tall()[:, None]) * turn


def _sawtooth(frames: Frames, strength: float) -> None:
    """Add a baseline that climbs over 24 samples and falls back."""
    ramp = (np.arange(WIDE_SAMPLES) % 24) / 23
    frames.now = frames.now + 4.2 * strength * frames.spread[:, None] * ramp * np.exp(0.4j)


WAVES: dict[str, Callable[[Frames, float], None]] = {
    "noise-floor": _drives,
    "pulse-ringing": _resonance,
    "diffuse-tail": _clutter,
    "narrowband-interference": _ships_radar,
    "obstructed-path": _behind_stacks,
    "quantisation": _toward_zero,
    "small-scale-fading": _waves_between,
    "ground-bounce": _off_tarmac,
    "late-detection": _hard_to_wake,
    "never-cleared": _never_cleared,
    "brush-sparks": _sparks,
    "sawtooth-baseline": _sawtooth,
}
AT_THE_RADIO = {
    name: place
    for place, name in enumerate(
        ("noise-floor", "narrowband-interference", "brush-sparks", "power-bias", "level-control",
         "never-cleared", "sawtooth-baseline", "quantisation", "late-detection"), 1,
    )
}  # fmt: skip
"""What the radio does, in this order, after all that happens on the way to it."""


def let_happen(frames: Frames, names: tuple[str, ...], strength: float) -> None:
    """Let effects happen, those on the way first."""
    for name in sorted(names, key=lambda one: AT_THE_RADIO.get(one, 0)):
        if name in WAVES:
            WAVES[name](frames, strength)
        else:
            frames.carry(EFFECTS[name](frames.log(), strength))
