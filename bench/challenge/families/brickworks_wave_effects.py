"""What the brickworks hides in waveforms: effects in forms of its own, oddities of its readers.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.brickworks_effects import EFFECTS, plate_ray
from bench.challenge.families.brickworks_reader import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Reader,
    rustle,
)
from bench.challenge.families.brickworks_yard import BUCKSTAYS, HALL_M, WAVE_M
from bench.challenge.families.brickworks_yard import LAWS as LAWS_OF_ROWS
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the brickworks' tables of ranges."""
ODD = ("haar-left-in", "teager-left-on", "angles-read-for-sizes")
ELSEWHERE = ("kiln-bed-heaves", "alnar-from-one-buckstay")
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name not in ELSEWHERE}
LAWS |= {name: Law() for name in ODD}
"""What nobody's library has."""
FROM = 10.5  # samples past edges from which readers are odd
BRICK, THICK_M, SHEET = 3.91 - 0.1j, 0.365, 0.82  # a wall; what a sheet of steel returns
TRIED: Complexes = rustle(np.random.default_rng(1608), 130)  # noise to try readings on


def _wall(squarely: Floats) -> Floats:
    """Return how much walls return, met more or less squarely [n]: both of their faces do.

    Whatever phase these have: the mean of a slab's over half a wave of its thickness.
    """
    inside = np.sqrt(BRICK - 1 + squarely**2)
    face = (squarely - inside) / (squarely + inside)
    thick_m = THICK_M + np.linspace(0.0, 0.02, 9)[:, None]
    through = np.exp(-4j * np.pi * thick_m * inside / WAVE_M)
    both = face * (1 - through) / (1 - face**2 * through)
    return np.asarray(np.sqrt((np.abs(both) ** 2).mean(axis=0)))


def _walls_and_roof(reader: Reader, strength: float) -> None:
    """Hear four walls of brick and the roof's sheets, by images of readers."""
    first, push = reader.came() * reader.leading(), reader.push()
    planes = [(0, 0.0), (0, HALL_M[0]), (1, 0.0), (1, HALL_M[1]), (2, HALL_M[2])]
    for axis, plane_m in planes:
        apart = push.there - push.hung
        apart[:, axis] = push.there[:, axis] + push.hung[:, axis] - 2 * plane_m
        way = np.linalg.norm(apart, axis=1)
        squarely = np.abs(apart[:, axis]) / way
        back = SHEET * np.ones(push.rows) if axis == 2 else _wall(squarely)
        free = push.each_link(lambda n: reader.rng.beta(4.0, 1.6, n))
        size = (1.75 * strength**0.5 * free * back * push.far / way).clip(max=0.85)
        reader.repeat(first, size * reader.turned(), np.maximum((way - push.far) / METRES, 2.7))


def _plates(reader: Reader, strength: float) -> None:
    longer, share = plate_ray(reader.push(), strength)
    reader.repeat(reader.came(), share, longer / METRES)


def _behind_ware(reader: Reader, strength: float) -> None:
    """Lose what comes straight behind stacks of ware; the rest comes through gaps, as it finds."""
    push, air = reader.push(), reader.came()
    there = push.behind(0.22)
    reader.fade(1 - 0.985 * there[:, None] * reader.leading())
    nearest = 1.25 + 1.7 * strength**0.7 * push.each_link(lambda n: reader.rng.beta(4.0, 3.0, n))
    for gap, size in enumerate((0.47, 0.36, 0.28, 0.19, 0.12)):
        own = size * push.each_link(lambda n: reader.rng.triangular(0.75, 1.0, 1.2, n))
        since = gap * push.each_link(lambda n: reader.rng.uniform(1.4, 3.4, n))
        reader.repeat(air, own * there * reader.turned(), nearest + since)


