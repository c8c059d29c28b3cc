"""What the printworks hides in waveforms: effects in forms of its own, oddities of its consoles.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.printworks_console import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Console,
    spline,
)
from bench.challenge.families.printworks_console import rush as noise_of
from bench.challenge.families.printworks_effects import EFFECTS, off_the_floor
from bench.challenge.families.printworks_hall import HALL_M, STANCHIONS
from bench.challenge.families.printworks_hall import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "antenna-delay", "antenna-pattern", "clock-offset", "diffraction", "exchange-motion",
    "level-control", "material-delay", "path-loss", "power-bias", "range-scale",
    "temperature-drift", "time-lag", "timestamp-jitter",
)  # fmt: skip
"""Effects that are those of the printworks' tables of ranges."""
ODD = ("parts-added-for-sizes", "pulse-matched-once-more", "kept-until-they-differ")
ELSEWHERE = ("wheels-of-unlike-size", "ellen-from-one-stanchion")
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name not in ELSEWHERE}
LAWS |= dict.fromkeys(ODD, Law())
"""What nobody's library has."""
FROM = 10.5  # samples past edges from which consoles are odd
MESH, SKIN = 0.62, 0.5  # how far sheets' holes let through; what the roof's skin returns
CELLS, PITCH = 2, 0.95  # of a row of grippers, that ring by handing on; radians a sample
TRIED: Complexes = noise_of(np.random.default_rng(1808), 140)  # noise to try readings on


def _perforated(console: Console, strength: float) -> None:
    """Hear four walls of perforated sheets, which let through the more the straighter it comes.

    As meshes do that are narrow next to waves (Ulrich 1967); and the roof's skin.
    """
    sheet, first = console.sheet(), console.by_air() * console.straight()
    for axis, plane_m in ((1, 0.0), (1, HALL_M[1]), (0, 0.0), (0, HALL_M[0]), (2, HALL_M[2])):
        apart = sheet.there - sheet.hung
        apart[:, axis] = sheet.there[:, axis] + sheet.hung[:, axis] - 2 * plane_m
        way = np.linalg.norm(apart, axis=1)
        straight = np.abs(apart[:, axis]) / way
        back = SKIN if axis == 2 else 1 / np.sqrt(1 + (2 * MESH * straight) ** 2)
        free = sheet.by_link(lambda n: console.rng.triangular(0.25, 0.75, 1.0, n))
        size = (1.5 * np.sqrt(strength) * free * back * sheet.far / way).clip(max=0.8)
        console.echo(first, size * console.phases(), ((way - sheet.far) / METRES).clip(2.8))


def _floor(console: Console, strength: float) -> None:
    longer, share = off_the_floor(console.sheet(), strength)
    console.echo(console.by_air(), share, longer / METRES)


def _by_rollers(console: Console, strength: float) -> None:
    """Lose what comes straight behind towers: it comes off rollers, one above the other."""
    sheet, air = console.sheet(), console.by_air()
    there = sheet.behind(0.2)
    console.weaken(-36.0 * there[:, None] * console.straight())
    base = 1.3 + 1.8 * strength**0.7 * sheet.by_link(
        lambda n: console.rng.triangular(0.1, 0.5, 1, n)
    )
    apart = sheet.by_link(lambda n: console.rng.uniform(3.0, 5.2, n))
    for roller in range(7):
        size = 0.5 * there / (1 + 0.35 * roller) * console.rng.uniform(0.6, 1.2, console.size)
        late = base + np.sqrt(2.0**2 + (roller * apart) ** 2) - 2.0
        console.echo(air, size * console.phases(), late)


def _wave_of_chance(console: Console) -> Complexes:
    """Return a wave of chance with a power of 1, alike while pulses last [n, k]."""
    pitches = 2 * np.pi * np.arange(-11, 12)[:, None] * PLACES / WIDE_SAMPLES
    weight = np.exp(-0.5 * (np.arange(-11, 12) / 6.0) ** 2)
    lots = console.rng.normal(size=(console.size, 23, 2)) @ np.array([1.0, 1.0j])
    waves = (lots * weight / np.sqrt(2 * (weight**2).sum())) @ np.exp(1j * pitches)
    return np.asarray(waves, np.complex128)


