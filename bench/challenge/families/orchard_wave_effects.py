"""What the orchard hides in waveforms: effects in forms of its own, and oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.orchard_effects import EFFECTS, soil_ray
from bench.challenge.families.orchard_gate import METRES, WIDE_SAMPLES, Gate, behindhand, bells
from bench.challenge.families.orchard_plot import CARRIER_M
from bench.challenge.families.orchard_plot import LAWS as RANGE_LAWS

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "exchange-motion",
)  # fmt: skip
"""Effects that are those of the orchard's tables of ranges."""
LAWS = {
    **{name: law for name, law in RANGE_LAWS.items() if law.forms and "unit" not in law.forms},
    **{name: Law() for name in ("leaves-flutter", "tops-clipped", "neighbours-frame")},
}
"""What nobody's library has."""


def _engines(gate: Gate, strength: float) -> None:
    gate.rush(EFFECTS["noise-floor"](gate.plot(), strength).hiss * np.ones(len(gate)))


def _second_lobe(gate: Gate, strength: float) -> None:
    """Ring in a lobe that swells and ebbs around eight samples after, of one phase."""
    there, turn = gate.signal(), np.exp(2j * np.pi * gate.lasting(1).random())
    for late in np.arange(5.0, 12.0):
        size = 0.17 * min(strength, 2.3) * np.exp(-np.square((late - 8.2) / 2.2))
        gate.cir = gate.cir + size * turn * np.exp(0.7j * late) * behindhand(
            there, np.full(len(gate), late)
        )


def _near_and_far_trees(gate: Gate, strength: float) -> None:
    """Scatter off trees: a steep slope of those about, a gentle one of the others."""
    after = np.maximum(gate.ago - 3.2, 0)
    power = 0.02 * strength * (np.exp(-after / 7) + 0.3 * np.exp(-after / 40)) * (after > 0)
    sizes = np.sqrt(power / 2) * gate.rng.lognormal(-0.18, 0.6, power.shape)
    rough = gate.crest()[:, None] * sizes * gate.rushing()
    taps = bells(np.array([10.0]))[0, 7:14]
    taps = taps / np.sqrt(np.square(taps).sum())
    pad = np.pad(rough, ((0, 0), (3, 3)))
    gate.cir = gate.cir + sum(t * pad[:, k : k + WIDE_SAMPLES] for k, t in enumerate(taps))


def _chirping_radar(gate: Gate, strength: float) -> None:
    """Hear a radar whose frequency climbs through the window, from another one on each time."""
    when = np.arange(WIDE_SAMPLES)
    climbs = gate.lasting(2).uniform(2e-4, 8e-4)
    begins = gate.rng.uniform(-0.35, -0.1, len(gate))[:, None]
    turns = begins * when + climbs * when**2 / 2
    loud = 1.1 * strength * np.sqrt(gate.rng.chisquare(8, len(gate)) / 8)
    gate.cir = gate.cir + (loud * gate.scatter * gate.turned())[:, None] * np.exp(
        2j * np.pi * turns
    )
    gate.hiss = gate.hiss * _rice(loud)
    gate.scatter = gate.scatter * np.sqrt(1 + loud**2 / 2)


def _rice(loud: Floats) -> Floats:
    """Return how much more sizes scatter with a tone of such a size [n], by trial."""
    tried, rng = np.arange(0, 11, 0.25), np.random.default_rng(715)
    noise = rng.normal(size=(10000, 2)) @ [1, 1j]
    spread = np.array([np.abs(noise + one).std() for one in tried])
    return np.asarray(np.interp(loud, tried, spread / spread[0]))


def _by_the_trees(gate: Gate, strength: float) -> None:
    """Hear, on some links, a trunk's worth of nothing, and then what trees around return."""
    plot, there = gate.plot(), gate.signal()
    struck = plot.each_link(lambda n: 1.0 * (plot.rng.random(n) < 0.23))
    late = plot.each_link(lambda n: 1.5 + plot.rng.gamma(2.6, 0.9, n)) * (0.4 + 0.6 * strength)
    early = np.clip(gate.ago / 2 + 3, 0, 1) * np.clip((9 - gate.ago) / 3, 0, 1)
    gate.weaken(1 - 0.985 * struck[:, None] * early)
    for _ in range(8):
        more = gate.rng.exponential(3.2, len(gate))
        size = 0.42 * struck * np.exp(-more / 8) * gate.rng.rayleigh(0.7, len(gate))
        gate.cir = gate.cir + (size * gate.turned())[:, None] * behindhand(there, late + more)


