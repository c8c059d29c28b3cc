"""What the opera hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the opera's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.opera_stage import (
    BETWEEN,
    CASTOR_M,
    CLEATS,
    CLEATS_M,
    ON_GALLERIES,
    PER_PPM_M,
    REVOLVE_M,
    TAGS,
    VARA_M,
    WAVE_M,
    Change,
    Cue,
    done,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
MASKED = {False: 0.19, True: 0.06}  # of links, and where these are scarce
DECK, SCUFFED_M = 3.1 - 0.16j, 0.004  # permittivity of hardboard on boards; how uneven it is
WIDE_M = 0.45  # of a pulse, from its top to one over e
DIMMERS_M: Floats = np.array([(2.0, 19.0, 1.5), (26.0, 19.0, 1.5), (14.0, 1.0, 12.0)])
LINES_M = 6.0  # from one line of a bar to the next; the first is at 2 m
SAG_M, SLIP, RAKE = 0.2, 0.09, 0.055  # between lines; of what is turned; one in eighteen
ANOTHER_CLOCK_S = 0.7


def _by_the_bus(cue: Cue, strength: float) -> Change:
    """Compare with places from a bus: the more axes run at a cue, the older these are."""
    axes = cue.by_cue(lambda n: cue.rng.integers(1, 7, n))
    return Change(cue.longer_in(strength * (0.062 + 0.011 * axes)))


def _chebyshev(cue: Cue, strength: float) -> Change:
    """Give the mean of the way over an exchange, by Chebyshev's rule: three places, all alike."""
    whole_s = 1.8 * strength * cue.column("reply_time_s")
    places = 0.5 + 0.5 * np.sqrt(0.5) * np.array([-1.0, 0.0, 1.0])
    return Change(np.mean([cue.longer_in(place * whole_s) for place in places], axis=0))


def _adapters(cue: Cue, strength: float) -> Change:
    """Be late by adapters at cleats, so many at each, and by which batch tags are of."""
    adapters = cue.common(1).poisson(1.4, CLEATS).clip(max=4)[cue.cleat]
    batch = cue.common(2).choice([0.02, 0.085], len(TAGS))
    return Change(strength * (0.043 * adapters + batch[cue.tag]))


def _weak_ovens(cue: Cue, strength: float) -> Change:
    """Leave some of crystals' offset, and of what warmth does past ovens: a tanh of it."""
    own = cue.common(3).laplace(0.0, 0.55, CLEATS + len(TAGS))
    warm = np.tanh((cue.column("temperature_c") - 26.0) / 7.0)
    ppm = 0.0125 * strength * (own[CLEATS + cue.tag] - own[cue.cleat] + 0.5 * warm)
    return Change(PER_PPM_M * ppm * cue.column("reply_time_s"))


def _bridge(cue: Cue, strength: float) -> Change:
    """Drift as a bridge with platinum in it: by a line less a square (Callendar 1887)."""
    warm = cue.column("temperature_c") - 19.0
    return Change(strength * (0.0093 * warm - 0.00011 * warm**2))


def _three_in_a_row(cue: Cue, strength: float) -> Change:
    """Be late and weak past a bar's clamps, three in a row: Fejér's kernel of the direction."""
    off = np.radians(cue.column("azimuth_deg")) - cue.common(4).uniform(0.0, 2 * np.pi)
    shade = ((1 + 2 * np.cos(off)) / 3) ** 2
    return Change(strength * (0.15 * shade - 0.05), all_db=-2.6 * min(strength, 1.5) * shade)


def _fermi(cue: Cue, strength: float) -> Change:
    """Be late where it is weak: by Fermi's function of the level."""
    over = np.clip((cue.column("rx_power_dbm") + 82.5) / 2.6, -30.0, 30.0)
    return Change(0.19 * strength * (1 / (1 + np.exp(over)) - 0.5))


def _student(cue: Cue, strength: float) -> Change:
    """Scatter by a bell that is as wide as six parts of chance have it (Student 1908)."""
    return Change(0.031 * strength * cue.rng.standard_t(6.0, cue.count).clip(-7.0, 7.0))


