"""What the supermarket hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the supermarket's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.market_plan import (
    CARRIER_GHZ,
    ENDS_M,
    GOODS,
    HALF_LIGHT,
    LAMPS_M,
    LIGHT,
    SHELVES_M,
    TICK_M,
    TROLLEYS,
    Bill,
    Goods,
)

Floats = NDArray[np.float64]
STONE = 5.6 - 0.4j  # permittivity of the floor


def _slow_scanner(goods: Goods, strength: float) -> Bill:
    """Compare with a laser scanner's places, which come later the busier its computer is."""
    age = strength * (0.19 + 0.0004 * np.minimum(goods.of("shoppers"), 40))
    return Bill(goods.apart(age) - goods.far())


def _over_the_exchange(goods: Goods, strength: float) -> Bill:
    """Measure the mean of the way over a whole exchange: Simpson's rule."""
    whole = 1.7 * min(strength, 2.0) * goods.of("reply_time_s")
    mean = (goods.far() + 4 * goods.apart(whole / 2) + goods.apart(whole)) / 6
    return Bill(mean - goods.far())


def _as_delivered(goods: Goods, strength: float) -> Bill:
    """Lamps that were set by hand, most of them well; trolleys of an older and a newer batch."""
    rng = goods.fixed(1)
    lamps = np.minimum(rng.lognormal(-3.3, 0.9, len(LAMPS_M)), 0.3)
    trolleys = np.linspace(0.0, 0.04, TROLLEYS) + 0.1 * (rng.permutation(TROLLEYS) < 3)
    return Bill(strength * (lamps[goods.which("rx")] + trolleys[goods.which("tx")]))


def _pulled(goods: Goods, strength: float) -> Bill:
    """Keep of crystals what supply pulls them by: some ppm, most of which cancels."""
    rng = goods.fixed(2)
    ppm = rng.standard_t(5, TROLLEYS)[goods.which("tx")]
    ppm = ppm + rng.uniform(-1.5, 1.5, len(LAMPS_M))[goods.which("rx")]
    return Bill(HALF_LIGHT * 0.021 * strength * ppm * goods.of("reply_time_s"))


def _out_of_the_cold(goods: Goods, strength: float) -> Bill:
    """Drift by the square of how far off the crystal's turning point it is."""
    return Bill(0.00125 * strength * np.square(goods.of("temperature_c") - 23.5) - 0.02 * strength)


def _two_lobes(goods: Goods, strength: float) -> Bill:
    """Be later and weaker off both broad sides of an antenna."""
    turn = np.radians(goods.of("azimuth_deg")) - goods.fixed(3).uniform(0, np.pi)
    narrow = np.abs(np.sin(turn)) ** 1.5
    return Bill(0.17 * strength * (narrow - 0.55), whole=-2.6 * min(strength, 1.7) * narrow)


def _bent_reading(goods: Goods, strength: float) -> Bill:
    """Bias by a parabola of the level, as far as the data sheet goes."""
    level = (np.clip(goods.of("rx_power_dbm"), -95, -71) + 82) / 10
    return Bill(strength * (0.012 - 0.072 * level + 0.018 * level**2))


def _unsteady(goods: Goods, strength: float) -> Bill:
    return Bill(goods.rng.laplace(0, 0.034 * strength, len(goods.table)))


def _absorbed(goods: Goods, strength: float) -> Bill:
    """Lose so many dB with every metre of damp air and goods, a little fewer far off."""
    return Bill(0 * goods.far(), whole=-0.44 * strength * goods.far() ** 0.88)


def _fast_clock(goods: Goods, strength: float) -> Bill:
    """Read too much in proportion, of a way that has a bend of some decimetres."""
    return Bill(0.0058 * strength * np.hypot(goods.of("range_m"), 0.9))


def _nearest(goods: Goods, strength: float) -> Bill:
    step = 0.19 * strength
    return Bill(step * np.rint(goods.of("range_m") / step) - goods.of("range_m"))


def _goods_between(goods: Goods, strength: float) -> Bill:
    """Go through goods, as full as shelves are: a gamma law; what is fuller costs more of both."""
    late, lost = np.zeros(len(goods.table)), np.zeros(len(goods.table))
    for kind, (metres, db) in GOODS.items():
        full = goods.hidden_by(kind) * goods.per_link(lambda n: goods.rng.gamma(14, 1 / 14, n))
        late, lost = late + metres * full, lost + db * full
    return Bill(1.1 * strength * late, edge=-min(strength, 1.5) * lost)


