"""What the cannery hides in waveforms: effects in forms of its own, oddities of its scanners.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.cannery_effects import EFFECTS, by_rails, floor_ray
from bench.challenge.families.cannery_hall import BRACKETS_M, HALL_M, WAVE_M
from bench.challenge.families.cannery_hall import LAWS as LAWS_OF_RANGES
from bench.challenge.families.cannery_scanner import METRES, SAMPLE, Scan, fizz
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the cannery's tables of ranges."""
ODD = ("blocks-read-backwards", "spikes-taken-out", "refresh-steals-words")
LAWS = {
    name: law
    for name, law in LAWS_OF_RANGES.items()
    if law.forms and law.forms != ("unit",)
} | {name: Law() for name in ODD}  # fmt: skip
"""What nobody's library has."""
FROM = 11.0  # samples past first paths from which scanners are at fault
WAVES_M = 0.0115  # how far corrugated sheets go to and fro about their middle
TRIED = np.random.default_rng(1067).standard_normal((2, 30000))  # noise to try readings on


def _corrugated(scan: Scan, strength: float) -> None:
    """Hear four walls and the roof, of corrugated sheets, the less the more squarely they are met.

    By Bessel's J0: what is not grazed goes into other orders of a grating.
    """
    lot, heard = scan.lot(), scan.signal() * scan.first_pulse()
    ends = lot.tags(), lot.brackets()
    for axis, at in ((0, 0.0), (0, HALL_M[0]), (1, 0.0), (1, HALL_M[1]), (2, HALL_M[2])):
        off = [np.abs(end[:, axis] - at) for end in ends]
        way = np.sqrt(lot.far**2 + 4 * off[0] * off[1])
        kept = np.abs(_bessel(4 * np.pi / WAVE_M * WAVES_M * (off[0] + off[1]) / way))
        whole = lot.by_link(scan.rng.uniform, 0.55, 1.0)  # doors and windows are in it
        share = np.minimum(1.25 * strength**0.5 * kept * whole * lot.far / way, 0.9)
        scan.add_copy(share * scan.phasors(), np.maximum(way - lot.far, 0.8) / METRES, heard)


def _bessel(at: Floats) -> Floats:
    """Return Bessel's J0 at places [n]: the mean of a cosine round a circle."""
    round_it = np.sin(np.linspace(0.0, np.pi, 60, endpoint=False))
    return np.asarray(np.cos(at[:, None] * round_it).mean(axis=1))


def _floor(scan: Scan, strength: float) -> None:
    longer, share = floor_ray(scan.lot(), strength)
    scan.add_copy(share, longer / METRES, scan.signal())


def _behind_stacks(scan: Scan, strength: float) -> None:
    """Lose, behind stacks of tins, what comes straight: it comes by slits, and off both rails."""
    lot, heard = scan.lot(), scan.signal()
    stack, wide = lot.behind(0.26), 0.4 + 0.6 * strength
    scan.scale(1 - 0.982 * stack[:, None] * scan.first_pulse())
    late = wide * lot.by_link(scan.rng.uniform, 1.3, 2.6)
    for size in (0.3, 0.22, 0.16):  # slits are as far apart as tins are wide
        own = size * lot.by_link(scan.rng.uniform, 0.75, 1.2)
        scan.add_copy(stack * own * scan.phasors(), late, heard)
        late = late + wide * lot.by_link(scan.rng.uniform, 0.5, 1.1)
    for way in by_rails(lot):
        after = np.clip((way - lot.far) / METRES, 4.0, 40.0)
        scan.add_copy(0.34 * stack * lot.far / way * scan.phasors(), after, heard)


def _clusters(scan: Scan, strength: float) -> None:
    """Fade as waves in three clusters do, each beside a steady part (kappa-mu, Yacoub 2007)."""
    steady = 2.6 / min(strength, 4.0) + 0.15  # of power, next to what is loose
    parts = [_wandering(scan) + np.sqrt(2 * steady) for _ in range(3)]
    power = sum(np.abs(one) ** 2 for one in parts) / (6 * (1 + steady))
    scan.scale(1 + scan.since(-4.2) * (np.sqrt(power) - 1))


def _wandering(scan: Scan) -> Complexes:
    """Return chance with components of scatter 1 that goes on for some samples [n, k]."""
    fresh = scan.rng.standard_normal((2, scan.size, len(SAMPLE)))
    out = fresh[0] + 1j * fresh[1]
    for k in range(1, len(SAMPLE)):
        out[:, k] = 0.82 * out[:, k - 1] + np.sqrt(1 - 0.82**2) * out[:, k]
    return np.asarray(out)


def _steam(scan: Scan, strength: float) -> None:
    """Reverberate among steel until steam has taken it: exponentially, and by half a bell."""
    past = np.maximum(scan.past - 2.0, 0.0)
    power = 0.02 * strength * np.exp(-past / 23.0 - (past / 48.0) ** 2) * scan.since(3.5, 3.0)
    scan.wave = scan.wave + scan.height()[:, None] * np.sqrt(power / 2) * fizz(scan.rng, scan.size)


def _in_a_tin(scan: Scan, strength: float) -> None:
    """Ring as an open tin does: in three modes, whose pitches are as Bessel's zeros are."""
    turn, after = scan.shared(1).uniform(0.2, 0.34), np.arange(2, 27)
    swing = np.zeros(len(after), complex)
    for zero, lasts in ((1.841, 8.0), (2.405, 5.0), (3.054, 3.2)):
        swing += np.exp(1j * turn * (zero - 1.841) * 3 * after - after / lasts)
    heard, rung = scan.signal(), scan.wave.copy()
    for lag, one in zip(after.tolist(), 0.1 * min(strength, 2.4) * swing, strict=True):
        rung[:, lag:] += one * heard[:, :-lag]
    scan.wave = rung


