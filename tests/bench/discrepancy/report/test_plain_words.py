"""The first lines of a report contradict nothing, and say nothing twice."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.confirm import Confirmed
from bench.discrepancy.headline import headline
from bench.discrepancy.law.found import LawConstant
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.report.found_lines import _explained, _once
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.verdict import Ambiguous, Control, LeftOut, Unknown
from bench.physics.effect import Effect
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

GAIN, ALIKE, MISS = Estimate(0.1, 0.05, 0.2), Estimate(0.0, -0.1, 0.1), Estimate(0.0364, 0, 1)
SEEN = SimpleNamespace(
    serves=True, gain=GAIN, nearer_m=ALIKE, better="the scatter of ranges", easier="",
    mae_before_m=MISS, mae_after_m=MISS, median_before_m=MISS, median_after_m=MISS,
)  # fmt: skip


def named(effect: Effect) -> LeftOut:
    return LeftOut(effect, (), GAIN, 1.0, Control("", None))


def test_the_first_line_says_what_the_table_has_and_has_not_and_what_improved() -> None:
    both = named(RangeRounding()), named(TimestampJitter())
    line = headline(
        both, True, SEEN, "", {"range-rounding": "was not added: worse"}, "The table with it"
    )  # type: ignore[arg-type]
    assert (
        "The table with timestamp-jitter, but not range-rounding, fits better in the scatter"
        in line
    )
    assert (
        "ranges as far off as before, within chance: mean |recorded - simulated| 0.0364 m before "
        "and after" in line
    )


@pytest.mark.parametrize(("aucs", "links", "said"), [
    ((0.58, 0.98), 12, "told from simulated ones more easily (AUC 0.58 -> 0.98)"),
    ((0.31, 0.6), 12, ""), ((0.58, 0.98), 4, ""), ((0.9, 0.95), 12, ""),
])  # fmt: skip
def test_an_after_whose_rows_are_told_more_easily_is_not_silent(
    aucs: tuple[float, float], links: int, said: str
) -> None:
    """A better score of single observables may hide that they no longer go together."""
    seen = SimpleNamespace(auc_before=aucs[0], auc_after=aucs[1], links=links)
    easier = Confirmed.easier.fget(seen)  # type: ignore[attr-defined]
    assert said in easier
    assert bool(easier) == bool(said)
    both = SimpleNamespace(**{**vars(SEEN), "easier": easier})
    line = headline((named(RangeRounding()),), True, both, "", {}, "The table with it")  # type: ignore[arg-type]
    assert said in line


def test_what_is_withheld_whole_leaves_what_has_no_name() -> None:
    why = {"range-rounding": "was not added: worse"}
    line = headline((named(RangeRounding()),), True, SEEN, "", why, "The table with it")  # type: ignore[arg-type]
    assert "The table with what has no name, but not range-rounding, fits better" in line


@pytest.mark.parametrize(("left", "said"), [(1.22, "like none of the known"), (0.2, "by 20% of")])
def test_what_leaves_as_much_as_it_changes_is_no_likeness(left: float, said: str) -> None:
    words = Adequacy(False, left, 11.1, "the mean of error_m in all rows").against("range-scale")
    assert said in words
    assert "122%" not in words
    assert ("looks most like range-scale" in words) is (left < 1)


def test_differences_are_listed_under_one_heading_alone() -> None:
    first, again = ["Something:", "- a", "- b"], ["Something more:", "- a", "- b"]
    listed = "It is seen in differences that are listed above, too."
    assert _once([first, again]) == [first, ["Something more:", listed]]


def test_what_a_law_explains_is_said_once() -> None:
    """Two searches saw the same places, a little otherwise: a sentence and a list, not two."""
    everywhere, high = Place(), Place("rx_z_m", 6.1, 6.4)
    seen = [(0.8, everywhere), (1.9, high)]
    again = [(0.7, everywhere), (1.8, high), (-0.5, Place("rx=B1"))]
    unknown = [
        Unknown(
            tuple(
                Finding(Cell("error_m", "mean", at), Estimate(size, size - 0.1, size + 0.1, "m"),
                        9.0, 0.002, 90, 30)
                for size, at in some
            ), GAIN, note=note,
        )
        for some, note in zip((seen, again), ("like none", "too little"), strict=True)
    ]  # fmt: skip
    heading, *lines = _explained(unknown)
    assert (
        heading == "What differed without it, and no known effect explains (like none; too little):"
    )
    assert len(lines) == 3
    assert [line.partition("= ")[2].partition(" m")[0] for line in lines] == ["0.8", "1.9", "-0.5"]
    refused = replace(unknown[0], note="looks most like timestamp-jitter, but levels are alike")
    assert _explained([refused])[0] == "What differed without it, and no known effect explains:"


def test_a_class_among_other_names_stands_in_brackets() -> None:
    """Without them three names were read as a choice of three."""
    either = Ambiguous((named(AntennaDelay(1.0)), named(PowerBias())), "")
    line = headline((either, named(RangeRounding())), True, SEEN, "", {}, "The table with it")  # type: ignore[arg-type]
    assert line.startswith("Left out: (antenna-delay or power-bias), range-rounding")
    line = headline((either,), True, SEEN, "", {}, "The table with it")  # type: ignore[arg-type]
    assert line.startswith("Left out: antenna-delay or power-bias")


def test_a_unit_of_a_square_is_said_as_one() -> None:
    assert str(LawConstant("a", 2.0, 2.0, 2.0, "m/s/V/V")) == "2 m per s and V^2"
    assert str(LawConstant("a", 2.0, 2.0, 2.0, "m")) == "2 m"
