"""Any recordings table, through the commands: no traceback, counts add up, units are kept."""

from __future__ import annotations

import contextlib
import io
import json
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from recordings_factory import cells

from bench.cli.main import main
from bench.plugins import Plugin, plugins
from bench.recordings import Recordings, read_recordings, write_recordings

WIDTH = 160
QUICK = {"deadline": None, "derandomize": True, "suppress_health_check": list(HealthCheck)}
BAD = ("no number", "negative", "far", "no cir", "nan cir", "silent cir", "outside", "no link")


@dataclass(frozen=True)
class Table:
    """A frame, how many of its rows are bad, and which are good."""

    frame: pd.DataFrame
    bad: int

    @property
    def good(self) -> pd.DataFrame:
        return self.frame.iloc[self.bad :].reset_index(drop=True)


@st.composite
def tables(draw: st.DrawFn, most_bad: int = 8) -> Table:
    """Draw ranges over some links, with bad rows first, one fault each."""
    links = draw(st.integers(4, 12))
    rows = links * draw(st.integers(3, 6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    link = np.arange(rows) % links
    true_m = rng.uniform(0.5, 40, links)[link]
    cir = np.abs(rng.normal(0, 50, (rows, WIDTH)))
    cir[:, 7] += rng.uniform(3000, 9000, rows)
    frame = pd.DataFrame({"true_range_m": true_m, "cir": list(cir.astype(np.float32))})
    frame["range_m"] = true_m + rng.normal(0.1, draw(st.sampled_from([1e-3, 0.1, 3.0])), rows)
    frame["link"] = draw(st.sampled_from(["link", "λ", "[b]", "a b;c"])) + pd.Series(link).astype(
        str
    )
    frame["first_path_index"] = rng.uniform(5, 7, rows)
    if draw(st.booleans()):
        frame["los"] = link % 2 == 0
    if draw(st.booleans()):
        frame["environment"] = np.where(link < links // 2, "a", "b")
    if draw(st.booleans()):
        frame["humidity"] = rng.uniform(0, 1, rows)
    kinds = draw(st.lists(st.sampled_from(BAD), max_size=most_bad))
    for row, kind in enumerate(kinds):
        _spoil(frame, row, kind)
    return Table(frame, len(kinds))


def _spoil(frame: pd.DataFrame, row: int, kind: str) -> None:
    """Make one row unusable."""
    match kind:
        case "no number":
            frame.loc[row, "range_m"] = np.nan
        case "negative":
            frame.loc[row, "true_range_m"] = -1.0
        case "far":
            frame.loc[row, "range_m"] = 5000.0
        case "no link":
            frame.loc[row, "link"] = None
        case "outside":
            frame.loc[row, "first_path_index"] = WIDTH + 1.0
        case _:
            value = {"no cir": np.empty(0), "silent cir": np.zeros(WIDTH)}.get(kind)
            nan = np.full(WIDTH, np.nan)
            frame.at[row, "cir"] = (nan if value is None else value).astype(np.float32)


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    with tempfile.TemporaryDirectory() as made:
        yield Path(made)


def bench(*words: object) -> tuple[int, str, str]:
    """Run a command; return its exit code, standard output and error."""
    out, err = io.StringIO(), io.StringIO()
    with (
        patch.object(sys, "argv", ["bench", *map(str, words)]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as ended,
    ):
        main()
    return int(ended.value.code or 0), out.getvalue(), err.getvalue()


def written(table: Table, path: Path) -> Path:
    table.frame.to_parquet(path)
    return path


@settings(max_examples=25, **QUICK)
@given(tables(most_bad=20))
def test_import_and_info_count_every_row_and_keep_units(table: Table) -> None:
    with folder() as here:
        code, _, err = bench("data", "import", written(table, here / "r.parquet"),
                             "-o", here / "o.parquet")  # fmt: skip
        if 2 * table.bad > len(table.frame):
            assert code == 2
            assert "rows are unusable" in err
            assert not (here / "o.parquet").exists()
            return
        assert code == 0
        made = read_recordings(here / "o.parquet")
        assert len(made) == len(table.frame) - table.bad
        assert sum(made.dropped.values()) == table.bad
        for column in ("range_m", "true_range_m", "first_path_index"):
            np.testing.assert_array_equal(made.frame[column], table.good[column])
        np.testing.assert_array_equal(np.stack(made.frame["cir"]), np.stack(table.good["cir"]))
        code, out, _ = bench("data", "info", here / "o.parquet", "--json")
        found = json.loads(out)
        error_m = table.good["range_m"] - table.good["true_range_m"]
        assert code == 0
        assert (found["rows"], found["links"]) == (len(made), table.good["link"].nunique())
        assert sum(found["dropped"].values()) == table.bad
        whole = [line for line in found["errors"] if line["rows"] == len(made)]
        assert any(line["mae_m"] == pytest.approx(error_m.abs().mean()) for line in whole)
        assert set(table.frame.columns) <= set(found["columns"])


@settings(max_examples=10, **QUICK)
@given(tables(most_bad=4))
def test_importing_what_was_imported_changes_nothing(table: Table) -> None:
    with folder() as here:
        words = ("data", "import", written(table, here / "r.parquet"), "-o", here / "o.parquet")
        assert bench(*words)[0] == 0
        assert bench("data", "import", here / "o.parquet", "-o", here / "again.parquet")[0] == 0
        one, two = (read_recordings(here / name) for name in ("o.parquet", "again.parquet"))
        assert one.fingerprint == two.fingerprint
        assert one.dropped == two.dropped


@settings(max_examples=3, **QUICK)
@given(tables(most_bad=3), st.sampled_from(["none", "constant"]))
def test_run_scores_every_usable_row_once_in_metres(table: Table, model: str) -> None:
    with folder() as here, patch("bench.runner.api.time_artifacts", lambda *_, **__: ([], [])):
        words = ("run", "--model", model, "--backend", "fp32", "--split", "link-kfold:2", "--json")
        path = written(table, here / "r.parquet")
        code, out, err = bench(*words, "--data", path, "--out", here / "out", "--device", "host")
        assert code == 0, err
        [run] = json.loads(out)["runs"]
        scores = [score for score in (run["nlos"], run["los"]) if score]
        rows = len(table.frame) - table.bad
        assert sum(score["rows"] for score in scores) == rows
        error_m = (table.good["range_m"] - table.good["true_range_m"]).astype(np.float32)
        raw = sum(score["rows"] * score["raw_mae_m"] for score in scores) / rows
        assert raw == pytest.approx(error_m.abs().mean(), rel=1e-5)
        if model == "none":
            mae = sum(score["rows"] * score["mae_m"]["value"] for score in scores) / rows
            assert mae == pytest.approx(raw)
        predicted = pd.read_parquet(next((here / "out" / "predictions").iterdir()))
        assert sorted(predicted["row"]) == list(range(rows))


@settings(max_examples=4, **QUICK)
@given(st.integers(1, 40), st.integers(0, 2**31))
def test_simulate_gives_the_rows_asked_for_marked_and_repeatable(rows: int, seed: int) -> None:
    with folder() as here:
        words = ("simulate", "rooms", "--rooms", "-n", rows, "--seed", seed, "--json")
        for name in ("a", "b"):
            code, out, err = bench(*words, "-o", here / f"{name}.parquet")
            assert code == 0, err
        facts = json.loads(out)
        one, two = (read_recordings(here / f"{name}.parquet") for name in "ab")
        assert (facts["rows"], facts["seed"], facts["simulated"]) == (rows, seed, True)
        assert len(one) == rows
        assert one.simulated
        assert one.fingerprint == two.fingerprint
        difference = one.frame["range_m"] - one.frame["true_range_m"]
        np.testing.assert_allclose(one.errors_m(), difference, atol=1e-9)
        assert facts["mae_m"] == pytest.approx(difference.abs().mean(), rel=1e-6)


@settings(max_examples=2, **QUICK)
@given(tables(most_bad=2))
def test_simulate_keeps_every_usable_row_of_a_geometry(table: Table) -> None:
    with folder() as here:
        write_recordings(Recordings(table.good.assign(cir=cells(np.stack(table.good["cir"]))), "g"),
                         here / "g.parquet")  # fmt: skip
        simulator = here / "s.toml"
        simulator.write_text('[[effects]]\neffect = "antenna-delay"\ndelay_ns = 1.0\n')
        code, _, err = bench("simulate", simulator, "--geometry", here / "g.parquet",
                             "-o", here / "o.parquet")  # fmt: skip
        assert code == 0, err
        made = read_recordings(here / "o.parquet")
        np.testing.assert_allclose(made.frame["true_range_m"], table.good["true_range_m"])
        assert made.frame["link"].tolist() == table.good["link"].tolist()


@settings(max_examples=2, **QUICK)
@given(st.integers(0, 1000), st.sampled_from([0.0, 8.0]))
def test_diagnose_of_any_drift_ends_in_json(seed: int, slope_mm: float) -> None:
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(16), 6)
    frame = pd.DataFrame({"link": [f"l{k}" for k in link]})
    frame["true_range_m"] = np.linspace(2, 20, 16)[link]
    frame["temperature_c"] = rng.uniform(0, 50, 16)[link]
    scatter_m = rng.normal(0, 0.03, len(link))
    frame["range_m"] = frame["true_range_m"] + slope_mm / 1e3 * frame["temperature_c"] + scatter_m
    drift = [one for one in plugins("effects") if one.name == "temperature-drift"]
    with folder() as here, _effects(drift):
        write_recordings(Recordings(frame, "made up"), here / "r.parquet")
        code, out, err = bench("diagnose", "--recorded", here / "r.parquet", "--paths-only",
                               "--observe", "error_m", "--json")  # fmt: skip
    assert code == 0, err
    assert json.loads(out)
    assert "Traceback" not in err


def _effects(known: list[Plugin]) -> contextlib.AbstractContextManager[object]:
    return patch("bench.discrepancy.select.candidates.plugins", lambda group: known)


@pytest.mark.parametrize("rows", [0, -1, 10**10, 10**400])
def test_simulate_refuses_more_rows_than_any_disk_holds(rows: int, tmp_path: Path) -> None:
    words = ("simulate", "rooms", "--rooms", f"-n{rows}", "-o", tmp_path / "s.parquet")
    code, _, err = bench(*words)
    assert code == 2
    assert "expected 1 to 1000000000 rows" in err
    assert not (tmp_path / "s.parquet").exists()
