"""What the vineyard hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the vineyard's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.vineyard_slope import (
    BASKETS,
    CRATES,
    DEVICES,
    FENCE_X_M,
    GHZ,
    M_PER_PPM_S,
    PIED_M,
    SLOPE_RAD,
    STAKES,
    STAKES_M,
    STAY_M,
    TOPPED_S,
    TRACTORS,
    WAVE_M,
    Blight,
    Harvest,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
TAGS = TRACTORS + BASKETS
GRASS_M = 0.011  # how uneven mown grass is
SOIL = (6.5, 0.16)  # permittivity and how much more for each percent of the humidity above 50
HIDDEN = {False: 0.16, True: 0.05}  # of links behind tractors at work, and where these are rare


def _old_fixes(harvest: Harvest, strength: float) -> Blight:
    """Compare with satellites' fixes, each tag's of another age, tractors' extrapolated better."""
    age_s = np.r_[harvest.same(1).uniform(0.08, 0.1, TRACTORS), np.full(BASKETS, 0.105)]
    return Blight(harvest.onward(strength * age_s[harvest.calls - STAKES]))


def _simpson(harvest: Harvest, strength: float) -> Blight:
    """Give the mean of ways over an exchange, half of which its last message adds: Simpson's."""
    wait_s = 1.3 * min(strength, 2.0) * harvest.of("reply_time_s")
    return Blight((4 * harvest.onward(wait_s / 2) + harvest.onward(wait_s)) / 6)


def _joints(harvest: Harvest, strength: float) -> Blight:
    """Be late by every joint of stakes' cables, which rodents gnaw, and by how tags were sealed."""
    joints = 0.036 * harvest.same(2).binomial(4, 0.4, STAKES)
    sealed = 0.05 * harvest.same(3).weibull(2.2, TAGS)
    own = np.r_[joints, sealed]
    return Blight(strength * (own[harvest.hears] + own[harvest.calls]))


def _cut_angles(harvest: Harvest, strength: float) -> Blight:
    """Leave some of crystals' offset, which goes by the cubic of quartz that is cut AT."""
    rng = harvest.same(4)
    at_rest, tilt, cubic = rng.normal(0.0, ((0.6,), (0.35,), (0.12,)), (3, DEVICES))
    warm = (harvest.of("temperature_c") - 15.0) / 9.0
    first, other = (
        at_rest[k] + tilt[k] * warm + cubic[k] * warm**3 for k in (harvest.hears, harvest.calls)
    )
    part = 0.017 * strength * M_PER_PPM_S * harvest.of("reply_time_s")
    return Blight(part * (first - other))


def _warms(harvest: Harvest, strength: float) -> Blight:
    """Drift by an exponential of warmth, as what leaks in semiconductors does."""
    return Blight(0.031 * strength * np.expm1((harvest.of("temperature_c") - 11.0) / 15.0))


def _lobe(harvest: Harvest, strength: float) -> Blight:
    """Be late and weak through who carries or drives: a lobe of von Mises' shape behind."""
    beside = np.radians(harvest.of("azimuth_deg")) - harvest.same(5).uniform(0, 2 * np.pi)
    lobe = np.exp(1.8 * (np.cos(beside) - 1))
    return Blight(strength * (0.13 * lobe - 0.03), whole=-2.9 * min(strength, 1.6) * lobe)


def _root_curve(harvest: Harvest, strength: float) -> Blight:
    """Be late where it is weak: by a sigmoid that is algebraic."""
    weak = (-83.0 - harvest.of("rx_power_dbm")) / 6.5
    return Blight(0.083 * strength * weak / np.sqrt(1 + weak**2))


def _verniers(harvest: Harvest, strength: float) -> Blight:
    """Tremble by two counters that are not in step: two even errors, whose sum is a triangle's."""
    size = len(harvest.table)
    return Blight(harvest.rng.triangular(-0.125, 0.0, 0.125, size) * strength)


