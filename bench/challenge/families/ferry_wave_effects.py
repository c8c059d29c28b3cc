"""What the ferry hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.ferry_deck import LAWS as RANGE_LAWS
from bench.challenge.families.ferry_effects import EFFECTS, plate_ray, turned
from bench.challenge.families.ferry_set import METRES, TIMES, Chain, after_a_while, static

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "time-lag",
)  # fmt: skip
"""Effects that are those of the ferry's tables of ranges."""
ODDITIES = ("gain-swings", "blanked-by-radar", "record-tapered")
LAWS = {
    **{name: law for name, law in RANGE_LAWS.items() if law.forms and "unit" not in law.forms},
    **{name: Law() for name in ODDITIES},
}
"""What nobody's library has."""


def _plates(chain: Chain, strength: float) -> None:
    longer, share = plate_ray(chain.lading(), strength)
    ray = share * turned(longer)
    chain.cir = chain.cir + ray[:, None] * after_a_while(chain.heard(), longer / METRES)


def _behind_lorries(chain: Chain, strength: float) -> None:
    """Lose, on some links, all that comes straight: what leaks under a lorry comes in a bunch."""
    ship, heard = chain.lading(), chain.heard()
    lorry = ship.each_link(lambda n: (chain.rng.random(n) < 0.21) * 1.0)
    late = ship.each_link(lambda n: 2.6 + chain.rng.gamma(3.0, 1.1, n)) * (0.6 + 0.4 * strength)
    hidden = chain.begun() * np.clip((12 - chain.past) / 4, 0, 1) * lorry[:, None]
    chain.weaken(1 - 0.985 * hidden)
    for k, size in enumerate((0.26, 0.3, 0.22, 0.2, 0.12, 0.09)):
        leak = lorry * size * chain.rng.rayleigh(0.8, len(late)) * chain.phase()
        chain.cir = chain.cir + leak[:, None] * after_a_while(heard, late + 1.6 * k)


