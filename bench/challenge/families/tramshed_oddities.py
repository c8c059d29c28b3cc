"""What the tram shed and its bells do to late parts of waveforms, which no library has.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.tramshed_bell import PLACES, WIDE_SAMPLES, Bell, ramp

Floats = NDArray[np.float64]
LATE = 9.0  # samples past first paths from which bells are odd
GHOST = 0.62  # of late sizes of the row before, that were not wiped
TWISTS, TWISTED = (0.05, 0.11), 0.97  # radians a sample; of the most that is lost
PLAY = 0.8  # of the mean size, to either side
TRIPS, TRIPPED, OPEN = 1.7, 0.2, 10  # times the mean; gain; samples while a breaker is open
SPENT = 2.2  # e-folds of a gain by all that is spent
SIDE = 6  # of squares that are read aslant
NOTCHES, NOTCH, LEAST = 5, 9, 0.15  # of a controller; samples each; least gain


def highest_so_far(late: Floats) -> Floats:
    """Return late sizes of each seven as the highest of these so far."""
    whole = len(late) // 7 * 7
    sevens = np.maximum.accumulate(late[:whole].reshape(-1, 7), axis=1)
    return np.concatenate([sevens.ravel(), late[whole:]])


def means_so_far(late: Floats) -> Floats:
    """Return the mean of each late size and all late ones before it."""
    return np.asarray(np.cumsum(late) / np.arange(1, len(late) + 1))


def turned_tables(late: Floats) -> Floats:
    """Return late sizes of which each eleven is turned by one place more than the one before."""
    made = late.copy()
    for k in range(len(late) // 11):
        made[11 * k : 11 * k + 11] = np.roll(late[11 * k : 11 * k + 11], k + 1)
    return made


def _aslant() -> NDArray[np.int64]:
    """Return places of a square in the order of its diagonals, there and back by turns."""
    row, column = np.divmod(np.arange(SIDE * SIDE), SIDE)
    along = np.where((row + column) % 2 == 0, column, row)
    return np.lexsort((along, row + column)).astype(np.int64)


ASLANT = _aslant()


def aslant(late: Floats) -> Floats:
    """Return late sizes of which each 36 are read as a square's diagonals."""
    whole = len(late) // len(ASLANT) * len(ASLANT)
    squares = late[:whole].reshape(-1, len(ASLANT))[:, ASLANT]
    return np.concatenate([squares.ravel(), late[whole:]])


def carried_on(late: Floats) -> Floats:
    """Return late sizes of which in each dozen the larger of two is carried on past the other."""
    made = late.copy()
    for begin in range(0, len(late) - 11, 12):
        for k in range(begin, begin + 11):
            if made[k] > made[k + 1]:
                made[k], made[k + 1] = made[k + 1], made[k]
    return made


def played(late: Floats) -> Floats:
    """Return late sizes by a gear with play, that stays until it is pushed from either side."""
    half = PLAY * float(late.mean())
    made = late.copy()
    for k in range(1, len(late)):
        made[k] = min(max(made[k - 1], late[k] - half), late[k] + half)
    return made


def broken(late: Floats) -> Floats:
    """Return late sizes of which some are cut, after each that trips a breaker, until it closes."""
    bar, made, shut = TRIPS * float(late.mean()), late.copy(), 0
    for k in range(len(late)):
        if shut > 0:
            made[k], shut = TRIPPED * late[k], shut - 1
        elif late[k] > bar:
            shut = OPEN
    return made


def spent(late: Floats) -> Floats:
    """Return late sizes by a gain that sags by the power that was spent on those before."""
    before = np.concatenate([[0.0], np.cumsum(late**2)[:-1]])
    return np.asarray(late * np.exp(-SPENT * before / (late**2).sum().clip(1e-12)))


def what_is_left(late: Floats) -> Floats:
    """Return what late sizes lack to the highest of the ten that they are of."""
    wide = np.append(late, np.zeros(-len(late) % 10)).reshape(-1, 10)
    return np.asarray((wide.max(axis=1, keepdims=True) - wide).ravel()[: len(late)])


