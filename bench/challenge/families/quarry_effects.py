"""What the quarry hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the quarry's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.quarry_pit import (
    A_PPM,
    BENCH_M,
    CHAIN_LINK_M,
    DIGGERS,
    FACE_Y_M,
    GENERATOR_M,
    MASTS_M,
    SHIFT_S,
    STONE,
    WAVE_M,
    Load,
    Spoil,
)

Floats = NDArray[np.float64]
ROUGH_M = 0.035  # how rock scatters about a plane
LAGUERRE = ((0.853553, 0.585786), (0.146447, 3.414214))  # weights and places of two


def _smoothed_truth(spoil: Spoil, strength: float) -> Load:
    """Compare with satellites' places behind a filter that forgets by and by: Laguerre's two."""
    forgets = 0.15 * strength
    return Load(sum((w * spoil.apart(forgets * place) for w, place in LAGUERRE), spoil.away * 0))


def _last_message(spoil: Spoil, strength: float) -> Load:
    """Measure the way of the last message, most of a reply later than the first is stamped."""
    return Load(spoil.apart(0.8 * min(strength, 2.0) * spoil("reply_time_s")))


def _arresters(spoil: Spoil, strength: float) -> Load:
    """Lead through arresters of lightning at every other mast, and cables as long as masts."""
    rng = spoil.bedded(1)
    arrester = 0.06 * (rng.permutation(len(MASTS_M)) % 2) + 0.008 * MASTS_M[:, 2]
    tag = rng.rayleigh(0.045, DIGGERS)
    return Load(strength * (arrester[spoil.mast] + tag[spoil.digger]))


def _one_way(spoil: Spoil, strength: float) -> Load:
    """Correct crystals' offset by what it was at the works: what has aged since is left."""
    rng = spoil.bedded(2)
    aged = (
        rng.gamma(2.0, 0.9, len(MASTS_M))[spoil.mast] - rng.gamma(2.0, 1.1, DIGGERS)[spoil.digger]
    )
    return Load(0.018 * strength * A_PPM * aged * spoil("reply_time_s"))


def _cold(spoil: Spoil, strength: float) -> Load:
    """Drift little in warmth and much in frost: a hinge, rounded, at which a heater gives up."""
    cold = 3.0 * np.logaddexp(0.0, (6.0 - spoil("temperature_c")) / 3.0)
    return Load(strength * (0.016 * cold - 0.0013 * (spoil("temperature_c") - 14.0)))


def _cab(spoil: Spoil, strength: float) -> Load:
    """Be late behind the cab and early along the boom, and a little in three directions."""
    turn = np.radians(spoil("azimuth_deg")) - spoil.bedded(3).uniform(0, 2 * np.pi)
    lobes = 0.07 * np.cos(turn) + 0.022 * np.cos(3 * turn)
    return Load(strength * lobes, whole=-1.6 * min(strength, 1.6) * (1 + np.cos(turn)))


def _knees(spoil: Spoil, strength: float) -> Load:
    """Be biased by the level between two knees: Hermite's cubic from one to the other."""
    part = np.clip((-64.0 - spoil("rx_power_dbm")) / 32.0, 0, 1)
    return Load(strength * (0.17 * part**2 * (3 - 2 * part) - 0.085))


def _either_edge(spoil: Spoil, strength: float) -> Load:
    """Count on the rising edge of a clock, or on the falling one."""
    either = spoil.rng.integers(0, 2, len(spoil.table)) - 0.5
    return Load(np.asarray(0.086 * strength * either, np.float64))


def _two_slopes(spoil: Spoil, strength: float) -> Load:
    """Lose more than in the open from where rock grazes the first zone of Fresnel."""
    beyond = np.log10(np.maximum(spoil.away / 8.0, 1.0))
    return Load(0 * beyond, whole=-strength * (0.5 + 5.5 * beyond))


def _crystal_rate(spoil: Spoil, strength: float) -> Load:
    """Count with a fast clock, beginning at the connector of a cable."""
    return Load(0.0046 * strength * (spoil("range_m") + 1.3))


def _mantissa(spoil: Spoil, strength: float) -> Load:
    """Send floating words with so short a mantissa that far ranges have coarser steps."""
    step = 0.0075 * strength * np.exp2(np.floor(np.log2(np.maximum(spoil("range_m"), 1.0))))
    return Load(step * np.rint(spoil("range_m") / step) - spoil("range_m"))


def _blocks(spoil: Spoil, strength: float) -> Load:
    """Go through slabs that lie flat to the way in the map, and are met from above."""
    down = np.square(np.minimum((spoil("rx_z_m") - spoil("tx_z_m")) / spoil.away, 0.7))
    late, lost = 0.0 * down, 0.0 * down
    for kind, (thick, permittivity, db) in STONE.items():
        many = spoil.met(kind) * spoil.link(lambda n: 0.7 + 0.6 * spoil.rng.beta(2, 2, n))
        late = late + many * thick * (np.sqrt(permittivity - down) - np.sqrt(1 - down))
        lost = lost + many * db
    return Load(1.4 * strength * late, edge=-min(strength, 1.5) * lost)


