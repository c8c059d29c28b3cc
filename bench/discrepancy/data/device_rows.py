"""Which rows are of which device, at whichever end."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

ENDS = ("tx", "rx")


def devices_of(frame: pd.DataFrame) -> dict[str, NDArray[np.bool_]]:
    """Return which rows [n] have a device at either end, by its name."""
    ends = [frame[end].astype(str) for end in ENDS if end in frame]
    names = sorted({name for end in ends for name in end.unique()})
    return {name: np.any([(end == name).to_numpy() for end in ends], axis=0) for name in names}
