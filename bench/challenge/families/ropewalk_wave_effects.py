"""What the ropewalk hides in waveforms: effects in forms of its own, oddities of its telltales.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.ropewalk_effects import EFFECTS, off_the_floor
from bench.challenge.families.ropewalk_telltale import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Telltale,
    creaking,
    highs,
)
from bench.challenge.families.ropewalk_walk import HALL_M, STRUTS, Hank
from bench.challenge.families.ropewalk_walk import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
OF_LATE_SIZES = (
    "late-sizes-laid-of-three-strands", "late-sizes-follow-at-a-winchs-pace",
    "late-sizes-left-as-places-among-sevens",
)  # fmt: skip
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "zhang-from-one-strut"}
LAWS |= {name: Law() for name in OF_LATE_SIZES}
LATE = 7.5  # samples past first paths from which telltales are odd
FLUTTERS, WALL, GABLE, NEXT = 4, 0.7, 0.5, 4.0  # orders; shares returned; samples from which heard
HECKLES = 11  # ways among hemp that hangs
KNOTS, SHAPE = 5, 1.75  # samples between chances of fades; of Weibull's law
DECAYS, STRETCH, TAIL, BEGINS = 8.5, 0.62, 0.034, 3.2  # samples; power of these; height; when
RINGS, MODES = 80, ((0.62, 15.0, 1.0), (1.35, 9.0, 0.7))  # samples; pitch, samples to 1 / e, share
BUZZES = (0.35, 0.95)  # radians a sample
BRUSHES, SLOW = 0.07, (0.02, 0.09)  # of a buzz's size, up and down; radians a sample of that
PACE, ABOUT = 0.42, 7  # of the mean: most that sizes change at once; how many are ranked
SOME: Complexes = creaking(np.random.default_rng(4107), 170)  # noise to try readings on


def across(hank: Hank, order: int) -> Floats:
    """Return ways in m that go `order` times from wall to wall, or < 0 off the south one first."""
    wide = HALL_M[1]
    far_y = hank.tag_m[:, 1] if order % 2 == 0 else wide - hank.tag_m[:, 1]
    run = hank.tag_m - hank.strut_m
    run[:, 1] = order * wide + far_y - hank.strut_m[:, 1]
    return np.asarray(np.linalg.norm(run, axis=1))


def by_sides(hank: Hank) -> list[tuple[Floats, Floats]]:
    """Return ways in m between walls and by gables, and what share of the straight one these give.

    Walls return less each time; all spreads by how far it went.
    """
    orders = [k for k in range(-FLUTTERS, FLUTTERS + 1) if k]
    made = [(across(hank, k), np.full(hank.rows, WALL ** abs(k))) for k in orders]
    for gable in (0.0, HALL_M[0]):
        both = (hank.strut_m[:, 0] - gable) * (hank.tag_m[:, 0] - gable)
        made.append((np.sqrt(hank.far**2 + 4 * both), np.full(hank.rows, GABLE)))
    return [(way, share * hank.far / way) for way, share in made]


def _sides(telltale: Telltale, strength: float) -> None:
    """Hear walls answer each other, and gables."""
    hank = telltale.hank()
    straight = telltale.by_air() * telltale.straight()
    for way, share in by_sides(hank):
        samples = (way - hank.far) / METRES
        clean = hank.by_link(lambda n: telltale.rng.beta(3.0, 1.5, n))
        part = np.sqrt(strength) * clean * share * (samples > NEXT)
        telltale.again(straight, part.clip(max=0.75) * telltale.turned(), samples.clip(0.0))


def _floor(telltale: Telltale, strength: float) -> None:
    longer, share = off_the_floor(telltale.hank(), strength)
    telltale.again(telltale.by_air(), share, longer / METRES)


def _hemp(telltale: Telltale, strength: float) -> None:
    """Lose what comes straight behind things: waves come among hemp, one some time after the other.

    These are by chance as arrivals are (Poisson), and have sizes as lengths of steps by chance.
    """
    hank, rng, air = telltale.hank(), telltale.rng, telltale.by_air()
    shut = hank.shut_out(0.2)
    telltale.dim(-34.0 * shut[:, None] * telltale.straight())
    after = hank.by_link(lambda n: rng.uniform(1.8, 2.9, n)) * (0.35 + 0.65 * strength**0.75)
    for k in range(HECKLES):
        size = 0.5 * shut * 0.9**k * rng.rayleigh(0.75, telltale.rows)
        telltale.again(air, size * telltale.turned(), after)
        after = after + hank.by_link(lambda n: rng.exponential(1.7, n))


def weibull(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, k] of Weibull's law (1951), of power 1, between knots."""
    knots = rng.weibull(SHAPE, (rows, 2 + WIDE_SAMPLES // KNOTS)) ** 2
    powers = knots / 1.0691  # Gamma(1 + 2 / SHAPE)
    at = np.arange(WIDE_SAMPLES) / KNOTS
    before = at.astype(np.int64)
    part = at - before
    return np.sqrt((1 - part) * powers[:, before] + part * powers[:, before + 1])


def _fades(telltale: Telltale, strength: float) -> None:
    """Fade amid hemp; of what comes straight, all alike."""
    size = weibull(telltale.rng, telltale.rows) ** min(strength**0.5, 1.6)
    size = size / np.sqrt((size**2).mean())
    top = np.rint(telltale.at).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    own = np.take_along_axis(size, top[:, None], axis=1).clip(0.28)
    size = size + telltale.straight() * (own - size)
    telltale.wave = telltale.wave + telltale.by_air() * (size - 1)


def of_hemp(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: a stretched exponential.

    (Kohlrausch 1854.)
    """
    return np.where(since >= 0, np.exp(-((since.clip(0.0) / DECAYS) ** STRETCH)), 0.0)


def _tail(telltale: Telltale, strength: float) -> None:
    power = TAIL * strength * of_hemp(telltale.off - BEGINS) * telltale.from_on(BEGINS)
    telltale.creak(np.sqrt(0.5 * power) * highs(telltale.wave, telltale.at)[:, None])


def hoop() -> Complexes:
    """Return how a hoop of iron rings in two modes, of power 1 [RINGS]; not at once."""
    since = np.arange(RINGS) - 1.0
    modes = sum(by * np.exp((1j * pitch - 1 / dies) * since) for pitch, dies, by in MODES)
    made = np.where(since > 0, modes * (1 - np.exp(-since.clip(0.0) / 2.2)), 0.0)
    return np.asarray(made / np.sqrt((np.abs(made) ** 2).sum()))


def rung(waves: Complexes) -> Complexes:
    """Return what a hoop makes of waveforms [n, k]."""
    room = 2 * waves.shape[1]
    both = np.fft.fft(waves, room, axis=1) * np.fft.fft(hoop(), room)
    return np.asarray(np.fft.ifft(both, axis=1)[:, : waves.shape[1]])


def _hoop(telltale: Telltale, strength: float) -> None:
    """Ring as a hoop of iron does about a strut's antenna."""
    part = 0.33 * min(strength, 2.4) ** 0.8 * np.exp(2j * np.pi * telltale.alike(1).random())
    telltale.wave = telltale.wave + part * rung(telltale.by_air())


def _motors(telltale: Telltale, strength: float) -> None:
    due = EFFECTS["noise-floor"](telltale.hank(), strength)
    telltale.hiss(np.broadcast_to(due.hiss_db, telltale.rows))


def scattering(waves: Complexes) -> float:
    """Return how sizes scatter, as telltales say it of noise."""
    return float(np.abs(waves).std())


def _say(telltale: Telltale, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how sizes scatter as tried, at what is `of` a row [n]."""
    ways = np.array([scattering(made(one)) for one in tried.tolist()]) / scattering(SOME)
    telltale.noise_by = telltale.noise_by * np.interp(of, tried, ways).clip(0.04)


def buzzed(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of any pitch within a band and any phase, whose sizes go up and down.

    Of power 1 [rows, k]; ever so slowly next to their pitch, as a motor's brushes have it.
    """
    pitch, slow = rng.uniform(*BUZZES, (rows, 1)), rng.uniform(*SLOW, (rows, 1))
    turn, phase = rng.uniform(-np.pi, np.pi, (2, rows, 1))
    size = (1 + BRUSHES * np.cos(slow * PLACES + phase)) / np.sqrt(1 + 0.5 * BRUSHES**2)
    return np.asarray(size * np.exp(1j * (pitch * PLACES + turn)))


def _buzz(telltale: Telltale, strength: float) -> None:
    """Hear a motor's telegraph, one tone; some struts more."""
    near = 0.5 + 1.3 * telltale.alike(2).triangular(0.0, 0.35, 1.0, STRUTS)[telltale.hank().strut]
    size = 1.7 * strength * near
    heard = buzzed(telltale.rng, telltale.rows)
    telltale.wave = telltale.wave + (size * telltale.sigma)[:, None] * heard
    tones = buzzed(np.random.default_rng(4108), len(SOME))
    _say(telltale, size, np.linspace(0.0, 16.0, 49), lambda one: SOME + one * tones)
    telltale.sigma = telltale.sigma * np.sqrt(1 + 0.5 * size**2)


def in_steps(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of which either part is kept in whole steps [n, k]."""
    return np.asarray(step * (np.rint(waves.real / step) + 1j * np.rint(waves.imag / step)))


def _in_steps(telltale: Telltale, strength: float) -> None:
    step = 1.1 * strength * float(np.median(telltale.sigma))
    telltale.wave = in_steps(telltale.wave, step)
    tried = np.geomspace(0.05, 12.0, 60)
    _say(telltale, step / telltale.sigma, tried, lambda one: in_steps(SOME, one))


def _deaf(telltale: Telltale, strength: float) -> None:
    """Ask more of what is seen, as when a shift before was loud."""
    telltale.deaf = strength


def laid_of_three(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that from `begin` [n] on come by turns of three thirds of these."""
    made = sizes.copy()
    for row, first in enumerate(begin.tolist()):
        own = sizes[row, first:]
        long = len(own) - len(own) % 3
        made[row, first : first + long] = own[:long].reshape(3, -1).T.ravel()
    return made


def winched(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that from `begin` [n] on go after what they should be at some pace.

    At most by PACE of their mean at once.
    """
    late = np.arange(sizes.shape[1]) >= begin[:, None]
    pace = PACE * np.where(late, sizes, 0.0).sum(axis=1) / late.sum(axis=1)
    made = sizes.copy()
    for k in range(1, sizes.shape[1]):
        step = (sizes[:, k] - made[:, k - 1]).clip(-pace, pace)
        made[:, k] = np.where(late[:, k], made[:, k - 1] + step, sizes[:, k])
    return made


def among_sevens(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] that from `begin` [n] on tell how many of seven about are no larger.

    Times a quarter of these seven's mean.
    """
    wide = np.pad(sizes, ((0, 0), (ABOUT // 2, ABOUT // 2)), mode="edge")
    seven = np.lib.stride_tricks.sliding_window_view(wide, ABOUT, axis=1)
    place = (seven <= sizes[:, :, None]).sum(axis=2)
    late = np.arange(sizes.shape[1]) >= begin[:, None]
    return np.where(late, 0.25 * place * seven.mean(axis=2), sizes)


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(telltale: Telltale, strength: float) -> None:
        sizes = np.abs(telltale.wave).clip(1e-9)
        begin = np.ceil(telltale.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 24)
        part = min(most * strength, 1.0) * telltale.from_on(LATE)
        telltale.wave = telltale.wave * (1 + part * (made(sizes, begin) / sizes - 1))

    return act


WAVES: dict[str, Callable[[Telltale, float], None]] = {
    "obstructed-path": _hemp, "specular-reflections": _sides, "ground-bounce": _floor,
    "small-scale-fading": _fades, "diffuse-tail": _tail, "pulse-ringing": _hoop,
    "noise-floor": _motors, "narrowband-interference": _buzz,
    **dict(zip(OF_LATE_SIZES, (_odd(laid_of_three, 0.5), _odd(winched, 0.9),
                               _odd(among_sevens, 1.0)), strict=True)),
    "quantisation": _in_steps, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows owe what they do once waves were IN_THE_HALL, before telltales hear them."""
IN_THE_HALL = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
               "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the ropewalk's tables of ranges."""


def put_in(telltale: Telltale, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is in the hall, what rows owe, and what telltales do."""
    asked = [name for name in WAVES if name in names]
    for name in asked:
        if name in IN_THE_HALL:
            WAVES[name](telltale, strength)
    for name in sorted(set(names).difference(WAVES)):
        telltale.owe(EFFECTS[name](telltale.hank(), strength))
    for name in asked:
        if name not in IN_THE_HALL:
            WAVES[name](telltale, strength)