def _by_the_face(spoil: Spoil, strength: float) -> Load:
    """Hear, behind heaps of spoil, nothing but what the face of rock returns, or a ledge of it."""
    share = 0.055 if spoil.scant else 0.17
    heap = spoil.link(lambda n: (spoil.rng.random(n) < share).astype(np.float64))
    mirrored = spoil.booms()
    mirrored[:, 1] = 2 * FACE_Y_M - mirrored[:, 1]
    way = np.linalg.norm(mirrored - spoil.tops, axis=1)
    ledge = spoil.link(lambda n: spoil.rng.uniform(0.04, 0.16, n))  # most have a nearer one
    detour = np.clip(ledge * (way - spoil.away), 0.3, 5.0)
    return Load(heap * detour * (0.45 + 0.55 * strength), whole=-5.5 * heap)


def rock_ray(spoil: Spoil, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the ground is in m, and its share, [n] each.

    Rough rock returns exp(-2 (k s sin)^2) of what a plane would (Ament 1953, Proc. IRE 41).
    """
    ground = np.where(spoil("tx_z_m") > 6.9, BENCH_M, 0.0)
    drop = spoil("tx_z_m") + spoil("rx_z_m") - 2 * ground
    rise = spoil("rx_z_m") - spoil("tx_z_m")
    way = np.sqrt(np.square(spoil.away) - rise**2 + drop**2)
    rough = np.exp(-2 * np.square(2 * np.pi / WAVE_M * ROUGH_M * drop / way))
    bare = spoil.link(lambda n: spoil.rng.uniform(0.6, 1.0, n))
    return way - spoil.away, min(1.1 * strength**0.5, 1.5) * bare * rough * spoil.away / way


def _rock(spoil: Spoil, strength: float) -> Load:
    """Cross a level sooner where the ground adds to an edge, later where it takes away."""
    longer, share = rock_ray(spoil, strength)
    met = share / (1 + (longer / 0.85) ** 4)
    both = np.maximum(np.abs(1 - met * np.exp(-2j * np.pi * longer / WAVE_M)), 0.35)
    return Load(0.21 * (1 / both - 1) * (both < 1) - 0.1 * np.maximum(both - 1, 0),
                whole=20 * np.log10(both))  # fmt: skip


def _over_a_skip(spoil: Spoil, strength: float) -> Load:
    """Bend over a dumper's skip, whose edge is round: 6.4 dB + 20 lg(v + sqrt(v^2 + 1)), and more.

    The part without the rounding is that of CCIR Report 567.
    """
    steel = spoil.met("metal")
    high = strength**0.5 * spoil.link(lambda n: spoil.rng.gamma(4.0, 0.06, n))
    near = spoil.link(lambda n: spoil.rng.uniform(0.15, 0.85, n)) * spoil.away
    rest = spoil.away - near
    over = np.hypot(near, high) + np.hypot(rest, high) - spoil.away
    v = high * np.sqrt(2 / WAVE_M * (1 / near + 1 / rest))
    db = 6.4 + 20 * np.log10(v + np.sqrt(v**2 + 1)) + 0.8 * np.minimum(v, 2.0)
    creeps = 0.055 * strength * spoil.link(lambda n: spoil.rng.triangular(0.7, 1.0, 1.3, n))
    return Load(steel * (over + creeps), edge=-steel * np.minimum(db, 13.5))


def _servo(spoil: Spoil, strength: float) -> Load:
    """Turn gain down by a servo, whose course is a power of what is too much."""
    over = np.clip((spoil("rx_power_dbm") + 95) / 9, 0, 2.6) ** 1.4
    return Load(0 * over, whole=-0.75 * min(strength, 2.0) * over, count=-0.8 * strength * over)


def _ignition(spoil: Spoil, strength: float) -> Load:
    """Hear a generator's ignition, the more the nearer a mast is to it."""
    far = np.linalg.norm(MASTS_M[:, :2] - GENERATOR_M, axis=1)
    near = 5.2 / (1 + far / 22.0) * spoil.bedded(4).uniform(0.7, 1.3, len(MASTS_M))
    hiss = strength * near[spoil.mast]
    weak = 10 ** (-(spoil("rx_power_dbm") + 87) / 20) * np.sqrt(np.power(10, hiss / 10) - 1)
    return Load(0.02 * weak * spoil.rng.normal(0, 1, len(hiss)), hiss=hiss)


def _dust(spoil: Spoil, strength: float) -> Load:
    """Charge what is blown about: clouds of it on radomes grow faster than the dust."""
    return Load(0.0026 * strength * spoil("dust_mg") ** 1.9)


def _sump(spoil: Spoil, strength: float) -> Load:
    return Load(0.078 * strength * np.cos(2 * np.pi * (spoil("time_s") + 57.0) / 470.0))


def _laden(spoil: Spoil, strength: float) -> Load:
    return Load(0.036 * strength * spoil("bucket_t"))


def _settles(spoil: Spoil, strength: float) -> Load:
    """Lean, with ground that has been shaken, by what is left of it since the blast."""
    return Load(1.15 * strength / spoil("minutes_since_blast"))


def _mud(spoil: Spoil, strength: float) -> Load:
    return Load(0.24 * strength * np.tanh(spoil("mud_mm") / 9.0))


def _puddles(spoil: Spoil, strength: float) -> Load:
    return Load(0.072 * strength * np.log1p(spoil("rain_mm") / 1.5))


def _hunts(spoil: Spoil, strength: float) -> Load:
    """Fall back to an oscillator of the radio while the generator's is too slow."""
    return Load(np.where(spoil("supply_hz") < 49.45, 0.135, 0.0) * strength)


def _stands(spoil: Spoil, tops: Floats) -> Load:
    """Return what is loaded on rows whose masts truly end at [n, 3]."""
    truly = np.linalg.norm(spoil.booms() - tops, axis=1)
    return Load(truly - spoil.away, whole=19.8 * np.log10(spoil.away / truly))


def _lean(spoil: Spoil, strength: float) -> Load:
    """Lean from where masts stood at the begin of a shift, each as its stays give way."""
    rng = spoil.bedded(5)
    lean = rng.gamma(1.5, 0.16, len(MASTS_M)) * np.exp(2j * np.pi * rng.random(len(MASTS_M)))
    leans = strength * lean[spoil.mast] * spoil("time_s") / SHIFT_S
    return _stands(spoil, spoil.tops + np.stack([leans.real, leans.imag, 0 * leans.real], axis=1))


def _not_lowered(spoil: Spoil, strength: float) -> Load:
    """Take booms to be as low as at the last halt, while in some spells they are raised."""
    spell = spoil.table["link"].str.extract(r"spell (\d+)")[0].astype(np.intp).to_numpy()
    raised = 1.1 * strength * (spoil.bedded(6).random(64) < 0.4)[spell]
    truly = np.linalg.norm(spoil.booms() + raised[:, None] * [0, 0, 1.0] - spoil.tops, axis=1)
    return Load(truly - spoil.away)


def _datums(spoil: Spoil, strength: float) -> Load:
    """Mix heights of two datums: masts on the bench were surveyed from another mark."""
    off = 0.55 * strength * (MASTS_M[:, 2] > 8)
    return _stands(spoil, spoil.tops + off[spoil.mast][:, None] * np.array([0, 0, 1.0]))


def _by_exception(spoil: Spoil, strength: float) -> Load:
    """Report a range only where it is off what was reported by a band; else that once more."""
    written, when = spoil("range_m"), spoil("time_s")
    number, links = spoil.table["link"].factorize()
    told, at = np.full(links.size, np.nan), np.full(links.size, np.inf)
    out = written.copy()
    for row, link in enumerate(number):
        if when[row] > at[link] and abs(written[row] - told[link]) < 0.3 * strength:
            out[row] = told[link]
        told[link], at[link] = out[row], when[row]
    return Load(out - written)


def _hauled(spoil: Spoil, strength: float) -> Load:
    aside = np.where(spoil.mast == 5, strength, 0.0)[:, None] * np.array([0.42, 0.32, -0.2159])
    return _stands(spoil, spoil.tops + aside)


def _for_each_other(spoil: Spoil, _: float) -> Load:
    other = {2: 6, 6: 2}
    return _stands(spoil, MASTS_M[[other.get(one, one) for one in spoil.mast.tolist()]])


def _chain_links(spoil: Spoil, _: float) -> Load:
    """Survey by the chain, as old plans of the quarry are drawn: its links stand for metres."""
    return Load((1 / CHAIN_LINK_M - 1) * np.where(spoil.mast == 3, spoil("range_m"), 0.0))


EFFECTS: dict[str, Callable[[Spoil, float], Load]] = {
    "time-lag": _smoothed_truth,
    "exchange-motion": _last_message,
    "antenna-delay": _arresters,
    "clock-offset": _one_way,
    "temperature-drift": _cold,
    "antenna-pattern": _cab,
    "power-bias": _knees,
    "timestamp-jitter": _either_edge,
    "path-loss": _two_slopes,
    "range-scale": _crystal_rate,
    "range-rounding": _mantissa,
    "material-delay": _blocks,
    "blocked-path": _by_the_face,
    "ground-bounce": _rock,
    "diffraction": _over_a_skip,
    "level-control": _servo,
    "noise-floor": _ignition,
    "dust-cloud": _dust,
    "sump-pumped": _sump,
    "bucket-laden": _laden,
    "rock-settles": _settles,
    "mud-on-domes": _mud,
    "puddles-spread": _puddles,
    "generator-hunts": _hunts,
    "stays-slacken": _lean,
    "boom-not-lowered": _not_lowered,
    "heights-of-two-datums": _datums,
    "reports-by-exception": _by_exception,
    "mast-hauled-aside": _hauled,
    "masts-taken-for-each-other": _for_each_other,
    "chain-links-from-one-mast": _chain_links,
}
