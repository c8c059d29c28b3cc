"""What the cathedral hides in waveforms: effects in forms of its own, its lecterns' oddities.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.cathedral_effects import EFFECTS, off_the_floor
from bench.challenge.families.cathedral_lectern import (
    METRES,
    PLACES,
    WIDE_SAMPLES,
    Lectern,
    lingered,
    loudness,
    sough,
)
from bench.challenge.families.cathedral_nave import BOSSES, CROSS_M, NAVE_M, Vigil
from bench.challenge.families.cathedral_nave import LAWS as LAWS_OF_ROWS

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
ODDITIES = (
    "late-sizes-rung-in-changes", "late-sizes-by-a-needle-that-falls-slowly",
    "late-counts-begun-anew-when-full",
)  # fmt: skip
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "passus-from-one-boss"}
LAWS |= {name: Law() for name in ODDITIES}
LATE = 7.6  # samples past first paths from which lecterns are odd
SHARES = {"walls": 0.85, "ends": 0.8, "vault": 0.6}  # of the straight way
VAULT_M, NEXT = 14.8, 4.4  # how high; samples from which mirrors are heard
ABOUT, LULLS, DIES = 10, 2.1, 13.0  # ways about what hides; samples between; to 1 / e
BLURS, SPREAD = 3.0, 0.62  # samples over which fades are alike; of the strong wave
TAIL, BEGINS, HALF, POWER = 0.055, 3.2, 9.0, 1.9  # height; samples until; of these; of time
RINGS, TURNS, AFTER = 0.83, 1.15, 2.4  # of each sample's ring the next keeps; radians; samples
PITCHES, KEYED, DEEP = (0.5, 1.2), (0.11, 0.24), 0.25  # radians a sample; of keys; how deep
SOME: Complexes = sough(np.random.default_rng(5407), 160)  # noise to try readings on
FALLS = 0.84  # of a needle, in a sample
FULL = 1.25  # of the mean, at which counts begin anew


def by_a_plane(vigil: Vigil, axis: int, at_m: float) -> tuple[Floats, Floats]:
    """Return ways in m by a plane square to an axis, and where along these they meet it, [n] each.

    Where is a part of the way from tags; ends beyond the plane have none.
    """
    off = [np.abs(end[:, axis] - at_m) for end in (vigil.tag_m, vigil.boss_m)]
    part = off[0] / (off[0] + off[1]).clip(1e-9)
    return np.sqrt(vigil.far**2 + 4 * off[0] * off[1]), np.asarray(part)


def mirrors(vigil: Vigil) -> list[tuple[Floats, Floats]]:
    """Return ways in m by all that mirrors waves, and what share of straight ones these have.

    The nave's walls, but where the transept is, its ends and the vault.
    """
    made = []
    for at_m in NAVE_M[1]:
        way, part = by_a_plane(vigil, 1, at_m)
        along = vigil.tag_m[:, 0] + part * (vigil.boss_m[:, 0] - vigil.tag_m[:, 0])
        inside = [(end[:, 1] - NAVE_M[1][0]) * (NAVE_M[1][1] - end[:, 1]) > 0
                  for end in (vigil.tag_m, vigil.boss_m)]  # fmt: skip
        there = inside[0] & inside[1] & ((along < CROSS_M[0][0]) | (along > CROSS_M[0][1]))
        made.append((way, SHARES["walls"] * there))
    for at_m in NAVE_M[0]:
        way, part = by_a_plane(vigil, 0, at_m)
        across = vigil.tag_m[:, 1] + part * (vigil.boss_m[:, 1] - vigil.tag_m[:, 1])
        made.append((way, SHARES["ends"] * ((across > NAVE_M[1][0]) & (across < NAVE_M[1][1]))))
    made.append((by_a_plane(vigil, 2, VAULT_M)[0], np.full(vigil.rows, SHARES["vault"])))
    return [(way, share * vigil.far / way) for way, share in made]


def _mirrors(lectern: Lectern, strength: float) -> None:
    """Hear walls, ends and the vault; plaster has come off some of these."""
    vigil, straight = lectern.vigil(), lectern.by_air() * lectern.direct()
    for way, share in mirrors(vigil):
        samples = (way - vigil.far) / METRES
        whole = vigil.each(lambda n: lectern.rng.beta(3.0, 1.2, n))
        part = (1.8 * np.sqrt(strength) * whole * share).clip(max=0.9) * (samples > NEXT)
        lectern.echo(straight, part * lectern.any_phases(), samples)


def _floor(lectern: Lectern, strength: float) -> None:
    longer, share = off_the_floor(lectern.vigil(), strength)
    lectern.echo(lectern.by_air(), share, longer / METRES)


def _hidden(lectern: Lectern, strength: float) -> None:
    """Lose what comes straight behind things: waves come about these by chance, and die off."""
    vigil, rng, air = lectern.vigil(), lectern.rng, lectern.by_air()
    shut = vigil.shut_off(0.2)
    lectern.fade(-33.0 * shut[:, None] * lectern.direct())
    soon = vigil.each(lambda n: 1.6 + rng.gamma(4.0, 0.2, n).clip(max=1.6))
    since = np.zeros(vigil.rows)
    for _ in range(ABOUT):
        size = 0.52 * shut * np.exp(-since / DIES) * rng.uniform(0.6, 1.3, vigil.rows)
        late = soon * (0.4 + 0.6 * strength**0.7) + since
        lectern.echo(air, size * lectern.any_phases(), late)
        since = since + vigil.each(lambda n: rng.exponential(LULLS, n))


def strong_and_weak(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of a strong wave amid weak ones, of power 1.

    (Rice 1948.) Weak ones are blurred along samples.
    """
    off = np.arange(-3 * int(BLURS), 3 * int(BLURS) + 1)
    bell = np.exp(-0.5 * (off / BLURS) ** 2)
    bell /= np.sqrt((bell**2).sum())
    drawn = rng.standard_normal((2, rows, WIDE_SAMPLES + len(off) - 1))
    weak = np.lib.stride_tricks.sliding_window_view(drawn, len(off), axis=2) @ bell
    size = np.hypot(1 + SPREAD * weak[0], SPREAD * weak[1])
    return np.asarray(size / np.sqrt(1 + 2 * SPREAD**2))


