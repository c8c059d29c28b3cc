"""Two devices that have each other's name have it in every row, whichever end they are at."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from unlisted import ANCHORS, SCATTER_M, rows

from bench.discrepancy.law.material import Material, material
from bench.discrepancy.law.search import Proposal, propose
from bench.discrepancy.law.swaps import Still, Swap, still, swaps
from bench.physics import Base, Simulator
from bench.physics.effects.ranging.law import with_constants
from bench.physics.scene import scene

ENDS, SWAPPED = ("tx", "rx"), {"a1": "a3", "a3": "a1"}


def both_ways() -> pd.DataFrame:
    """Return rows in which anchors ask and are asked, every other one, and range to each other."""
    frame = rows(np.random.default_rng(7))
    turned = np.arange(len(frame)) % 2 == 0
    ways = [("tx", "rx"), *((f"tx_{axis}_m", f"rx_{axis}_m") for axis in "xyz")]
    for one, two in ways:
        there, back = frame[one].copy(), frame[two].copy()
        frame[one], frame[two] = there.where(~turned, back), back.where(~turned, there)
    pairs = [(i, k) for i in range(len(ANCHORS)) for k in range(len(ANCHORS)) if i != k]
    among = frame.iloc[: len(pairs)].assign(link=[f"a{i}-a{k}" for i, k in pairs])
    for end, column in zip(ENDS, np.array(pairs).T, strict=True):
        among[end] = [f"a{i}" for i in column]
        for axis, name in enumerate("xyz"):
            among[f"{end}_{name}_m"] = ANCHORS[column, axis]
    frame = pd.concat([frame, among], ignore_index=True)
    return frame.assign(true_range_m=_apart_m(*(places(frame, end) for end in ENDS)))


def places(frame: pd.DataFrame, end: str) -> np.ndarray:
    """Return the positions [n, 3] of an end by the plan."""
    return frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(float)


def _apart_m(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(one - two, axis=1))


def really_m(frame: pd.DataFrame) -> np.ndarray:
    """Return how much longer ranges [n] are than by the plan with a1 and a3 swapped."""
    real = {}
    for end in ENDS:
        real[end] = places(frame, end)
        for name, other in SWAPPED.items():
            real[end][frame[end] == name] = ANCHORS[int(other[1:])]
    return _apart_m(real["tx"], real["rx"]) - frame["true_range_m"].to_numpy()


def given(frame: pd.DataFrame, residual_m: np.ndarray) -> Material:
    """Return rows as the material of a search."""
    frame = frame.assign(error_m=residual_m)
    return material(frame, residual_m, pd.factorize(frame["link"])[0])


def proposed(frame: pd.DataFrame) -> Proposal:
    noise = np.random.default_rng(1).normal(0, SCATTER_M, len(frame))
    found = propose(given(frame, really_m(frame) + noise), 1)
    assert found is not None
    return found


def test_a_swap_is_found_at_both_ends() -> None:
    best = proposed(both_ways()).best
    assert isinstance(best.structure, Swap)
    assert best.structure.pair == ("a1", "a3")
    assert best.structure.words({}) == "devices a1 and a3 are swapped"
    assert best.fitted.fit.scale_m < 2 * SCATTER_M


def test_a_swap_says_what_happens_in_every_row() -> None:
    """Also between both devices: as far as the plan says, and not from one to itself."""
    frame = both_ways()
    seen = given(frame, really_m(frame))
    swap = next(one for one in swaps(seen) if one.pair == ("a1", "a3"))
    assert swap.shift_m(seen, ()) == pytest.approx(really_m(frame), abs=1e-9)
    assert (frame["tx"].isin(SWAPPED) & frame["rx"].isin(SWAPPED)).sum() == 2


def test_a_swap_as_an_effect_says_the_same() -> None:
    frame = both_ways()
    seen = given(frame, really_m(frame))
    swap = next(one for one in swaps(seen) if one.pair == ("a1", "a3"))
    law = with_constants(swap.expression, swap.fitted(seen).constants)
    spots = scene(frame, "recorded")
    plain, put = (Simulator(Base(), effects).observe(spots, cir=False) for effects in ((), (law,)))
    assert put.range_m - plain.range_m == pytest.approx(really_m(frame), abs=1e-6)


def test_anchors_at_one_end_are_swapped_at_that_end() -> None:
    frame = rows(np.random.default_rng(7))
    best = proposed(frame).best
    assert isinstance(best.structure, Swap)
    assert best.structure.words({}) == "devices a1 and a3 (rx) are swapped"
    assert best.structure.choices == 15  # of six anchors two; tags walk


def test_a_name_with_one_place_at_each_end_is_that_of_two_devices() -> None:
    """Tags 0 to 2 and anchors 0 to 5: an anchor is swapped with an anchor."""
    frame = rows(np.random.default_rng(7), places=3)
    spot = frame["link"].str[1].to_numpy()
    frame = frame.assign(tx=spot, rx=frame["rx"].str[1:])
    found = still(given(frame, np.zeros(len(frame))))
    assert [(one.name, one.ends) for one in found] == [
        *((name, (end,)) for name in "012" for end in ENDS),
        *((name, ("rx",)) for name in "345"),
    ]
    assert all(isinstance(one, Still) for one in found)
    pairs = {one.pair for one in swaps(given(frame, np.zeros(len(frame))))}
    assert ("0", "5") in pairs
    assert not any(one == two for one, two in pairs)


def test_only_one_end_may_have_names() -> None:
    frame = rows(np.random.default_rng(7)).drop(columns="tx")
    seen = given(frame, np.zeros(len(frame)))
    assert all(np.isfinite(one.shift_m(seen, ())).all() for one in swaps(seen))
    assert len(list(swaps(seen))) == 15
