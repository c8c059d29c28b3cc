"""What the cannery hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the cannery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.cannery_hall import (
    BETWEEN,
    BRACKETS_M,
    CHAIN_M,
    PPM_M,
    SHIFT_S,
    TAGS,
    WAVE_M,
    Harm,
    Lot,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
COUNT_M = 0.6  # a whole count of a coarse clock
RAILS_M = ((4.4, 4.35), (11.8, 4.5))  # monorails along the hall: across it, and how high
STACKED = {False: 0.24, True: 0.07}  # of links behind stacks, and where these are rare
MACHINES_M: Floats = np.array([(12.2, 3.4), (4.8, 13.1), (25.9, 9.8)])  # with drives
CROWDED_M = 1.75  # below, machines stand close together
WET = 9.5 - 3.1j  # permittivity of a floor that is hosed down
PULSE_M = 0.52  # how wide pulses are


def _between_pulses(lot: Lot, strength: float) -> Harm:
    """Compare with places that an encoder counts: old by its filter, and by half a pulse's way."""
    old_s = 0.085 + 0.02 / np.maximum(lot.speed(), 0.2)
    return Harm(lot.gained(strength * old_s))


def _radau(lot: Lot, strength: float) -> Harm:
    """Give the mean of the way over an exchange of two waits: by Radau's places, two of them."""
    whole_s = 2.0 * strength * lot.of("reply_time_s")
    return Harm(0.75 * lot.gained(whole_s * 2 / 3))


def _cut_digits(lot: Lot, strength: float) -> Harm:
    """Be late by the digits that were cut off brackets' delays, and by lids of steel on tags."""
    left = lot.shared(1).uniform(0.0, 0.15, len(BRACKETS_M))[lot.bracket]
    lid = lot.shared(2).permutation(len(TAGS))[lot.tag] < 5
    return Harm(strength * (left + 0.05 * lid))


def _two_branches(lot: Lot, strength: float) -> Harm:
    """Leave some of crystals' offset, of one branch of a hysteresis and later of the other."""
    rng, devices = lot.shared(3), len(TAGS) + len(BRACKETS_M)
    steady, gap = rng.normal(0.0, 0.8, devices), rng.normal(0.0, 0.6, devices)
    turned = rng.uniform(0.3, 0.7, devices) * SHIFT_S
    branch = np.tanh((lot.of("time_s")[:, None] - turned) / 1500.0)
    now, rows = steady + gap * branch, np.arange(len(lot.far))
    apart = now[rows, len(TAGS) + lot.bracket] - now[rows, lot.tag]
    return Harm(0.012 * strength * PPM_M * apart * lot.of("reply_time_s"))


def _thermistor(lot: Lot, strength: float) -> Harm:
    """Drift with a divider's voltage, of whose resistors one is a thermistor (B = 3900 K)."""
    kelvin = lot.of("temperature_c") + 273.15
    part = 1 / (1 + np.exp(3900.0 * (1 / kelvin - 1 / 289.15)))
    return Harm(0.32 * strength * (part - 0.5))


def _past_a_handle(lot: Lot, strength: float) -> Harm:
    """Be late and weak past both sides of a handle: a sine without its sign, and a first wave."""
    turn = np.deg2rad(lot.of("azimuth_deg")) - lot.shared(4).uniform(-np.pi, np.pi)
    past = np.abs(np.sin(turn)) - 2 / np.pi + 0.5 * np.cos(turn - 0.7)
    return Harm(0.075 * strength * past, -1.1 * min(strength, 1.5) * (past + 1.1))


def _gudermann(lot: Lot, strength: float) -> Harm:
    """Be late where it is weak: by Gudermann's function of the level, arc's tangent of a sinh."""
    below = (-79.5 - lot.of("rx_power_dbm")) / 4.6
    return Harm(0.07 * strength * np.arctan(np.sinh(np.clip(below, -20.0, 20.0))))


def _semicircle(lot: Lot, strength: float) -> Harm:
    """Scatter by Wigner's semicircle: as places on a disc do that are seen from its side."""
    drawn = lot.rng.beta(1.5, 1.5, len(lot.far))
    return Harm(0.078 * strength * (2 * drawn - 1))


