"""What the granary hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the granary's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.granary_bins import (
    BIN_M,
    BINS_M,
    DAY_S,
    PER_PPM_M,
    SPOUTS,
    TAGS,
    WAVE_M,
    Docket,
    Freight,
)
from bench.challenge.families.granary_faults import UNLISTED
from bench.challenge.families.granary_sieve import AHEAD, METRES, first_paths, measured, swells

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OUT_OF_SIGHT = {False: 0.2, True: 0.075}  # of links, and where these are rare
HOP_S, HOPS, MOST_HOPS = 0.0165, 3.0, 9  # a hop; how many a fix takes, and at most
ENDS = (9 / 24, 28 / 24, 23 / 24, 1.0)  # how much places count from either end (Gregory 1670)
MESSAGES = 2.2  # replies that an exchange lasts
MEET_C, HENDERSON_C, BY, SWELLS_M = 19.0, 55.8, 1 / 2.2857, 0.5  # of wood's moisture by warmth
OFF_CRATE, CRATE_M = 0.42, 0.11  # of half its side that antennas are off; metres of these
EVEN_DBM, LOCK_DB, LOCKS_M = -85.0, 2.6, 0.067  # of what locks the better the louder it is
SCATTERS_M, OWN_TIME = 0.043, 4.0  # of a bell; how evenly its own time goes
BAY_M = (8.5, 7.0, 6.0)  # of frames along, across and up
LENS_M, LENS = (27.0, 18.0), (0.003, 0.0035, 25.0)  # its middle; parts; so far from it in m
VULGAR: Floats = np.array([0, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 1])
WRITTEN_M = 0.8  # of which vulgar fractions are written
LIKED_DBM, WIDE_DB = -93.0, 10.0  # over which gain is turned down
FARTHEST_M = 4.3  # that what comes round bins is late
FLOOR, GRADUAL_M = 3.1 - 0.25j, 0.0035  # permittivity of loose grain; how softly it begins
MILL_M: Floats = np.array([50.0, 30.0, 2.0])
FULL_KW = 92.0  # at which a mill would stall


def _hops(docket: Docket, strength: float) -> Freight:
    """Compare with places that came by as many hops as chance has it, by Poisson's law."""
    counts = np.cumprod([1.0, *(HOPS / np.arange(1, MOST_HOPS + 1))])
    late = np.zeros(docket.count)
    for hops, by in enumerate(counts / counts.sum()):
        late += by * docket.draws_off(HOP_S * strength * hops)
    return Freight(late)


def gregory() -> tuple[Floats, Floats]:
    """Return places between 0 and 1 and what each counts, which sum up to 1 (Gregory 1670)."""
    counts = np.array([*ENDS, *ENDS[::-1]])
    return np.linspace(0.0, 1.0, len(counts)), counts / counts.sum()


def _exchange(docket: Docket, strength: float) -> Freight:
    """Give the mean of the way over an exchange, by eight places whose ends are put right."""
    lasts_s = MESSAGES * strength * docket["reply_time_s"]
    parts = [by * docket.draws_off(lasts_s * at) for at, by in zip(*gregory(), strict=True)]
    return Freight(np.sum(parts, axis=0))


def _digits(docket: Docket, strength: float) -> Freight:
    """Be late by the first digit of what spouts were entered with (Benford 1938); by tags' paste.

    Paste is as thick as two parts of chance have it (Rayleigh).
    """
    drawn = docket.shared(1)
    odds = np.log10(1 + 1 / np.arange(1, 10))
    digits = drawn.choice(np.arange(1, 10), SPOUTS, p=odds / odds.sum())
    paste = 0.035 * drawn.rayleigh(1.0, len(TAGS)).clip(max=2.6)
    return Freight(strength * (0.034 * digits[docket.spout] + paste[docket.tag]))


def _telegraph(docket: Docket, strength: float) -> Freight:
    """Leave some of crystals' offset: tags' jumps between two values as a telegraph's signal."""
    drawn = docket.shared(2)
    spouts = drawn.normal(0.0, 0.4, SPOUTS).clip(-0.9, 0.9)[docket.spout]
    amid = drawn.uniform(-0.7, 0.7, len(TAGS))[docket.tag]
    apart = drawn.uniform(0.6, 1.5, len(TAGS))[docket.tag]
    jumps = drawn.exponential(DAY_S / 4.0, (len(TAGS), 30)).cumsum(axis=1)[docket.tag]
    odd = (jumps < docket["time_s"][:, None]).sum(axis=1) % 2
    ppm = amid + np.where(odd == 1, apart, -apart) - spouts
    return Freight(PER_PPM_M * 0.026 * strength * ppm * docket["reply_time_s"])


