"""What the belfry's close hides in waveforms: effects in forms of its own, oddities of radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.belfry_close import CLOSE_M, GARGOYLES_M, HALF_M, MASONS, TOWER_M
from bench.challenge.families.belfry_close import LAWS as RANGE_LAWS
from bench.challenge.families.belfry_ear import BEAT, METRES, Heard, rustle
from bench.challenge.families.belfry_effects import EFFECTS, turf_ray
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern",
    "power-bias", "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control",
)  # fmt: skip
"""Effects that are those of the belfry's tables of ranges."""
STRANGE = ("antenna-switched-midway", "peak-detector-left-on", "interleaver-left-on")
LAWS = {
    **{name: law for name, law in RANGE_LAWS.items() if law.forms and law.forms != ("unit",)},
    **{name: Law() for name in STRANGE},
}
"""What nobody's library has."""
STONE = 0.2  # of the power that meets it upright, returned


def _masonry(heard: Heard, strength: float) -> None:
    """Hear the churchyard's walls and the tower's faces: Schlick's rule (1994) for stone."""
    watch, struck = heard.watch(), heard.sound() * heard.striking()
    tags, mouths = watch.tags(), watch.mouths()
    walls = [(axis, place) for axis in (0, 1) for place in (0.0, CLOSE_M[axis])]
    faces = [(axis, TOWER_M[axis] + side) for axis in (0, 1) for side in (-HALF_M, HALF_M)]
    for axis, place in walls + faces:
        ahead, behind = tags[:, axis] - place, mouths[:, axis] - place
        same_side = (ahead * behind > 0).astype(np.float64)
        way = np.sqrt(watch.away**2 + 4 * np.maximum(ahead * behind, 0.0))
        grazing = 1 - np.minimum(np.abs(ahead + behind) / way, 1.0)
        power = STONE + (1 - STONE) * grazing**5
        ivy = watch.linked(lambda n: 1 - 0.75 * heard.rng.random(n) ** 2)
        share = 1.5 * strength**0.5 * ivy * np.sqrt(power) * same_side * watch.away / way
        late = np.maximum(way - watch.away, 1.0) / METRES
        heard.again(np.minimum(share, 0.85) * heard.any_phase(), late, struck)


def _turf(heard: Heard, strength: float) -> None:
    longer, share = turf_ray(heard.watch(), strength)
    heard.again(share, longer / METRES, heard.sound())


def _behind_the_tower(heard: Heard, strength: float) -> None:
    """Lose, behind the tower, what comes straight: round it comes less, and less once more."""
    watch, sound = heard.watch(), heard.sound()
    behind = watch.linked(lambda n: np.where(heard.rng.random(n) < 0.21, 1.0, 0.0))
    heard.soften(1 - 0.985 * behind[:, None] * heard.sounding() * heard.striking())
    begin = watch.linked(lambda n: heard.rng.triangular(2.2, 3.2, 4.8, n)) * 0.5 * (1 + strength)
    apart = watch.linked(lambda n: heard.rng.uniform(1.4, 3.4, n))
    for number in range(5):
        share = behind * 0.38 / (1 + 0.28 * number) * heard.rng.triangular(0.8, 1, 1.2, len(heard))
        heard.again(share * heard.any_phase(), begin + apart * number, sound)


def _leaves(heard: Heard, strength: float) -> None:
    """Fade by sums of six waves from leaves beside one that is steady (Clarke 1968)."""
    shape = (len(heard), 6, 1)
    turns = heard.rng.uniform(0, 0.11, shape) * BEAT + heard.rng.random(shape)
    loose = np.exp(2j * np.pi * turns).sum(axis=1) / np.sqrt(6)
    part = min(0.16 * strength, 0.7)
    size = np.abs(np.sqrt(1 - part) + np.sqrt(part) * loose)
    heard.soften(1 + heard.sounding() * (size / np.sqrt(np.mean(size**2)) - 1))


def _stretched(heard: Heard, strength: float) -> None:
    """Scatter among stones and leaves: a stretched exponential of the delay."""
    past = np.maximum(heard.past - 4.0, 0.0)
    power = 0.045 * strength * np.exp(-np.sqrt(past / 9.0)) * (past > 0)
    rough = np.sqrt(power / 2) * rustle(heard.rng, len(heard))
    heard.wave = heard.wave + heard.stroke()[:, None] * rough


def _steep_filter(heard: Heard, strength: float) -> None:
    """Ring as a filter with steep sides does: a sine by the lag, at the sides of its band."""
    side = 0.2 + 0.12 * heard.stays(1).random()
    lags = np.arange(4, 46)
    answer = 1.3 * min(strength, 2.5) * np.sin(2 * np.pi * side * lags) / lags
    sound, rung = heard.sound(), heard.wave.copy()
    for lag, part in zip(lags.tolist(), answer.tolist(), strict=True):
        rung[:, lag:] += part * sound[:, :-lag]
    heard.wave = rung


def _town(heard: Heard, strength: float) -> None:
    heard.hiss(np.asarray(EFFECTS["noise-floor"](heard.watch(), strength).hiss))


