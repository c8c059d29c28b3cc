"""What the foundry hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the foundry's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.foundry_bay import (
    BLAST_S,
    CARRIER_M,
    COLUMNS_M,
    CRANES,
    CUBIT_M,
    FURNACES_M,
    GIRDER_M,
    HUNG,
    METRES_PER_PPM_S,
    STACKS,
    Flaw,
    Pour,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
PULSE_M = 1.57  # a raised cosine, from end to end
GRAIN_M = 0.006  # how uneven sand is
DRY, WATER = 2.7, 80.0  # permittivities
SHADED = {False: 0.17, True: 0.05}  # of links behind charging buckets, and where these are rare


def _scanned(pour: Pour, strength: float) -> Flaw:
    """Compare with places that a controller holds until its next scan, one cycle after another."""
    held_s = (pour.get("time_s") + pour.lasting(1).uniform(0, 0.08)) % 0.08
    return Flaw(pour.longer(strength * (0.08 + held_s)))


def _three_messages(pour: Pour, strength: float) -> Flaw:
    """Give the mean of a symmetric exchange: its second message counts as much as both others."""
    wait_s = 1.1 * min(strength, 2.0) * pour.get("reply_time_s")
    return Flaw(0.5 * pour.longer(wait_s) + 0.25 * pour.longer(2 * wait_s))


def _chained(pour: Pour, strength: float) -> Flaw:
    """Be later from one repeater of the clock's chain to the next; hooks' cables wear."""
    chain = 0.016 + 0.021 * pour.lasting(2).permutation(HUNG)
    worn = 0.03 + 0.07 * pour.lasting(3).beta(1.5, 1.5, CRANES)
    own = np.concatenate([chain, worn])
    return Flaw(strength * (own[pour.ear] + own[pour.mouth]))


def _ageing(pour: Pour, strength: float) -> Flaw:
    """Leave some of crystals' offset, which goes by the logarithm of how long they have been on."""
    rng, devices = pour.lasting(4), HUNG + CRANES
    at_first, ages = rng.normal(0, 0.7, devices), rng.normal(0, 0.4, devices)
    for_long = np.log1p(pour.get("time_s") / 700.0)
    apart = (at_first[pour.ear] - at_first[pour.mouth]) + for_long * (
        ages[pour.ear] - ages[pour.mouth]
    )
    return Flaw(0.012 * strength * METRES_PER_PPM_S * apart * pour.get("reply_time_s"))


def _heated(pour: Pour, strength: float) -> Flaw:
    """Stay as calibrated while a heater holds 22 degrees C, and drift by a line in hotter air."""
    return Flaw(0.0042 * strength * np.maximum(pour.get("temperature_c") - 22.0, 0.0))


def _bail(pour: Pour, strength: float) -> Flaw:
    """Be late past the bail of a ladle, and weak: by a line to and by a line from it."""
    turn = pour.get("azimuth_deg") + 360 * pour.lasting(5).random()
    beside = np.abs((turn % 360) - 180) / 90 - 1  # from -1 to 1
    return Flaw(0.075 * strength * beside, all_db=-1.1 * min(strength, 1.5) * (1 + beside))


def _arc_tangent(pour: Pour, strength: float) -> Flaw:
    """Be late where it is weak: by an arc's tangent of the level."""
    below = (-81.0 - pour.get("rx_power_dbm")) / 4.0
    return Flaw(0.067 * strength * np.arctan(below))


def _hum(pour: Pour, strength: float) -> Flaw:
    """Tremble with a loop that mains modulate: by a sine of a phase that nobody knows."""
    return Flaw(0.085 * strength * np.sin(2 * np.pi * pour.rng.random(len(pour.way))))


def _beyond(pour: Pour, strength: float) -> Flaw:
    """Lose more from 9 m on, past what stands about: by another exponent there."""
    return Flaw(0 * pour.way, all_db=-7.5 * strength * np.log10(np.maximum(pour.way / 9.0, 1)))


def _own_beats(pour: Pour, strength: float) -> Flaw:
    """Count ways by hooks' own beats, which are slow, some more."""
    slow = 0.0048 * pour.lasting(6).uniform(0.5, 1.5, CRANES)
    return Flaw(strength * slow[pour.mouth - HUNG] * pour.get("range_m"))


def _short_words(pour: Pour, strength: float) -> Flaw:
    """Keep numbers of eight bits behind the leading one's place: the farther the coarser."""
    written = pour.get("range_m")
    octave = np.exp2(np.floor(np.log2(np.maximum(written, 0.5))))
    step = strength * octave / 128.0
    return Flaw(step * np.rint(written / step) - written)