def _keyhole(console: Console, strength: float) -> None:
    """Fade as through a keyhole between towers: by products of two waves (Chizhik 2002)."""
    faded = _wave_of_chance(console) * _wave_of_chance(console)
    mixed = min(0.12 * strength**0.6, 0.6)
    by = np.sqrt(1 - mixed) + np.sqrt(mixed) * faded
    usual = np.sqrt((np.abs(by) ** 2).mean())
    console.wave = console.wave + console.by_air() * (np.abs(by) / usual - 1)


def _diffuses(console: Console, strength: float) -> None:
    """Diffuse among towers as light does in fog: by first passages, and what is absorbed."""
    since = np.maximum(console.since - 3.0, 1e-3)
    power = since**-1.5 * np.exp(-5.5 / since - since / 60.0)
    power = 0.95 * power * (console.since > 3.0)
    console.add_noise(np.sqrt(strength * power / 2) * console.height()[:, None])


def ladder(lag: Floats) -> Floats:
    """Return what a row of equal cells hands on after so many samples: Bessel's J of CELLS."""
    turn = np.pi * (np.arange(64) + 0.5) / 64
    phase = CELLS * turn - PITCH * np.maximum(lag, 0.0)[:, None] * np.sin(turn)
    return np.asarray(np.cos(phase).mean(axis=1))


def _handed_on(console: Console, strength: float) -> None:
    """Ring in a row of grippers beside the antenna, each of which swings on the next."""
    begun, pitch = console.shared(1).uniform((1.5, 0.2), (3.5, 1.4))
    air, wave = console.by_air(), console.wave.copy()
    lags = np.arange(2, 40)
    rung = ladder(lags - begun) * np.exp(-0.055 * lags) * (lags > begun)
    for lag, part in zip(lags, 0.5 * min(strength, 2.4) ** 0.8 * rung, strict=True):
        wave[:, lag:] += part * np.exp(1j * pitch * lag) * air[:, :-lag]
    console.wave = wave


def _static_bars(console: Console, strength: float) -> None:
    db = EFFECTS["noise-floor"](console.sheet(), strength).noise_db
    console.raise_noise(np.full(console.size, db))


def _tell(console: Console, of: Floats, tried: Floats, made: list[Floats]) -> None:
    """Tell of noise what sizes of it scatter by: as tried, read at what is `of` a row [n]."""
    usual = np.abs(TRIED).std()
    spread = [float(one.std() / usual) for one in made]
    console.grown = console.grown * np.interp(of, tried, spread).clip(0.04)


