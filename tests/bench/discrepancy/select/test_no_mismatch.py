"""What is said where nothing is found, and of what names leave, does not contradict itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select.conclude import _why_left, of_the_rest
from bench.discrepancy.select.objections import loses_by_itself
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.verdict import Control, LeftOut, NoMismatch, Unknown
from bench.discrepancy.sets.choice import Choice
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

ONE = Estimate(1.0, 0.5, 1.5, "nats")


def test_a_small_p_that_was_not_enough_is_said_to_be() -> None:
    shift = {"error_m": 0.012}
    assert str(NoMismatch(shift, 0.49)).startswith("no mismatch found (p = 0.49); a range shift")
    assert "(p = 0.034, not enough, as" in str(NoMismatch(shift, 0.034))
    assert "(p = 0.024, not enough, as" in str(NoMismatch(shift, 0.024))
    assert str(NoMismatch({}, 0.02)).endswith(
        "(p = 0.02, not enough, as several searches share 5 %)"
    )


def test_what_is_unknown_beside_names_is_what_these_leave() -> None:
    """Causes of one set share the search before all of them, which a named one may explain."""
    cells = [Cell("error_m", "mean", Place()), Cell("error_m", "mean", Place("obstacle=glass"))]
    before, after = (Finding(one, Estimate(0.2, 0.1, 0.3, "m"), 9.0, 0.002, 40, 9) for one in cells)
    said = LeftOut(AntennaDelay(), (), ONE, 1.0, Control("", None)), Unknown((before,), ONE, {})
    rounds = tuple(
        Round(Located(some, 0.002, 9.0, 3.0, 1, {}), None, None) for some in ((before,), (after,))
    )
    assert of_the_rest(said, rounds)[1].findings == (after,)
    assert of_the_rest(said[1:], rounds) == said[1:]
    assert of_the_rest(said, rounds[:1]) == said


def test_what_is_left_alone_is_not_left_by_names() -> None:
    less, more = Estimate(-0.05, -0.06, -0.04, "m"), Estimate(0.05, 0.04, 0.06, "m")
    named = (LeftOut(AntennaDelay(), (), ONE, 1.0, Control("", None)),)
    for effect, said, words in (
        (less, (), "simulated ranges scatter more than recorded ones"),
        (more, (), "no known effect removes enough"),
        (less, named, "left after the named effects"),
    ):
        seen = Finding(Cell("error_m", "rows", Place()), effect, 9.0, 0.002, 40, 9)
        last = Round(Located((seen,), 0.002, 9.0, 3.0, 1, {}), None, None)
        search = cast(Search, SimpleNamespace(choice=Choice()))
        assert _why_left(search, last, said).startswith(words)


def test_what_held_out_links_are_surely_worse_with_is_no_name_but_scatter() -> None:
    worse, perhaps = Estimate(-1.1, -1.6, -0.6, "nats"), Estimate(-0.1, -0.3, 0.1, "nats")
    for effect, gain, loses in (
        (AntennaDelay(), worse, True),
        (AntennaDelay(), perhaps, False),
        (TimestampJitter(), worse, False),
    ):
        assert loses_by_itself(LeftOut(effect, (), gain, 1.0, Control("", None))) is loses