def _fades(lectern: Lectern, strength: float) -> None:
    """Fade as a strong wave amid weak ones does; of what comes straight, all alike."""
    size = strong_and_weak(lectern.rng, lectern.rows) ** min(strength**0.5, 1.6)
    top = np.rint(lectern.at + 1.0).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    straight = np.take_along_axis(size, top[:, None], axis=1).clip(0.3)
    direct = lectern.direct()
    size = size * (1 - direct) + straight * direct
    size = size / np.sqrt((size**2).mean())
    lectern.wave = lectern.wave + (size - 1) * lectern.by_air()


def reverberant(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...]: by a power of time, of long halls."""
    return np.where(since >= 0, (1 + since.clip(0.0) / HALF) ** -POWER, 0.0)


def _tail(lectern: Lectern, strength: float) -> None:
    power = TAIL * strength * reverberant(lectern.off - BEGINS) * lectern.since(BEGINS)
    high = loudness(lectern.wave, lectern.at, lectern.sigma)
    lectern.whisper(np.sqrt(0.5 * power) * high[:, None])


def pipe(waves: Complexes) -> Complexes:
    """Return how a pipe rings of waveforms, of power 1 [n, k]: it turns, and dies off evenly."""
    blown = lingered(waves, np.full(len(waves), AFTER))
    made = np.zeros(waves.shape, np.complex128)
    keeps = RINGS * np.exp(1j * TURNS)
    for k in range(waves.shape[1]):
        made[:, k] = blown[:, k] + (keeps * made[:, k - 1] if k else 0.0)
    return np.asarray(made * np.sqrt(1 - RINGS**2))


def _pipe(lectern: Lectern, strength: float) -> None:
    """Ring as a pipe does, at a phase that all have alike."""
    phase = np.exp(1j * lectern.alike(6).uniform(-np.pi, np.pi))
    part = 0.36 * min(strength, 2.3) ** 0.8 * phase
    lectern.wave = lectern.wave + part * pipe(lectern.by_air())


def _organs(lectern: Lectern, strength: float) -> None:
    dues = EFFECTS["noise-floor"](lectern.vigil(), strength)
    lectern.louder(np.zeros(lectern.rows) + dues.noise_db)


def unlike(waves: Complexes) -> float:
    """Return by how much two sizes differ in the mean (Gini 1912), as lecterns say it."""
    sizes = np.sort(np.abs(waves).ravel())
    rank = 2.0 * np.arange(len(sizes)) - len(sizes) + 1
    return float(2 * (rank * sizes).mean() / len(sizes))


def _say(lectern: Lectern, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how unlike sizes are as tried, at what is `of` a row [n]."""
    by = np.array([unlike(made(one)) for one in tried.tolist()]) / unlike(SOME)
    lectern.noise_by = lectern.noise_by * np.interp(of, tried, by).clip(0.05)