def _trunked_radio(console: Console, strength: float) -> None:
    """Hear a harmonic of a trunked radio: phases step by odd eighths of a turn (pi/4-DQPSK)."""
    drawn = console.shared(2)
    pitch, near = drawn.uniform(-1.8, 1.8), drawn.lognormal(-0.1, 0.35, STANCHIONS)
    bits = console.rng.integers(4, size=(console.size, WIDE_SAMPLES // 9 + 3))
    steps = np.cumsum(0.25 * np.pi * (2 * bits - 3), axis=1)
    at = PLACES / 9 + console.rng.random((console.size, 1))
    now, part = at.astype(np.int64), np.clip(3 * (at % 1) - 1, 0.0, 1.0)
    one, other = (np.exp(1j * np.take_along_axis(steps, now + k, axis=1)) for k in (0, 1))
    size = 1.7 * strength * near[console.sheet().reader]
    tone = ((1 - part) * one + part * other) * np.exp(1j * pitch * PLACES)
    console.wave = console.wave + (console.sigma * size * console.phases())[:, None] * tone
    power = np.sqrt((np.abs(tone) ** 2).mean()) * size
    tried = np.linspace(0.0, 14.0, 57)
    _tell(console, power, tried, [np.abs(TRIED + one) for one in tried])
    console.sigma = console.sigma * np.sqrt(1 + power**2 / 2)


def differences(waves: Complexes, step: float) -> Complexes:
    """Return what is kept of waveforms by whole steps of what differs from 0.86 of the last."""
    kept, last = np.empty_like(waves), np.zeros(len(waves), np.complex128)
    for k in range(waves.shape[1]):
        off = (waves[:, k] - 0.86 * last) / step
        last = 0.86 * last + step * (np.rint(off.real) + 1j * np.rint(off.imag))
        kept[:, k] = last
    return kept


def _by_differences(console: Console, strength: float) -> None:
    """Keep whole steps of what differs from what was kept before, which leaks (DPCM)."""
    step = 1.9 * strength * float(np.median(console.sigma))
    console.wave = differences(console.wave, step)
    tried = np.geomspace(0.05, 12.0, 60)
    made = [np.abs(differences(TRIED, float(one))[:, 20:]) for one in tried]
    _tell(console, step / console.sigma, tried, made)


def _numb(console: Console, strength: float) -> None:
    """Ask more of a first pulse, as where static once struck an antenna."""
    console.numb = strength


def _show(console: Console, sizes: Floats, part: float) -> None:
    """Let late sizes be others [n, k] by a part; phases stay."""
    now = np.abs(console.wave).clip(1e-9)
    console.wave = console.wave * (1 + part * console.from_on(FROM) * (sizes / now - 1))


def _added(console: Console, strength: float) -> None:
    """Show sums of both parts' sizes for late sizes: roots of squares are left out."""
    wave = console.wave
    _show(console, np.abs(wave.real) + np.abs(wave.imag), min(1.2 * strength, 1.0))


def _matched(console: Console, strength: float) -> None:
    """Match late samples to a pulse once more, so that all is wider, and as large on average."""
    taps = spline(0.8 * np.arange(-3.0, 4.0))
    late = console.wave * console.from_on(FROM)
    wide = sum(
        by * np.roll(late, k, axis=1) for k, by in enumerate(taps / np.sqrt((taps**2).sum()), -3)
    )
    _show(console, np.abs(wide), min(strength, 1.0))


def _send_on_delta(console: Console, strength: float) -> None:
    """Show late sizes again until they are twice or half of it: what differs less is not sent."""
    size = np.abs(console.wave).clip(1e-9)
    shown, last = np.empty_like(size), size[:, 0]
    for k in range(WIDE_SAMPLES):
        last = np.where(np.abs(np.log2(size[:, k] / last)) > 1, size[:, k], last)
        shown[:, k] = last
    _show(console, shown, min(strength, 1.0))


IN_THE_HALL: dict[str, Callable[[Console, float], None]] = {
    "obstructed-path": _by_rollers,
    "specular-reflections": _perforated,
    "ground-bounce": _floor,
    "small-scale-fading": _keyhole,
    "diffuse-tail": _diffuses,
}
IN_CONSOLES: dict[str, Callable[[Console, float], None]] = {
    "pulse-ringing": _handed_on,
    "noise-floor": _static_bars,
    "narrowband-interference": _trunked_radio,
    "parts-added-for-sizes": _added,
    "pulse-matched-once-more": _matched,
    "kept-until-they-differ": _send_on_delta,
    "quantisation": _by_differences,
    "late-detection": _numb,
}
WAVES = IN_THE_HALL | IN_CONSOLES


def put_in(console: Console, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what becomes of rows, and what consoles do."""
    for name in (one for one in IN_THE_HALL if one in names):
        IN_THE_HALL[name](console, strength)
    for name in sorted({*names} - {*WAVES}):
        console.take(EFFECTS[name](console.sheet(), strength))
    for name in (one for one in IN_CONSOLES if one in names):
        IN_CONSOLES[name](console, strength)
