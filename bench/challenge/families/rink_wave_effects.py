"""What the rink hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.rink_effects import EFFECTS, ice_ray
from bench.challenge.families.rink_ice import LAWS as RANGE_LAWS
from bench.challenge.families.rink_ice import RINK_M, TRUSSES_M
from bench.challenge.families.rink_radio import INDEX, METRES, Record, behindhand, crackle

Floats = NDArray[np.float64]
OF_RANGES = (
    "antenna-delay", "clock-offset", "temperature-drift", "antenna-pattern", "power-bias",
    "timestamp-jitter", "path-loss", "range-scale", "material-delay", "diffraction",
    "level-control", "exchange-motion",
)  # fmt: skip
"""Effects that are those of the rink's tables of ranges."""
OWN = ("code-sidelobes", "late-part-thinned", "small-sizes-squeezed")
LAWS = {name: law for name, law in RANGE_LAWS.items() if law.forms and law.forms != ("unit",)}
LAWS |= {name: Law() for name in OWN}
"""What nobody's library has."""
BOARD = 2.3  # permittivity of polyethylene with ribs of steel behind


def _boards(record: Record, strength: float) -> None:
    """Hear boards and roof by images, in the plane of incidence; some gates stand open."""
    sheet, heard = record.sheet(), record.heard() * record.direct()
    for axis, plane in ((0, 0.0), (0, RINK_M[0]), (1, 0.0), (1, RINK_M[1]), (2, RINK_M[2])):
        image = sheet.helmets()
        image[:, axis] = 2 * plane - image[:, axis]
        way = np.linalg.norm(image - sheet.ends(), axis=1)
        cosine = np.abs(image - sheet.ends())[:, axis] / way
        inside = np.sqrt(BOARD - 1 + cosine**2)
        back = np.abs((BOARD * cosine - inside) / (BOARD * cosine + inside)) + 0.35
        gate = sheet.by_link(lambda n: record.rng.choice([0.3, 0.9, 1.1], n))
        share = np.minimum(1.15 * strength**0.5 * gate * back * sheet.d / way, 0.9)
        late = np.maximum(way - sheet.d, 0.9) / METRES
        record.cir = record.cir + (share * record.turn())[:, None] * behindhand(heard, late)


def _ice(record: Record, strength: float) -> None:
    longer, ray = ice_ray(record.sheet(), strength)
    record.cir = record.cir + ray[:, None] * behindhand(record.heard(), longer / METRES)


def _behind_crowd(record: Record, strength: float) -> None:
    """Lose, behind a crowd, what comes straight: boards return it, three times by chance."""
    sheet, heard = record.sheet(), record.heard()
    crowd = sheet.by_link(lambda n: 1.0 * (record.rng.random(n) < 0.21))
    record.dim(1 - 0.983 * crowd[:, None] * record.open() * record.direct())
    late = sheet.by_link(lambda n: record.rng.uniform(2.2, 4.6, n)) * (0.5 + 0.5 * strength)
    for size in (0.3, 0.34, 0.2):
        share = crowd * size * record.rng.uniform(0.75, 1.25, len(crowd)) * record.turn()
        record.cir = record.cir + share[:, None] * behindhand(heard, late)
        late = late + sheet.by_link(lambda n: record.rng.exponential(3.0, n)) + 1.0


def _scintillates(record: Record, strength: float) -> None:
    """Fade by the product of two gamma powers, large and small eddies (Andrews et al. 2001)."""
    many, rows = len(INDEX) // 5 + 2, len(record.table)
    large = record.rng.gamma(7.0 / strength, strength / 7.0, (rows, 1))
    small = record.rng.gamma(2.6 / strength**0.5, strength**0.5 / 2.6, (rows, many))
    gain = np.minimum(np.sqrt(large**0.3 * small), 2.6)
    gain = gain / np.sqrt(np.mean(gain**2))
    place = (INDEX + record.rng.uniform(0, 5, (rows, 1))) / 5
    low = np.floor(place).astype(np.intp)
    one, two = (np.take_along_axis(gain, low + k, axis=1) for k in (0, 1))
    record.dim(1 + record.open() * (one + (place - low) * (two - one) - 1))


def _hall_rings(record: Record, strength: float) -> None:
    """Scatter as far as boards go, and hardly beyond: Fermi's step of the delay."""
    since = record.since
    power = 0.03 * strength / (1 + np.exp(np.clip((since - 24.0) / 9.0, -40, 40)))
    sizes = record.crest_size()[:, None] * np.sqrt(power / 2 * (since > 4))
    record.cir = record.cir + sizes * crackle(record.rng, len(since))


def _dispersed(record: Record, strength: float) -> None:
    """Ring in a spiral that leads some frequencies farther: turning faster and faster."""
    bend = record.frozen(1).uniform(0.006, 0.02)
    lags = np.arange(3, 40)
    answer = 0.16 * min(strength, 3.0) * np.exp(-lags / 9.0 + 1j * (0.4 * lags + bend * lags**2))
    heard = record.heard()
    rung = np.zeros_like(heard)
    for lag, part in zip(lags.tolist(), answer.tolist(), strict=True):
        rung[:, lag:] += part * heard[:, :-lag]
    record.cir = record.cir + rung


