"""An error of the level follows what the distance makes of levels: what only fades is none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.sets import faded as module
from bench.discrepancy.sets.choose import _contest, chosen
from bench.discrepancy.sets.faded import NAME, faded
from bench.discrepancy.sets.rivals import clear_levels
from bench.recordings.table import Recordings
from tests.bench.discrepancy.sets.test_sets import search_of

Change = Callable[[Recordings], Recordings]


def fading(of_fading_m: float, of_level_m: float) -> Change:
    """Return what fades recorded signals, with so many metres per dB of that and of the level."""

    def made(table: Recordings) -> Recordings:
        if table.simulator:
            return table
        frame = table.frame
        fades = 2.5 * np.random.default_rng(8).normal(size=len(frame))
        level = frame["rx_power_dbm"].to_numpy() + fades
        shift = of_fading_m * fades + of_level_m * (level + 77)
        return replace(
            table,
            frame=frame.assign(
                rx_power_dbm=level,
                error_m=frame["error_m"] + shift,
                range_m=frame["range_m"] + shift,
            ),
        )

    return made


def test_what_follows_fading_alone_is_no_error_of_the_level() -> None:
    found = chosen(search_of(None, 11, fading(-0.02, 0.0)), ())
    assert (found.names, found.others) == ((), (NAME,))


def test_what_follows_levels_however_they_come_about_is_one() -> None:
    found = chosen(search_of(None, 11, fading(0.0, -0.008)), ())
    assert (found.names, found.others) == (("power-bias",), ())


def test_levels_that_do_not_fade_tell_nothing() -> None:
    made = _contest(search_of(None, 11, fading(0.0, -0.008)), ())
    assert made is not None
    contest, _ = made
    contest.fading = np.zeros(len(contest.known))
    assert faded(contest, ("power-bias",)) is None


@pytest.mark.parametrize("offsets_m", [0.0, 0.05])
def test_where_links_keep_offsets_weak_signals_tell_no_error_of_the_level(
    offsets_m: float,
) -> None:
    levels, usual = np.array([-3.0, -1.0, 1.0, 2.0]), np.array([True, True, True, False])
    contest = SimpleNamespace(usual=usual, fading=levels)
    contest.evidence = SimpleNamespace(mean_ratio=offsets_m)
    told = [False, False, True, False] if offsets_m else usual
    assert np.array_equal(clear_levels(contest), told)  # type: ignore[arg-type]


@pytest.mark.parametrize(("scale_undoes", "held"), [(True, True), (False, False)])
def test_what_only_undoes_the_distance_of_levels_is_no_second_name(
    monkeypatch: pytest.MonkeyPatch, *, scale_undoes: bool, held: bool
) -> None:
    # The law alone does as well as both names; it leads the error, where the scale repairs that.
    left = 100.0 if scale_undoes else 395.0
    worths = {("power-bias",): left, ("range-scale",): 2.0, (): 0.0}
    contest = SimpleNamespace(
        fading=np.linspace(-3, 3, 50),
        library=frozenset({"power-bias", "range-scale"}),
        kinds={"power-bias": SimpleNamespace(follows="rx_power_dbm")}
        | {"range-scale": SimpleNamespace(follows="")},
        worth=lambda causes: worths.get(tuple(causes), 400.0),
    )
    made = {(): 399.0, ("range-scale",): 396.0}
    monkeypatch.setattr(module, "_worth", lambda _, rest, __: made[tuple(rest)])
    found = faded(contest, ("power-bias", "range-scale"))  # type: ignore[arg-type]
    assert (found is not None) is held
    if found:
        assert found.names == ("power-bias",)