def _aslant(pour: Pour, strength: float) -> Flaw:
    """Go through linings and stacks that stand across or along the bay: aslant, by Snell's law."""
    level = np.abs(pour.place("rx") - pour.place("tx"))
    across = np.maximum(level[:, 0], level[:, 1]) / np.maximum(np.linalg.norm(level, axis=1), 1e-9)
    late, lost = np.zeros((2, len(pour.way)))
    for kind, (thick_m, dense, db) in STACKS.items():
        inside = np.sqrt(1 - (1 - across**2) / dense)  # cosine of the angle of refraction
        longer = thick_m * (np.sqrt(dense) * inside - across) / across**0.3
        late, lost = late + pour.has(kind) * longer, lost + pour.has(kind) * db / inside
    return Flaw(1.2 * strength * late, edge_db=-min(strength, 1.5) * lost)


def girder_way(pour: Pour) -> Floats:
    """Return how long ways by the lower sides of bridges are, in m [n]: by images above them."""
    below = [GIRDER_M - pour.place(end)[:, 2] for end in ("tx", "rx")]
    return np.asarray(np.sqrt(pour.way**2 + 4 * below[0] * below[1]))


def _by_the_girder(pour: Pour, strength: float) -> Flaw:
    """Hear, behind charging buckets, nothing but what a bridge above returns."""
    shaded = pour.some_links(SHADED[pour.scarce])
    detour = np.clip(girder_way(pour) - pour.way, 0.36, 3.7)
    return Flaw(shaded * detour * (0.42 + 0.58 * strength), all_db=-5.5 * shaded)