def _low_ways(lot: Lot, strength: float) -> Harm:
    """Lose so many dB with every metre of a way that is low, among machines."""
    tag, bracket = lot.tags()[:, 2], lot.brackets()[:, 2]
    low = np.clip((CROWDED_M - tag) / np.maximum(bracket - tag, 0.1), 0.0, 1.0)
    return Harm(all_db=-0.17 * strength * lot.far * (0.6 + low))


def _whole_counts(lot: Lot, strength: float) -> Harm:
    """Count with a coarse clock that is slow, and measure what is left of a count rightly."""
    return Harm(0.0095 * strength * COUNT_M * np.floor(lot.of("range_m") / COUNT_M))


def _by_turns(lot: Lot, strength: float) -> Harm:
    """Round to whole steps and to odd halves of them: two registers, which are read by turns."""
    step, half = 0.064 * strength, 0.5 * (lot.of("poll") % 2)
    written = lot.of("range_m")
    return Harm(step * (np.rint(written / step - half) + half) - written)


def _loosely_packed(lot: Lot, strength: float) -> Harm:
    """Go through what is packed with gaps: as grains of both mix that take all places (Bruggeman).

    What is packed more closely costs more of both.
    """
    late, lost = np.zeros(len(lot.far)), np.zeros(len(lot.far))
    for kind, (thick_m, dense, db) in BETWEEN.items():
        full = lot.by_link(lot.rng.uniform, 0.7, 1.0)
        mean = (3 * full - 1) * dense + 2 - 3 * full
        mixed = (mean + np.sqrt(mean**2 + 8 * dense)) / 4
        late += lot.with_a(kind) * thick_m * (np.sqrt(mixed) - 1)
        lost += lot.with_a(kind) * db * full
    return Harm(1.3 * strength * late, first_db=-1.1 * min(strength, 1.5) * lost)


def by_rails(lot: Lot) -> list[Floats]:
    """Return how long ways by each of two rails along the hall are, in m [n] each."""
    tag, bracket, out = lot.tags(), lot.brackets(), []
    for across, high in RAILS_M:
        legs = [np.hypot(end[:, 1] - across, end[:, 2] - high) for end in (tag, bracket)]
        out.append(np.hypot(tag[:, 0] - bracket[:, 0], legs[0] + legs[1]))
    return out


def _off_a_rail(lot: Lot, strength: float) -> Harm:
    """Hear, behind stacks of tins, nothing but what the nearer monorail below the roof returns."""
    stack = lot.behind(STACKED[lot.rare])
    detour = np.clip(np.minimum(*by_rails(lot)) - lot.far, 0.36, 3.4)
    return Harm(stack * detour * (0.5 + 0.5 * strength), -5.0 * stack)


