"""What the brewery hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the brewery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.brewery_cellar import (
    BARROWS,
    ELL_M,
    FILLED,
    GANTRIES_M,
    HALF_PPM_M,
    HANDLE_M,
    LONG_M,
    WAVE_M,
    WIDE_M,
    Batch,
    Brew,
    handles,
)

Floats = NDArray[np.float64]
EVERY = len(GANTRIES_M)
SCALE_M = 0.34  # of a pulse, as the scatter of a bell


def _hunting(batch: Batch, strength: float) -> Brew:
    """Compare with places whose clock is set by a servo that hunts: now older, now newer."""
    old_s = 0.15 * (1 + 0.25 * np.sin(2 * np.pi * batch.get("time_s") / 37.0))
    return Brew(batch.farther(strength * old_s))


def _three_eighths(batch: Batch, strength: float) -> Brew:
    """Measure the mean of the way while a reply is awaited: by Simpson's three eighths."""
    wait_s = 1.7 * min(strength, 2.0) * batch.get("reply_time_s")
    parts = [3 * batch.farther(wait_s / 3), 3 * batch.farther(2 * wait_s / 3)]
    return Brew((parts[0] + parts[1] + batch.farther(wait_s)) / 8)


def _splitters(batch: Batch, strength: float) -> Brew:
    """Reach gantries through splitters, by as many more as their numbers have binary ones."""
    rng = batch.recipe(1)
    ones = np.array([one.bit_count() for one in range(EVERY)])
    leads = 0.045 * ones + 0.01 * rng.random(EVERY)
    return Brew(strength * (leads[batch.gantry] + rng.gamma(1.2, 0.045, BARROWS)[batch.barrow]))


def _dead_zone(batch: Batch, strength: float) -> Brew:
    """Correct crystals' offset, but not for what is within a dead zone of 1.3 ppm."""
    rng = batch.recipe(2)
    ppm = (
        rng.laplace(0, 2.2, EVERY)[batch.gantry]
        - rng.choice([-2.4, 0.3, 2.0], BARROWS)[batch.barrow]
    )
    left = np.clip(ppm, -1.3, 1.3) + 0.02 * ppm
    return Brew(0.034 * strength * HALF_PPM_M * left * batch.get("reply_time_s"))


def _warms(batch: Batch, strength: float) -> Brew:
    """Drift by the logarithm of how warm it is above freezing, most in the cold."""
    warm = np.maximum(batch.get("temperature_c") + 3.0, 0.5)
    return Brew(0.072 * strength * (np.log(warm / 20.0) + 0.25))


def _half_plane(batch: Batch, strength: float) -> Brew:
    """Be late and weak over the half that the load fills: a cosine, and nothing behind it."""
    turn = np.radians(batch.get("azimuth_deg")) - batch.recipe(3).uniform(0, 2 * np.pi)
    load = np.maximum(np.cos(turn), 0.0)
    return Brew(0.17 * strength * (load - 0.2), whole=-2.7 * min(strength, 1.5) * load)


def _hill(batch: Batch, strength: float) -> Brew:
    """Be late where it is weak: by Hill's curve of how far it is below a level, squared."""
    x = np.maximum(-79.0 - batch.get("rx_power_dbm"), 0.0) / 7.0
    return Brew(strength * (0.16 * x**2 / (1 + x**2) - 0.06))


def _latest(batch: Batch, strength: float) -> Brew:
    """Time by the latest of many edges: Gumbel's law, less its mean."""
    return Brew(0.033 * strength * (batch.rng.gumbel(size=batch.rows) - np.euler_gamma))


def _tanks(batch: Batch, strength: float) -> Brew:
    """Lose some with each tank that a way passes close by: as many as Poisson has it."""
    near = batch.links(lambda n: 1.0 * batch.rng.poisson(1.0, n)) * batch.m / 14.0
    return Brew(0 * near, whole=-strength * (0.075 * batch.m + 0.5 * near))


def _cable_first(batch: Batch, strength: float) -> Brew:
    """Count too fast what is left of a way once a cable of 0.9 m is taken off."""
    return Brew(0.0051 * strength * (batch.get("range_m") - 0.9))


def _two_steps(batch: Batch, strength: float) -> Brew:
    """Round to steps, which gantries of one make have half again as long as the others."""
    step = strength * np.where(batch.gantry % 2 == 0, 0.12, 0.18)
    written = batch.get("range_m")
    return Brew(step * np.floor(written / step + 0.5) - written)


