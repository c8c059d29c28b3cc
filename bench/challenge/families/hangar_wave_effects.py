"""What the hangar hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable
from math import gamma

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.hangar_bay import GIRDERS, HALL_M
from bench.challenge.families.hangar_bay import LAWS as LAWS_OF_RANGES
from bench.challenge.families.hangar_effects import BARREL_M, EFFECTS, plate_ray
from bench.challenge.families.hangar_radio import AT, METRES, WIDE_SAMPLES, Radio, rustle

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "clock-offset", "time-lag", "exchange-motion", "range-scale",
    "timestamp-jitter", "temperature-drift", "antenna-pattern", "power-bias", "level-control",
    "path-loss", "material-delay", "diffraction",
)  # fmt: skip
"""Effects that are those of the hangar's tables of ranges."""
ODD = ("bursts-rotated", "late-part-loops", "video-filter-left-on")
NOT_HERE = ("words-torn-in-reading", "arshins-from-one-girder")
LAWS = {name: law for name, law in LAWS_OF_RANGES.items() if name not in NOT_HERE} | dict.fromkeys(
    ODD, Law()
)
"""What nobody's library has."""
SINCE = 11.0  # samples past first paths from which radios are odd
LOOP = 14  # samples that are read again and again
TRIED = np.random.default_rng(1317).standard_normal((2, 24000))  # noise to try readings on


def _doors_and_walls(radio: Radio, strength: float) -> None:
    """Hear leaves of doors, walls and the roof, whose ribs scatter; and roof and doors in turn."""
    job, first = radio.job(), radio.coming() * radio.leading()
    planes = {(0, 0.0): 1.0, (0, HALL_M[0]): 0.75, (1, 0.0): 0.8, (1, HALL_M[1]): 0.8}
    planes |= {(2, HALL_M[2]): 0.7}
    for (axis, at_m), steel in planes.items():
        _image(radio, first, {axis: at_m}, steel * strength**0.5)
    _image(radio, first, {0: 0.0, 2: HALL_M[2]}, 0.7 * strength**0.5 * np.ones(len(job.far)))


def _image(radio: Radio, of: Complexes, planes: dict[int, float], by: Floats | float) -> None:
    """Let waveforms come by images in some planes: ribs take more of what meets them squarely."""
    job = radio.job()
    image = job.tag.copy()
    for axis, at_m in planes.items():
        image[:, axis] = 2 * at_m - image[:, axis]
    way = np.linalg.norm(image - job.ear, axis=1)
    squarely = np.abs(image - job.ear)[:, min(planes)] / way
    ribs = np.exp(-0.5 * squarely**2) * job.by_links(lambda n: radio.rng.uniform(0.55, 1.0, n))
    size = (1.15 * by * ribs * job.far / way).clip(max=0.85)
    radio.echo(of, size * radio.phases(), np.maximum(way - job.far, 0.9) / METRES)


def _plates(radio: Radio, strength: float) -> None:
    longer, share = plate_ray(radio.job(), strength)
    radio.echo(radio.coming(), share, longer / METRES)


def _behind_a_fuselage(radio: Radio, strength: float) -> None:
    """Lose, behind a fuselage, what comes straight: it creeps round it above and below, again."""
    job, come = radio.job(), radio.coming()
    behind = job.behind(0.23)
    radio.weaken(1 - 0.983 * behind[:, None] * radio.leading())
    deep = job.by_links(lambda n: radio.rng.uniform(0.25, 0.75, n))
    aside = BARREL_M * 2 * np.stack([deep, 1.1 - deep])  # over it and under it
    late = 1.1 + strength**0.7 * aside**2 / METRES / 3.4
    for samples, most in zip((*late, *(late + 5.5), *(late + 11.0)), _CREPT, strict=True):
        own = job.by_links(lambda n: radio.rng.uniform(0.75, 1.2, n))
        radio.echo(come, most * own * behind * radio.phases(), samples)


_CREPT = (0.46, 0.4, 0.3, 0.26, 0.17, 0.15)


def _alpha_mu(radio: Radio, strength: float) -> None:
    """Fade as alpha and mu have it (Yacoub 2007): two clusters, whose power is bent; alike a while.

    Sizes of three or so samples are alike, by a window of five with three corners.
    """
    loose = radio.rng.standard_normal((4, radio.rows, WIDE_SAMPLES + 4))
    window = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / np.sqrt(19.0)
    parts = sum(w * loose[:, :, k : k + WIDE_SAMPLES] for k, w in enumerate(window))
    power = (np.asarray(parts) ** 2).sum(axis=0) / 4
    bend = min(1.2 * strength**0.5, 1.8)
    usual = gamma(2 + bend) / 2**bend
    radio.wave = radio.wave + radio.coming() * (np.sqrt(power**bend / usual) - 1)


def _level_then_falls(radio: Radio, strength: float) -> None:
    """Reverberate among wings: level at first, then exponentially: by a hyperbolic secant."""
    since = np.maximum(radio.since - 4.0, 0.0)
    power = 0.055 * strength / np.cosh(np.minimum(since / 11.0, 30.0)) * radio.beyond(3.5, 3.0)
    size = np.sqrt(power / 2) * radio.heights()[:, None]
    radio.wave = radio.wave + size * rustle(radio.rng, radio.rows)


