"""What the lighthouse's rock and lenses do to late parts of waveforms, which no library has.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.lighthouse_lens import PLACES, WIDE_SAMPLES, Lens

Floats = NDArray[np.float64]
LATE = 9.0  # samples past first paths from which lenses are odd
PRISMS, FAN = ((3.4, 1.0), (7.7, -0.75), (12.9, 0.6)), 0.55  # samples and shares; of all that
SHADOW, WIDTH, DARK = (14.0, 44.0), (16.0, 34.0), 0.96  # samples from first paths; part lost
WASHES = 0.42  # e-folds of what is lost in each stretch of swell
STRETCH = 22.0  # samples
LIT, DARK_GAIN, FLASH, NIGHT = 3, 0.15, 5, 12  # flashes; between these; samples of both
DIPS, RUNS, WOUND = 1.0, 0.05, 42  # of running means; least gain; samples until wound again
SLOWER = 14.0  # samples in which time is told by its logarithm


def odd_and_even(late: Floats) -> Floats:
    """Return late sizes of which each eight's second, fourth and so on come before the others."""
    whole = len(late) // 8 * 8
    eights = late[:whole].reshape(-1, 8)
    return np.concatenate([eights[:, [1, 3, 5, 7, 0, 2, 4, 6]].ravel(), late[whole:]])


def inward(late: Floats) -> Floats:
    """Return late sizes of which each seven is told from both ends inward."""
    whole = len(late) // 7 * 7
    sevens = late[:whole].reshape(-1, 7)
    return np.concatenate([sevens[:, [0, 6, 1, 5, 2, 4, 3]].ravel(), late[whole:]])


def blackened(late: Floats) -> Floats:
    """Return late sizes as a plate blackens: little by faint light, no more by bright."""
    middle = float(np.median(late)) + 1e-12
    return np.asarray(2.2 * middle * late**3 / (late**3 + (1.3 * middle) ** 3))


def dipped(late: Floats) -> Floats:
    """Return how far late sizes are off a horizon that is the running mean of nine."""
    wide = np.pad(late, 4, mode="edge")
    mean = np.convolve(wide, np.ones(9) / 9, mode="valid")
    return np.asarray(np.abs(late - DIPS * mean))


def chords(late: Floats) -> Floats:
    """Return late sizes drawn as straight lines from every sixth to the next."""
    knots = np.append(np.arange(0, len(late) - 1, 6), len(late) - 1)
    return np.asarray(np.interp(np.arange(len(late)), knots, late[knots]))


def plotted(late: Floats) -> Floats:
    """Return late sizes plotted by the logarithm of time, stretched to where they end."""
    last = float(len(late) - 1)
    part = np.arange(len(late)) / last
    when = SLOWER * np.expm1(part * np.log1p(last / SLOWER))
    return np.asarray(np.interp(when, np.arange(len(late)), late))


def middle_of_five(late: Floats) -> Floats:
    """Return the middle by size of each late size, the two before and the two after."""
    wide = np.pad(late, 2, mode="edge")
    five = np.stack([wide[k : k + len(late)] for k in range(5)])
    return np.asarray(np.median(five, axis=0))


def flashed(late: Floats) -> Floats:
    """Return late sizes by a gain that flashes in groups, with dark between."""
    at = np.arange(len(late)) % (2 * FLASH * LIT + NIGHT)
    lit = (at < 2 * FLASH * LIT) & (at % (2 * FLASH) < FLASH)
    return np.asarray(late * np.where(lit, 1.0, DARK_GAIN))


def run_down(late: Floats) -> Floats:
    """Return late sizes by a gain that runs down evenly and is wound up at once."""
    part = np.arange(len(late)) % WOUND / (WOUND - 1)
    return np.asarray(late * (1 - (1 - RUNS) * part))


def _told(made: Callable[[Floats], Floats], most: float) -> Callable[[Lens, float], None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(lens: Lens, strength: float) -> None:
        sizes = np.abs(lens.wave) + 1e-9
        other = sizes.copy()
        for row, at in enumerate(np.ceil(lens.at + LATE).clip(0, WIDE_SAMPLES - 40).tolist()):
            other[row, int(at) :] = made(sizes[row, int(at) :])
        part = min(most * strength, 1.0) * lens.since(LATE)
        lens.wave = lens.wave * (1 - part + part * other / sizes)

    return act


def _prisms(lens: Lens, strength: float) -> None:
    """Fan out what comes late into some more, later ones, of links' own phases."""
    late = lens.since(LATE - 3.0) * lens.arrived()
    link = lens.entries()
    for samples, share in PRISMS:
        turn = link.per_link(lambda n: lens.rng.uniform(-np.pi, np.pi, n))
        size = FAN * min(strength, 2.0) ** 0.7 * share * np.exp(1j * turn)
        lens.once_more(late, size, np.full(lens.rows, samples))


def _shadows(lens: Lens, strength: float) -> None:
    """Lose a span of what comes late, as from a sector that the tower stands before."""
    link, rng = lens.entries(), lens.rng
    begin = link.per_link(lambda n: rng.uniform(*SHADOW, n))[:, None]
    wide = link.per_link(lambda n: rng.uniform(*WIDTH, n))[:, None] * strength**0.5
    since = PLACES - lens.at[:, None] - begin
    dark = ((since / 3.0).clip(0.0, 1.0) * ((wide - since) / 3.0).clip(0.0, 1.0)) * DARK
    lens.darken(20 * np.log10(1 - dark))


def _washes(lens: Lens, strength: float) -> None:
    """Lose the more of what comes late the later it is, as its phases swell from pulse to pulse.

    By the square of how late: what sums of phases that scatter so lose.
    """
    since = (PLACES - lens.at[:, None] - LATE).clip(0.0)
    lens.darken(-8.686 * strength * WASHES * (since / STRETCH) ** 2)


ODDITIES: dict[str, Callable[[Lens, float], None]] = {
    "prisms-fan-out-what-comes-late": _prisms,
    "tower-shadows-a-span-of-what-comes-late": _shadows,
    "swell-washes-out-what-comes-late": _washes,
    "late-eights-told-odd-and-even": _told(odd_and_even, 0.75),
    "late-sevens-told-from-ends-inward": _told(inward, 0.75),
    "late-sizes-as-plates-blacken": _told(blackened, 0.9),
    "late-sizes-off-a-dipped-horizon": _told(dipped, 0.8),
    "late-sixths-joined-by-chords": _told(chords, 0.9),
    "late-part-plotted-by-logarithms-of-time": _told(plotted, 0.5),
    "late-sizes-as-the-middle-of-five": _told(middle_of_five, 0.95),
    "late-gain-flashes-in-groups": _told(flashed, 0.7),
    "late-gain-runs-down-like-a-clock": _told(run_down, 0.9),
}
"""What is hidden in late parts; in turn."""