def _part_full(batch: Batch, strength: float) -> Brew:
    """Go through what is partly full: a third root of permittivity mixes (Looyenga 1965)."""
    late, lost = np.zeros(batch.rows), np.zeros(batch.rows)
    for kind, (thick_m, permittivity, db) in FILLED.items():
        full = batch.links(lambda n: batch.rng.uniform(0.6, 1.0, n))
        mixed = (1 + full * (permittivity ** (1 / 3) - 1)) ** 3
        there = batch.stands(kind)
        late += there * thick_m * (np.sqrt(mixed) - 1)
        lost += there * db * full / 0.8
    return Brew(1.9 * strength * late, edge=-min(strength, 1.5) * lost)


def _by_next_row(batch: Batch, strength: float) -> Brew:
    """Hear, behind a tank, nothing but what the row of tanks beside the aisle returns."""
    share = 0.055 if batch.rare else 0.17
    tank = batch.links(lambda n: np.where(batch.rng.random(n) < share, 1.0, 0.0))
    aside = batch.links(lambda n: batch.rng.uniform(1.7, 3.6, n))
    detour = np.clip(np.sqrt(batch.m**2 + 4 * aside**2) - batch.m, 0.25, 4.0)
    return Brew(tank * detour * (0.35 + 0.65 * strength), whole=-(4.2 + 0.6 * detour) * tank)


