"""What the gasworks hides in waveforms: effects in forms of its own, and its oddities.

numpy alone; oddities are in `gasworks_oddities`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.gasworks_effects import EFFECTS, by_tanks, off_the_ground
from bench.challenge.families.gasworks_meter import (
    PLACES,
    WIDE_SAMPLES,
    Meter,
    heights,
    hissing,
    piped_later,
)
from bench.challenge.families.gasworks_oddities import ODDITIES
from bench.challenge.families.gasworks_yard import LAWS as LAWS_OF_ROWS
from bench.challenge.families.gasworks_yard import TAGS, YARD_M

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "aunes-from-one-bracket"}
LAWS |= {name: Law() for name in ODDITIES}
WALL, NEXT = 0.62, 6.2  # share of walls; samples from which tanks and walls are heard
VENTS, EACH_M, FADES_M = 8, 0.6, 1.9  # ways by vents; between these; of how they fade, in m
SMOOTHS: Floats = np.hanning(9)[1:-1]  # of fades from sample to sample
TAIL, BEGINS, SWELLS = 0.017, 4.0, 15.0  # power at most; samples until; to the most
STEMS, STEM_AT, STEM_EACH, CHIRPS = 7, 5.0, 1.9, 0.5  # echoes in stems; samples; radians
PITCH, SWINGS, WOBBLES = (0.25, 2.0), (1.0, 3.0), (0.05, 0.15)  # of tones, radians (a sample)
SOME: Complexes = hissing(np.random.default_rng(9207), 150)  # noise to try readings on


def _sides(meter: Meter, strength: float) -> None:
    """Hear tanks' sides and the yard's walls, where nothing is in front of these."""
    charge = meter.charge()
    first = meter.came() * meter.straight()
    ways = [*zip(*by_tanks(charge), strict=True)]
    for axis, side in ((0, 0.0), (0, YARD_M[0]), (1, 0.0), (1, YARD_M[1])):
        image = charge.bracket_m.copy()
        image[:, axis] = 2 * side - image[:, axis]
        way = np.linalg.norm(image - charge.tag_m, axis=1)
        ways.append((way - charge.far, WALL * charge.far / way))
    for longer, share in ways:
        bare = charge.per_link(lambda n: meter.rng.triangular(0.1, 0.9, 1.0, n))
        heard = np.isfinite(longer) & (longer > NEXT * meter.metres)
        size = np.where(heard, 1.5 * np.sqrt(strength) * bare * share, 0.0).clip(max=0.85)
        late = np.where(heard, longer, 0.0) / meter.metres
        meter.again(first, size * meter.turned(), late)


def _ground(meter: Meter, strength: float) -> None:
    longer, share = off_the_ground(meter.charge(), strength)
    meter.again(meter.came(), share, longer / meter.metres)


def _vents(meter: Meter, strength: float) -> None:
    """Lose what comes straight behind things; some comes by vents, by a power of how far round."""
    charge, rng, came = meter.charge(), meter.rng, meter.came()
    shut = charge.shut_in(0.2)
    meter.dull(-33.0 * shut[:, None] * meter.straight())
    first_m = charge.per_link(lambda n: 0.5 + rng.gamma(3.0, 0.13, n).clip(max=1.0))
    first_m = first_m * (0.5 + 0.5 * strength**0.8)
    for vent in range(VENTS):
        since_m = EACH_M * (vent + 0.4 * charge.per_link(lambda n: rng.uniform(-1.0, 1.0, n)))
        since_m = since_m.clip(0.0)
        fades = rng.weibull(2.4, charge.rows)
        size = shut * 0.46 * (1 + since_m / FADES_M) ** -1.6 * fades
        samples = (first_m + since_m) / meter.metres
        meter.again(came, size.clip(max=0.8) * meter.turned(), samples)


def waning(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of power 1 (Nakagami 1960, m of 1.5).

    Three even parts each, smooth from sample to sample.
    """
    even = rng.standard_normal((3, rows, WIDE_SAMPLES + len(SMOOTHS) - 1))
    smooth = sum(w * even[:, :, k : k + WIDE_SAMPLES] for k, w in enumerate(SMOOTHS))
    power = (np.asarray(smooth) ** 2).mean(axis=0) / (SMOOTHS**2).sum()
    return np.asarray(np.sqrt(power / power.mean()))


def _fades(meter: Meter, strength: float) -> None:
    """Fade smoothly; of what comes straight, all alike."""
    size = waning(meter.rng, meter.rows) ** min(np.sqrt(strength), 1.6)
    top = np.rint(meter.at + 1.6).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    straight = meter.straight()
    first = np.take_along_axis(size, top[:, None], axis=1).clip(0.4, 2.4)
    size = straight * first + (1 - straight) * size
    meter.wave = meter.wave + (size / np.sqrt((size**2).mean()) - 1) * meter.came()