def _amid_ropes(cue: Cue, strength: float) -> Change:
    """Lose more among ropes and cloths: by one more exponent, which sets in about 5 m."""
    cloths = cue.by_link(lambda n: cue.rng.gamma(4.0, 0.25, n))
    return Change(all_db=-strength * (5.2 * np.log10(1 + (cue.way / 5.0) ** 2) + 0.8 * cloths))


def _reference_clocks(cue: Cue, strength: float) -> Change:
    """Count by the clocks of two galleries and of all else, each of which is slow."""
    slow = np.select([cue.cleat < 4, cue.cleat < ON_GALLERIES], [0.0054, 0.0062], 0.0069)
    return Change(strength * slow * cue.column("range_m"))


def _two_firmwares(cue: Cue, strength: float) -> Change:
    """Write steps: cleats of an old firmware cut down to these, others go to the nearest."""
    step, read = 0.12 * strength, cue.column("range_m")
    old = (cue.common(5).permutation(CLEATS) < 5)[cue.cleat]
    return Change(step * np.where(old, np.floor(read / step), np.rint(read / step)) - read)


def _packs_of_flats(cue: Cue, strength: float) -> Change:
    """Go through what is of solid and of air, as it stands: a mixture's law (Looyenga 1965).

    Flats and rostra stand across the stage, parapets' floors lie: ways are the more aslant.
    """
    late, lost = np.zeros(cue.count), np.zeros(cue.count)
    lean = np.abs(cue.at - cue.post) / cue.way[:, None]
    for kind, (thick_m, solid, dense, db) in BETWEEN.items():
        straight = lean[:, 2 if kind == "concrete" else 1].clip(0.4, 1.0)
        packed = cue.by_link(lambda n: cue.rng.choice([0.7, 1.0, 1.4], n)) * cue.through(kind)
        mixed = (solid * (dense ** (1 / 3) - 1) + 1) ** 3
        late += packed * thick_m * (np.sqrt(mixed - 1 + straight**2) - straight)
        lost += packed * db / np.sqrt(straight)
    return Change(1.15 * strength * late, first_db=-min(strength, 1.5) * lost)


def _off_the_curtain(cue: Cue, strength: float) -> Change:
    """Hear, past a stack of scenery, nothing but what the iron curtain throws back."""
    masked = cue.some_hidden(MASKED[cue.seldom])
    image = np.linalg.norm(cue.at * [1.0, -1.0, 1.0] - cue.post, axis=1)
    detour = 0.42 + 2.5 * np.tanh((image - cue.way) / 6.0)
    return Change(masked * detour * (0.45 + 0.55 * strength), -2.1 * masked, -3.6 * masked)


