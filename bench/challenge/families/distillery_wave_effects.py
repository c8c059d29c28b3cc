"""What the distillery hides in waveforms: effects in forms of its own, its safes' oddities.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.distillery_effects import EFFECTS, off_the_floor
from bench.challenge.families.distillery_house import LAWS as LAWS_OF_ROWS
from bench.challenge.families.distillery_house import LINTELS, POTS_M, Run
from bench.challenge.families.distillery_safe import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Safe,
    matched,
    run_later,
    seething,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
ODDITIES = (
    "late-tens-lose-heads-and-tails", "late-sevens-told-backwards",
    "late-sizes-blended-with-those-half-way-on",
)  # fmt: skip
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "klafters-from-one-lintel"}
LAWS |= {name: Law() for name in ODDITIES}
LATE = 7.4  # samples past first paths from which safes are odd
RIDGE_M, SLOPE = (5.0, 10.4), np.radians(38.0)  # across and up, of the barn's roof; its pitch
ROOF, GIRTH_M, NEXT = 0.75, 1.3, 4.9  # share; radius of pots; samples from which it is heard
BENT, LULLS, DIES = 9, 2.3, 12.0  # ways about what hides; samples between; to 1 / e
KNOTS, FADE = 5, 1.5  # samples between fades; their shape (Nakagami)
TAIL, BEGINS, GROWS, WANES = 0.052, 3.0, 5.0, 17.0  # power; samples until; in which; to 1 / e
CABLE, RETURNS = 4.6, 0.6  # samples there and back; of each turn that comes back
PITCH, SWINGS, SWING = (0.4, 1.3), (0.05, 0.12), 2.2  # radians a sample, of swings; of these, up to
SOME: Complexes = seething(np.random.default_rng(6207), 160)  # noise to try readings on


def by_a_slope(run: Run, side: float) -> tuple[Floats, Floats]:
    """Return ways in m by a slope of the barn's roof, 1 or -1 aside, and if these are there [n].

    Images stand as far behind it as ends are before.
    """
    out = np.array([0.0, side * np.sin(SLOPE), np.cos(SLOPE)])
    ridge = np.array([0.0, *RIDGE_M])
    below = [(ridge - end) @ out for end in (run.tag_m, run.lintel_m)]
    way = np.sqrt(run.far**2 + 4 * (below[0] * below[1]).clip(0.0))
    part = below[0] / (below[0] + below[1]).clip(1e-9)
    at = run.tag_m + part[:, None] * (run.lintel_m - run.tag_m)
    inside = (np.minimum(*below) > 0) & (side * (at[:, 1] - RIDGE_M[0]) > -3.0) & (at[:, 1] < 10.0)
    return way, inside.astype(np.float64)


def off_pots(run: Run) -> list[tuple[Floats, Floats]]:
    """Return ways in m by pots, and what share of straight ones balls of copper return [n]."""
    made = []
    for pot in POTS_M:
        one, other = (np.linalg.norm(end - pot, axis=1) for end in (run.tag_m, run.lintel_m))
        share = 0.5 * GIRTH_M * run.far / (one * other).clip(0.6)
        made.append((one + other, share.clip(max=0.6)))
    return made


def _copper_and_slates(safe: Safe, strength: float) -> None:
    """Hear pots and the slopes of a roof; soot and moss are on some of these."""
    run, first = safe.run(), safe.heard() * safe.straight()
    ways = off_pots(run)
    for side in (1.0, -1.0):
        way, there = by_a_slope(run, side)
        ways.append((way, ROOF * there * run.far / way))
    for way, share in ways:
        samples = (way - run.far) / METRES
        bright = run.by_link(lambda n: safe.rng.uniform(0.5, 1.0, n))
        part = np.sqrt(strength) * 1.9 * bright * share.clip(max=0.6) * (samples > NEXT)
        safe.again(first, part.clip(max=0.9) * safe.turned(), samples)


def _floor(safe: Safe, strength: float) -> None:
    longer, share = off_the_floor(safe.run(), strength)
    safe.again(safe.heard(), share, longer / METRES)


def _shut(safe: Safe, strength: float) -> None:
    """Lose what comes straight behind things: ways bend about these, of sizes as Weibull has."""
    run, rng, heard = safe.run(), safe.rng, safe.heard()
    shut = run.shut_off(0.2)
    safe.weaken(-32.0 * shut[:, None] * safe.straight())
    sooner = run.by_link(lambda n: 1.5 + rng.weibull(2.0, n).clip(max=2.2))
    since = sooner * (0.45 + 0.55 * strength**0.75)
    begin = since
    for _ in range(BENT):
        size = shut * 0.5 * np.exp(-(since - begin) / DIES) * rng.weibull(3.0, run.rows)
        safe.again(heard, size.clip(max=0.8) * safe.turned(), since)
        since = since + run.by_link(lambda n: rng.gamma(2.0, 0.5 * LULLS, n))


def by_knots(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of power 1: at knots gammas, even between."""
    knots = np.arange(0, WIDE_SAMPLES + KNOTS, KNOTS)
    drawn = rng.gamma(FADE, 1 / FADE, (rows, len(knots)))
    at = PLACES / KNOTS
    low = at.astype(np.int64)
    part = at - low
    return np.sqrt((1 - part) * drawn[:, low] + part * drawn[:, low + 1])


