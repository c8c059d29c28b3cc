"""What the signal box's yard hides in waveforms: effects in forms of its own, oddities of radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.signalbox_effects import EFFECTS, ballast_ray
from bench.challenge.families.signalbox_frame import METRES, SAMPLE, Strip, static
from bench.challenge.families.signalbox_yard import LAWS as RANGE_LAWS
from bench.challenge.families.signalbox_yard import SEMAPHORES_M

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern",
    "power-bias", "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control",
)  # fmt: skip
"""Effects that are those of the signal box's tables of ranges."""
MISHAPS = ("coupling-dried-out", "clutter-map-taken-away", "second-bank-without-phase")
LAWS = {
    name: RANGE_LAWS.get(name, Law())
    for name in (*(n for n, law in RANGE_LAWS.items() if law.forms), *MISHAPS)
    if name != "rods-from-one-semaphore"
}
"""What nobody's library has."""


def _trains(strip: Strip, strength: float) -> None:
    """Hear trains on both sides of a way and the box's own front: flat sides of steel, and brick.

    A train returns only where it stands when the place comes that a mirror would ask for.
    """
    train, straight = strip.train(), strip.call() * strip.direct()
    tags, arms = train.tags(), train.arms()
    ends = np.stack([tags[:, 0], arms[:, 0]])
    aside = [train.per_link(lambda n: strip.rng.uniform(1.6, 6.0, n)) for _ in range(2)]
    there = [train.per_link(lambda n: 1.0 * (strip.rng.random(n) < 0.75)) for _ in range(2)]
    planes = (ends.max(axis=0) + aside[0], ends.min(axis=0) - aside[1])
    for plane, stands in zip(planes, there, strict=True):
        way = np.sqrt(train.far**2 + 4 * np.prod(ends - plane, axis=0))
        share = np.minimum(0.72 * strength**0.5 * stands * train.far / way, 0.85)
        strip.hear(share * strip.turned(), np.maximum(way - train.far, 1.0) / METRES, straight)
    behind_m = train.per_link(lambda n: strip.rng.uniform(2.0, 5.0, n))
    way = np.sqrt(train.far**2 + 4 * (tags[:, 1] + behind_m) * (arms[:, 1] + behind_m))
    strip.hear(0.45 * strength**0.5 * train.far / way * strip.turned(),
               np.maximum(way - train.far, 1.0) / METRES, straight)  # fmt: skip


def _ballast(strip: Strip, strength: float) -> None:
    longer, share = ballast_ray(strip.train(), strength)
    strip.hear(share, longer / METRES, strip.call())


def _behind_trains(strip: Strip, strength: float) -> None:
    """Lose, behind a train, what comes straight: it comes by gaps, under and between wagons."""
    train, call = strip.train(), strip.call()
    stands = train.per_link(lambda n: 1.0 * (strip.rng.random(n) < 0.21))
    strip.scale(1 - 0.984 * stands[:, None] * strip.on() * strip.direct())
    first = train.per_link(lambda n: 2.1 + strip.rng.gamma(4.0, 0.35, n)) * (0.5 + 0.5 * strength)
    spread = train.per_link(lambda n: strip.rng.uniform(1.2, 2.6, n))
    for later, size in ((0.0, 0.34), (1.0, 0.29), (2.3, 0.25), (4.1, 0.17), (6.6, 0.11)):
        share = stands * size * strip.rng.uniform(0.75, 1.25, train.size)
        strip.hear(share * strip.turned(), first + later * spread, call)


def _two_waves(strip: Strip, strength: float) -> None:
    """Fade by two waves and what is diffuse (Durgin, Rappaport and de Wolf 2002)."""
    rows, knots = len(strip.table), len(SAMPLE) // 5 + 3
    second = np.sqrt(min(0.2 * strength, 0.7)) * np.exp(2j * np.pi * strip.rng.random((rows, 1)))
    turn = np.exp(2j * np.pi * strip.rng.random((rows, knots)))
    loose = strip.rng.standard_normal((rows, knots, 2)) @ np.array([1, 1j])
    gain = 1 + second * turn + np.sqrt(min(0.06 * strength, 0.3)) * loose
    place = (SAMPLE + strip.rng.uniform(0, 5, (rows, 1))) / 5
    left = np.floor(place).astype(np.intp)
    part = place - left
    one, two = (np.take_along_axis(gain, left + k, axis=1) for k in (0, 1))
    size = np.abs((1 - part) * one + part * two)
    strip.scale(1 + strip.on() * (size / np.sqrt(np.mean(size**2)) - 1))


def _swells(strip: Strip, strength: float) -> None:
    """Scatter from wagons all about: more and more at first, then less and less."""
    time = np.maximum(strip.past - 3, 0) / 15.0
    power = 0.015 * strength * time * np.exp(1 - time)
    rough = static(strip.rng, len(time)) * np.sqrt(power / 2)
    strip.wave = strip.wave + strip.height()[:, None] * rough


def _to_and_fro(strip: Strip, strength: float) -> None:
    """Ring to and fro between an antenna and an arrester: again after each 3.4 samples."""
    turn = strip.kept(1).uniform(0, 2 * np.pi)
    heard = strip.call()
    for number in range(1, 9):
        share = min(0.31 * strength, 0.8) * 0.66 ** (number - 1) * np.exp(1j * number * turn)
        strip.hear(np.full(len(heard), share), np.full(len(heard), 3.4 * number), heard)


def _line_hums(strip: Strip, strength: float) -> None:
    strip.crackle(np.asarray(EFFECTS["noise-floor"](strip.train(), strength).hiss))


