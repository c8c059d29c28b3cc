"""What the watermill hides in waveforms: effects in forms of their own, its hoppers' oddities.

numpy alone; oddities are in `watermill_oddities`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.watermill_effects import EFFECTS, off_the_floor
from bench.challenge.families.watermill_hopper import (
    PLACES,
    WIDE_SAMPLES,
    Hopper,
    ground_later,
    heights,
    trundling,
)
from bench.challenge.families.watermill_oddities import ODDITIES
from bench.challenge.families.watermill_race import HATCHES, ROOM_M, Grist
from bench.challenge.families.watermill_race import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "ells-from-one-hatch"}
LAWS |= {name: Law() for name in ODDITIES}
BRICK, SHINGLES, NEXT = 0.6, 0.5, 5.0  # shares; samples from which these are heard
CRACKS, EACH_M, SWELL = 9, 0.55, (0.9, 2.6)  # ways; between these; of how they swell and die, in m
KNOT, SPREAD_DB = 4, 5.0  # samples from fade to fade; by which these scatter
TAIL, BEGINS, LINGERS, STEEP = 0.033, 3.4, 13.0, 2.2  # power; samples until, in which; of a power
JOINTS, BACK = (4.5, 7.4), (0.55, -0.42)  # samples there and back, of cables; part that returns
PITCH, SWEEPS = (0.3, 2.4), 0.012  # radians a sample, of tones; by which these rise, each sample
SOME: Complexes = trundling(np.random.default_rng(8407), 160)  # noise to try readings on


def by_walls(grist: Grist) -> list[tuple[Floats, Floats]]:
    """Return ways in m by long walls, by both in turn and by shingles, and shares [n] that come.

    Steep waves are returned less by brick (a straight line by their cosine).
    """
    tag, hatch = grist.tag_m, grist.hatch_m
    wide, high = ROOM_M[1], ROOM_M[2]
    made = []
    for sign, shift, times in ((-1.0, 0.0, 1), (-1.0, 2 * wide, 1), (1.0, 2 * wide, 2),
                               (1.0, -2 * wide, 2)):  # fmt: skip
        image = np.stack([tag[:, 0], sign * tag[:, 1] + shift, tag[:, 2]], axis=1)
        way = np.linalg.norm(image - hatch, axis=1)
        grazes = 1 - np.abs(image[:, 1] - hatch[:, 1]) / way
        made.append((way, (BRICK + 0.3 * grazes) ** times * grist.far / way))
    image = tag * [1.0, 1.0, -1.0] + [0.0, 0.0, 2 * high]
    way = np.linalg.norm(image - hatch, axis=1)
    return [*made, (way, SHINGLES * grist.far / way)]


def _walls(hopper: Hopper, strength: float) -> None:
    """Hear walls and shingles, where sacks are not in front."""
    grist = hopper.grist()
    first = hopper.came() * hopper.straight()
    for way, share in by_walls(grist):
        samples = (way - grist.far) / hopper.metres
        bare = grist.each(lambda n: hopper.rng.beta(2.0, 1.2, n))
        part = 1.45 * np.sqrt(strength) * bare * share * (samples > NEXT)
        hopper.repeat(first, part.clip(max=0.85) * hopper.turns(), samples)


def _floor(hopper: Hopper, strength: float) -> None:
    longer, share = off_the_floor(hopper.grist(), strength)
    hopper.repeat(hopper.came(), share, longer / hopper.metres)


def swelling(since_m: Floats) -> Floats:
    """Return how high what comes by cracks is so many m after the first [...]: it swells, dies."""
    rises, dies = SWELL
    made = (1 - np.exp(-(since_m + 0.5) / rises)) * np.exp(-since_m / dies)
    return np.asarray(made / 0.42)


def _cracks(hopper: Hopper, strength: float) -> None:
    """Lose what comes straight behind things; some comes by cracks, more of it a little later."""
    grist, rng, came = hopper.grist(), hopper.rng, hopper.came()
    shut = grist.shut_off(0.2)
    hopper.lose(-32.0 * shut[:, None] * hopper.straight())
    first_m = grist.each(lambda n: rng.triangular(0.45, 0.8, 1.5, n)) * (0.5 + 0.5 * strength**0.8)
    since_m = np.zeros(grist.rows)
    for _ in range(CRACKS):
        fades = np.sqrt(rng.gamma(4.0, 0.25, grist.rows))
        size = (shut * 0.36 * swelling(since_m) * fades).clip(max=0.8)
        hopper.repeat(came, size * hopper.turns(), (first_m + since_m) / hopper.metres)
        since_m = since_m + EACH_M * grist.each(lambda n: rng.exponential(0.9, n).clip(0.3, 2.5))


def shimmer(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of power 1: dB that bend from knot to knot.

    Scattered evenly in dB, as by much that shadows (Suzuki 1977).
    """
    knots = WIDE_SAMPLES // KNOT + 3
    db = SPREAD_DB * rng.standard_normal((rows, knots)).clip(-2.4, 2.0)
    at = (np.arange(WIDE_SAMPLES) + rng.uniform(0.0, KNOT, (rows, 1))) / KNOT
    whole = np.floor(at).astype(np.int64)
    turn = 0.5 - 0.5 * np.cos(np.pi * (at - whole))
    low, high = (np.take_along_axis(db, whole + k, axis=1) for k in (0, 1))
    made = 10 ** (((1 - turn) * low + turn * high) / 20)
    return np.asarray(made / np.sqrt((made**2).mean()))


