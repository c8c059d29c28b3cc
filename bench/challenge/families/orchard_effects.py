"""What the orchard hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the orchard's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.orchard_plot import (
    ANSWER_S,
    CARRIER_M,
    PICKERS,
    POSTS_M,
    QUARTER_LIGHT,
    STACKS,
    TANKS_M,
    YARD_M,
    Plot,
    Yield,
)

Floats = NDArray[np.float64]


def _two_receivers(plot: Plot, strength: float) -> Yield:
    """Compare with places of satellite receivers: one make is later than the other."""
    age = np.where(plot.picker % 2, 0.135, 0.16) * strength
    return Yield(plot.gap(plot.picker_at(age)) - plot.distance)


def _three_messages(plot: Plot, strength: float) -> Yield:
    """Measure a quarter of the way at the poll, a half at the answer, a quarter at the end."""
    reply = min(strength, 2.0) * plot("reply_time_s")
    middle = plot.gap(plot.picker_at(reply))
    final = plot.gap(plot.picker_at(reply + ANSWER_S))
    return Yield((plot.distance + 2 * middle + final) / 4 - plot.distance)


def _makes_of_boards(plot: Plot, strength: float) -> Yield:
    """Boards of three makes at the posts; pickers that differ as cables do."""
    rng = plot.lasting(1)
    post = rng.choice([0.01, 0.07, 0.16], len(POSTS_M)) + rng.uniform(-0.01, 0.01, len(POSTS_M))
    return Yield(strength * (post[plot.post] + 0.07 * rng.weibull(1.5, PICKERS)[plot.picker]))


def _two_sided(plot: Plot, strength: float) -> Yield:
    """Keep what a double-sided exchange leaves of crystals where replies are not alike."""
    rng = plot.lasting(2)
    ppm = rng.normal(0, 0.016, len(POSTS_M))[plot.post] - rng.gumbel(0, 0.009, PICKERS)[plot.picker]
    ppm = ppm * (1 + 0.012 * (plot("temperature_c") - 18))
    return Yield(QUARTER_LIGHT * strength * ppm * (plot("reply_time_s") - ANSWER_S))


def _slackens(plot: Plot, strength: float) -> Yield:
    """Drift by the root of how warm it is above freezing."""
    warm = np.sqrt(np.maximum(plot("temperature_c") + 4, 0) / 10)
    return Yield(0.115 * strength * (warm - 1.45))


def _ramps(plot: Plot, strength: float) -> Yield:
    """Be later and weaker in proportion to the angle from some direction."""
    off = plot("azimuth_deg") - plot.lasting(3).uniform(-180, 180)
    angle = np.abs(off - 360 * np.round(off / 360)) / 180
    return Yield(0.2 * strength * (angle - 0.5), whole=-2.8 * min(strength, 1.5) * angle)


def _calibrated(plot: Plot, strength: float) -> Yield:
    """Bias by four values of a data sheet, and lines between them."""
    level = plot("rx_power_dbm")
    bias = np.interp(level, [-97.0, -89.0, -83.0, -74.0], [0.055, 0.035, -0.02, -0.085])
    return Yield(strength * bias)


def _two_edges(plot: Plot, strength: float) -> Yield:
    """Catch either of two edges of a clock."""
    edge = plot.rng.choice([-1.0, 1.0], len(plot.distance))
    return Yield(strength * (0.042 * edge + 0.012 * plot.rng.normal(size=len(edge))))


def _more_leaves(plot: Plot, strength: float) -> Yield:
    """Lose more in leaves: at first so much a metre, and no more than a limit."""
    return Yield(0 * plot.distance, whole=8.5 * strength * np.expm1(-plot.distance / 26))


def _calibrated_near(plot: Plot, strength: float) -> Yield:
    """Be wrong in proportion, but right at the 4 m where it was calibrated."""
    return Yield(0.0046 * strength * (plot("range_m") - 4))


def _up(plot: Plot, strength: float) -> Yield:
    step = 0.17 * strength
    return Yield(step * np.ceil(plot("range_m") / step) - plot("range_m"))


def _stacks(plot: Plot, strength: float) -> Yield:
    """Go through stacks and sheds, more or less full; longer where they are met from above."""
    late, lost = np.zeros((2, len(plot.distance)))
    for kind, (metres, db) in STACKS.items():
        late, lost = late + metres * plot.behind(kind), lost + db * plot.behind(kind)
    full = plot.each_link(lambda n: 1.2 - 0.3 * plot.rng.power(2.0, n))
    steep = 1 / np.sqrt(1 - np.square(np.minimum(_drop(plot) / plot.distance, 0.8)))
    return Yield(strength * late * full * steep, edge=-min(strength, 1.5) * lost * full)


def _drop(plot: Plot) -> Floats:
    """Return how much lower pickers are than posts in m [n]."""
    return np.abs(plot("tx_z_m") - plot("rx_z_m"))


def _by_a_tank(plot: Plot, strength: float) -> Yield:
    """Hear only what the nearest tank of water returns: two legs."""
    share = 0.06 if plot.seldom else 0.16
    lost = plot.each_link(lambda n: 1.0 * (plot.rng.random(n) < share))
    ends = plot.picker_at(), POSTS_M[plot.post]
    legs = [sum(np.linalg.norm(end - tank, axis=1) for end in ends) for tank in TANKS_M]
    detour = np.minimum(np.min(legs, axis=0) - plot.distance, 5.5)
    return Yield(lost * detour * (0.35 + 0.65 * strength), whole=-6.0 * lost)


def soil_ray(plot: Plot, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the soil is in m, and what rough soil returns, [n]."""
    both = 4 * plot("tx_z_m") * plot("rx_z_m")
    longer = np.sqrt(plot.distance**2 + both) - plot.distance
    grazing = (plot("tx_z_m") + plot("rx_z_m")) / (plot.distance + longer)
    rough = np.exp(-2 * np.square(2 * np.pi / CARRIER_M * 0.012 * grazing))
    return longer, np.minimum(0.8 * strength, 0.93) * rough


