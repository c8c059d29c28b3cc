"""What the shipyard hides in waveforms: effects in forms of its own, oddities of its lookouts.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.shipyard_effects import EFFECTS, aside_m, off_a_ball, off_the_deck
from bench.challenge.families.shipyard_lookout import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Lookout,
    heights,
    surf,
)
from bench.challenge.families.shipyard_slip import DERRICKS, DOCK_M, TANK_M, TANKS_M, Berth
from bench.challenge.families.shipyard_slip import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
OF_LATE_SIZES = (
    "late-sizes-left-as-running-means", "late-ink-spreads-before-it-dries",
    "late-gain-tripped-up-and-down",
)  # fmt: skip
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "spans-from-one-derrick"}
LAWS |= {name: Law() for name in OF_LATE_SIZES}
LATE = 8.0  # samples past first paths from which lookouts are odd
GATES, NEXT = 0.5, 4.4  # what gates and sheds of sheets return; samples past which these are heard
SHEETS: tuple[tuple[int, float], ...] = ((0, 0.0), (0, DOCK_M[0]), (1, 0.0), (1, DOCK_M[1]))
PLANKS, CLOSER = 9, 2.1  # ways through staging; samples to the second, of which roots tell the rest
KNOTS, SKEWED = 6, 1.05  # samples between chances of fades; of Wald's law
PEAKS, TAIL, BEGINS = 7.0, 0.02, 3.6  # samples since a tail began; its height in power; when
RINGS, FELL, PITCH, DIES = 90, 9.0, 16.0, 17.0  # samples; samples; radians; samples to 1 / e
KEYS = ((0.55, 0.75), (1.15, 1.4))  # radians a sample: either tone of a telephone's key
FOUR = 4  # samples of which noise is told by how far they range
SECTORS = 40  # of a turn, in which phases are kept
SWELLS, TRIPS = 0.33, (0.7, 1.25, 2.4)  # of ink; of means: down, up; of a gain that is up
SOME: Complexes = surf(np.random.default_rng(3907), 170)  # noise to try readings on


def by_sheet(berth: Berth, sheet: tuple[int, float]) -> Floats:
    """Return ways in m by a sheet, which is square to an axis [n]."""
    axis, where = sheet
    both = 4 * (berth.tag_m[:, axis] - where) * (berth.top_m[:, axis] - where)
    return np.sqrt(berth.far**2 + both)


def by_things(berth: Berth) -> list[tuple[Floats, Floats]]:
    """Return ways in m by tanks and by sheets, and what share of the straight one these return.

    Balls spread what they return, as if it came from half their size (Born and Wolf).
    """
    made = []
    for ball in TANKS_M:
        legs = off_a_ball(berth.tag_m, berth.top_m, ball)
        free = aside_m(berth, ball) > TANK_M
        made.append((legs[0] + legs[1], free * 0.5 * TANK_M * berth.far / (legs[0] * legs[1])))
    for sheet in SHEETS:
        way = by_sheet(berth, sheet)
        made.append((way, GATES * berth.far / way))
    return made


def _balls(lookout: Lookout, strength: float) -> None:
    """Hear tanks, sheds and gates."""
    berth, straight = lookout.berth(), lookout.by_air() * lookout.ahead()
    for way, share in by_things(berth):
        late = (way - berth.far) / METRES
        free = berth.each(lambda n: np.sqrt(lookout.rng.uniform(0.08, 1.0, n)))
        part = np.minimum(1.45 * strength**0.5 * free * share, 0.75) * (late > NEXT)
        lookout.echo(straight, part * lookout.any_phase(), late.clip(0.0))


def _deck(lookout: Lookout, strength: float) -> None:
    longer, share = off_the_deck(lookout.berth(), strength)
    lookout.echo(lookout.by_air(), share, longer / METRES)


def _staging(lookout: Lookout, strength: float) -> None:
    """Lose what comes straight behind things: waves come by planks, one beyond the other.

    As zones are (Fresnel), they are late by roots: ever closer.
    """
    berth, rng, air = lookout.berth(), lookout.rng, lookout.by_air()
    cut = berth.cut_off(0.2)
    lookout.dim(-33.0 * cut[:, None] * lookout.ahead())
    soon = berth.each(lambda n: rng.triangular(1.9, 2.5, 3.4, n)) * (0.4 + 0.6 * strength**0.7)
    apart = berth.each(lambda n: CLOSER * rng.uniform(0.7, 1.5, n))
    for k in range(PLANKS):
        size = 0.62 * cut * (1 + k) ** -0.75 * rng.weibull(1.9, lookout.rows)
        lookout.echo(air, size * lookout.any_phase(), soon + apart * 1.6 * np.sqrt(k))


def wald(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, k], whose powers are Wald's of mean 1 (1944), between knots."""
    powers = rng.wald(1.0, SKEWED, (rows, 2 + WIDE_SAMPLES // KNOTS))
    knot = np.arange(WIDE_SAMPLES) // KNOTS
    part = np.arange(WIDE_SAMPLES) / KNOTS - knot
    return np.sqrt(powers[:, knot] * (1 - part) + powers[:, knot + 1] * part)


def _fades(lookout: Lookout, strength: float) -> None:
    """Fade amid rigging; of what comes straight, all alike."""
    size = wald(lookout.rng, lookout.rows) ** min(1.05 * strength**0.5, 1.6)
    ahead = lookout.ahead()
    top = np.rint(lookout.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    own = size[np.arange(lookout.rows), top].clip(0.25)[:, None]
    size = size + ahead * (own - size)
    lookout.wave = lookout.wave + lookout.by_air() * (size / np.sqrt((size**2).mean()) - 1)


def of_walks(since: Floats) -> Floats:
    """Return a tail's power, 1 at its most, by samples since it began [...]: by Levy's law (1925).

    As of what walks until it is first there, and may be long in coming.
    """
    part = PEAKS / np.maximum(since, 1e-3 * PEAKS)
    return np.where(since > 0, part**1.5 * np.exp(1.5 - 1.5 * part), 0.0)


def _tail(lookout: Lookout, strength: float) -> None:
    power = TAIL * strength * of_walks(lookout.off - BEGINS) * lookout.since(BEGINS)
    lookout.roar(np.sqrt(0.5 * power) * heights(lookout.wave, lookout.at)[:, None])


def plate() -> Complexes:
    """Return how a plate of steel rings whose high pitches come first, of power 1 [RINGS]."""
    since = np.arange(RINGS) - 2.0
    phase = PITCH * np.log1p(since.clip(0.0) / FELL)
    made = np.where(since > 0, np.exp(-since / DIES + 1j * phase) * np.tanh(since / 3.0), 0.0)
    return np.asarray(made / np.linalg.norm(made))


def struck(waves: Complexes) -> Complexes:
    """Return what a plate makes of waveforms [n, k]."""
    made = np.zeros(waves.shape, np.complex128)
    for k, one in enumerate(plate()):
        made[:, k:] += one * waves[:, : waves.shape[1] - k]
    return made


def _plate(lookout: Lookout, strength: float) -> None:
    """Ring as a plate of steel does behind a derrick's antenna."""
    part = 0.33 * min(strength, 2.3) ** 0.8 * np.exp(2j * np.pi * lookout.alike(1).random())
    lookout.wave = lookout.wave + part * struck(lookout.by_air())


def _welds(lookout: Lookout, strength: float) -> None:
    toll = EFFECTS["noise-floor"](lookout.berth(), strength)
    lookout.hiss(np.broadcast_to(toll.hiss_db, lookout.rows))


def ranging(waves: Complexes) -> float:
    """Return how far FOUR sizes in a row range in the mean (Tippett 1925), as lookouts tell it."""
    fours = np.lib.stride_tricks.sliding_window_view(np.abs(waves), FOUR, axis=1)
    return float((fours.max(axis=2) - fours.min(axis=2)).mean())


def _tell(lookout: Lookout, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Tell of noise by how sizes range as tried, at what is `of` a row [n]."""
    ranged = np.array([ranging(made(one)) for one in tried.tolist()]) / ranging(SOME)
    lookout.noise_by = lookout.noise_by * np.maximum(np.interp(of, tried, ranged), 0.04)


def keyed(rng: np.random.Generator, rows: int) -> Complexes:
    """Return two tones at once, of power 1, of any pitch within bands and any phase [rows, k]."""
    tones = [np.exp(1j * (rng.uniform(*key, (rows, 1)) * PLACES
                          + rng.uniform(-np.pi, np.pi, (rows, 1)))) for key in KEYS]  # fmt: skip
    return np.asarray(np.sqrt(0.5) * (tones[0] + tones[1]))


def _keys(lookout: Lookout, strength: float) -> None:
    """Hear a harmonic of the cranes' telephone, whose keys are two tones; some derricks more."""
    near = 0.55 + 1.15 * lookout.alike(2).beta(1.4, 2.3, DERRICKS)[lookout.berth().derrick]
    size = 1.65 * strength * near
    heard = keyed(lookout.rng, lookout.rows)
    lookout.wave = lookout.wave + (size * lookout.sigma)[:, None] * heard
    tones = keyed(np.random.default_rng(3908), len(SOME))
    _tell(lookout, size, np.linspace(0.0, 15.0, 46), lambda one: SOME + one * tones)
    lookout.sigma = np.hypot(lookout.sigma, size * lookout.sigma / np.sqrt(2))


def in_sectors(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of which sizes are kept in whole steps, and phases amid sectors [n, k]."""
    sector = 2 * np.pi / SECTORS
    phase = sector * (np.floor(np.angle(waves) / sector) + 0.5)
    return np.asarray(step * np.rint(np.abs(waves) / step) * np.exp(1j * phase))


def _in_sectors(lookout: Lookout, strength: float) -> None:
    step = 0.85 * strength * float(np.median(lookout.sigma))
    lookout.wave = in_sectors(lookout.wave, step)
    tried = np.geomspace(0.05, 12.0, 60)
    _tell(lookout, step / lookout.sigma, tried, lambda one: in_sectors(SOME, one))


def _deaf(lookout: Lookout, strength: float) -> None:
    """Ask more of what is seen, as where a horn once blew."""
    lookout.deaf = strength


def running(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that from `begin` [n] on are means of all since then."""
    late = np.arange(sizes.shape[1]) >= begin[:, None]
    many = np.cumsum(late, axis=1)
    return np.where(late, np.cumsum(sizes * late, axis=1) / np.maximum(many, 1), sizes)


def inked(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that from `begin` [n] on run the wider the later, by a root of how late.

    Each spreads as heat does, and no ink is lost.
    """
    made = sizes.copy()
    place = np.arange(sizes.shape[1], dtype=np.float64)
    for row, first in enumerate(begin.tolist()):
        own = place[first:]
        wide = SWELLS * np.sqrt(1.0 + own - first)
        runs = np.exp(-0.5 * (np.subtract.outer(own, own) / wide) ** 2)
        made[row, first:] = runs / runs.sum(axis=0) @ sizes[row, first:]
    return made


def tripped(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] whose gain, from `begin` [n] on, is up once one was large, until small.

    As a comparator has it that is slow to change its mind (Schmitt 1938).
    """
    low, high, gain = TRIPS
    late = np.arange(sizes.shape[1]) >= begin[:, None]
    mean = (sizes * late).sum(axis=1) / late.sum(axis=1)
    up, made = np.zeros(len(sizes), np.bool_), sizes.copy()
    for k in range(sizes.shape[1]):
        up = late[:, k] & ((up & (sizes[:, k] > low * mean)) | (sizes[:, k] > high * mean))
        made[:, k] *= np.where(up, gain, 1.0)
    return made


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(lookout: Lookout, strength: float) -> None:
        sizes = np.abs(lookout.wave)
        begin = np.floor(lookout.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 20)
        more = made(sizes, begin) / np.maximum(sizes, 1e-9) - 1
        lookout.wave = lookout.wave * (1 + min(most * strength, 1.0) * lookout.since(LATE) * more)

    return act


WAVES: dict[str, Callable[[Lookout, float], None]] = {
    "obstructed-path": _staging, "specular-reflections": _balls, "ground-bounce": _deck,
    "small-scale-fading": _fades, "diffuse-tail": _tail, "pulse-ringing": _plate,
    "noise-floor": _welds, "narrowband-interference": _keys,
    **dict(zip(OF_LATE_SIZES, (_odd(running, 0.6), _odd(inked, 0.9), _odd(tripped, 0.5)),
               strict=True)),
    "quantisation": _in_sectors, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows pay what they do once waves have been IN_THE_DOCK, before lookouts see them."""
IN_THE_DOCK = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
               "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the shipyard's tables of ranges."""


def put_in(lookout: Lookout, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the dock, what rows pay, and what lookouts do."""
    on_air, after = ([name for name in WAVES if name in names and (name in IN_THE_DOCK) == is_in]
                     for is_in in (True, False))  # fmt: skip
    for name in on_air:
        WAVES[name](lookout, strength)
    for name in sorted({*names} - {*WAVES}):
        lookout.pay(EFFECTS[name](lookout.berth(), strength))
    for name in after:
        WAVES[name](lookout, strength)
