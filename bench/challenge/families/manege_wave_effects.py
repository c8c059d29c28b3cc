"""What the manege hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.manege_effects import EFFECTS, sand_ray
from bench.challenge.families.manege_hall import HALL_M, LETTERS
from bench.challenge.families.manege_hall import LAWS as LAWS_OF_ROWS
from bench.challenge.families.manege_handset import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Handset,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the manege's tables of ranges."""
ODD = ("late-part-in-decibels", "divided-by-neighbours", "summed-from-the-end")
ELSEWHERE = ("antennas-by-turns", "paces-from-one-letter")
LAWS = {one: law for one, law in LAWS_OF_ROWS.items() if one not in ELSEWHERE}
LAWS |= {one: Law() for one in ODD}
"""What nobody's library has."""
FROM = 10.5  # samples past edges from which radios are odd
BOARDS, GABLES = 2.2, 3.9  # permittivity of long sides and roof, of short sides
PROBES: Floats = np.random.default_rng(1408).normal(size=(2, 25000))  # noise to try readings on


def _sides_and_roof(handset: Handset, strength: float) -> None:
    """Hear four sides and the roof, by images, as much as Fresnel has it of wood and brick."""
    first = handset.by_air() * handset.opening()
    for axis, at_m, dense in (
        (1, 0.0, BOARDS), (1, HALL_M[1], BOARDS), (0, 0.0, GABLES), (0, HALL_M[0], GABLES),
        (2, HALL_M[2], BOARDS),
    ):  # fmt: skip
        _side(handset, first, axis, at_m, dense, strength)


def _side(
    handset: Handset, of: Complexes, axis: int, at_m: float, dense: float, strength: float
) -> None:
    lesson = handset.lesson()
    image = lesson.post.copy()
    image[:, axis] = 2 * at_m - image[:, axis]
    way = np.sqrt(((lesson.at - image) ** 2).sum(axis=1))
    squarely = np.abs(lesson.at[:, axis] - image[:, axis]) / way
    inside = np.sqrt(dense - 1 + squarely**2)
    fresnel = (inside - squarely) / (inside + squarely)
    even = lesson.per_link(lambda n: handset.rng.triangular(0.5, 0.9, 1.1, n))
    size = (1.35 * strength**0.5 * even * fresnel * lesson.reach / way).clip(max=0.8)
    longer = np.maximum((way - lesson.reach) / METRES, 2.8)
    handset.repeat(of, size * handset.turns(), longer)


def _sand(handset: Handset, strength: float) -> None:
    longer, share = sand_ray(handset.lesson(), strength)
    handset.repeat(handset.by_air(), share, longer / METRES)


def _behind_a_stand(handset: Handset, strength: float) -> None:
    """Lose what comes straight, behind a stand: it comes over its roof, and by either end."""
    lesson, air = handset.lesson(), handset.by_air()
    behind = lesson.some(0.22)
    handset.fade(1 - 0.984 * behind[:, None] * handset.opening())
    over = 1.2 + 1.7 * strength**0.7 * lesson.per_link(lambda n: handset.rng.gamma(8.0, 1 / 8, n))
    ends = lesson.per_link(lambda n: handset.rng.uniform(2.0, 5.0, n))
    for size, samples in ((0.44, over), (0.27, over + ends), (0.2, over + 2.1 * ends)):
        own = size * lesson.per_link(lambda n: handset.rng.uniform(0.85, 1.15, n))
        handset.repeat(air, own * behind * handset.turns(), samples)


def _factors(handset: Handset, strength: float) -> None:
    """Fade by factors that multiply, alike for three samples or so: a log-normal law."""
    loose = handset.rng.normal(size=(handset.count, WIDE_SAMPLES))
    walk, kept = loose.copy(), 0.72
    for at in range(1, WIDE_SAMPLES):
        walk[:, at] = kept * walk[:, at - 1] + np.sqrt(1 - kept**2) * loose[:, at]
    wide = min(0.48 * strength**0.5, 0.8)
    handset.wave = handset.wave + handset.by_air() * (np.exp(wide * walk - wide**2) - 1)


def _rafters(handset: Handset, strength: float) -> None:
    """Reverberate among rafters: by a power of the time since, level at first."""
    since = np.maximum(handset.since - 3.5, 0.0)
    power = 0.03 * strength / (1 + (since / 16.0) ** 2) ** 1.6 * handset.past(3.2, 2.4)
    handset.hisses(np.sqrt(power / 2) * handset.tops()[:, None])


def _stirrups(handset: Handset, strength: float) -> None:
    """Ring in stirrups: a swing that grows for some samples and falls off again."""
    pitch, turn = handset.common(1).uniform((0.3, 0.0), (1.0, 2 * np.pi))
    air, rung = handset.by_air(), handset.wave.copy()
    for lag in range(3, 30):
        grown = (lag - 2) / 3.0 * np.exp(1 - (lag - 2) / 3.0)
        swing = 0.15 * min(strength, 2.4) ** 0.8 * grown * np.exp(1j * (pitch * lag + turn))
        rung[:, lag:] += swing * air[:, :-lag]
    handset.wave = rung


def _ballasts(handset: Handset, strength: float) -> None:
    raised = EFFECTS["noise-floor"](handset.lesson(), strength).noise_db
    handset.hiss_more(raised + np.zeros(handset.count))