def _weissberger(harvest: Harvest, strength: float) -> Blight:
    """Lose what Weissberger's model has leaves take (1982), which fill three tenths of all ways."""
    deep = 0.3 * harvest.metres
    db = GHZ**0.284 * np.where(deep < 14.0, 0.45 * deep, 1.33 * np.maximum(deep, 1.0) ** 0.588)
    return Blight(0 * db, whole=-0.62 * strength * db)


def _past_the_bench(harvest: Harvest, strength: float) -> Blight:
    """Count all ways right that the works' bench has, and too long what is beyond."""
    return Blight(0.0048 * strength * np.maximum(harvest.of("range_m") - 4.0, 0.0))


def _cut_down(harvest: Harvest, strength: float) -> Blight:
    """Count whole ticks alone, cut down, and show their middles."""
    tick, raw = 0.14 * strength, harvest.of("range_m")
    return Blight(tick * (np.floor(raw / tick) + 0.5) - raw)


def _layers(harvest: Harvest, strength: float) -> Blight:
    """Go through one to four layers of crates, or of walls, as links have them."""
    late, lost = np.zeros((2, len(harvest.metres)))
    for kind, (thick_m, dense, db) in CRATES.items():
        layers = harvest.by_link(lambda n: 1 + harvest.rng.binomial(3, 0.35, n))
        met = layers * harvest.stands(kind)
        late, lost = late + met * thick_m * (np.sqrt(dense) - 1), lost + met * db
    return Blight(
        1.05 * strength * late.clip(max=0.3), first=-min(strength, 1.5) * lost.clip(max=9.0)
    )


def stake_ways(harvest: Harvest) -> Floats:
    """Return how much longer ways by each stake are, in m [n, STAKES]: inf by who hears."""
    ends = (harvest.at("tx"), harvest.at("rx"))
    legs = sum(np.linalg.norm(end[:, None] - STAKES_M, axis=2) for end in ends)
    longer = np.asarray(legs) - harvest.metres[:, None]
    return np.where(harvest.hears[:, None] == np.arange(STAKES), np.inf, longer)


def _by_a_stake(harvest: Harvest, strength: float) -> Blight:
    """Hear, behind tractors at work, nothing but what another stake of steel scatters."""
    behind = harvest.chosen(HIDDEN[harvest.seldom])
    detour = 0.34 + 3.8 * np.tanh(stake_ways(harvest).min(axis=1) / 3.8)  # else by what is nearer
    return Blight(behind * detour * (0.4 + 0.6 * strength), whole=-5.0 * behind)


