"""What the picture of a table shows."""

from __future__ import annotations

import numpy as np
import pytest
from recordings_factory import make_frame

from bench.recordings import Recordings
from bench.recordings.picture import draw
from bench.recordings.picture_errors import MAX_POINTS


def _recordings(*without: str, rows: int = 240) -> Recordings:
    frame = make_frame(rows=rows, links=12).drop(columns=[c for c in without if c != "time_s"])
    frame["rx_power_dbm"] = np.linspace(-95, -80, rows)
    if "time_s" not in without:
        frame["time_s"] = np.arange(rows, dtype=float)
    return Recordings(frame, source="noise")


def _titles(recordings: Recordings) -> list[str]:
    return [ax.get_title(loc="left") for ax in draw(recordings).axes if ax.axison]


def test_errors_stand_by_distance_level_time_and_link() -> None:
    assert _titles(_recordings()) == [
        "Median CIR, band between quartiles",
        "Range error (4 rows lie outside)",
        "Error by true distance",
        "Error by receive level",
        "Error by time in the session",
        "Error by link: median and quartiles",
    ]


@pytest.mark.parametrize("column", ["time_s", "link", "cir"])
def test_what_is_not_known_has_no_panel(column: str) -> None:
    words = {"time_s": "time", "link": "link", "cir": "CIR"}
    assert len(_titles(_recordings(column))) == 5
    assert not [title for title in _titles(_recordings(column)) if words[column] in title]


def test_medians_by_level_are_those_of_the_rows() -> None:
    recordings = _recordings()
    recordings.frame["range_m"] = recordings.frame["true_range_m"] + np.where(
        recordings.frame["rx_power_dbm"] < -87.5, 0.4, 0.1
    )
    panel = next(ax for ax in draw(recordings).axes if "level" in ax.get_title(loc="left"))
    medians = [line for line in panel.lines if "median" in str(line.get_label())]
    assert len(medians) == 2
    for line in medians:
        level, middle = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        assert middle[level < -88.5] == pytest.approx(0.4)
        assert middle[level > -86.5] == pytest.approx(0.1)


def test_links_stand_in_the_order_of_their_median() -> None:
    recordings = _recordings()
    panel = next(ax for ax in draw(recordings).axes if "link" in ax.get_title(loc="left"))
    drawn = np.concatenate([np.array(line.get_xydata()) for line in panel.lines[:2]])
    errors = recordings.frame.assign(e=recordings.errors_m()).groupby("link")["e"].median()
    order = drawn[np.argsort(drawn[:, 0]), 1]
    assert order == pytest.approx(np.sort(errors.to_numpy()))


def test_large_tables_are_thinned() -> None:
    panel = draw(_recordings(rows=4 * MAX_POINTS)).axes[2]
    clouds = [line for line in panel.lines if line.get_linestyle() == "None"]
    assert max(len(np.asarray(line.get_xdata())) for line in clouds) == MAX_POINTS