def swelling(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: it swells, then dies (gamma)."""
    part = since.clip(0.0) / SWELLS
    return np.asarray(part * np.exp(1 - part))


def _tail(meter: Meter, strength: float) -> None:
    """Hear all else of a yard that fills with echoes before it is quiet."""
    high = heights(meter.wave, meter.at, meter.sigma)[:, None]
    power = TAIL * strength * swelling(PLACES - meter.at[:, None] - BEGINS)
    meter.hiss(high * np.sqrt(power) * meter.behind(BEGINS))


def stemmed(waves: Complexes) -> Complexes:
    """Return what rings after waveforms in tags' stems: evenly less, at a pitch that rises."""
    made = np.zeros(waves.shape, np.complex128)
    for k in range(STEMS):
        share = (1 - k / STEMS) * np.exp(1j * CHIRPS * k**2)
        made += share * piped_later(waves, np.full(len(waves), STEM_AT + k * STEM_EACH))
    return made


def _stems(meter: Meter, strength: float) -> None:
    turn = np.exp(1j * meter.common(5).uniform(-np.pi, np.pi))
    meter.wave = meter.wave + 0.2 * min(strength, 2.2) ** 0.8 * turn * stemmed(meter.came())


def _sparks(meter: Meter, strength: float) -> None:
    meter.roar(np.zeros(meter.rows) + EFFECTS["noise-floor"](meter.charge(), strength).noise_db)


def of_noise(waves: Complexes) -> float:
    """Return how sizes scatter within fives, as meters say of noise."""
    sizes = np.abs(waves)[:, : waves.shape[1] // 5 * 5]
    return float(np.sqrt(sizes.reshape(-1, 5).var(axis=1, ddof=1).mean()))


def _say(meter: Meter, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([of_noise(made(float(one))) for one in tried]) / of_noise(SOME)
    meter.noise_by = meter.noise_by * np.interp(of, tried, by).clip(0.05)


def wobbling(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of power 1 whose pitch swings (Carson 1922) [rows, WIDE_SAMPLES]."""
    pitch, swing, wobble = (rng.uniform(*by, (rows, 1)) for by in (PITCH, SWINGS, WOBBLES))
    begins, other = rng.uniform(-np.pi, np.pi, (2, rows, 1))
    return np.asarray(np.exp(1j * (pitch * PLACES + begins
                                   + swing * np.sin(wobble * PLACES + other))))  # fmt: skip


def _wobbles(meter: Meter, strength: float) -> None:
    """Hear an exhauster's dynamo, whose pitch swings; some tags more."""
    near = meter.common(6).weibull(2.5, len(TAGS)).clip(0.4, 1.9)[meter.charge().tag]
    size = 1.15 * strength * near
    meter.wave = meter.wave + (size * meter.sigma)[:, None] * wobbling(meter.rng, meter.rows)
    tones = wobbling(np.random.default_rng(9208), len(SOME))
    _say(meter, size, np.linspace(0.0, 9.0, 37), lambda one: SOME + one * tones)
    meter.sigma = meter.sigma * np.sqrt(1 + 0.5 * size**2)


def in_steps(waves: Complexes, step: float) -> Complexes:
    """Return waveforms whose sizes are told by whole steps; phases stay [n, k]."""
    size = np.abs(waves) + 1e-12
    return np.asarray(waves * (step * np.rint(size / step) / size))


def _steps(meter: Meter, strength: float) -> None:
    step = 1.2 * strength * float(np.median(meter.sigma))
    meter.wave = in_steps(meter.wave, step)
    tried = np.geomspace(0.03, 12.0, 50)
    _say(meter, step / meter.sigma, tried, lambda one: in_steps(SOME, one))


def _deaf(meter: Meter, strength: float) -> None:
    """Ask a larger part of the most of what is heard, as meters do that tar has got into."""
    meter.deaf = strength


WAVES: dict[str, Callable[[Meter, float], None]] = {
    "obstructed-path": _vents, "specular-reflections": _sides,
    "ground-bounce": _ground, "small-scale-fading": _fades, "diffuse-tail": _tail,
    "pulse-ringing": _stems, "noise-floor": _sparks, "narrowband-interference": _wobbles,
    **ODDITIES,
    "quantisation": _steps, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows pay what they do once waves were ON_THE_WAY, before meters hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the gasworks' tables of ranges."""


def hide(meter: Meter, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what rows are charged, and what meters do."""
    for name in ON_THE_WAY:
        if name in names:
            WAVES[name](meter, strength)
    for name in sorted({*names} - {*WAVES}):
        meter.settle(EFFECTS[name](meter.charge(), strength))
    for name in (one for one in WAVES if one in names and one not in ON_THE_WAY):
        WAVES[name](meter, strength)
