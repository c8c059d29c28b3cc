"""What the glasshouse hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the glasshouse's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.glasshouse_house import (
    CABLE,
    CARRIER_GHZ,
    CARRIER_M,
    GUTTERS_M,
    HOUSE_M,
    LIGHT,
    PARTS,
    PPM_M,
    TROLLEYS,
    Crop,
    Growth,
)

Floats = NDArray[np.float64]
DAY_S = 9 * 3600.0


def _ticks_of_odometer(crop: Crop, strength: float) -> Growth:
    """Compare with an odometer that is read on ticks, and held until the next one."""
    return Growth(crop.grown(strength * (0.11 + np.mod(crop.of("time_s"), 0.09))))


def _during_reply(crop: Crop, strength: float) -> Growth:
    """Measure the mean of the way while a reply is waited for, by Simpson's rule."""
    wait = 1.8 * min(strength, 2.0) * crop.of("reply_time_s")
    return Growth((4 * crop.grown(wait / 2) + crop.grown(wait)) / 6)


def _chained(crop: Crop, strength: float) -> Growth:
    """Feed gutters by a chain of cables, each behind the last; tags are of two lots."""
    rng = crop.sown(1)
    chain = np.cumsum(rng.uniform(0.004, 0.055, len(GUTTERS_M)))
    lot = 0.07 * (rng.permutation(TROLLEYS) < 2) + 0.015 * rng.random(TROLLEYS)
    return Growth(strength * (chain[crop.device("rx")] + lot[crop.device("tx")]))


def _pulled(crop: Crop, strength: float) -> Growth:
    """Keep a tenth of the crystals' offset in a reply: what a first message tells of it is old."""
    rng = crop.sown(2)
    ppm = rng.triangular(-4, 0, 4, len(GUTTERS_M))[crop.device("rx")]
    ppm = ppm - rng.choice([-1.5, 1.5], TROLLEYS)[crop.device("tx")]
    return Growth(0.021 * strength * PPM_M * ppm * crop.of("reply_time_s"))


def _turnover(crop: Crop, strength: float) -> Growth:
    """Drift as a tuning fork does: by a parabola about the temperature at which it turns over."""
    return Growth(0.00062 * strength * (np.square(crop.of("temperature_c") - 16.0) - 90.0))


def _picker(crop: Crop, strength: float) -> Growth:
    """Be late and weak where the picker stands: a cardioid, to the third power."""
    turn = np.radians(crop.of("azimuth_deg")) - crop.sown(3).uniform(-np.pi, np.pi)
    shade = ((1 + np.cos(turn)) / 2) ** 3
    return Growth(0.15 * strength * (shade - 0.3), whole=-3.0 * min(strength, 1.5) * shade)


def _slicer(crop: Crop, strength: float) -> Growth:
    """Slice weak edges later: by x / sqrt(1 + x^2) of the level."""
    x = (-77.0 - crop.of("rx_power_dbm")) / 6.0
    return Growth(strength * (0.066 * x / np.sqrt(1 + x * x) + 0.008))


def _spread_clock(crop: Crop, strength: float) -> Growth:
    """Time with a clock whose spectrum is spread: by two steps, of which each row has its own."""
    steps = crop.rng.uniform(-1, 1, (2, crop.size)).sum(axis=0)
    return Growth(0.052 * strength * steps)


def _foliage(crop: Crop, strength: float) -> Growth:
    """Lose what leaves take: by Weissberger's power of the way (1982, ECAC-TR-81-101)."""
    return Growth(0 * crop.way_m, whole=-0.62 * strength * crop.way_m**0.588)


def _humid(crop: Crop, strength: float) -> Growth:
    """Divide by a speed of light that somebody took for dry air, and a little more."""
    return Growth(crop.of("range_m") * (1 / (1 - 0.0048 * min(strength, 100.0)) - 1))


def _cut(crop: Crop, strength: float) -> Growth:
    """Cut off what is less than a step."""
    step = 0.16 * strength
    return Growth(-np.mod(crop.of("range_m"), step))


def _partitions(crop: Crop, strength: float) -> Growth:
    """Go through slabs that stand along the rows: ways bend toward their normals."""
    slant = np.abs(crop.of("rx_y_m") - crop.of("tx_y_m")) / crop.way_m
    slant = np.minimum(slant, 0.8) ** 2
    late, lost = np.zeros(crop.size), np.zeros(crop.size)
    for kind, (thick, permittivity, db) in PARTS.items():
        sheets = crop.behind(kind) * crop.per_link(lambda n: crop.rng.triangular(0.7, 1, 1.3, n))
        late += sheets * thick * (np.sqrt(permittivity - slant) - np.sqrt(1 - slant))
        lost += sheets * db
    return Growth(1.6 * strength * late, edge=-lost * min(strength, 1.4))