def _fades(hopper: Hopper, strength: float) -> None:
    """Fade from knot to knot; of what comes straight, all alike."""
    size = shimmer(hopper.rng, hopper.rows) ** min(np.sqrt(strength), 1.6)
    top = np.rint(hopper.at + 1.2).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    first = np.take_along_axis(size, top[:, None], axis=1).clip(0.35, 2.5)
    straight = hopper.straight()
    size = straight * first + (1 - straight) * size
    hopper.wave = hopper.wave + (size / np.sqrt((size**2).mean()) - 1) * hopper.came()


def lingering(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: a power of time, of a large hall."""
    return np.asarray((since > 0) * (1 + since.clip(0.0) / LINGERS) ** -STEEP)


def _tail(hopper: Hopper, strength: float) -> None:
    """Hear all else of a hall with many holes, that dies away ever more slowly."""
    high = heights(hopper.wave, hopper.at, hopper.sigma)[:, None]
    power = TAIL * strength * lingering(PLACES - hopper.at[:, None] - BEGINS)
    hopper.hiss(high * np.sqrt(power) * hopper.after(BEGINS))


def jointed(waves: Complexes) -> Complexes:
    """Return what comes after waveforms once and twice by cables' two joints, of power about 1."""
    made = np.zeros(waves.shape, np.complex128)
    for times in (1, 2, 3):
        for joint, back in zip(JOINTS, BACK, strict=True):
            made += 2.2 * back**times * ground_later(waves, np.full(len(waves), times * joint))
    return made


def _joints(hopper: Hopper, strength: float) -> None:
    """Hear hatches' cables, whose joints do not match, all alike."""
    turn = np.exp(1j * hopper.shared(5).uniform(-np.pi, np.pi))
    hopper.wave = hopper.wave + 0.31 * min(strength, 2.2) ** 0.8 * turn * jointed(hopper.came())


def _dynamo(hopper: Hopper, strength: float) -> None:
    due = EFFECTS["noise-floor"](hopper.grist(), strength)
    hopper.louder(np.zeros(hopper.rows) + due.noise_db)


def of_noise(waves: Complexes) -> float:
    """Return how sizes scatter within sixes, as hoppers say of noise."""
    sizes = np.abs(waves)
    sixes = sizes[:, : sizes.shape[1] // 6 * 6].reshape(-1, 6)
    return float(np.sqrt(sixes.var(axis=1, ddof=1).mean()))


def _say(hopper: Hopper, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([of_noise(made(float(one))) for one in tried]) / of_noise(SOME)
    hopper.noise_by = hopper.noise_by * np.interp(of, tried, by).clip(0.05)


def sweeping(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of power 1 whose pitch rises or falls evenly [rows, WIDE_SAMPLES]."""
    pitch, begins = rng.uniform(*PITCH, (rows, 1)), rng.uniform(-np.pi, np.pi, (rows, 1))
    rises = rng.uniform(-SWEEPS, SWEEPS, (rows, 1))
    return np.asarray(np.exp(1j * (begins + pitch * PLACES + 0.5 * rises * PLACES**2)))


def _sweeps(hopper: Hopper, strength: float) -> None:
    """Hear what feeds the lamps, whose pitch sweeps; some hatches more."""
    near = hopper.shared(6).gamma(5.0, 0.2, HATCHES).clip(0.4, 1.9)[hopper.grist().hatch]
    size = 0.7 * strength * near
    hopper.wave = hopper.wave + (size * hopper.sigma)[:, None] * sweeping(hopper.rng, hopper.rows)
    tones = sweeping(np.random.default_rng(8408), len(SOME))
    _say(hopper, size, np.linspace(0.0, 9.0, 46), lambda one: SOME + one * tones)
    hopper.sigma = hopper.sigma * np.sqrt(1 + 0.5 * size**2)


def stepped(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of either part told by middles of steps, of which none is nought [n, k]."""
    return np.asarray(step * (np.floor(waves.real / step) + 0.5
                              + 1j * (np.floor(waves.imag / step) + 0.5)))  # fmt: skip


def _steps(hopper: Hopper, strength: float) -> None:
    step = 0.9 * strength * float(np.median(hopper.sigma))
    hopper.wave = stepped(hopper.wave, step)
    _say(hopper, step / hopper.sigma, np.geomspace(0.03, 12.0, 60), lambda one: stepped(SOME, one))


def _blunt(hopper: Hopper, strength: float) -> None:
    """Ask a part of the most of what is heard, as hoppers do whose damsel is worn."""
    hopper.blunt = strength


WAVES: dict[str, Callable[[Hopper, float], None]] = {
    "obstructed-path": _cracks, "specular-reflections": _walls,
    "ground-bounce": _floor, "small-scale-fading": _fades, "diffuse-tail": _tail,
    "pulse-ringing": _joints, "noise-floor": _dynamo, "narrowband-interference": _sweeps,
    **ODDITIES,
    "quantisation": _steps, "late-detection": _blunt,
}  # fmt: skip
"""In turn; rows pay what they do once waves were ON_THE_WAY, before hoppers hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the watermill's tables of ranges."""


def hide(hopper: Hopper, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what rows owe, and what hoppers do."""
    for name in ON_THE_WAY:
        if name in names:
            WAVES[name](hopper, strength)
    for name in sorted(set(names) - set(WAVES)):
        hopper.pay(EFFECTS[name](hopper.grist(), strength))
    for name, act in WAVES.items():
        if name in names and name not in ON_THE_WAY:
            act(hopper, strength)