def _common_exponent(gate: Gate, strength: float) -> None:
    """Keep so many bits of the largest component of a frame, and all others at its step."""
    largest = np.maximum(np.abs(gate.cir.real), np.abs(gate.cir.imag)).max(axis=1)
    ratio = 0.014 * strength * largest / gate.scatter
    step = (ratio * gate.scatter)[:, None]
    gate.cir = step * (np.rint(gate.cir.real / step) + 1j * np.rint(gate.cir.imag / step))
    tried = np.random.default_rng(716).normal(size=(2, 12000))
    grid = np.linspace(0.05, 8, 54)
    rounded = [one * np.rint(tried / one) for one in grid]
    sizes = np.array([np.hypot(*one).std() for one in rounded]) / np.hypot(*tried).std()
    gate.hiss = gate.hiss * np.maximum(np.interp(ratio, grid, sizes), 0.03)
    parts = np.array([one.std() for one in rounded])
    gate.scatter = gate.scatter * np.maximum(np.interp(ratio, grid, parts), 0.5)


def _trembling(gate: Gate, strength: float) -> None:
    """Add to every few samples a part of any phase: leaves that stand otherwise each time."""
    depth = 0.3 * np.sqrt(min(strength, 3.0))
    part = gate.rushing() * depth
    smooth = (np.roll(part, 1, axis=1) + 1.4 * part + np.roll(part, -1, axis=1)) / 2
    gain = np.abs(1 + smooth) / np.sqrt(1 + 2 * depth**2)
    gate.weaken(np.where(gate.ago > -5, gain, 1.0))


def _off_the_soil(gate: Gate, strength: float) -> None:
    longer, size = soil_ray(gate.plot(), strength)
    turned = -size * np.exp(-2j * np.pi * longer / CARRIER_M)
    gate.cir = gate.cir + turned[:, None] * behindhand(gate.signal(), longer / METRES)


def _deafer(gate: Gate, strength: float) -> None:
    """Ask for several times more of a first path."""
    gate.deaf = 1 + 2 * strength


def _flutter(gate: Gate, strength: float) -> None:
    """Lose what comes later while it is summed up: leaves move, and the more ways there are."""
    lost = np.exp(-strength * np.maximum(gate.ago - 3, 0) / 26)
    gate.weaken(lost)


def _clipped(gate: Gate, strength: float) -> None:
    """Clip sizes above a share of the largest."""
    size = np.abs(gate.cir)
    limit = size.max(axis=1, keepdims=True) / (1 + 0.45 * strength)
    gate.cir = gate.cir * np.minimum(1, limit / np.maximum(size, 1e-9))


def _neighbour(gate: Gate, strength: float) -> None:
    """Receive a neighbour's frame at the same time, at any place of the window, now and then."""
    struck = gate.rng.random(len(gate)) < min(0.3 * strength, 0.75)
    middle = gate.rng.uniform(4, WIDE_SAMPLES - 5, len(gate))
    size = struck * gate.rng.uniform(4, 16, len(gate)) * gate.scatter * gate.turned()
    gate.cir = gate.cir + size[:, None] * bells(middle)


WAVES: dict[str, Callable[[Gate, float], None]] = {
    "noise-floor": _engines,
    "pulse-ringing": _second_lobe,
    "diffuse-tail": _near_and_far_trees,
    "narrowband-interference": _chirping_radar,
    "obstructed-path": _by_the_trees,
    "quantisation": _common_exponent,
    "small-scale-fading": _trembling,
    "ground-bounce": _off_the_soil,
    "late-detection": _deafer,
    "leaves-flutter": _flutter,
    "tops-clipped": _clipped,
    "neighbours-frame": _neighbour,
}
IN_THE_RADIO = (
    "noise-floor", "narrowband-interference", "neighbours-frame", "tops-clipped", "power-bias",
    "level-control", "quantisation", "late-detection",
)  # fmt: skip
"""What is in the radio, in the order of its parts; the rest is in the air."""


def undergo(gate: Gate, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms undergo effects: what is in the air before what is in the radio."""
    air = [name for name in names if name not in IN_THE_RADIO]
    for name in air + [part for part in IN_THE_RADIO if part in names]:
        if wave := WAVES.get(name):
            wave(gate, strength)
        else:
            gate.harvest(EFFECTS[name](gate.plot(), strength))
