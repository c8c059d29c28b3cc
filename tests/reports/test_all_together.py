"""All data sets at once: shares of the baseline's MAE, each data set counting alike."""

from __future__ import annotations

import numpy as np
import pytest

from reports.errors import ReportError
from reports.ranking.paired import Interval, Paired
from reports.together import Line, relative, section
from reports.together_picture import draw


def _pair(first, second, rows=1.0) -> Paired:
    sums = np.array([first, second], float)
    return Paired(("first", "second"), sums, np.full(sums.shape[1], rows))


def test_each_data_set_counts_alike_whatever_its_errors_and_links() -> None:
    small = _pair([0.11, 0.22, 0.33], [0.1, 0.2, 0.3])  # 10 % worse
    large = _pair(np.full(50, 7.0), np.full(50, 10.0), rows=9.0)  # 30 % better
    assert relative([small, large]).value == pytest.approx(-0.1)


def test_the_same_share_on_every_link_leaves_no_doubt() -> None:
    found = relative([_pair([0.9, 1.8], [1.0, 2.0]), _pair([2.7, 0.9, 9.0], [3.0, 1.0, 10.0])])
    assert found.low == pytest.approx(-0.1)
    assert found.high == pytest.approx(-0.1)


def test_one_link_alone_gives_no_interval() -> None:
    found = relative([_pair([0.9], [1.0]), _pair([0.9, 1.8], [1.0, 2.0])])
    assert (found.low, found.high) == (None, None)


def test_the_interval_holds_the_truth_nineteen_times_in_twenty() -> None:
    rng, held = np.random.default_rng(0), 0
    for trial in range(150):
        pairs = []
        for links, worse in ((60, 1.0), (80, 1.1)):
            base = rng.gamma(4.0, 0.05, links)
            pairs.append(_pair(base * worse + rng.normal(0, 0.02, links), base))
        found = relative(pairs, seed=trial)
        assert found.low is not None
        assert found.high is not None
        held += found.low <= 0.05 <= found.high
    assert 0.88 <= held / 150 <= 1.0


LINES = [
    Line("good", {"real, NLoS": Interval(-0.1, -0.15, -0.05), "all together, NLoS": None}),
    Line("bad", {"real, NLoS": Interval(0.2), "all together, NLoS": Interval(0.1, -0.1, 0.3)}),
]


def test_the_table_and_the_picture_say_the_same() -> None:
    table = section(LINES, "remnet")[1]
    assert [cell.text for cell in table.rows[0]][:2] == ["good", "-10.0"]
    assert table.rows[1][2].details == ("[-10.0, +30.0]",)
    (axes,) = draw(LINES, "remnet").axes
    points = [container.lines[0].get_xdata().tolist() for container in axes.containers]
    assert points == [[pytest.approx(-10)], [pytest.approx(20), pytest.approx(10)]]
    assert [label.get_text() for label in axes.get_yticklabels()] == list(LINES[0].found)


def test_of_one_data_set_there_is_nothing_to_draw() -> None:
    assert section([], "remnet") == []
    with pytest.raises(ReportError, match="at least two data sets"):
        draw([], "remnet")