def deck_ray(cue: Cue, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the deck is in m, and its complex share, [n] each.

    Antennas lie level, across their ways; what stands on the deck takes some, by links.
    """
    way = np.linalg.norm(cue.at - cue.post * [1.0, 1.0, -1.0], axis=1)
    down = (cue.at[:, 2] + cue.post[:, 2]) / way
    inside = np.sqrt(DECK - 1 + down**2)
    fresnel = (down - inside) / (down + inside)
    even = np.exp(-0.5 * (4 * np.pi * SCUFFED_M * down / WAVE_M) ** 2)
    free = cue.by_link(lambda n: 0.55 + 0.45 * cue.rng.beta(4.0, 1.5, n))
    size = min(1.55 * strength**0.5, 2.3) * even * free * cue.way / way
    longer = way - cue.way
    return longer, size * fresnel * np.exp(-2j * np.pi * longer / WAVE_M)


def _halfway_up(sizes: Floats, at_m: Floats) -> Floats:
    """Return where sizes [n, k] first are half of their largest, in m [n]: by lines."""
    half = 0.5 * sizes.max(axis=1, keepdims=True)
    over, rows = (sizes >= half).argmax(axis=1).clip(min=1), np.arange(len(sizes))
    high, low = sizes[rows, over], sizes[rows, over - 1]
    part = (high - half[:, 0]) / np.maximum(high - low, 1e-9)
    return np.asarray(at_m[over] - part.clip(0.0, 1.0) * (at_m[1] - at_m[0]))


def _pulled_edge(cue: Cue, strength: float) -> Change:
    """Be where both pulses' edge is: a bell's, and that of the deck a little later."""
    longer, share = deck_ray(cue, strength)
    at_m = np.linspace(-1.2, 0.4, 81)
    both = np.abs(
        np.exp(-((at_m / WIDE_M) ** 2))
        + share[:, None] * np.exp(-(((at_m - longer[:, None]) / WIDE_M) ** 2))
    )
    moved = _halfway_up(both, at_m) + WIDE_M * np.sqrt(np.log(2.0))
    added = np.abs(1 + share * np.exp(-((longer / 0.8) ** 2)))
    return Change((1.4 * moved).clip(-0.22, 0.3), all_db=20 * np.log10(added.clip(min=0.4)))


def screened_db(longer_m: Floats) -> Floats:
    """Return what a screen takes in dB [n], as noise barriers do (Kurze and Anderson 1971)."""
    turn = np.sqrt(2 * np.pi * 2 * np.maximum(longer_m, 1e-6) / WAVE_M)
    return np.asarray(5 + 20 * np.log10(turn / np.tanh(turn)))


def _under_a_portal(cue: Cue, strength: float) -> Change:
    """Bend below a portal of steel, and follow the boom that is its edge."""
    steel = cue.through("metal")
    part = cue.by_link(lambda n: cue.rng.beta(3.0, 3.0, n).clip(0.15, 0.85))
    below = np.sqrt(strength) * cue.by_link(lambda n: cue.rng.triangular(0.12, 0.28, 0.45, n))
    bent = np.hypot(cue.way * part, below) + np.hypot(cue.way * (1 - part), below) - cue.way
    boom = 0.08 * strength * cue.by_link(lambda n: cue.rng.uniform(0.6, 1.4, n))
    lost = 0.72 * screened_db(bent).clip(max=26.0)
    return Change(steel * (bent + boom).clip(max=0.45), first_db=-steel * lost)


def _ever_less(cue: Cue, strength: float) -> Change:
    """Let through ever less of what is above a level: by an exponential; sum the fewer symbols."""
    over = np.maximum(cue.column("rx_power_dbm") + 90.0, 0.0)
    less = min(0.36 * strength, 0.8) * (over - 6.0 * (1 - np.exp(-over / 6.0)))
    return Change(all_db=-less, sums_db=-1.3 * less)


def _dimmers(cue: Cue, strength: float) -> Change:
    """Hear dimmers, louder at cues that are lit dimly: weak rows scatter."""
    off = np.linalg.norm(cue.post[:, None] - DIMMERS_M, axis=2)
    own = cue.common(6).gamma(4.0, 0.22, CLEATS)[cue.cleat]
    dim = cue.by_cue(lambda n: cue.rng.beta(1.5, 1.5, n))
    db = strength * (own + 4.2 * dim * np.exp(-off / 11.0).sum(axis=1))
    weak = 10 ** (-(cue.column("rx_power_dbm") + 85.0) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Change(0.016 * weak * cue.rng.normal(size=cue.count), hiss_db=db)


def _haze(cue: Cue, strength: float) -> Change:
    return Change(0.06 * strength * np.log1p(cue.column("haze_mg") / 1.4))


def _ballast(cue: Cue, strength: float) -> Change:
    """Hang the lower, the more weight is on: by a power that is nearly a square."""
    return Change(0.18 * strength * (cue.column("ballast_kg") / 450.0) ** 1.8)


def _castors(cue: Cue, strength: float) -> Change:
    """Read long over castors of the revolve, and short between them."""
    return Change(0.055 * strength * np.sin(2 * np.pi * cue.column("rim_m") / CASTOR_M + 1.1))


def _iron_curtain(cue: Cue, strength: float) -> Change:
    """Come by another way as soon as the iron curtain is low enough."""
    return Change(np.where(cue.column("curtain_m") < 3.6, 0.114 * strength, 0.0))


def _velour(cue: Cue, strength: float) -> Change:
    """Come through velour, which is the heavier the damper the air is."""
    return Change(0.0125 * strength * (cue.column("damp_g") - 5.0))


def _follow_spot(cue: Cue, strength: float) -> Change:
    """Be late beside a follow spot's ballast, by one over how far it is."""
    return Change(0.37 * strength / cue.column("spot_m"))


def _rosin(cue: Cue, strength: float) -> Change:
    """Come through rosin, of which no more than so much settles."""
    rosin = cue.column("rosin_mg")
    return Change(0.17 * strength * rosin / (rosin + 10.0))


def _sag(cue: Cue, strength: float) -> Change:
    """Hang lower than bars' ends say, between the lines that these hang by."""
    lower = np.sin(np.pi * (cue.at[:, 0] - 2.0) / LINES_M) ** 2
    lower = SAG_M * strength * cue.flown * lower
    return Change(cue.longer(lower[:, None] * np.array([0.0, 0.0, -1.0])))


def _slips(cue: Cue, strength: float) -> Change:
    """Be turned less than a motor says, as the wheel that drives the revolve slips."""
    course = cue.course
    turned = course["turn_rad"] * done(course, course["into_s"])
    back = -SLIP * strength * turned * (course["arm_m"] > 0)
    out = cue.at[:, :2] - REVOLVE_M
    turn = np.exp(1j * back)[:, None] * (out @ np.array([1.0, 1.0j]))[:, None] * [1.0, -1.0j]
    return Change(cue.longer(np.column_stack([turn.real - out, 0 * back])))


def _rake(cue: Cue, strength: float) -> Change:
    """Be higher up stage than a level plan has it: wagons stand on a rake."""
    higher = RAKE * strength * (1 - cue.flown) * cue.at[:, 1]
    return Change(cue.longer(higher[:, None] * np.array([0.0, 0.0, 1.0])))


def _another_clock(cue: Cue, strength: float) -> Change:
    """Be of another moment than is written, at one cleat: its clock was never set."""
    return Change((cue.cleat == 8) * cue.longer_in(ANOTHER_CLOCK_S * strength))


def _hung(cue: Cue, cleats_m: Floats) -> Change:
    """Return what becomes of rows whose cleats are elsewhere in truth [CLEATS, 3]."""
    longer = cue.longer(0.0, (cleats_m - CLEATS_M)[cue.cleat])
    return Change(longer, all_db=-18.3 * np.log10(1 + longer / cue.way))


def _caught(cue: Cue, strength: float) -> Change:
    there = CLEATS_M.copy()
    there[1] += 0.43 * strength * np.array([6.0, 2.0, -3.0]) / 7
    return _hung(cue, there)


def _mistaken(cue: Cue, _: float) -> Change:
    there = CLEATS_M.copy()
    there[[0, 7]] = CLEATS_M[[7, 0]]
    return _hung(cue, there)


def _varas(cue: Cue, _: float) -> Change:
    """Write, at one cleat, varas of Castile, as its theatre's old plans have it."""
    return Change(np.where(cue.cleat == 5, (1 / VARA_M - 1) * cue.column("range_m"), 0.0))


EFFECTS: dict[str, Callable[[Cue, float], Change]] = {
    "antenna-delay": _adapters,
    "antenna-pattern": _three_in_a_row,
    "blocked-path": _off_the_curtain,
    "clock-offset": _weak_ovens,
    "diffraction": _under_a_portal,
    "exchange-motion": _chebyshev,
    "ground-bounce": _pulled_edge,
    "level-control": _ever_less,
    "material-delay": _packs_of_flats,
    "noise-floor": _dimmers,
    "path-loss": _amid_ropes,
    "power-bias": _fermi,
    "range-rounding": _two_firmwares,
    "range-scale": _reference_clocks,
    "temperature-drift": _bridge,
    "time-lag": _by_the_bus,
    "timestamp-jitter": _student,
    "haze-on-radomes": _haze,
    "bars-ballasted": _ballast,
    "revolve-castors-passed": _castors,
    "iron-curtain-lowered": _iron_curtain,
    "velour-takes-up-damp": _velour,
    "follow-spot-near": _follow_spot,
    "rosin-settles": _rosin,
    "bars-sag-between-lines": _sag,
    "revolve-slips": _slips,
    "rake-forgotten": _rake,
    "one-cleat-of-another-clock": _another_clock,
    "cleat-caught-by-a-flat": _caught,
    "cleats-of-two-sides-mistaken": _mistaken,
    "varas-from-one-cleat": _varas,
}
