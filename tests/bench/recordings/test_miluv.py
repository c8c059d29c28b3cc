"""MILUV on a small experiment made here in the published form, and on the real one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bench.errors import BenchError
from bench.recordings import open_recordings
from bench.recordings.readers.miluv import C_AIR_M_PER_NS, TURN_NS

EXPERIMENT = "cirObstacles_3_random_0"
DISTANCE_M = 3.0
OFFSET_PPM = 4.0
REPLY_NS, NEXT_NS, DELAY_NS = 305_000.0, 1_538_000.0, 0.5


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("BENCH_DATA", str(tmp_path))
    return tmp_path


def _range(start: int, end: int, time_s: float) -> dict[str, object]:
    """Return one exchange: the initiator's clock is fast, both radios are 0.5 ns late."""
    flight = DISTANCE_M / C_AIR_M_PER_NS + DELAY_NS
    fast = 1 + OFFSET_PPM * 1e-6
    a0, b0 = 67_000_000.0, 12_345.0  # the initiator's counter turns over within the exchange
    stamps = {
        "tx1_raw": a0,
        "rx1_raw": b0,
        "tx2_raw": b0 + REPLY_NS,
        "rx2_raw": a0 + (REPLY_NS + 2 * flight) * fast,
        "tx3_raw": b0 + REPLY_NS + NEXT_NS,
        "rx3_raw": a0 + (REPLY_NS + NEXT_NS + 2 * flight) * fast,
    }
    stamps = {name: value % TURN_NS for name, value in stamps.items()}
    stamps["tx1_raw"] += time_s * TURN_NS  # as published: some counters are not turned over
    return {
        "range": 3.05, "from_id": start, "to_id": end, **stamps, "fpp1": -90.0, "fpp2": -80.0,
        "skew1": -OFFSET_PPM, "skew2": OFFSET_PPM, "gt_range": DISTANCE_M, "timestamp": time_s,
    }  # fmt: skip


def _cir(who: int, start: int, end: int, time_s: float, value: int = 1) -> dict[str, object]:
    cir = [value] * 700 + [9] * 316
    return {"timestamp": time_s, "my_id": who, "from_id": start, "to_id": end, "idx": 700.5,
            "cir": str(cir)}  # fmt: skip


def _put(data: Path, ranges: list[dict], cirs: list[dict], robot: str = "ifo001") -> Path:
    folder = data / "miluv" / EXPERIMENT / robot
    folder.mkdir(parents=True, exist_ok=True)
    pd.DataFrame(ranges).to_csv(folder / "uwb_range.csv", index=False)
    pd.DataFrame(cirs).to_csv(folder / "uwb_cir.csv", index=False)
    return folder


@pytest.fixture
def experiment(data: Path) -> Path:
    """Two robots that both logged the range between them, one anchor, a listener, a late CIR."""
    ranges = [_range(10, 20, 1.0), _range(10, 3, 2.0), _range(10, 20, 31.0), _range(10, 2, 32.0)]
    cirs = [
        _cir(20, 10, 20, 1.1, value=2),  # the responder's: the initiator's is preferred
        _cir(10, 10, 20, 1.2, value=3),
        _cir(11, 10, 3, 2.1, value=4),  # overheard
        _cir(3, 10, 3, 2.2, value=5),
        _cir(20, 10, 20, 31.1, value=6),
        _cir(10, 10, 2, 32.9, value=7),  # too late
    ]
    _put(data, ranges, cirs)
    _put(data, ranges[:1], cirs[:1], "ifo002")
    return data


def test_a_cir_goes_with_the_range_of_its_pair_just_before_it(experiment: Path) -> None:
    recordings, source = open_recordings("miluv")
    frame = recordings.frame
    assert [cell[0] for cell in frame["cir"]] == [3, 5, 6]
    assert recordings.dropped == {
        "range without a CIR of one of its ends": 1,
        "CIR overheard by a third tag": 1,
        "CIR without a range of its pair": 1,
    }
    assert frame["rx"].tolist() == ["10", "3", "20"]
    assert frame["tx"].tolist() == ["20", "10", "10"]
    assert frame["first_path_power_dbm"].tolist() == [-80.0, -90.0, -90.0]
    assert frame["clock_offset_ppm"].tolist() == [OFFSET_PPM] * 3
    assert frame["reply_time_s"].tolist() == pytest.approx([REPLY_NS * 1e-9] * 3)
    assert frame["los"].tolist() == [True, False, True]
    assert frame["obstacles"].iloc[1] == ["plastic"]
    assert source is not None
    assert source.full_name == "miluv"


def test_a_link_is_a_pair_and_a_stretch_of_time(experiment: Path) -> None:
    links = open_recordings("miluv")[0].frame["link"].tolist()
    assert links == [f"{EXPERIMENT} {name}" for name in ("10-20 from 0 s", "3-10 from 0 s",
                                                         "10-20 from 20 s")]  # fmt: skip


def test_timestamps_give_double_and_single_sided_ranges(experiment: Path) -> None:
    double, single = open_recordings("miluv:ds")[0], open_recordings("miluv:ss")[0]
    late_m = DELAY_NS * C_AIR_M_PER_NS
    assert open_recordings("miluv")[0].errors_m() == pytest.approx([0.05] * 3)
    assert double.errors_m() == pytest.approx([late_m] * 3, abs=1e-4)
    clock_m = C_AIR_M_PER_NS / 2 * REPLY_NS * OFFSET_PPM * 1e-6
    assert single.errors_m() - double.errors_m() == pytest.approx([clock_m] * 3, abs=1e-4)
    assert single.source == "miluv:ss"
    assert (single.frame["range_calibrated_m"] == 3.05).all()


@pytest.mark.parametrize(
    ("name", "change", "expected"),
    [
        ("miluv:xs", {}, "unknown variant of miluv 'xs'; did you mean"),
        ("rooms:ss", {}, "unknown variant of rooms 'ss'"),
        ("miluv", {"skew1": None}, "uwb_range.csv: no column 'skew1'"),
    ],
)
def test_what_is_not_as_published_gives_one_line(
    experiment: Path, name: str, change: dict[str, object], expected: str
) -> None:
    path = experiment / "miluv" / EXPERIMENT / "ifo001" / "uwb_range.csv"
    pd.read_csv(path).drop(columns=list(change)).to_csv(path)
    with pytest.raises(BenchError) as caught:
        open_recordings(name)
    assert expected in str(caught.value)


@pytest.mark.real
def test_the_real_experiment(real_data: Path) -> None:
    if not (real_data / "miluv").is_dir():
        pytest.skip("no miluv in BENCH_DATA")
    recordings, double, single = (open_recordings(f"miluv{v}")[0] for v in ("", ":ds", ":ss"))
    frame = recordings.frame
    assert 150 < len(frame) < 330
    assert recordings.dropped["CIR overheard by a third tag"] > 600
    assert 0.10 < np.abs(recordings.errors_m()).mean() < 0.16
    # Calibration takes 0.1 m of antenna delay off; single-sided ranges keep the clock offset.
    assert 0.05 < (double.frame["range_m"] - frame["range_m"]).mean() < 0.15
    clock_m = 299_702_547 / 2 * frame["reply_time_s"] * frame["clock_offset_ppm"] * 1e-6
    rest_m = single.frame["range_m"] - double.frame["range_m"] - clock_m
    assert np.abs(rest_m).mean() < 0.03
    ends = [frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy() for end in ("tx", "rx")]
    far = np.linalg.norm(ends[0] - ends[1], axis=1)
    assert np.abs(far - frame["true_range_m"]).max() < 0.005
    assert frame["link"].nunique() > 100
