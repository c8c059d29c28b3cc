"""Readers written by published descriptions, on small files made here in that form."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bench.errors import BenchError
from bench.recordings import open_recordings
from bench.recordings.readers.ghent_family import find_environments
from bench.recordings.sources.base import open_source


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("BENCH_DATA", str(tmp_path))
    (tmp_path / "ghent").mkdir()
    return tmp_path


# The Ghent family ---------------------------------------------------------------------------------

META_19 = {
    "x_tag": 1000, "y_tag": 0, "z_tag": 1500, "x_anchor": 4000, "y_anchor": 4000,
    "z_anchor": 1500, "anchorNumber": 7.0, "RXPACC": 1518.0, "fpindex": 46350.0,
    "fp_ampl1": 1958, "fp_ampl2": 3287, "fp_ampl3": 3313, "std_noise": 88.0,
    "RX_power": -91.274, "FP_power": -111.719, "timestamp": 2.7e9,
    "estimated_range": [5100, 4900], "actual_range": 5000.0, "newlabel": "good",
    "loc_tag": "10-7", "NLOS": ["NLOS", "LOS"],
}  # fmt: skip
UNIVERSITY = (
    ",real_rng,rng,rssi,fp_idx,fp_power,fp_amp1,fp_amp2,fp_amp3,std_noise,pacc_cnt,condition,"
    "location_from,location_to,msid,bias,rng_wo_bias,error,error_nobias,env\n"
    "1,6.0,8.0,-80.1,743,-93.968,1404,1657,1179,36,101,nlos,hall,hall,0,0.01,7.99,1.99,2.0,hh\n"
    "2,2.5,2.4,-79.9,751,-82.7,5532,6158,3494,40,101,los,lab,lab,2,-0.08,2.48,-0.02,-0.1,ll\n"
)
FEATURES = (
    "fp_ampl1;fp_ampl2;fp_ampl3;std_noise;CIRpower;RXPACC;fpindex;RX_power;FP_power;Pd;Pr;"
    "estimated_range;real_rng;label;\n"
    "1404;1657;1179;36;1125,99;101;743;-80,136;-93,968;13,8;1,17;8,045;6,269;1;\n"
    "5532;6158;3494;40;1109,01;101;747;-79,895;-82,755;2,8;1,03;2,545;2,707;0;\n"
)


def _put_meta(data: Path, name: str, **changes: object) -> None:
    pd.DataFrame(META_19 | changes).to_csv(data / "ghent" / f"meta_{name}.csv")


def test_meta_in_the_form_of_2019_is_another_environment(data: Path) -> None:
    _put_meta(data, "IIoT_19")
    _put_meta(data, "OfficeLab", RX_power=-91.726, FP_power=-111.281)
    frame = open_recordings("ghent-family")[0].frame
    assert frame["environment"].tolist() == ["IIoT_19"] * 2 + ["OfficeLab"] * 2
    assert frame["link"].unique().tolist() == ["IIoT_19 10-7", "OfficeLab 10-7"]
    # Mirrored decimals are turned back only where they are mirrored.
    assert frame["rx_power_dbm"].tolist() == pytest.approx([-91.726] * 4)
    assert frame["first_path_power_dbm"].tolist() == pytest.approx([-111.281] * 4, abs=1e-3)


def test_university_in_metres_and_with_its_own_labels(data: Path) -> None:
    (data / "ghent" / "meta_University.csv").write_text(UNIVERSITY)
    (data / "ghent" / "features_university_hw_processed.csv").write_text("part of the same rows")
    recordings, _ = open_recordings("ghent-family")
    frame = recordings.frame
    assert recordings.errors_m() == pytest.approx([2.0, -0.1])
    assert frame["los"].tolist() == [False, True]
    assert frame["link"].tolist() == ["University 0, 6.0 m", "University 2, 2.5 m"]
    assert frame["first_path_power_dbm"].iloc[0] == pytest.approx(-93.968, abs=1e-3)


def test_features_alone_with_semicolons_and_decimal_commas(data: Path) -> None:
    (data / "ghent" / "features_university_hw_processed.csv").write_text(FEATURES)
    frame = open_recordings("ghent-family")[0].frame
    assert frame["environment"].unique().tolist() == ["university_hw"]
    assert frame["range_m"].tolist() == [8.045, 2.545]
    assert frame["los"].tolist() == [False, True]
    assert frame["link"].tolist() == ["university_hw 6.269 m", "university_hw 2.707 m"]
    assert frame["cir_power"].tolist() == [1125.99, 1109.01]


def test_features_in_millimetres_with_mirrored_levels(data: Path) -> None:
    text = FEATURES.replace(",", ".").replace(";", ",").replace("real_rng", "distance_GT")
    text = text.replace("8.045", "8045").replace("6.269", "6269").replace(",743,", ",46350,")
    (data / "ghent" / "features_Office.csv").write_text(text.replace("-93.968", "-93.032"))
    frame = open_recordings("ghent-family")[0].frame
    assert frame["range_m"].iloc[0] == pytest.approx(8.045)
    assert frame["first_path_index"].iloc[0] == pytest.approx(724.21875)


def test_a_meta_file_stands_for_its_features() -> None:
    names = ("meta_IIoT_19.csv", "features_IIoT_19.csv", "features_OfficeLab.csv",
             "meta_University.csv", "features_university_1_hw_processed.csv")  # fmt: skip
    found = find_environments([Path(name) for name in names])
    assert {name: path.name for name, path in found.items()} == {
        "IIoT_19": "meta_IIoT_19.csv",
        "OfficeLab": "features_OfficeLab.csv",
        "University": "meta_University.csv",
    }


def _put_cirs(data: Path, rows: int = 2, dtype: str = "c8") -> None:
    h5py = pytest.importorskip("h5py", reason="h5py is not installed")
    cirs = (np.arange(rows * 1016).reshape(rows, 1016) * (3 + 4j)).astype(dtype)
    with h5py.File(data / "ghent" / "CIRsV2.hdf5", "w") as file:
        file["OfficeLab"] = cirs
        file["University_full"] = cirs


def test_cirs_go_with_their_rows(data: Path) -> None:
    _put_meta(data, "IIoT_19")
    _put_meta(data, "OfficeLab")
    (data / "ghent" / "meta_University.csv").write_text(UNIVERSITY)
    _put_cirs(data)
    recordings, source = open_recordings("ghent-family:cir")
    frame = recordings.frame
    assert frame["environment"].tolist() == ["OfficeLab"] * 2 + ["University"] * 2
    assert [cell[1] for cell in frame["cir"]] == [5, 5 * 1017, 5, 5 * 1017]
    assert frame["cir_q"].iloc[0][2] == 8
    assert source is not None
    assert source.full_name == recordings.source == "ghent-family:cir"


@pytest.mark.parametrize(
    ("rows", "dtype", "expected"),
    [(3, "c8", "2 rows but 3 CIRs; expected one per row"), (2, "S4", "expected complex numbers")],
)
def test_cirs_that_do_not_fit_are_refused(data: Path, rows: int, dtype: str, expected: str) -> None:
    _put_meta(data, "OfficeLab")
    h5py = pytest.importorskip("h5py", reason="h5py is not installed")
    with h5py.File(data / "ghent" / "CIRsV2.hdf5", "w") as file:
        file["OfficeLab"] = np.ones((rows, 4)).astype(dtype)
    with pytest.raises(BenchError, match=expected):
        open_recordings("ghent-family:cir")
    (data / "ghent" / "CIRsV2.hdf5").write_bytes(b"no")
    with pytest.raises(BenchError, match="no HDF5 file"):
        open_recordings("ghent-family:cir")


def test_of_another_form_is_named(data: Path) -> None:
    path = data / "ghent" / "meta_Somewhere.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(BenchError, match=r"meta_Somewhere\.csv: no column 'fp_ampl1'"):
        open_recordings("ghent-family")


# Bregar -------------------------------------------------------------------------------------------


def _measurement(channel: int, nlos: int = 0) -> dict[str, object]:
    cir = [f"({k % 5}{-k:+d}j)" for k in range(200)]
    return {
        "tag_id": 1, "anchor_id": 2, "x_tag": 0.0, "y_tag": 0.0, "z_tag": 1.2, "x_anchor": 3.0,
        "y_anchor": 4.0, "z_anchor": 1.2, "nlos": nlos, "range": 5.1, "fp_index": 10, "rss": -80.0,
        "rss_fp": -82.0, "fp_point1": 5000, "fp_point2": 6000, "fp_point3": 5500,
        "stdev_noise": 48, "cir_power": 9000, "max_noise": 900, "rxpacc": 1010,
        "channel_number": channel, "cir": cir,
    }  # fmt: skip


def _put_bregar(data: Path, site: str, content: object) -> Path:
    path = data / "bregar" / site / "data.json"
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps(content))
    return path


def _site(**anchors: list[dict[str, object]]) -> dict[str, object]:
    point = {
        anchor: {"ch1": several[:1], "ch5": several[1:]} for anchor, several in anchors.items()
    }
    return {"path": [], "anchors": list(anchors), "channels": [], "measurements": {"1_2_3": point}}


def test_bregar_positions_channels_and_links(data: Path) -> None:
    two = [_measurement(1), _measurement(5, nlos=1)]
    _put_bregar(data, "location0", _site(A1=two))
    _put_bregar(data, "location2", _site(A1=two, A6=two))
    recordings, _ = open_recordings("bregar")
    frame = recordings.frame
    assert recordings.errors_m() == pytest.approx([0.1] * 4)
    assert frame["channel"].tolist() == [1, 5, 1, 5]
    assert frame["los"].tolist() == [True, False] * 2
    assert frame["link"].unique().tolist() == ["location0 1_2_3 A1", "location2 1_2_3 A1"]
    assert frame["cir"].iloc[0][7] == pytest.approx(np.hypot(7 % 5, 7))
    assert recordings.dropped == {"anchor A6 of location2 (position not right)": 2}


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ({}, "no 'measurements' where expected"),
        ([1], "not as published"),
        (_site(A1=[{"cir": []}]), "no 'nlos' where expected"),
        (_site(A1=[_measurement(1) | {"cir": ["x"]}]), "not as published"),
    ],
)
def test_bregar_of_another_form_is_named(data: Path, content: object, expected: str) -> None:
    path = _put_bregar(data, "location0", content)
    with pytest.raises(BenchError) as caught:
        open_recordings("bregar")
    assert expected in str(caught.value)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("name", ["bregar", "ghent-family"])
def test_untested_readers_say_so(name: str) -> None:
    assert "real file" in str(open_source(name).untested)