def _fades(safe: Safe, strength: float) -> None:
    """Fade from knot to knot; of what comes straight, all alike."""
    size = by_knots(safe.rng, safe.rows) ** min(0.75 * strength**0.5, 1.4)
    top = np.rint(safe.at + 1.2).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    first = size[np.arange(safe.rows), top].clip(0.35)[:, None]
    straight = safe.straight()
    size = straight * first + (1 - straight) * size
    safe.wave = safe.wave + (size / np.sqrt((size**2).mean()) - 1) * safe.heard()


def grown_and_waned(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: it grows, and wanes evenly."""
    late = since.clip(0.0)
    return np.asarray(1.6 * -np.expm1(-late / GROWS) * np.exp(-late / WANES))


def _tail(safe: Safe, strength: float) -> None:
    """Hear all else of a hall, into which what comes has to spread first."""
    high = matched(safe.wave, safe.at, safe.sigma)[:, None]
    power = TAIL * strength * grown_and_waned(safe.off - BEGINS)
    safe.seethe(high * np.sqrt(0.5 * power))


def to_and_fro(waves: Complexes) -> Complexes:
    """Return what comes back along a cable of waveforms: the less, and the other way up each time.

    Of power 1 [n, k].
    """
    made = np.zeros(waves.shape, np.complex128)
    for turn in range(1, 6):
        made += (-RETURNS) ** (turn - 1) * run_later(waves, np.full(len(waves), turn * CABLE))
    return np.asarray(made * np.sqrt(1 - RETURNS**2))


def _cable(safe: Safe, strength: float) -> None:
    """Hear once more what a plug sends back along a cable that is as long at all lintels."""
    part = 0.34 * min(strength, 2.2) ** 0.8 * np.exp(1j * safe.shared(5).uniform(-np.pi, np.pi))
    safe.wave = safe.wave + part * to_and_fro(safe.heard())


def _boiler(safe: Safe, strength: float) -> None:
    duty = EFFECTS["noise-floor"](safe.run(), strength)
    safe.roar(np.zeros(safe.rows) + duty.noise_db)


def astray(waves: Complexes) -> float:
    """Return how sizes scatter by what lies between these and ones five on, as safes say.

    (von Neumann 1941.)
    """
    apart = np.abs(waves)[:, 5:] - np.abs(waves)[:, :-5]
    return float(np.sqrt(0.5 * (apart**2).mean()))


def _say(safe: Safe, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how far astray sizes are as tried, at what is `of` a row [n]."""
    by = np.array([astray(made(float(one))) for one in tried]) / astray(SOME)
    safe.noise_by = safe.noise_by * np.interp(of, tried, by).clip(0.05)


def warbling(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of size 1 whose pitch swings, as a hammer's furnace does [rows, k]."""
    pitch, swings = rng.uniform(*PITCH, (rows, 1)), rng.uniform(*SWINGS, (rows, 1))
    phase, begin = rng.uniform(-np.pi, np.pi, (2, rows, 1))
    turn = pitch * PLACES + SWING * np.sin(swings * PLACES + begin) + phase
    return np.asarray(np.exp(1j * turn))


def _warble(safe: Safe, strength: float) -> None:
    """Hear coppersmiths' furnace; some lintels more."""
    near = safe.shared(6).gamma(6.0, 1 / 6.0, LINTELS).clip(0.4, 1.9)[safe.run().lintel]
    size = 0.95 * strength * near
    safe.wave = safe.wave + (size * safe.sigma)[:, None] * warbling(safe.rng, safe.rows)
    tones = warbling(np.random.default_rng(6208), len(SOME))
    _say(safe, size, np.linspace(0.0, 9.0, 46), lambda one: SOME + one * tones)
    safe.sigma = safe.sigma * np.sqrt(1 + 0.5 * size**2)


def between_steps(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of either part of which the middle between steps is told [n, k].

    Nought is not among these.
    """
    low = np.floor(waves.real / step) + 1j * np.floor(waves.imag / step)
    return np.asarray(step * (low + 0.5 + 0.5j))


def _between(safe: Safe, strength: float) -> None:
    step = 1.1 * strength * float(np.median(safe.sigma))
    safe.wave = between_steps(safe.wave, step)
    _say(
        safe, step / safe.sigma, np.geomspace(0.04, 14.0, 60), lambda one: between_steps(SOME, one)
    )


def _dull(safe: Safe, strength: float) -> None:
    """Ask more of what is heard, as safes do whose glass is dull."""
    safe.dull = strength


def in_blocks(sizes: Floats, begin: Integers, many: int, made: Callable[..., Floats]) -> Floats:
    """Return sizes [n, k] of which, from `begin` [n] on, blocks of so `many` are made others.

    `made` takes blocks [blocks, many]; what is left at the end stays.
    """
    kept = sizes.copy()
    for row, at in enumerate(begin.tolist()):
        end = at + (sizes.shape[1] - at) // many * many
        kept[row, at:end] = made(sizes[row, at:end].reshape(-1, many)).ravel()
    return kept


def hearts(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes of each ten of which heads and tails are cut (Dixon 1960).

    The three largest and the three least are told as the nearest that is left.
    """

    def cut(tens: Floats) -> Floats:
        ranked = np.sort(tens, axis=1)
        return np.clip(tens, ranked[:, 3:4], ranked[:, 6:7])

    return in_blocks(sizes, begin, 10, cut)


def backwards(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes of which each seven are told backwards."""
    return in_blocks(sizes, begin, 7, lambda sevens: sevens[:, ::-1])


def half_way_on(sizes: Floats, begin: Integers) -> Floats:
    """Return late sizes blended with as late ones of the other half of these, evenly."""
    made = sizes.copy()
    for row, at in enumerate(begin.tolist()):
        late = sizes[row, at:]
        made[row, at:] = 0.5 * (late + np.roll(late, len(late) // 2))
    return made


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(safe: Safe, strength: float) -> None:
        sizes = np.abs(safe.wave) + 1e-9
        begin = np.clip(np.ceil(safe.at + LATE), 0, WIDE_SAMPLES - 24).astype(np.int64)
        part = min(most * strength, 1.0) * safe.after(LATE)
        safe.wave = safe.wave * (1 - part + part * made(sizes, begin) / sizes)

    return act


WAVES: dict[str, Callable[[Safe, float], None]] = {
    "obstructed-path": _shut, "specular-reflections": _copper_and_slates,
    "ground-bounce": _floor, "small-scale-fading": _fades, "diffuse-tail": _tail,
    "pulse-ringing": _cable, "noise-floor": _boiler, "narrowband-interference": _warble,
    "late-tens-lose-heads-and-tails": _odd(hearts, 0.95),
    "late-sevens-told-backwards": _odd(backwards, 0.75),
    "late-sizes-blended-with-those-half-way-on": _odd(half_way_on, 0.8),
    "quantisation": _between, "late-detection": _dull,
}  # fmt: skip
"""In turn; rows pay what they do once waves were ON_THE_WAY, before safes hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the distillery's tables of ranges."""


def hide(safe: Safe, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what rows pay, and what safes do."""
    for name in ON_THE_WAY:
        if name in names:
            WAVES[name](safe, strength)
    for name in sorted({*names} - {*WAVES}):
        safe.levy(EFFECTS[name](safe.run(), strength))
    for name, act in WAVES.items():
        if name in names and name not in ON_THE_WAY:
            act(safe, strength)
