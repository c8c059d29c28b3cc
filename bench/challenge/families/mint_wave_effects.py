"""What the mint hides in waveforms: effects in forms of its own, its assays' oddities.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.mint_assay import (
    PLACES,
    WIDE_SAMPLES,
    Assay,
    heights,
    jingling,
    rolled_later,
)
from bench.challenge.families.mint_court import LAWS as LAWS_OF_ROWS
from bench.challenge.families.mint_court import ROOM_M, TAGS, Tally
from bench.challenge.families.mint_effects import EFFECTS, off_marble

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
ODDITIES = (
    "late-eights-told-with-bits-reversed", "late-sizes-evened-by-a-gain-that-follows",
    "late-sizes-dead-after-crests", "late-sizes-read-by-a-slower-clock",
    "late-sixes-told-by-size", "every-ninth-late-size-left-out",
    "grilles-disperse-what-comes-late",
)  # fmt: skip
LAWS = {name: law for name, law in LAWS_OF_ROWS.items() if name != "toises-from-one-quoin"}
LAWS |= {name: Law() for name in ODDITIES}
LATE = 7.2  # samples past first paths from which assays are odd
WALL, VAULT, NEXT = 0.62, 0.5, 4.9  # shares; samples from which these are heard
BENT, LULLS_M, DIES_M = 8, 0.62, 3.4  # ways about what hides; between these; to 1 / e
KEPT, STEADY = 0.74, 1.15  # of fades from sample to sample; of what does not fade, next to these
TAIL, BEGINS, SOON, LONG = 0.021, 3.2, 8.0, 46.0  # power; samples until; to 1 / e of either part
RINGS, RING_AT, RING_EACH, RING_KEEPS = 7, 4.5, 1.6, 0.72  # of a ring; samples; part that is left
RING_TURN = 1.9  # radians from each to the next
PITCHES, BEATS = (0.3, 2.6), (0.06, 0.16)  # radians a sample, of tones; of what these beat with
DEAD, SLOW, SPREAD = 0.2, 0.9, 4.0  # left after crests; of clocks; samples of delay by pitch
SOME: Complexes = jingling(np.random.default_rng(7307), 160)  # noise to try readings on


def by_faces(tally: Tally) -> list[tuple[Floats, Floats]]:
    """Return ways in m by outer walls and vaults, and what share of straight ones [n] comes."""
    made = []
    for axis, side in ((0, 0.0), (0, ROOM_M[0]), (1, 0.0), (1, ROOM_M[1]), (2, ROOM_M[2])):
        image = tally.tag_m.copy()
        image[:, axis] = 2 * side - image[:, axis]
        way = np.linalg.norm(image - tally.quoin_m, axis=1)
        made.append((way, (VAULT if axis == 2 else WALL) * tally.far / way))
    return made


def _faces(assay: Assay, strength: float) -> None:
    """Hear walls and vaults; hangings are before some of these."""
    tally, first = assay.tally(), assay.came() * assay.direct()
    for way, share in by_faces(tally):
        samples = (way - tally.far) / assay.metres
        bare = tally.links(lambda n: assay.rng.beta(2.5, 1.5, n))
        part = 1.5 * np.sqrt(strength) * bare * share * (samples > NEXT)
        assay.echo(first, part.clip(max=0.85) * assay.by_chance(), samples)


def _floor(assay: Assay, strength: float) -> None:
    longer, share = off_marble(assay.tally(), strength)
    assay.echo(assay.came(), share, longer / assay.metres)


def _shut(assay: Assay, strength: float) -> None:
    """Lose what comes straight behind things: ways bend about these, each by its own dB."""
    tally, rng, came = assay.tally(), assay.rng, assay.came()
    cut = tally.cut_off(0.2)
    assay.dim(-33.0 * cut[:, None] * assay.direct())
    first = tally.links(lambda n: 0.5 + 0.9 * rng.beta(1.4, 1.8, n))
    late = first = first * (0.5 + 0.5 * strength**0.8)
    for _ in range(BENT):
        fades = 10 ** (0.15 * rng.standard_normal(tally.rows).clip(-2.0, 2.0))
        size = cut * 0.46 * np.exp(-(late - first) / DIES_M) * fades
        assay.echo(came, size.clip(max=0.8) * assay.by_chance(), late / assay.metres)
        late = late + tally.links(lambda n: LULLS_M * rng.uniform(0.5, 1.5, n))


def wavering(rng: np.random.Generator, rows: int) -> Floats:
    """Return sizes by chance [rows, WIDE_SAMPLES] of power 1: steady, and what forgets evenly.

    (Rice 1944; Ornstein and Uhlenbeck 1930.)
    """
    even = rng.standard_normal((WIDE_SAMPLES, rows, 2)) @ np.array([1.0, 1.0j]) / np.sqrt(2)
    made = np.empty((WIDE_SAMPLES, rows), np.complex128)
    made[0] = even[0]
    for at in range(1, WIDE_SAMPLES):
        made[at] = KEPT * made[at - 1] + np.sqrt(1 - KEPT**2) * even[at]
    return np.asarray(np.abs(STEADY + made.T) / np.sqrt(1 + STEADY**2))


def _fades(assay: Assay, strength: float) -> None:
    """Fade from sample to sample; of what comes straight, all alike."""
    size = wavering(assay.rng, assay.rows) ** min(1.1 * np.sqrt(strength), 1.7)
    top = np.rint(assay.at + 1.3).astype(np.int64).clip(0, WIDE_SAMPLES - 1)
    straight = assay.direct()
    first = np.take_along_axis(size, top[:, None], axis=1).clip(0.35)
    size = straight * first + (1 - straight) * size
    assay.wave = assay.wave + (size / np.sqrt((size**2).mean()) - 1) * assay.came()


def two_slopes(since: Floats) -> Floats:
    """Return a tail's power by samples since it began [...], of a near hall and a far one."""
    late = since.clip(0.0)
    return np.asarray((0.7 * np.exp(-late / SOON) + 0.3 * np.exp(-late / LONG)) * (since > 0))


