"""How many rows both sides of a comparison have, and which of the recorded ones take part."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.matching import same_links
from bench.discrepancy.compare.settings import PAIRS_SHARE
from bench.discrepancy.compare.shared import unseen
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Comparison
from bench.discrepancy.data.columns import WAVES, known_columns, numeric
from bench.discrepancy.data.gaps import with_temperatures
from bench.discrepancy.data.nominal_noise import nominal_noise
from bench.discrepancy.data.observables import COUNT, NOISE
from bench.discrepancy.data.own_link import far_off_their_link
from bench.discrepancy.settings import NOISE_APART_DB
from bench.physics.simulator import Simulator
from bench.recordings.clean import describe
from bench.recordings.places import cut_into_places
from bench.recordings.table import Recordings

DEVICE_COLUMNS = ("tx", "rx")
RANGE_M = "range_m"
PLACE_COLUMNS = tuple(f"{end}_{axis}_m" for end in DEVICE_COLUMNS for axis in "xyz")
OTHER_END = {
    f"{end}{what}": f"{other}{what}"
    for end, other in (DEVICE_COLUMNS, DEVICE_COLUMNS[::-1])
    for what in ("", "_x_m", "_y_m", "_z_m")
}


def beside(recorded: Recordings, simulated: Simulator | Recordings) -> Simulator | Recordings:
    """Return a simulated table as it stands beside the recorded one; a simulator as it is.

    Its ends are named as there, temperatures have no gaps, and drives are cut into places.
    """
    if not isinstance(simulated, Recordings):
        return simulated
    frame = simulated.frame
    if exchanged(recorded.frame, frame):
        frame = frame.rename(columns=OTHER_END)[list(frame)]
    return replace(simulated, frame=cut_into_places(with_temperatures(frame)))


def exchanged(recorded: pd.DataFrame, simulated: pd.DataFrame) -> bool:
    """Return whether the devices of one table's ends are those of the other end in the other.

    All that both tables know of a row would differ then, though nothing does. Not where an end
    has devices of both, which may be either.
    """
    if not all(set(DEVICE_COLUMNS) <= set(frame) for frame in (recorded, simulated)):
        return False
    ours, theirs = ([set(f[end].dropna()) for end in DEVICE_COLUMNS] for f in (recorded, simulated))
    crossed = [mine & other for mine, other in zip(ours, reversed(theirs), strict=True)]
    straight = [mine & other for mine, other in zip(ours, theirs, strict=True)]
    return all(crossed) and not any(straight)


def counted(
    recorded: Recordings, simulated: Simulator | Recordings, waveforms: bool = True
) -> tuple[str, ...]:
    """Return how many rows of how many links each table has, and what was left out, in words.

    Also why `waveforms` are, if they are asked for.
    """
    lines = [f"recorded: {_words(recorded)}"]
    seen = recorded.frame
    more = [_copies(seen), _lone_rows(seen), _one_pair(seen), _negative(seen)]
    if isinstance(simulated, Recordings):
        lines.append(f"simulated: {_words(simulated)}")
        more.append(_exchanged(recorded.frame, simulated))
        more.append(_noise(recorded.frame, simulated.frame))
        more.append(_nominal(recorded.frame, simulated.frame) if waveforms else "")
        more.append(far_off_their_link(recorded, simulated))
        more.append(_put_aside(recorded.frame, simulated.frame))
    more.append(_not_compared(recorded, simulated) if waveforms else "")
    return (*lines, *(words for words in more if words))


def _exchanged(recorded: pd.DataFrame, simulated: Recordings) -> str:
    """Return, in words, that a simulated table's ends were named as the recorded one's."""
    if not exchanged(recorded, simulated.frame):
        return ""
    return f"{simulated.source}: its tx are recorded as rx and its rx as tx: taken as recorded"


def _put_aside(recorded: pd.DataFrame, simulated: pd.DataFrame) -> str:
    """Return, in words, which categories no simulated row has; "" where links are the same."""
    lone = "" if same_links(recorded, simulated) else unseen(recorded, simulated)
    return f"no simulated row has {lone}: these recorded rows take no part" if lone else ""


def _not_compared(recorded: Recordings, simulated: Simulator | Recordings) -> str:
    """Return, in words, what waveforms would need to be compared; "" where they are or none is."""
    tables = [one for one in (recorded, simulated) if isinstance(one, Recordings)]
    if not any(WAVES[0] in known_columns(one.frame) for one in tables):
        return ""
    lacking = ((one, [n for n in WAVES if n not in known_columns(one.frame)]) for one in tables)
    words = [f"{one.source} has no {' and no '.join(names)}" for one, names in lacking if names]
    return f"CIRs are not compared: {', '.join(words)}" if words else ""


def _lone_rows(frame: pd.DataFrame) -> str:
    """Return, in words, that every link has one row; "" where one has more."""
    if len(frame) < 2 or frame["link"].nunique(dropna=False) < len(frame):
        return ""
    return (
        "every link has one row only: what rows of one run have in common (a lag, an offset of "
        "the link) cannot be told from scatter; give rows of one run one link"
    )


def _copies(frame: pd.DataFrame) -> str:
    """Return, in words, how many rows say at the same time the same as others, "" for none."""
    if "time_s" not in frame:
        return ""
    plain = frame.select_dtypes(["number", "bool", "string"])
    many = int(plain[plain["time_s"].notna()].duplicated().sum())
    if not many:
        return ""
    return f"{many} recorded rows are copies of others, and count as rows of their own: drop them"


def _negative(frame: pd.DataFrame) -> str:
    """Return how many measured ranges are below zero, "" where none is.

    They stay: a radio whose delays are set too long reads so at short distances.
    """
    below = np.flatnonzero(numeric(frame, RANGE_M) < 0)
    if not len(below):
        return ""
    first_m = float(frame[RANGE_M].iloc[below[0]])
    return (
        f"{len(below)} of {len(frame)} rows have a negative range_m (the first: {first_m:.4g} m in "
        f"row {below[0]}), which no distance is; they took part: mend or drop them"
    )


def _one_pair(frame: pd.DataFrame) -> str:
    """Return what is wrong with links of which many are one pair of places, "" where few are.

    Rows of one pair are near-copies; under many names they count as independent.
    """
    ends = [*DEVICE_COLUMNS, *PLACE_COLUMNS]
    if not {"link", *ends} <= {*frame}:
        return ""
    first = frame.groupby("link")[ends].first()
    pairs = len(first.drop_duplicates())
    if pairs > PAIRS_SHARE * len(first):
        return ""
    return (
        f"{len(first)} links are of {pairs} pairs of devices and places: rows of one pair under "
        "several names count as independent, so all that follows seems surer than it is"
    )


def _noise(recorded: pd.DataFrame, simulated: pd.DataFrame) -> str:
    """Return by how much logged noise differs from a simulated table's, "" where by under 1 dB.

    As it is for one accumulated symbol, where both tell how many. Without waveforms only louder
    noise is told by name; that there is less is for whoever made the simulator to know.
    """
    ours, theirs = (_noise_db(frame, recorded, simulated) for frame in (recorded, simulated))
    if not abs(ours - theirs) > NOISE_APART_DB:  # unknown, too
        return ""
    words = f"{abs(ours - theirs):.1f} dB {'more' if ours > theirs else 'less'}"
    return f"logged noise (noise_std, median): {words} recorded than simulated"


def _nominal(recorded: pd.DataFrame, simulated: pd.DataFrame) -> str:
    """Return, in words, that logged noise is not that of the samples, "" where it may be."""
    more_db = nominal_noise(recorded, simulated)
    if not more_db:
        return ""
    words = f"{abs(more_db):.1f} dB {'more' if more_db > 0 else 'less'}"
    return (
        f"noise_std is the same on both sides, but recorded samples hold {words} noise before the "
        "path: it is not of the samples, and is not compared"
    )


def _noise_db(frame: pd.DataFrame, *tables: pd.DataFrame) -> float:
    """Return the median of the logged noise in dB, for one symbol where all tables count them."""
    noise = numeric(frame, NOISE)
    if all(COUNT in table for table in tables):
        count = numeric(frame, COUNT)
        noise = noise / np.sqrt(np.where(count > 0, count, np.nan))
    known = noise[np.isfinite(noise) & (noise > 0)]
    return float(20 * np.log10(np.median(known))) if len(known) else float("nan")


def _words(table: Recordings) -> str:
    links = f" of {table.frame['link'].nunique()} links" if "link" in table.frame else ""
    lost = f"; left out: {describe(table.dropped)}" if table.dropped else ""
    return f"{len(table)} rows{links}{lost}"


def covered(comparison: Comparison, recorded: Recordings) -> NDArray[np.bool_]:
    """Return which rows [n] the simulated side has a counterpart of: all, but for tables."""
    if isinstance(comparison, TableComparison):
        return comparison.covered(recorded.frame)
    return np.ones(len(recorded), bool)