def _by_the_roof(crop: Crop, strength: float) -> Growth:
    """Hear, behind tanks of water, nothing but what the panes of the roof return."""
    share = 0.05 if crop.thin else 0.16
    tank = crop.per_link(lambda n: np.where(crop.rng.random(n) < share, 1.0, 0.0))
    up = np.array([0.0, 0.0, 2.0 * HOUSE_M[2]])
    way = np.linalg.norm(crop.tags() * [1, 1, -1] + up - crop.hooks(), axis=1)
    ridge = crop.per_link(lambda n: crop.rng.gamma(2.0, 0.16, n))  # how much higher panes are
    detour = np.clip(way - crop.way_m + 2 * ridge, 0.25, 4.2)
    return Growth(tank * detour * (0.3 + 0.7 * strength), whole=-5.2 * tank)


def foil_ray(crop: Crop, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by foil on wet soil is in m, and its share, [n] each.

    Wet soil returns the more the flatter it is met; torn foil leaves some of it to some links.
    """
    mirrored = crop.tags() * [1, 1, -1] - crop.hooks()
    way = np.linalg.norm(mirrored, axis=1)
    steep = np.abs(mirrored[:, 2]) / way
    torn = crop.per_link(lambda n: crop.rng.triangular(0.5, 0.9, 1.0, n))
    share = min(0.85 * strength**0.5, 1.15) * torn * (1 - 0.5 * steep) * crop.way_m / way
    return way - crop.way_m, share


def _foil(crop: Crop, strength: float) -> Growth:
    """Shift an early and a late gate by what overlaps of two three-cornered pulses."""
    longer, share = foil_ray(crop, strength)
    overlap = np.maximum(1 - longer / 1.4, 0)
    part = -share * overlap * np.cos(2 * np.pi * longer / CARRIER_M)
    power = np.maximum(1 + 2 * part + np.square(share * overlap), 0.25)
    return Growth(np.clip(0.6 * longer * part / power, -0.3, 0.3), whole=10 * np.log10(power))


def _past_cabinets(crop: Crop, strength: float) -> Growth:
    """Bend past the edge of a cabinet: between a knife edge's limits, by a closed form.

    A quarter of the power at the edge, 1 / (2 pi^2 v^2) far in the shade; in between by a line.
    """
    steel = crop.behind("metal")
    deep = strength**0.5 * crop.per_link(lambda n: crop.rng.uniform(0.05, 0.3, n))
    one = crop.way_m * crop.per_link(lambda n: crop.rng.beta(3.0, 3.0, n).clip(0.12, 0.88))
    two = crop.way_m - one
    over = np.sqrt(one**2 + deep**2) + np.sqrt(two**2 + deep**2) - crop.way_m
    v = deep * np.sqrt(2 * crop.way_m / (CARRIER_M * one * two))
    db = 10 * np.log10(4 + 12 * v + 2 * (np.pi * v) ** 2)
    hinge = 0.05 * strength * crop.per_link(lambda n: crop.rng.uniform(0.75, 1.25, n))
    return Growth(steel * (over + hinge), edge=-steel * np.minimum(db, 13.0))


def _automatic(crop: Crop, strength: float) -> Growth:
    """Turn gain down softly above a level, and stop adding up symbols the sooner."""
    over = np.logaddexp(0, (crop.of("rx_power_dbm") + 84) / 2.5)
    return Growth(0 * over, whole=-0.42 * min(strength, 2.2) * over, count=-0.55 * strength * over)


def _lamp_drivers(crop: Crop, strength: float) -> Growth:
    """Hear the drivers of lamps, the more the higher a gutter hangs: weak rows scatter with it."""
    high = np.exp((GUTTERS_M[:, 2] - 4.0) / 0.9)
    high = high * crop.sown(4).uniform(0.75, 1.25, len(GUTTERS_M))
    hiss = 2.6 * strength * np.minimum(high, 2.2)[crop.device("rx")]
    weak = 10 ** (-(crop.of("rx_power_dbm") + 82) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Growth(0.021 * weak * crop.rng.normal(size=crop.size), hiss=hiss)


def _film(crop: Crop, strength: float) -> Growth:
    """Go through films of water on leaves, which join into sheets the more there are of them."""
    return Growth(0.22 * strength * (crop.of("leaf_wet_percent") / 100) ** 1.8)


def _screen(crop: Crop, strength: float) -> Growth:
    """Add what an aluminised screen returns, once it is drawn over the middle."""
    return Growth(np.where(crop.of("screen_percent") > 55.0, 0.12 * strength, 0.0))


def _fogging(crop: Crop, strength: float) -> Growth:
    return Growth(0.08 * strength * np.sin(2 * np.pi * crop.of("time_s") / 610.0 + 1.1))


def _fruit(crop: Crop, strength: float) -> Growth:
    return Growth(0.25 * strength * -np.expm1(-crop.of("fruit_kg") / 60.0))


def _pipes(crop: Crop, strength: float) -> Growth:
    """Warm cables along the pipes that heat the house, whose filling is denser cold."""
    return Growth(0.0031 * strength * (crop.of("pipe_c") - 10.0))


def _algae(crop: Crop, strength: float) -> Growth:
    return Growth(0.058 * strength * np.log(1 + crop.of("days_unwashed") / 3.0))


def _dimmed(crop: Crop, strength: float) -> Growth:
    """Switch lamps the longer off within a turn the dimmer they are: a supply sags between."""
    return Growth(5.2 * strength / crop.of("lamp_percent"))


def _canopy(crop: Crop, strength: float) -> Growth:
    """Cross a canopy that closes in the course of a day, below the height it has come to."""
    day = crop.of("time_s") / DAY_S
    tall = 1.1 + 1.2 * day
    below = np.clip((tall - crop.of("tx_z_m")) / (crop.of("rx_z_m") - crop.of("tx_z_m")), 0, 1)
    through = crop.rows_crossed() * below
    return Growth(0.07 * strength * through, whole=-0.5 * min(strength, 2.0) * through)


def _slips(crop: Crop, strength: float) -> Growth:
    """Trust an odometer whose wheel slips on wet pipes: off by the more the longer a run lasts."""
    begin = crop.table.groupby("link", sort=False)["time_s"].transform("min")
    gone = crop.of("time_s") - begin.to_numpy(np.float64)
    return Growth(crop.grown(-0.13 * strength * gone))


def _longer_of_two(crop: Crop, strength: float) -> Growth:
    """Keep, in gutters of one make, the longer of a range and the one before of the same link."""
    written = crop.of("range_m")
    make = np.isin(crop.device("rx"), crop.sown(5).permutation(len(GUTTERS_M))[:3])
    rows = crop.table.groupby("link", sort=False)
    before = rows["range_m"].shift(1).to_numpy(np.float64)
    follows = rows["time_s"].diff().to_numpy(np.float64) > 0  # else another run of it begins
    longer = np.maximum(before - written, 0.0)
    return Growth(np.where(follows & make, min(strength, 1.0) * longer, 0.0))


def _hung(crop: Crop, gutters: Floats) -> Growth:
    """Return what grows where gutters truly hang at [7, 3]."""
    truly = np.sqrt(np.square(crop.tags() - gutters[crop.device("rx")]).sum(axis=1))
    return Growth(truly - crop.way_m, whole=-20.4 * np.log10(truly / crop.way_m))


def _unhooked(crop: Crop, strength: float) -> Growth:
    off = np.zeros_like(GUTTERS_M)
    off[2] = np.array([0.31, 0.13, -0.314]) * strength
    return _hung(crop, GUTTERS_M + off)


def _transposed(crop: Crop, _: float) -> Growth:
    order = np.arange(len(GUTTERS_M))
    order[[1, 5]] = order[[5, 1]]
    return _hung(crop, GUTTERS_M[order])


def _cable_speed(crop: Crop, _: float) -> Growth:
    """Multiply, in one gutter, with the speed at which cables are traversed."""
    there = crop.device("rx") == 4
    return Growth((CABLE - 1) * there * crop.of("range_m"))


def turns(longer_m: Floats) -> NDArray[np.complex128]:
    """Return the phase of a way so much longer, which the ground has turned about [n]."""
    return np.asarray(-np.exp(-2j * np.pi * longer_m * CARRIER_GHZ / LIGHT))


EFFECTS: dict[str, Callable[[Crop, float], Growth]] = {
    "time-lag": _ticks_of_odometer,
    "exchange-motion": _during_reply,
    "antenna-delay": _chained,
    "clock-offset": _pulled,
    "temperature-drift": _turnover,
    "antenna-pattern": _picker,
    "power-bias": _slicer,
    "timestamp-jitter": _spread_clock,
    "path-loss": _foliage,
    "range-scale": _humid,
    "range-rounding": _cut,
    "material-delay": _partitions,
    "blocked-path": _by_the_roof,
    "ground-bounce": _foil,
    "diffraction": _past_cabinets,
    "level-control": _automatic,
    "noise-floor": _lamp_drivers,
    "leaf-film": _film,
    "screen-drawn": _screen,
    "fogging-turns": _fogging,
    "sap-in-fruit": _fruit,
    "pipes-heated": _pipes,
    "algae-on-panes": _algae,
    "lamps-dimmed": _dimmed,
    "canopy-closes": _canopy,
    "odometer-slips": _slips,
    "longer-of-two-kept": _longer_of_two,
    "gutter-unhooked": _unhooked,
    "gutters-transposed": _transposed,
    "speed-of-cable-in-one-gutter": _cable_speed,
}