def _tail(assay: Assay, strength: float) -> None:
    """Hear all else of two halls, one of which dies away sooner."""
    high = heights(assay.wave, assay.at, assay.sigma)[:, None]
    power = TAIL * strength * two_slopes(PLACES - assay.at[:, None] - BEGINS)
    assay.jingle(high * np.sqrt(power) * assay.past(BEGINS))


def ringing(waves: Complexes) -> Complexes:
    """Return what rings on after waveforms, ever less and at a pitch of its own, of power 1."""
    made = np.zeros(waves.shape, np.complex128)
    for turn in range(RINGS):
        late = np.full(len(waves), RING_AT + turn * RING_EACH)
        made += RING_KEEPS**turn * np.exp(1j * RING_TURN * turn) * rolled_later(waves, late)
    return np.asarray(made * np.sqrt(1 - RING_KEEPS**2))


def _rings(assay: Assay, strength: float) -> None:
    """Hear quoins' holders ring, all at one pitch."""
    part = 0.34 * min(strength, 2.2) ** 0.8 * np.exp(1j * assay.alike(5).uniform(-np.pi, np.pi))
    assay.wave = assay.wave + part * ringing(assay.came())


def _furnace(assay: Assay, strength: float) -> None:
    toll = EFFECTS["noise-floor"](assay.tally(), strength)
    assay.roar(np.zeros(assay.rows) + toll.noise_db)


