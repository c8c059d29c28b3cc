"""The mark of mirrored paths: power at delays that a link's own walls make, not those of others.

A tail, ringing or an echo in the receiver has power at delays that no geometry moves. So how far
the profile of a row stands out at the delays of its own four walls is compared with how far it does
at those of other links: a permutation that leaves everything else alike.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.physics.units import C_M_PER_NS, Floats
from bench.recordings.table import SAMPLE_PERIOD_NS

ENDS = ("tx", "rx", "room")
COLUMNS = tuple(f"{end}_{axis}_m" for end in ENDS for axis in "xyz")
EARLIEST_NS = 5.0  # two pulses of 500 MHz: nearer echoes are the pulse itself [derived]
ASIDE = 4  # samples: two pulses
AFTER = 5  # samples after the first path, in which its peak lies
OTHERS = 8  # links whose delays are tried for each row [cost]
MOST_ROWS = 2000  # that are looked at [cost]
FEWEST_LINKS = 12  # below which nothing is said [convention]
MARK_DB, MARK_Z = 2.0, 6.0  # that recordings must reach [convention]
HINT_DB, HINT_Z = 0.5, 2.0  # by which a simulated table has reflections too [convention]


def mirrored(frame: pd.DataFrame, least_db: float = MARK_DB, least_z: float = MARK_Z) -> bool:
    """Return whether rows have power where their own walls mirror it.

    By `least_db` and `least_z` standard errors. Needs positions, room, `cir` of one length and
    `first_path_index`; False without.
    """
    frame = frame.iloc[:: len(frame) // MOST_ROWS + 1]
    if not {*COLUMNS, "cir", "first_path_index", "link"} <= set(frame):
        return False
    lengths = {len(row) for row in frame["cir"]}
    delays = wall_delays_ns(frame)
    if len(lengths) != 1 or max(lengths) < 10 * ASIDE or not np.isfinite(delays).any():
        return False
    above, error = standing_out_db(frame, delays)
    return bool(above > max(least_db, least_z * error))


def wall_delays_ns(frame: pd.DataFrame) -> Floats:
    """Return how much later [n, 4] what four walls mirror arrives than the straight path, in ns."""
    places = [
        frame[[f"{end}_{axis}_m" for axis in "xyz"]].apply(pd.to_numeric, errors="coerce")
        for end in ENDS
    ]
    tx, rx, room = (place.to_numpy(np.float64) for place in places)
    far, out = np.linalg.norm(tx - rx, axis=1), []
    for axis in (0, 1):
        for wall in (np.zeros(len(tx)), room[:, axis]):
            image = tx.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            out.append((np.linalg.norm(image - rx, axis=1) - far) / C_M_PER_NS)
    return np.stack(out, axis=1)


def _period_ns(frame: pd.DataFrame) -> float:
    """Return the usual sample period in ns."""
    if "sample_period_ns" not in frame:
        return SAMPLE_PERIOD_NS
    known = pd.to_numeric(frame["sample_period_ns"], errors="coerce").median()
    return float(known) if known > 0 else SAMPLE_PERIOD_NS


def standing_out_db(frame: pd.DataFrame, delays_ns: Floats) -> tuple[float, float]:
    """Return by how much rows stand out at their own `delays_ns` [n, 4], and its standard error.

    In dB over what they do at delays of other links; a mean over links, (nan, nan) of few.
    """
    level, top = _smoothed_db(frame)
    delays_ns = np.where(delays_ns > EARLIEST_NS, delays_ns, np.nan) / _period_ns(frame)
    code = pd.factorize(frame["link"])[0]
    first = np.unique(code, return_index=True)[1]
    rng = np.random.default_rng(0)
    own = _prominence(level, top, delays_ns)
    theirs = [
        _prominence(level, top, delays_ns[first[rng.permutation(len(first))]][code])
        for _ in range(OTHERS)
    ]
    more = own - _mean(np.stack(theirs, axis=1))
    kept = np.isfinite(more)
    links = np.unique(code[kept], return_inverse=True)[1]
    if not kept.any() or links.max() + 1 < FEWEST_LINKS:
        return float("nan"), float("nan")
    mean = np.bincount(links, more[kept]) / np.bincount(links)
    return float(mean.mean()), float(mean.std(ddof=1) / np.sqrt(len(mean)))


def _smoothed_db(frame: pd.DataFrame) -> tuple[Floats, Floats]:
    """Return power in samples of three [n, K] in dB, and where the first path peaks [n]."""
    size = np.stack([np.abs(np.asarray(row, np.complex128)) for row in frame["cir"]])
    first = pd.to_numeric(frame["first_path_index"], errors="coerce").to_numpy(np.float64)
    begin = np.clip(np.nan_to_num(np.floor(first)), 0, size.shape[1] - AFTER).astype(np.intp)
    near = np.take_along_axis(size, begin[:, None] + np.arange(AFTER), axis=1)
    power = np.pad(np.nan_to_num(size) ** 2, ((0, 0), (1, 1)))
    wide = power[:, :-2] + power[:, 1:-1] + power[:, 2:]
    floor = 1e-6 * max(float(np.median(wide)), 1e-12)
    return 10 * np.log10(np.maximum(wide, floor)), begin + near.argmax(axis=1)


def _prominence(level: Floats, top: Floats, delays: Floats) -> Floats:
    """Return the mean level [n] at delays [n, 4] in samples over that `ASIDE` samples beside them.

    A delay that is NaN takes no part.
    """
    at = np.nan_to_num(top[:, None] + np.rint(delays), nan=-1).astype(np.intp)
    last = level.shape[1] - ASIDE - 1
    inside = np.isfinite(delays) & (at < last)
    here = np.clip(at, ASIDE, last)
    each = (np.take_along_axis(level, here + lag, axis=1) for lag in (-ASIDE, 0, ASIDE))
    before, there, after = each
    return _mean(np.where(inside, there - (before + after) / 2, np.nan))


def _mean(values: Floats) -> Floats:
    """Return the mean of what is known in each row of [n, k], NaN where nothing is."""
    known = np.isfinite(values)
    total = np.where(known, values, 0.0).sum(axis=1)
    return np.where(known.any(axis=1), total / np.maximum(known.sum(axis=1), 1), np.nan)
