"""What the pottery and its cones do to late parts of waveforms, which no library has.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.pottery_cone import PLACES, WIDE_SAMPLES, Cone, cast_later

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LATE = 9.0  # samples past first paths from which cones are odd
CHEQUERS, GIVES_BACK, ROUNDS = (5.0, 9.0), 0.62, 7  # samples to and fro; each time; how often
SPOKES, OPEN, SHUT_DB = (11.0, 19.0), 0.5, -15.0  # samples a turn; part of these; lost behind one
PITCH, TRAYS, TRAY = (2.2, 3.6), 3, 0.8  # samples between; of these; each next to the last
WIDE = 4  # samples to either side of which a mean is
SOFT = 2.6  # how sharply a cone bends at the mean
POTS, HANDS = 12, (0.4, 1.45)  # samples that a potter throws; gains of two
NECK = (0.25, 1.4)  # gains at a bottle kiln's ends and belly
MESH = 1.15  # of the mean, what a sieve lets through


def least_of_three(late: Floats) -> Floats:
    """Return the least of each late size and those beside it."""
    wide = np.pad(late, 1, mode="edge")
    return np.minimum(np.minimum(wide[:-2], wide[1:-1]), wide[2:])


def off_their_mean(late: Floats) -> Floats:
    """Return how far late sizes are off the mean of all that are near, to either side."""
    wide = np.pad(late, WIDE, mode="reflect")
    near = np.convolve(wide, np.full(2 * WIDE + 1, 1 / (2 * WIDE + 1)), mode="valid")
    return np.asarray(np.abs(late - near))


def of_one_height(late: Floats) -> Floats:
    """Return late sizes of which each eight are as high at most as the mean of all such."""
    most = np.array([late[k : k + 8].max() for k in range(0, len(late), 8)])
    by = most.mean() / np.maximum(most, 1e-12)
    return np.asarray(late * np.repeat(by, 8)[: len(late)])


def _wedge() -> NDArray[np.int64]:
    """Return places of a dozen once clay is cut in halves and one is turned over on the other."""
    order = np.empty(12, np.int64)
    order[::2], order[1::2] = np.arange(6), 11 - np.arange(6)
    return order


WEDGE = _wedge()


def wedged(late: Floats) -> Floats:
    """Return late sizes of which each dozen is wedged as clay is, twice."""
    whole = len(late) // 12 * 12
    dozens = late[:whole].reshape(-1, 12)[:, WEDGE][:, WEDGE]
    return np.concatenate([dozens.ravel(), late[whole:]])


def by_a_cone(late: Floats) -> Floats:
    """Return late sizes by how far a cone has bent, which it does about the mean (a logistic)."""
    mean = float(late.mean())
    return np.asarray(2 * mean / (1 + np.exp(-SOFT * (late / max(mean, 1e-12) - 1))))


def as_bends(late: Floats) -> Floats:
    """Return how far late sizes are off the middle of those beside them, doubled."""
    wide = np.pad(late, 1, mode="reflect")
    return np.asarray(np.abs(2 * wide[1:-1] - wide[:-2] - wide[2:]))


def of_two_hands(late: Floats) -> Floats:
    """Return late sizes by either of two gains, in the order of Thue and Morse, a dozen each."""
    turn = np.arange(len(late)) // POTS
    ones = np.array([int(k).bit_count() % 2 for k in turn])
    return np.asarray(late * np.array(HANDS)[ones])


def bottled(late: Floats) -> Floats:
    """Return late sizes by a gain with the outline of a bottle kiln: its belly is low down."""
    part = np.linspace(0.0, 1.0, len(late))
    belly = np.sin(np.pi * part**0.6) ** 2
    return np.asarray(late * (NECK[0] + (NECK[1] - NECK[0]) * belly))


def sieved(late: Floats) -> Floats:
    """Return late sizes of which what is over a mesh falls to the next two, and is not kept."""
    mesh = MESH * float(late.mean())
    over = (late - mesh).clip(0.0)
    made = late - over
    made[1:] += 0.5 * over[:-1]
    made[2:] += 0.5 * over[:-2]
    return np.asarray(made)


def thrown_round(late: Floats) -> Floats:
    """Return late sizes as told by two who start at either end and take turns by fours."""
    fours = [np.arange(k, min(k + 4, len(late))) for k in range(0, len(late), 4)]
    order = []
    while fours:
        order.append(fours.pop(0))
        fours.reverse()
    return late[np.concatenate(order)]


def _told(made: Callable[[Floats], Floats], most: float) -> Callable[[Cone, float], None]:
    """Return what lets late sizes be others, by a part `most` at strength 1; phases stay."""

    def act(cone: Cone, strength: float) -> None:
        size = np.abs(cone.wave) + 1e-9
        part = min(most * strength, 1.0) * cone.past(LATE)
        begins = np.ceil(cone.at + LATE).astype(np.int64).clip(0, WIDE_SAMPLES - 40)
        for row, begin in enumerate(begins.tolist()):
            by = made(size[row, begin:].copy()) / size[row, begin:]
            cone.wave[row, begin:] *= 1 + part[row, begin:] * (by - 1)

    return act


def chequered(waves: Complexes, samples: Floats, kept: float) -> Complexes:
    """Return waveforms that went to and fro between chequers: all pass, and come by and by."""
    made = -kept * waves
    for once in range(1, ROUNDS + 1):
        made = made + (1 - kept**2) * kept ** (once - 1) * cast_later(waves, once * samples)
    return made


def _chequers(cone: Cone, strength: float) -> None:
    """Let what comes late go to and fro between a regenerator's chequers of brick."""
    kept = min(GIVES_BACK * strength**0.5, 0.9)
    apart = cone.firing().each_link(lambda n: cone.rng.uniform(*CHEQUERS, n))
    late = cone.past(LATE) * cone.arrived()
    cone.wave = cone.wave + chequered(late, apart, kept) - late


