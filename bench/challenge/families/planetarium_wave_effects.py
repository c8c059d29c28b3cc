"""What the planetarium hides in waveforms: effects in forms of its own, its almanacs' oddities.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.planetarium_almanac import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Almanac,
    brights,
    set_later,
    starlight,
)
from bench.challenge.families.planetarium_dome import COVES, MIDDLE_M, RADIUS_M, Seating
from bench.challenge.families.planetarium_dome import LAWS as LAWS_OF_ROWS
from bench.challenge.families.planetarium_effects import EFFECTS, off_the_carpet

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
OF_LATE_SIZES = (
    "late-sizes-told-as-magnitudes-of-stars", "late-half-shown-before-the-other",
    "late-sizes-held-from-fibonacci-on",
)  # fmt: skip
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "sazhens-from-one-cove"}
LAWS |= {name: Law() for name in OF_LATE_SIZES}
LATE = 7.8  # samples past first paths from which almanacs are odd
DOME, WALL, TABLE, SCREEN, NEXT = 0.95, 0.7, 0.7, 0.75, 4.2  # shares; samples from which heard
SCREENS_M = (10.9, 6.5)  # how far off the middle screens hang; how far they reach to either side
TABLE_M = (0.6, 3.4)  # how high the orrery's table is, how far it reaches
TURNS: Floats = np.linspace(0.0, 2 * np.pi, 480, endpoint=False)
WAYS, SPAN, SWELLS = 9, 21.0, 4.5  # about what hides; samples over which; samples to the most
KNOTS, SECOND, SPREAD = 7, 0.8, 0.45  # samples between fades; the other wave; what else there is
SOON, LONG, SHARE = 6.0, 27.0, 0.8  # samples to 1 / e of either room; of what is near
TAIL, BEGINS = 0.05, 3.4  # height of tails; samples until these begin
CABLE, BACK, TIMES = 5.3, 0.62, 7  # samples there and back; of it comes again; how often
PITCHES, WOBBLES, DEPTH = (-0.9, -0.3), (0.03, 0.09), 1.3  # radians a sample; of these; radians
ON = 5  # samples that sizes are compared over
CLASS = 100 ** (1 / 5)  # of stars' sizes (Pogson 1856)
SOME: Complexes = starlight(np.random.default_rng(5207), 170)  # noise to try readings on


def by_the_dome(seating: Seating) -> tuple[Floats, Floats]:
    """Return ways in m by the dome's far side, and 1 where there is one, [n] each.

    It is in the plane of both ends and the middle: the longest of all by that great circle.
    """
    one, other = seating.tag_m - MIDDLE_M, seating.cove_m - MIDDLE_M
    east = other / np.linalg.norm(other, axis=1, keepdims=True)
    north = one - (one * east).sum(axis=1, keepdims=True) * east
    north = north / np.linalg.norm(north, axis=1, keepdims=True).clip(1e-9)
    turns = np.cos(TURNS)[:, None, None] * east + np.sin(TURNS)[:, None, None] * north
    way = sum(np.linalg.norm(RADIUS_M * turns - end, axis=2) for end in (one, other))
    most, all_ = np.asarray(way).argmax(axis=0), np.arange(seating.rows)
    return np.asarray(way)[most, all_], (turns[most, all_, 2] > 0).astype(np.float64)


def by_the_wall(seating: Seating) -> tuple[Floats, Floats]:
    """Return ways in m by the upright wall's far side, and 1 where there is one, [n] each."""
    flat = RADIUS_M * np.stack([np.cos(TURNS), np.sin(TURNS)], axis=1)[:, None]
    legs = [np.linalg.norm(flat - (end - MIDDLE_M)[:, :2], axis=2)
            for end in (seating.tag_m, seating.cove_m)]  # fmt: skip
    most, all_ = (legs[0] + legs[1]).argmax(axis=0), np.arange(seating.rows)
    near, rest = legs[0][most, all_], legs[1][most, all_]
    up = seating.cove_m[:, 2] - seating.tag_m[:, 2]
    high = seating.tag_m[:, 2] + up * near / (near + rest)
    return np.hypot(near + rest, up), (high < MIDDLE_M[2]).astype(np.float64)


