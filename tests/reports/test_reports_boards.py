from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import result_files as files
from scipy import stats

from reports import Board, ReportError, make_boards


def boards(folder: Path, *records: Any, machine: str | None = None) -> list[Board]:
    return make_boards(files.read(folder, *records), machine)


def board(folder: Path, *records: Any, machine: str | None = None) -> Board:
    (only,) = boards(folder, *records, machine=machine)
    return only


def test_one_board_per_data_set_and_split(tmp_path: Path) -> None:
    records = [
        files.run(data=data, split=split)
        for data in ("rooms", "apartment")
        for split in ("link-kfold:5", "leave-environment-out:big")
    ]
    found = boards(tmp_path, *records)
    assert [(one.data, one.split) for one in found] == [
        ("apartment", "leave-environment-out:big"),
        ("apartment", "link-kfold:5"),
        ("rooms", "leave-environment-out:big"),
        ("rooms", "link-kfold:5"),
    ]
    assert [one.simulated for one in found] == [False, False, True, True]


def test_entries_are_sorted_by_nlos_mae_unknown_ones_last(tmp_path: Path) -> None:
    found = board(
        tmp_path,
        files.run("a", nlos=files.score(0.09)),
        files.run("b", nlos=files.score(0.05)),
        files.run("c", nlos=None),
        files.run("d", nlos=files.score(float("nan"))),
        files.run("e", nlos=files.score(0.07)),
    )
    assert [entry.model for entry in found.entries] == ["b", "e", "a", "c", "d"]


def test_seeds_are_averaged_with_student_interval(tmp_path: Path) -> None:
    maes = [0.070, 0.074, 0.071]
    runs = [files.run(seed=i, nlos=files.score(mae)) for i, mae in enumerate(maes)]
    (entry,) = board(tmp_path, *runs).entries
    assert entry.seeds == (0, 1, 2)
    mae = entry.nlos.mae_m
    assert mae.value == pytest.approx(sum(maes) / 3)
    assert (mae.low, mae.high) == pytest.approx((mae.value - 0.004, mae.value + 0.004))
    low, high = stats.t.interval(0.95, 2, loc=mae.value, scale=stats.sem(maes))
    assert mae.seed_half == pytest.approx((high - low) / 2)


def test_one_seed_has_no_seed_interval(tmp_path: Path) -> None:
    (entry,) = board(tmp_path, files.run()).entries
    assert entry.nlos.mae_m.seed_half is None


def test_an_interval_one_seed_lacks_is_not_made_up(tmp_path: Path) -> None:
    bare = files.score(mae_m=files.Interval(0.08))
    runs = [files.run(seed=0), files.run(seed=1, nlos=bare)]
    (entry,) = board(tmp_path, *runs).entries
    assert entry.nlos.mae_m.low is None


def test_a_seed_without_finite_figure_gives_no_seed_interval(tmp_path: Path) -> None:
    runs = [files.run(seed=0), files.run(seed=1, nlos=files.score(float("nan")))]
    (entry,) = board(tmp_path, *runs).entries
    assert math.isnan(entry.nlos.mae_m.value)
    assert entry.nlos.mae_m.seed_half is None


def test_sizes_and_estimates_are_averaged_over_seeds(tmp_path: Path) -> None:
    def one(seed: int, scale: float) -> Any:
        guess = files.Estimate("npu", files.Interval(10 * scale, 5, 20), None)
        size = files.Size(int(100 * scale), 50, 7, 9)
        return files.run(seed=seed, size=size, estimates=[guess])

    (entry,) = board(tmp_path, one(0, 1), one(1, 3)).entries
    assert entry.size.file_bytes == 200
    estimate = entry.estimate("npu")
    assert (estimate.latency_us.value, estimate.latency_us.low) == (20, 5)
    assert estimate.energy_mj is None
    assert entry.estimate("unheard-of") is None


def test_older_data_of_the_same_name_is_left_out_and_counted(tmp_path: Path) -> None:
    old = files.run("svm", data_fingerprint="old", created_utc="2026-01-01")
    new = files.run("mlp", data_fingerprint="new", created_utc="2026-02-01")
    found = board(tmp_path, old, new)
    assert found.fingerprint == "new"
    assert [entry.model for entry in found.entries] == ["mlp"]
    assert found.older_data == 1


def test_seeds_from_older_code_are_never_averaged_with_newer(tmp_path: Path) -> None:
    old = [
        files.run(seed=i, code_hash="old", created_utc="2026-01-01", nlos=files.score(0.2))
        for i in range(3)
    ]
    new = files.run(seed=0, code_hash="new", created_utc="2026-02-01", nlos=files.score(0.1))
    found = board(tmp_path, *old, new)
    assert found.entries[0].nlos.mae_m.value == pytest.approx(0.1)
    assert found.entries[0].seeds == (0,)
    assert found.older_code == 3


