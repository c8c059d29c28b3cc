"""The new simulator keeps what held-out links miss, whatever may be said of it."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.select import remainder
from bench.discrepancy.select.refute import Checked
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.receiver.noise_floor import NoiseFloor

TAIL, NOISE = DiffuseTail(), NoiseFloor()
NAMED = LeftOut(NOISE, (), Estimate(1, 1, 1), 1.0, Control("", None))
SAID = (NAMED, Unknown((), Estimate(1, 1, 1)))
HELD = Checked((NOISE,), (), (), (TAIL, NOISE))


@dataclass(frozen=True)
class _View:
    waveform: bool


@dataclass(frozen=True)
class _Search:
    fit: _View
    comparison: None = None
    discover: None = None
    seed: int = 0
    logged: tuple[()] = ()


def _best(
    monkeypatch: pytest.MonkeyPatch, helps: bool, waveform: bool = True
) -> tuple[object, ...]:
    monkeypatch.setattr(remainder, "improves", lambda *_: helps)
    search = _Search(_View(waveform))
    return remainder.fitting_best(search, HELD, (), SAID)  # type: ignore[arg-type]


def test_a_refused_effect_is_simulated_where_held_out_links_fit_better(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert _best(monkeypatch, helps=True) == (TAIL, NOISE)
    assert _best(monkeypatch, helps=False) == (NOISE,)
    assert _best(monkeypatch, helps=True, waveform=False) == (NOISE,)


def test_what_no_verdict_names_is_listed() -> None:
    assert remainder.beyond_names((TAIL, NOISE), SAID) == (TAIL,)
