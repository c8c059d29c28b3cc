"""How many rows each side of a comparison has, and what was left out, is said."""

from __future__ import annotations

import pandas as pd

from bench.discrepancy.counterpart import beside, counted, exchanged
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

ROWS = pd.DataFrame({"link": ["a", "a", "b"], "true_range_m": 5.0, "error_m": 0.1})


def test_what_was_left_out_is_counted_by_reason() -> None:
    table = Recordings(ROWS, "mine", dropped={"no range error": 4, "negative true range": 7})
    words = "recorded: 3 rows of 2 links; left out: 7 negative true range, 4 no range error"
    assert counted(table, Simulator(Base())) == (words,)


def test_a_simulated_table_is_counted_too() -> None:
    table = Recordings(ROWS, "mine")
    plain = Recordings(ROWS.drop(columns="link"), "simulated")
    assert counted(table, plain) == ("recorded: 3 rows of 2 links", "simulated: 3 rows")


def test_noise_that_is_logged_louder_or_quieter_is_said() -> None:
    quiet = ROWS.assign(noise_std=25.0, preamble_count=256)
    loud = ROWS.assign(noise_std=100.0, preamble_count=1024)
    for ours, theirs, words in (
        (quiet, loud.assign(preamble_count=256), "12.0 dB less recorded than simulated"),
        (loud, quiet, "6.0 dB more recorded than simulated"),
        (loud.drop(columns="preamble_count"), quiet, "12.0 dB more recorded than simulated"),
    ):
        found = counted(Recordings(ours, "mine"), Recordings(theirs, "simulated"))
        assert words in found[-1]
    assert len(counted(Recordings(quiet, "mine"), Recordings(quiet, "simulated"))) == 2
    assert len(counted(Recordings(quiet, "mine"), Recordings(ROWS, "simulated"))) == 2


def test_links_of_which_many_are_one_pair_of_places_are_said() -> None:
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in range(8)], "tx": "t", "rx": "a", "error_m": 0.1}
    )
    for end, x in (("tx", [0.0, 0, 0, 0, 1, 1, 1, 1]), ("rx", 5.0)):
        frame = frame.assign(**{f"{end}_{axis}_m": x if axis == "x" else 1.0 for axis in "xyz"})
    found = counted(Recordings(frame, "mine"), Simulator(Base()))
    assert found[-1].startswith("8 links are of 2 pairs of devices and places")
    apart = frame.assign(tx_x_m=[0.5 * i for i in range(8)])
    assert "pairs of devices" not in " ".join(counted(Recordings(apart, "mine"), Simulator(Base())))


def test_symbols_that_were_not_counted_are_no_division_by_zero() -> None:
    none = ROWS.assign(noise_std=25.0, preamble_count=0.0)
    found = counted(Recordings(none, "mine"), Recordings(ROWS, "simulated"))
    assert len(counted(Recordings(none, "mine"), Recordings(none, "simulated"))) == len(found) == 2


def test_negative_ranges_are_said() -> None:
    below = ROWS.assign(range_m=[5.1, -5.0, -0.2])
    found = counted(Recordings(below, "mine"), Simulator(Base()))
    assert "2 of 3 rows have a negative range_m (the first: -5 m in row 1)" in found[-1]


def test_links_of_one_row_are_said_to_hide_what_rows_have_in_common() -> None:
    alone = ROWS.assign(link=["a", "b", "c"])
    found = counted(Recordings(alone, "mine"), Simulator(Base()))
    assert found[-1].startswith("every link has one row only: what rows of one run have in common")
    assert len(counted(Recordings(ROWS, "mine"), Simulator(Base()))) == 1


def test_what_cirs_lack_to_be_compared_is_said() -> None:
    """A table without the index of first paths was found alike without a word of its CIRs."""
    whole = ROWS.assign(cir=[[1.0, 2.0]] * 3, first_path_index=0.5)
    short = whole.drop(columns="first_path_index")
    ours, theirs = Recordings(whole, "mine"), Recordings(short, "theirs")
    words = "CIRs are not compared: theirs has no first_path_index"
    assert words in counted(ours, theirs)
    assert words in counted(theirs, Simulator(Base()))
    assert words not in counted(ours, theirs, waveforms=False)
    assert not any("CIRs" in line for line in counted(ours, ours))
    bare = "CIRs are not compared: bare has no cir and no first_path_index"
    assert bare in counted(Recordings(ROWS, "bare"), ours)


def test_categories_that_no_simulated_row_has_are_said() -> None:
    """Links without sight had been put aside where the simulator knows sight alone."""
    ours = Recordings(ROWS.assign(los=[True, False, True]), "mine")
    theirs = Recordings(ROWS.assign(los=True, link="c"), "theirs")
    words = "no simulated row has los False (1 rows): these recorded rows take no part"
    assert words in counted(ours, theirs)
    assert not any("take no part" in line for line in counted(theirs, ours))
    blind = Recordings(ROWS.assign(los=False, link="c"), "blind")
    assert not any("take no part" in line for line in counted(theirs, blind))  # of none: no column


ENDS = ROWS.assign(tx=["t", "t", "u"], rx="a", tx_z_m=1.0, rx_z_m=3.0)


def test_ends_that_another_tool_names_the_other_way_are_named_as_recorded() -> None:
    """All that both tables know of a row differed, and a material delay was named."""
    names = {"tx": "rx", "rx": "tx", "tx_z_m": "rx_z_m", "rx_z_m": "tx_z_m"}
    ours, theirs = Recordings(ENDS, "mine"), Recordings(ENDS.rename(columns=names), "theirs")
    made = beside(ours, theirs)
    assert isinstance(made, Recordings)
    pd.testing.assert_frame_equal(made.frame[list(ENDS)], ENDS)
    words = "theirs: its tx are recorded as rx and its rx as tx: taken as recorded"
    assert words in counted(ours, theirs)
    assert words not in counted(ours, made)


def test_ends_are_left_where_they_are_not_exchanged() -> None:
    assert not exchanged(ENDS, ENDS)
    assert not exchanged(ENDS, ENDS.assign(tx="x", rx="y"))  # other names altogether
    assert not exchanged(ENDS, ROWS)
    both = ENDS.assign(tx=["t", "a", "u"], rx=["a", "t", "a"])  # any may be either end
    assert not exchanged(both, both.rename(columns={"tx": "rx", "rx": "tx"}))
    simulator = Simulator(Base())
    assert beside(Recordings(ENDS, "mine"), simulator) is simulator
