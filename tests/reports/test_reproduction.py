from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import msgspec
import pytest

from bench.provenance import sealed
from reports.errors import ReportError
from reports.markdown import to_markdown
from reports.reproduction import (
    full_page,
    index_page,
    outcome_page,
    pictures,
    read_outcome,
    read_outcomes,
)
from reports.reproduction.load import FigureFile, OutcomeFile
from reports.reproduction.worse import worse


def row(**changes: Any) -> dict[str, Any]:
    made = {"label": ["remnet"], "quantity": "MAE", "unit": "m", "paper": 0.0687, "note": ""}
    return {**made, "ours": {"value": 0.0701, "low": 0.065, "high": 0.075}, **changes}


def series(**changes: Any) -> dict[str, Any]:
    made = {"name": "ours", "x": [1, 2], "y": [0.1, None], "z": None, "low": None, "high": None}
    return {**made, "style": "", **changes}


def figure(kind: str = "lines", **changes: Any) -> dict[str, Any]:
    made: dict[str, Any] = {name: f"{name} (m)" for name in ("x_label", "y_label", "z_label")}
    made |= dict.fromkeys(("log_x", "log_y", "equal_axes"), False)
    return {**made, "name": kind, "title": "A", "kind": kind, "series": [series()], **changes}


def outcome(**changes: Any) -> dict[str, Any]:
    table = {"title": "T", "labels": ["model"], "rows": [row()], "digits": 4, "notes": ["a note"]}
    made: dict[str, Any] = {"experiment": "optimisation", "title": "Optimisation", "data": "rooms"}
    made |= {"data_fingerprint": "ab", "simulated": True, "quick": False, "protocol": "As said."}
    made |= {"tables": [table], "figures": [figure()], "notes": [], "elapsed_s": 3.0}
    made |= {"host": {"cpu": "Example", "cores": 2}, "created_utc": "2026-01-01T00:00:00+00:00"}
    return {**made, "schema_version": 1, "kind": "reproduction", **changes}


def dumped(content: dict[str, Any]) -> str:
    """Return the text of an outcome's file, with the hash of its content."""
    return json.dumps(sealed(content))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "optimisation.json").write_text(dumped(outcome()))
    return tmp_path


def page(folder: Path, **changes: Any) -> str:
    path = folder / "optimisation.json"
    path.write_text(dumped(outcome(**changes)))
    return to_markdown(outcome_page(read_outcome(path)))


def test_ours_the_papers_and_the_difference_stand_below_each_other(folder: Path) -> None:
    lines = page(folder).splitlines()
    start = lines.index("| model |  | MAE (m) |")
    assert lines[start + 2 : start + 5] == [
        "| remnet | ours | 0.0701<br>[0.0650, 0.0750] |",
        "|  | paper | 0.0687 |",
        "|  | diff. | +0.0014 |",
    ]


def test_without_a_figure_of_the_papers_there_is_no_line_for_it(folder: Path) -> None:
    table = outcome()["tables"][0] | {"rows": [row(paper=None, ours=3)]}
    text = page(folder, tables=[table])
    assert "| remnet | 3 |" in text
    assert "paper |" not in text


def test_what_is_not_finite_or_unknown_is_no_number(folder: Path) -> None:
    nothing = {"value": None, "low": None, "high": None}
    rows = [row(ours=nothing), row(label=["mlp"], ours=None), row(label=["svm"], ours="none")]
    text = page(folder, tables=[outcome()["tables"][0] | {"rows": rows}])
    assert "| remnet | ours | n/a |" in text
    assert "| mlp | ours | – |" in text
    assert "| svm | ours | none |" in text


def test_simulated_and_quick_are_said_on_the_page_and_the_picture(folder: Path) -> None:
    assert "Recordings: rooms (SIMULATED, QUICK)." in page(folder, quick=True)
    for name, save in pictures(read_outcome(folder / "optimisation.json")):
        path = folder / Path(name).name
        save(path)
        if path.suffix == ".svg":
            assert "rooms (SIMULATED, QUICK)" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("kind", "changes"),
    [
        ("lines", {"low": [0.05, None], "high": [0.2, None]}),
        ("scatter", {"style": "marker"}),
        ("scatter", {"style": "dashed"}),
        ("histogram", {}),
        ("bars", {"x": ["big", "small"], "low": [0.05, 0.1], "high": [0.2, 0.3]}),
        ("bars", {"x": ["big", "small"], "style": "dashed"}),
        ("scatter3d", {"z": [1.0, 2.0]}),
        ("tradeoff", {"style": "hollow", "colour": "a53", "marker": "int8", "x_low": [0.5, 1]}),
        ("tradeoff", {"style": "step"}),
        ("tradeoff", {"style": "dashed"}),
    ],
)
def test_every_kind_of_picture_is_drawn_twice(
    kind: str, changes: dict[str, Any], folder: Path
) -> None:
    path = folder / "optimisation.json"
    made = figure(kind, series=[series(z=[0.0, 1.0]), series(**changes)], log_y=True)
    path.write_text(dumped(outcome(figures=[made])))
    drawn = dict(pictures(read_outcome(path)))
    assert list(drawn) == [f"figures/optimisation-{kind}{end}" for end in (".svg", ".png")]
    for name, save in drawn.items():
        save(folder / Path(name).name)
    assert (folder / f"optimisation-{kind}.png").read_bytes().startswith(b"\x89PNG")