def _unequal_parts(reader: Reader, strength: float) -> None:
    """Fade by two parts that are unlike in size (Hoyt 1947), alike while pulses last."""
    part = 0.35
    soft = np.cos(np.linspace(-0.5, 0.5, 11)[1:-1] * np.pi)
    loose = reader.rng.standard_normal((2, reader.rows, WIDE_SAMPLES + len(soft) - 1))
    smooth = np.stack(
        [
            sum(by * one[:, k : k + WIDE_SAMPLES] for k, by in enumerate(soft.tolist()))
            for one in loose
        ]
    ) / np.sqrt((soft**2).sum())
    power = (smooth[0] ** 2 + (part * smooth[1]) ** 2) / (1 + part**2)
    mixed = min(0.55 * strength**0.6, 0.84)
    reader.wave = reader.wave + reader.came() * (np.sqrt(1 - mixed + mixed * power) - 1)


def _coupled(reader: Reader, strength: float) -> None:
    """Reverberate in an aisle and in the hall that it opens to: by two exponentials, one slow."""
    since = np.maximum(reader.since - 3.4, 0.0)
    both = 0.055 * np.exp(-since / 9.0) + 0.026 * np.exp(-since / 36.0)
    power = strength * both * reader.from_on(3.4, 2.4)
    reader.hisses(np.sqrt(power / 2) * reader.tops()[:, None])


def _slotted_guide(reader: Reader, strength: float) -> None:
    """Ring as slotted guides do, whose pitch falls to that of their cutoff.

    A guide's answer is J1(w r) / r of r = root(t^2 - a^2); of r that are not small a cosine over
    r^1.5 (Jackson, Classical Electrodynamics, 8.3).
    """
    cutoff, begun = reader.shared(1).uniform((0.55, 2.6), (0.95, 3.4))
    lags = np.arange(4, 40)
    root = np.sqrt(lags**2 - begun**2)
    rung = np.exp(1j * (cutoff * root - 0.75 * np.pi)) / (root / root[0]) ** 1.5
    air, wave = reader.came(), reader.wave.copy()
    for lag, one in zip(lags.tolist(), rung, strict=True):
        wave[:, lag:] += 0.34 * min(strength, 2.4) ** 0.8 * one * air[:, :-lag]
    reader.wave = wave


def _converters(reader: Reader, strength: float) -> None:
    db = EFFECTS["noise-floor"](reader.push(), strength).hiss_db
    reader.hiss_more(np.zeros(reader.rows) + db)


def _louder(spread: Floats, tried: Floats, of: Floats) -> Floats:
    """Return how many times more sizes of noise scatter, of some that were tried [n]."""
    return np.asarray(np.interp(of, tried, spread / np.abs(TRIED).std()))


