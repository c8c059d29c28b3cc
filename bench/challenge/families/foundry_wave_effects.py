"""What the foundry hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.foundry_bay import BAY_M, CARRIER_M, Pour
from bench.challenge.families.foundry_bay import LAWS as RANGE_LAWS
from bench.challenge.families.foundry_effects import EFFECTS, girder_way, sand_ray
from bench.challenge.families.foundry_gauge import METRES, TICK, Gauge, grate

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the foundry's tables of ranges."""
STRANGE = ("words-left-in-gray", "small-details-dropped", "late-part-differenced")
NOT_HERE = ("hooks-swing-less", "braking-way-taken-off", "cubits-from-one-column")
LAWS = {name: law for name, law in RANGE_LAWS.items() if name not in NOT_HERE} | {
    name: Law() for name in STRANGE
}
"""What nobody's library has."""
SHEETS, RIBS_M = 0.7, 0.0045  # of what meets corrugated walls, returned; how deep these are
LATE = 10.0  # samples past arrivals from which oddities are


def _flutter(gauge: Gauge, strength: float) -> None:
    """Hear both long walls again and again, and what is above: ways to and fro, by their ribs.

    What is uneven returns less the steeper it is met (Rayleigh).
    """
    pour, leading = gauge.pour(), gauge.signal() * gauge.lead()
    x, other = (pour.place(end)[:, 0] for end in ("tx", "rx"))
    rest = np.sqrt(np.maximum(pour.way**2 - (x - other) ** 2, 0.01))
    wide = BAY_M[0]
    for across, met in (
        (x + other, 1), (2 * wide - x - other, 1), (2 * wide + other - x, 2),
        (2 * wide + x - other, 2), (2 * wide + x + other, 3), (4 * wide - x - other, 3),
    ):  # fmt: skip
        way = np.hypot(across, rest)
        share = strength**0.5 * SHEETS**met * _even(met * (across / way) ** 2)
        _echo(gauge, pour, way, share, leading)
    way = girder_way(pour)
    _echo(gauge, pour, way, 0.55 * strength**0.5 * _even(1 - (rest / way) ** 2), leading)


def _even(steep: Floats) -> Floats:
    """Return what ribs leave of what is met so steeply: squares of sines [n]."""
    return np.asarray(np.exp(-0.5 * (4 * np.pi * RIBS_M / CARRIER_M) ** 2 * steep))


def _echo(gauge: Gauge, pour: Pour, way: Floats, part: Floats, of: Complexes) -> None:
    """Hear ways [n] in m that return such a part [n], some links more."""
    own = pour.for_links(lambda n: gauge.rng.triangular(0.6, 0.9, 1.2, n))
    share = np.minimum(1.25 * part * own * pour.way / way, 0.85)
    gauge.join(share * gauge.spun(), np.maximum(way - pour.way, 1.0) / METRES, of)


def _sand(gauge: Gauge, strength: float) -> None:
    longer, share = sand_ray(gauge.pour(), strength)
    gauge.join(share, longer / METRES, gauge.signal())


def _behind_buckets(gauge: Gauge, strength: float) -> None:
    """Lose, behind charging buckets, what comes straight: it comes by gaps of any order between."""
    pour, signal = gauge.pour(), gauge.signal()
    behind = pour.some_links(0.21)
    gauge.dim(1 - 0.983 * behind[:, None] * gauge.come() * gauge.lead())
    latest = (0.45 + 0.55 * strength) * pour.for_links(lambda n: gauge.rng.uniform(5.0, 9.0, n))
    gaps = [pour.for_links(lambda n: gauge.rng.uniform(0.45, 1.0, n)) for _ in range(4)]
    for late in np.sort(gaps, axis=0):
        size = 0.33 * pour.for_links(lambda n: gauge.rng.uniform(0.7, 1.2, n))
        gauge.join(behind * size * gauge.spun(), late * latest, signal)


