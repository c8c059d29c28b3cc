"""What the chairlift hides in waveforms: effects in forms of its own, oddities of its masts.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.chairlift_effects import EFFECTS, by_trees, snow_ray
from bench.challenge.families.chairlift_mast import (
    METRES,
    PEAK,
    SAMPLES_AT,
    WIDE_SAMPLES,
    Mast,
    murmur,
)
from bench.challenge.families.chairlift_rope import LAWS as LAWS_OF_ROWS
from bench.challenge.families.chairlift_rope import PYLONS_M

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "path-loss", "level-control", "power-bias", "exchange-motion", "time-lag", "clock-offset",
    "antenna-delay", "temperature-drift", "timestamp-jitter", "antenna-pattern", "range-scale",
    "material-delay", "diffraction",
)  # fmt: skip
"""Effects that are those of the chairlift's tables of ranges."""
ODD = ("converter-sticks", "late-sizes-inverted", "lesser-of-pairs")
LAWS = {
    name: law
    for name, law in (LAWS_OF_ROWS | dict.fromkeys(ODD, Law())).items()
    if name not in ("rope-hangs-lower", "lead-in-the-filter", "klafters-from-one-pylon")
}
"""What nobody's library has."""
SINCE = 12.0  # samples past edges, from which masts are odd
SHEDS_M = ((0, -6.0), (0, 131.0), (1, 8.3))  # walls of stations, and of a shed against snow


def _sheds_and_trees(mast: Mast, strength: float) -> None:
    """Hear walls of stations and of a snow shed, and the wood's edge, whose trunks scatter."""
    trip, come = mast.trip(), mast.come() * mast.leading()
    for axis, wall_m in SHEDS_M:
        depth = (trip.seat[:, axis] - wall_m) * (trip.mast[:, axis] - wall_m)
        longer = np.sqrt(trip.long**2 + 4 * np.maximum(depth, 0.1)) - trip.long
        metal = trip.for_links(lambda n: mast.rng.uniform(0.6, 1.0, n))
        by = 1.5 * strength**0.5 * metal * trip.long / (trip.long + longer)
        mast.repeat(come, by.clip(max=0.85) * mast.spins(), longer.clip(min=1.2) / METRES)
    by = 0.55 * strength**0.5 * trip.for_links(lambda n: mast.rng.rayleigh(0.8, n).clip(max=1.6))
    for later_m in (0.0, 1.7, 3.9):
        size = by * trip.long / (trip.long + by_trees(trip) + later_m)
        mast.repeat(come, size * mast.spins(), (by_trees(trip) + later_m) / METRES)


def _snow(mast: Mast, strength: float) -> None:
    longer, share = snow_ray(mast.trip(), 0.5 * strength)
    mast.repeat(mast.come(), share, longer / METRES)


def _behind_cabins(mast: Mast, strength: float) -> None:
    """Lose, behind cabins, what comes straight: it comes through windows and off hangers."""
    trip, come = mast.trip(), mast.come()
    cabin = trip.some(0.23)
    mast.leave(1 - 0.983 * cabin[:, None] * mast.leading())
    late = trip.for_links(lambda n: 1.2 + strength * mast.rng.triangular(1.0, 1.8, 3.2, n))
    for size in (0.4, 0.5, 0.3, 0.22):
        own = trip.for_links(lambda n: mast.rng.uniform(0.8, 1.15, n))
        mast.repeat(come, size * own * cabin * mast.spins(), late)
        late = late + trip.for_links(lambda n: mast.rng.weibull(1.5, n) * 2.0 + 0.4)


def _beats(mast: Mast, strength: float) -> None:
    """Fade by two waves that beat: one steady, the other's phase strays from sample to sample."""
    other = 0.97 * np.tanh(1.1 * strength**0.7)
    stray = mast.rng.normal(0.0, 0.55, (mast.rows, WIDE_SAMPLES)).cumsum(axis=1)
    begin = mast.rng.uniform(0, 2 * np.pi, (mast.rows, 1))
    both = np.abs(1 + other * np.exp(1j * (begin + stray))) / np.sqrt(1 + other**2)
    mast.wave = mast.wave + (both - 1) * mast.come()


def _wood(mast: Mast, strength: float) -> None:
    """Scatter in the wood: by an exponential of a root, deep trunks being dim behind others."""
    past = np.maximum(mast.off - PEAK, 0.0)
    power = 0.22 * strength * np.exp(-np.sqrt(past / 2.4)) * mast.from_(5.0, 4.0)
    size = np.sqrt(power / 2) * mast.peaks()[:, None]
    mast.wave = mast.wave + size * murmur(mast.rng, mast.rows)


def _to_and_fro(mast: Mast, strength: float) -> None:
    """Run to and fro on a cable that fits neither end: so many samples later, each time less."""
    longs, turn = mast.fixed(1).uniform((4.6, 0.0), (6.4, 2 * np.pi))
    come, back = mast.come(), min(0.26 * strength**0.8, 0.55) * np.exp(1j * turn)
    for times in range(1, 6):
        by = np.full(mast.rows, back**times)
        mast.repeat(come, by, np.full(mast.rows, longs * times))