def _moisture(docket: Docket, strength: float) -> Freight:
    """Drift as boxes of wood dry in warm air, at an equal dampness (Henderson 1952)."""
    dry = (MEET_C + HENDERSON_C) / (docket["temperature_c"] + HENDERSON_C)
    return Freight(SWELLS_M * strength * (dry**BY - 1))


def to_crate(at: Floats) -> Floats:
    """Return how far a square crate's sides are from OFF_CRATE off its middle, [n] half sides."""
    cosine, sine = np.cos(at), np.sin(at)
    ahead = np.where(cosine > 0, 1 - OFF_CRATE, 1 + OFF_CRATE) / np.maximum(np.abs(cosine), 1e-9)
    return np.asarray(np.minimum(ahead, 1 / np.maximum(np.abs(sine), 1e-9)))


def _crate(docket: Docket, strength: float) -> Freight:
    """Be late and weak by how far it is to a crate's sides from an antenna off its middle."""
    turned = docket.shared(3).uniform(0.0, 2 * np.pi)
    far = to_crate(np.radians(docket["azimuth_deg"]) - turned)
    mean = to_crate(np.linspace(0.0, 2 * np.pi, 721)[:-1]).mean()
    weak = -1.4 * min(strength, 1.5) * (far - (1 - OFF_CRATE))
    return Freight(CRATE_M * strength * (far - mean), first_db=weak)


def locked(ratio: Floats) -> Floats:
    """Return I1 / I0, how well phases are locked at such a ratio, odd, [n] (von Mises 1918)."""
    at = (np.arange(96) + 0.5) * np.pi / 96
    by = np.exp(ratio[:, None] * np.cos(at) - np.abs(ratio)[:, None])
    return np.asarray((by * np.cos(at)).sum(axis=1) / by.sum(axis=1))


def _locks(docket: Docket, strength: float) -> Freight:
    """Be early where it is loud and late where it is weak, as a loop locks to phases."""
    return Freight(LOCKS_M * strength * locked((EVEN_DBM - docket["rx_power_dbm"]) / LOCK_DB))


def _own_time(docket: Docket, strength: float) -> Freight:
    """Scatter by a bell whose own time goes by fits and starts (Madan and Seneta 1990)."""
    went = docket.rng.gamma(OWN_TIME, 1 / OWN_TIME, docket.count)
    return Freight(SCATTERS_M * strength * np.sqrt(went) * docket.rng.normal(size=docket.count))


def _frames(docket: Docket, strength: float) -> Freight:
    """Lose by frames on the way, of which more take less each (COST 231 1999); links unlike."""
    count = (np.abs(docket.to_m - docket.from_m) / np.array(BAY_M)).sum(axis=1)
    thick = docket.per_link(lambda n: docket.rng.triangular(0.4, 1.0, 1.6, n))
    return Freight(all_db=-1.0 * strength * thick * count ** ((count + 2) / (count + 1) - 0.46))


def through_lens(places: Floats) -> Floats:
    """Return by how much places seem off through a lens, in m [n, 3] (Brown 1966)."""
    off = np.zeros_like(places)
    aside = places[:, :2] - np.array(LENS_M)
    square = (aside**2).sum(axis=1, keepdims=True) / LENS[2] ** 2
    off[:, :2] = aside * (LENS[0] + LENS[1] * square)
    return off


def _lens(docket: Docket, strength: float) -> Freight:
    """Be surveyed from a picture from above, whose lens draws out its rim; heights are right."""
    tags, spouts = (strength * through_lens(one) for one in (docket.from_m, docket.to_m))
    return Freight(docket.grows(tags, spouts))


def vulgar(ranges: Floats, unit: float) -> Floats:
    """Return the nearest of vulgar fractions of a unit, up to quarters, [n]."""
    whole, part = np.divmod(ranges / unit, 1.0)
    nearest = np.abs(part[:, None] - VULGAR).argmin(axis=1)
    return np.asarray(unit * (whole + VULGAR[nearest]))


