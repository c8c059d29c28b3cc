"""What the bowls green hides in ranges and levels: effects in forms of its own.

numpy alone; shared by the green's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.bowls_dial import METRES, bending, humped, summit
from bench.challenge.families.bowls_faults import UNLISTED
from bench.challenge.families.bowls_rinks import (
    DAY_S,
    GREEN_M,
    KNOTS,
    KNOTS_M,
    PER_PPM_M,
    TAGS,
    WAVE_M,
    Change,
    End,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
UNSEEN = {False: 0.2, True: 0.075}  # of links, and where these are rare
HARDY = ((0.28, 0.0), (1.62, 1 / 6), (2.2, 0.5), (1.62, 5 / 6), (0.28, 1.0))
"""Sixfold weights of five places of an exchange, and where in it they are."""
SWEPT_S, OLD_S, UNEVEN = 0.31, 0.085, 0.3  # of a scanner: once round; mean age; how ages differ
TURN_M, TURNS, MOULD_M = 0.045, 6, (0.0, 0.02, 0.17)  # of cables round ropes; of tags' shells
SPENT = 0.45  # by how much more a cell's last hour pulls crystals
MELTS_C, READ_C = 47.0, 20.0  # at which wax in covers has no order left; when it was calibrated
FOOT_M = 0.3048
INCHES: Floats = np.array([0.0, 5 / 12, 10 / 12, 1.0])  # of a foot, that are written
BASE_SCALE, TOOTH = 0.0024, 0.0052  # how long all are; for each of three gears that is worn
SUBSTANCE = 3.3 / 6.3 / 1.53  # polarisability of wood without air, for each g/cm3
WOODS = (0.55, 0.7)  # g/cm3 of benches and of boards
CARPET, CARPET_M, SLAB = 1.9 - 0.16j, 0.009, 5.24 - 0.6j  # permittivities, how thick
BLOWER_M: Floats = np.array([0.5, 17.0, 1.0])
FAN, TAUT_PA, HUMS_M = 2.5, 245.0, 14.0  # power of pressure; how far it is heard
MASTS_M: Floats = np.array(
    [(4.1 * k, y) for k in range(1, 10) for y in (2.6, 23.4)] + [(1.5, 13.0), (40.5, 13.0)]
)
MAST_HIGH_M = 4.6


def _swept(end: End, strength: float) -> Change:
    """Compare with places from a scanner that turns: of another age in each direction."""
    off = end.below[:, :2] - np.array(GREEN_M) / 2
    passed = np.mod(np.arctan2(off[:, 1], off[:, 0]) / (2 * np.pi) - end["time_s"] / SWEPT_S, 1.0)
    return Change(end.stretches_in(OLD_S * strength * (1 + UNEVEN * (passed - 0.5))))


def _hardy(end: End, strength: float) -> Change:
    """Give the mean of the way over an exchange, by Hardy's rule (1913)."""
    whole_s = 2.2 * strength * end["reply_time_s"]
    return Change(np.sum([by / 6 * end.stretches_in(at * whole_s) for by, at in HARDY], axis=0))


def _wound(end: End, strength: float) -> Change:
    """Be late by turns of cable round ropes, at knots; by how thick shells of tags are."""
    drawn = end.shared(1)
    turns = np.minimum(drawn.geometric(0.4, KNOTS) - 1, TURNS)[end.knot]
    return Change(strength * (TURN_M * turns + drawn.triangular(*MOULD_M, len(TAGS))[end.tag]))


def _spent(end: End, strength: float) -> Change:
    """Leave some of crystals' offset, and of tags' the more the emptier cells are: by a cube."""
    drawn = end.shared(2)
    knots = drawn.logistic(0.0, 0.42, KNOTS).clip(-1.5, 1.5)[end.knot]
    tags = drawn.uniform(-1.3, 1.3, len(TAGS))[end.tag]
    tags = tags * (1 + SPENT * (end["time_s"] / DAY_S) ** 3)
    return Change(PER_PPM_M * 0.017 * strength * (tags - knots) * end["reply_time_s"])


def _landau(end: End, strength: float) -> Change:
    """Drift by the order that wax in covers has left: a root of how far it is from melting."""
    left, usual = (
        ((MELTS_C - c) / 30.0).clip(0.01) for c in (end["temperature_c"], np.full(1, READ_C))
    )
    return Change(0.24 * strength * (np.sqrt(usual) - np.sqrt(left)))


def _bump(end: End, strength: float) -> Change:
    """Be late and weak behind a hand or a handle: by a bump that is smooth to its very ends."""
    middle = end.shared(3).uniform(0.0, 360.0)
    off = (end["azimuth_deg"] - middle + 180.0) % 360.0 - 180.0
    inside = (1 - (off / 105.0) ** 2).clip(1e-3)
    shade = np.exp(1 - 1 / inside)
    return Change(strength * (0.17 * shade - 0.04), first_db=-5.0 * min(strength, 1.5) * shade)