def grass_ray(harvest: Harvest, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ground is in m, and its complex share, [n] each.

    Fresnel's coefficient of upright waves on soil without loss, less what grass scatters.
    """
    heights = harvest.at("tx")[:, 2] + harvest.at("rx")[:, 2]
    rise = harvest.at("tx")[:, 2] - harvest.at("rx")[:, 2]
    way = np.sqrt(harvest.metres**2 - rise**2 + heights**2)
    steep = heights / way
    dense = SOIL[0] + SOIL[1] * np.maximum(harvest.of("humidity_percent") - 50.0, 0.0)
    inner = np.sqrt(dense - (1 - steep**2))
    returned = (dense * steep - inner) / (dense * steep + inner)
    even = np.exp(-2 * (2 * np.pi * GRASS_M * steep / WAVE_M) ** 2)
    turn = np.exp(-2j * np.pi * ((way - harvest.metres) / WAVE_M % 1.0))
    size = min(1.15 * strength**0.5, 1.7) * returned * even * harvest.metres / way
    return way - harvest.metres, size * turn


def _grass(harvest: Harvest, strength: float) -> Blight:
    """Be where the middle of both rays' energy is, as far as their pulses overlap."""
    longer, share = grass_ray(harvest, strength)
    part = share * np.exp(-np.square(longer / 0.9))
    both = np.maximum(np.abs(1 + part) ** 2, 0.16)
    middle = longer * (np.real(part) + np.abs(part) ** 2) / both
    return Blight(np.clip(middle, -0.25, 0.25), whole=10 * np.log10(both))


def lee_db(v: Floats) -> Floats:
    """Return what an edge takes in dB by Lee's fit (1985), for v >= 0 [n]."""
    near = 0.5 * np.exp(-0.95 * v)
    mid = 0.4 - np.sqrt(np.maximum(0.1184 - (0.38 - 0.1 * v) ** 2, 0.0))
    return np.asarray(
        -20 * np.log10(np.where(v < 1, near, np.where(v < 2.4, mid, 0.225 / np.maximum(v, 1))))
    )


def _over_trailers(harvest: Harvest, strength: float) -> Blight:
    """Bend over a trailer's edge of steel, and creep along what is heaped on it."""
    steel = harvest.stands("metal")
    near = harvest.metres * harvest.by_link(
        lambda n: harvest.rng.beta(2.0, 2.0, n).clip(0.12, 0.88)
    )
    far = harvest.metres - near
    high = strength**0.5 * harvest.by_link(lambda n: 0.15 + 0.4 * harvest.rng.beta(1.5, 2.5, n))
    over = np.hypot(near, high) + np.hypot(far, high) - harvest.metres
    db = lee_db(high * np.sqrt(2 / WAVE_M * (1 / near + 1 / far))).clip(max=9.0)
    creeps = 0.06 * strength * harvest.by_link(lambda n: harvest.rng.uniform(0.6, 1.4, n))
    return Blight(steel * (over.clip(max=0.3) + creeps), first=-steel * db)


def _soft_knee(harvest: Harvest, strength: float) -> Blight:
    """Turn gain down past a soft knee, and end a sum the sooner: by a logarithm of both."""
    over = np.logaddexp(0.0, (harvest.of("rx_power_dbm") + 93.0) / 3.0)
    return Blight(0 * over, whole=-0.55 * min(strength, 2.2) * over, fewer=-1.05 * strength * over)


def _boar_fence(harvest: Harvest, strength: float) -> Blight:
    """Hear a fence against boars tick: some rows, and the more the nearer to it they are heard."""
    away = harvest.at("rx")[:, 0] - FENCE_X_M
    ticks = harvest.rng.random(len(away)) < 0.4
    own = harvest.same(6).uniform(0.6, 1.4, DEVICES)[harvest.hears]
    hiss = strength * own * (1.1 + 4.2 * ticks * np.exp(-away / 30.0))
    weak = 10 ** (-(harvest.of("rx_power_dbm") + 90.0) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Blight(0.019 * weak * harvest.rng.standard_normal(len(away)), hiss=hiss)


def _must(harvest: Harvest, strength: float) -> Blight:
    """Coat lids of tags with must, which holds water until there is no more room for it."""
    return Blight(0.15 * strength * -np.expm1(-harvest.of("must_g") / 5.0))


def _wilts(harvest: Harvest, strength: float) -> Blight:
    """Read shorter through leaves that hold less water."""
    return Blight(-0.0105 * strength * harvest.of("leaf_bar"))


def _stays(harvest: Harvest, strength: float) -> Blight:
    """Read long beside stays of iron, and short between them."""
    turn = 2 * np.pi * harvest.of("row_m") / STAY_M
    return Blight(0.061 * strength * np.cos(turn - 0.7))


def _hail_net(harvest: Harvest, strength: float) -> Blight:
    """Read long below a hail net that dew has wetted."""
    return Blight(np.where(harvest.of("humidity_percent") > 86.0, 0.105 * strength, 0.0))


def _heaped(harvest: Harvest, strength: float) -> Blight:
    """Go through what is heaped before tags: more than in step with its weight."""
    return Blight(0.145 * strength * (harvest.of("grapes_kg") / 26.0) ** 1.8)


def _sulphur(harvest: Harvest, strength: float) -> Blight:
    return Blight(0.066 * strength * np.log1p(harvest.of("sulphur_g") / 1.3))


def _moist(harvest: Harvest, strength: float) -> Blight:
    """Load stakes by moist soil, which sucks the less the more water it holds."""
    return Blight(3.1 * strength / harvest.of("soil_kpa"))


def _plumb(harvest: Harvest, strength: float) -> Blight:
    """Hang plumb on the slope, where the survey has tags' rods stand square to it."""
    lean, off = strength * SLOPE_RAD, []
    for end, device in (("tx", harvest.calls), ("rx", harvest.hears)):
        rod = np.where(device >= STAKES, harvest.at(end)[:, 2], 0.0)
        off.append(rod[:, None] * np.array([0.0, np.sin(lean), np.cos(lean) - 1]))
    return Blight(harvest.moved(*off))


def _slips(harvest: Harvest, strength: float) -> Blight:
    """Be farther down than wheels were counted: they spin on the way up and skid on that down."""
    off = []
    for end, device in (("tx", harvest.calls), ("rx", harvest.hears)):
        drives = (device >= STAKES) & (device < STAKES + TRACTORS)
        slid = np.where(drives, 0.085 * strength * np.abs(harvest.went(end)[:, 1]), 0.0)
        off.append(slid[:, None] * np.array([0.0, -1.0, 0.0]))
    return Blight(harvest.moved(*off))


def _topped(harvest: Harvest, strength: float) -> Blight:
    """Go, until shoots are topped, through more of them in every row of vines below the tops."""
    before = harvest.of("time_s") < TOPPED_S
    late = before * 0.08 * harvest.leaves.clip(max=4.0)
    return Blight(strength * late, whole=-9.0 * min(strength, 1.5) * late)


def _truly_at(harvest: Harvest, stakes_m: Floats) -> Blight:
    """Return what befalls rows whose stakes have their antennas elsewhere in truth [STAKES, 3]."""
    heard = harvest.hears < STAKES
    off = np.where(heard[:, None], (stakes_m - STAKES_M)[harvest.hears % STAKES], 0.0)
    longer = np.where(heard, harvest.moved(0 * off, off), 0.0)
    return Blight(longer, whole=-19.2 * np.log10(1 + longer / harvest.metres))


def _askew(harvest: Harvest, strength: float) -> Blight:
    """Stand where a trailer has pulled a stake to."""
    off = np.zeros((STAKES, 3))
    off[7] = 0.52 * strength * np.array([2.0, -6.0, -3.0]) / 7
    return _truly_at(harvest, STAKES_M + off)


def _backwards(harvest: Harvest, _: float) -> Blight:
    return _truly_at(harvest, STAKES_M[[0, 8, 2, 3, 4, 5, 6, 7, 1, 9]])


def _pieds(harvest: Harvest, _: float) -> Blight:
    """Show pieds, at one stake, as the estate's old map has them."""
    times = np.where(harvest.hears == 4, 1 / PIED_M, 1.0)
    return Blight((times - 1) * harvest.of("range_m"))


EFFECTS: dict[str, Callable[[Harvest, float], Blight]] = {
    "time-lag": _old_fixes,
    "exchange-motion": _simpson,
    "antenna-delay": _joints,
    "clock-offset": _cut_angles,
    "temperature-drift": _warms,
    "antenna-pattern": _lobe,
    "power-bias": _root_curve,
    "timestamp-jitter": _verniers,
    "path-loss": _weissberger,
    "range-scale": _past_the_bench,
    "range-rounding": _cut_down,
    "material-delay": _layers,
    "blocked-path": _by_a_stake,
    "ground-bounce": _grass,
    "diffraction": _over_trailers,
    "level-control": _soft_knee,
    "noise-floor": _boar_fence,
    "must-on-lids": _must,
    "leaves-wilt": _wilts,
    "trellis-stays-passed": _stays,
    "hail-net-wets": _hail_net,
    "baskets-heaped": _heaped,
    "sulphur-on-foils": _sulphur,
    "stakes-in-moist-soil": _moist,
    "rods-hang-plumb": _plumb,
    "wheels-slip-downhill": _slips,
    "shoots-topped": _topped,
    "stake-pulled-askew": _askew,
    "stakes-counted-backwards": _backwards,
    "pieds-from-one-stake": _pieds,
}
