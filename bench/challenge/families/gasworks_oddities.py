"""What the gasworks' pipes and meters do to late parts of waveforms, which no library has.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.gasworks_meter import PLACES, WIDE_SAMPLES, Meter, piped_later

Floats = NDArray[np.float64]
LATE = 9.0  # samples past first paths from which meters are odd
PIPE, PIPE_KEEPS, PIPE_TURN = 6, 0.62, 2.2  # turns of a pipe; part each leaves; radians of each
FOG, FOG_EACH = 5, 3.1  # times that fog scatters; samples of each at most
FLICKERS, BLOCK = 0.6, 9  # of a flame's gamma; samples of a flicker
MAIN_SLOWER, MAIN_PART = 0.5, 0.6  # parts of straight ways that mains' are longer; that comes
CORED, DOUBLES, SINKS, FALLS, STAIR = 1.3, 5.0, 0.5, 0.86, 14
"""Of medians; from step to step; each stair; backwards each sample; samples of a stair."""


def thirds(late: Floats) -> Floats:
    """Return late sizes of which each nine's thirds are told the last first."""
    whole = len(late) // 9 * 9
    nines = late[:whole].reshape(-1, 3, 3)[:, ::-1]
    return np.concatenate([nines.ravel(), late[whole:]])


def mingled(late: Floats) -> Floats:
    """Return late sizes as roots of what they make with the third after."""
    after = np.concatenate([late[3:], late[-3:]])
    return np.asarray(np.sqrt(late * after))


def cored(late: Floats) -> Floats:
    """Return late sizes less what a part of their median is, none below nought."""
    return np.asarray((late - CORED * float(np.median(late))).clip(0.02 * late))


def doubled(late: Floats) -> Floats:
    """Return late sizes by whole steps of logarithms, of which the middle is the median."""
    middle = float(np.median(late))
    return np.asarray(middle * DOUBLES ** np.rint(np.log(late / middle) / np.log(DOUBLES)))


def held(late: Floats) -> Floats:
    """Return late sizes of which each four are told as the first of these."""
    return np.asarray(np.repeat(late[::4], 4)[: len(late)])


def stairs(late: Floats) -> Floats:
    """Return late sizes by a gain that falls by stairs, three down and up again."""
    return np.asarray(late * SINKS ** (np.arange(len(late)) // STAIR % 3))


def foreshown(late: Floats) -> Floats:
    """Return late sizes told backwards by a needle that falls slowly, as large all told."""
    made, needle = np.empty(len(late)), 0.0
    for k in range(len(late) - 1, -1, -1):
        needle = max(float(late[k]), FALLS * needle)
        made[k] = needle
    return np.asarray(made * late.mean() / made.mean())


def _told(made: Callable[[Floats], Floats], most: float) -> Callable[[Meter, float], None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(meter: Meter, strength: float) -> None:
        sizes = np.abs(meter.wave) + 1e-9
        other = sizes.copy()
        for row, at in enumerate(np.ceil(meter.at + LATE).clip(0, WIDE_SAMPLES - 40).tolist()):
            other[row, int(at) :] = made(sizes[row, int(at) :])
        part = min(most * strength, 1.0) * meter.behind(LATE)
        meter.wave = meter.wave * (1 - part + part * other / sizes)

    return act


def _pipe(meter: Meter, strength: float) -> None:
    """Hear a pipe sound on at its own pitch with what comes late."""
    late = meter.behind(LATE - 2.0) * meter.came()
    part = 0.75 * min(strength, 2.0) ** 0.7
    for turn in range(1, PIPE + 1):
        share = np.full(meter.rows, part * PIPE_KEEPS**turn * np.exp(1j * PIPE_TURN * turn))
        meter.again(late, share, np.full(meter.rows, 1.4 * turn))


def _fog(meter: Meter, strength: float) -> None:
    """Scatter what comes late in fog of tar, by chance and a little later each time."""
    late = meter.behind(LATE - 2.0) * meter.came()
    for time in range(FOG):
        size = 0.42 * min(strength, 2.0) ** 0.7 * np.sqrt(meter.rng.exponential(1.0, meter.rows))
        samples = FOG_EACH * (time + meter.rng.random(meter.rows))
        meter.again(late, size.clip(max=0.8) * meter.turned(), samples)


def _flickers(meter: Meter, strength: float) -> None:
    """Let what comes late flicker by blocks, as through flames (a gamma law)."""
    shape = FLICKERS / strength
    size = np.sqrt(meter.rng.gamma(shape, 1 / shape, (meter.rows, WIDE_SAMPLES // BLOCK + 1)))
    size = np.repeat(size, BLOCK, axis=1)[:, :WIDE_SAMPLES].clip(max=3.0)
    meter.wave = meter.wave + meter.behind(LATE) * (size - 1) * meter.came()


def _main(meter: Meter, strength: float) -> None:
    """Hear what mains guide: all once more, the later the farther the slower it is in these."""
    samples = LATE + 4.0 + MAIN_SLOWER * meter.charge().far / meter.metres
    came, share = meter.came(), MAIN_PART * min(strength, 1.6) ** 0.6 * meter.turned()
    late = piped_later(came, samples.clip(max=60.0))
    meter.wave = meter.wave + (PLACES - meter.at[:, None] > LATE) * share[:, None] * late


ODDITIES: dict[str, Callable[[Meter, float], None]] = {
    "pipe-sounds-on-with-what-comes-late": _pipe,
    "tar-fog-scatters-what-comes-late": _fog,
    "flames-flicker-what-comes-late": _flickers,
    "mains-guide-what-comes-late": _main,
    "late-nines-told-by-thirds-backwards": _told(thirds, 0.75),
    "late-sizes-mingled-with-the-third-after": _told(mingled, 0.9),
    "late-sizes-cored-of-their-middle": _told(cored, 0.95),
    "late-sizes-by-steps-of-logarithms": _told(doubled, 0.9),
    "late-fours-told-as-their-first": _told(held, 0.75),
    "late-gain-falls-by-stairs": _told(stairs, 0.85),
    "late-sizes-foreshown-by-a-needle": _told(foreshown, 0.85),
}
"""What is hidden in late parts; in turn."""
