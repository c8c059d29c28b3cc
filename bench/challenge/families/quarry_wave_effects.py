"""What the quarry hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.quarry_effects import EFFECTS, rock_ray
from bench.challenge.families.quarry_log import METRES, PLACES, Log, held_back, hiss
from bench.challenge.families.quarry_pit import DIGGERS, FACE_Y_M, WAVE_M
from bench.challenge.families.quarry_pit import LAWS as RANGE_LAWS

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "time-lag",
)  # fmt: skip
"""Effects that are those of the quarry's tables of ranges."""
LAWS = {name: law for name, law in RANGE_LAWS.items() if law.forms and "unit" not in law.forms}
LAWS |= {name: Law() for name in ("limiter-recovers", "record-folded", "sums-smear-late")}
"""What nobody's library has."""
LIMESTONE = np.sqrt(7.5 - 0.3j)  # index of refraction of sawn rock
FACES = ((1, FACE_Y_M), (0, -6.0), (0, 68.0))  # axis and place of planes of rock


def _faces(log: Log, strength: float) -> None:
    """Hear faces of sawn rock by their images, and the widest twice: by a joint behind it."""
    spoil, heard = log.spoil(), log.heard() * log.early()
    booms, ends = spoil.booms(), spoil.tops
    for axis, plane in FACES:
        image = booms.copy()
        image[:, axis] = 2 * plane - image[:, axis]
        way = np.linalg.norm(image - ends, axis=1)
        steep = np.abs(image[:, axis] - ends[:, axis]) / way
        back = np.abs((steep - LIMESTONE) / (steep + LIMESTONE)) * spoil.away / way
        sawn = spoil.link(lambda n: log.rng.uniform(0.6, 1.4, n))
        share = np.minimum(1.7 * strength**0.5 * sawn * back, 0.9) * log.spin()
        late = np.maximum(way - spoil.away, 1.1) / METRES
        log.cir = log.cir + share[:, None] * held_back(heard, late)
        log.cir = log.cir + (0.4 * share * log.spin())[:, None] * held_back(heard, late + 6.5)


def _rock(log: Log, strength: float) -> None:
    longer, share = rock_ray(log.spoil(), strength)
    ray = -share * np.exp(-2j * np.pi * longer / WAVE_M)
    log.cir = log.cir + ray[:, None] * held_back(log.heard(), longer / METRES)


def _behind_heaps(log: Log, strength: float) -> None:
    """Lose, behind heaps of spoil, what comes straight: what creeps over comes later, blurred."""
    spoil, heard = log.spoil(), log.heard()
    heap = spoil.link(lambda n: (log.rng.random(n) < 0.22).astype(np.float64))
    late = spoil.link(lambda n: log.rng.lognormal(1.25, 0.3, n)) * (0.5 + 0.5 * strength)
    log.leave(1 - 0.98 * heap[:, None] * log.begun() * log.early())
    for k, size in enumerate((0.2, 0.32, 0.24, 0.15, 0.1)):
        crept = heap * size * log.rng.triangular(0.6, 1.0, 1.4, len(heap)) * log.spin()
        log.cir = log.cir + crept[:, None] * held_back(heard, late + 1.3 * k)


def _two_scatterers(log: Log, strength: float) -> None:
    """Fade as two waves of chance phases do beside a steady one, slower or faster along records."""
    size, rows = min(0.22 * strength**0.5, 0.45), len(log.top)
    gain = np.ones((rows, len(PLACES)), np.complex128)
    for one in (1.0, 0.7):
        rate = log.rng.normal(0, 0.11, (rows, 1))
        gain += one * size * log.spin()[:, None] * np.exp(2j * np.pi * rate * PLACES)
    gain = np.abs(gain) / np.sqrt(1 + 1.49 * size**2)
    log.leave(1 + log.begun() * (gain - 1))


def _benches(log: Log, strength: float) -> None:
    """Scatter off benches one behind the other: bursts, each wider and weaker than the last."""
    power = np.zeros(log.later.shape)
    for k, (begin, wide) in enumerate(((6.0, 4.0), (19.0, 8.0), (41.0, 14.0), (74.0, 22.0))):
        where = begin * log.rng.uniform(0.85, 1.15, (len(power), 1))
        power += 0.045 * 0.45**k * np.exp(-0.5 * np.square((log.later - where - wide) / wide))
    sizes = log.loud()[:, None] * np.sqrt(0.8 * strength * power * (log.later > 3))
    log.cir = log.cir + sizes * hiss(log.rng, len(sizes))


def _critical(log: Log, strength: float) -> None:
    """Ring in a dome that is damped just so: t exp(-t / tau), turning as it dies away."""
    lags = np.arange(2, 44)
    turn = log.bedded(1).uniform(-0.7, 0.7)
    answer = 0.055 * min(strength, 2.5) * lags / 4.0 * np.exp(1 - lags / 6.0 + 1j * turn * lags)
    heard = log.heard()
    views = np.lib.stride_tricks.sliding_window_view(np.pad(heard, ((0, 0), (43, 0))), 44, axis=1)
    log.cir = log.cir + views[:, :, ::-1][:, :, 2:] @ answer


def _ignition(log: Log, strength: float) -> None:
    load = EFFECTS["noise-floor"](log.spoil(), strength)
    log.drown(np.asarray(load.hiss))


