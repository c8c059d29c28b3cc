"""What the crag hides in waveforms: effects in forms of its own, oddities of its bolts.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable
from math import gamma

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.crag_belay import METRES, PLACES, WIDE_SAMPLES, Bolt, grain
from bench.challenge.families.crag_effects import EFFECTS, mat_ray
from bench.challenge.families.crag_wall import BOLTS, HALL_M
from bench.challenge.families.crag_wall import LAWS as OF_TABLES

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "clock-offset", "time-lag", "exchange-motion", "range-scale",
    "timestamp-jitter", "temperature-drift", "antenna-pattern", "power-bias", "level-control",
    "path-loss", "material-delay", "diffraction",
)  # fmt: skip
"""Effects that are those of the crag's tables of ranges."""
ODD = ("gaps-bridged", "chopper-left-on", "mean-taken-off")
NOT_HERE = ("rope-counter-slips", "means-since-begun", "braccia-from-one-bolt")
LAWS = {one: OF_TABLES[one] for one in OF_TABLES if one not in NOT_HERE} | {
    one: Law() for one in ODD
}
"""What nobody's library has."""
LATE = 10.5  # samples past first paths from which bolts are odd
GRAINS: Floats = np.random.default_rng(1215).standard_normal((24000, 2))  # to try readings on


def _five_sides(bolt: Bolt, strength: float) -> None:
    """Hear four sides of the hall and its roof, which facets and holds on them make uneven."""
    ascent, first = bolt.ascent(), bolt.arriving() * bolt.foremost()
    for axis, side_m in ((0, 0.0), (0, HALL_M[0]), (1, 0.0), (1, HALL_M[1]), (2, HALL_M[2])):
        depth = np.abs(ascent.tag[:, axis] - side_m) * np.abs(ascent.ear[:, axis] - side_m)
        way = np.sqrt(ascent.apart**2 + 4 * depth)
        grazing = ascent.apart / way
        facets = ascent.each(lambda n: bolt.rng.beta(3.0, 1.5, n))
        size = np.minimum(1.15 * strength**0.5 * facets * grazing**1.5, 0.85)
        bolt.again(first, size * bolt.turns(), np.maximum(way - ascent.apart, 0.85) / METRES)


def _mats(bolt: Bolt, strength: float) -> None:
    longer, share = mat_ray(bolt.ascent(), strength)
    bolt.again(bolt.arriving(), share, longer / METRES)


def _below_a_lip(bolt: Bolt, strength: float) -> None:
    """Lose, below an overhang's lip, what comes straight: it creeps round, and off holds nearby."""
    ascent, heard = bolt.ascent(), bolt.arriving()
    below = ascent.hidden(0.24)
    bolt.dim(1 - 0.984 * below[:, None] * bolt.foremost())
    late = 1.4 + 1.7 * strength**0.8 * ascent.each(lambda n: bolt.rng.uniform(0.7, 1.4, n))
    size = 0.46 * below
    for grown in (1.0, 0.8, 0.62, 0.45, 0.3):
        bolt.again(heard, grown * size * bolt.turns(), late)
        late = late + ascent.each(lambda n: 0.6 + bolt.rng.exponential(1.7, n))


def _weibull(bolt: Bolt, strength: float) -> None:
    """Fade by Weibull's law, alike for a few samples: powers are powers of exponential ones."""
    loose = bolt.rng.standard_normal((2, len(bolt.table), WIDE_SAMPLES + 4))
    alike = sum(loose[:, :, k : k + WIDE_SAMPLES] for k in range(5)) / np.sqrt(10)
    power = (np.asarray(alike) ** 2).sum(axis=0)
    steep = min(0.75 * strength**0.5, 1.2)
    bolt.waves = bolt.waves + bolt.arriving() * (np.sqrt(power**steep / gamma(1 + steep)) - 1)


def _rises_and_falls(bolt: Bolt, strength: float) -> None:
    """Reverberate in a hall: a tail that first rises, as what is high up comes late, then falls."""
    past = np.maximum(bolt.past - 3.0, 0.0)
    power = 0.03 * strength * (0.35 + past / 12.0) * np.exp(-past / 13.0) * bolt.after(3.0, 2.5)
    size = bolt.tops()[:, None] * np.sqrt(power / 2)
    bolt.waves = bolt.waves + size * grain(bolt.rng, len(bolt.table))


def _carabiner(bolt: Bolt, strength: float) -> None:
    """Ring in a carabiner by the antenna: two near pitches, which beat."""
    first, second, turn = bolt.common(1).uniform((0.3, 0.75, 0.0), (0.5, 1.0, 2 * np.pi))
    heard, rung = bolt.arriving(), bolt.waves.copy()
    size = 0.13 * min(strength, 2.4) ** 0.8
    for lag in range(3, 22):
        beat = np.exp(1j * first * lag) + np.exp(1j * (second * lag + turn))
        rung[:, lag:] += size * np.exp(-(lag - 3) / 6.0) * beat * heard[:, :-lag]
    bolt.waves = rung