def test_other_package_versions_count_as_other_code(tmp_path: Path) -> None:
    old = files.run(seed=0, versions={"torch": "1"}, created_utc="2026-01-01")
    new = files.run(seed=1, versions={"torch": "2"}, created_utc="2026-02-01")
    assert board(tmp_path, old, new).entries[0].seeds == (1,)


def test_skipped_pairs_keep_their_reason_once(tmp_path: Path) -> None:
    skips = [files.skipped("svm", "qat", "no gradient", seed=i) for i in range(3)]
    found = board(tmp_path, files.run("svm", "fp32"), *skips)
    assert [(one.model, one.backend, one.reason) for one in found.skipped] == [
        ("svm", "qat", "no gradient")
    ]
    assert [entry.name for entry in found.entries] == ["svm/fp32"]


def test_pairs_without_any_record_are_missing(tmp_path: Path) -> None:
    found = board(tmp_path, files.run("a", "fp32"), files.run("b", "int8"))
    assert found.missing == [("a", "int8"), ("b", "fp32")]


def test_a_timing_belongs_to_its_artifact(tmp_path: Path) -> None:
    seeds = [files.run(seed=i) for i in range(2)]
    other = files.run(seed=0, split="link-kfold:5")
    found = boards(tmp_path, *seeds, other, files.timing(seeds[0], 10), files.timing(other, 99))
    medians = {one.split: one.entries[0].latency(1).median_us for one in found}
    assert medians == {"leave-environment-out:medium": 10, "link-kfold:5": 99}
    assert all(one.entries[0].own_timing for one in found)


def test_without_its_own_timing_one_of_the_same_kind_is_marked(tmp_path: Path) -> None:
    timed = files.run(split="link-kfold:5")
    wanted = files.run()
    found = boards(tmp_path, wanted, timed, files.timing(timed, 10))
    entry = found[0].entries[0]
    assert entry.latency(1).median_us == 10
    assert not entry.own_timing
    assert entry.latency(64) is None


def test_the_same_bytes_under_another_backend_keep_their_own_timing(tmp_path: Path) -> None:
    plain, graph = (files.run("m", b, artifact_sha256="same") for b in ("fp32", "graph"))
    found = board(tmp_path, plain, graph, files.timing(plain, 10), files.timing(graph, 20))
    medians = {entry.backend: entry.latency(1).median_us for entry in found.entries}
    assert medians == {"fp32": 10, "graph": 20}
    assert all(entry.own_timing for entry in found.entries)


def test_a_timing_of_another_backend_or_data_is_never_used(tmp_path: Path) -> None:
    run = files.run("remnet", "fp32")
    others = [
        files.timing(files.run("remnet", "int8")),
        files.timing(files.run("remnet", "fp32", data="apartment")),
    ]
    entry = board(tmp_path, run, *others).entries[0]
    assert entry.timing is None


OTHER = {"cpu": "Small board", "cores": 4}


def two_machines() -> list[Any]:
    run = files.run()
    return [
        run,
        files.timing(run, 10, created_utc="2026-01-01"),
        files.timing(run, 20, created_utc="2026-02-01", machine=OTHER),
    ]


def test_the_machine_used_last_is_shown_and_the_others_named(tmp_path: Path) -> None:
    found = board(tmp_path, *two_machines())
    assert found.machine == OTHER
    assert found.other_machines == ["Example CPU 3000, id 0123abcd"]
    assert found.entries[0].latency(1).median_us == 20


def test_a_machine_can_be_chosen_by_part_of_its_name(tmp_path: Path) -> None:
    found = board(tmp_path, *two_machines(), machine="example")
    assert found.machine == files.MACHINE
    assert found.entries[0].latency(1).median_us == 10


def test_a_machine_never_timed_is_an_error_that_names_the_others(tmp_path: Path) -> None:
    with pytest.raises(ReportError, match="Example CPU 3000, id 0123abcd, Small board"):
        board(tmp_path, *two_machines(), machine="mainframe")


def test_a_machine_without_a_name_still_has_a_label(tmp_path: Path) -> None:
    nameless = files.timing(files.run(), machine={"cores": 2}, created_utc="2020-01-01")
    found = board(tmp_path, files.run(), nameless, files.timing(files.run(), machine=OTHER))
    assert found.other_machines == ["unnamed machine"]


def test_one_processor_under_two_pythons_is_two_machines(tmp_path: Path) -> None:
    run = files.run()
    other = {**files.MACHINE, "python": "3.12.1", "id": "feedbeef"}
    timings = [files.timing(run, 10), files.timing(run, 20, machine=other)]
    found = board(tmp_path, run, *timings, machine="feedbeef")
    assert found.entries[0].latency(1).median_us == 20
    assert found.other_machines == ["Example CPU 3000, id 0123abcd"]


def test_the_same_files_give_the_same_boards(tmp_path: Path) -> None:
    records = [files.run(m, b) for m in "abc" for b in "xyz"]
    first = boards(tmp_path / "1", *records)
    second = boards(tmp_path / "2", *reversed(records))
    assert first == second