def _vulgar(docket: Docket, strength: float) -> Freight:
    """Write halves, thirds and quarters, whichever is nearest."""
    ranges = docket["range_m"]
    return Freight(vulgar(ranges, WRITTEN_M * strength) - ranges)


def on_a_lattice(within: Floats, fill: Floats) -> Floats:
    """Return the permittivity of balls on a lattice, which fill so much, [n] (Rayleigh 1892)."""
    beside = (within + 2) / (within - 1)
    near = 1.305 * (within - 1) / (within + 4 / 3) * fill ** (10 / 3)
    return np.asarray(1 + 3 * fill / (beside - fill - near))


def _things(docket: Docket, strength: float) -> Freight:
    """Go through two walls of round bins as these are met, boxes, hoppers' sheets, brick aslant."""
    drawn, link = docket.rng, docket.per_link
    aside = link(lambda n: drawn.uniform(0.0, 0.9, n))
    staves = 2 * link(lambda n: drawn.uniform(0.03, 0.055, n)) / np.sqrt(1 - aside**2)
    boxes = link(lambda n: 0.4 * drawn.integers(1, 5, n))
    index = np.sqrt(on_a_lattice(np.full(1, 1.99), link(lambda n: drawn.uniform(0.15, 0.5, n))))
    sheets = link(lambda n: 0.021 * drawn.integers(2, 7, n))
    sine = np.sin(link(lambda n: drawn.uniform(0.0, 0.9, n)))
    bricks = link(lambda n: 0.115 * drawn.integers(1, 4, n))
    within, without = np.sqrt(3.91 - sine**2), np.sqrt(1 - sine**2)
    things: dict[str, tuple[Floats, Floats]] = {
        "concrete": (staves * (np.sqrt(5.24) - 1), 0.8 + 30.0 * staves),
        "wood": (boxes * (index - 1), 0.6 + 3.0 * boxes),
        "plywood": (sheets * (np.sqrt(2.71) - 1), 0.7 + 19.0 * sheets),
        "brick": (bricks * (within - without), 1.0 + 13.0 * bricks / without),
    }
    late, lost = (sum(docket.past(w) * both[k] for w, both in things.items()) for k in (0, 1))
    return Freight(
        1.2 * strength * np.asarray(late), first_db=-min(strength, 1.5) * np.asarray(lost)
    )


def round_bins(docket: Docket) -> Floats:
    """Return how much longer strings are that go round bins' far sides, in m [n, bins]."""
    ways = [one[:, None, :2] - BINS_M for one in (docket.from_m, docket.to_m)]
    far = [np.maximum(np.linalg.norm(one, axis=2), 1.001 * BIN_M) for one in ways]
    faces = [np.arctan2(one[:, :, 1], one[:, :, 0]) for one in ways]
    between = np.abs(np.angle(np.exp(1j * (faces[0] - faces[1]))))
    touched = 2 * np.pi - between - np.arccos(BIN_M / far[0]) - np.arccos(BIN_M / far[1])
    flat = sum(np.sqrt(one**2 - BIN_M**2) for one in far) + BIN_M * touched
    up = (docket.to_m - docket.from_m)[:, [2]]
    return np.asarray(np.hypot(flat, up) - docket.far[:, None])


def _far_sides(docket: Docket, strength: float) -> Freight:
    """Hear, out of sight, nothing but what creeps round the far side of the best placed bin."""
    cut = docket.hidden_links(OUT_OF_SIGHT[docket.rare])
    longer = round_bins(docket).min(axis=1).clip(0.7)
    late = FARTHEST_M * np.tanh(longer / FARTHEST_M) * (0.5 + 0.5 * strength)
    return Freight(cut * late, -1.1 * cut, -4.8 * cut)


def gradual(sine: Floats) -> Complexes:
    """Return what grain returns of level waves that come so steeply [n]: it begins softly.

    By Epstein's layer (1930), whose permittivity goes over by a tanh; thin, it is Fresnel's.
    """
    turn = np.pi * GRADUAL_M * 2 * np.pi / WAVE_M
    root = np.sqrt(FLOOR - 1 + sine**2)
    return np.asarray(np.sinh(turn * (sine - root)) / np.sinh(turn * (sine + root)))


