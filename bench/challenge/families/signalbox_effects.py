"""What the signal box's yard hides in ranges and levels: effects in forms of its own, laws, faults.

numpy alone; shared by its tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.signalbox_yard import (
    BELL_S,
    BETWEEN,
    PPM_SECOND_M,
    ROD_M,
    SEMAPHORES_M,
    SIDINGS,
    WAGONS,
    WAVE_M,
    WIDE_M,
    Change,
    Train,
    braked,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
EVERY = len(SEMAPHORES_M)
PULSE_M = 0.31  # scatter of a pulse
TRIED_M = np.linspace(-0.45, 0.45, 91)
CUT_OFF, RARELY_CUT = 0.17, 0.05  # of links


def _own_lags(train: Train, strength: float) -> Change:
    """Compare with what wagons say of themselves, each of which has a clock that is late."""
    lags_s = 0.13 + 0.02 * train.kept(1).standard_normal(WAGONS)
    return Change(train.more(strength * lags_s[train.wagon]))


def _geometric(train: Train, strength: float) -> Change:
    """Give the geometric mean of the ways before and after a reply, as a product's root is."""
    later = train.more(1.5 * min(strength, 2.0) * train.column("reply_time_s"))
    return Change(np.sqrt(train.far * (train.far + later)) - train.far)


def _by_age(train: Train, strength: float) -> Change:
    """Be later the more years a semaphore's radio has stood outside; wagons' are of any make."""
    years = train.kept(2).integers(0, 8, EVERY)
    makes = 0.065 * train.kept(3).weibull(1.3, WAGONS)
    return Change(strength * (0.029 * years[train.semaphore] + makes[train.wagon]))


def _aged_crystals(train: Train, strength: float) -> Change:
    """Leave some of crystals' offset, which grows with the root of their years, either way."""
    rng = train.kept(4)
    years = rng.uniform(0, 9, EVERY + WAGONS)
    ppm = rng.choice([-1.0, 1.0], EVERY + WAGONS) * np.sqrt(years)
    apart = ppm[train.semaphore] - ppm[EVERY + train.wagon]
    return Change(0.0125 * strength * PPM_SECOND_M * apart * train.column("reply_time_s"))


def _arsinh(train: Train, strength: float) -> Change:
    """Drift in proportion about a mild day, and by ever less than that in frost and heat."""
    return Change(0.05 * strength * np.arcsinh((train.column("temperature_c") - 11.0) / 6.0))


def _before_or_behind(train: Train, strength: float) -> Change:
    """Be early before a wagon's end wall and late behind it, with little between the two."""
    turn = np.radians(train.column("azimuth_deg")) + train.kept(5).uniform(0, 2 * np.pi)
    behind = np.tanh(2.2 * np.cos(turn))
    dim = -1.25 * min(strength, 1.5) * (1 + behind)
    return Change(strength * (0.075 * behind + 0.01), whole=dim)


def _softsign(train: Train, strength: float) -> Change:
    """Be late where it is weak, early where it is strong: by x / (1 + |x|) of the level."""
    x = (-87.5 - train.column("rx_power_dbm")) / 5.0
    return Change(strength * (0.092 * x / (1 + np.abs(x)) + 0.012))


def _now_and_then(train: Train, strength: float) -> Change:
    """Scatter a little in most rows and much in every eighth, when an interrupt comes between."""
    much = np.where(train.rng.random(train.size) < 0.125, 2.8, 1.0)
    return Change(0.027 * strength * much * train.rng.standard_normal(train.size))


def _past_a_bend(train: Train, strength: float) -> Change:
    """Lose by the way's square far off and nothing near: one bend, rounded, at 20 m."""
    return Change(0 * train.far, whole=-3.6 * strength * np.log10(1 + (train.far / 20.0) ** 2))


def _cables_too(train: Train, strength: float) -> Change:
    """Count too fast, with what is afterwards taken off for cables in the count as well."""
    return Change(0.0055 * strength * (train.column("range_m") + 1.3))


def _up_or_down(train: Train, strength: float) -> Change:
    """Round up or down to steps by chance, so that the mean is right."""
    step, written = 0.115 * strength, train.column("range_m")
    return Change(step * np.floor(written / step + train.rng.random(train.size)) - written)


def _wall_after_wall(train: Train, strength: float) -> Change:
    """Go through one wall, two or three of what stands between, each of which costs the same."""
    late, lost = np.zeros(train.size), np.zeros(train.size)
    for kind, (thick_m, permittivity, db) in BETWEEN.items():
        walls = train.per_link(lambda n: 1.0 + train.rng.binomial(2, 0.4, n)) * train.through(kind)
        late = late + walls * thick_m * (permittivity**0.5 - 1)
        lost = lost + walls * db
    return Change(1.2 * strength * late, edge=-0.7 * min(strength, 1.5) * lost)