def _weibull(gauge: Gauge, strength: float) -> None:
    """Fade by Weibull's sizes, which are powers of what Rayleigh's are, alike for some samples."""
    knots = len(TICK) // 6 + 3
    drawn = gauge.rng.standard_normal((len(gauge), knots, 2)) @ np.array([1.0, 1j])
    place = TICK / 6 + gauge.rng.random((len(gauge), 1))
    left = np.floor(place).astype(np.intp)
    part = place - left
    one, other = (np.take_along_axis(drawn, left + k, axis=1) for k in (0, 1))
    sizes = np.abs((one * (1 - part) + other * part) / np.hypot(1 - part, part)) / np.sqrt(2)
    faded = sizes ** min(0.34 * strength**0.7, 0.95)
    gauge.dim(1 + gauge.come() * (faded / np.sqrt(np.mean(faded**2)) - 1))


def _two_rooms(gauge: Gauge, strength: float) -> None:
    """Reverberate in the bay and in pits beside it: two exponential falls, one fast, one slow."""
    past = np.maximum(gauge.past - 2.5, 0.0)
    power = 0.026 * strength * (np.exp(-past / 9.0) + 0.25 * np.exp(-past / 45.0))
    power = power * gauge.beyond(2.5, 4.0)
    rough = np.sqrt(power / 2) * grate(gauge.rng, len(gauge))
    gauge.seen = gauge.seen + gauge.tall()[:, None] * rough


def _mismatch(gauge: Gauge, strength: float) -> None:
    """Ring along a cable that ends badly: to and fro again, each time less and turned over."""
    late, turn = gauge.lasting(1).uniform((4.6, 0.0), (6.6, 2 * np.pi))
    back = 0.3 * min(strength, 2.3) ** 0.7
    signal = gauge.signal()
    for times in range(1, 5):
        share = -((-back) ** times) * np.exp(1j * turn * times)
        gauge.join(np.full(len(gauge), share), np.full(len(gauge), late * times), signal)


def _furnaces(gauge: Gauge, strength: float) -> None:
    gauge.louder(np.asarray(EFFECTS["noise-floor"](gauge.pour(), strength).noise_db))


def _remote_control(gauge: Gauge, strength: float) -> None:
    """Hear a harmonic of cranes' remote controls: a tone whose pitch swings, at some hauls."""
    pitch, deep = gauge.lasting(2).uniform((-0.3, 1.5), (0.3, 3.5))
    pour = gauge.pour()
    near = pour.for_links(lambda n: gauge.rng.uniform(0.35, 1.65, n))
    size = 1.6 * strength * near
    swing = np.sin(2 * np.pi * (TICK / 53.0 + gauge.rng.random((len(gauge), 1))))
    tone = np.exp(1j * (2 * np.pi * pitch * TICK + deep * swing)) * gauge.spun()[:, None]
    gauge.seen = gauge.seen + (size * gauge.sigma)[:, None] * tone
    gauge.noisier = gauge.noisier * _with_tone(size)
    gauge.sigma = gauge.sigma * np.sqrt(1 + 0.5 * size**2)


def _with_tone(size: Floats) -> Floats:
    """Return how many times more sizes scatter with a tone so many times noise's [n]: by trial."""
    real, imaginary = np.random.default_rng(1027).standard_normal((2, 20000))
    tried = np.linspace(0, 7, 36)
    spread = np.array([np.hypot(real + one, imaginary).std() for one in tried])
    return np.asarray(np.interp(size, tried, spread / spread[0]))


def _late_root(gauge: Gauge) -> tuple[NDArray[np.bool_], Floats, Floats]:
    """Return which samples are late, all sizes, and roots of mean late powers [n, 1]."""
    late, size = gauge.past > LATE, np.abs(gauge.seen)
    power = np.sum(late * size**2, axis=1) / np.maximum(np.sum(late, axis=1), 1)
    return late, size, np.sqrt(power)[:, None]