def _walkie_talkie(log: Log, strength: float) -> None:
    """Hear a voice radio's harmonic: a carrier that is swung in pitch, some diggers' more."""
    pitch, swing, rate = log.bedded(2).uniform([-0.4, 0.6, 0.01], [0.4, 1.6, 0.03])
    loud = strength * (0.9 + 0.5 * log.bedded(3).permutation(DIGGERS) / DIGGERS)
    loud = loud[log.spoil().digger]
    turn = swing * np.sin(2 * np.pi * (rate * PLACES + log.rng.random((len(loud), 1))))
    wave = np.exp(1j * (2 * np.pi * pitch * PLACES + turn)) * log.spin()[:, None]
    log.cir = log.cir + (loud * log.sigma)[:, None] * wave
    log.noise = log.noise * _scatters(loud)
    log.sigma = log.sigma * np.sqrt(1 + 0.5 * loud**2)


def _scatters(loud: Floats) -> Floats:
    """Return how many times more sizes scatter beside a steady carrier [n], Rice's law summed."""
    grid = np.linspace(0, 16, 1601)
    tried = np.linspace(0, 9, 46)[:, None]
    kernel = np.i0(np.minimum(grid * tried, 600.0)) * np.exp(-0.5 * (grid**2 + tried**2)) * grid
    kernel = kernel / kernel.sum(axis=1, keepdims=True)
    mean = (kernel * grid).sum(axis=1)
    spread = np.sqrt((kernel * grid**2).sum(axis=1) - mean**2)
    return np.asarray(np.interp(loud, tried[:, 0], spread / spread[0]))


def _limiter(log: Log, strength: float) -> None:
    """Recover from a limiter: deaf after the first top, then by and by as it was."""
    depth = 1 - 1 / (1 + 1.3 * strength)
    since = np.clip(log.later - 4, 0, None)
    back = np.clip(since / 34.0, 0, 1)
    log.cir = log.cir * np.where(since > 0, 1 - depth * (1 - back) ** 2, 1.0)


def _folded(log: Log, strength: float) -> None:
    """Write on from the end of a memory backward, over what is there: ends fold onto middles."""
    fold = log.top + 62
    mirror = np.clip(np.rint(2 * fold[:, None] - PLACES), 0, len(PLACES) - 1).astype(np.intp)
    again = np.take_along_axis(log.cir, np.roll(mirror, 38, axis=1), axis=1)
    part = min(0.55 * strength, 1.4)
    log.cir = log.cir + np.where(log.later > 12, part * again * log.spin()[:, None], 0)


def _smear(log: Log, strength: float) -> None:
    """Add up symbols whose clocks drift apart: the later a sample, the more of its neighbours."""
    part = 0.5 * np.clip(0.6 * strength * (log.later - 4) / 40.0, 0, 1)
    for step in (1, 2, 3):
        near = (np.roll(log.cir, step, axis=1) + np.roll(log.cir, -step, axis=1)) / 2
        log.cir = (1 - part) * log.cir + part * near


def _by_blocks(log: Log, strength: float) -> None:
    """Share an exponent among sixteen samples: steps are those that their largest one needs."""
    size = np.maximum(np.abs(log.cir.real), np.abs(log.cir.imag))
    blocks = np.arange(0, len(PLACES), 16)
    largest = np.maximum.reduceat(size, blocks, axis=1).repeat(16, axis=1)[:, : len(PLACES)]
    step = np.exp2(np.ceil(np.log2(np.maximum(largest, 1.0)))) * min(0.035 * strength, 0.24)
    log.cir = step * (np.rint(log.cir.real / step) + 1j * np.rint(log.cir.imag / step))
    before = np.median(step[:, 0] / log.sigma)
    noise = np.random.default_rng(837).normal(size=(2, 20000))
    kept = np.hypot(*(before * np.rint(noise / before))).std() / np.hypot(*noise).std()
    log.noise = log.noise * max(float(kept), 0.03)


def _numb(log: Log, strength: float) -> None:
    """Hear louder first tops alone, and those late."""
    log.numb = 1.1 * strength


WAVES: dict[str, Callable[[Log, float], None]] = {
    "specular-reflections": _faces,
    "ground-bounce": _rock,
    "obstructed-path": _behind_heaps,
    "small-scale-fading": _two_scatterers,
    "diffuse-tail": _benches,
    "pulse-ringing": _critical,
    "noise-floor": _ignition,
    "narrowband-interference": _walkie_talkie,
    "limiter-recovers": _limiter,
    "sums-smear-late": _smear,
    "record-folded": _folded,
    "quantisation": _by_blocks,
    "late-detection": _numb,
}
PIT = ("specular-reflections", "ground-bounce", "obstructed-path", "small-scale-fading",
       "diffuse-tail")  # fmt: skip


def loaded(log: Log, names: tuple[str, ...], strength: float) -> None:
    """Load waveforms with effects: those of the pit, those of rows, those of the radio."""
    rows = tuple(name for name in names if name not in WAVES)
    for name in (*PIT, *rows, *(one for one in WAVES if one not in PIT)):
        if name in rows:
            log.load(EFFECTS[name](log.spoil(), strength))
        elif name in names:
            WAVES[name](log, strength)