def by_fives(waves: Complexes) -> float:
    """Return how sizes scatter within fives, as assays say of noise."""
    sizes = np.abs(waves)
    fives = sizes[:, : sizes.shape[1] // 5 * 5].reshape(len(sizes), -1, 5)
    return float(np.sqrt(fives.var(axis=2, ddof=1).mean()))


def _say(assay: Assay, of: Floats, tried: Floats, made: Callable[[float], Complexes]) -> None:
    """Say of noise how sizes scatter as tried, at what is `of` a row [n]."""
    by = np.array([by_fives(made(float(one))) for one in tried]) / by_fives(SOME)
    assay.noise_by = assay.noise_by * np.interp(of, tried, by).clip(0.05)


def beating(rng: np.random.Generator, rows: int) -> Complexes:
    """Return tones that beat with others, as two motors do, of power 1 [rows, WIDE_SAMPLES]."""
    pitch, beat = rng.uniform(*PITCHES, (rows, 1)), rng.uniform(*BEATS, (rows, 1))
    phase, other = rng.uniform(-np.pi, np.pi, (2, rows, 1))
    first = np.exp(1j * (pitch * PLACES + phase))
    return np.asarray((first + 0.6 * np.exp(1j * ((pitch + beat) * PLACES + other))) / 1.36**0.5)


def _beats(assay: Assay, strength: float) -> None:
    """Hear motors of rolling mills; some tags more."""
    near = assay.alike(6).triangular(0.4, 0.9, 1.8, len(TAGS))[assay.tally().tag]
    size = 0.9 * strength * near
    assay.wave = assay.wave + (size * assay.sigma)[:, None] * beating(assay.rng, assay.rows)
    tones = beating(np.random.default_rng(7308), len(SOME))
    _say(assay, size, np.linspace(0.0, 9.0, 46), lambda one: SOME + one * tones)
    assay.sigma = assay.sigma * np.sqrt(1 + 0.5 * size**2)


def clipped_off(waves: Complexes, step: float) -> Complexes:
    """Return waveforms of either part of which what is beyond whole steps is clipped off [n, k]."""
    return np.asarray(step * (np.trunc(waves.real / step) + 1j * np.trunc(waves.imag / step)))


def _clips(assay: Assay, strength: float) -> None:
    step = 0.5 * strength * float(np.median(assay.sigma))
    assay.wave = clipped_off(assay.wave, step)
    tried = np.geomspace(0.03, 12.0, 60)
    _say(assay, step / assay.sigma, tried, lambda one: clipped_off(SOME, one))


def _dull(assay: Assay, strength: float) -> None:
    """Ask more of what is heard, as assays do whose touchstone is dull."""
    assay.dull = strength


def reversed_bits(late: Floats) -> Floats:
    """Return late sizes of which each eight are told in the order of their bits reversed."""
    whole = len(late) // 8 * 8
    eights = late[:whole].reshape(-1, 8)[:, [0, 4, 2, 6, 1, 5, 3, 7]]
    return np.concatenate([eights.ravel(), late[whole:]])


def evened(late: Floats) -> Floats:
    """Return late sizes by a gain that follows what nine are, to the power of a half and more."""
    nine, there = np.ones(9), np.ones(len(late))
    near = np.convolve(late, nine, "same") / np.convolve(there, nine, "same")
    made = late / near**0.7
    return np.asarray(made * late.mean() / made.mean())


def dead(late: Floats) -> Floats:
    """Return late sizes of which little is left for two samples after crests."""
    crest = np.zeros(len(late), np.bool_)
    crest[1:-1] = (late[1:-1] > late[:-2]) & (late[1:-1] >= late[2:])
    lost = np.zeros(len(late), np.bool_)
    for after in (1, 2):
        lost[after:] |= crest[:-after]
    return np.where(lost, DEAD * late, late)


def slower(late: Floats) -> Floats:
    """Return late sizes as a clock reads them that is slower: later ones, stretched."""
    at = np.arange(len(late))
    return np.asarray(np.interp(SLOW * at, at, late))


def by_size(late: Floats) -> Floats:
    """Return late sizes of which each six are told by size, the least first."""
    whole = len(late) // 6 * 6
    return np.concatenate([np.sort(late[:whole].reshape(-1, 6), axis=1).ravel(), late[whole:]])


def ninths_out(late: Floats) -> Floats:
    """Return late sizes without every ninth, closed up; at the end as many are told again."""
    kept = late[np.arange(len(late)) % 9 != 8]
    return np.concatenate([kept, kept[-(len(late) - len(kept)) :]])


def _odd(made: Callable[[Floats], Floats], most: float) -> Callable[..., None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(assay: Assay, strength: float) -> None:
        sizes = np.abs(assay.wave) + 1e-9
        other = sizes.copy()
        begin = np.ceil(assay.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 30)
        for row, first in enumerate(begin.tolist()):
            other[row, first:] = made(sizes[row, first:])
        part = min(most * strength, 1.0) * assay.past(LATE)
        assay.wave = assay.wave * (1 + part * (other / sizes - 1))

    return act


def dispersed(waves: Complexes, samples: float) -> Complexes:
    """Return waveforms of which pitches come the later the farther off, as from waveguides."""
    pitch = 2 * np.pi * np.fft.fftfreq(2 * waves.shape[1])
    turned = np.fft.fft(waves, len(pitch), axis=1) * np.exp(-0.5j * samples * pitch * np.abs(pitch))
    return np.asarray(np.fft.ifft(turned, axis=1)[:, : waves.shape[1]])


def _disperses(assay: Assay, strength: float) -> None:
    """Draw out what comes late, through grilles; how much of noise there is stays."""
    late = assay.past(LATE)
    made = dispersed(late * assay.wave, SPREAD * strength)
    assay.wave = (1 - late) * assay.wave + assay.past(LATE - 1.0) * made


WAVES: dict[str, Callable[[Assay, float], None]] = {
    "obstructed-path": _shut, "specular-reflections": _faces,
    "ground-bounce": _floor, "small-scale-fading": _fades, "diffuse-tail": _tail,
    "grilles-disperse-what-comes-late": _disperses,
    "pulse-ringing": _rings, "noise-floor": _furnace, "narrowband-interference": _beats,
    "late-eights-told-with-bits-reversed": _odd(reversed_bits, 0.75),
    "late-sizes-evened-by-a-gain-that-follows": _odd(evened, 0.9),
    "late-sizes-dead-after-crests": _odd(dead, 0.9),
    "late-sizes-read-by-a-slower-clock": _odd(slower, 0.8),
    "late-sixes-told-by-size": _odd(by_size, 0.85),
    "every-ninth-late-size-left-out": _odd(ninths_out, 0.9),
    "quantisation": _clips, "late-detection": _dull,
}  # fmt: skip
"""In turn; rows pay what they do once waves were ON_THE_WAY, before assays hear them."""
ON_THE_WAY = ("obstructed-path", "specular-reflections", "ground-bounce", "small-scale-fading",
              "diffuse-tail", "grilles-disperse-what-comes-late")  # fmt: skip
ELSEWHERE = {*LAWS_OF_ROWS, *WAVES, "blocked-path", "range-rounding"}
OF_RANGES = tuple(name for name in EFFECTS if name not in ELSEWHERE)
"""Effects that are those of the mint's tables of ranges."""


def hide(assay: Assay, names: tuple[str, ...], strength: float) -> None:
    """Put into waveforms what is on the way, what is taken of rows, and what assays do."""
    for name in (one for one in ON_THE_WAY if one in names):
        WAVES[name](assay, strength)
    for name in sorted({*names} - {*WAVES}):
        assay.exact(EFFECTS[name](assay.tally(), strength))
    for name, act in WAVES.items():
        if name in names and name not in ON_THE_WAY:
            act(assay, strength)
