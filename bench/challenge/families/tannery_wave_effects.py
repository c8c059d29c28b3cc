"""What the tannery hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.tannery_effects import EFFECTS, pit_ray
from bench.challenge.families.tannery_floor import DRUMS_M, HOISTS, PURLINS_M, SHED_M
from bench.challenge.families.tannery_floor import LAWS as RANGE_LAWS
from bench.challenge.families.tannery_reader import METRES, PLACES, Reading, murmur

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern",
    "power-bias", "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control",
)  # fmt: skip
"""Effects that are those of the tannery's tables of ranges."""
OF_RADIOS = ("drums-turn-while-summed", "address-bit-stuck", "swept-gain-left-on")
LAWS = {n: law for n, law in RANGE_LAWS.items() if {*law.forms} - {"unit"}} | dict.fromkeys(
    OF_RADIOS, Law()
)
"""What nobody's library has."""
BRICK = 3.91


def _walls(reading: Reading, strength: float) -> None:
    """Hear walls of brick and the roof by images: both polarisations' powers, as they are met."""
    lot, straight = reading.lot(), reading.voice() * reading.foremost()
    for axis, plane in ((0, 0.0), (0, SHED_M[0]), (1, 0.0), (1, SHED_M[1]), (2, SHED_M[2])):
        off = lot.hides() - lot.bolts()
        off[:, axis] = 2 * plane - lot.hides()[:, axis] - lot.bolts()[:, axis]
        way = np.linalg.norm(off, axis=1)
        steep = np.abs(off[:, axis]) / way
        root = np.sqrt(BRICK - 1 + steep**2)
        across, along = (
            (steep - root) / (steep + root),
            (BRICK * steep - root) / (BRICK * steep + root),
        )
        back = np.sqrt((across**2 + along**2) / 2)
        piled = lot.each_link(lambda n: reading.rng.uniform(0.7, 1.5, n))  # hides before walls
        share = np.minimum(1.3 * strength**0.5 * piled * back * lot.way / way, 0.85)
        late = np.maximum(way - lot.way, 1.0) / METRES
        reading.add(share * reading.phases(), late, straight)


def _pits(reading: Reading, strength: float) -> None:
    longer, share = pit_ray(reading.lot(), strength)
    reading.add(share, longer / METRES, reading.voice())


def _behind_piles(reading: Reading, strength: float) -> None:
    """Lose, behind a pile of hides, what comes straight: hoops of drums return it, ever later."""
    lot, voice = reading.lot(), reading.voice()
    pile = lot.each_link(lambda n: (reading.rng.random(n) < 0.2).astype(np.float64))
    reading.weaken(1 - 0.982 * pile[:, None] * reading.begun() * reading.foremost())
    late = lot.each_link(lambda n: 2.0 + 2.8 * reading.rng.beta(2, 2, n)) * (0.5 + 0.5 * strength)
    for size in (0.33, 0.27, 0.24, 0.15):
        share = pile * size * reading.rng.triangular(0.75, 1.0, 1.25, len(pile))
        reading.add(share * reading.phases(), late, voice)
        late = 1.35 * late + lot.each_link(lambda n: reading.rng.uniform(0.4, 1.6, n))


def _weibull(reading: Reading, strength: float) -> None:
    """Fade by Weibull's sizes, alike over four samples, straight in dB between them."""
    rows, shape = len(reading.table), 3.2 / strength**0.6
    knots = len(PLACES) // 4 + 3
    size = np.clip(reading.rng.weibull(shape, (rows, knots)), 0.06, None)
    db = 20 * np.log10(np.minimum(size, 2.3))
    place = (PLACES + reading.rng.uniform(0, 4, (rows, 1))) / 4
    left = place.astype(np.intp)
    low, high = (np.take_along_axis(db, left + k, axis=1) for k in (0, 1))
    gain = 10 ** ((low + (place - left) * (high - low)) / 20)
    reading.weaken((gain / np.sqrt(np.mean(gain**2))) ** reading.begun())


def _rafters(reading: Reading, strength: float) -> None:
    """Scatter among rafters and hides: by a power of the delay, and so for long."""
    since = np.maximum(reading.since, 0)
    power = 0.034 * strength * (1 + since / 12.0) ** -1.8 * (since > 4)
    rough = murmur(reading.rng, len(since))
    reading.wave = reading.wave + reading.top()[:, None] * np.sqrt(power / 2) * rough


def _two_tones(reading: Reading, strength: float) -> None:
    """Ring at two pitches, as an antenna on a wet bracket does: they beat while they die away."""
    pitches = reading.lasting(1).uniform([0.2, -1.1], [0.7, -0.6])
    lags = np.arange(3, 38)
    both = np.exp(1j * np.outer(pitches, lags)) * np.exp(-lags / np.array([[8.0], [13.0]]))
    answer = 0.11 * min(strength, 2.8) * both.sum(axis=0)
    voice = reading.voice()
    for lag, part in zip(lags.tolist(), answer.tolist(), strict=True):
        reading.wave = reading.wave + part * np.pad(voice, ((0, 0), (lag, 0)))[:, : len(PLACES)]