def test_a_trade_off_lists_looks_and_lines_once() -> None:
    from reports.reproduction.draw import draw

    spots = [
        series(name="x", colour=colour, marker=marker, x_low=[0.5, 1.5], x_high=[2, 3])
        for colour in ("a53", "tpu")
        for marker in ("fp32", "int8")
    ]
    made = figure("tradeoff", series=[*spots, series(name="front", style="step")], log_x=True)
    (axes,) = draw(msgspec.convert(made, FigureFile), "rooms (SIMULATED)").axes
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert names == ["a53", "tpu", "fp32", "int8", "front"]
    assert axes.get_title() == "A\nrooms (SIMULATED)"


def test_digits_of_a_row_override_the_tables(folder: Path) -> None:
    table = outcome()["tables"][0] | {"rows": [row(ours=1234.56, paper=None, digits=1)]}
    assert "| remnet | 1,234.6 |" in page(folder, tables=[table])


def test_the_index_holds_every_outcome_and_what_was_not_possible(folder: Path) -> None:
    (folder / "rooms.json").write_text(dumped(outcome(experiment="rooms", title="Rooms")))
    text = to_markdown(index_page(read_outcomes(folder), [("pca", "no CIR")]))
    assert "## Optimisation" in text
    assert "## Rooms" in text
    assert "](figures/rooms-lines.svg)" in text
    assert "- pca: no CIR" in text


def full(*changes: dict[str, Any]) -> str:
    outcomes = [msgspec.convert(outcome(**one), OutcomeFile) for one in changes]
    return to_markdown(full_page(outcomes, [("pca", "no CIR")], ["Source: commit abc"], "pics"))


def test_the_full_page_says_what_it_rests_on() -> None:
    again = {"elapsed_s": 3, "longest_s": 3000}
    text = full({"elapsed_s": 60.4}, {"experiment": "rooms", "title": "Rooms", **again})
    assert "Recordings: rooms (SIMULATED)." in text
    assert "- Source: commit abc" in text
    assert "3,060 s (51 min) in all; in seconds: optimisation 60, rooms 3,000." in text
    assert text.count("- Machine: Example (2 cores).") == 1
    assert "](pics/rooms-lines.png)" in text
    assert "- pca: no CIR" in text


def worse_lines(*rows: dict[str, Any]) -> list[str]:
    table = outcome()["tables"][0] | {"rows": list(rows)}
    return worse([msgspec.convert(outcome(tables=[table]), OutcomeFile)])


def test_a_picture_of_other_data_says_so(folder: Path) -> None:
    assert "![A, real ranges](" in page(folder, figures=[figure(data="real ranges")])


def test_where_we_are_worse_stands_first() -> None:
    assert worse_lines(row()) == [
        "optimisation: remnet, MAE: 0.0701 m, the paper 0.0687 m (inside our interval)"
    ]
    assert "(outside our interval)" in worse_lines(row(paper=0.01))[0]
    assert worse_lines(row(quantity="R²", unit="", ours=0.5, paper=0.56)) == [
        "optimisation: remnet, R²: 0.5000, the paper 0.5600"
    ]
    text = full({})
    assert text.index("## Where we do worse than the paper") < text.index("## Optimisation")


def test_what_describes_the_data_says_so_and_no_label_is_known_by_name() -> None:
    assert len(worse_lines(row(label=["none"]))) == 1
    assert worse_lines(row(label=["none"], of_data=True)) == []


def test_what_is_better_or_no_merit_is_not_called_worse() -> None:
    rows = [
        row(paper=0.08),
        row(label=["REMnet before"], of_data=True),
        row(quantity="NLoS rows", ours=10, paper=5),
        row(quantity="R²", ours=0.7, paper=0.5),
        row(ours="yes"),
        row(paper=None),
    ]
    assert worse_lines(*rows) == []
    assert "Where we do worse" not in full({"tables": []})


@pytest.mark.parametrize(
    "content",
    [
        "{",
        "[]",
        dumped(outcome(kind="run")),
        dumped(outcome(schema_version=2)),
        dumped(outcome(tables=[{"title": "x"}])),
        dumped(outcome(figures=[figure(name="../../evil")])),
        dumped(outcome(experiment="../up")),
        dumped(outcome(figures=[figure(kind="pie")])),
        dumped(outcome(figures=[figure(series=[series(x=[1])])])),
        dumped(outcome(figures=[figure(series=[series(x=["a", "b"])])])),
        dumped(outcome(figures=[figure("scatter3d")])),
    ],
)
def test_what_is_no_outcome_is_refused_in_one_line(content: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text(content)
    with pytest.raises(ReportError, match=r"bad\.json") as caught:
        read_outcome(path)
    assert "\n" not in str(caught.value)
