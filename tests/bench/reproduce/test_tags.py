"""Tags from recorded ranges: exact on exact ranges, honest about poor geometry."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.reproduce.experiments.positioning_recorded import _hall_2020, _map, _table
from bench.reproduce.fixed_tag import ANCHORS_M, TAG_M, fixed_tag
from bench.reproduce.tags import SOLVERS, Tag, tags_of


def ranges_frame(
    tag: list[float], anchors: list[list[float]], rows: int = 20, noise_m: float = 0.0
) -> pd.DataFrame:
    rng = np.random.default_rng(0)
    parts = []
    for number, anchor in enumerate(anchors):
        true = float(np.linalg.norm(np.subtract(tag, anchor)))
        frame = pd.DataFrame({"range_m": true + rng.normal(0, noise_m, rows)})
        for axis, name in enumerate("xyz"[: len(tag)]):
            frame[f"tx_{name}_m"], frame[f"rx_{name}_m"] = tag[axis], anchor[axis]
        parts.append(frame.assign(link=f"anchor {number} - tag 7"))
    return pd.concat(parts, ignore_index=True)


def only_tag(frame: pd.DataFrame, dimensions: int = 2) -> Tag:
    (tag,) = tags_of(frame, {"raw": "range_m"}, dimensions, 10)
    return tag


@pytest.mark.parametrize("solver", SOLVERS)
def test_exact_ranges_give_the_exact_position(solver: str) -> None:
    tag = only_tag(ranges_frame([2.0, 1.0], [[0, 0], [5, 0], [0, 4]]))
    fixes, away, converged = tag.fixes("raw", solver)
    assert tag.name == "tag 7"
    assert fixes.shape == (10, 2)
    assert away.max() < 1e-6
    assert converged.all()
    assert np.abs(tag.range_errors_m("raw")).max() < 1e-12


@pytest.mark.parametrize(
    ("anchors", "reason"),
    [
        ([[0, 0], [5, 0]], "2 anchors: a 2-D position needs at least 3"),
        ([[0, 0], [2, 0], [5, 0]], "on one line"),
        ([[0, 0]], "1 anchors"),
    ],
)
def test_geometry_that_fixes_nothing_is_reported_and_not_averaged(
    anchors: list[list[float]], reason: str
) -> None:
    bad = only_tag(ranges_frame([2.0, 1.0], anchors))
    good = only_tag(ranges_frame([2.0, 1.0], [[0, 0], [5, 0], [0, 4]], noise_m=0.05))
    table = _table("made", [bad, good], [])
    assert reason in str(bad.refusal())
    assert reason in table.notes[-1]
    assert bad.name in table.notes[-1]
    figures = {(row.label[0], row.quantity) for row in table.rows if row.label[0] == bad.name}
    assert (bad.name, "dilution of precision") in figures
    summary = [row for row in table.rows if row.label[0].startswith("median of 1 tags")]
    assert [row.quantity for row in summary] == [
        "range MAE", "position MAE, Gauss-Newton", "position MAE, robust"
    ]  # fmt: skip


def test_anchors_nearly_in_line_keep_their_own_row_only() -> None:
    poor = only_tag(ranges_frame([2.0, 0.1], [[0, 0], [2.5, 0.02], [5, 0]], noise_m=0.02))
    assert poor.refusal() is None
    assert poor.dop > 3
    table = _table("made", [poor], [])
    assert "Poor geometry" in table.notes[-1]
    assert not any(row.label[0].startswith("median") for row in table.rows)
    assert any(row.quantity == "position MAE, robust" for row in table.rows)


def test_the_campaign_without_positions_says_why() -> None:
    pairs = [("1", "3"), ("1", "4"), ("2", "3"), ("2", "4"), ("3", "1")]
    reason = _hall_2020(pd.DataFrame(pairs, columns=["tx", "rx"]))
    assert "none of its 4 nodes" in reason
    assert "more than 2 others" in reason


def test_the_fixed_tag_is_seen_by_four_anchors_and_repeats() -> None:
    scene = fixed_tag(False, 3, 4, seed=5)
    frame = scene.frame
    assert scene.simulated
    assert len(frame) == 3 * 4 * 4
    assert frame["link"].nunique() == 12
    assert frame["anchor"].tolist() == [0, 1, 2, 3] * 12
    true = np.linalg.norm(ANCHORS_M - TAG_M, axis=1)
    np.testing.assert_allclose(frame["true_range_m"], np.tile(true, 12))
    np.testing.assert_array_equal(frame["range_m"], fixed_tag(False, 3, 4, seed=5).frame["range_m"])
    assert (frame["obstacles"].map(len) == 1).all()
    clear = fixed_tag(True, 3, 4, seed=5)
    assert np.abs(clear.errors_m()).mean() < np.abs(scene.errors_m()).mean()


def test_the_map_shows_tags_fixes_and_anchors_of_those_with_a_position() -> None:
    anchors = [[0, 0], [5, 0], [0, 4]]
    good = only_tag(ranges_frame([2.0, 1.0], anchors))
    bad = only_tag(ranges_frame([2.0, 1.0], anchors[:2]))
    drawn = _map("made", "Made", [good, bad])
    assert drawn is not None
    where = {series.name: (series.x, series.y) for series in drawn.series}
    assert where["where the tags are"] == where["median fix, raw"] == ([2.0], [1.0])
    assert len(where["anchors"][0]) == 3
    assert where["a tag and its fixes"][0][:2] == [2.0, 2.0]
    assert _map("made", "Made", [bad]) is None


@pytest.mark.real
def test_the_industrial_hall_is_positioned(real_data: object, tmp_path: object) -> None:
    from pathlib import Path

    from bench.reproduce.context import Context
    from bench.reproduce.experiments.positioning_recorded import _hall

    found = list(_hall(Context("ghent", Path(str(tmp_path)), quick=True)))
    tables = [one.table for one in found if one.table]
    assert len(tables) == 2
    medians = [row for row in tables[0].rows if row.label[0].startswith("median")]
    robust = next(row for row in medians if row.quantity == "position MAE, robust")
    assert 0.1 < robust.ours.value < 0.6  # type: ignore[union-attr]
    assert [one.figure.data for one in found if one.figure] == ["real ranges"] * 2
    assert "IIoT_20 gives no position" in found[-1].note
