"""The transfer matrix, and what `bench run` across data and `bench transfer` print."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from test_across import A, B, table

from bench.cli import main as cli
from bench.errors import BenchError
from bench.measure.metrics import score
from bench.parallel import Spread
from bench.recordings import Recordings, write_recordings
from bench.results import Interval
from bench.runner.curve import CurvePoint
from bench.runner.curve_picture import draw_curve
from bench.runner.material import Material
from bench.runner.plan import Plan
from bench.runner.transfer import OTHERS, here, transfer
from bench.runner.transfer_picture import draw_matrix

FAR = table(9, offset_m=0.6, source="far")


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    paths = [tmp_path / f"{one.source}.parquet" for one in (A, FAR)]
    for path, one in zip(paths, (A, FAR), strict=True):
        write_recordings(one, path)
    return [str(path) for path in paths]


def _bench(*arguments: object) -> str:
    done = CliRunner().invoke(cli.group, [str(a) for a in arguments], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.output


def _median(plan: Plan, material: Material, *_: object) -> tuple[list, list]:
    """Score the training rows' median without files: what the matrix makes of it is tested."""
    rows, left = [], []
    for fold in material.split.folds:
        tested = np.concatenate([fold.test_nlos, fold.test_los])
        rows.append(tested)
        left.append(np.full(len(tested), np.median(material.errors_m[fold.train]), np.float32))
    every, predicted = np.concatenate(rows), np.concatenate(left)
    los = material.recordings.frame["los"].to_numpy()[every]
    scores = [
        score(material.errors_m[every[k]], predicted[k], material.links[every[k]], 0)
        for k in (~los, los)
    ]
    return [SimpleNamespace(nlos=scores[0], los=scores[1], reason=None)], []


@pytest.fixture
def _unbuilt(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.runner.transfer.execute", _median)


@pytest.mark.usefixtures("_unbuilt")
def test_every_data_set_is_tested_with_what_was_learnt_on_every_other(tmp_path: Path) -> None:
    matrix = transfer("constant", data=[A, B, FAR], out=tmp_path)
    assert matrix.rows == ("a", "b", "far", OTHERS)
    assert len(matrix.cells) == 12
    los = FAR.frame["los"].to_numpy()
    for train in (A, B):
        left = np.abs(FAR.errors_m() - np.median(train.errors_m()))[~los].mean()
        found = matrix.cell(train.source, "far").nlos
        assert found is not None
        assert found.mae_m.value == pytest.approx(left, rel=1e-4)
    both = np.median(np.concatenate([A.errors_m(), B.errors_m()]))
    left = np.abs(FAR.errors_m() - both)[los].mean()
    assert matrix.cell(OTHERS, "far").los.mae_m.value == pytest.approx(left, rel=1e-4)
    own = matrix.cell("far", "far")
    assert own.nlos.mae_m.value < 0.5 * matrix.cell("a", "far").nlos.mae_m.value
    texts = [text.get_text() for ax in draw_matrix(matrix).axes[:2] for text in ax.texts]
    assert f"{own.nlos.mae_m.value:.3f}\n({own.nlos.raw_mae_m:.3f})" in texts
    assert len(texts) == 24


def test_processes_asked_for_reach_the_fits(tmp_path: Path, monkeypatch) -> None:
    seen = []

    def noted(plan: Plan, material: Material, folder: object, watch: object, spread: Spread):
        seen.append(spread.jobs)
        return _median(plan, material)

    monkeypatch.setattr("bench.runner.transfer.execute", noted)
    transfer("constant", data=[A, B], out=tmp_path, jobs=3)
    assert seen == [3] * 4


@pytest.mark.usefixtures("_unbuilt")
def test_a_cell_that_cannot_be_had_says_why(tmp_path: Path) -> None:
    bare = Recordings(B.frame.drop(columns="cir"), source="bare")
    copy = Recordings(A.frame.assign(environment="x"), source="copy")
    matrix = transfer("mlp", data=[bare, copy], out=tmp_path)
    assert "bare has no CIR" in str(matrix.cell("bare", "copy").reason)
    assert matrix.cell("copy", "copy").reason is None
    twice = transfer("constant", data=[A, copy], out=tmp_path)
    assert "they hold the same measurements" in str(twice.cell("a", "copy").reason)
    assert twice.cell("a", "copy").nlos is None


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"data": [A]}, "takes at least two data sets; here: a"),
        ({"model": "none,constant", "data": [A, B]}, "of one model on one backend"),
        ({"data": ["roms", "rooms"]}, "did you mean 'rooms'"),
    ],
)
def test_bad_input_is_one_clear_line(tmp_path: Path, options: dict, expected: str) -> None:
    with pytest.raises(BenchError, match=expected):
        transfer(**{"model": "constant", **options}, out=tmp_path)


def test_all_that_is_here_but_untested_readers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("BENCH_DATA", raising=False)
    assert here() == ["rooms"]


def test_the_commands_print_and_draw(files: list[str], tmp_path: Path) -> None:
    out, plot = tmp_path / "out", tmp_path / "plot.png"
    told = _bench("transfer", "--model", "none", "--data", ",".join(files), "--out", out,
                  "--plot", plot)  # fmt: skip
    assert "NLoS rows: MAE left in m (before)" in told
    assert plot.stat().st_size > 10_000
    matrix = json.loads(_bench("transfer", "--model", "none", "--data", ",".join(files),
                               "--out", out, "--json"))  # fmt: skip
    assert [cell["train"] for cell in matrix["cells"]] == [files[0]] * 2 + [files[1]] * 2
    curve = tmp_path / "curve.svg"
    told = _bench("run", "--model", "none", "--backend", "fp32", "--data", files[0], "--links",
                  6, "--draws", 2, "--out", out, "--plot", curve)  # fmt: skip
    assert "Learning curve on" in told
    assert curve.exists()
    again = _bench("run", "--model", "none", "--backend", "fp32", "--data", files[0],
                   "--links", 6, "--draws", 2, "--out", out, "--json")  # fmt: skip
    printed = json.loads(again)
    assert [point["links"] for point in printed["curve"]] == [6]


def test_a_curve_is_drawn_with_its_intervals() -> None:
    found = [Interval(0.4, 0.3, 0.6), Interval(0.2, 0.15, 0.3)]
    curve = [
        CurvePoint("m", "fp32", 0, "a", "s", links, 3, one, None, 0.5, None)
        for links, one in zip((1, 6), found, strict=True)
    ]
    (panel,) = draw_curve(curve).axes
    (bars,) = panel.containers
    drawn = np.asarray(bars[0].get_xydata())
    assert drawn[:, 1] == pytest.approx([0.4, 0.2])
    ends = np.concatenate([path.vertices[:, 1] for path in bars[2][0].get_paths()])
    assert ends == pytest.approx([0.3, 0.6, 0.15, 0.3])
    assert panel.lines[-1].get_ydata() == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("run", "--plot", "x.png"), "--plot draws a learning curve; expected --links"),
        (("run", "--links", "2", "--plot", "x.jpg"), "expected a name that ends in .png"),
        (("run", "--data", "rooms", "--test", "rooms"), "--data and --test both say"),
        (("transfer", "--plot", "x.jpg"), "expected a name that ends in .png"),
    ],
)
def test_options_that_do_not_go_together(arguments, expected, monkeypatch, capsys) -> None:
    more = ("--model", "constant", "--backend", "fp32")
    monkeypatch.setattr(sys, "argv", ["bench", *arguments, *more])
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert left.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert expected in line