def off_the_grain(docket: Docket, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each."""
    up = docket.from_m[:, 2] + docket.to_m[:, 2]
    flat = ((docket.to_m - docket.from_m)[:, :2] ** 2).sum(axis=1)
    way = np.sqrt(flat + up**2)
    strewn = docket.per_link(lambda n: 0.4 + 0.6 * docket.rng.beta(2.5, 1.5, n))
    share = 1.3 * np.sqrt(strength) * strewn * gradual(up / way) * docket.far / way
    share = share * np.exp(-2j * np.pi * (way - docket.far) / WAVE_M)
    return way - docket.far, share / np.maximum(np.abs(share) / 0.78, 1.0)


def of_both(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As sieves have it of two pulses, the second of which is so much later and such a share.
    """
    top, quiet = np.full(len(longer_m), 95.4), np.full(len(longer_m), 1e-6)
    one = swells(top).astype(np.complex128)
    both = one + share[:, None] * swells(top + longer_m / METRES)
    at = first_paths(both, quiet)
    return METRES * (at + AHEAD - top), np.abs(measured(both, at))


def _both(docket: Docket, strength: float) -> Freight:
    """Be where ratios of both pulses' samples have it: that of the grain comes later."""
    late, height = of_both(*off_the_grain(docket, strength))
    return Freight(late.clip(-0.2, 0.24), 20 * np.log10(height.clip(0.4)))


def past_edge_db(v: Floats) -> Floats:
    """Return what an edge takes in dB, by Fresnel's parameter >= 0 [n] (Boersma 1960)."""
    f = (1 + 0.926 * v) / (2 + 1.792 * v + 3.104 * v**2)
    g = 1 / (2 + 4.142 * v + 3.492 * v**2 + 6.67 * v**3)
    return np.asarray(-10 * np.log10((f**2 + g**2) / 2))


def _lorries(docket: Docket, strength: float) -> Freight:
    """Bend over a lorry's side of steel, and creep along what is heaped on it."""
    steel, drawn, link = docket.past("metal"), docket.rng, docket.per_link
    part = link(lambda n: 0.2 + 0.6 * drawn.beta(1.5, 1.5, n))
    near = 1 / (part * docket.far) + 1 / ((1 - part) * docket.far)
    high = link(lambda n: drawn.uniform(0.06, 0.28, n)) * np.sqrt(strength)
    lost = past_edge_db(high * np.sqrt(2 / WAVE_M * near))
    late = 0.5 * high**2 * near + strength * link(lambda n: drawn.triangular(0.05, 0.12, 0.17, n))
    return Freight(steel * late.clip(0.0, 0.46), first_db=-steel * lost.clip(1.0, 17.0))


def _weibull(docket: Docket, strength: float) -> Freight:
    """Turn gain down by Weibull's curve (1951) of what is over a level; add up fewer symbols."""
    over = ((docket["rx_power_dbm"] - LIKED_DBM) / WIDE_DB).clip(0.0)
    less = 3.3 * min(strength, 2.2) * -np.expm1(-(over**1.7))
    return Freight(all_db=-less, count_db=-1.1 * less)


def _mill(docket: Docket, strength: float) -> Freight:
    """Hear the mill's drive, as a queue grows with its load; less by a root the farther."""
    own = docket.shared(4).uniform(0.3, 1.3, SPOUTS)[docket.spout]
    away = np.linalg.norm(docket.to_m - MILL_M, axis=1)
    loud = docket["mill_kw"] / (FULL_KW - docket["mill_kw"])
    db = strength * (own + 4.2 * loud / np.sqrt(1 + away / 8.0))
    weak = 10 ** ((-90.0 - docket["rx_power_dbm"]) / 20) * np.sqrt(np.expm1(db * np.log(10) / 10))
    return Freight(0.015 * weak.clip(max=8.0) * docket.rng.normal(size=docket.count), noise_db=db)


EFFECTS: dict[str, Callable[[Docket, float], Freight]] = {
    "antenna-delay": _digits,
    "antenna-pattern": _crate,
    "blocked-path": _far_sides,
    "clock-offset": _telegraph,
    "diffraction": _lorries,
    "exchange-motion": _exchange,
    "ground-bounce": _both,
    "level-control": _weibull,
    "material-delay": _things,
    "noise-floor": _mill,
    "path-loss": _frames,
    "power-bias": _locks,
    "range-rounding": _vulgar,
    "range-scale": _lens,
    "temperature-drift": _moisture,
    "time-lag": _hops,
    "timestamp-jitter": _own_time,
    **UNLISTED,
}