def _rice(chain: Chain, strength: float) -> None:
    """Fade as Rice has it, all samples of a pulse alike: a steady part, and one of chance."""
    steady = 7.0 / max(strength, 0.2)
    shape = (len(TIMES) // 5 + 3, len(chain.table))
    chance = chain.rng.normal(size=(2, *shape)) / np.sqrt(2 * steady)
    sizes = np.hypot(1 + chance[0], chance[1]) / np.sqrt(1 + 1 / steady)
    at = (TIMES + 5 * chain.rng.random((len(chain.table), 1))) / 5
    low, part = np.floor(at).astype(np.intp), np.mod(at, 1)
    rows = np.arange(len(chain.table))[:, None]
    gain = sizes[low, rows] * (1 - part) + sizes[low + 1, rows] * part
    chain.weaken(np.where(chain.past > -6, gain, 1.0))


def _steel_box(chain: Chain, strength: float) -> None:
    """Reverberate in a box of steel: energy comes in by and by, and leaves through the ramp."""
    past = np.maximum(chain.past - 3, 0)
    power = 0.03 * strength * (past / 7) / (1 + past / 7) * np.exp(-past / 38)
    rays = chain.rng.exponential(1.0, power.shape) * power  # each of its own power
    chain.cir = chain.cir + chain.top()[:, None] * np.sqrt(rays / 2) * static(chain.rng, len(rays))


def _mismatched(chain: Chain, strength: float) -> None:
    """Ring in a filter with two poles that are not where they should be: beats that die away."""
    pair = chain.lasting(1).uniform(0.35, 0.75, 2) * [1, -1]
    lags = np.arange(3, 46)
    taps = 0.11 * min(strength, 2.4) * 0.9**lags * np.exp(1j * np.outer(pair, lags)).sum(axis=0)
    heard = chain.heard()
    for lag, tap in zip(lags, taps, strict=True):
        chain.cir[:, lag:] += tap * heard[:, :-lag]


def _drives(chain: Chain, strength: float) -> None:
    chain.noisier(EFFECTS["noise-floor"](chain.lading(), strength).hiss * np.ones(len(chain.table)))


def _radar(chain: Chain, strength: float) -> None:
    """Hear a carrier whose frequency is swept, a little, from one end of a record to the other."""
    base, sweep = chain.lasting(2).uniform([-0.35, 0.0003], [0.35, 0.0009])
    loud = strength * chain.rng.uniform(0.9, 1.9, len(chain.table))
    turns = base * TIMES + sweep * TIMES**2 / 2
    wave = (loud * chain.sigma * chain.phase())[:, None] * np.exp(2j * np.pi * turns)
    chain.cir = chain.cir + wave
    chain.of_noise = chain.of_noise * _with_a_carrier(loud)
    chain.sigma = chain.sigma * np.sqrt(1 + loud**2 / 2)


def _with_a_carrier(loud: Floats) -> Floats:
    """Return how many times more sizes scatter beside a carrier [n]: by moments of many."""
    rng = np.random.default_rng(775)
    noise = rng.normal(size=12000) + 1j * rng.normal(size=12000)
    grid = np.linspace(0, 10, 81)
    spread = np.array([np.abs(noise + one).std() for one in grid])
    return np.asarray(np.interp(loud, grid, spread / spread[0]))


def _gain_swings(chain: Chain, strength: float) -> None:
    """Swing in gain after every first path, as its supply does once something strong has come."""
    past = np.maximum(chain.past, 0)
    chain.cir = chain.cir * (
        1 - 0.42 * min(strength, 2.0) * np.sin(past / 8.0) * np.exp(-past / 60)
    )


def _blanked(chain: Chain, strength: float) -> None:
    """Blank some stretches of a record while the ship's radar sends, wherever that is."""
    blank = np.zeros(chain.cir.shape, bool)
    for _ in range(4):
        begin = chain.rng.uniform(4, 50, len(blank))[:, None]
        struck = chain.rng.random(len(blank))[:, None] < min(0.6 * strength, 0.95)
        blank |= struck & (chain.past > begin) & (chain.past < begin + 13)
    chain.cir = np.where(blank, 0.0, chain.cir)


def _rounded(chain: Chain, strength: float) -> None:
    """Round to as many steps as a row's largest component leaves of a word."""
    most = np.maximum(np.abs(chain.cir.real), np.abs(chain.cir.imag)).max(axis=1)
    step = (0.006 * strength * most)[:, None]
    chain.cir = step * (np.round(chain.cir.real / step) + 1j * np.round(chain.cir.imag / step))
    ratio = step[:, 0] / chain.sigma
    noise = np.random.default_rng(776).normal(size=(2, 12000))
    grid = np.linspace(0.02, 8, 70)
    sizes = [np.hypot(*(one * np.round(noise / one))).std() for one in grid]
    left = np.interp(ratio, grid, np.array(sizes) / np.hypot(*noise).std())
    chain.of_noise = chain.of_noise * np.maximum(left, 0.03)


def _tapered(chain: Chain, strength: float) -> None:
    """Taper records toward their ends, as before a transform: what is late counts less."""
    late = np.clip((chain.past - 12) / 150, 0, 1)
    chain.cir = chain.cir * np.cos(np.pi / 2 * late) ** (1.6 * strength)


def _lifted(chain: Chain, strength: float) -> None:
    """Ask more of a first path, and time it higher up."""
    chain.lift = 0.3 * min(strength, 2.5)


WAVES: dict[str, Callable[[Chain, float], None]] = {
    "ground-bounce": _plates,
    "obstructed-path": _behind_lorries,
    "small-scale-fading": _rice,
    "diffuse-tail": _steel_box,
    "pulse-ringing": _mismatched,
    "noise-floor": _drives,
    "narrowband-interference": _radar,
    "gain-swings": _gain_swings,
    "blanked-by-radar": _blanked,
    "quantisation": _rounded,
    "record-tapered": _tapered,
    "late-detection": _lifted,
}
"""In the order in which they come over a waveform; those of rows come before the ringing."""


def overcome(chain: Chain, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms be overcome by effects, in the order of the ship and its radio."""
    rows = [name for name in names if name not in WAVES]
    waves = [name for name in WAVES if name in names]
    ship = [name for name in waves if [*WAVES].index(name) < [*WAVES].index("pulse-ringing")]
    for name in (*ship, *rows, *waves[len(ship) :]):
        if name in WAVES:
            WAVES[name](chain, strength)
        else:
            chain.overcome(EFFECTS[name](chain.lading(), strength))