def _chiller(record: Record, strength: float) -> None:
    record.hiss(np.asarray(EFFECTS["noise-floor"](record.sheet(), strength).hiss))


def _microphone(record: Record, strength: float) -> None:
    """Hear a digital microphone: a carrier whose phase is keyed by half turns of 13 samples."""
    pitch = record.frozen(2).uniform(-0.42, 0.42)
    size = record.frozen(3).uniform(0.85, 1.5, len(TRUSSES_M)) * strength
    loud = size[record.sheet().number("rx")]
    keyed = record.rng.choice([-1.0, 1.0], (len(loud), len(INDEX) // 13 + 2))
    begin = record.rng.integers(0, 13, (len(loud), 1))
    key = np.take_along_axis(keyed, (INDEX.astype(np.intp) + begin) // 13, axis=1)
    wave = key * np.exp(2j * np.pi * pitch * INDEX) * record.turn()[:, None]
    record.cir = record.cir + (loud * record.sigma)[:, None] * wave
    record.louder = record.louder * _beside_carrier(loud)
    record.sigma = record.sigma * np.sqrt(1 + 0.5 * loud**2)


def _beside_carrier(loud: Floats) -> Floats:
    """Return how many times more sizes scatter beside a carrier [n]: by equal parts of noise."""
    parts = (np.arange(400) + 0.5) / 400
    noise = np.sqrt(-2 * np.log(parts))[:, None] * np.exp(2j * np.pi * parts[::8])
    tried = np.linspace(0, 9, 37)
    spread = np.array([np.abs(noise + one).std() for one in tried])
    return np.asarray(np.interp(loud, tried, spread / spread[0]))


def _sidelobes(record: Record, strength: float) -> None:
    """Correlate with a code that is cut short: again, weaker, every 31 samples after."""
    heard = record.heard() * record.direct()
    for turn, part in ((31.0, 0.2), (62.0, -0.13), (93.0, 0.08)):
        again = behindhand(heard, np.full(len(heard), turn))
        record.cir = record.cir + min(strength, 3.0) * part * again


def _thinned(record: Record, strength: float) -> None:
    """Keep, some samples after first paths, means of so many samples in place of each."""
    many = 2 + int(np.ceil(2.0 * min(strength, 3.0)))
    groups = np.arange(0, len(INDEX), many)
    sums = np.add.reduceat(record.cir, groups, axis=1)
    means = (sums / np.diff([*groups, len(INDEX)])).repeat(many, axis=1)[:, : len(INDEX)]
    record.cir = np.where(record.since > 9, means, record.cir)


def _squeezed(record: Record, strength: float) -> None:
    """Lose small sizes the more the smaller they are, after first paths: a power above one."""
    share = np.abs(record.cir) / record.crest_size()[:, None]
    power = 0.16 * strength * np.clip((record.since - 4) / 3, 0, 1)
    record.cir = record.cir * np.clip(share, 1e-4, 1.0) ** power


def _dithered(record: Record, strength: float) -> None:
    """Round down after as much as a step was added by chance: right on average, and noisier."""
    step = 1.5 * strength * float(np.median(record.sigma))
    chance = record.rng.random((2, *record.cir.shape))
    parts = [np.floor(x / step + u) * step
             for x, u in zip((record.cir.real, record.cir.imag), chance, strict=True)]  # fmt: skip
    record.cir = parts[0] + 1j * parts[1]
    ratio = step / record.sigma
    record.louder = record.louder * _coarser(ratio)
    record.sigma = record.sigma * np.sqrt(1 + np.square(ratio) / 6)


def _coarser(ratio: Floats) -> Floats:
    """Return how many times more sizes scatter with such dithered steps [n]: by trial."""
    rng = np.random.default_rng(857)
    noise, chance = rng.standard_normal((2, 20000)), rng.random((2, 20000))
    tried = np.geomspace(0.05, 12, 45)
    spread = [float(np.hypot(*(x * np.floor(noise / x + chance))).std()) for x in tried]
    return np.asarray(np.interp(ratio, tried, spread)) / float(np.hypot(*noise).std())


def _deaf(record: Record, strength: float) -> None:
    """Ask more of a first pulse, and compare it with a larger part of itself."""
    record.deaf = 0.9 * strength


WAVES: dict[str, Callable[[Record, float], None]] = {
    "specular-reflections": _boards,
    "ground-bounce": _ice,
    "obstructed-path": _behind_crowd,
    "small-scale-fading": _scintillates,
    "diffuse-tail": _hall_rings,
    "pulse-ringing": _dispersed,
    "noise-floor": _chiller,
    "narrowband-interference": _microphone,
    "code-sidelobes": _sidelobes,
    "small-sizes-squeezed": _squeezed,
    "late-part-thinned": _thinned,
    "quantisation": _dithered,
    "late-detection": _deaf,
}
HALL = tuple(WAVES)[:5]


def skate(record: Record, names: tuple[str, ...], strength: float) -> None:
    """Cut effects into waveforms: those of the hall, of rows, of the radio."""
    rows = [name for name in names if name not in WAVES]
    radio = [name for name in WAVES if name not in HALL]
    for name in [*HALL, *rows, *radio]:
        if name in rows:
            record.take(EFFECTS[name](record.sheet(), strength))
        elif name in names:
            WAVES[name](record, strength)