def sand_ray(pour: Pour, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the sand is in m, and its complex share, [n] each.

    Fresnel's coefficient of upright waves; what sand holds of water adds to the index by volume
    (Birchak 1974), and grains scatter some of it.
    """
    low, high = pour.place("tx")[:, 2], pour.place("rx")[:, 2]
    way = np.sqrt(pour.way**2 + 4 * low * high)
    moist = 0.016 * pour.get("sand_percent")
    dense = np.square((1 - moist) * np.sqrt(DRY) + moist * np.sqrt(WATER))
    steep = (low + high) / way
    bent = np.sqrt(dense - 1 + steep**2)
    size = (dense * steep - bent) / (dense * steep + bent)
    size = size * np.exp(-0.5 * (4 * np.pi * GRAIN_M * steep / CARRIER_M) ** 2)
    turn = np.exp(-2j * np.pi * (way - pour.way) / CARRIER_M)
    return way - pour.way, min(1.7 * strength**0.5, 2.4) * size * pour.way / way * turn


def _raised(place: Floats) -> Floats:
    """Return a pulse of height 1 at places in m."""
    return np.where(
        np.abs(place) < PULSE_M / 2, np.cos(np.pi * np.clip(place / PULSE_M, -0.5, 0.5)) ** 2, 0.0
    )


def _sand(pour: Pour, strength: float) -> Flaw:
    """Move the first top of two pulses together."""
    longer, share = sand_ray(pour, strength)
    place = np.linspace(-0.5, 0.5, 101)
    both = np.abs(_raised(place) + share[:, None] * _raised(place - longer[:, None]))
    falls = (both[:, 1:-1] >= both[:, :-2]) & (both[:, 1:-1] > both[:, 2:])
    found = np.where(falls.any(axis=1), 1 + falls.argmax(axis=1), 50)
    top = both[np.arange(len(found)), found]
    return Flaw(np.clip(place[found], -0.3, 0.3), all_db=20 * np.log10(np.maximum(top, 0.45)))


def _round_flasks(pour: Pour, strength: float) -> Flaw:
    """Come by both sides of a pile of flasks: arcs' tangents, as 3GPP has it (TR 38.901, 7.6.4)."""
    steel = pour.has("metal")
    one = pour.way * pour.for_links(lambda n: pour.rng.uniform(0.25, 0.75, n))
    deep = [strength**0.5 * pour.for_links(lambda n: pour.rng.uniform(0.2, 0.6, n)) for _ in "ab"]
    longer = [np.hypot(one, a) + np.hypot(pour.way - one, a) - pour.way for a in deep]
    sides = [np.arctan(np.pi / 2 * np.sqrt(np.pi / CARRIER_M * x)) / np.pi for x in longer]
    db = np.clip(-20 * np.log10(np.maximum(1 - sides[0] - sides[1], 0.05)), 0.5, 10.0)
    rough = 0.05 * strength * pour.for_links(lambda n: pour.rng.uniform(0.7, 1.4, n))
    return Flaw(steel * (np.minimum(*longer).clip(max=0.35) + rough), edge_db=-steel * db)


def _pads(pour: Pour, strength: float) -> Flaw:
    """Turn gain down by pads, one more every 5 dB; each takes symbols too."""
    pads = np.floor(np.clip(pour.get("rx_power_dbm") + 97.0, 0.0, 32.0) / 5.0)
    return Flaw(0 * pads, all_db=-0.8 * min(strength, 2.2) * pads, count_db=-1.5 * strength * pads)


def _furnaces(pour: Pour, strength: float) -> Flaw:
    """Hear coils of induction furnaces: by one over the square of how far they are."""
    apart = pour.place("rx")[:, None, :2] - FURNACES_M
    near = np.sum(1 / (1 + np.sum(apart**2, axis=2) / 110.0), axis=1)
    hears = pour.lasting(7).uniform(0.85, 1.15, HUNG + CRANES)[pour.ear]
    hiss = strength * hears * (0.5 + 3.4 * near)
    weak = 10 ** (-(pour.get("rx_power_dbm") + 92) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Flaw(0.021 * weak * pour.rng.normal(size=len(weak)), noise_db=hiss)


def _slag(pour: Pour, strength: float) -> Flaw:
    return Flaw(0.14 * strength * -np.expm1(-pour.get("slag_mm") / 5.5))


def _lining(pour: Pour, strength: float) -> Flaw:
    return Flaw(0.155 * strength * (pour.get("lining_c") / 1100.0) ** 2.2)


def _blaster(pour: Pour, strength: float) -> Flaw:
    turn = 2 * np.pi * pour.get("time_s") / BLAST_S
    return Flaw(0.058 * strength * np.sin(turn + 0.9))


def _magnet(pour: Pour, strength: float) -> Flaw:
    """Read short while a magnet is on: its field saturates the isolator."""
    return Flaw(np.where(pour.get("magnet_a") > 55.0, -0.097 * strength, 0.0))


def _graphite(pour: Pour, strength: float) -> Flaw:
    return Flaw(0.062 * strength * np.log1p(pour.get("graphite_g") / 3.4))


def _dries(pour: Pour, strength: float) -> Flaw:
    return Flaw(-0.029 * strength * pour.get("sand_percent"))


def _domes(pour: Pour, strength: float) -> Flaw:
    """Load antennas by covers of iron close to their domes: by one over the gap."""
    return Flaw(0.34 * strength / pour.get("gap_mm"))


def _swing_less(pour: Pour, strength: float) -> Flaw:
    """Swing less than the model of the crane has it, from which places were taken."""
    return Flaw(pour.longer(0.0, 1 - 0.4 * strength))


def _braking(pour: Pour, strength: float) -> Flaw:
    """Take off, of what comes closer, the way that it takes to brake: a guard left on."""
    closer = np.maximum(-pour.longer(0.05) / 0.05, 0.0)
    return Flaw(-strength * closer**2 / (2 * 2.4))


def _truly_on(pour: Pour, columns_m: Floats) -> Flaw:
    """Return what is wrong with rows whose columns have their antennas at [9, 3] in truth."""
    column = pour.ear < HUNG
    off = np.where(column[:, None], (columns_m - COLUMNS_M)[pour.ear % HUNG], 0.0)
    truly = np.linalg.norm(pour.place("rx") + off - pour.place("tx"), axis=1)
    return Flaw(np.where(column, truly - pour.way, 0.0), all_db=17.6 * np.log10(pour.way / truly))


def _backed_into(pour: Pour, strength: float) -> Flaw:
    off = np.zeros((HUNG, 3))
    off[3] = 0.47 * strength * np.array([-6.0, 2.0, -3.0]) / 7
    return _truly_on(pour, COLUMNS_M + off)


def _crosswired(pour: Pour, _: float) -> Flaw:
    return _truly_on(pour, COLUMNS_M[[5, 1, 2, 3, 4, 0, 6, 7, 8]])


def _cubits(pour: Pour, _: float) -> Flaw:
    """Show cubits, at one column, whose display the apprentices set."""
    return Flaw(np.where(pour.ear == 6, (1 / CUBIT_M - 1) * pour.get("range_m"), 0.0))


EFFECTS: dict[str, Callable[[Pour, float], Flaw]] = {
    "time-lag": _scanned,
    "exchange-motion": _three_messages,
    "antenna-delay": _chained,
    "clock-offset": _ageing,
    "temperature-drift": _heated,
    "antenna-pattern": _bail,
    "power-bias": _arc_tangent,
    "timestamp-jitter": _hum,
    "path-loss": _beyond,
    "range-scale": _own_beats,
    "range-rounding": _short_words,
    "material-delay": _aslant,
    "blocked-path": _by_the_girder,
    "ground-bounce": _sand,
    "diffraction": _round_flasks,
    "level-control": _pads,
    "noise-floor": _furnaces,
    "slag-crusts": _slag,
    "lining-heats": _lining,
    "shot-blaster-cycles": _blaster,
    "magnet-energised": _magnet,
    "graphite-settles": _graphite,
    "sand-dries": _dries,
    "covers-touch-domes": _domes,
    "hooks-swing-less": _swing_less,
    "braking-way-taken-off": _braking,
    "column-backed-into": _backed_into,
    "columns-crosswired": _crosswired,
    "cubits-from-one-column": _cubits,
}
