"""What ranges differ by beside a name is no second cause where another form of it does as well."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.select import other_forms as module
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.sets.choice import Choice
from bench.physics.effects.ranging.range_scale import RangeScale

SCALE = (RangeScale(scale=0.01),)
RNG = np.random.default_rng(3)
LINKS = np.repeat(np.arange(40), 5)
FAR = np.repeat(RNG.uniform(2, 40, 40), 5)
PLACE = np.repeat(RNG.uniform(-1, 1, 40), 5)
CHANCE = RNG.normal(0, 0.01, 200)
FRAME = pd.DataFrame({
    "link": LINKS, "true_range_m": FAR, "temperature_c": PLACE, "error_m": np.zeros(200),
})  # fmt: skip
TWO_TAPES = 0.003 * PLACE * FAR  # a scale of another size here and there
STEP = 0.2 * (RNG.random(40) > 0.5)[LINKS]  # goes with nothing


def _search(left_m: np.ndarray, choice: Choice) -> Search:
    """Return a search of which such ranges are left beside a scale."""
    rows: View = view(FRAME, LINKS, np.arange(200), Window(), None, False)
    comparison = SimpleNamespace(
        ensemble=lambda _, added, *__: Ensemble(
            ("error_m",), ("m",),
            np.stack([left_m, *[0.01 * FAR * len(added) * 0 + 0.0] * 2])[..., None], LINKS,
        )
    )  # fmt: skip
    return cast("Search", SimpleNamespace(choice=choice, both=rows, comparison=comparison))


@pytest.mark.parametrize(("left_m", "share"), [(TWO_TAPES, 0.2), (STEP, 0.9)])
def test_a_scale_of_two_sizes_is_a_scale_and_steps_are_none(
    monkeypatch: pytest.MonkeyPatch, left_m: np.ndarray, share: float
) -> None:
    monkeypatch.setattr(module, "moved_m", lambda *_: 0.01 * FAR)
    search = _search(left_m + CHANCE, Choice(("range-scale",)))
    rest_m = left_m - module._deformation(search, search.both, SCALE)
    kept = float(np.std(rest_m) / np.std(left_m))
    assert kept < share if share < 0.5 else kept > share


@pytest.mark.parametrize(
    ("others", "removed", "beyond", "forms"),
    [((), 0.1, True, True), ((), 0.5, True, False), ((), 0.5, False, True),
     (("a law of time_s",), 0.1, True, False), (("a law of time_s",), 0.1, False, True)],
)  # fmt: skip
def test_little_is_a_form_and_what_a_set_holds_without_a_name_is_none(
    monkeypatch: pytest.MonkeyPatch,
    others: tuple[str, ...],
    removed: float,
    beyond: bool,
    forms: bool,
) -> None:
    gained = Estimate(1.0, 0.9, 1.1, "nats")
    monkeypatch.setattr(module, "tally", lambda made: made)
    monkeypatch.setattr(module, "gain_interval", lambda *_: gained)
    monkeypatch.setattr(module, "_beyond_deformed", lambda *_: beyond)
    monkeypatch.setattr(module, "_others_needed", lambda *_: beyond)
    search = SimpleNamespace(
        choice=Choice(("range-scale",), others), discover=None, seed=0,
        comparison=SimpleNamespace(ensemble=lambda *_: None),
    )  # fmt: skip
    last = SimpleNamespace(explanation=SimpleNamespace(removable=Estimate(removed, 0, 1, "nats")))
    asked = cast("Search", search), SCALE, cast("Round", last)
    assert module.made_by_forms(*asked) is forms
