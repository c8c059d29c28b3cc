"""Bad input that is found before anything is fitted."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.data.checks import check_tables
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings


def table(source: str, period_ns: float, cir: bool = True) -> Recordings:
    """Return forty rows with waveforms of a sample period; SIMULATED."""
    frame = pd.DataFrame({"link": [f"l{i // 4}" for i in range(40)]})
    own_m = 2.1 + 0.01 * len(source) + 0.001 * period_ns
    frame = frame.assign(true_range_m=2.0, range_m=own_m, sample_period_ns=period_ns)
    if cir:
        frame["cir"] = list(np.ones((40, 16), np.float32))
    return Recordings(frame, source)


@pytest.mark.parametrize("simulated", [Simulator(Base()), table("sim.parquet", 1.0)])
def test_tables_of_about_the_same_period_pass(simulated: Simulator | Recordings) -> None:
    check_tables(table("r.parquet", 1.0016), simulated)


def test_waveforms_of_another_period_are_refused_with_what_to_do() -> None:
    said = r"s\.parquet: sample_period_ns is 2, but 1\.002 in r\.parquet: .*resample"
    with pytest.raises(BenchError, match=said):
        check_tables(table("r.parquet", 1.0016), table("s.parquet", 2.0))


def test_a_period_without_waveforms_is_of_no_matter() -> None:
    check_tables(table("r.parquet", 1.0016), table("s.parquet", 2.0, cir=False))
    check_tables(table("r.parquet", 1.0016), table("s.parquet", 2.0), waveforms=False)


def test_simulated_levels_without_their_sign_are_refused() -> None:
    unsigned = table("s.parquet", 1.0)
    unsigned = Recordings(unsigned.frame.assign(rx_power_dbm=82.0), "s.parquet")
    with pytest.raises(BenchError, match=r"s\.parquet: the median of rx_power_dbm is 82 dBm"):
        check_tables(table("r.parquet", 1.0), unsigned)


def test_a_table_against_itself_is_refused() -> None:
    with pytest.raises(BenchError, match=r"r\.parquet: its ranges are those of r\.parquet"):
        check_tables(table("r.parquet", 1.0), table("r.parquet", 1.0))


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        ("rx_power_dbm", 82.0, "the median of rx_power_dbm is 82 dBm: .*sign lost"),
        ("temperature_c", 1e308, r"temperature_c is 1e\+308 at row 0: no measurement"),
    ],
)
def test_figures_that_no_receiver_gives_are_refused(column: str, value: float, said: str) -> None:
    made = table("r.parquet", 1.0)
    strange = Recordings(made.frame.assign(**{column: value}), "r.parquet")
    with pytest.raises(BenchError, match=said):
        check_tables(strange, Simulator(Base()))
    usual = Recordings(made.frame.assign(rx_power_dbm=-82.0, temperature_c=20.0), "r.parquet")
    check_tables(usual, Simulator(Base()))