def _by_a_gap(train: Train, strength: float) -> Change:
    """Hear, behind a train, nothing but what finds a gap between two of its wagons."""
    rare = RARELY_CUT if train.scarce else CUT_OFF
    train_there = train.per_link(lambda n: 1.0 * (train.rng.random(n) < rare))
    part = train.per_link(lambda n: train.rng.uniform(0.25, 0.75, n))
    along = train.per_link(lambda n: train.rng.uniform(2.5, 6.0, n) * train.rng.choice([-1, 1], n))
    tags, arms = train.tags(), train.arms()
    gap = tags + part[:, None] * (arms - tags) + along[:, None] * np.array([0, 1.0, 0])
    legs = np.linalg.norm(gap - tags, axis=1) + np.linalg.norm(arms - gap, axis=1)
    detour = np.clip(legs - train.far, 0.28, 4.3)
    return Change(train_there * detour * (0.38 + 0.62 * strength), whole=-5.2 * train_there)


def ballast_ray(train: Train, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ballast is in m, and its complex share, [n] each.

    What stones scatter is lost: Rayleigh's factor of their roughness (Ament 1953).
    """
    heights = train.column("tx_z_m") + train.column("rx_z_m")
    level = np.hypot(*(train.tags() - train.arms())[:, :2].T)
    way = np.hypot(level, heights)
    rough_m = train.per_link(lambda n: train.rng.uniform(0.004, 0.016, n))
    uneven = 4 * np.pi * rough_m * heights / way / WAVE_M
    share = min(1.12 * strength**0.5, 1.5) * np.exp(-0.5 * uneven**2) * 0.86 * train.far / way
    longer = way - train.far
    return longer, -share * np.exp(-2j * np.pi * longer / WAVE_M)


def _ballast(train: Train, strength: float) -> Change:
    """Move, by part of it, with where a matched filter answers both pulses most."""
    longer, share = ballast_ray(train, strength)
    one, two = (np.exp(-np.square((TRIED_M - x) / (2 * PULSE_M))) for x in (0, longer[:, None]))
    size = np.abs(one + share[:, None] * two)
    rows, at = np.arange(len(size)), np.clip(size.argmax(axis=1), 1, len(TRIED_M) - 2)
    low, top, high = (size[rows, at + k] for k in (-1, 0, 1))
    part = np.clip(0.5 * (low - high) / np.minimum(low - 2 * top + high, -1e-12), -1, 1)
    moved = TRIED_M[at] + part * (TRIED_M[1] - TRIED_M[0])
    power = np.square(np.abs(1 + share * np.exp(-np.square(longer / PULSE_M) / 4)))
    return Change(0.4 * moved, whole=10 * np.log10(np.maximum(power, 0.22)))


def _over_and_under(train: Train, strength: float) -> Change:
    """Bend over a tank wagon and under it: powers of two knife edges (ITU-R P.526) add up."""
    tank = train.through("metal")
    over = strength**0.5 * train.per_link(lambda n: train.rng.uniform(0.08, 0.36, n))
    under = strength**0.5 * train.per_link(lambda n: train.rng.uniform(0.08, 0.6, n))
    one = train.far * train.per_link(lambda n: train.rng.triangular(0.15, 0.4, 0.85, n))
    both = 1 / one + 1 / (train.far - one)
    power: Floats = np.zeros(train.size)
    for deep in (over, under):
        x = deep * np.sqrt(2 * both / WAVE_M) - 0.1
        power = power + 10**-0.69 / np.square(np.sqrt(x**2 + 1) + x)
    shorter = 0.5 * np.square(np.minimum(over, under)) * both
    clings = 0.058 * strength * train.per_link(lambda n: train.rng.triangular(0.7, 1.0, 1.3, n))
    db = np.clip(-10 * np.log10(power), 0.5, 14.0)
    return Change(tank * (shorter + clings), edge=-tank * db)


def _either_gain(train: Train, strength: float) -> Change:
    """Take the smaller gain above a band of levels, the larger one below, and in it either."""
    sure = np.clip((train.column("rx_power_dbm") + 93.0) / 8.0, 0, 1)
    small = (train.rng.random(train.size) < sure).astype(np.float64)
    return Change(0 * sure, whole=-2.8 * min(strength, 2.2) * small, count=-4.4 * strength * small)


def _line_hums(train: Train, strength: float) -> Change:
    """Hear the line that feeds the yard: by one over how far it is."""
    off = WIDE_M + 0.5 - SEMAPHORES_M[:, 0]
    loud = (0.4 + 20.0 / (off + 3.0)) * train.kept(6).lognormal(0, 0.15, EVERY)
    hiss = strength * loud[train.semaphore]
    weak = 10 ** (-(train.column("rx_power_dbm") + 92) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Change(0.018 * weak * train.rng.standard_normal(train.size), hiss=hiss)


def _grease(train: Train, strength: float) -> Change:
    return Change(0.21 * strength * (train.column("grease_g") / 40.0) ** 2.1)


def _joints(train: Train, strength: float) -> Change:
    return Change(0.074 * strength * np.sin(2 * np.pi * train.column("chainage_m") / 11.9 - 0.4))


def _heaters(train: Train, strength: float) -> Change:
    return Change(np.where(train.column("heater_kw") > 2.4, 0.132 * strength, 0.0))


def _coal(train: Train, strength: float) -> Change:
    return Change(0.23 * strength * np.tanh(train.column("dust_g") / 55.0))


def _frost(train: Train, strength: float) -> Change:
    return Change(0.068 * strength * np.log(1 + train.column("frost_mm") / 0.7))


def _wires(train: Train, strength: float) -> Change:
    return Change(0.00026 * strength * train.column("sun_w_per_m2"))


def _conducts(train: Train, strength: float) -> Change:
    """Leak through wet ballast what a track circuit drives: one over its resistance."""
    return Change(0.46 * strength / train.column("ballast_ohm"))


def _cant(train: Train, strength: float) -> Change:
    """Stand upright in the plan, and lean in truth with the cant of the siding."""
    cant = strength * SIDINGS[train.column("siding").astype(np.intp), 2]
    aside = np.cross(train.ahead(), [0.0, 0.0, 1.0])
    high = train.column("tx_z_m")
    off = (high * np.sin(cant))[:, None] * aside
    off[:, 2] = high * (np.cos(cant) - 1)
    return Change(train.more_from(train.tags() + off))


def _underrated(train: Train, strength: float) -> Change:
    """Reckon with retarders that brake less than they do: wagons are not as far as is said."""
    slower = train.column("entry_m_per_s") - train.column("exit_m_per_s")
    short = 0.2 * strength * slower * braked(train.column("gripped_s"))
    return Change(train.more_from(train.tags() - short[:, None] * train.ahead()))


def _between_bells(train: Train, strength: float) -> Change:
    """Run fast or slow, each semaphore by itself, and be set right whenever its bell rings."""
    phase, rate = train.kept(7).uniform([[0.0], [-1.0]], [[1.0], [1.0]], (2, EVERY))
    since = np.mod(train.column("time_s") / BELL_S + phase[train.semaphore], 1.0)
    return Change(0.34 * strength * rate[train.semaphore] * since)


def _stand(train: Train, semaphores_m: Floats) -> Change:
    """Return what changes in rows whose semaphores stand at [10, 3] in truth."""
    truly = np.sqrt(np.square(train.tags() - semaphores_m[train.semaphore]).sum(axis=1))
    return Change(truly - train.far, whole=-20.4 * np.log10(truly / train.far))


def _struck(train: Train, strength: float) -> Change:
    places = SEMAPHORES_M.copy()
    places[7] += 0.555 * strength * np.array([2.0, 9.0, -6.0]) / 11
    return _stand(train, places)


def _renamed(train: Train, _: float) -> Change:
    places = SEMAPHORES_M.copy()
    places[[3, 8]] = places[[8, 3]]
    return _stand(train, places)


def _rods(train: Train, _: float) -> Change:
    """Write rods, at one semaphore, as the line was once surveyed."""
    there = (train.semaphore == 1).astype(np.float64)
    return Change(there * (1 / ROD_M - 1) * train.column("range_m"))


EFFECTS: dict[str, Callable[[Train, float], Change]] = {
    "time-lag": _own_lags,
    "exchange-motion": _geometric,
    "antenna-delay": _by_age,
    "clock-offset": _aged_crystals,
    "temperature-drift": _arsinh,
    "antenna-pattern": _before_or_behind,
    "power-bias": _softsign,
    "timestamp-jitter": _now_and_then,
    "path-loss": _past_a_bend,
    "range-scale": _cables_too,
    "range-rounding": _up_or_down,
    "material-delay": _wall_after_wall,
    "blocked-path": _by_a_gap,
    "ground-bounce": _ballast,
    "diffraction": _over_and_under,
    "level-control": _either_gain,
    "noise-floor": _line_hums,
    "grease-on-domes": _grease,
    "rail-joints": _joints,
    "point-heaters-on": _heaters,
    "coal-dust": _coal,
    "frost-on-arms": _frost,
    "wires-lengthen-in-sun": _wires,
    "ballast-conducts": _conducts,
    "cant-forgotten": _cant,
    "retarders-underrated": _underrated,
    "clocks-run-between-bells": _between_bells,
    "semaphore-struck": _struck,
    "semaphores-renamed": _renamed,
    "rods-from-one-semaphore": _rods,
}