def _motors(reading: Reading, strength: float) -> None:
    reading.louder(np.asarray(EFFECTS["noise-floor"](reading.lot(), strength).hiss))


def _sweeping(reading: Reading, strength: float) -> None:
    """Hear a radar for levels of vats: a carrier that sweeps while a record lasts."""
    pitch, bend = reading.lasting(2).uniform([-0.4, 2e-4], [0.2, 9e-4])
    size = strength * reading.lasting(3).uniform(0.8, 1.5, HOISTS)[reading.lot().hoist]
    turned = 2 * np.pi * (pitch * PLACES + bend * PLACES**2)
    wave = np.exp(1j * turned) * reading.phases()[:, None]
    reading.wave = reading.wave + (size * reading.sigma)[:, None] * wave
    reading.rougher = reading.rougher * _beside(size)
    reading.sigma = reading.sigma * np.sqrt(1 + size**2 / 2)


def _beside(size: Floats) -> Floats:
    """Return how many times more sizes scatter beside a carrier of such size [n]: by trial."""
    noise = np.random.default_rng(897).normal(size=(2, 16000))
    tried = np.linspace(0, 7, 36)
    spread = np.array([np.hypot(noise[0] + one, noise[1]).std() for one in tried])
    return np.asarray(np.interp(size, tried, spread / spread[0]))


def _drums_turn(reading: Reading, strength: float) -> None:
    """Add up symbols while drums turn: what they and all beyond return cancels in part.

    sin(x) / x of how far a hoop turns in the meantime, in a band of delays about each drum.
    """
    lot = reading.lot()
    ends = (lot.hides()[:, :2], PURLINS_M[lot.purlin][:, :2])
    left = np.ones_like(reading.since)
    for number, drum in enumerate(DRUMS_M):
        turned = reading.lasting(4 + number).uniform(0.5, 0.85) * min(strength, 1.5)
        legs = sum(np.linalg.norm(end - drum, axis=1) for end in ends)
        begin = np.maximum((legs - lot.way) / METRES, 9.0)[:, None]
        beyond = np.clip((reading.since - begin + 3) / 3, 0, 1)
        left = left * (1 - beyond * (1 - np.sinc(turned)))
    reading.weaken(np.maximum(left, 0.05))


def _stuck(reading: Reading, strength: float) -> None:
    """Write, past first paths, with a bit of the address stuck: two sums end in one word.

    In a part of the frames, so that the words that are passed over keep what others bring.
    """
    part = min(0.55 * strength, 1.0)
    past = np.floor(reading.since).astype(np.intp)
    over = np.where((past >= 8) & (past & 4 != 0), part, 0.0)
    passed = over * reading.wave
    doubled = np.zeros_like(passed)
    doubled[:, :-4] = passed[:, 4:]
    reading.wave = reading.wave - passed + doubled


def _swept(reading: Reading, strength: float) -> None:
    """Leave a swept gain on that was for ground radar: all that is later is larger, noise too."""
    db = 0.16 * strength * np.clip(reading.since - 5.0, 0.0, 70.0)
    reading.wave = reading.wave * 10 ** (np.minimum(db, 14.0) / 20)


def _toward_zero(reading: Reading, strength: float) -> None:
    """Drop what is less than a step: both components go toward zero."""
    step = 1.25 * strength * float(np.median(reading.sigma))
    real, imaginary = (step * np.trunc(x / step) for x in (reading.wave.real, reading.wave.imag))
    reading.wave = real + 1j * imaginary
    noise = np.random.default_rng(898).normal(size=(2, 16000))
    tried = np.geomspace(0.05, 2.2, 40)
    spread = np.array([np.hypot(*(x * np.trunc(noise / x))).std() for x in tried])
    by = np.interp(step / reading.sigma, tried, spread / np.hypot(*noise).std())
    reading.rougher = reading.rougher * np.maximum(by, 0.05)


def _dull(reading: Reading, strength: float) -> None:
    """Ask more of a first pulse, and take it nearer to its top."""
    reading.dull = 0.95 * strength


SHED: dict[str, Callable[[Reading, float], None]] = {
    "specular-reflections": _walls,
    "ground-bounce": _pits,
    "obstructed-path": _behind_piles,
    "small-scale-fading": _weibull,
    "diffuse-tail": _rafters,
    "drums-turn-while-summed": _drums_turn,
}
RADIO: dict[str, Callable[[Reading, float], None]] = {
    "pulse-ringing": _two_tones,
    "noise-floor": _motors,
    "narrowband-interference": _sweeping,
    "address-bit-stuck": _stuck,
    "swept-gain-left-on": _swept,
    "quantisation": _toward_zero,
    "late-detection": _dull,
}
WAVES = SHED | RADIO


def dye(reading: Reading, names: tuple[str, ...], strength: float) -> None:
    """Dye waveforms with effects: those of the shed, those of rows, those of the radio."""
    for name in (one for one in SHED if one in names):
        SHED[name](reading, strength)
    for name in (one for one in names if one not in WAVES):
        reading.dye(EFFECTS[name](reading.lot(), strength))
    for name in (one for one in RADIO if one in names):
        RADIO[name](reading, strength)
