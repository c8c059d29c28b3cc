"""A law that does just what an effect of the library does is no law without a name."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.verdicts import LEFT_OF_RANGES, LEFT_OF_WAVES
from bench.discrepancy.law.likeness import NOT_ALONE
from bench.discrepancy.law.unexplained import borne_out, weighed
from bench.discrepancy.select.candidates import library, offered
from bench.discrepancy.select.state import Round, Search, Selection
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown, Verdict
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.ranging.range_scale import RangeScale
from tests.bench.discrepancy.numpy_tables import tables


def words_of(
    hidden: Callable[[pd.DataFrame, np.random.Generator], np.ndarray],
    note: str,
    named: tuple[Verdict, ...] = (),
    added: Added = (),
) -> str:
    """Return what is said of a law beside `named`; why nothing else was named: `note`."""
    recorded, simulated = tables(5, hidden)
    frame, codes = recorded.frame, link_codes(recorded.frame)
    views = [
        view(frame, codes, np.flatnonzero(codes % 3 == part), Window(), None, False)
        for part in range(3)
    ]
    comparison = TableComparison(simulated.frame, Window())
    search = Search(comparison, *views[:2], offered(library()[0], frame, False, False)[0], 0)
    unknown = Unknown((), Estimate(1.0, 0.9, 1.1), {}, note)
    made = weighed(search, Selection((*named, unknown), added, (), together=("range-scale",)))
    return str(borne_out(comparison, views[2], made, 0).law)


def scaled(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    return 0.02 * frame["true_range_m"].to_numpy() - 0.1


def late(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    return np.where(frame["tx"] == "d2", 250.0 * frame["reply_time_s"], 0.0)


def grown(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    return 0.0016 * frame["true_range_m"].to_numpy() ** 2


def levelling(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    true_m = frame["true_range_m"].to_numpy()
    return 3.0 * true_m / (true_m + 0.8)


@pytest.mark.parametrize(
    ("hidden", "name"),
    [(levelling, ""), (scaled, "range-scale"), (late, "clock-offset"), (grown, "")],
)
def test_a_law_says_of_which_effects_form_it_is(
    hidden: Callable[[pd.DataFrame, np.random.Generator], np.ndarray], name: str
) -> None:
    said = words_of(hidden, "")
    assert said.startswith(f"a law of the form of {name}: " if name else "a law without a name: ")
    assert said.endswith(f" ({name} is not named: {NOT_ALONE})") == bool(name)


def test_a_law_says_why_the_effect_of_its_form_was_refused() -> None:
    said = words_of(scaled, "range-scale gains most, but it is there too in rows at one place")
    assert said.startswith("a law of the form of range-scale: error = ")
    assert "(range-scale is not named: range-scale gains most" in said


def test_of_what_is_named_a_law_is_another_curve() -> None:
    named = LeftOut(RangeScale(), (), Estimate(1.0, 0.9, 1.1), 1.0, Control("", None))
    said = words_of(scaled, "", (named,))
    assert said.startswith("a law of the form of range-scale, which is named: its curve")


def of_one(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    return np.where(frame["tx"] == "d2", 0.2, 0.0)


@pytest.mark.parametrize("same", [True, False])
def test_a_delay_of_one_device_stays_a_delay(monkeypatch: pytest.MonkeyPatch, same: bool) -> None:
    """The law of one device has fewer constants than the delays of all, and is one of these."""
    if not same:
        monkeypatch.setattr("bench.discrepancy.law.unexplained.does_the_same", lambda *_: False)
    recorded, simulated = tables(5, of_one)
    frame, codes = recorded.frame, link_codes(recorded.frame)
    parts = [np.flatnonzero(codes % 3 == part) for part in range(2)]
    views = [view(frame, codes, rows, Window(), None, False) for rows in parts]
    kinds = offered(library()[0], frame, False, False)[0]
    search = Search(TableComparison(simulated.frame, Window()), views[0], views[1], kinds, 0)
    devices = tuple(f"d{i}" for i in range(11))
    noise = np.random.default_rng(0).normal(0, 0.1, 11)
    delays = DeviceDelay(devices, tuple(noise + np.where(np.arange(11) == 2, 1.34, 0.0)))
    named = LeftOut(delays, (), Estimate(1.0, 0.9, 1.1), 1.0, Control("", None))
    unknown = Unknown((), Estimate(1.0, 0.9, 1.1), {}, LEFT_OF_WAVES)
    explained = SimpleNamespace(contenders=(), removable=Estimate(1.0, 0.9, 1.1))
    turn = Round(SimpleNamespace(findings=()), explained, delays)  # type: ignore[arg-type]
    made = weighed(search, Selection((named, unknown), (delays,), (turn,)))
    assert (made.instead is None) is same


def bent(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    far = frame["true_range_m"].to_numpy()
    return 0.02 * far + 0.0012 * far**2


def warm(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    return 0.02 * frame["true_range_m"].to_numpy() + 0.01 * frame["temperature_c"].to_numpy()


@pytest.mark.parametrize(("hidden", "law"), [(bent, False), (warm, True)])
def test_another_curve_of_what_is_named_is_no_law(
    hidden: Callable[[pd.DataFrame, np.random.Generator], np.ndarray], law: bool
) -> None:
    scale = RangeScale(scale=0.02)
    named = LeftOut(scale, (), Estimate(1.0, 0.9, 1.1), 1.0, Control("", None))
    assert (words_of(hidden, "", (named,), (scale,)) != "None") == law


@pytest.mark.parametrize(("note", "said"), [(LEFT_OF_WAVES, False), (LEFT_OF_RANGES, True)])
def test_a_scale_is_no_law_beside_waveforms_that_nothing_explains(note: str, said: bool) -> None:
    assert (words_of(scaled, note) != "None") == said


def test_a_law_of_a_logged_clock_names_the_effect_and_its_log():
    logged: list[np.ndarray] = []

    def clocks(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
        logged.append(rng.normal(0, 4, len(frame)))
        return 149.9 * logged[-1] * frame["reply_time_s"].to_numpy()

    recorded, simulated = tables(5, clocks)
    frame = recorded.frame.assign(clock_offset_ppm=logged[0])
    other = simulated.frame.assign(clock_offset_ppm=np.random.default_rng(3).permutation(
        np.resize(logged[0], len(simulated.frame))))  # fmt: skip
    codes = link_codes(frame)
    views = [
        view(frame, codes, np.flatnonzero(codes % 3 == part), Window(), None, False)
        for part in range(3)
    ]
    comparison = TableComparison(other, Window())
    search = Search(comparison, *views[:2], offered(library()[0], frame, False, False)[0], 0)
    unknown = Unknown((), Estimate(1.0, 0.9, 1.1), {}, "")
    law = borne_out(comparison, views[2], weighed(search, Selection((unknown,), (), ())), 0).law
    assert str(law).startswith("a law of the form of clock-offset, by what is logged")
