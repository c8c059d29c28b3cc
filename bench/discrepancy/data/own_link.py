"""Rows whose range lies far off the other rows of their own link, as those of strangers do."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.data.settings import (
    FAR_OFF_LINK_M,
    FAR_OFF_LINK_TIMES,
    FAR_SCATTERS,
    FEWEST_FAR,
    FEWEST_OF_LINK,
    SHOWN_FAR,
)
from bench.discrepancy.settings import MAD_TO_STD
from bench.errors import BenchError
from bench.recordings.table import Recordings


def far_off_their_link(recorded: Recordings, simulated: Recordings) -> str:
    """Return how many recorded rows lie far off their own link, "" where no more than simulated.

    A mean over all hardly shows them, and what strikes whole links they are not: packets of another
    exchange, say. Of a link of few rows nothing is said.
    """
    if not all("link" in table.frame for table in (recorded, simulated)):
        return ""
    off_m, limit_m = _off(recorded)
    far = np.flatnonzero(off_m > limit_m)
    other = float(np.mean(_off(simulated)[0] > limit_m))
    if len(far) < FEWEST_FAR or len(far) / len(off_m) < FAR_OFF_LINK_TIMES * other:
        return ""
    rows = ", ".join(map(str, far[:SHOWN_FAR])) + (" ..." if len(far) > SHOWN_FAR else "")
    return (
        f"{len(far)} of {len(off_m)} recorded rows lie more than {limit_m:.2g} m off the median of "
        f"their own link, by {np.median(off_m[far]):.2g} m in the median ({other:.2%} of the "
        f"simulated ones do): rows {rows}; answers of another exchange, something that came and "
        "went, or first paths too weak for the detector"
    )


def _off(table: Recordings) -> tuple[NDArray[np.float64], float]:
    """Return how far the error of every row is from the median of its link [n] in metres.

    And from where on that is far: many times what rows of a link differ by.
    """
    try:
        error_m = pd.Series(table.errors_m())
    except BenchError:  # neither errors nor ranges
        return np.zeros(0), np.inf
    links = table.frame["link"].to_numpy()
    groups = error_m.groupby(links, dropna=False)
    off_m = (error_m - groups.transform("median")).abs()
    off_m = off_m.where(groups.transform("count") >= FEWEST_OF_LINK).fillna(0.0)
    scatter_m = MAD_TO_STD * float(off_m[off_m > 0].median()) if (off_m > 0).any() else 0.0
    return off_m.to_numpy(np.float64), max(FAR_SCATTERS * scatter_m, FAR_OFF_LINK_M)