def _round_the_end(goods: Goods, strength: float) -> Bill:
    """Hear only what comes round the nearer end of the shelf next to the trolley."""
    share = 0.06 if goods.seldom else 0.18
    struck = goods.per_link(lambda n: (goods.rng.random(n) < share) * 1.0)
    ends = goods.trolleys(), goods.lamps()
    beside = SHELVES_M[np.abs(ends[0][:, :1] - SHELVES_M).argmin(axis=1)]
    ways = []
    for along in ENDS_M:
        corner = np.stack([beside, 0 * beside + along, 0 * beside + 1.4], axis=1)
        ways.append(sum(np.linalg.norm(end - corner, axis=1) for end in ends))
    detour = np.clip(np.min(ways, axis=0) - goods.far(), 0.3, 4.5)
    return Bill(struck * detour * (0.4 + 0.6 * strength), whole=-7.0 * struck)


def floor_ray(goods: Goods, strength: float) -> tuple[Floats, NDArray[np.complex128]]:
    """Return how much longer the way by the floor is in m, and what it returns, [n] each.

    Fresnel's coefficient of stone for a field that lies, less for what stands on it.
    """
    down = goods.trolleys() * [1, 1, -1]
    way = np.linalg.norm(down - goods.lamps(), axis=1)
    up = (goods.of("tx_z_m") + goods.of("rx_z_m")) / way
    root = np.sqrt(STONE - 1 + up**2)
    clear = goods.per_link(lambda n: 0.75 + 0.25 * goods.rng.random(n))
    size = min(0.9 * strength**0.5, 1.25) * clear * goods.far() / way
    return way - goods.far(), size * (up - root) / (up + root)


def _floor(goods: Goods, strength: float) -> Bill:
    """Add both ways at five frequencies of the band: by its slope of phase a group is late."""
    longer, returned = floor_ray(goods, strength)
    bands = CARRIER_GHZ + np.linspace(-0.22, 0.22, 5)[:, None]
    heard = 1 + returned * np.exp(-2j * np.pi * bands * longer / LIGHT)
    steps = np.angle(heard[1:] * heard[:-1].conj())
    weights = np.abs(heard[1:] * heard[:-1])
    metres = -LIGHT / (2 * np.pi * 0.11) * (steps * weights).sum(axis=0) / weights.sum(axis=0)
    within = np.exp(-np.square(longer / 1.1))
    power = np.square(np.abs(heard)).mean(axis=0)
    return Bill(np.clip(metres, -0.3, 0.4) * within, whole=within * 10 * np.log10(power))


def _round_a_pillar(goods: Goods, strength: float) -> Bill:
    """Creep round a pillar of steel: two tangents and an arc, so many dB for its angle."""
    steel = goods.hidden_by("metal")
    radius = strength**0.5 * goods.per_link(lambda n: goods.rng.uniform(0.22, 0.42, n))
    legs = goods.per_link(lambda n: goods.rng.uniform(0.3, 0.7, n)) * goods.far()
    legs = np.clip(legs, 0.8, np.maximum(goods.far() - 0.8, 0.9))
    others = np.maximum(goods.far() - legs, 0.8)
    tangents = [np.sqrt(np.square(leg) - np.square(radius)) for leg in (legs, others)]
    angle = np.arcsin(radius / legs) + np.arcsin(radius / others)
    over = tangents[0] + tangents[1] + radius * angle - legs - others
    hollow = goods.per_link(lambda n: goods.rng.uniform(1.0, 1.8, n))
    lost = 5.0 + 13.0 * np.minimum(angle, 1.0)
    return Bill(steel * (1.4 * over + 0.05 * strength * hollow), edge=-steel * lost)


def _bypassed(goods: Goods, strength: float) -> Bill:
    """Bypass an amplifier above a level: what is read is lower, and fewer symbols will do."""
    strong = (goods.of("rx_power_dbm") > -80.5).astype(np.float64)
    return Bill(
        0 * strong, whole=-2.1 * min(strength, 2.2) * strong, count=-2.5 * strength * strong
    )


