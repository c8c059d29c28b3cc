"""What the atrium hides in waveforms: effects in forms of its own, oddities of its units.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.atrium_effects import EFFECTS, marble_ray
from bench.challenge.families.atrium_unit import AT, METRES, WIDE_SAMPLES, Unit, rustle
from bench.challenge.families.atrium_well import BALCONIES, COURT_M
from bench.challenge.families.atrium_well import LAWS as OF_ROWS
from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the atrium's tables of ranges."""
ODD = ("late-sizes-capped", "comb-left-in", "tail-cancelled-too-well")
AWAY = ("encoder-wheel-worn", "snapped-to-landings", "toises-from-one-balcony")
LAWS = {name: law for name, law in OF_ROWS.items() if name not in AWAY} | {
    name: Law() for name in ODD
}
"""What nobody's library has."""
FROM = 11.0  # samples past first paths, from which units are odd
TRIED: Floats = np.random.default_rng(1308).normal(size=(2, 30000))  # noise to try readings on


def _parapets(unit: Unit, strength: float) -> None:
    """Hear the court's four sides, whose parapets of glass return more, the more they are grazed.

    By images; of some sides a link sees less than of others.
    """
    ride, first = unit.ride(), unit.came() * unit.front()
    for axis in (0, 1):
        for side_m in (0.0, COURT_M[axis]):
            image = ride.ear.copy()
            image[:, axis] = 2 * side_m - image[:, axis]
            longer = np.linalg.norm(ride.tag - image, axis=1) - ride.apart
            seen = ride.by_link(lambda n: unit.rng.triangular(0.15, 0.8, 1.0, n))
            size = 1.05 * strength**0.5 * seen * ride.apart / (ride.apart + longer)
            late = np.maximum(longer / METRES, 2.6)
            unit.echo(first, np.minimum(size, 0.8) * unit.any_phase(), late)


def _marble(unit: Unit, strength: float) -> None:
    longer, share = marble_ray(unit.ride(), strength)
    unit.echo(unit.came(), share, longer / METRES)


def _behind_pillars(unit: Unit, strength: float) -> None:
    """Lose what comes straight behind clad pillars: what is left goes round, by three ways."""
    ride, heard = unit.ride(), unit.came()
    behind = ride.chosen(0.23)
    unit.weaken(1 - 0.982 * behind[:, None] * unit.front())
    late = 1.3 + 1.8 * strength**0.75 * ride.by_link(lambda n: unit.rng.gamma(9.0, 1 / 9.0, n))
    for size in (0.42, 0.34, 0.22):
        unit.echo(heard, size * behind * unit.any_phase(), late)
        late = late + ride.by_link(lambda n: unit.rng.uniform(1.0, 3.4, n))


def _gamma_fading(unit: Unit, strength: float) -> None:
    """Fade by a gamma law of powers, alike from one knot to the next, three samples on."""
    knots = np.arange(0, WIDE_SAMPLES + 3, 3)
    m = 1.3 / strength**0.7
    power = unit.rng.gamma(m, 1 / m, (unit.size, len(knots)))
    part = AT / 3 - np.floor(AT / 3)
    left = np.floor(AT / 3).astype(np.int64)
    size = np.sqrt(power[:, left] * (1 - part) + power[:, left + 1] * part)
    unit.wave = unit.wave + unit.came() * (size - 1)


def _two_rooms(unit: Unit, strength: float) -> None:
    """Reverberate in court and galleries: two tails, of which the lesser one lasts."""
    past = np.maximum(unit.past - 3.0, 0.0)
    power = 0.028 * np.exp(-past / 7.0) + 0.012 * np.exp(-past / 30.0)
    size = np.sqrt(0.5 * strength * power * unit.since(3.5, 1.0))
    unit.wave = unit.wave + unit.height()[:, None] * size * rustle(unit.rng, unit.size)


def _rail_rings(unit: Unit, strength: float) -> None:
    """Ring in a handrail: every four samples or so, and each time less."""
    lag = 3.6 + 1.3 * float(unit.shared(1).random())
    turn = np.exp(1j * float(unit.shared(2).uniform(-np.pi, np.pi)))
    heard, size = unit.came(), 0.3 * min(strength, 2.4) ** 0.8
    for k in range(1, 6):
        by = np.full(unit.size, size * 0.62 ** (k - 1) * turn**k)
        unit.echo(heard, by, np.full(unit.size, lag * k))


