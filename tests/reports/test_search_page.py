"""What the page of a search says of its finalists."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from reports.believe import digest
from reports.errors import ReportError
from reports.markdown import to_markdown
from reports.search import (
    Cycles,
    Final,
    Judged,
    SearchFile,
    Tried,
    meets,
    minus_reference,
    read_search,
    search_page,
    search_picture,
)

LINKS = tuple(range(30))


def judged(mae_m: float, wobble: float = 0.0) -> Judged:
    """Thirty links of ten rows; every other link `wobble` better or worse."""
    sums = tuple(10 * (mae_m + wobble * (-1) ** link) for link in LINKS)
    return Judged(mae_m, LINKS, sums, (10,) * 30)


def final(cycles: float, flash: int, nlos: Judged, los: Judged | None = None) -> Final:
    return Final(Cycles(cycles, cycles, cycles), flash, 1000, 4, 4, nlos, los)


FOUND = SearchFile(
    "search", 1, "rooms", "f", True, "link-kfold:5", "0",
    {"device": "nrf52832", "candidates": 3, "seed": 0, "levels": 1, "epochs": 3,
     "final_epochs": 3, "calibrate": 4},
    {"filters": (4, 8)}, 0.1, 0.05,
    (Tried("small", 3, 0.05, 1000, 9e4, 6000.0, True),),
    {
        "remnet": final(1e6, 13_000, judged(0.060)),
        "small": final(2e5, 6_000, judged(0.061)),
        "big": final(9e5, 6_000, judged(0.058)),
        "unsure": final(2e5, 6_000, judged(0.061, 0.004)),
        "poor": final(2e5, 6_000, judged(0.059), judged(0.2)),
    },
    {"odd": "sums too large"}, "abc", "now",
)  # fmt: skip


def test_differences_are_paired_by_link() -> None:
    gap = minus_reference(FOUND, "unsure", "nlos")
    assert gap is not None
    assert gap.high is not None
    assert gap.value == pytest.approx(0.001)
    assert 0.001 < gap.high < 0.004
    assert minus_reference(FOUND, "small", "los") is None


def test_the_bar_needs_all_three() -> None:
    assert meets(FOUND, "small")
    assert not meets(FOUND, "big")  # cycles
    assert not meets(FOUND, "unsure")  # the interval's upper end
    heavy = replace(FOUND.finals["small"], flash_bytes=7_000)
    assert not meets(replace(FOUND, finals={**FOUND.finals, "small": heavy}), "small")


def test_lines_of_sight_count_too() -> None:
    finals = {**FOUND.finals, "remnet": replace(FOUND.finals["remnet"], los=judged(0.05))}
    assert not meets(replace(FOUND, finals=finals), "poor")
    assert meets(FOUND, "poor")  # nothing to compare with there


def test_the_page_names_the_best_and_the_bar() -> None:
    text = to_markdown(search_page(FOUND, "front.png"))
    assert "met by small, poor." in text
    assert "no more than REMnet's own cycles: big." in text
    assert "rooms (SIMULATED)" in text
    assert "odd has no 8-bit C: sums too large." in text
    assert "![MAE against counted cycles](front.png)" in text
    missed = replace(FOUND, finals={name: FOUND.finals[name] for name in ("remnet", "big")})
    assert "missed by every network" in to_markdown(search_page(missed, None))
    assert len(search_picture(FOUND).axes) == 1


def test_a_file_that_is_no_search_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "search.json"
    with pytest.raises(ReportError, match="cannot be read as a search"):
        read_search(path)
    content = {"kind": "search", "schema_version": 1}
    path.write_text(json.dumps({**content, "content_sha256": digest(content)}))
    with pytest.raises(ReportError, match="missing required field"):
        read_search(path)