def _drives(scan: Scan, strength: float) -> None:
    scan.noisier(np.zeros(scan.size) + EFFECTS["noise-floor"](scan.lot(), strength).noise_db)


def _data_link(scan: Scan, strength: float) -> None:
    """Hear a harmonic of scales' data link: a carrier whose phase is led by quarter turns (MSK).

    Each bit takes it a quarter of a turn forward or back within seven samples; some brackets hear
    more.
    """
    bits = np.repeat(scan.rng.integers(0, 2, (scan.size, len(SAMPLE) // 7 + 1)), 7, axis=1)
    swung = np.cumsum((2.0 * bits[:, : len(SAMPLE)] - 1) / 7, axis=1) * np.pi / 2
    pitch = scan.shared(2).uniform(0.9, 1.7)
    own = scan.shared(3).uniform(0.5, 1.6, len(BRACKETS_M))[scan.lot().bracket]
    size = 1.45 * strength * own * scan.rng.weibull(4.0, scan.size)
    tone = np.exp(1j * (swung + pitch * SAMPLE)) * scan.phasors()[:, None]
    scan.wave = scan.wave + (size * scan.sigma)[:, None] * tone
    scan.noise_by = scan.noise_by * _with_a_tone(size)
    scan.sigma = scan.sigma * np.sqrt(1 + size**2 / 2)


def _with_a_tone(size: Floats) -> Floats:
    """Return how many times more sizes of noise scatter beside a tone of sizes [n]: as tried."""
    tried = np.linspace(0.0, 12.0, 49)
    spread = np.array([np.hypot(TRIED[0] + one, TRIED[1]).std() for one in tried])
    return np.asarray(np.interp(size, tried, spread / spread[0]))


def _backwards(scan: Scan, strength: float) -> None:
    """Read late samples in blocks of ten, each from its end on: mixed with right ones."""
    at = np.arange(len(SAMPLE))
    turned = np.minimum(at // 10 * 10 + 9 - at % 10, len(at) - 1)
    part = min(0.8 * strength, 1.0) * scan.since(FROM + 2.0)
    scan.wave = (1 - part) * scan.wave + part * scan.wave[:, turned]


def _no_spikes(scan: Scan, strength: float) -> None:
    """Cut late sizes to some times the median of seven: a filter that is meant for sparks."""
    size = np.abs(scan.wave)
    wide = np.pad(size, ((0, 0), (3, 3)), mode="edge")
    usual = np.median(np.lib.stride_tricks.sliding_window_view(wide, 7, axis=1), axis=2)
    most = np.maximum(1.15 - 0.3 * strength, 0.3) * usual
    cut = np.minimum(1.0, most / np.maximum(size, 1e-9))
    scan.wave = scan.wave * (1 + scan.since(FROM) * (cut - 1))


def _stolen(scan: Scan, strength: float) -> None:
    """Lose late sums while memory is refreshed: three words of each eleven have less in them."""
    phase = int(scan.shared(4).integers(11))
    away = (np.arange(len(SAMPLE)) + phase) % 11 < 3
    scan.wave = scan.wave * (1 - min(0.65 * strength, 0.97) * away * scan.since(FROM))


def _uneven_codes(scan: Scan, strength: float) -> None:
    """Round by a converter that seldom says odd numbers: their steps are narrow, even ones wide."""
    step = 1.3 * strength * float(np.median(scan.sigma))
    scan.wave = _coded(scan.wave.real, step) + 1j * _coded(scan.wave.imag, step)
    tried = np.geomspace(0.08, 8.0, 36)
    plain = np.hypot(*TRIED).std()
    coded = [np.hypot(*_coded(TRIED, one)).std() / plain for one in tried]
    by = np.interp(step / scan.sigma, tried, np.array(coded))
    scan.noise_by = scan.noise_by * np.maximum(by, 0.05)


def _coded(values: Floats, step: float) -> Floats:
    """Return values in steps, of which odd ones are 0.4 wide and even ones 1.6."""
    pair = values / (2 * step)
    even = np.rint(pair)
    rest = pair - even
    return np.asarray(step * (2 * even + np.where(np.abs(rest) > 0.4, np.sign(rest), 0.0)))


def _deaf(scan: Scan, strength: float) -> None:
    """Ask more of a first pulse: what is weak is taken for noise."""
    scan.deaf = strength


ON_THE_WAY: dict[str, Callable[[Scan, float], None]] = {
    "specular-reflections": _corrugated,
    "ground-bounce": _floor,
    "obstructed-path": _behind_stacks,
    "small-scale-fading": _clusters,
    "diffuse-tail": _steam,
}
IN_BRACKETS: dict[str, Callable[[Scan, float], None]] = {
    "pulse-ringing": _in_a_tin,
    "noise-floor": _drives,
    "narrowband-interference": _data_link,
    "blocks-read-backwards": _backwards,
    "spikes-taken-out": _no_spikes,
    "refresh-steals-words": _stolen,
    "quantisation": _uneven_codes,
    "late-detection": _deaf,
}
WAVES = ON_THE_WAY | IN_BRACKETS


def suffer_all(scan: Scan, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms meet effects: those on the way, those of rows, those in brackets."""
    for name in (one for one in ON_THE_WAY if one in names):
        ON_THE_WAY[name](scan, strength)
    for name in (one for one in names if one not in WAVES):
        scan.suffer(EFFECTS[name](scan.lot(), strength))
    for name in (one for one in IN_BRACKETS if one in names):
        IN_BRACKETS[name](scan, strength)
