from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import matplotlib.image
import pytest
import result_files as files
from hypothesis import given
from hypothesis import strategies as st

from reports import Board, ReportError, make_boards
from reports.figures import latency_against_error, points, save_png, save_svg
from reports.pareto import pareto_front

POINTS = st.lists(st.tuples(st.floats(0, 9), st.floats(0, 9)), max_size=30)


def boards(folder: Path, *records: Any) -> list[Board]:
    return make_boards(files.read(folder, *records))


@given(POINTS)
def test_nothing_beats_the_front_and_all_else_is_beaten(some: list[tuple[float, float]]) -> None:
    front = pareto_front(some)
    for i, (x, y) in enumerate(some):
        beaten = any(a <= x and b <= y and (a, b) != (x, y) for a, b in some)
        assert (some[i] in [some[k] for k in front]) == (not beaten)
    assert [some[i][0] for i in front] == sorted(some[i][0] for i in front)
    assert len({some[i] for i in front}) == len(front)


def test_a_small_front_by_hand() -> None:
    assert pareto_front([(3, 1), (1, 3), (2, 2), (2, 3), (4, 1)]) == [1, 2, 0]
    assert pareto_front([]) == []


def test_points_are_measured_latency_and_error(tmp_path: Path) -> None:
    run, floor, untimed = files.run(), files.run("none"), files.run("svm")
    (board,) = boards(tmp_path, run, floor, untimed, files.timing(run, 50), files.timing(floor, 1))
    (point,) = points(board)
    assert (point.model, point.backend) == ("remnet", "fp32")
    assert (point.latency_us, point.latency_low_us, point.latency_high_us) == (50, 49, 51)
    assert (point.mae_m, point.mae_low_m) == pytest.approx((0.07, 0.066))


def test_points_of_a_device_are_its_estimates(tmp_path: Path) -> None:
    bare = files.Estimate("npu", files.Interval(7.0), None)
    score = files.score(mae_m=files.Interval(0.08))
    run = files.run(estimates=[bare], nlos=score)
    (board,) = boards(tmp_path, run, files.run("mlp"))
    (point,) = points(board, "npu")
    assert (point.latency_us, point.latency_low_us, point.latency_high_us) == (7, 7, 7)
    assert (point.mae_low_m, point.mae_high_m) == (0.08, 0.08)
    assert [one.latency_us for one in points(board, "cortex-a53")] == [900]
    assert points(board, "edge-tpu") == []


def test_a_panel_per_board_with_units_and_the_simulated_mark(tmp_path: Path) -> None:
    figure = latency_against_error(boards(files.full_folder(tmp_path)))
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == [
        "apartment, split link-kfold:5",
        "rooms (SIMULATED), split leave-environment-out:medium",
    ]
    for axes in figure.axes:
        assert axes.get_xlabel().endswith("(µs)")
        assert axes.get_ylabel() == "NLoS MAE (m)"
        names = [text.get_text() for text in axes.get_legend().get_texts()]
        assert names[:4] == ["cnn1d", "mlp", "remnet", "svm"]
        assert names[-2:] == ["Pareto front", "no mitigation"]


def test_the_front_drawn_is_the_front(tmp_path: Path) -> None:
    runs = [files.run(m, nlos=files.score(e)) for m, e in (("a", 0.07), ("b", 0.08), ("c", 0.09))]
    timings = [files.timing(run, us) for run, us in zip(runs, (90, 20, 50), strict=True)]
    (axes,) = latency_against_error(boards(tmp_path, *runs, *timings)).axes
    (front,) = [line for line in axes.lines if line.get_label() == "Pareto front"]
    assert list(front.get_xdata()) == [20, 90]
    assert list(front.get_ydata()) == pytest.approx([0.08, 0.07])


def test_an_unstable_point_is_hollow_and_not_on_the_front(tmp_path: Path) -> None:
    good, shaky = files.run("good"), files.run("shaky", nlos=files.score(0.01))
    slow = files.run("slow", nlos=files.score(0.05))
    records = [files.timing(good, 50), files.timing(shaky, latency=[files.latency(1, 5, True)])]
    records.append(files.timing(slow, 80))
    (axes,) = latency_against_error(boards(tmp_path, good, shaky, slow, *records)).axes
    (front,) = [line for line in axes.lines if line.get_label() == "Pareto front"]
    assert list(front.get_xdata()) == [50, 80]
    hollow = [line for line in axes.lines if line.get_markerfacecolor() == "none"]
    assert [list(line.get_xdata()) for line in hollow] == [[5]]
    assert axes.get_legend().get_texts()[-1].get_text() == "unstable"


def test_one_point_is_no_front(tmp_path: Path) -> None:
    alone = files.run("alone")
    (axes,) = latency_against_error(boards(tmp_path, alone, files.timing(alone, 50))).axes
    assert "Pareto front" not in [line.get_label() for line in axes.lines]


def test_estimated_latency_is_labelled_an_estimate(tmp_path: Path) -> None:
    (axes,) = latency_against_error(boards(tmp_path, files.run()), "cortex-a53").axes
    assert axes.get_xlabel() == "estimated latency of one inference on cortex-a53 (µs, est.)"


def test_more_names_than_looks_still_draw(tmp_path: Path) -> None:
    runs = [files.run(f"m{i}", f"b{i}") for i in range(15)]
    figure = latency_against_error(boards(tmp_path, *runs), "cortex-a53")
    save_png(figure, tmp_path / "f.png")


def test_nothing_to_draw_says_what_was_missing(tmp_path: Path) -> None:
    found = boards(tmp_path, files.run(), files.run("mlp", nlos=None))
    with pytest.raises(ReportError, match="both an NLoS MAE and a measured latency"):
        latency_against_error(found)
    with pytest.raises(ReportError, match="an estimate for device 'edge-tpu'"):
        latency_against_error(found, "edge-tpu")


def test_files_are_pictures_and_repeat_byte_for_byte(tmp_path: Path) -> None:
    found = boards(files.full_folder(tmp_path / "results"))
    for name in ("a", "b"):
        figure = latency_against_error(found)
        save_svg(figure, tmp_path / f"{name}.svg")
        save_png(figure, tmp_path / f"{name}.png")
    assert ElementTree.parse(tmp_path / "a.svg").getroot().tag.endswith("svg")
    assert matplotlib.image.imread(tmp_path / "a.png").shape[0] > 1000
    for kind in ("svg", "png"):
        assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()


def test_neither_pyplot_nor_matplotlib_is_imported_before_it_is_needed(tmp_path: Path) -> None:
    run = files.run()
    files.write(tmp_path, run, files.timing(run))
    code = (
        "import sys, pathlib, reports, reports.figures, reports.leaderboard\n"
        "from reports import *\n"
        f"boards = make_boards(read_results(pathlib.Path({str(tmp_path)!r})))\n"
        "heavy = {'matplotlib', 'torch', 'sklearn', 'scipy', 'pandas', 'bench', 'zoo'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
        "reports.figures.latency_against_error(boards)\n"
        "assert 'matplotlib' in sys.modules and 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_model_far_worse_than_nothing_is_named_and_not_drawn_to_scale(tmp_path: Path) -> None:
    good, broken = files.run("good", nlos=files.score(0.05)), files.run("broken")
    broken = replace(broken, nlos=files.score(0.9))
    timings = [files.timing(good), files.timing(broken, 50.0)]
    axes = latency_against_error(boards(tmp_path, good, broken, *timings)).axes[0]
    assert axes.get_ylim()[1] < 0.2
    assert any("broken/fp32 (0.90 m)" in text.get_text() for text in axes.texts)
