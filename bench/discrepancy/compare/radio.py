"""The radio settings that recordings name, for the simulator that they are compared with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from bench.discrepancy.data.columns import numeric
from bench.physics.base import Base
from bench.physics.effect import describe
from bench.physics.own_base import at_period
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

SETTINGS = ("channel", "prf_mhz", "tx_power_dbm")


def base_of(recorded: pd.DataFrame, simulated: Simulator | Recordings) -> Base:
    """Return the base with the radio settings that the recordings name, where they name one.

    A table's is at its own sample period. A base of another channel alone is decibels of difference
    that are no physics left out.
    """
    base = _of_table(simulated) if isinstance(simulated, Recordings) else simulated.base
    known = {name: numeric(recorded, name) for name in SETTINGS}
    only = {n: np.unique(v[np.isfinite(v)]) for n, v in known.items()}
    given = {name: value[0] for name, value in only.items() if len(value) == 1}
    whole = {p.name for p in describe(Base) if p.whole}
    settings = {n: int(v) if n in whole else float(v) for n, v in given.items()}
    return replace(base, **settings)  # type: ignore[arg-type]


def _of_table(simulated: Recordings) -> Base:
    """Return the base at the sample period of a table."""
    known = numeric(simulated.frame, "sample_period_ns")
    known = known[np.isfinite(known)]
    return at_period(Base(), float(np.median(known))) if len(known) else Base()