def _wall_of_lamps(unit: Unit, strength: float) -> None:
    noise = EFFECTS["noise-floor"](unit.ride(), strength).noise
    unit.raise_noise(np.asarray(noise) + np.zeros(unit.size))


def _in_bursts(unit: Unit, strength: float) -> None:
    """Hear a carrier that some other service keys: louder at some balconies, and at some times."""
    pitch = float(unit.shared(3).uniform(0.5, 1.7))
    own = unit.shared(4).gamma(6.0, 1 / 6.0, BALCONIES).clip(0.5, 1.7)[unit.ride().balcony]
    size = 1.6 * strength * own * unit.rng.beta(5.0, 2.0, unit.size)
    tone = np.exp(1j * pitch * AT) * unit.any_phase()[:, None]
    unit.wave = unit.wave + (size * unit.sigma)[:, None] * tone
    sizes = np.linspace(0.0, 10.0, 51)
    spread = [np.abs(TRIED[0] + one + 1j * TRIED[1]).std() for one in sizes]
    unit.noisier = unit.noisier * np.interp(size, sizes, np.array(spread) / spread[0])
    unit.sigma = unit.sigma * np.sqrt(1 + 0.5 * size**2)


def _capped(unit: Unit, strength: float) -> None:
    """Cap late sizes softly, where what follows a first pulse is taken to be no signal."""
    size, late = np.abs(unit.wave), unit.since(FROM)
    usual = np.sqrt((late * size**2).sum(axis=1) / late.sum(axis=1))[:, None]
    cap = usual * 1.1 / strength**0.6
    unit.wave = unit.wave * (1 + late * (1 / (1 + (size / cap) ** 2) ** 0.5 - 1))


def _comb(unit: Unit, strength: float) -> None:
    """Leave a comb in late samples, by which a unit tries its gain: every fifth is small."""
    comb = np.cos(np.pi * (AT + int(unit.shared(5).integers(5))) / 5) ** 4
    unit.wave = unit.wave * (1 - min(0.7 * strength, 0.95) * comb * unit.since(FROM))


def _cancelled(unit: Unit, strength: float) -> None:
    """Take off what is late as if it were told in advance by the two samples before it."""
    wide = np.pad(unit.wave, ((0, 0), (2, 0)))
    told = 0.5 * wide[:, 1:-1] + 0.3 * wide[:, :-2]
    share = min(0.7 * strength, 1.3)
    unit.wave = unit.wave - share * unit.since(FROM) * told


def _companded(unit: Unit, strength: float) -> None:
    """Keep both parts in whole steps, half a step off zero, so that nothing is nothing."""
    step = 1.25 * strength * float(np.median(unit.sigma))
    real, imaginary = (
        step * (np.floor(part / step) + 0.5) for part in (unit.wave.real, unit.wave.imag)
    )
    unit.wave = real + 1j * imaginary
    steps = np.geomspace(0.1, 8.0, 45)
    spread = [np.hypot(*(one * (np.floor(TRIED / one) + 0.5))).std() for one in steps]
    by = np.interp(step / unit.sigma, steps, np.array(spread) / np.hypot(*TRIED).std())
    unit.noisier = unit.noisier * np.maximum(by, 0.05)


def _deaf(unit: Unit, strength: float) -> None:
    """Ask for more, as a unit does that was set up beside something loud."""
    unit.deaf = strength


IN_THE_COURT: dict[str, Callable[[Unit, float], None]] = {
    "obstructed-path": _behind_pillars,
    "specular-reflections": _parapets,
    "ground-bounce": _marble,
    "diffuse-tail": _two_rooms,
    "small-scale-fading": _gamma_fading,
}
IN_UNITS: dict[str, Callable[[Unit, float], None]] = {
    "pulse-ringing": _rail_rings,
    "noise-floor": _wall_of_lamps,
    "narrowband-interference": _in_bursts,
    "tail-cancelled-too-well": _cancelled,
    "late-sizes-capped": _capped,
    "comb-left-in": _comb,
    "quantisation": _companded,
    "late-detection": _deaf,
}
WAVES = IN_THE_COURT | IN_UNITS


def go_through(unit: Unit, names: tuple[str, ...], strength: float) -> None:
    """Put waveforms through effects: those in the court, those of rows, those in units."""
    for name in (one for one in IN_THE_COURT if one in names):
        IN_THE_COURT[name](unit, strength)
    for name in (one for one in EFFECTS if one in names and one not in WAVES):
        unit.upset(EFFECTS[name](unit.ride(), strength))
    for name in (one for one in IN_UNITS if one in names):
        IN_UNITS[name](unit, strength)