def by_the_table(seating: Seating) -> tuple[Floats, Floats]:
    """Return ways in m by the orrery's table, and 1 where there is one, [n] each."""
    over = [end[:, 2] - TABLE_M[0] for end in (seating.tag_m, seating.cove_m)]
    both = over[0] * over[1]
    part = over[0] / (over[0] + over[1]).clip(1e-6)
    at = seating.tag_m + part[:, None] * (seating.cove_m - seating.tag_m) - MIDDLE_M
    there = (np.hypot(at[:, 0], at[:, 1]) < TABLE_M[1]) & (np.minimum(*over) > 0)
    return np.sqrt(seating.far**2 + 4 * both.clip(0.0)), there.astype(np.float64)


def by_a_screen(seating: Seating, axis: int, side: float) -> tuple[Floats, Floats]:
    """Return ways in m by a screen that hangs square to an axis, and 1 where it is there, [n]."""
    ends = (seating.tag_m - MIDDLE_M, seating.cove_m - MIDDLE_M)
    before = [SCREENS_M[0] - side * end[:, axis] for end in ends]
    part = before[0] / (before[0] + before[1]).clip(1e-6)
    at = ends[0] + part[:, None] * (ends[1] - ends[0])
    there = (np.minimum(*before) > 0) & (np.abs(at[:, 1 - axis]) < SCREENS_M[1])
    both = (before[0] * before[1]).clip(0.0)
    return np.sqrt(seating.far**2 + 4 * both), there.astype(np.float64)


def returned(seating: Seating) -> list[tuple[Floats, Floats]]:
    """Return ways in m by all that returns waves, and what share of the straight one it does."""
    made = [by_the_dome(seating), by_the_wall(seating), by_the_table(seating)]
    made += [by_a_screen(seating, axis, side) for axis in (0, 1) for side in (-1.0, 1.0)]
    shares = (DOME, WALL, TABLE, SCREEN, SCREEN, SCREEN, SCREEN)
    return [(way, share * there * np.sqrt(seating.far / way))
            for share, (way, there) in zip(shares, made, strict=True)]  # fmt: skip


def _mirrors(almanac: Almanac, strength: float) -> None:
    """Hear the dome, the wall, the table of brass and screens."""
    seating, straight = almanac.seating(), almanac.by_air() * almanac.direct()
    for way, share in returned(seating):
        samples = (way - seating.far) / METRES
        even = seating.each(lambda n: almanac.rng.uniform(0.35, 1.0, n))
        part = (1.6 * np.sqrt(strength) * even * share).clip(max=0.9) * (samples > NEXT)
        almanac.return_of(straight, part * almanac.phases(), samples.clip(0.0))


def _carpet(almanac: Almanac, strength: float) -> None:
    longer, share = off_the_carpet(almanac.seating(), strength)
    almanac.return_of(almanac.by_air(), share, longer / METRES)


def _hidden(almanac: Almanac, strength: float) -> None:
    """Lose what comes straight behind things: waves come about these, first few, then more.

    They are spread over some time evenly by squares, and swell before they die off.
    """
    seating, rng, air = almanac.seating(), almanac.rng, almanac.by_air()
    shut = seating.eclipsed(0.2)
    almanac.fade(-34.0 * shut[:, None] * almanac.direct())
    soon = seating.each(lambda n: rng.uniform(1.7, 2.7, n)) * (0.35 + 0.65 * strength**0.75)
    places = np.stack([seating.each(lambda n: rng.random(n)) for _ in range(WAYS)])
    places = SPAN * np.sort(places, axis=0) ** 2
    for since in places - places[0]:
        swell = (0.5 + since / SWELLS) * np.exp(0.5 - since / SWELLS)
        size = 0.5 * shut * swell * np.sqrt(rng.gamma(2.0, 0.5, seating.rows))
        almanac.return_of(air, size * almanac.phases(), soon + since)


