"""Experiments end to end on a small data set of the published form, and bad input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench.cli.reproduce import command
from bench.errors import BenchError
from bench.parallel import Spread
from bench.plugins import find
from bench.recordings.table import Recordings
from bench.reproduce.build import over_links
from bench.reproduce.catalogue import chosen, experiments
from bench.reproduce.context import Context
from bench.reproduce.experiments import latency_vs_accuracy, optimisation
from bench.reproduce.thinning import thinned


def call(*arguments: str) -> str:
    result = CliRunner().invoke(command, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def files(folder: Path) -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def _few_models(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the experiments on all models take few: tests of the backends go through them all."""
    few = ("none", "mlp", "remnet")
    assert "mlp" in optimisation.MODELS.split(",")
    monkeypatch.setattr(optimisation, "MODELS", "mlp")
    monkeypatch.setattr(
        latency_vs_accuracy, "plugins", lambda group: [find(group, name) for name in few]
    )


@pytest.mark.slow
@pytest.mark.usefixtures("_few_models")
def test_every_experiment_runs_on_the_published_form(deepuwb: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    ask = ("all", "--data", "deepuwb", "--quick", "--out", str(out))
    content = json.loads(call(*ask, "--json"))
    assert content["impossible"] == []
    done = {one["experiment"]: one for one in content["outcomes"]}
    assert list(done) == [one.name for one in experiments()]
    folder = out / "reproduction" / "deepuwb-quick"
    page = (folder / "reproduce.md").read_text(encoding="utf-8")
    for name, one in done.items():
        assert one["quick"]
        assert not one["simulated"]
        assert one["tables"]
        assert (folder / f"{name}.md").is_file()
        for figure in one["figures"]:
            picture = f"figures/{name}-{figure['name']}"
            assert f"]({picture}.svg)" in page
            assert (folder / f"{picture}.svg").read_text().startswith("<?xml")
            assert (folder / f"{picture}.png").read_bytes().startswith(b"\x89PNG")
    assert "deepuwb (QUICK)" in page
    assert not (out / "runs").exists(), "a leaderboard must never show quick runs"
    kept = {path: when for path, when in files(folder).items() if path.suffix == ".json"}
    assert json.loads(call(*ask, "--json")) == content
    assert {path: path.stat().st_mtime_ns for path in kept} == kept


def test_pca_stands_alone(deepuwb: Path, tmp_path: Path) -> None:
    printed = call("pca", "--data", "deepuwb", "--out", str(tmp_path / "out"))
    assert "Variance explained" in printed
    folder = tmp_path / "out" / "reproduction" / "deepuwb"
    (one,) = [json.loads(path.read_text()) for path in folder.glob("*.json")]
    shares = [row["ours"] for row in one["tables"][0]["rows"]]
    assert shares[0] > shares[1] >= shares[2] > 0
    assert shares[3] == pytest.approx(sum(shares[:3]))
    materials = next(figure for figure in one["figures"] if figure["name"] == "materials")
    assert {series["name"] for series in materials["series"]} == {
        *("metal plate", "plastic", "wood door", "glass plate")
    }


def test_a_page_stands_alone_with_its_pictures(deepuwb: Path, tmp_path: Path) -> None:
    page = tmp_path / "docs" / "reproduce.md"
    call("pca", "--data", "deepuwb", "--out", str(tmp_path / "out"), "--page", str(page))
    text = page.read_text(encoding="utf-8")
    assert "Recordings: deepuwb." in text
    assert "Source: commit" in text
    assert "Measured time:" in text
    assert "Not on this page: optimisation, rooms," in text
    pictures = sorted(path.name for path in (tmp_path / "docs" / "reproduce").iterdir())
    assert pictures == ["pca-materials.png", "pca-rooms.png"]
    assert all(f"](reproduce/{name})" in text for name in pictures)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("optimization",), "did you mean 'optimisation'"),
        ((",",), "no experiment named"),
        (("pca", "--data", "room"), "did you mean 'rooms'"),
        (("pca", "--data", "absent.parquet"), "absent.parquet"),
        (("pca", "--data", "deepuwb", "--split", "by-row"), "by-row"),
        (("rooms", "--data", "deepuwb", "--split", "link-kfold:9999"), "9999"),
        (("latency-vs-accuracy", "--device", "cortex"), "unknown device 'cortex'"),
        (("pca", "--page", "page.html"), "ends in .md"),
        (("pca", "--jobs", "0"), "at least 1"),
        (("pca", "--jobs", "2", "--scheduler", "tcp://127.0.0.1:1"), "expected one of them"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    arguments: tuple[str, ...], message: str, deepuwb: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    with pytest.raises(BenchError, match=message) as caught:
        call(*arguments, "--out", str(out))
    assert "\n" not in str(caught.value)
    assert not out.exists()


def test_a_damaged_outcome_is_made_again(deepuwb: Path, tmp_path: Path) -> None:
    ask = ("pca", "--data", "deepuwb", "--out", str(tmp_path / "out"))
    call(*ask)
    path = tmp_path / "out" / "reproduction" / "deepuwb" / "pca.json"
    whole = json.loads(path.read_text())
    path.write_text("{")
    call(*ask)
    again = json.loads(path.read_text())
    assert again["tables"] == whole["tables"]
    assert again["figures"] == whole["figures"]
    path.write_text(json.dumps({**again, "key": "of other code", "longest_s": 1e6}))
    call(*ask)
    last = json.loads(path.read_text())
    assert last["longest_s"] == 1e6, "the time of the making that trained is kept"
    assert last["elapsed_s"] < 1e6


def test_fits_of_experiments_are_spread_as_asked(deepuwb: Path, tmp_path, monkeypatch) -> None:
    seen = []

    def noted(plan, material, folder, watch, spread):
        seen.append(spread)
        return [], []

    monkeypatch.setattr("bench.reproduce.context.execute", noted)
    context = Context("deepuwb", tmp_path, spread=Spread(2))
    context.runs("none", "fp32")
    context.tried("none", "fp32")
    assert seen == [Spread(2)] * 2


def test_list_names_every_experiment() -> None:
    assert [line.split()[0] for line in call("--list").splitlines()] == [
        one.name for one in experiments()
    ]
    assert list(json.loads(call("--list", "--json"))) == [one.name for one in experiments()]


def test_names_come_once_and_in_the_order_asked() -> None:
    assert [one.name for one in chosen("rooms, pca,rooms")] == ["rooms", "pca"]


def test_thinning_keeps_whole_links_and_the_mixture() -> None:
    import pandas as pd

    link = np.repeat(np.arange(400), 10)
    frame = pd.DataFrame(
        {
            "link": link.astype(str),
            "environment": np.where(link < 300, "a", "b"),
            "los": link % 4 == 0,
            "error_m": np.arange(len(link), dtype=float),
        }
    )
    few = thinned(Recordings(frame, source="made"), rows=1000)
    assert 900 <= len(few) <= 1000
    assert (few.frame.groupby("link").size() == 10).all()
    assert few.frame["environment"].eq("a").mean() == pytest.approx(0.75, abs=0.03)
    assert few.fingerprint == thinned(Recordings(frame, source="made"), rows=1000).fingerprint


def test_the_interval_is_over_links_not_rows() -> None:
    rng = np.random.default_rng(0)
    level = np.repeat(rng.normal(0, 1, 40), 50)
    figure = over_links(lambda v: float(v.mean()), level, np.repeat(np.arange(40), 50))
    assert figure.low is not None
    assert figure.high is not None
    width = figure.high - figure.low
    assert 0.4 < width < 0.9  # 2 x 1.96 / sqrt(40) = 0.62; by rows it would be 0.09
