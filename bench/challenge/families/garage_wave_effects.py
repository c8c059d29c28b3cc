"""What the garage hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.garage_cars import LAWS as RANGE_LAWS
from bench.challenge.families.garage_cars import PHONES
from bench.challenge.families.garage_effects import EFFECTS, floor_ray, image_ways
from bench.challenge.families.garage_key import AT, METRES, Key, simmer

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the garage's tables of ranges."""
FAULTY = ("banks-unlike", "late-sizes-squared", "converters-out-of-step")
LAWS = {name: RANGE_LAWS[name] for name in RANGE_LAWS if RANGE_LAWS[name].forms}
del LAWS["quarters-from-one-anchor"]
LAWS |= {name: Law() for name in FAULTY}
"""What nobody's library has."""
WALLS, BLOCK = 5.9, 8  # permittivity of concrete; samples that have one exponent
SINCE = 11.0  # samples past onsets from which radios are faulty


def _walls(key: Key, strength: float) -> None:
    """Hear four walls and the ceiling, whose paint and pipes return less than Fresnel has it.

    Of both ways that waves can lie the mean power.
    """
    visit, opening = key.visit(), key.sound() * key.opening()
    for way, met in image_ways(visit):
        root = np.sqrt(WALLS - 1 + met**2)
        flat, upright = (met - root) / (met + root), (WALLS * met - root) / (WALLS * met + root)
        returned = np.sqrt((flat**2 + upright**2) / 2)
        rough = visit.each_link(key.rng.beta, 5.0, 1.8)
        share = np.minimum(1.3 * strength**0.5 * returned * rough * visit.off / way, 0.85)
        key.echo(share * key.phases(), np.maximum(way - visit.off, 0.9) / METRES, opening)


def _floor(key: Key, strength: float) -> None:
    longer, share = floor_ray(key.visit(), strength)
    key.echo(share, longer / METRES, key.sound())


def _in_pockets(key: Key, strength: float) -> None:
    """Lose, from pockets behind, what comes straight: it comes round both hips, and off a wall."""
    visit, sound = key.visit(), key.sound()
    pocket = visit.unseen(0.44)
    key.weaken(1 - 0.984 * pocket[:, None] * key.begun() * key.opening())
    stretch = 0.4 + 0.6 * strength
    hips = [stretch * visit.each_link(key.rng.uniform, 1.5, 3.2) for _ in "lr"]
    wall = np.maximum(*hips) + stretch * visit.each_link(key.rng.gamma, 2.5, 1.4)
    for late, size in ((hips[0], 0.34), (hips[1], 0.3), (wall, 0.42)):
        own = visit.each_link(key.rng.uniform, 0.7, 1.2)
        key.echo(pocket * size * own * key.phases(), late, sound)


def _two_waves(key: Key, strength: float) -> None:
    """Fade as two waves and some diffuse power do (Durgin 2002): their phase walks as it goes on.

    `second`: of the second wave's power over the first's.
    """
    second, loose = min(0.1 * strength, 0.45), min(0.05 * strength, 0.3)
    shape = key.has.shape
    start = key.rng.uniform(-np.pi, np.pi, (shape[0], 1))
    walk = start + np.cumsum(key.rng.normal(0.0, 0.5, shape), axis=1)
    wave = 1 + np.sqrt(second) * np.exp(1j * walk) + np.sqrt(loose / 2) * _slowly(key)
    key.weaken(1 + key.begun() * (np.abs(wave) / np.sqrt(1 + second + loose) - 1))


def _slowly(key: Key) -> Complexes:
    """Return chance with components of scatter 1 that some samples in a row share [n, k]."""
    kernel = np.hanning(11)[1:-1]
    white = key.rng.normal(size=(key.rows, len(AT) + len(kernel) - 1, 2)) @ np.array([1.0, 1j])
    rows = [np.convolve(row, kernel, "valid") for row in white]
    return np.asarray(np.array(rows) / np.sqrt(np.sum(kernel**2)))


def _stretched(key: Key, strength: float) -> None:
    """Reverberate between cars: by an exponential of a root, fast at first and long at last."""
    past = np.maximum(key.past - 1.5, 0.0)
    power = 0.06 * strength * np.exp(-np.sqrt(past / 2.6)) * key.later_than(4.0, 1.0)
    rough = np.sqrt(power / 2) * simmer(key.rng, key.rows)
    key.has = key.has + key.crest()[:, None] * rough


def _coupled_patches(key: Key, strength: float) -> None:
    """Ring as two patches do that swing against each other: energy goes over, and comes back."""
    beat, turn = key.always(1).uniform((0.24, -0.5), (0.42, 0.5))
    lags = np.arange(3, 31)
    swing = np.sin(beat * lags) * np.exp(-lags / 9.0) * np.exp(1j * turn * lags)
    part = 0.15 * min(strength, 2.5) * swing
    sound, rung = key.sound(), key.has.copy()
    for lag, one in zip(lags.tolist(), part, strict=True):
        rung[:, lag:] += one * sound[:, :-lag]
    key.has = rung


def _chargers(key: Key, strength: float) -> None:
    key.raise_noise(EFFECTS["noise-floor"](key.visit(), strength)["hiss"])


