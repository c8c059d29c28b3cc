"""The named data sets, on small files made here in the published forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bench.errors import BenchError
from bench.plugins import plugins
from bench.recordings import open_recordings
from bench.recordings.readers.deepuwb import OBSTACLES
from bench.recordings.readers.ghent import unmirrored
from bench.recordings.readers.outdoor import COLUMNS
from bench.recordings.sources.apartment import ApartmentSource
from bench.recordings.sources.base import Source, download_folder
from bench.recordings.sources.deepuwb import DeepUwbSource
from bench.recordings.sources.outdoor import OutdoorSource
from bench.recordings.splits import make_split

REAL = ("apartment", "ghent", "outdoor", "deepuwb")


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("BENCH_DATA", str(tmp_path))
    return tmp_path


# Deep UWB -----------------------------------------------------------------------------------------


def _deepuwb(rows_per_run: int = 25, runs: int = 8) -> pd.DataFrame:
    """Return a table of exactly the published form: runs of one room and one set of obstacles."""
    rng = np.random.default_rng(0)
    rows = rows_per_run * runs
    run = np.arange(rows) // rows_per_run
    kinds = ["0000000000", "1000000000", "0100000001", "0000001000"]
    return pd.DataFrame(
        {
            "CIR": [np.abs(rng.normal(0, 100, 157)) for _ in range(rows)],
            "Error": rng.normal(0.1, 0.1, rows),
            "Room": run % 5,
            "Obstacles": pd.Series([kinds[r % 4] for r in run], dtype=object),
        }
    )


def _put_deepuwb(data: Path, table: pd.DataFrame) -> Path:
    (data / "deepuwb").mkdir(exist_ok=True)
    path = data / "deepuwb" / "dataset.pkl"
    table.to_pickle(path)
    return path


def test_deepuwb_is_read_as_published(data: Path) -> None:
    table = _deepuwb()
    _put_deepuwb(data, table)
    recordings, source = open_recordings("deepuwb")
    frame = recordings.frame
    assert isinstance(source, DeepUwbSource)
    assert not recordings.simulated
    np.testing.assert_array_equal(np.stack(frame["cir"]), np.stack(table["CIR"]).astype(np.float32))
    np.testing.assert_array_equal(recordings.errors_m(), table["Error"])
    rooms = ["through-the-wall", "big", "medium", "small", "outdoor"]
    assert frame["environment"].iloc[::25].tolist() == [*rooms, *rooms[:3]]
    assert frame["obstacles"].iloc[50] == ["polystyrene plate", "metal window"]
    assert frame["los"].tolist() == (table["Obstacles"] == "0000000000").tolist()
    assert (frame["first_path_index"] == 5).all()
    assert frame["link"].nunique() == 8
    assert len(OBSTACLES) == 10


def test_deepuwb_splits_as_in_the_paper(data: Path) -> None:
    _put_deepuwb(data, _deepuwb(runs=20))
    recordings, source = open_recordings("deepuwb")
    (fold,) = make_split(recordings, "leave-environment-out", source=source).folds
    where = recordings.frame["environment"].to_numpy()
    assert set(where[fold.train]) == {"big", "small"}
    assert set(where[fold.test_nlos]) == {"medium"}
    assert set(where[fold.test_los]) == {"big", "medium", "small"}


def test_deepuwb_in_another_order_gets_links_by_room_and_obstacles(data: Path) -> None:
    table = _deepuwb(runs=8).sample(frac=1, random_state=0, ignore_index=True)
    _put_deepuwb(data, table)
    links = open_recordings("deepuwb")[0].frame["link"]
    assert links.nunique() == table[["Room", "Obstacles"]].drop_duplicates().shape[0]


def test_deepuwb_rows_that_are_not_as_published_are_counted(data: Path) -> None:
    table = _deepuwb().astype({"Error": object})
    table.at[0, "Room"] = 9
    table.at[1, "Obstacles"] = "01"
    table.at[2, "CIR"] = np.ones(156)
    table.at[3, "CIR"] = np.full(157, np.nan)
    table.at[4, "Error"] = "?"
    _put_deepuwb(data, table)
    assert open_recordings("deepuwb")[0].dropped == {
        "unknown room": 1,
        "obstacles are not ten digits 0/1": 1,
        "CIR not of length 157": 1,
        "no range error": 1,
        "NaN in the CIR": 1,
    }


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda t: t.drop(columns="Room"), "no column 'Room' (it has: CIR, Error, Obstacles)"),
        (lambda t: t.assign(CIR=[np.ones(100)] * len(t)), "CIR not of length 157"),
        (lambda t: t.iloc[:0], "no rows"),
    ],
)
def test_deepuwb_of_another_form_gives_one_clear_line(data: Path, change, expected: str) -> None:
    path = _put_deepuwb(data, change(_deepuwb()))
    with pytest.raises(BenchError) as caught:
        open_recordings("deepuwb")
    assert expected in str(caught.value)
    assert str(path) in str(caught.value)


# Outdoor ------------------------------------------------------------------------------------------

GOOD = (
    "1723710245.75672,6653,6648,1331,10.168694,5,14305,15276,14270.0,6491.0,230.0,52.0,-79.68,"
    "-80.71,72110385.0,72106024.0,-881874723.0,-953985108.0,-1783889797.0,-1855995821.0,12.0"
)


def _put_outdoor(data: Path, *lines: str, place: str = "LOS/height_50.0cm/10m.csv") -> None:
    path = data / "outdoor" / "Static_measurements" / place
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join([",".join(COLUMNS), *lines]) + "\n")


def test_outdoor_summaries_are_no_rows_and_damage_is_counted(data: Path) -> None:
    _put_outdoor(
        data,
        *[GOOD] * 6,
        GOOD.replace(",12.0", ",anchor_id: 12"),
        GOOD.replace("-953985108.0", "-953985100.0"),
        GOOD.replace(",6491.0", ",0").replace("-79.68", "-inf"),
        GOOD.replace(",230.0", ",102.0"),
        "\0\0\0",
        "Distance Mean,10.136019617977528",
        "RSSI_fp(dBm) Std,,,,,,,,,,,,,,,,,,,,",
    )
    _put_outdoor(data, GOOD, place="NLOS/height_50.0cm/10m.csv")
    recordings, _ = open_recordings("outdoor")
    assert len(recordings) == 7
    assert recordings.dropped == {
        "damaged line": 2,
        "timestamps contradict the round-trip times": 1,
        "registers contradict the receive level": 1,
        "rx_power_dbm is infinite": 1,
    }
    row = recordings.frame.iloc[0]
    assert row["true_range_m"] == pytest.approx(np.sqrt(10**2 + 0.5**2))
    assert row["rx_power_dbm"] == pytest.approx(-79.68, abs=0.01)
    assert row["reply_time_s"] == pytest.approx(1.1285e-3, rel=1e-3)
    assert recordings.frame["link"].unique().tolist() == ["50 cm, 10 m"]
    assert recordings.frame["los"].tolist() == [True] * 6 + [False]


def test_outdoor_with_another_header_is_refused(data: Path) -> None:
    path = data / "outdoor" / "Static_measurements" / "LOS" / "height_50.0cm" / "2m.csv"
    path.parent.mkdir(parents=True)
    path.write_text("a,b\n1,2\n")
    with pytest.raises(BenchError, match="expected the header timestamp"):
        OutdoorSource().load()


# Ghent --------------------------------------------------------------------------------------------


def _put_ghent(data: Path) -> Path:
    """Return a folder with both years: the columns read, a few rows each."""
    folder = data / "ghent"
    folder.mkdir()
    hall_19 = {
        "x_tag": 1000, "y_tag": 0, "z_tag": 1500, "x_anchor": 4000, "y_anchor": 4000,
        "z_anchor": 1500, "anchorNumber": 7.0, "RXPACC": 1500.0, "fpindex": 46350.0,
        "fp_ampl1": 1958, "fp_ampl2": 3287, "fp_ampl3": 3313, "std_noise": 88.0,
        "RX_power": -91.274, "FP_power": -111.719, "timestamp": 2.7e9,
        "estimated_range": ["5100", "4900", "-"], "actual_range": 5000.0, "newlabel": "good",
        "loc_tag": "10-7", "NLOS": ["NLOS", "LOS", "LOS"],
    }  # fmt: skip
    pd.DataFrame(hall_19).to_csv(folder / "meta_IIoT_19.csv")
    stamps = {"T1": 57055236684, "T2": 56459561043, "T3": 69652782156, "T4": 70248523212,
              "T5": 70601671244, "T6": 70005933158}  # fmt: skip
    registers = dict.fromkeys((f"{name}_{end}" for end in ("tag", "anchor") for name in (
        "rxtofs", "DRX_CAR_INT", "sar_temp_l", "otp_temp_23", "sar_bat_l", "ppampl", "rxpacc",
        "rxpacc_nosat", "fpindex", "rcphase", "rsmpdel", "ldethres")), 300.0)  # fmt: skip
    hall_20 = stamps | registers | {
        "fp_ampl1_tag": 17442, "fp_ampl2_tag": 18524, "fp_ampl3_tag": 18109, "CIR_noise_tag": 48,
        "rxpower_tag": -79.948, "fppower_tag": -81.873, "RMoteclk_tag": [1000, 1000, 1129],
        "tag_ID": [1, 1, 3], "anchor_ID": [3, 3, 1], "distance_UWB": 10786,
        "distance_GT": 10969.4, "NLOS": "LOS", "DRX_CAR_INT_tag": 44122,
    }  # fmt: skip
    table = pd.DataFrame(hall_20)
    table.loc[2, "T1"] += 100
    table.to_csv(folder / "meta_IIoT_20.csv")
    return folder


def test_ghent_lengths_signs_and_levels(data: Path) -> None:
    _put_ghent(data)
    recordings, _ = open_recordings("ghent")
    hall = recordings.frame[recordings.frame["environment"] == "IIoT_19"]
    assert recordings.errors_m()[:2] == pytest.approx([0.1, -0.1])
    assert hall["true_range_m"].tolist() == [5.0, 5.0]
    assert hall["los"].tolist() == [False, True]
    assert hall["first_path_index"].iloc[0] == pytest.approx(724.21875)
    assert hall["rx_power_dbm"].iloc[0] == pytest.approx(-91.726)
    assert hall[["tx_x_m", "rx_y_m", "rx"]].iloc[0].tolist() == [1.0, 4.0, "anchor 7"]
    assert recordings.dropped["no range error"] == 1


def test_ghent_repeats_are_one_exchange_and_both_directions_one_link(data: Path) -> None:
    _put_ghent(data)
    recordings, _ = open_recordings("ghent")
    hall = recordings.frame[recordings.frame["environment"] == "IIoT_20"]
    assert recordings.dropped["repeated exchange (the same six timestamps)"] == 1
    assert hall["link"].tolist() == ["IIoT_20 1-3"] * 2
    assert hall["tx"].tolist() == ["node 1", "node 3"]
    assert hall["clock_offset_ppm"].iloc[0] == pytest.approx(4.5657, abs=1e-3)
    assert hall["reply_time_s"].iloc[0] == pytest.approx(0.20647, abs=1e-4)
    assert hall["time_s"].tolist() == pytest.approx([0, 1.0009], abs=1e-3)
    assert hall["T6"].tolist() == [70005933158.0] * 2


@pytest.mark.parametrize(
    ("column", "content", "expected"),
    [("T5", None, "no column 'T5'"), ("distance_UWB", "-", "'distance_UWB' holds no number")],
)
def test_ghent_of_another_form_is_named(data: Path, column, content, expected: str) -> None:
    path = _put_ghent(data) / "meta_IIoT_20.csv"
    table = pd.read_csv(path)
    table = table.drop(columns=column) if content is None else table.assign(**{column: content})
    table.to_csv(path)
    with pytest.raises(BenchError, match=expected) as caught:
        open_recordings("ghent")
    assert str(path) in str(caught.value)


# Apartment ----------------------------------------------------------------------------------------

FRAME = (
    "{kind} 4B Rx time = {time:.15e} 953B8FDBD7\r\n\r\n"
    "{kind} 4B Rx time(un) = 1.0e+001 953B901800\r\n\r\ntxdly 4045 rxdly 4045\r\n"
    "RX DATA: 41cc\r\n\r\n"
    "RX OK WInd(0735), HLP({path}), PSC(0274), SLP(0000.0000), RC(0095 3B8FDBD7), DCR(0), DCI(0), "
    "NTH(077A), T(83BD), RSL(-078.9641), FSL({level}), RSMPL(31)\r\nAccum Len 1016\r\n{lines}\r\n"
)
RANGE = (
    "\r\nAnchor ToF: 8.986 ns Dist: 2.693148 m DistRaw: 2.603148 m DistScal: 2.603148 m "
    "Bias: -0.090 m ClockOffset: 1.814 ppm\r\n\r\n"
    "Ra  000000023b4a86af Db 000000023b4a3e6e\r\n\r\n"
    "Rb  00000002f9b76319 Da 00000002f9b7b951\r\n\r\n"
)
ERROR = "RX E\0 WInd(0735), PSC(0264), CE(0000), T(82BE)\r\nAccum Len 1016\r\n1, 2\r\n\r\n"


def _frame(kind: str, time: float, value: int = 1, path: str = "0745.3125") -> str:
    lines = "".join(f"{value}, {-row}\r\n" for row in range(1016))
    return FRAME.format(kind=kind, time=time, path=path, level="-081.7507", lines=lines)


def _put_apartment(data: Path, *logs: str) -> Path:
    folder = data / "apartment" / "results"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "anchors.csv").write_text("location,x,y\n1,0.0,0.0\n")
    (folder / "tags.csv").write_text("location,x,y\n1,3.0,4.0\n2,1.0,0.0\n")
    (folder / "pairs.csv").write_text("file_number,anchor_location,tag_location\n1,1,1\n2,1,2\n")
    (folder / "labels.csv").write_text("file_id,label\n1,NDP NLOS\n2,LOS\n")
    header = "File:20180108-115817_DecaWaveAllAccum.log, created by DecaRanging\r\n"
    for number, log in enumerate(logs, 1):
        (folder / f"{number}.log").write_text(header + log, newline="")
    return folder


def test_apartment_ranges_belong_to_the_final_frame_before_them(data: Path) -> None:
    exchange = _frame("21", 17.0, 5, "0701.5") + _frame("29", 17.1, 7) + RANGE
    later = _frame("21", 0.7, 5) + _frame("29", 0.8, 9, "0746.0") + RANGE  # the counter turned over
    cut_short = _frame("21", 1.5) + ERROR
    _put_apartment(data, RANGE + exchange + ERROR + later + cut_short, exchange)
    recordings, _ = open_recordings("apartment")
    frame = recordings.frame
    assert recordings.dropped == {"range without a frame": 1}
    assert [cell[3] for cell in frame["cir_i"]] == [7, 9, 7]
    np.testing.assert_array_equal(frame["cir_q"].iloc[0], -np.arange(1016))
    np.testing.assert_allclose(frame["cir"].iloc[0], np.hypot(7, np.arange(1016)))
    assert frame["first_path_index"].tolist() == [745.3125, 746.0, 745.3125]
    assert frame["poll_first_path_index"].tolist() == [701.5, 745.3125, 701.5]
    assert frame["range_m"].tolist() == [2.693148] * 3
    assert frame["true_range_m"].tolist() == [5.0, 5.0, 1.0]
    assert frame["los_class"].tolist() == ["NDP NLOS", "NDP NLOS", "LOS"]
    assert frame["los"].tolist() == [False, False, True]
    assert frame["time_s"].tolist() == pytest.approx([0, 17.2074 - 16.3, 0], abs=1e-3)
    assert frame["reply_time_s"].iloc[0] == pytest.approx(0.15, abs=1e-6)
    assert frame["link"].nunique() == 2


def test_apartment_damaged_accumulators_are_dropped_and_counted(data: Path) -> None:
    good = _frame("21", 1.0) + _frame("29", 1.1) + RANGE
    short = good.replace("1, -1015\r\n", "")
    text = good.replace("1, -500", "1, x500")
    _put_apartment(data, good * 3 + short + text, good)
    recordings, _ = open_recordings("apartment")
    assert len(recordings) == 4
    assert recordings.dropped == {"no CIR": 1, "CIR not of length 1016": 1}


def test_apartment_is_parsed_again_when_a_file_changes(data: Path) -> None:
    good = _frame("21", 1.0) + _frame("29", 1.1) + RANGE
    folder = _put_apartment(data, good, good)
    first = ApartmentSource().load()
    again = ApartmentSource().load()
    assert first.fingerprint == again.fingerprint
    (folder / "2.log").write_text(good.replace("Dist: 2.693148", "Dist: 2.793148"), newline="")
    assert ApartmentSource().load().frame["range_m"].tolist() == [2.693148, 2.793148]


def test_a_damaged_cache_is_not_believed(data: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path / "cache"))
    good = _frame("21", 1.0) + _frame("29", 1.1) + RANGE
    _put_apartment(data, good, good)
    first = ApartmentSource().load()
    (cached,) = (tmp_path / "cache" / "parsed").iterdir()
    content = bytearray(cached.read_bytes())
    content[len(content) // 2] ^= 0xFF
    cached.write_bytes(content)
    assert ApartmentSource().load().fingerprint == first.fingerprint


def test_a_cache_that_cannot_be_written_costs_only_time(data: Path, tmp_path, monkeypatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path / "file" / "cache"))
    good = _frame("21", 1.0) + _frame("29", 1.1) + RANGE
    _put_apartment(data, good, good)
    assert len(ApartmentSource().load()) == 2


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("1.log", "no ranges here", "no range found"),
        ("7.log", "anything", "no row for log 7"),
        ("tags.csv", "location,x\n1,2\n", "no column 'y'"),
        ("labels.csv", "file_id,label\n1,MAYBE\n2,LOS\n", "unknown label 'MAYBE'"),
    ],
)
def test_apartment_files_of_another_form_are_named(data, name, content, expected) -> None:
    good = _frame("21", 1.0) + _frame("29", 1.1) + RANGE
    folder = _put_apartment(data, good, good)
    (folder / name).write_text(content)
    with pytest.raises(BenchError, match=expected) as caught:
        ApartmentSource().load()
    assert name.split(".")[0] in str(caught.value)


# All ----------------------------------------------------------------------------------------------


def test_mirrored_decimals_are_turned_back() -> None:
    assert unmirrored(pd.Series([-91.274, -79.05])).tolist() == pytest.approx([-91.726, -79.95])


@pytest.mark.parametrize("name", REAL)
def test_a_data_set_that_is_not_here_says_how_to_get_it(name: str, data: Path) -> None:
    with pytest.raises(BenchError) as caught:
        open_recordings(name)
    line = str(caught.value)
    assert f"bench data fetch {name}" in line
    assert "https://doi.org/10." in line
    assert str(download_folder(name)) in line


def test_an_unknown_data_set_gets_a_did_you_mean() -> None:
    with pytest.raises(BenchError, match="unknown data set 'apartmnt'; did you mean 'apartment'"):
        open_recordings("apartmnt")


@pytest.mark.parametrize("path", ["missing.parquet", "./rooms", "missing.xlsx", Path("rooms")])
def test_what_looks_like_a_path_is_one(path) -> None:
    with pytest.raises(BenchError, match="no such file"):
        open_recordings(path)


def test_every_registered_data_set_is_a_source() -> None:
    for plugin in plugins("datasets"):
        assert issubclass(plugin.load(), Source)
        assert plugin.summary()


# On the real files --------------------------------------------------------------------------------


@pytest.mark.real
def test_the_real_apartment(real_data: Path) -> None:
    recordings, _ = open_recordings("apartment")
    frame = recordings.frame.assign(error=recordings.errors_m())
    assert len(frame) == 3721
    assert frame["link"].nunique() == 25
    assert recordings.dropped == {
        "range without a frame": 1,
        "poll_rx_power_dbm is infinite": 1,
    }
    error = frame.groupby("los_class")["error"].median()
    assert 0.1 < error["LOS"] < 0.5
    assert error["NDP NLOS"] > 0.6
    ticks = {name: frame[f"{name}_ticks"] for name in ("Ra", "Db", "Rb", "Da")}
    offset = ((ticks["Ra"] - ticks["Db"]) / ticks["Db"] * 1e6) - (
        2 * frame["range_raw_m"] / 299_792_458 / frame["reply_time_s"] * 1e6
    )
    np.testing.assert_allclose(frame["clock_offset_ppm"], offset, atol=2e-3)


@pytest.mark.real
def test_real_double_sided_ranges_agree_with_the_timestamps(real_data: Path) -> None:
    from bench.recordings.twr import intervals

    recordings, _ = open_recordings("ghent")
    hall = recordings.frame[recordings.frame["environment"] == "IIoT_20"]
    assert (len(recordings), len(hall), hall["link"].nunique()) == (20337, 3177, 4)
    found = intervals(hall)
    truncated = found.double_sided_m() - hall["range_m"].to_numpy()
    assert truncated.min() >= 0
    assert truncated.max() < 1e-3
    np.testing.assert_allclose(hall["clock_offset_ppm"], found.clock_offset_ppm(), atol=0.09)
    assert np.abs(found.single_sided_m() - hall["true_range_m"]).max() > 100


@pytest.mark.real
def test_real_powers_are_what_the_registers_imply(real_data: Path) -> None:
    hall = open_recordings("ghent")[0].frame
    assert (hall["first_path_power_dbm"] - unmirrored(hall["first_path_power_printed_dbm"])
            ).abs().quantile(0.9999) < 2e-3  # fmt: skip
    outside = open_recordings("outdoor")[0].frame
    assert (outside["rx_power_dbm"] - outside["rx_power_printed_dbm"]).abs().max() < 0.01
    assert len(outside) == 51761