def _the_drive(mast: Mast, strength: float) -> None:
    mast.louder_noise(np.asarray(EFFECTS["noise-floor"](mast.trip(), strength)["noise"]))


def _two_tones(mast: Mast, strength: float) -> None:
    """Hear radios of rescuers: two tones, by lot louder, and at some masts."""
    pitch = mast.fixed(2).uniform(-1.5, -0.6)
    near = mast.fixed(3).triangular(0.6, 0.9, 1.5, len(PYLONS_M))[mast.trip().pylon]
    size = 1.15 * strength * near * mast.rng.lognormal(0.0, 0.2, mast.rows)
    tones = [np.exp(1j * one * SAMPLES_AT) * mast.spins()[:, None] for one in (pitch, pitch + 1.3)]
    mast.wave = mast.wave + (size * mast.sigma)[:, None] * (tones[0] + tones[1])
    mast.times["noise"] = mast.times["noise"] * _beside_tones(size)
    mast.sigma = mast.sigma * np.sqrt(1 + np.square(size))


def _beside_tones(size: Floats) -> Floats:
    """Return how many times more sizes of noise scatter beside two tones of sizes [n]: tried."""
    rng = np.random.default_rng(1225)
    noise = rng.standard_normal((2, 32000))
    beat = 2 * np.abs(np.cos(rng.uniform(0, np.pi, 32000)))
    sizes = np.linspace(0.0, 8.0, 41)
    spread = [np.std(np.abs(noise[0] + one * beat + 1j * noise[1])) for one in sizes]
    return np.asarray(np.interp(size, sizes, spread) / spread[0])


def _resized(mast: Mast, wanted: Floats, part: Floats) -> None:
    """Let sizes become others by a part [n, k], and keep phases."""
    size = np.maximum(np.abs(mast.wave), 1e-9)
    mast.wave = mast.wave * (1 - part + part * wanted / size)


def _sticks(mast: Mast, strength: float) -> None:
    """Read late sizes by a converter that sticks where it is low: it rises by parts of itself."""
    size, stuck = np.abs(mast.wave), np.abs(mast.wave)
    for at in range(1, WIDE_SAMPLES):
        stuck[:, at] = np.minimum(size[:, at], stuck[:, at - 1] * (1 + 0.22 / strength) + 1e-6)
    _resized(mast, stuck, mast.from_(SINCE))


def _inverted(mast: Mast, strength: float) -> None:
    """Invert late sizes, in part, about what is usual: a bit of a sign is wrong."""
    size, late = np.abs(mast.wave), mast.from_(SINCE)
    usual = np.sqrt((late * size**2).sum(axis=1) / np.maximum(late.sum(axis=1), 1.0))[:, None]
    _resized(mast, np.maximum(1.7 * usual - size, 0.0), min(0.45 * strength, 1.0) * late)


def _lesser(mast: Mast, strength: float) -> None:
    """Keep the lesser of every two late sizes, and little of the other, as if it were a spark."""
    size = np.abs(mast.wave)
    pair = size.reshape(mast.rows, -1, 2).min(axis=2).repeat(2, axis=1)
    kept = np.where(size > pair, 0.3 * pair, pair)
    _resized(mast, kept, min(0.9 * strength, 1.0) * mast.from_(SINCE))


def _rings(mast: Mast, strength: float) -> None:
    """Keep sizes in whole steps, and phases as they are: what is written is a size."""
    step = 1.2 * strength * float(np.median(mast.sigma))
    _resized(mast, step * np.rint(np.abs(mast.wave) / step), np.ones((mast.rows, 1)))
    sizes = np.random.default_rng(1226).rayleigh(1.0, 32000)
    steps = np.geomspace(0.1, 5.0, 36)
    spread = np.array([np.std(one * np.rint(sizes / one)) for one in steps]) / sizes.std()
    by = np.interp(step / mast.sigma, steps, spread)
    mast.times["noise"] = mast.times["noise"] * np.maximum(by, 0.05)


def _dense(mast: Mast, strength: float) -> None:
    """Ask for more of an edge, so that a weak one passes unseen."""
    mast.dense = strength


ALONG: dict[str, Callable[[Mast, float], None]] = {
    "specular-reflections": _sheds_and_trees,
    "obstructed-path": _behind_cabins,
    "ground-bounce": _snow,
    "diffuse-tail": _wood,
    "small-scale-fading": _beats,
}
AT_MASTS: dict[str, Callable[[Mast, float], None]] = {
    "noise-floor": _the_drive,
    "pulse-ringing": _to_and_fro,
    "narrowband-interference": _two_tones,
    "late-sizes-inverted": _inverted,
    "converter-sticks": _sticks,
    "lesser-of-pairs": _lesser,
    "quantisation": _rings,
    "late-detection": _dense,
}
WAVES = {**ALONG, **AT_MASTS}


def ail(mast: Mast, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms ail: by what is along the line, by what ails rows, by what masts have."""
    for group in (ALONG, EFFECTS, AT_MASTS):
        for name in group:
            if name not in names or (group is EFFECTS and name in WAVES):
                continue
            if group is EFFECTS:
                mast.fall_ill(EFFECTS[name](mast.trip(), strength))
            else:
                WAVES[name](mast, strength)