def _broadcast(heard: Heard, strength: float) -> None:
    """Hear a transmitter on a hill at high gargoyles: a carrier with a tone on its size."""
    pitch, tone = heard.stays(2).uniform([-0.42, 0.03], [0.42, 0.09])
    high = 0.5 + np.sqrt(GARGOYLES_M[:, 2] / 14.0) * heard.stays(3).uniform(0.7, 1.2, 8)
    size = strength * high[heard.watch().gargoyle]
    swell = 1 + 0.45 * np.cos(2 * np.pi * (tone * BEAT + heard.rng.random((len(heard), 1))))
    carrier = np.exp(2j * np.pi * pitch * BEAT) * heard.any_phase()[:, None]
    heard.wave = heard.wave + (size * heard.sigma)[:, None] * swell * carrier
    heard.rustling = heard.rustling * _beside(size)
    heard.sigma = heard.sigma * np.sqrt(1 + 0.55 * size**2)


def _beside(size: Floats) -> Floats:
    """Return how many times more sizes scatter in a while beside such a carrier [n]: by trial.

    Its tone is slow: what it adds in the few samples before first paths is a part of its sway.
    """
    rng = np.random.default_rng(947)
    noise = rng.standard_normal(16000) + 1j * rng.standard_normal(16000)
    swell = 1 + 0.45 * np.cos(2 * np.pi * rng.random(16000))
    tried = np.linspace(0, 6.5, 27)
    spread = [np.abs(noise + one * swell).std() for one in tried]
    return np.asarray(np.interp(size, tried, np.array(spread) / spread[0]))


def _switched(heard: Heard, strength: float) -> None:
    """Hear, from a sample on, by the other antenna of a mason, which hears more or less."""
    db = heard.stays(4).choice([-7.0, -3.5, 1.5], MASONS) * heard.stays(5).uniform(0.8, 1.2, MASONS)
    gain = 10 ** (min(strength, 2.0) * db[heard.watch().mason] / 20)
    heard.wave = heard.wave * (1 + heard.from_(16.0, 1.5) * (gain[:, None] - 1))


def _peaks(heard: Heard, strength: float) -> None:
    """Leave a display's peak detector on: late samples show the largest of five, in part."""
    size = np.abs(heard.wave)
    wide = np.pad(size, ((0, 0), (2, 2)), mode="edge")
    peak = np.lib.stride_tricks.sliding_window_view(wide, 5, axis=1).max(axis=2)
    part = min(0.6 * strength, 1.0) * heard.from_(10.0)
    heard.wave = heard.wave * (1 + part * (peak / np.maximum(size, 1e-9) - 1))


def _interleaved(heard: Heard, strength: float) -> None:
    """Leave late words as an interleaver wrote them: row by row, and read column by column.

    In blocks of eight by eight, in a part of the frames.
    """
    part = min(0.85 * strength, 1.0)
    begin = np.ceil(heard.attack).astype(np.intp) + 9
    order = np.arange(64).reshape(8, 8).T.ravel()
    past = np.arange(len(BEAT)) - begin[:, None]
    source = begin[:, None] + 64 * (past // 64) + order[past % 64]
    inside = (past >= 0) & (source < len(BEAT))
    moved = np.take_along_axis(heard.wave, np.where(inside, source, 0), axis=1)
    mixed = (1 - part) * heard.wave + part * moved
    heard.wave = np.where(inside, mixed, heard.wave)


def _dithered(heard: Heard, strength: float) -> None:
    """Round both components to steps beside a grid that lies elsewhere in each record."""
    step = 1.75 * strength * float(np.median(heard.sigma))
    grid = heard.rng.uniform(-0.5, 0.5, (2, len(heard), 1))
    parts = (heard.wave.real, heard.wave.imag)
    real, imaginary = (step * (np.rint(x / step - g) + g) for x, g in zip(parts, grid, strict=True))
    heard.wave = real + 1j * imaginary
    heard.rustling = heard.rustling * np.array([_rounded(*pair) for pair in zip(
        step / heard.sigma, grid[:, :, 0].T, strict=True)])  # fmt: skip


def _rounded(step: float, grid: Floats) -> float:
    """Return how many times more noise's sizes scatter when rounded beside such a grid [2]."""
    noise = np.random.default_rng(948).standard_normal((2, 1500))
    there = step * (np.rint(noise / step - grid[:, None]) + grid[:, None])
    return max(float(np.hypot(*there).std() / np.hypot(*noise).std()), 0.05)


def _dulled(heard: Heard, strength: float) -> None:
    """Ask more of a first pulse, and take it after it rises fastest."""
    heard.dulled = 0.95 * strength


CLOSE: tuple[tuple[str, Callable[[Heard, float], None]], ...] = (
    ("specular-reflections", _masonry),
    ("ground-bounce", _turf),
    ("obstructed-path", _behind_the_tower),
    ("small-scale-fading", _leaves),
    ("diffuse-tail", _stretched),
)
RADIO: tuple[tuple[str, Callable[[Heard, float], None]], ...] = (
    ("pulse-ringing", _steep_filter),
    ("noise-floor", _town),
    ("narrowband-interference", _broadcast),
    ("antenna-switched-midway", _switched),
    ("peak-detector-left-on", _peaks),
    ("interleaver-left-on", _interleaved),
    ("quantisation", _dithered),
    ("late-detection", _dulled),
)
WAVES = dict(CLOSE + RADIO)


def ring(heard: Heard, names: tuple[str, ...], strength: float) -> None:
    """Add effects to waveforms: those of the close, those of rows, those of the radio."""
    for name, act in CLOSE:
        if name in names:
            act(heard, strength)
    for name in names:
        if name not in WAVES:
            heard.toll(EFFECTS[name](heard.watch(), strength))
    for name, act in RADIO:
        if name in names:
            act(heard, strength)