def _parking_radar(key: Key, strength: float) -> None:
    """Hear a radar for parking sweep by: its pitch rises by a line, louder in some phones."""
    slope = key.always(2).uniform(0.0008, 0.0022)
    own = key.always(3).gamma(5.0, 0.2, PHONES)[key.visit().phone]
    size = 1.5 * strength * own * key.rng.uniform(0.5, 1.5, key.rows)
    begun = key.rng.uniform(-0.5, 0.5, (key.rows, 1))
    sweep = np.exp(2j * np.pi * (begun * AT + 0.5 * slope * AT**2)) * key.phases()[:, None]
    key.has = key.has + (size * key.sigma)[:, None] * sweep
    key.by_noise = key.by_noise * _beside(size)
    key.sigma = key.sigma * np.sqrt(1 + size**2 / 2)


def _beside(size: Floats) -> Floats:
    """Return how many times more sizes scatter beside such a sweep [n]: by trial."""
    noise = np.random.default_rng(1047).normal(size=(25000, 2)).view(np.complex128)[:, 0]
    tried = np.linspace(0.0, 9.0, 46)
    spread = [np.abs(noise + one).std() for one in tried]
    return np.asarray(np.interp(size, tried, spread) / spread[0])


def _banks(key: Key, strength: float) -> None:
    """Read late samples from banks of memory that are not alike: fourteen samples of each."""
    gain_db = key.always(4).uniform(-4.6, 4.6, 4) * min(strength, 2.2)
    bank = (np.arange(len(AT)) // 14) % len(gain_db)
    gain = 10 ** ((gain_db - gain_db.mean())[bank] / 20)
    key.has = key.has * (1 + key.later_than(SINCE) * (gain - 1))


def _squared(key: Key, strength: float) -> None:
    """Show late sizes as a detector has them that squares: the smaller, the less is left."""
    size, late = np.abs(key.has), key.later_than(SINCE)
    usual = np.sqrt((late * size**2).sum(axis=1) / np.maximum(late.sum(axis=1), 1.0))[:, None]
    bent = (size / (2.5 * usual)).clip(1e-6, 1.0) ** min(0.3 * strength, 1.0)
    key.has = key.has * (1 + late * (bent - 1))


def _out_of_step(key: Key, strength: float) -> None:
    """Take every other late sample too soon, and louder: two converters that are not in step."""
    odd = np.arange(len(AT)) % 2 == 1
    before = np.concatenate([key.has[:, :1], key.has[:, :-1]], axis=1)
    early = min(0.38 * strength, 0.8) * key.later_than(SINCE) * odd
    key.has = ((1 - early) * key.has + early * before) * (1 + 0.35 * early)


def _shared_exponents(key: Key, strength: float) -> None:
    """Keep short words of which eight samples have one exponent: as coarse as their largest asks.

    What is quiet has steps of its own: words of a given length below the usual noise.
    """
    floor = 1.25 * strength * float(np.median(key.sigma))
    key.has = _worded(key.has, floor)
    noise = simmer(np.random.default_rng(1048), 120)
    tried = np.geomspace(0.15, 6.0, 32)
    spread = np.array([np.abs(_worded(noise, one)).std() for one in tried]) / np.abs(noise).std()
    key.by_noise = key.by_noise * np.maximum(np.interp(floor / key.sigma, tried, spread), 0.05)


def _worded(waves: Complexes, floor: float) -> Complexes:
    """Return waveforms [n, k] in steps: `floor`, doubled until a block's largest has 6 bits."""
    blocks = np.pad(waves, ((0, 0), (0, -waves.shape[1] % BLOCK))).reshape(len(waves), -1, BLOCK)
    largest = np.maximum(np.abs(blocks.real), np.abs(blocks.imag)).max(axis=2, keepdims=True)
    step = floor * 2.0 ** np.ceil(np.log2(np.maximum(largest / (64 * floor), 1.0)))
    kept = step * (np.rint(blocks.real / step) + 1j * np.rint(blocks.imag / step))
    return np.asarray(kept.reshape(len(waves), -1)[:, : waves.shape[1]])


def _deaf(key: Key, strength: float) -> None:
    """Ask more of a first pulse: one that is weak is passed over."""
    key.deaf = strength


UP_TO_PHONES: dict[str, Callable[[Key, float], None]] = {
    "specular-reflections": _walls,
    "ground-bounce": _floor,
    "obstructed-path": _in_pockets,
    "small-scale-fading": _two_waves,
    "diffuse-tail": _stretched,
}
IN_PHONES: dict[str, Callable[[Key, float], None]] = {
    "pulse-ringing": _coupled_patches,
    "noise-floor": _chargers,
    "narrowband-interference": _parking_radar,
    "banks-unlike": _banks,
    "late-sizes-squared": _squared,
    "converters-out-of-step": _out_of_step,
    "quantisation": _shared_exponents,
    "late-detection": _deaf,
}
WAVES = {**UP_TO_PHONES, **IN_PHONES}


def meet_all(key: Key, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms meet effects: those up to phones, those of rows, those in phones."""
    for name, effect in UP_TO_PHONES.items():
        if name in names:
            effect(key, strength)
    for name in names:
        if name not in WAVES:
            key.meet(EFFECTS[name](key.visit(), strength))
    for name, effect in IN_PHONES.items():
        if name in names:
            effect(key, strength)