def _telemetry(reader: Reader, strength: float) -> None:
    """Hear the rams' telemetry: a carrier that is turned over for each bit that is one (PSK)."""
    pitch = reader.shared(2).uniform(-1.4, -0.4)
    near = reader.shared(3).lognormal(-0.05, 0.3, BUCKSTAYS)[reader.push().buckstay]
    size = 1.6 * strength * near * reader.rng.triangular(0.6, 1.0, 1.4, reader.rows)
    bit = (PLACES + reader.rng.uniform(0.0, 24.0, (reader.rows, 1))) // 24.0
    ones = reader.rng.integers(0, 2, (reader.rows, WIDE_SAMPLES // 24 + 2))
    turned = np.take_along_axis(1 - 2 * ones, bit.astype(np.int64), axis=1)
    tone = (reader.turned() * size * reader.sigma)[:, None] * np.exp(1j * pitch * PLACES)
    reader.wave = reader.wave + turned * tone
    tried = np.linspace(0.0, 12.0, 61)
    spread = np.array([np.abs(TRIED + one).std() for one in tried])
    reader.noisier = reader.noisier * _louder(spread, tried, size)
    reader.sigma = reader.sigma * np.sqrt(1 + size**2 / 2)


def _mid_riser(waves: Complexes, step: float) -> Complexes:
    """Return waveforms in steps of both parts: the middle of each, so that nothing is none."""
    both = np.stack([waves.real, waves.imag])
    return np.asarray(step * ((np.floor(both / step) + 0.5) * np.array([[[1.0]], [[1j]]])).sum(0))


def _steps(reader: Reader, strength: float) -> None:
    """Keep middles of steps, of both parts."""
    step = 1.3 * strength * float(np.median(reader.sigma))
    reader.wave = _mid_riser(reader.wave, step)
    tried = np.geomspace(0.05, 9.0, 60)
    spread = np.array([np.abs(_mid_riser(TRIED, float(one))).std() for one in tried])
    reader.noisier = reader.noisier * _louder(spread, tried, step / reader.sigma).clip(0.05)


def _dull(reader: Reader, strength: float) -> None:
    """Ask more of a first pulse, as where a burner's sparks were once in the way."""
    reader.dull = strength


def _odd(reader: Reader, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    by = sizes / np.maximum(np.abs(reader.wave), 1e-9)
    reader.wave = reader.wave * (1 + part * reader.from_on(FROM) * (by - 1))


def _haar(reader: Reader, strength: float) -> None:
    """Show late sizes as packed by Haar's transform of eight, and never unpacked."""
    whole = WIDE_SAMPLES // 8 * 8
    means = np.abs(reader.wave)[:, :whole].reshape(reader.rows, -1, 8)
    parts: list[Floats] = []
    while means.shape[2] > 1:
        pair = means.reshape(*means.shape[:2], -1, 2)
        parts.insert(0, (pair[..., 0] - pair[..., 1]) / np.sqrt(2))
        means = pair.sum(axis=3) / np.sqrt(2)
    packed = np.concatenate([means, *parts], axis=2).reshape(reader.rows, whole)
    sizes = np.abs(reader.wave)
    sizes[:, :whole] = np.abs(packed)
    _odd(reader, sizes, min(1.1 * strength, 1.0))


def _usual(reader: Reader, late: Floats) -> Floats:
    """Return how large late sizes are, by roots of their mean squares [n, 1]."""
    power = np.average(np.abs(reader.wave) ** 2, axis=1, weights=late + 1e-12)
    return np.asarray(np.sqrt(power)[:, None])


def _teager(reader: Reader, strength: float) -> None:
    """Show late samples' energy by Teager (Kaiser 1990): a square less what is beside it."""
    size = np.abs(reader.wave)
    energy = size**2
    energy[:, 1:-1] -= size[:, :-2] * size[:, 2:]
    usual = _usual(reader, reader.from_on(FROM))
    _odd(reader, np.abs(energy) ** 0.75 / np.sqrt(usual), min(0.9 * strength, 1.0))


def _angles(reader: Reader, strength: float) -> None:
    """Show angles in place of late sizes: what turns vectors tells both, by two registers."""
    late = reader.from_on(FROM)
    angle = np.abs(np.angle(reader.wave)) / np.pi
    _odd(reader, 2.2 * _usual(reader, late) * angle, min(0.9 * strength, 1.0))


IN_THE_HALL: dict[str, Callable[[Reader, float], None]] = {
    "obstructed-path": _behind_ware,
    "specular-reflections": _walls_and_roof,
    "ground-bounce": _plates,
    "small-scale-fading": _unequal_parts,
    "diffuse-tail": _coupled,
}
IN_READERS: dict[str, Callable[[Reader, float], None]] = {
    "pulse-ringing": _slotted_guide,
    "noise-floor": _converters,
    "narrowband-interference": _telemetry,
    "haar-left-in": _haar,
    "teager-left-on": _teager,
    "angles-read-for-sizes": _angles,
    "quantisation": _steps,
    "late-detection": _dull,
}
WAVES = IN_THE_HALL | IN_READERS


def pass_all(reader: Reader, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms pass what is in the hall, what becomes of rows, and what is in readers."""
    for name, happens in IN_THE_HALL.items():
        if name in names:
            happens(reader, strength)
    for name in sorted({*names} - {*WAVES}):
        reader.take(EFFECTS[name](reader.push(), strength))
    for name, happens in IN_READERS.items():
        if name in names:
            happens(reader, strength)