def _microphone(handset: Handset, strength: float) -> None:
    """Hear a teacher's wireless microphone: a carrier that speech turns to and fro (FM)."""
    pitch, quick = handset.common(2).uniform((-1.5, 0.05), (-0.5, 0.11))
    near = handset.common(3).triangular(0.5, 1.0, 1.5, LETTERS)[handset.lesson().letter]
    size = 1.55 * strength * near * handset.rng.uniform(0.7, 1.3, handset.count)
    speech = handset.rng.uniform(0.0, 2 * np.pi, (handset.count, 1))
    tone = np.exp(1j * (pitch * PLACES + 1.6 * np.sin(quick * PLACES + speech)))
    handset.wave = handset.wave + (size * handset.sigma * handset.turns())[:, None] * tone
    sizes = np.linspace(0.0, 9.0, 61)
    spread = np.array([np.hypot(PROBES[0] + one, PROBES[1]).std() for one in sizes])
    handset.told_noise = handset.told_noise * np.interp(size, sizes, spread / spread[0])
    handset.sigma = handset.sigma * np.sqrt(1 + size**2 / 2)


def _late(handset: Handset, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    share = part * handset.past(FROM)
    handset.wave = handset.wave * (1 + share * (sizes / np.maximum(np.abs(handset.wave), 1e-9) - 1))


def _usual(handset: Handset) -> Floats:
    """Return how large late sizes are, by their roots of mean squares [n, 1]."""
    late = handset.past(FROM)
    power = (late * np.abs(handset.wave) ** 2).sum(axis=1) / late.sum(axis=1)
    return np.asarray(np.sqrt(power)[:, None])


def _decibels(handset: Handset, strength: float) -> None:
    """Show late sizes as a logarithm has them, as meters do."""
    usual = _usual(handset)
    db = 20 * np.log10(np.abs(handset.wave) / usual + 1e-3)
    _late(handset, usual * np.clip(0.9 + db / 18.0, 0.0, 3.0), min(0.85 * strength, 1.0))


def _neighbours(handset: Handset, strength: float) -> None:
    """Divide late sizes by the mean of neighbours, as for a constant rate of false alarms."""
    size = np.abs(handset.wave)
    wide = np.pad(size, ((0, 0), (6, 6)), mode="edge")
    beside = [wide[:, 6 + k : 6 + k + WIDE_SAMPLES] for k in (-6, -5, -4, -3, 3, 4, 5, 6)]
    mean = np.mean(beside, axis=0)
    _late(handset, 0.9 * _usual(handset) * size / mean, min(0.8 * strength, 1.0))


def _from_the_end(handset: Handset, strength: float) -> None:
    """Show a root of the mean of what follows within some samples: sums begin at the end."""
    long = round(6 + 8 * min(strength, 2.0))
    summed = np.cumsum(np.pad(np.abs(handset.wave) ** 2, ((0, 0), (1, long)), mode="edge"), axis=1)
    mean = (summed[:, long:-1] - summed[:, :WIDE_SAMPLES]) / long
    _late(handset, np.sqrt(np.maximum(mean, 0.0)), min(0.8 * strength, 1.0))


def _rounded_down(handset: Handset, strength: float) -> None:
    """Round both parts down to steps: half a step of each is left over as a constant."""
    step = 1.1 * strength * float(np.median(handset.sigma))
    wave = handset.wave
    handset.wave = step * (np.floor(wave.real / step) + 1j * np.floor(wave.imag / step))
    steps = np.geomspace(0.1, 8.0, 50)
    spread = [np.hypot(*(one * np.floor(PROBES / one))).std() for one in steps]
    by = np.interp(step / handset.sigma, steps, np.array(spread) / np.hypot(*PROBES).std())
    handset.told_noise = handset.told_noise * np.maximum(by, 0.05)


def _dull(handset: Handset, strength: float) -> None:
    """Ask more of a first pulse, as where loudspeakers once disturbed."""
    handset.dull = strength


IN_THE_HALL: dict[str, Callable[[Handset, float], None]] = {
    "obstructed-path": _behind_a_stand,
    "specular-reflections": _sides_and_roof,
    "ground-bounce": _sand,
    "small-scale-fading": _factors,
    "diffuse-tail": _rafters,
}
IN_HANDSETS: dict[str, Callable[[Handset, float], None]] = {
    "pulse-ringing": _stirrups,
    "noise-floor": _ballasts,
    "narrowband-interference": _microphone,
    "late-part-in-decibels": _decibels,
    "divided-by-neighbours": _neighbours,
    "summed-from-the-end": _from_the_end,
    "quantisation": _rounded_down,
    "late-detection": _dull,
}
WAVES = IN_THE_HALL | IN_HANDSETS


def pass_on(handset: Handset, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms pass what is in the hall, what strains rows, and what is in handsets."""
    for name in (one for one in IN_THE_HALL if one in names):
        IN_THE_HALL[name](handset, strength)
    for name in sorted(one for one in names if one not in WAVES):
        handset.strain(EFFECTS[name](handset.lesson(), strength))
    for name in (one for one in IN_HANDSETS if one in names):
        IN_HANDSETS[name](handset, strength)