def _burr(end: End, strength: float) -> Change:
    """Be late where it is weak: by Burr's curve (1942) of how far it is below a level."""
    below = (-61.0 - end["rx_power_dbm"]).clip(0.0)
    return Change(strength * (0.195 - 0.195 * (1 + (below / 20.0) ** 5.5) ** -1.3 - 0.1))


def _late_now_and_then(end: End, strength: float) -> Change:
    """Scatter by a bell and by waits that are exponential, about their mean (Grushka 1972)."""
    waits = end.rng.exponential(1.0, end.rows).clip(max=5.5) - 1.0
    return Change(strength * (0.028 * end.rng.normal(size=end.rows) + 0.029 * waits))


def _from_a_break(end: End, strength: float) -> Change:
    """Lose as over a plane, power by the fourth of ways, past breaks that are soft; by links."""
    begins = end.by_link(lambda n: 17.0 * np.exp(0.25 * end.rng.normal(size=n)))
    return Change(all_db=-10.0 * strength * np.log10(1 + (end.far / begins) ** 2.0))


def _worn_gears(end: End, strength: float) -> Change:
    """Be surveyed by a wheel's three gears, of which at knots some or other slipped."""
    slipped = end.shared(5).binomial(3, 0.45, KNOTS)[end.knot]
    return Change(strength * (BASE_SCALE + TOOTH * slipped) * end.far)


def _inches(end: End, strength: float) -> Change:
    """Write feet, and of inches none, five or ten, whichever is nearest."""
    fine = end["range_m"] / (FOOT_M * strength)
    feet = np.floor(fine)
    nearest = np.abs(INCHES - (fine - feet)[:, None]).argmin(axis=1)
    return Change(FOOT_M * strength * (feet + INCHES[nearest] - fine))


def of_wood(dense: Floats) -> Floats:
    """Return permittivities of wood by g/cm3 [n]: polarisabilities add up (Lorentz, Lorenz)."""
    part = SUBSTANCE * dense
    return np.asarray((1 + 2 * part) / (1 - part))


def _polarised(end: End, strength: float) -> Change:
    """Go through benches and hoardings by how dense they are, through panes and hollow walls."""
    drawn = end.rng
    deep = end.by_link(lambda n: drawn.triangular(0.1, 0.2, 0.5, n))
    boards = end.by_link(lambda n: drawn.triangular(0.03, 0.09, 0.2, n))
    dense, pressed = (mean + end.by_link(lambda n: drawn.normal(0.0, 0.05, n)) for mean in WOODS)
    panes = end.by_link(lambda n: drawn.uniform(0.012, 0.034, n))
    sheets = end.by_link(lambda n: drawn.uniform(0.025, 0.075, n))
    through: list[tuple[str, Floats, Floats]] = [
        ("wood", deep * (np.sqrt(of_wood(dense)) - 1), 0.9 + 9.0 * deep),
        ("chipboard", boards * (np.sqrt(of_wood(pressed)) - 1), 0.8 + 20.0 * boards),
        ("plasterboard", sheets * (np.sqrt(2.73) - 1), 1.0 + 16.0 * sheets),
        ("glass", panes * (np.sqrt(6.31) - 1), 1.0 + 30.0 * panes),
    ]
    late = sum(end.meets(what) * metres for what, metres, _ in through)
    lost = sum(end.meets(what) * db for what, _, db in through)
    return Change(strength * late, first_db=-min(strength, 1.5) * lost)


def by_masts(end: End) -> Floats:
    """Return how much longer ways are by each mast, in m [n, masts]: where on it is soonest."""
    rise = end.aloft[:, 2] - end.below[:, 2]
    legs = [np.linalg.norm(one[:, None, :2] - MASTS_M, axis=2) for one in (end.below, end.aloft)]
    part = legs[0] / (legs[0] + legs[1])
    high = (end.below[:, 2:] + rise[:, None] * part).clip(max=MAST_HIGH_M)
    ways = [
        np.hypot(leg, one[:, 2:] - high)
        for leg, one in zip(legs, (end.below, end.aloft), strict=True)
    ]
    return np.asarray(ways[0] + ways[1] - end.far[:, None])


def _off_masts(end: End, strength: float) -> Change:
    """Hear, out of sight, nothing but what the best placed mast of floodlights returns."""
    hidden = end.struck(UNSEEN[end.rare])
    longer = by_masts(end)
    soonest = np.where(longer > 0.46, longer, np.inf).min(axis=1)
    late = soonest.clip(max=4.4) * (0.45 + 0.55 * strength)
    return Change(hidden * late, -1.5 * hidden, -4.2 * hidden)


def layered(down: Floats, dense: tuple[complex, complex], upright: bool) -> Complexes:
    """Return what a carpet on a slab returns of waves that come down so steeply [n] (Airy)."""
    roots = [down.astype(np.complex128), *(np.sqrt(one - 1 + down**2) for one in dense)]
    by = [1.0, *dense] if upright else [1.0, 1.0, 1.0]
    bend = [root / one for root, one in zip(roots, by, strict=True)]
    top, bottom = ((a - b) / (a + b) for a, b in pairwise(bend))
    there_and_back = bottom * np.exp(-4j * np.pi * CARPET_M * roots[1] / WAVE_M)
    return np.asarray((top + there_and_back) / (1 + top * there_and_back))