def _dimmers(bolt: Bolt, strength: float) -> None:
    slip = EFFECTS["noise-floor"](bolt.ascent(), strength)
    bolt.hiss(np.asarray(slip.hiss))


def _sweeps(bolt: Bolt, strength: float) -> None:
    """Hear a beat of fans' inverters: a tone whose pitch slides, louder at some bolts."""
    pitch, slide = bolt.common(2).uniform((0.4, 0.002), (1.1, 0.005))
    own = bolt.common(3).uniform(0.6, 1.4, BOLTS)[bolt.ascent().bolt]
    size = 1.5 * strength * own * bolt.rng.triangular(0.6, 1.0, 1.4, len(own))
    tone = np.exp(1j * (pitch * PLACES + slide * PLACES**2 / 2)) * bolt.turns()[:, None]
    bolt.waves = bolt.waves + (size * bolt.sigma)[:, None] * tone
    tried = np.linspace(0.0, 9.0, 46)
    spread = np.array([np.hypot(GRAINS[:, 0] + one, GRAINS[:, 1]).std() for one in tried])
    bolt.hissing = bolt.hissing * np.interp(size, tried, spread / spread[0])
    bolt.sigma = bolt.sigma * np.sqrt(1 + size**2 / 2)


def _bridged(bolt: Bolt, strength: float) -> None:
    """Keep every sixth late sample alone, and draw lines between them."""
    knots = np.arange(0, WIDE_SAMPLES, 6)
    left = np.minimum(np.arange(WIDE_SAMPLES) // 6, len(knots) - 2)
    part = np.minimum((np.arange(WIDE_SAMPLES) - knots[left]) / 6, 1.0)
    lines = bolt.waves[:, knots[left]] * (1 - part) + bolt.waves[:, knots[left + 1]] * part
    share = min(0.9 * strength, 1.0) * bolt.after(LATE)
    bolt.waves = bolt.waves + share * (lines - bolt.waves)


def _chopped(bolt: Bolt, strength: float) -> None:
    """Have every other late sample while an amplifier is chopped: it gains less, then none."""
    odd = (np.arange(WIDE_SAMPLES) + int(bolt.common(4).integers(2))) % 2
    away = min(0.8 * strength, 0.97) * odd * bolt.after(LATE)
    bolt.waves = bolt.waves * (1 - away)


def _less_a_mean(bolt: Bolt, strength: float) -> None:
    """Take off late sizes a part of their mean, and leave nothing where they are below it."""
    there, size = bolt.after(LATE), np.abs(bolt.waves)
    mean = (there * size).sum(axis=1) / np.maximum(there.sum(axis=1), 1.0)
    left = np.maximum(1 - 0.45 * strength * mean[:, None] / np.maximum(size, 1e-9), 0.0)
    bolt.waves = bolt.waves * (1 + there * (left - 1))


def _toward_zero(bolt: Bolt, strength: float) -> None:
    """Keep whole steps of both parts, toward zero: whatever is below a step is nothing."""
    step = strength * float(np.median(bolt.sigma))
    kept = np.trunc(bolt.waves.real / step) + 1j * np.trunc(bolt.waves.imag / step)
    bolt.waves = step * kept
    tried = np.geomspace(0.1, 6.0, 40)
    spread = np.array([one * np.hypot(*np.trunc(GRAINS / one).T).std() for one in tried])
    by = np.interp(step / bolt.sigma, tried, spread / np.hypot(*GRAINS.T).std())
    bolt.hissing = bolt.hissing * np.maximum(by, 0.04)


def _numbed(bolt: Bolt, strength: float) -> None:
    """Take what is weak for noise, where a gain was set by what is loud."""
    bolt.numb = strength


ABOUT: dict[str, Callable[[Bolt, float], None]] = {
    "obstructed-path": _below_a_lip,
    "specular-reflections": _five_sides,
    "ground-bounce": _mats,
    "small-scale-fading": _weibull,
    "diffuse-tail": _rises_and_falls,
}
AT_BOLTS: dict[str, Callable[[Bolt, float], None]] = {
    "pulse-ringing": _carabiner,
    "noise-floor": _dimmers,
    "narrowband-interference": _sweeps,
    "mean-taken-off": _less_a_mean,
    "gaps-bridged": _bridged,
    "chopper-left-on": _chopped,
    "quantisation": _toward_zero,
    "late-detection": _numbed,
}
WAVES = ABOUT | AT_BOLTS


def put_through(bolt: Bolt, names: tuple[str, ...], strength: float) -> None:
    """Put waveforms through effects: those about antennas, those of rows, those of bolts."""
    rows = {one: EFFECTS[one] for one in names if one not in WAVES}
    for one in (name for name in ABOUT if name in names):  # in this order
        ABOUT[one](bolt, strength)
    for effect in rows.values():
        bolt.take(effect(bolt.ascent(), strength))
    for one, act in AT_BOLTS.items():
        if one in names:
            act(bolt, strength)