def notched(late: Floats) -> Floats:
    """Return late sizes by a gain that a controller notches up and shuts off, over and over."""
    at = np.arange(len(late)) % (NOTCHES * NOTCH) // NOTCH
    return np.asarray(late * (LEAST + (1 - LEAST) * at / (NOTCHES - 1)))


def roots_of_both(late: Floats) -> Floats:
    """Return the root of the product of late sizes two before and two after."""
    wide = np.pad(late, 2, mode="reflect")
    return np.sqrt(wide[:-4] * wide[4:])


def _read(made: Callable[[Floats], Floats], most: float) -> Callable[[Bell, float], None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(bell: Bell, strength: float) -> None:
        size = np.abs(bell.wave) + 1e-9
        part = min(most * strength, 1.0) * bell.from_on(LATE)
        begins = np.ceil(bell.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 44)
        for row, begin in enumerate(begins.tolist()):
            ratio = made(size[row, begin:]) / size[row, begin:]
            bell.wave[row, begin:] *= 1 + part[row, begin:] * (ratio - 1)

    return act


def _ghosts(bell: Bell, strength: float) -> None:
    """Have late sizes of what the same tag was sent before, that were not wiped, by power."""
    table = bell.table[["rx", "time_s"]].reset_index(drop=True)
    table = table.assign(copy=table.groupby(["rx", "time_s"]).cumcount())
    rows = table.sort_values("time_s", kind="stable")
    last = rows.index.to_series().groupby([rows["rx"], rows["copy"]]).shift(1).sort_index()
    there = np.flatnonzero(last.notna().to_numpy())
    size = np.abs(bell.wave)
    before = size[last.to_numpy()[there].astype(np.int64)]
    since = (bell.at[there] - bell.at[last.to_numpy()[there].astype(np.int64)]).round()
    where = (PLACES - since[:, None]).clip(0, WIDE_SAMPLES - 1).astype(np.int64)
    left = GHOST * strength**0.5 * np.take_along_axis(before, where, axis=1)
    more = np.hypot(size[there], left) / (size[there] + 1e-9)
    bell.wave[there] *= 1 + bell.from_on(LATE)[there] * (more - 1)


def _twists(bell: Bell, strength: float) -> None:
    """Turn what comes late across the antenna and along it again, by wires that are twisted."""
    fares, rng = bell.fares(), bell.rng
    pace = fares.each_link(lambda n: rng.uniform(*TWISTS, n))[:, None]
    begun = fares.each_link(lambda n: rng.uniform(0.0, np.pi, n))[:, None]
    since = (PLACES - bell.at[:, None] - LATE).clip(0.0)
    lost = min(TWISTED * strength**0.5, 0.995) * np.sin(begun + pace * since) ** 2
    bell.muffle(20 * np.log10(1 - lost * ramp((since - 1.0) / 4.0)))


ODDITIES: dict[str, Callable[[Bell, float], None]] = {
    "twisted-wires-turn-what-comes-late": _twists,
    "late-part-keeps-a-ghost-of-the-row-before": _ghosts,
    "late-sevens-told-as-highest-so-far": _read(highest_so_far, 0.9),
    "late-sizes-told-as-means-so-far": _read(means_so_far, 0.5),
    "late-elevens-turned-by-one-more-each": _read(turned_tables, 0.75),
    "late-squares-read-aslant": _read(aslant, 0.75),
    "late-dozens-carry-larger-ones-on": _read(carried_on, 0.8),
    "late-sizes-by-a-gear-with-play": _read(played, 0.95),
    "late-gain-cut-by-a-breaker": _read(broken, 0.9),
    "late-gain-sags-by-what-was-spent": _read(spent, 0.85),
    "late-tens-told-as-what-is-left": _read(what_is_left, 0.55),
    "late-gain-notched-up-by-a-controller": _read(notched, 0.9),
    "late-sizes-as-roots-of-two-off": _read(roots_of_both, 0.9),
}
"""What is hidden in late parts; in turn."""
