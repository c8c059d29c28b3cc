"""A shift that no row determines is not listed with an interval of kilometres."""

from __future__ import annotations

from bench.discrepancy.law.faults import UNDETERMINED, Position
from bench.discrepancy.law.found import LawConstant
from bench.discrepancy.law.judge import shown


def test_a_shift_that_may_be_anything_is_said_to_be_undetermined() -> None:
    constants = (
        LawConstant("dx", 0.72, 0.7, 0.75, "m"),
        LawConstant("dz", -0.4, -820000.0, 0.01, "m"),
        LawConstant("at", 600.0, 500.0, 700.0, "m"),
    )
    said = shown(constants)
    assert said["dz"] == "an undetermined length"
    assert said["dx"].startswith("0.72")
    assert said["at"].startswith("600")


def test_a_device_of_which_nothing_says_how_far_it_moved_is_said_so() -> None:
    moved = Position("a3", ("rx",), (0, 1), "xyz", 1)
    lost = moved.words(dict.fromkeys(("dx", "dy"), UNDETERMINED))
    assert lost.endswith("; how far, these recordings do not determine")
    partly = moved.words({"dx": "0.5 m", "dy": UNDETERMINED})
    assert partly.endswith("by 0.5 m along x, an undetermined length along y")