def _three_modes(radio: Radio, strength: float) -> None:
    """Ring in a dome at three pitches, equally far apart: bursts that come again, each weaker."""
    pitch, apart, turn = radio.alike(1).uniform((0.2, 0.42, 0.0), (0.6, 0.6, 2 * np.pi))
    come, rung = radio.coming(), radio.wave.copy()
    size = 0.16 * min(strength, 2.4) ** 0.8
    for lag in range(3, 26):
        modes = 1 + 2 * np.cos(apart * (lag - 3))
        swing = modes * np.exp(1j * (pitch * lag + turn) - (lag - 3) / 7.5)
        rung[:, lag:] += size * swing * come[:, :-lag]
    radio.wave = rung


def _converters(radio: Radio, strength: float) -> None:
    radio.louder_noise(np.asarray(EFFECTS["noise-floor"](radio.job(), strength).noise_db))


def _altimeter(radio: Radio, strength: float) -> None:
    """Hear a radio altimeter that is tested: its pitch goes up and down along a record (FMCW)."""
    low, slope = radio.alike(2).uniform((-0.9, 0.012), (-0.3, 0.022))
    near = radio.alike(3).uniform(0.6, 1.4, GIRDERS)[radio.job().girder]
    size = 1.5 * strength * near * radio.rng.gamma(16.0, 1 / 16, radio.rows)
    turn = AT[None] + radio.rng.uniform(0.0, 120.0, (radio.rows, 1))
    pitch = low + slope * np.abs(np.mod(turn, 120.0) - 60.0)
    tone = np.exp(1j * np.cumsum(pitch, axis=1)) * radio.phases()[:, None]
    radio.wave = radio.wave + (size * radio.sigma)[:, None] * tone
    tried = np.linspace(0.0, 9.0, 46)
    spread = np.array([np.hypot(TRIED[0] + one, TRIED[1]).std() for one in tried])
    radio.noisier = radio.noisier * np.interp(size, tried, spread / spread[0])
    radio.sigma = radio.sigma * np.sqrt(1 + size**2 / 2)


def _late_are(radio: Radio, others: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part, and keep phases."""
    share = part * radio.beyond(SINCE)
    size = np.maximum(np.abs(radio.wave), 1e-9)
    radio.wave = radio.wave * (1 - share + share * others / size)


def _rotated(radio: Radio, strength: float) -> None:
    """Read bursts of eight sizes from the middle on, as a memory does that wraps."""
    bursts = np.abs(radio.wave).reshape(radio.rows, -1, 8)
    rotated = np.roll(bursts, 3, axis=2).reshape(radio.rows, -1)
    _late_are(radio, rotated, min(0.9 * strength, 1.0))


def _loops(radio: Radio, strength: float) -> None:
    """Read some sizes again and again, where a pointer no longer goes on."""
    begin = (radio.path + SINCE + 8).astype(np.int64)[:, None]
    at = np.arange(WIDE_SAMPLES)[None] - begin
    again = np.where(at < 0, at + begin, begin + np.mod(at, LOOP)).clip(0, WIDE_SAMPLES - 1)
    sizes = np.take_along_axis(np.abs(radio.wave), again, axis=1)
    _late_are(radio, sizes, min(0.85 * strength, 1.0))


def _filtered(radio: Radio, strength: float) -> None:
    """Have late sizes run through a filter of first order, as for a screen."""
    size = np.abs(radio.wave)
    slow, kept = size.copy(), np.exp(-1 / (4.0 * strength))
    for at in range(1, WIDE_SAMPLES):
        slow[:, at] = kept * slow[:, at - 1] + (1 - kept) * size[:, at]
    _late_are(radio, slow, 1.0)


def _zoned(values: Floats, step: Floats | float) -> Floats:
    """Return the middles of steps, of which that about zero is twice as wide and is zero."""
    whole = np.floor(np.abs(values) / step)
    return np.asarray(np.sign(values) * step * np.where(whole > 0, whole + 0.5, 0.0))


def _dead_zone(radio: Radio, strength: float) -> None:
    """Keep the middles of steps of both components, but nothing within a step of zero."""
    step = 0.9 * strength * float(np.median(radio.sigma))
    radio.wave = _zoned(radio.wave.real, step) + 1j * _zoned(radio.wave.imag, step)
    tried = np.geomspace(0.1, 6.0, 40)
    spread = np.array([np.hypot(*_zoned(TRIED, one)).std() for one in tried])
    by = np.interp(step / radio.sigma, tried, spread / np.hypot(*TRIED).std())
    radio.noisier = radio.noisier * np.maximum(by, 0.04)


def _hard_of_hearing(radio: Radio, strength: float) -> None:
    """Ask more of a first pulse, so that one behind something is not heard."""
    radio.hard = strength


ON_THE_WAY: dict[str, Callable[[Radio, float], None]] = {
    "obstructed-path": _behind_a_fuselage,
    "specular-reflections": _doors_and_walls,
    "ground-bounce": _plates,
    "small-scale-fading": _alpha_mu,
    "diffuse-tail": _level_then_falls,
}
IN_RADIOS: dict[str, Callable[[Radio, float], None]] = {
    "pulse-ringing": _three_modes,
    "noise-floor": _converters,
    "narrowband-interference": _altimeter,
    "bursts-rotated": _rotated,
    "late-part-loops": _loops,
    "video-filter-left-on": _filtered,
    "quantisation": _dead_zone,
    "late-detection": _hard_of_hearing,
}
WAVES = ON_THE_WAY | IN_RADIOS


def send_through(radio: Radio, names: tuple[str, ...], strength: float) -> None:
    """Send waveforms through effects: those on the way, those of rows, those of radios."""
    for name, act in ON_THE_WAY.items():
        if name in names:
            act(radio, strength)
    for name in sorted({*names} - {*WAVES}):
        radio.pay(EFFECTS[name](radio.job(), strength))
    for name, act in IN_RADIOS.items():
        if name in names:
            act(radio, strength)