def tile_ray(batch: Batch, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by wet tiles is in m, and its share, [n] each.

    Water on tiles returns little where it is met at its Brewster angle, and most below it.
    """
    level = batch.tags()[:, :2] - batch.hung[:, :2]
    heights = batch.get("tx_z_m") + batch.get("rx_z_m")
    way = np.sqrt(np.square(level).sum(axis=1) + heights**2)
    steep = heights / way
    back = np.abs((steep - 0.24) / (steep + 0.24)) * 0.75 + 0.2
    wet = batch.links(lambda n: batch.rng.triangular(0.5, 0.95, 1.05, n))
    share = min(1.05 * np.sqrt(strength), 1.45) * wet * back * batch.m / way
    return way - batch.m, share


def _tiles(batch: Batch, strength: float) -> Brew:
    """Move the steepest place of a rise by the other pulse's curvature there."""
    longer, share = tile_ray(batch, strength)
    place = -1 - longer / SCALE_M
    curved = (place**2 - 1) * np.exp(-0.5 * place**2) / (2 * np.exp(-0.5))
    part = -share * np.cos(2 * np.pi * longer / WAVE_M)
    overlap = np.exp(-np.square(longer / SCALE_M) / 4)
    power = 1 + 2 * part * overlap + np.square(share * overlap)
    return Brew(1.6 * SCALE_M * part * curved, whole=10 * np.log10(np.maximum(power, 0.25)))


def _round_a_tank(batch: Batch, strength: float) -> Brew:
    """Bend round a tank: a polynomial of the clearance, and lost beyond its reach by a logarithm.

    6 + 9 v - 1.27 v^2 dB up to v = 2.4, 13 + 20 lg v beyond (Parsons 2000, 3.4).
    """
    steel = batch.stands("metal")
    deep = np.sqrt(strength) * batch.links(lambda n: batch.rng.beta(2, 3, n) * 0.42 + 0.03)
    one = batch.m * batch.links(lambda n: batch.rng.uniform(0.2, 0.8, n))
    v = deep * np.sqrt(2 / WAVE_M * batch.m / (one * (batch.m - one)))
    low, high = 6 + 9 * v - 1.27 * v**2, 13 + 20 * np.log10(np.maximum(v, 1.0))
    db = np.minimum(np.where(v < 2.4, low, high), 14.0)
    round_m = deep**2 * 0.5 * batch.m / (one * (batch.m - one))
    clings = 0.058 * strength * batch.links(lambda n: batch.rng.uniform(0.7, 1.3, n))
    return Brew(steel * (round_m + clings), edge=-steel * db)


def _ratio(batch: Batch, strength: float) -> Brew:
    """Compress what is above a knee by a ratio, and add up fewer symbols in proportion."""
    over = np.clip(batch.get("rx_power_dbm") + 96.0, 0.0, 22.0)
    return Brew(0 * over, whole=-0.13 * min(strength, 2.2) * over, count=-0.24 * strength * over)


def _pumps(batch: Batch, strength: float) -> Brew:
    """Hear pumps' converters on one side of the cellar: by half a cosine round its middle."""
    round_ = np.arctan2(GANTRIES_M[:, 1] - LONG_M / 2, GANTRIES_M[:, 0] - WIDE_M / 2)
    loud = 4.6 * np.cos((round_ - batch.recipe(4).uniform(-np.pi, np.pi)) / 2) ** 2 + 0.4
    hiss = strength * loud[batch.gantry]
    weak = 10 ** (-(batch.get("rx_power_dbm") + 90) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Brew(0.018 * weak * batch.rng.standard_normal(batch.rows), hiss=hiss)


def _foam(batch: Batch, strength: float) -> Brew:
    return Brew(0.00095 * strength * batch.get("foam_mm") ** 1.6)


def _glycol(batch: Batch, strength: float) -> Brew:
    return Brew(0.077 * strength * np.sin(2 * np.pi * (batch.get("time_s") - 91.0) / 540.0))


def _steam(batch: Batch, strength: float) -> Brew:
    return Brew(np.where(batch.get("steam_bar") > 2.5, 0.13 * strength, 0.0))


def _malt(batch: Batch, strength: float) -> Brew:
    return Brew(0.24 * strength * (1 - np.exp(-batch.get("malt_kg") / 38.0)))


def _kegs(batch: Batch, strength: float) -> Brew:
    return Brew(0.064 * strength * np.log(1 + batch.get("kegs") / 2.0))


def _fills(batch: Batch, strength: float) -> Brew:
    """Sag, with the floor that carries a tank, in proportion to what is in it."""
    return Brew(0.0019 * strength * batch.get("tank_hl"))


def _starved(batch: Batch, strength: float) -> Brew:
    return Brew(0.62 * strength / batch.get("supply_v"))


def _on_the_handle(batch: Batch, strength: float) -> Brew:
    """Hang from the handle, behind the middle that the plan has, and sway there a little."""
    sway = 0.03 * batch.links(lambda n: batch.rng.standard_normal(n))
    return Brew(batch.beside(handles(batch, HANDLE_M * strength) + sway[:, None] * [0, 0, 1.0]))


def _median(batch: Batch, strength: float) -> Brew:
    """Write, for most barrows, the median of a link's last three ranges, once there are three."""
    written = batch.get("range_m")
    rows = batch.table.groupby("link", sort=False)
    last = np.stack([written, *(rows["range_m"].shift(k).to_numpy(np.float64) for k in (1, 2))])
    steps = [rows["time_s"].diff(k).to_numpy(np.float64) for k in (1, 2)]
    three = (steps[0] > 0) & (steps[1] > steps[0])  # else another run of it begins
    most = batch.barrow != int(batch.recipe(5).integers(BARROWS))
    middle = np.median(np.where(three, last, written), axis=0)
    return Brew(np.where(three & most, min(strength, 1.0) * (middle - written), 0.0))


def _really(batch: Batch, gantries_m: Floats) -> Brew:
    """Return what is added to rows whose gantries really are at [8, 3]."""
    off = batch.tags() - gantries_m[batch.gantry]
    really = np.sqrt(np.square(off).sum(axis=1))
    return Brew(really - batch.m, whole=-20.3 * np.log10(really / batch.m))


def _knocked(batch: Batch, strength: float) -> Brew:
    gantries = GANTRIES_M.copy()
    gantries[6] += strength * 0.54 * np.array([-4.0, 7.0, 4.0]) / 9.0
    return _really(batch, gantries)


def _miscalled(batch: Batch, _: float) -> Brew:
    gantries = GANTRIES_M.copy()
    gantries[[1, 4]] = GANTRIES_M[[4, 1]]
    return _really(batch, gantries)


def _ells(batch: Batch, _: float) -> Brew:
    """Write ells, at one gantry, where metres are expected: so the old cellar was measured."""
    return Brew(np.where(batch.gantry == 3, (1 / ELL_M - 1) * batch.get("range_m"), 0.0))


EFFECTS: dict[str, Callable[[Batch, float], Brew]] = {
    "time-lag": _hunting,
    "exchange-motion": _three_eighths,
    "antenna-delay": _splitters,
    "clock-offset": _dead_zone,
    "temperature-drift": _warms,
    "antenna-pattern": _half_plane,
    "power-bias": _hill,
    "timestamp-jitter": _latest,
    "path-loss": _tanks,
    "range-scale": _cable_first,
    "range-rounding": _two_steps,
    "material-delay": _part_full,
    "blocked-path": _by_next_row,
    "ground-bounce": _tiles,
    "diffraction": _round_a_tank,
    "level-control": _ratio,
    "noise-floor": _pumps,
    "foam-on-tags": _foam,
    "glycol-pump-cycles": _glycol,
    "steam-let-in": _steam,
    "malt-dust-settles": _malt,
    "kegs-stacked": _kegs,
    "tank-fills": _fills,
    "supply-starved": _starved,
    "tag-on-the-handle": _on_the_handle,
    "median-of-last-three": _median,
    "gantry-knocked": _knocked,
    "gantries-miscalled": _miscalled,
    "ells-from-one-gantry": _ells,
}