def _soil(plot: Plot, strength: float) -> Yield:
    """Balance what an early gate and a late one take of a bell-shaped pulse and its ray."""
    longer, size = soil_ray(plot, strength)
    turn = -size * np.exp(-2j * np.pi * longer / CARRIER_M)
    early, late, middle = (
        np.square(np.abs(_bell(at) + turn * _bell(at - longer))) for at in (-0.22, 0.22, 0.0)
    )
    metres = 0.13 * (late - early) / np.maximum(late + early, 0.05)
    return Yield(metres, whole=5 * np.log10(np.maximum(early + late, 0.04) * 0.5 + 0.5 * middle))


def _bell(at_m: Floats | float) -> Floats:
    return np.exp(-np.square(np.asarray(at_m) / 0.38))


def _two_edges_of_a_trailer(plot: Plot, strength: float) -> Yield:
    """Knife edges at both ends of a trailer, by Lee's pieces, each seen from the other."""
    steel = plot.behind("metal")
    high = plot.each_link(lambda n: 0.1 + plot.rng.gamma(6, 0.055, n)) * np.sqrt(strength)
    wide = np.minimum(0.35 * plot.distance, plot.each_link(lambda n: plot.rng.uniform(1, 4, n)))
    leg = (plot.distance - wide) / 2
    over = 2 * np.hypot(leg, high) + wide - plot.distance
    depth = high * np.sqrt(2 / CARRIER_M * (1 / leg + 1 / wide)) / 1.6
    lost = np.minimum(2 * -20 * np.log10(np.clip(_lee(depth), 0.02, 1)), 23)
    return Yield(steel * over, edge=-steel * lost * np.sqrt(min(strength, 1.0)))


def _lee(v: Floats) -> Floats:
    """Return what a knife edge leaves of an amplitude, v >= 0, in three pieces [n]."""
    root = np.sqrt(np.maximum(0.1184 - np.square(0.38 - 0.1 * v), 0))
    rest = 0.225 / np.maximum(v, 1e-3)
    return np.where(v < 1, 0.5 * np.exp(-0.95 * v), np.where(v < 2.4, 0.4 - root, rest))


def _attenuator(plot: Plot, strength: float) -> Yield:
    """Switch in steps of an attenuator and of symbols, one for every 2.5 dB of level."""
    steps = np.floor(np.maximum(plot("rx_power_dbm") + 88, 0) / 2.5)
    return Yield(
        0 * plot.distance, whole=-0.75 * min(strength, 2.0) * steps, count=-0.8 * strength * steps
    )