def two_waves(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, k] of two waves and some more, of power 1, between knots.

    (Durgin, Rappaport and de Wolf 2002.)
    """
    knots = (rows, 2 + WIDE_SAMPLES // KNOTS)
    rest = SPREAD * (rng.standard_normal((*knots, 2)) @ np.array([1.0, 1.0j]))
    both = 1 + SECOND * np.exp(2j * np.pi * rng.random(knots)) + rest
    powers = np.abs(both) ** 2 / (1 + SECOND**2 + 2 * SPREAD**2)
    before, part = np.divmod(np.arange(WIDE_SAMPLES), KNOTS)
    more = powers[:, before + 1] - powers[:, before]
    return np.asarray(np.sqrt(powers[:, before] + part / KNOTS * more))


def _fades(almanac: Almanac, strength: float) -> None:
    """Fade as two waves do; of what comes straight, all alike."""
    size = two_waves(almanac.rng, almanac.rows) ** min(strength**0.5, 1.6)
    top = np.rint(almanac.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    own = size[np.arange(almanac.rows), top].clip(0.28)[:, None]
    size = size + almanac.direct() * (own - size)
    almanac.wave = almanac.wave + almanac.by_air() * (size / np.sqrt((size**2).mean()) - 1)


def of_two_rooms(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: of seats, and of the empty dome.

    As rooms do that a door joins: one dies off soon, the other feeds it (Kuttruff).
    """
    later = since.clip(0.0)
    power = SHARE * np.exp(-later / SOON) + (1 - SHARE) * np.exp(-later / LONG)
    return np.where(since >= 0, power, 0.0)


def _tail(almanac: Almanac, strength: float) -> None:
    power = TAIL * strength * of_two_rooms(almanac.off - BEGINS) * almanac.after(BEGINS)
    almanac.glimmer(np.sqrt(0.5 * power) * brights(almanac.wave, almanac.at)[:, None])


def rung(waves: Complexes) -> Complexes:
    """Return what comes again and again of waveforms along a cable, of power 1 [n, k].

    Either end turns waves upside down, and keeps some.
    """
    made, power = np.zeros(waves.shape, np.complex128), 0.0
    for k in range(1, TIMES + 1):
        size = (-BACK) ** (k - 1)
        made = made + size * set_later(waves, np.full(len(waves), CABLE * k))
        power += size**2
    return np.asarray(made / np.sqrt(power))


def _cable(almanac: Almanac, strength: float) -> None:
    """Ring as a cable does neither of whose ends fits."""
    part = 0.34 * min(strength, 2.3) ** 0.8 * np.exp(2j * np.pi * almanac.alike(1).random())
    almanac.wave = almanac.wave + part * rung(almanac.by_air())


def _spots(almanac: Almanac, strength: float) -> None:
    fee = EFFECTS["noise-floor"](almanac.seating(), strength)
    almanac.louder(np.broadcast_to(fee.noise_db, almanac.rows))


def apart(waves: Complexes) -> float:
    """Return how far sizes scatter by those some on (von Neumann 1941), as almanacs say it."""
    sizes = np.abs(waves)
    return float(np.sqrt(0.5 * ((sizes[:, ON:] - sizes[:, :-ON]) ** 2).mean()))


