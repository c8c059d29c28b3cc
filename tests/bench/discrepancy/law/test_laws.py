"""Laws and faults that no library effect is are found by form, size and name; noise has none."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest
from unlisted import CASES, Case, Hidden, tables

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.law import instead, unexplained
from bench.discrepancy.law.found import FoundLaw, SetupFault, fault_dict, law_dict
from bench.discrepancy.law.instead import leads
from bench.discrepancy.law.judge import judged, setup_fault
from bench.discrepancy.law.material import Material, condition, material
from bench.discrepancy.law.search import propose
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Ambiguous, Control, LeftOut
from bench.physics import Base, Simulator, from_toml, to_toml
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.law import Law
from bench.physics.effects.ranging.range_scale import RangeScale

QUICK = (
    "scale -1.2 %", "three lobes", "one tag squared", "rounded down", "anchor off 0.5 m",
    "anchors 0 and 1 swapped", "one anchor in feet",
)  # fmt: skip


def material_of(case: Case | None, seed: int) -> tuple[pd.DataFrame, np.ndarray, np.ndarray]:
    """Return recorded rows, recorded - simulated ranges in metres, and which links are sealed."""
    recorded, simulated = tables(case, seed)
    mean = simulated["error_m"].to_numpy().reshape(-1, len(recorded)).mean(axis=0)
    codes = pd.factorize(recorded["link"])[0]
    sealed = np.random.default_rng(seed).permutation(codes.max() + 1)[: codes.max() // 4]
    return recorded, recorded["error_m"].to_numpy() - mean, np.isin(codes, sealed)


def part(given: tuple, keep: np.ndarray, like: Material | None = None) -> Material:
    """Return some of the rows as the material of a search."""
    recorded, residual, _ = given
    codes = pd.factorize(recorded["link"])[0]
    frame = recorded[keep].reset_index(drop=True)
    return material(frame, residual[keep], codes[keep], like)


def answer(case: Case | None, seed: int) -> tuple[FoundLaw | None, SetupFault | None]:
    """Return what the search says of a case, judged on its sealed links."""
    given = material_of(case, seed)
    proposal = propose(part(given, ~given[2]), seed)
    if proposal is None:
        return None, None
    law = judged(proposal, part(given, given[2], proposal.given), seed)
    return law, setup_fault(proposal) if law else None


@lru_cache
def of_name(name: str) -> tuple[int, Case, FoundLaw | None, SetupFault | None]:
    """Return a case by name, with its number and what the search says of it."""
    number, case = next((i, c) for i, c in enumerate(CASES) if c.name == name)
    return number, case, *answer(case, number)


def is_right(case: Case, law: FoundLaw | None) -> bool:
    """Return whether a law has the form and the covariate that was hidden."""
    named = law is not None and law.form in case.forms
    return named and (not case.columns or set(law.columns) <= set(case.columns))


def errors_of(case: Case, law: FoundLaw) -> list[float]:
    """Return the relative errors of the constants that were hidden."""
    found = {constant.name: constant.value for constant in law.constants}
    return [abs(found[name] - true) / abs(true) for name, true in case.constants.items()]


@pytest.mark.parametrize("name", QUICK)
def test_a_hidden_law_is_found(name: str) -> None:
    _, case, law, fault = of_name(name)
    assert law is not None
    assert is_right(case, law), str(law)
    assert max(errors_of(case, law), default=0.0) < 0.1
    assert (fault.kind if fault else "") == case.fault
    assert not fault or fault.devices == case.devices or case.fault == "unit"
    assert law.gain_nats.low > 0
    assert str(law).startswith("a fault of the set-up" if case.fault else "a law without a name")
    assert from_toml(to_toml(Simulator(Base(), (law.effect,)))).effects == (law.effect,)
    assert json.loads(json.dumps([law_dict(law), fault_dict(fault)]))[0]["form"] == law.form


def test_noise_has_no_law() -> None:
    assert answer(None, 100) == (None, None)


def test_a_law_that_sealed_links_do_not_bear_out_is_not_said() -> None:
    case = next(c for c in CASES if c.name == "scale -1.2 %")
    given = material_of(case, 1)
    proposal = propose(part(given, ~given[2]), 1)
    assert proposal is not None
    sealed = part(given, given[2], proposal.given)
    assert judged(proposal, sealed, 1) is not None
    noise = replace(sealed, residual_m=np.random.default_rng(2).normal(0, 0.03, len(sealed.links)))
    assert judged(proposal, noise, 1) is None


def test_the_effect_gives_what_the_law_says() -> None:
    for name in ("anchor off 0.5 m", "anchors 0 and 1 swapped", "one tag squared", "three lobes"):
        number, case, law, _ = of_name(name)
        assert law is not None
        frame = tables(case, number)[0].drop(columns=["range_m", "error_m"])
        bare, lawful = (
            Simulator(Base(), effects).simulate(frame).frame["range_m"].to_numpy()
            for effects in ((), (law.effect,))
        )
        off = (lawful - bare) - case.hidden(frame)
        assert np.abs(off).max() < 0.05


def test_only_groups_that_a_simulator_knows_are_written_down() -> None:
    assert condition('rx=a"2') == ('(rx == "a\\"2")', 'rx is a"2')
    assert condition("pair=t1->a2")[0] == '((tx == "t1") * (rx == "a2"))'
    assert condition("obstacle=wall")[0] == '(obstacles == "wall")'
    assert condition("los=False")[0] == "(los < 0.5)"
    assert condition("firmware=2") is None
    assert condition("rx=" + "a" * 41) is None
    for text in ("rx=a'2", 'rx=a"2', "rx=a\\2", "environment=hall (north)"):
        Law(f"{condition(text)[0]} * true_range_m")


def test_a_law_leads_names_that_leave_it_and_not_those_that_explain_it() -> None:
    number, case, _, _ = of_name("anchor off 0.5 m")
    given = material_of(case, number)
    alone = propose(part(given, ~given[2]), number)
    assert alone is not None
    noise = np.random.default_rng(1).normal(0, alone.scale_m, len(alone.given.links))
    explained = replace(alone.given, residual_m=noise)
    named = (AntennaDelay(delay_ns=0.1),)
    assert leads(alone, alone.given, None, named)
    assert not leads(alone, explained, None, named)
    assert leads(alone, alone.given, alone, named)  # the names leave all of it: they do nothing
    better = replace(alone, best=replace(alone.best, nats=alone.best.nats + 10))
    assert not leads(alone, alone.given, better, named)  # together they do better


def test_a_law_that_a_class_member_is_narrows_the_class(monkeypatch: pytest.MonkeyPatch) -> None:
    number, case, _, _ = of_name("anchor off 0.5 m")
    given = material_of(case, number)
    alone = propose(part(given, ~given[2]), number)
    assert alone is not None
    noise = np.random.default_rng(1).normal(0, alone.scale_m, len(alone.given.links))
    explained = replace(alone.given, residual_m=noise)
    clock, scale, delay = ClockOffset(), RangeScale(), AntennaDelay(delay_ns=0.1)
    doubt = Estimate(1.0, 0.9, 1.1)
    options = tuple(LeftOut(e, (), doubt, 1.0, Control("", None)) for e in (clock, scale, delay))
    found = Selection((Ambiguous(options, ""),), (clock,), ())

    def left(_: object, __: object, added: tuple[object, ...]) -> Material:
        return explained if delay in added else alone.given

    monkeypatch.setattr(instead, "gathered", left)
    search = cast(Search, SimpleNamespace(comparison=None))
    narrower = instead.narrowed(search, found, alone, ())
    assert narrower is not None
    assert narrower.names == (("antenna-delay",),)
    assert narrower.added == (delay,)
    bare = replace(found, verdicts=(Ambiguous(options[:2], ""),))
    assert instead.narrowed(search, bare, alone, ()) is None


def test_words_have_units_and_intervals() -> None:
    _, _, law, _ = of_name("scale -1.2 %")
    assert law is not None
    assert str(law).startswith("a law without a name: error = -0.012 (-0.01")
    assert "m per m of true range; looks like: a clock or unit scale" in str(law)


def test_a_law_of_anchors_at_their_places_is_not_told_from_their_delays() -> None:
    delays_m = {"a0": 0.12, "a2": 0.12, "a4": 0.12}  # the anchors above 2.5 m

    def hidden(frame: pd.DataFrame) -> np.ndarray:
        return frame["rx"].map(delays_m).fillna(0.0).to_numpy()

    given = material_of(Case("", hidden, (), (), {}), 3)
    found = propose(part(given, np.ones(len(given[1]), bool)), 3)
    assert found is None or not any("rx_" in one for one in found.best.structure.columns)


@pytest.mark.parametrize(
    ("hidden", "told"),
    [
        (lambda frame: 0.004 * frame["true_range_m"].to_numpy(), False),
        (lambda frame: 0.03 * (frame["supply_v"].to_numpy() > 3.2), True),
    ],
)
def test_a_law_that_a_changed_waveform_may_make_is_told_from_it(hidden: Hidden, told: bool) -> None:
    given = material_of(Case("", hidden, (), (), {}), 3)
    found = propose(part(given, np.ones(len(given[1]), bool)), 3)
    assert found is not None
    assert unexplained._beyond_detectors(found) == told