def _engines(plot: Plot, strength: float) -> Yield:
    """Sparks of pickers' engines: every picker has its own; weak rows scatter the more."""
    hiss = 0.5 * strength + strength * plot.lasting(4).uniform(0.4, 2.2, PICKERS)[plot.picker]
    weak = 10 ** (-(plot("rx_power_dbm") + 90) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Yield(0.024 * weak * plot.rng.standard_t(9, len(weak)), hiss=hiss)


def _dew(plot: Plot, strength: float) -> Yield:
    return Yield(0.23 * strength * (1 - 2 ** (-plot("dew_mm") / 0.11)))


def _crates(plot: Plot, strength: float) -> Yield:
    """Press the springs down that the antenna stands on, more and more."""
    return Yield(0.18 * strength * (plot("crates_kg") / 320) ** 1.8)


def _irrigation(plot: Plot, strength: float) -> Yield:
    return Yield(0.085 * strength * np.cos(2 * np.pi * plot("time_s") / 1370 + 0.9))


def _sprayer(plot: Plot, strength: float) -> Yield:
    return Yield(np.where(plot("pump_bar") > 4.2, 0.15 * strength, 0.0))


def _satellites(plot: Plot, strength: float) -> Yield:
    return Yield(0.9 * strength / plot("satellites"))


def _foliage(plot: Plot, strength: float) -> Yield:
    return Yield(0.046 * strength * plot("leaf_area_index"))


def _slope(plot: Plot, strength: float) -> Yield:
    """Take heights from a flat map: the ground rises along the rows."""
    rises = np.array([0.06, 0.018]) * strength
    pickers, posts = plot.picker_at(), POSTS_M[plot.post].copy()
    for ends in (pickers, posts):
        ends[:, 2] += ends[:, :2] @ rises
    return Yield(plot.gap(pickers, posts) - plot.distance)


def _slew(plot: Plot, strength: float) -> Yield:
    """Let ranges of a link change by no more than a limit from poll to poll."""
    most, range_m = 0.9 / np.sqrt(strength), plot("range_m")
    written = range_m.copy()
    for rows in plot.table.groupby("link").indices.values():
        for before, now in pairwise(rows):
            step = range_m[now] - written[before]
            written[now] = written[before] + np.clip(step, -most, most)
    return Yield(written - range_m)


def _truly_at(plot: Plot, posts: Floats) -> Yield:
    """Return what rows yield where posts truly are at [n, 3]."""
    truly = plot.gap(plot.picker_at(), posts)
    return Yield(truly - plot.distance, whole=20 * np.log10(plot.distance / truly))


def _from_the_soil(plot: Plot, strength: float) -> Yield:
    """Heights of posts were taken from the top of a bank: all are lower by as much."""
    return _truly_at(plot, POSTS_M[plot.post] - [0.0, 0.0, 0.8 * strength])


def _leans(plot: Plot, strength: float) -> Yield:
    shift = np.where(plot.post[:, None] == 7, strength * np.array([0.44, 0.31, -0.147]), 0.0)
    return _truly_at(plot, POSTS_M[plot.post] + shift)


def _relabelled(plot: Plot, _: float) -> Yield:
    return _truly_at(plot, POSTS_M[[0, 3, 2, 1, 4, 5, 6, 7]][plot.post])


def _yards(plot: Plot, _: float) -> Yield:
    return Yield(np.where(plot.post == 5, (1 / YARD_M - 1) * plot("range_m"), 0.0))


EFFECTS: dict[str, Callable[[Plot, float], Yield]] = {
    "time-lag": _two_receivers,
    "exchange-motion": _three_messages,
    "antenna-delay": _makes_of_boards,
    "clock-offset": _two_sided,
    "temperature-drift": _slackens,
    "antenna-pattern": _ramps,
    "power-bias": _calibrated,
    "timestamp-jitter": _two_edges,
    "path-loss": _more_leaves,
    "range-scale": _calibrated_near,
    "range-rounding": _up,
    "material-delay": _stacks,
    "blocked-path": _by_a_tank,
    "ground-bounce": _soil,
    "diffraction": _two_edges_of_a_trailer,
    "level-control": _attenuator,
    "noise-floor": _engines,
    "dew-on-leaves": _dew,
    "crates-aboard": _crates,
    "irrigation-turns": _irrigation,
    "sprayer-runs": _sprayer,
    "few-satellites": _satellites,
    "leaves-grow": _foliage,
    "slope-forgotten": _slope,
    "slew-limited": _slew,
    "heights-from-the-soil": _from_the_soil,
    "post-leans": _leans,
    "posts-relabelled": _relabelled,
    "yards-from-one-post": _yards,
}
