"""Bad input that is found before anything is fitted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.data.checks import check_tables
from bench.discrepancy.data.observables import shared_window
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.recordings.io import write_recordings
from bench.recordings.open import read
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


def of_samples(source: str, samples: int) -> Recordings:
    """Return rows with waveforms of so many samples, the path at the tenth; SIMULATED."""
    made = table(source, 1.0)
    cirs = list(np.ones((len(made.frame), samples), np.float32))
    return Recordings(made.frame.assign(cir=cirs, first_path_index=10.4), source)


def test_waveforms_that_end_after_the_path_are_refused_on_either_side() -> None:
    long, short = of_samples("long.parquet", 60), of_samples("short.parquet", 20)
    said = r"short\.parquet: its CIRs hold 10 samples from first_path_index on; expected 16 or"
    for pair in ((short, long), (long, short), (short, Simulator(Base()))):
        with pytest.raises(BenchError, match=said):
            check_tables(*pair)
        check_tables(*pair, waveforms=False)
    check_tables(long, of_samples("other.parquet", 40))
    late = long.frame.assign(first_path_index=[10.4, *[50.0] * 4, *[10.4] * (len(long.frame) - 5)])
    said = rf"10 samples from first_path_index on in 4 of {len(late)} rows \(the first: row 1\)"
    with pytest.raises(BenchError, match=said):
        check_tables(Recordings(late, "late.parquet"), Simulator(Base()))
    said = r"short\.parquet: its CIRs hold 10 samples from first_path_index on; expected 16 or"
    untimed = Recordings(short.frame.drop(columns="sample_period_ns"), short.source)
    with pytest.raises(BenchError, match=said):
        check_tables(long, untimed)


def test_waveforms_are_compared_as_far_as_both_tables_go() -> None:
    long, other = of_samples("long.parquet", 60).frame, of_samples("other.parquet", 40).frame
    assert shared_window(long, None).after == 50
    assert shared_window(long, other).after == shared_window(other, long).after == 30


def test_simulated_levels_without_their_sign_are_refused() -> None:
    unsigned = table("s.parquet", 1.0)
    unsigned = Recordings(unsigned.frame.assign(rx_power_dbm=82.0), "s.parquet")
    with pytest.raises(BenchError, match=r"s\.parquet: the median of rx_power_dbm is 82 dBm"):
        check_tables(table("r.parquet", 1.0), unsigned)


def test_levels_without_their_sign_in_some_rows_are_refused() -> None:
    frame = table("r.parquet", 1.0).frame
    level = np.where(np.arange(len(frame)) % 3 == 1, 84.0, -84.0)
    mixed = Recordings(frame.assign(rx_power_dbm=level), "r.parquet")
    with pytest.raises(BenchError, match=r"rx_power_dbm is 84 dBm at row 1 \(\d+ of \d+ rows"):
        check_tables(mixed, Simulator(Base()))


def test_a_table_against_itself_is_refused() -> None:
    with pytest.raises(BenchError, match=r"r\.parquet: its ranges are those of r\.parquet"):
        check_tables(table("r.parquet", 1.0), table("r.parquet", 1.0))


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        ("rx_power_dbm", 82.0, "the median of rx_power_dbm is 82 dBm: .*sign lost"),
        ("temperature_c", 1e308, r"temperature_c is 1e\+308 at row 0: no measurement"),
        ("temperature_c", 293.0, "median of temperature_c is 293 degC: expected .*kelvin"),
        ("reply_time_s", 900.0, "median of reply_time_s is 900 s: expected seconds"),
        ("reply_time_s", 0.9, "median of reply_time_s is 0.9 s: expected seconds"),
        ("time_s", 1.7e18, r"median of time_s is 1.7e\+18 s: expected seconds"),
        ("time_s", 1.7e12, r"median of time_s is 1.7e\+12 s: expected seconds"),
        ("rx_power_dbm", -8700.0, "median of rx_power_dbm is -8700 dBm: expected dBm"),
        ("rx_power_dbm", 2e-9, "rx_power_dbm is 2e-09 dBm: .*milliwatts"),
        ("tx_x_m", 3000.0, "positions tx_x_m .. rx_z_m are 1.5e.03 times .*millimetres"),
    ],
)
def test_figures_that_no_receiver_gives_are_refused(column: str, value: float, said: str) -> None:
    made = table("r.parquet", 1.0)
    places = dict.fromkeys(("tx_x_m", "tx_y_m", "tx_z_m", "rx_x_m", "rx_y_m", "rx_z_m"), 0.0)
    strange = Recordings(made.frame.assign(**places).assign(**{column: value}), "r.parquet")
    with pytest.raises(BenchError, match=said):
        check_tables(strange, Simulator(Base()))
    usual = made.frame.assign(
        rx_power_dbm=-82.0, temperature_c=20.0, reply_time_s=0.1, time_s=1.7e9, tx_x_m=2.0,
        tx_y_m=0.0, tx_z_m=0.0, rx_x_m=0.0, rx_y_m=0.0, rx_z_m=0.0,
    )  # fmt: skip
    check_tables(Recordings(usual, "r.parquet"), Simulator(Base()))


def test_waveforms_that_are_no_magnitudes_are_refused() -> None:
    made = table("r.parquet", 1.0).frame
    for share, fails in ((-1.0, True), (-0.05, False)):  # a small undershoot is arithmetic
        cirs = [np.array([0.0, share, 1.0, 0.5], np.float32)] * len(made)
        signed = Recordings(made.assign(cir=cirs), "r.parquet")
        if fails:
            with pytest.raises(BenchError, match=r"cir is -1 in row 0: expected magnitudes"):
                check_tables(signed, Simulator(Base()))
        else:
            check_tables(signed, Simulator(Base()))


def test_an_end_without_names_is_refused_and_names_may_be_numbers() -> None:
    made = table("r.parquet", 1.0).frame.assign(time_s=np.arange(40.0), tx=3)
    with pytest.raises(BenchError, match=r"column 'rx' is empty in every row: .*leave the column"):
        check_tables(Recordings(made.assign(rx=np.nan), "r.parquet"), Simulator(Base()))
    some = Recordings(made.assign(rx=[np.nan, "a"] * 20), "r.parquet")
    check_tables(some, Simulator(Base()))


def test_a_figure_that_no_instrument_reads_is_refused_in_a_single_row() -> None:
    made = table("r.parquet", 1.0, cir=False)
    wild = made.frame.assign(reply_time_s=[1e19, *[0.001] * 37, 1e19, np.nan])
    said = r"r\.parquet: reply_time_s is 1e\+19 s at row 0 \(2 rows like it\): no instrument"
    with pytest.raises(BenchError, match=said):
        check_tables(Recordings(wild, "r.parquet"), Simulator(Base()))
    check_tables(Recordings(wild.assign(reply_time_s=0.001), "r.parquet"), Simulator(Base()))


def test_headings_in_radians_beside_degrees_are_refused() -> None:
    """They gave a sine of 7.9 m, which held-out links liked."""
    turns = np.linspace(-0.5, 0.5, 40)

    def turning(source: str, by: float) -> Recordings:
        made = table(source, 1.0)
        return Recordings(made.frame.assign(azimuth_deg=by * turns), source)

    degrees, radians = turning("d.parquet", 360.0), turning("rad.parquet", 2 * np.pi)
    said = r"rad\.parquet: azimuth_deg goes from -3\.14 to 3\.14, in d\.parquet from -180 to 180"
    for pair in ((degrees, radians), (radians, degrees)):
        with pytest.raises(BenchError, match=said):
            check_tables(*pair)
    check_tables(degrees, turning("other.parquet", 350.0))
    check_tables(degrees, turning("still.parquet", 3.0))  # an antenna that hardly turns
    check_tables(degrees, table("none.parquet", 1.0))


def test_ranges_that_differ_by_arithmetic_alone_are_a_copy() -> None:
    ours = table("r.parquet", 1.0)
    rows = ours.frame.assign(range_m=ours.frame["range_m"] + 1e-7)
    with pytest.raises(BenchError, match=r"c\.parquet: its ranges are those of r\.parquet"):
        check_tables(ours, Recordings(rows, "c.parquet"))
    check_tables(ours, Recordings(rows.assign(range_m=rows["range_m"] + 0.001), "c.parquet"))


@pytest.mark.parametrize("wrong", ["ours", "theirs"])
def test_a_mistake_is_said_with_the_file_it_is_in(tmp_path: Path, wrong: str) -> None:
    """Two files of one name in two folders: "rec" said neither which nor where."""
    tables = {}
    for folder in ("ours", "theirs"):
        made = table("rec", 1.0 if folder == "ours" else 1.01)
        load = np.where(np.arange(len(made.frame)) == 7, 1e308 if folder == wrong else 2.0, 1.0)
        (tmp_path / folder).mkdir()
        path = tmp_path / folder / "rec.parquet"
        write_recordings(Recordings(made.frame.assign(load_t=load), "rec"), path)
        tables[folder] = read(path)
    with pytest.raises(BenchError) as told:
        check_tables(tables["ours"], tables["theirs"])
    file = tmp_path / wrong / "rec.parquet"
    assert str(told.value) == f"{file}: load_t is 1e+308 at row 7: no measurement"