def off_the_carpet(end: End, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the carpet is in m, and its complex share, [n] each."""
    low, high = end.below[:, 2], end.aloft[:, 2]
    way = np.hypot(end.far, 2 * np.sqrt(low * high))
    down = (low + high) / way
    part = end.by_link(lambda n: end.rng.beta(1.4, 1.4, n))
    free = end.by_link(lambda n: end.rng.beta(5.0, 1.3, n))
    back = part * layered(down, (CARPET, SLAB), True)
    back += (1 - part) * layered(down, (CARPET, SLAB), False)
    share = 2.1 * np.sqrt(strength) * free * back * end.far / way
    share = share * np.exp(-2j * np.pi * (way - end.far) / WAVE_M)
    return way - end.far, share / np.maximum(1.0, np.abs(share) / 0.84)


def _both_bend(end: End, strength: float) -> Change:
    """Be where both pulses together bend down most at first: that of the carpet comes later."""
    longer, share = off_the_carpet(end, strength)
    step = 1 / 20
    at = np.arange(-9.0, 9.0, step)
    bend = bending(
        np.abs(humped(at) + share[:, None] * humped(at - longer[:, None] / METRES)), step
    )
    tops = (bend[:, 1:-1] > bend[:, :-2]) & (bend[:, 1:-1] >= bend[:, 2:])
    tops &= bend[:, 1:-1] > 0.35 * bend.max(axis=1)[:, None]
    place = at[0] + step * summit(bend, 1 + tops.argmax(axis=1))
    added = np.abs(1 + share * humped(longer / METRES)).clip(min=0.42)
    return Change((1.2 * METRES * place).clip(-0.25, 0.3), 20 * np.log10(added))


def past_an_edge(over: Floats) -> Floats:
    """Return what an edge takes in dB [n] by Fresnel's parameter, in Lee's pieces (1985)."""
    steep = (0.1184 - (0.38 - 0.1 * over) ** 2).clip(1e-9)
    left = np.select(
        [over < 0.0, over < 1.0, over < 2.4],
        [0.5 - 0.62 * over.clip(-0.8), 0.5 * np.exp(-0.95 * over), 0.4 - np.sqrt(steep)],
        0.225 / over.clip(2.4),
    )
    return np.asarray(-20 * np.log10(left))


def _past_a_board(end: End, strength: float) -> Change:
    """Bend past a scoreboard of steel, and run along the channels that it hangs in."""
    steel, drawn = end.meets("metal"), end.rng
    cut = end.by_link(lambda n: drawn.beta(2.0, 2.0, n).clip(0.15, 0.85))
    high = np.sqrt(strength) * end.by_link(lambda n: drawn.uniform(0.1, 0.75, n))
    legs = [end.far * part for part in (cut, 1 - cut)]
    over = high * np.sqrt(2 * end.far / (WAVE_M * legs[0] * legs[1]))
    detour = sum(np.hypot(high, leg) for leg in legs) - end.far
    runs = strength * end.by_link(lambda n: drawn.triangular(0.03, 0.07, 0.15, n))
    lost = past_an_edge(over).clip(max=11.0)
    return Change(steel * (detour + runs).clip(0.0, 0.47), first_db=-steel * lost)


def _magnetised(end: End, strength: float) -> Change:
    """Turn gain down by ferrites: by Langevin's function; count the fewer symbols."""
    over = ((end["rx_power_dbm"] + 95.0) / 7.0).clip(1e-3)
    less = 7.0 * min(strength, 2.2) * (1 / np.tanh(over) - 1 / over)
    return Change(all_db=-less, count_db=-1.15 * less)


def _blower(end: End, strength: float) -> Change:
    """Hear the blower's drive, by a fan's law of pressure, the less the farther knots are."""
    own = end.shared(4).uniform(0.5, 1.5, KNOTS)[end.knot]
    near = np.exp(-np.linalg.norm(KNOTS_M - BLOWER_M, axis=1) / HUMS_M)[end.knot]
    db = strength * (own + 6.5 * near * (end["inside_pa"] / TAUT_PA) ** FAN)
    weak = 10 ** ((-86.0 - end["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Change(0.017 * weak.clip(max=8.0) * end.rng.normal(size=end.rows), noise_db=db)


EFFECTS: dict[str, Callable[[End, float], Change]] = {
    "antenna-delay": _wound,
    "antenna-pattern": _bump,
    "blocked-path": _off_masts,
    "clock-offset": _spent,
    "diffraction": _past_a_board,
    "exchange-motion": _hardy,
    "ground-bounce": _both_bend,
    "level-control": _magnetised,
    "material-delay": _polarised,
    "noise-floor": _blower,
    "path-loss": _from_a_break,
    "power-bias": _burr,
    "range-rounding": _inches,
    "range-scale": _worn_gears,
    "temperature-drift": _landau,
    "time-lag": _swept,
    "timestamp-jitter": _late_now_and_then,
    **UNLISTED,
}
