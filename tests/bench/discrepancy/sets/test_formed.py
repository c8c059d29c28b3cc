"""A name gives way to a law that predicts as well; a name that is the truth does not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets import formed as forms
from bench.discrepancy.sets.choose import Contest, _contest, chosen
from bench.discrepancy.sets.formed import Formed, _named_scale, _over, _varied, formed
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.recordings.table import Recordings
from tests.bench.discrepancy.numpy_tables import Hidden, warmth
from tests.bench.discrepancy.sets.test_sets import search_of


def stepped(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return 8 cm from 24 degrees on: warming radios follow no step."""
    return 0.08 * (frame["temperature_c"].to_numpy() > 24)


def settling(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return what levels off with the distance: an error of the level would too."""
    return 0.15 * (1 - np.exp(-frame["true_range_m"].to_numpy() / 4))


@pytest.mark.parametrize(
    ("hidden", "names", "form"),
    [(stepped, (), "step"), (settling, (), ""), (warmth, ("temperature-drift",), "")],
)
def test_a_name_holds_only_where_no_law_predicts_as_well(
    hidden: Hidden, names: tuple[str, ...], form: str
) -> None:
    found = chosen(search_of(hidden, 11), ())
    assert found.names == names
    assert any(one.startswith(form) for one in (*found.others, ""))


def speed(frame: pd.DataFrame) -> np.ndarray:
    """Return radial speeds, in m/s, that go with nothing else."""
    return 1.2 * np.sin(40 * frame["true_range_m"].to_numpy())


def moving(table: Recordings) -> Recordings:
    return replace(table, frame=table.frame.assign(radial_speed_m_per_s=speed(table.frame)))


@pytest.mark.parametrize(("bend", "names"), [(0.2, ("time-lag",)), (0.4, ())])
def test_a_lag_that_hardly_varies_is_a_lag(bend: float, names: tuple[str, ...]) -> None:
    """A law of the speed and the temperature does as well, or is likelier, as it varies by more."""

    def late(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        warm = (frame["temperature_c"].to_numpy() - 22) / 17
        return 0.15 * (1 + bend * warm) * speed(frame)

    assert chosen(search_of(late, 11, moving), ()).names == names


HEIGHTS_M = {"d5": 1.2, "d6": 2.4, "d7": 2.1, "d8": 1.5, "d9": 1.4, "d10": 2.6}


def raised(per_row: np.ndarray) -> Callable[[Recordings], Recordings]:
    """Return what adds heights of rx: of its device, and `per_row` [n] of each row of ours."""

    def made(table: Recordings) -> Recordings:
        frame = table.frame
        more = np.resize(per_row, len(frame))
        return replace(table, frame=frame.assign(rx_z_m=frame["rx"].map(HEIGHTS_M) + more))

    return made


def test_a_law_over_where_devices_stand_is_no_more_than_their_delays() -> None:
    def delays(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return 0.08 * (frame["rx"].map(HEIGHTS_M).to_numpy() > 1.8)

    found = chosen(search_of(delays, 11, raised(np.zeros(1))), ())
    assert found.names == ("antenna-delay",)
    assert found.others == ()


def test_a_law_of_heights_times_the_reply_time_is_no_more_than_clocks() -> None:
    def clocks(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return 150.0 * frame["reply_time_s"].to_numpy() * (frame["rx"].map(HEIGHTS_M) > 1.8)

    made = _contest(search_of(clocks, 11, raised(np.zeros(1))), ())
    assert made is not None
    laws = formed(made[0], ("clock-offset",), ("clock-offset",))
    assert not [one.name for one in laws if {"rx_z_m", "reply_time_s"} <= one.over]
    assert made[0].settled().names == ("clock-offset",)


def test_a_law_over_where_devices_go_is_a_law() -> None:
    up = np.random.default_rng(4).uniform(-1, 1, 360)

    def high(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return 0.08 * (frame["rx"].map(HEIGHTS_M).to_numpy() + up > 1.8)

    found = chosen(search_of(high, 11, raised(up)), ())
    assert "antenna-delay" not in found.names


def test_a_cause_that_a_deformation_did_for_is_back_where_only_a_law_does_for_it() -> None:
    """A lag beside a motion during the exchange is no lag that goes with the reply time."""

    def moving(table: Recordings) -> Recordings:
        speed = np.resize(np.sin(0.7 * np.arange(360)) * 1.2, len(table.frame))
        reply_s = np.resize(np.linspace(2e-3, 9e-3, 11), len(table.frame))
        return replace(
            table, frame=table.frame.assign(radial_speed_m_per_s=speed, reply_time_s=reply_s)
        )

    def hidden(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
        rows = moving(Recordings(frame, "rows")).frame
        reply = (rows["reply_time_s"] / rows["reply_time_s"].mean()).to_numpy()
        return np.asarray(rows["radial_speed_m_per_s"] * (0.06 + 0.04 * reply))

    found = chosen(search_of(hidden, 11, moving), ())
    assert {"exchange-motion", "time-lag"} <= {*found.names}
    assert found.others == ()


@pytest.mark.parametrize(("lead", "over"), [(1.0, {"heading"}), (4.0, {"heading", "warmth"})])
def test_a_law_is_about_what_it_is_multiplied_with_where_it_is_the_better_for_it(
    lead: float, over: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    ones = np.ones((3, 1))
    law = Formed(
        "wave", (ones,), 0.0, frozenset({"heading", "warmth"}), False, ones,
        ones[:, 0], "warmth", (2 * ones,),
    )  # fmt: skip
    nats = {id(law.parts): lead, id(law.bare): 0.0}
    monkeypatch.setattr(
        "bench.discrepancy.sets.formed.nats_with", lambda _, __, more: nats[id(more["wave"])]
    )
    assert _over(cast(Contest, None), ("antenna-pattern",), ("antenna-pattern",), law) == over


@pytest.mark.parametrize("bend", [0.2, 0.0])
def test_a_name_that_varies_is_no_worse_than_a_law_times_the_same(bend: float) -> None:
    def late(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        warm = (frame["temperature_c"].to_numpy() - 22) / 17
        return 0.15 * (1 + bend * warm) * speed(frame)

    made = _contest(search_of(late, 11, moving), ())
    assert made is not None
    contest, name = made[0], ("time-lag",)
    contest.settled()
    warm = contest.rows.frame["temperature_c"].to_numpy()[contest.known]
    part = speed(contest.rows.frame)[contest.known][:, None]
    law = Formed("a", (part,), 0.0, frozenset(), False, part, warm, "temperature_c", (part,))
    gained = _varied(contest, name, name, law) - contest.nats(name)
    assert (gained > 3) == (bend > 0)
    assert _varied(contest, name, name, replace(law, by=None)) == -np.inf


@pytest.mark.parametrize(
    ("power", "offset", "scale"), [(1, False, True), (1, True, True), (2, True, False)]
)
def test_a_line_over_the_distance_is_no_law_in_the_place_of_an_error_of_the_level(
    power: int, offset: bool, scale: bool
) -> None:
    made = _contest(search_of(None, 11), ())
    assert made is not None
    contest = made[0]
    far = contest.rows.scene.true_range_m[contest.known][:, None] ** power
    parts = (far, np.ones_like(far))[: 1 + offset]
    law = Formed("a", parts, 0.0, frozenset({"true_range_m"}), offset, far)
    assert _named_scale(contest, ("power-bias",), law) == scale
    assert not _named_scale(contest, ("power-bias", "antenna-delay"), law)
    contest.library -= {"range-scale"}
    assert not _named_scale(contest, ("power-bias",), law)


@pytest.mark.parametrize(
    ("name", "shape", "level"),
    [
        ("power-bias", np.log, True),  # as a level falls in free space
        ("power-bias", np.square, False),
        ("range-scale", np.log, False),  # follows no level
    ],
)
def test_a_logarithm_of_the_distance_is_no_other_cause_than_a_bias_of_the_level(
    name: str, shape: Callable[[np.ndarray], np.ndarray], level: bool
) -> None:
    far_m = np.linspace(2, 20, 40)
    rows = SimpleNamespace(frame=pd.DataFrame({"true_range_m": far_m}))
    kinds = {"power-bias": PowerBias, "range-scale": RangeScale}
    contest = SimpleNamespace(kinds=kinds, rows=rows, known=np.arange(40))
    parts = (shape(far_m / 7)[:, None], np.ones((40, 1)))
    law = Formed("a law", parts, 9.0, frozenset({"true_range_m"}), True, np.ones((40, 1)))
    assert forms._level(cast(Contest, contest), (name,), law) is level