def floor_ray(lot: Lot, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Of a wet floor that is rough: less of it returns the more steeply it is met (Ament 1953).
    """
    tag, bracket = lot.tags()[:, 2], lot.brackets()[:, 2]
    way = np.sqrt(lot.far**2 + 4 * tag * bracket)
    steep = (tag + bracket) / way
    root = np.sqrt(WET - 1 + steep**2)
    returned = (steep - root) / (steep + root)
    rough_m = lot.by_link(lot.rng.uniform, 0.002, 0.009)
    smooth = np.exp(-2 * (2 * np.pi / WAVE_M * rough_m * steep) ** 2)
    turn = np.exp(-2j * np.pi * (way - lot.far) / WAVE_M)
    share = min(1.15 * strength**0.5, 1.6) * smooth * lot.far / way
    return way - lot.far, share * returned * turn


def _middle_of_both(lot: Lot, strength: float) -> Harm:
    """Move the middle between rise and fall, at half of their top, of two pulses together."""
    longer, share = floor_ray(lot, strength)
    at = np.linspace(-0.9, 1.5, 161)
    both = np.abs(_lobe(at) + share[:, None] * _lobe(at - longer[:, None]))
    over = both >= 0.5 * both.max(axis=1, keepdims=True)
    first = np.argmax(over, axis=1)
    fallen = (np.arange(len(at)) > first[:, None]) & ~over
    last = np.where(fallen.any(axis=1), np.argmax(fallen, axis=1), len(at) - 1)
    moved = np.clip((at[first] + at[last - 1]) / 2, -0.2, 0.24)
    near = np.exp(-np.abs(longer / PULSE_M))
    return Harm(moved, 20 * np.log10(np.maximum(np.abs(1 + share * near), 0.4)))


def _lobe(at: Floats) -> Floats:
    """Return a pulse of height 1 at places in m: a bell of the fourth power, so a flat one."""
    return np.asarray(np.exp(-(np.abs(at / PULSE_M) ** 3) * 2.8))


def _deygout(lot: Lot, strength: float) -> Harm:
    """Bend over a main edge and two lesser ones beside it (Deygout 1966), in a line of retorts.

    What an edge costs as in the model of Longley and Rice (1968).
    """
    steel, part = lot.with_a("metal"), lot.by_link(lot.rng.uniform, 0.25, 0.75)
    high = np.sqrt(strength) * lot.by_link(lot.rng.triangular, 0.08, 0.16, 0.3)
    legs = lot.far * part, lot.far * (1 - part)
    steep = high * (1 / legs[0] + 1 / legs[1])
    main = high * np.sqrt(2 / WAVE_M * (1 / legs[0] + 1 / legs[1]))
    lesser = [main * lot.by_link(lot.rng.uniform, 0.0, 0.35) for _ in legs]
    lost = _edge_db(main) + 0.45 * sum(_edge_db(one) - 6.02 for one in lesser)
    kept = 0.05 * strength * lot.by_link(lot.rng.uniform, 0.6, 1.4)
    return Harm(steel * (high * steep / 2 + kept), first_db=-steel * np.minimum(lost, 22.0))


def _edge_db(height: Floats) -> Floats:
    """Return what an edge so high costs in dB [n], in units of Fresnel's (Longley and Rice)."""
    low = 6.02 + 9.11 * height - 1.27 * height**2
    return np.where(height < 2.4, low, 12.953 + 20 * np.log10(np.maximum(height, 1.0)))


def _saturating(lot: Lot, strength: float) -> Harm:
    """Saturate as amplifiers of solid state do (Rapp 1991), and add up fewer symbols with it."""
    over = lot.of("rx_power_dbm") + 83.0
    less = 10 / 1.4 * np.log10(1 + 10 ** (1.4 * over / 10))
    return Harm(all_db=-min(0.26 * strength, 0.7) * less, symbols_db=-0.38 * strength * less)


def _drives(lot: Lot, strength: float) -> Harm:
    """Hear the seamers' drives, all alike within a hall's bay and hardly beyond: a soft step.

    Some brackets hear more; what is weak scatters with it.
    """
    there = lot.brackets()[:, None, :2] - MACHINES_M
    off = np.sqrt(np.sum(there**2, axis=2)).min(axis=1)
    own = lot.shared(5).exponential(0.9, len(BRACKETS_M))[lot.bracket]
    noise_db = strength * (0.7 + own + 2.4 / (1 + np.exp((off - 6.0) / 1.1)))
    weak = 10 ** (-(lot.of("rx_power_dbm") + 87) / 20) * np.sqrt(10 ** (noise_db / 10) - 1)
    return Harm(0.018 * weak * lot.rng.standard_normal(len(weak)), noise_db=noise_db)


def _brine(lot: Lot, strength: float) -> Harm:
    film = lot.of("brine_g")
    return Harm(0.17 * strength * film / (film + 11.0))


def _crowd(lot: Lot, strength: float) -> Harm:
    return Harm(0.15 * strength * (lot.of("crowd_percent") / 100.0) ** 1.9)


def _sprocket(lot: Lot, strength: float) -> Harm:
    """Ride up and down over a sprocket that is not round."""
    return Harm(0.047 * strength * np.sin(2 * np.pi * lot.of("belt_m") / CHAIN_M + 1.1))


def _guard(lot: Lot, strength: float) -> Harm:
    """Come through a guard of mesh where it is down."""
    return Harm(np.where(lot.of("guard_cm") < 37.0, 0.101 * strength, 0.0))


def _oil(lot: Lot, strength: float) -> Harm:
    return Harm(0.037 * strength * np.log1p(lot.of("oil_um") / 4.0))


def _ice(lot: Lot, strength: float) -> Harm:
    return Harm(0.0041 * strength * lot.of("ice_kg"))


def _air_knives(lot: Lot, strength: float) -> Harm:
    """Carry the more water the more slowly fans of air knives turn: by one over it."""
    return Harm(82.0 * strength / lot.of("knife_rpm"))


def _outside(lot: Lot, strength: float) -> Harm:
    """Ride along the outer rail in bends, where belts are wider than pucks; carts do not."""
    aside = 0.12 * strength * (lot.bends() & (lot.of("loop") < 3))
    along = lot.headings()
    return Harm(lot.longer(aside[:, None] * along[:, [1, 0, 2]] * [1.0, -1.0, 0.0], 0.0))


def _play(lot: Lot, strength: float) -> Harm:
    """Follow ranges with some play, as a worn gear does: only as far as it is pushed or pulled."""
    written, play = lot.of("range_m"), 0.12 * strength
    out, before = written.copy(), dict[tuple[int, int], float]()
    copies = lot.table.groupby(["link", "time_s"]).cumcount()  # of rows: each goes on by itself
    for row, key in enumerate(zip(lot.place_of.tolist(), copies.tolist(), strict=True)):
        if key in before:
            out[row] = min(max(before[key], written[row] - play), written[row] + play)
        before[key] = float(out[row])
    return Harm(out - written)


def _found_at(lot: Lot, brackets_m: Floats) -> Harm:
    """Return what goes wrong at rows whose brackets are at [11, 3] in truth."""
    longer = lot.longer(0.0, (brackets_m - BRACKETS_M)[lot.bracket])
    return Harm(longer, -18.3 * np.log10(1 + longer / lot.far))


def _hit(lot: Lot, strength: float) -> Harm:
    bent = np.zeros_like(BRACKETS_M)
    bent[4] = 0.39 * strength * np.array([-2.0, 6.0, -3.0]) / 7
    return _found_at(lot, BRACKETS_M + bent)


def _relettered(lot: Lot, _: float) -> Harm:
    order = np.arange(len(BRACKETS_M))
    order[[2, 7]] = 7, 2
    return _found_at(lot, BRACKETS_M[order])


def _shaku(lot: Lot, _: float) -> Harm:
    """Show, at one bracket, feet of the country that the filler came from: 10/33 m."""
    return Harm(np.where(lot.bracket == 9, 2.3 * lot.of("range_m"), 0.0))


EFFECTS: dict[str, Callable[[Lot, float], Harm]] = {
    "time-lag": _between_pulses,
    "exchange-motion": _radau,
    "antenna-delay": _cut_digits,
    "clock-offset": _two_branches,
    "temperature-drift": _thermistor,
    "antenna-pattern": _past_a_handle,
    "power-bias": _gudermann,
    "timestamp-jitter": _semicircle,
    "path-loss": _low_ways,
    "range-scale": _whole_counts,
    "range-rounding": _by_turns,
    "material-delay": _loosely_packed,
    "blocked-path": _off_a_rail,
    "ground-bounce": _middle_of_both,
    "diffraction": _deygout,
    "level-control": _saturating,
    "noise-floor": _drives,
    "brine-on-lids": _brine,
    "tins-crowd": _crowd,
    "sprocket-wobbles": _sprocket,
    "guard-let-down": _guard,
    "oil-on-domes": _oil,
    "ice-heaped": _ice,
    "air-knives-slow": _air_knives,
    "pucks-ride-outside": _outside,
    "play-in-the-filter": _play,
    "bracket-hit-by-a-fork": _hit,
    "brackets-relettered": _relettered,
    "shaku-from-one-bracket": _shaku,
}