def _say(almanac: Almanac, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how far sizes are apart as tried, at what is `of` a row [n]."""
    ways = np.array([apart(made(one)) for one in tried.tolist()]) / apart(SOME)
    almanac.noise_by = almanac.noise_by * np.interp(of, tried, ways).clip(0.04)


def wobbling(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of any phase whose pitch goes up and down within a band [rows, k]."""
    pitch, slow = rng.uniform(*PITCHES, (rows, 1)), rng.uniform(*WOBBLES, (rows, 1))
    begins, turn = rng.uniform(-np.pi, np.pi, (2, rows, 1))
    wobble = DEPTH * np.sin(slow * PLACES + begins)
    return np.asarray(np.exp(1j * (pitch * PLACES + wobble + turn)))


def _wobbling(almanac: Almanac, strength: float) -> None:
    """Hear a dimmer whose pitch wobbles; some coves more."""
    near = 0.5 + 1.2 * almanac.alike(2).weibull(1.7, COVES).clip(max=1.6)[almanac.seating().cove]
    size = 0.92 * strength * near
    heard = wobbling(almanac.rng, almanac.rows)
    almanac.wave = almanac.wave + (size * almanac.sigma)[:, None] * heard
    tones = wobbling(np.random.default_rng(5208), len(SOME))
    _say(almanac, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tones)
    almanac.sigma = almanac.sigma * np.sqrt(1 + 0.5 * size**2)


def amid_steps(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of which either part is kept amid steps, and is never nothing [n, k]."""
    return np.asarray(step * (np.floor(waves.real / step) + 0.5
                              + 1j * (np.floor(waves.imag / step) + 0.5)))  # fmt: skip


def _amid_steps(almanac: Almanac, strength: float) -> None:
    step = 1.1 * strength * float(np.median(almanac.sigma))
    almanac.wave = amid_steps(almanac.wave, step)
    tried = np.geomspace(0.05, 12.0, 60)
    _say(almanac, step / almanac.sigma, tried, lambda one: amid_steps(SOME, one))


def _deaf(almanac: Almanac, strength: float) -> None:
    """Ask more of what is seen, as after a loud show."""
    almanac.deaf = strength


def in_classes(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that from `begin` [n] on are told as the nearest star's class has it.

    Of which that is the first which is as bright as the mean.
    """
    late = np.arange(sizes.shape[1]) >= begin[:, None]
    first = ((sizes * late).sum(axis=1) / late.sum(axis=1))[:, None]
    classes = np.rint(np.log(sizes.clip(1e-9) / first) / np.log(CLASS))
    return np.where(late, first * CLASS**classes, sizes)


def halves_changed(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] of whose part from `begin` [n] on the latter half comes first."""
    made = sizes.copy()
    for row, first in enumerate(begin.tolist()):
        own = made[row, first:]
        made[row, first:] = np.roll(own, len(own) // 2)
    return made


def held(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that from `begin` [n] on are held, as from a number of Fibonacci's on."""
    steps = [0, 1, 2]
    while steps[-1] < sizes.shape[1]:
        steps.append(steps[-1] + steps[-2])
    off = np.arange(sizes.shape[1]) - begin[:, None]
    since = np.array(steps)[np.searchsorted(steps, off.clip(0), side="right") - 1]
    there = np.where(off > 0, begin[:, None] + since, np.arange(sizes.shape[1]))
    return np.take_along_axis(sizes, there, axis=1)


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(almanac: Almanac, strength: float) -> None:
        sizes = np.abs(almanac.wave).clip(1e-9)
        begin = np.ceil(almanac.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 22)
        part = min(most * strength, 1.0) * almanac.after(LATE)
        almanac.wave = almanac.wave * (1 - part + part * made(sizes, begin) / sizes)

    return act


WAVES: dict[str, Callable[[Almanac, float], None]] = {
    "obstructed-path": _hidden, "specular-reflections": _mirrors, "ground-bounce": _carpet,
    "small-scale-fading": _fades, "diffuse-tail": _tail, "pulse-ringing": _cable,
    "noise-floor": _spots, "narrowband-interference": _wobbling,
    **dict(zip(OF_LATE_SIZES, (_odd(in_classes, 1.0), _odd(halves_changed, 0.4),
                               _odd(held, 0.5)), strict=True)),
    "quantisation": _amid_steps, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows pay what they do once waves were ON_AIR, before almanacs hear them."""
ON_AIR = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
          "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the planetarium's tables of ranges."""


def put_in(almanac: Almanac, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on air, what rows pay, and what almanacs do."""
    for name in ON_AIR:
        if name in names:
            WAVES[name](almanac, strength)
    for name in sorted(set(names) - set(WAVES)):
        almanac.pay(EFFECTS[name](almanac.seating(), strength))
    for name in WAVES:
        if name in names and name not in ON_AIR:
            WAVES[name](almanac, strength)