def _relays(strip: Strip, strength: float) -> None:
    """Hear a radio relay's two carriers, one half as large, at some semaphores: they beat."""
    pitch, apart = strip.kept(2).uniform([-0.44, 0.17], [0.2, 0.34])
    loud = strength * strip.kept(3).uniform(0.8, 1.6, len(SEMAPHORES_M))[strip.train().semaphore]
    one, two = (np.exp(2j * np.pi * x * SAMPLE) for x in (pitch, pitch + apart))
    wave = one * strip.turned()[:, None] + 0.5 * two * strip.turned()[:, None]
    strip.wave = strip.wave + (loud * strip.sigma)[:, None] * wave
    strip.noisier = strip.noisier * _beside(loud)
    strip.sigma = strip.sigma * np.sqrt(1 + 0.5 * 1.25 * loud**2)


def _beside(loud: Floats) -> Floats:
    """Return how many times more sizes scatter beside two such carriers [n]: by trial."""
    rng = np.random.default_rng(907)
    noise = rng.standard_normal((20000, 2)) @ np.array([1, 1j])
    both = 1 + 0.5 * np.exp(2j * np.pi * rng.random(20000))
    tried = np.linspace(0.0, 7.5, 40)
    spread = np.array([np.std(np.abs(noise + one * both)) for one in tried])
    return np.asarray(np.interp(loud, tried, spread / spread[0]))


def _dried_out(strip: Strip, strength: float) -> None:
    """Couple late samples through a capacitor that has dried out: what lasts is let through less.

    y[k] = a (y[k-1] + x[k] - x[k-1]), from where the gate for first paths is shut.
    """
    a = 1 - min(0.22 * strength, 0.6)
    passed = strip.wave.copy()
    for k in range(1, passed.shape[1]):
        passed[:, k] = a * (passed[:, k - 1] + strip.wave[:, k] - strip.wave[:, k - 1])
    late = strip.after(7.0)
    strip.wave = strip.wave * (1 - late) + passed * late


def _map_taken_away(strip: Strip, strength: float) -> None:
    """Take away, after first paths, what a semaphore hears on average: a map of clutter."""
    place = np.clip(np.rint(strip.onset)[:, None] + np.arange(-9, 130), 0, len(SAMPLE) - 1)
    share = np.abs(strip.wave) / np.maximum(strip.height(), 1e-9)[:, None]
    lined_up = _by_group(np.take_along_axis(share, place.astype(np.intp), axis=1),
                       strip.train().semaphore)  # fmt: skip
    past = np.clip(np.rint(strip.past) + 9, 0, lined_up.shape[1] - 1).astype(np.intp)
    usual = np.take_along_axis(lined_up, past, axis=1)
    left = np.maximum(share - min(0.6 * strength, 1.1) * usual * strip.after(8.0), 0.1 * share)
    strip.wave = strip.wave * left / np.maximum(share, 1e-12)


def _by_group(values: Floats, group: NDArray[np.intp]) -> Floats:
    """Return the means [n, k] of the rows of values [n, k] that are of the same group [n]."""
    sums, many = np.zeros((group.max() + 1, values.shape[1])), np.bincount(group)
    np.add.at(sums, group, values)
    return np.asarray((sums / np.maximum(many, 1)[:, None])[group])


def _without_phase(strip: Strip, strength: float) -> None:
    """Add up powers and not phases in the second bank of a memory: noise does not fall there."""
    floor = 2.4 * strength * strip.sigma[:, None] * strip.after(20.0)
    size = np.abs(strip.wave)
    strip.wave = strip.wave * np.sqrt(size**2 + floor**2) / np.maximum(size, 1e-9)


def _whole_sizes(strip: Strip, strength: float) -> None:
    """Keep sizes in whole steps, and phases as they are."""
    step = 1.6 * strength * float(np.median(strip.sigma))
    size = np.abs(strip.wave)
    strip.wave = strip.wave * (step * np.rint(size / step)) / np.maximum(size, 1e-9)
    noise = np.abs(np.random.default_rng(908).standard_normal((20000, 2)) @ np.array([1, 1j]))
    tried = np.geomspace(0.05, 5.0, 60)
    spread = np.array([np.std(x * np.rint(noise / x)) for x in tried]) / noise.std()
    strip.noisier = strip.noisier * np.maximum(np.interp(step / strip.sigma, tried, spread), 0.05)


def _numb(strip: Strip, strength: float) -> None:
    """Ask more of a first edge, and take it later."""
    strip.numb = 0.95 * strength


YARD = ("specular-reflections", "ground-bounce", "obstructed-path", "small-scale-fading",
        "diffuse-tail")  # fmt: skip
WAVES: dict[str, Callable[[Strip, float], None]] = {
    "specular-reflections": _trains,
    "ground-bounce": _ballast,
    "obstructed-path": _behind_trains,
    "small-scale-fading": _two_waves,
    "diffuse-tail": _swells,
    "pulse-ringing": _to_and_fro,
    "noise-floor": _line_hums,
    "narrowband-interference": _relays,
    "coupling-dried-out": _dried_out,
    "clutter-map-taken-away": _map_taken_away,
    "second-bank-without-phase": _without_phase,
    "quantisation": _whole_sizes,
    "late-detection": _numb,
}


def signal(strip: Strip, names: tuple[str, ...], strength: float) -> None:
    """Change waveforms by effects: those of the yard, those of rows, those of the radio."""
    of_rows = [name for name in names if name not in WAVES]
    of_radio = [name for name in WAVES if name not in YARD]
    for name in (*YARD, *of_rows, *of_radio):
        if name in of_rows:
            strip.change(EFFECTS[name](strip.train(), strength))
        elif name in names:
            WAVES[name](strip, strength)