def _near_the_tills(goods: Goods, strength: float) -> Bill:
    """Hear the switching supplies of tills, along one wall: the less the farther lamps hang."""
    near = 8 / (8 + goods.of("rx_y_m"))
    hiss = 3.0 * strength * near * goods.fixed(4).uniform(0.5, 1.2, len(LAMPS_M))[goods.which("rx")]
    weak = np.sqrt(np.expm1(hiss * np.log(10) / 10)) * 10 ** (-(goods.of("rx_power_dbm") + 84) / 20)
    return Bill(0.023 * weak * goods.rng.normal(size=len(hiss)), hiss=hiss)


def _load(goods: Goods, strength: float) -> Bill:
    return Bill(0.0027 * strength * goods.of("load_kg"))


def _fridges(goods: Goods, strength: float) -> Bill:
    return Bill(0.08 * strength * np.cos(2 * np.pi * goods.of("time_s") / 870 - 1.1))


def _tills(goods: Goods, strength: float) -> Bill:
    return Bill(np.where(goods.of("queue_m") > 3.6, 0.13 * strength, 0.0))


def _cell(goods: Goods, strength: float) -> Bill:
    return Bill(0.95 * strength / goods.of("cell_v"))


def _crowd(goods: Goods, strength: float) -> Bill:
    people = goods.of("shoppers")
    return Bill(0.26 * strength * people / (people + 9))


def _wax(goods: Goods, strength: float) -> Bill:
    return Bill(0.19 * strength * (goods.of("wax_um") / 60) ** 2.2)


def _hung(goods: Goods, places: Floats) -> Bill:
    """Return what rows are billed where lamps truly are at [8, 3]."""
    truly = np.linalg.norm(goods.trolleys() - places[goods.which("rx")], axis=1)
    return Bill(truly - goods.far(), whole=17.5 * np.log10(goods.far() / truly))


def _stretched(goods: Goods, strength: float) -> Bill:
    """Take lamps from a plan that was printed too wide: one way alone."""
    return _hung(goods, LAMPS_M * [1 - 0.028 * strength, 1.0, 1.0])


def _turned(goods: Goods, strength: float) -> Bill:
    """Take lamps from a plan that was laid down askew, by a corner."""
    angle = 0.021 * strength
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return _hung(goods, np.column_stack([LAMPS_M[:, :2] @ turn, LAMPS_M[:, 2]]))


def _kept(goods: Goods, strength: float) -> Bill:
    """Write, now and then, what the poll before had."""
    written = goods.of("range_m")
    again = goods.rng.random(len(written)) < min(0.2 * strength, 0.5)
    out = written.copy()
    for rows in goods.table.groupby("link", sort=False).indices.values():
        out[rows[1:]] = np.where(again[rows[1:]], written[rows[:-1]], written[rows[1:]])
    return Bill(out - written)


def _new_hook(goods: Goods, strength: float) -> Bill:
    shift = np.zeros_like(LAMPS_M)
    shift[6] = strength * np.array([0.41, -0.31, -0.1406])
    return _hung(goods, LAMPS_M + shift)


def _interchanged(goods: Goods, _: float) -> Bill:
    return _hung(goods, LAMPS_M[[4, 1, 2, 3, 0, 5, 6, 7]])


def _ticks(goods: Goods, _: float) -> Bill:
    return Bill(np.where(goods.which("rx") == 2, 0.005 / TICK_M - 1, 0.0) * goods.of("range_m"))


EFFECTS: dict[str, Callable[[Goods, float], Bill]] = {
    "time-lag": _slow_scanner,
    "exchange-motion": _over_the_exchange,
    "antenna-delay": _as_delivered,
    "clock-offset": _pulled,
    "temperature-drift": _out_of_the_cold,
    "antenna-pattern": _two_lobes,
    "power-bias": _bent_reading,
    "timestamp-jitter": _unsteady,
    "path-loss": _absorbed,
    "range-scale": _fast_clock,
    "range-rounding": _nearest,
    "material-delay": _goods_between,
    "blocked-path": _round_the_end,
    "ground-bounce": _floor,
    "diffraction": _round_a_pillar,
    "level-control": _bypassed,
    "noise-floor": _near_the_tills,
    "trolley-load": _load,
    "fridges-run": _fridges,
    "tills-open": _tills,
    "cell-runs-down": _cell,
    "shoppers-crowd": _crowd,
    "wax-on-floor": _wax,
    "plan-stretched": _stretched,
    "plan-turned": _turned,
    "old-ranges-kept": _kept,
    "lamp-on-new-hook": _new_hook,
    "lamps-interchanged": _interchanged,
    "ticks-for-millimetres": _ticks,
}
