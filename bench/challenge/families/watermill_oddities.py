"""What the watermill's hoppers do amiss with late parts of waveforms, which no library has.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.watermill_hopper import WIDE_SAMPLES, Hopper

Floats = NDArray[np.float64]
LATE = 7.0  # samples past first paths from which hoppers are odd
ROOT, LEAKS, FOLDS, HUM, DEEP = 0.45, 0.72, 1.35, 15.0, 0.75
"""Of sizes; that is left each sample; of medians; samples of a swing, and its part."""
SHAFT, RETURNS, SOAKS = 8.6, 0.62, 15.0  # samples there and back; part; samples to 1 / e


def woven(late: Floats) -> Floats:
    """Return late sizes of which each dozen's halves are woven into each other."""
    whole = len(late) // 12 * 12
    dozens = late[:whole].reshape(-1, 2, 6).transpose(0, 2, 1)
    return np.concatenate([dozens.ravel(), late[whole:]])


def rooted(late: Floats) -> Floats:
    """Return late sizes as a meter tells them that is not straight: by a power, as large all told.

    Small ones are told too large.
    """
    made = late**ROOT
    return np.asarray(made * late.mean() / made.mean())


def leaked(late: Floats) -> Floats:
    """Return late sizes through a store that leaks, and that each fills by as much."""
    made, store = np.empty(len(late)), float(late[0])
    for k, one in enumerate(late):
        store = LEAKS * store + (1 - LEAKS) * one
        made[k] = store
    return made


def crested(late: Floats) -> Floats:
    """Return late sizes each as large as the largest beside it, all told as large as before."""
    beside = np.stack([np.roll(late, 1), late, np.roll(late, -1)])
    beside[0, 0], beside[2, -1] = late[0], late[-1]
    made = beside.max(axis=0)
    return np.asarray(made * late.mean() / made.mean())


def bridged(late: Floats) -> Floats:
    """Return late sizes of which every other is told as the middle of what is beside it."""
    made = late.copy()
    lost = np.arange(1, len(late) - 1, 2)
    made[lost] = 0.5 * (late[lost - 1] + late[lost + 1])
    return made


def hummed(late: Floats) -> Floats:
    """Return late sizes by a gain that swings with what feeds it."""
    return np.asarray(late * (1 + DEEP * np.sin(2 * np.pi * np.arange(len(late)) / HUM)))


def folded(late: Floats) -> Floats:
    """Return late sizes of which what is over a ceiling is folded back under it."""
    ceiling = FOLDS * float(np.median(late))
    over = late % (2 * ceiling)
    return np.where(over > ceiling, 2 * ceiling - over, over)


def from_amid(late: Floats) -> Floats:
    """Return late sizes of which each nine are told from the middle outwards, by turns."""
    whole = len(late) // 9 * 9
    nines = late[:whole].reshape(-1, 9)[:, [4, 3, 5, 2, 6, 1, 7, 0, 8]]
    return np.concatenate([nines.ravel(), late[whole:]])


def _told(made: Callable[[Floats], Floats], most: float) -> Callable[[Hopper, float], None]:
    """Return what lets late sizes be told as others, by a part `most` at strength 1.

    Phases stay.
    """

    def act(hopper: Hopper, strength: float) -> None:
        sizes = np.abs(hopper.wave) + 1e-9
        other = sizes.copy()
        begins = np.ceil(hopper.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 36)
        for row, begin in enumerate(begins):
            other[row, begin:] = made(sizes[row, begin:])
        part = min(most * strength, 1.0) * hopper.after(LATE)
        hopper.wave = hopper.wave * (1 + part * (other / sizes - 1))

    return act


def _shaft(hopper: Hopper, strength: float) -> None:
    """Hear what comes late again and again, from the ends of a hollow shaft."""
    late = hopper.after(LATE - 1.0) * hopper.came()
    part = RETURNS * min(strength, 1.4) ** 0.7
    for times in (1, 2, 3):
        samples = np.full(hopper.rows, times * SHAFT)
        hopper.repeat(late, part**times * hopper.turns(), samples)


def _chaff(hopper: Hopper, strength: float) -> None:
    """Lose more of what comes the later it comes, as chaff soaks it up; noise stays."""
    since = hopper.after(LATE) * (np.arange(WIDE_SAMPLES) - hopper.at[:, None] - LATE).clip(0.0)
    hopper.lose(-20 / np.log(10) * strength * (since / SOAKS).clip(max=4.0))


ODDITIES: dict[str, Callable[[Hopper, float], None]] = {
    "hollow-shaft-repeats-what-comes-late": _shaft,
    "chaff-soaks-up-what-comes-late": _chaff,
    "late-dozens-woven-from-halves": _told(woven, 0.75),
    "late-sizes-told-by-a-bent-meter": _told(rooted, 0.9),
    "late-sizes-through-a-leaking-store": _told(leaked, 0.85),
    "late-sizes-as-large-as-those-beside": _told(crested, 0.9),
    "every-other-late-size-bridged": _told(bridged, 0.95),
    "late-gain-hums": _told(hummed, 0.75),
    "late-sizes-folded-under-a-ceiling": _told(folded, 0.9),
    "late-nines-told-from-amid": _told(from_amid, 0.75),
}
"""What is hidden in late parts; in turn."""