def _spokes(cone: Cone, strength: float) -> None:
    """Let spokes of a flywheel pass before what comes late, at what turn they are by then."""
    each = cone.firing().each_link(lambda n: cone.rng.uniform(*SPOKES, n))[:, None]
    begun = cone.rng.random((cone.rows, 1))
    since = PLACES - cone.at[:, None] - LATE
    behind = ((since / each + begun) % 1.0 > OPEN) & (since > 0)
    cone.dull(np.where(behind, SHUT_DB * min(strength, 2.0), 0.0))


def _trays(cone: Cone, strength: float) -> None:
    """Let each of some trays return a part of what comes late, at its place in a rack."""
    apart = cone.firing().each_link(lambda n: cone.rng.uniform(*PITCH, n))
    late, turn = cone.past(LATE) * cone.arrived(), np.exp(2j * np.pi * cone.rng.random(cone.rows))
    for tray in range(1, TRAYS + 1):
        share = (min(TRAY * strength**0.5, 0.95) * turn) ** tray
        cone.repeat(late, share, tray * apart)


ODDITIES: dict[str, Callable[[Cone, float], None]] = {
    "chequers-of-brick-hold-back-what-comes-late": _chequers,
    "spokes-pass-before-what-comes-late": _spokes,
    "trays-return-what-comes-late": _trays,
    "late-sizes-fettled-to-the-least-of-three": _told(least_of_three, 0.95),
    "late-sizes-told-as-off-their-mean": _told(off_their_mean, 0.85),
    "late-eights-brought-to-one-height": _told(of_one_height, 0.95),
    "late-dozens-wedged-as-clay-is": _told(wedged, 0.75),
    "late-sizes-by-a-cone-that-bends": _told(by_a_cone, 0.95),
    "late-sizes-told-as-bends": _told(as_bends, 0.7),
    "late-dozens-by-two-hands-in-turn": _told(of_two_hands, 0.9),
    "late-gain-shaped-like-a-bottle-kiln": _told(bottled, 0.85),
    "late-sizes-sieved-by-a-mesh": _told(sieved, 0.95),
    "late-fours-told-from-both-ends": _told(thrown_round, 0.75),
}
"""What is hidden in late parts; in turn."""