def _gray(gauge: Gauge, strength: float) -> None:
    """Leave late sizes in Gray's code of the converter, some of them: neighbours lie far apart."""
    late, size, usual = _late_root(gauge)
    step = usual / 12.0
    word = np.floor(size / step).astype(np.int64)
    coded = np.bitwise_xor(word, word >> 1) * step
    share = min(0.45 * strength, 0.9)
    gauge.seen = gauge.seen * np.where(late, 1 + share * (coded / np.maximum(size, 1e-9) - 1), 1)


def _details(gauge: Gauge, strength: float) -> None:
    """Drop small details of late sizes, as Haar's wavelets show them, to write less."""
    late, size, usual = _late_root(gauge)
    small, kept = 0.55 * min(strength, 2.0) ** 0.6 * usual, size.copy()
    for _ in range(2):  # pairs, then pairs that begin one later
        pairs = kept[:, : kept.shape[1] // 2 * 2].reshape(len(size), -1, 2)
        mean, half = pairs.mean(axis=2), (pairs[:, :, 0] - pairs[:, :, 1]) / 2
        half = np.where(np.abs(half) < small, 0.0, half)
        whole = np.stack([mean + half, mean - half], axis=2).reshape(len(size), -1)
        kept = np.roll(whole, -1, axis=1)
    kept = np.roll(kept, 2, axis=1)
    gauge.seen = gauge.seen * np.where(late, kept / np.maximum(size, 1e-9), 1.0)


def _differenced(gauge: Gauge, strength: float) -> None:
    """Write late samples less a part of those before: a step of a coder that was not undone."""
    before = np.concatenate([gauge.seen[:, :1], gauge.seen[:, :-1]], axis=1)
    part = min(0.4 * strength, 0.85)
    gauge.seen = gauge.seen - part * gauge.beyond(LATE) * before


def _by_angle(gauge: Gauge, strength: float) -> None:
    """Keep sizes in whole steps and phases in sixteenths of a turn, as a CORDIC does."""
    step = 1.3 * strength * float(np.median(gauge.sigma))
    sixteenth = np.pi / 8
    angle = sixteenth * np.rint(np.angle(gauge.seen) / sixteenth)
    gauge.seen = step * np.floor(np.abs(gauge.seen) / step + 0.5) * np.exp(1j * angle)
    noise = np.hypot(*np.random.default_rng(1028).standard_normal((2, 15000)))
    tried = np.geomspace(0.1, 8.0, 40)
    spread = np.array([(one * np.rint(noise / one)).std() for one in tried]) / noise.std()
    by = np.interp(step / gauge.sigma, tried, spread)
    gauge.noisier = gauge.noisier * np.maximum(by, 0.05)


def _blunt(gauge: Gauge, strength: float) -> None:
    """Ask more of a first pulse: one that is weak is not seen."""
    gauge.blunt = 1.05 * strength


OUTSIDE: dict[str, Callable[[Gauge, float], None]] = {
    "specular-reflections": _flutter,
    "ground-bounce": _sand,
    "obstructed-path": _behind_buckets,
    "small-scale-fading": _weibull,
    "diffuse-tail": _two_rooms,
}
INSIDE: dict[str, Callable[[Gauge, float], None]] = {
    "pulse-ringing": _mismatch,
    "noise-floor": _furnaces,
    "narrowband-interference": _remote_control,
    "words-left-in-gray": _gray,
    "small-details-dropped": _details,
    "late-part-differenced": _differenced,
    "quantisation": _by_angle,
    "late-detection": _blunt,
}
WAVES = OUTSIDE | INSIDE


def put_through(gauge: Gauge, names: tuple[str, ...], strength: float) -> None:
    """Put waveforms through effects: those outside of the radio, those of rows, those inside."""
    for name in [one for one in OUTSIDE if one in names]:
        OUTSIDE[name](gauge, strength)
    for name in [one for one in names if one not in WAVES]:
        gauge.take(EFFECTS[name](gauge.pour(), strength))
    for name in [one for one in INSIDE if one in names]:
        INSIDE[name](gauge, strength)