def keyed(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones of power 1 whose sizes go up and down, as a tremulant's do [rows, k]."""
    pitch, key = (rng.uniform(*one, (rows, 1)) for one in (PITCHES, KEYED))
    turn, begins = rng.uniform(-np.pi, np.pi, (2, rows, 1))
    size = (1 + DEEP * np.sin(key * PLACES + begins)) / np.sqrt(1 + 0.5 * DEEP**2)
    return np.asarray(size * np.exp(1j * (pitch * PLACES + turn)))


def _keyed(lectern: Lectern, strength: float) -> None:
    """Hear a tremulant's relay; some bosses more."""
    near = lectern.alike(7).triangular(0.4, 1.2, 2.2, BOSSES)[lectern.vigil().boss]
    size = 0.78 * strength * near
    lectern.wave = lectern.wave + (size * lectern.sigma)[:, None] * keyed(lectern.rng, lectern.rows)
    tones = keyed(np.random.default_rng(5408), len(SOME))
    _say(lectern, size, np.linspace(0.0, 9.0, 46), lambda one: SOME + one * tones)
    lectern.sigma = lectern.sigma * np.sqrt(1 + 0.5 * size**2)


def cut_off(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of either part of which whole steps are kept, the rest cut off [n, k]."""
    return np.asarray(step * (np.trunc(waves.real / step) + 1j * np.trunc(waves.imag / step)))


def _cut_off(lectern: Lectern, strength: float) -> None:
    step = 0.6 * strength * float(np.median(lectern.sigma))
    lectern.wave = cut_off(lectern.wave, step)
    tried = np.geomspace(0.04, 8.0, 54)
    _say(lectern, step / lectern.sigma, tried, lambda one: cut_off(SOME, one))


def _deaf(lectern: Lectern, strength: float) -> None:
    """Ask more of what is heard, as while the full organ plays."""
    lectern.deaf = strength


def in_changes(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] of which, from `begin` [n] on, each pair is heard the other way round."""
    place = np.arange(sizes.shape[1])
    since = place - begin[:, None]
    other = np.where(since >= 0, place + 1 - 2 * (since % 2), place)
    return np.take_along_axis(sizes, other.clip(0, sizes.shape[1] - 1), axis=1)


def by_a_needle(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] as from `begin` [n] on a needle has them, which falls slowly."""
    made = sizes.copy()
    for k in range(1, sizes.shape[1]):
        made[:, k] = np.where(k > begin, np.maximum(sizes[:, k], FALLS * made[:, k - 1]),
                              sizes[:, k])  # fmt: skip
    return made


def begun_anew(sizes: Floats, begin: Integers) -> Floats:
    """Return sizes [n, k] of which, from `begin` [n] on, what is full is taken off as often.

    Counts are full at FULL of the mean of these.
    """
    late = np.arange(sizes.shape[1]) >= begin[:, None]
    full = FULL * ((sizes * late).sum(axis=1) / late.sum(axis=1).clip(1))[:, None]
    return np.where(late, sizes % full.clip(1e-9), sizes)


def _odd(made: Callable[[Floats, Integers], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(lectern: Lectern, strength: float) -> None:
        sizes = np.abs(lectern.wave).clip(1e-9)
        begin = np.ceil(lectern.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 20)
        part = min(most * strength, 1.0) * lectern.since(LATE)
        lectern.wave = lectern.wave * (1 + part * (made(sizes, begin) / sizes - 1))

    return act


WAVES: dict[str, Callable[[Lectern, float], None]] = {
    "obstructed-path": _hidden, "specular-reflections": _mirrors, "ground-bounce": _floor,
    "small-scale-fading": _fades, "diffuse-tail": _tail, "pulse-ringing": _pipe,
    "noise-floor": _organs, "narrowband-interference": _keyed,
    **dict(zip(ODDITIES, (_odd(in_changes, 0.75), _odd(by_a_needle, 0.8),
                          _odd(begun_anew, 0.8)), strict=True)),
    "quantisation": _cut_off, "late-detection": _deaf,
}  # fmt: skip
"""In turn; rows pay what they do once waves were ON_THE_WAY, before lecterns hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the cathedral's tables of ranges."""


def hide(lectern: Lectern, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what rows pay, and what lecterns do."""
    on_the_way = [name for name in ON_THE_WAY if name in names]
    within = [name for name in WAVES if name in names and name not in ON_THE_WAY]
    for name in on_the_way:
        WAVES[name](lectern, strength)
    for name in sorted({*names} - {*WAVES}):
        lectern.pay(EFFECTS[name](lectern.vigil(), strength))
    for name in within:
        WAVES[name](lectern, strength)
