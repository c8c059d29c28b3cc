"""What the watermill's hoppers do amiss with late parts: what they are said to do."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.watermill_hopper import (
    AHEAD,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_SAMPLES,
    Hopper,
    grains,
    trundling,
)
from bench.challenge.families.watermill_oddities import (
    DEEP,
    FOLDS,
    HUM,
    LATE,
    LEAKS,
    ODDITIES,
    ROOT,
    SOAKS,
    bridged,
    crested,
    folded,
    from_amid,
    hummed,
    leaked,
    rooted,
    woven,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "watermill")


def _waves() -> Any:
    top = 60 + np.random.default_rng(3).random(40)
    wave = 4000.0 * grains(top) + 60.0 * trundling(np.random.default_rng(4), 40)
    rows = _known().head(40).assign(
        range_m=10.0, error_m=0.0, rx_power_dbm=-80.0, first_path_power_dbm=-82.0,
        noise_std=60.0 * OF_SIZES, preamble_count=300.0, first_path_index=top - AHEAD,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip
    return rows.assign(true_range_m=10.0)


def _hopper(period_ns: float = SAMPLE_NS) -> Hopper:
    return Hopper(_waves().assign(sample_period_ns=period_ns), 0, np.random.default_rng(0))


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    some = np.arange(26.0)
    assert woven(some)[:12].tolist() == [0, 6, 1, 7, 2, 8, 3, 9, 4, 10, 5, 11]
    assert woven(some)[24:].tolist() == [24, 25]
    assert from_amid(some)[:10].tolist() == [4, 3, 5, 2, 6, 1, 7, 0, 8, 13]
    assert bridged(some).tolist() == some.tolist()
    assert bridged(some**2)[5:8].tolist() == [26.0, 36.0, 50.0]
    falling = np.exp(-np.arange(100.0) / 20)
    flat = rooted(falling)
    assert flat.mean() == pytest.approx(falling.mean())
    assert flat[80] / flat[20] == pytest.approx((falling[80] / falling[20]) ** ROOT)
    store = leaked(np.array([1.0, 0.0, 0.0]))
    assert np.allclose(store, [1.0, LEAKS, LEAKS**2])
    crests = crested(np.array([1.0, 5.0, 2.0, 1.0, 1.0, 1.0]))
    assert np.allclose(crests / crests[0], [1, 1, 1, 0.4, 0.2, 0.2])
    hum = hummed(np.ones(60))
    assert hum.max() == pytest.approx(1 + DEEP, rel=0.01)
    assert np.allclose(hum[15:30], hum[:15])
    assert HUM == 15.0
    under = folded(np.array([0.5, 1.0, 1.0, 1.0, 2.0, 9.0]))
    assert under.max() <= FOLDS
    assert np.allclose(under[:5], [0.5, 1.0, 1.0, 1.0, 2 * FOLDS - 2.0])


def test_chaff_soaks_up_more_the_later_and_shafts_repeat() -> None:
    hopper = _hopper()
    hopper.sigma *= 0.0
    before = hopper.wave.copy()
    ODDITIES["chaff-soaks-up-what-comes-late"](hopper, 1.0)
    at = np.arange(WIDE_SAMPLES) - hopper.at[:, None] - LATE
    lost = np.log(np.abs(hopper.wave) / np.abs(before))
    there = (at > 3.0) & (at < 50.0)
    assert np.allclose(lost[there], -at[there] / SOAKS)
    assert np.allclose(lost[at < 0], 0.0)
    again = _hopper()
    again.repeat(again.plain, np.full(again.rows, 0.5), np.full(again.rows, 20.0))
    before = np.abs(again.wave)
    ODDITIES["hollow-shaft-repeats-what-comes-late"](again, 1.0)
    late = np.abs(again.wave[:, 85:89]).max(axis=1)
    assert (late > 300.0).mean() > 0.9
    assert np.abs(np.abs(again.wave) - before)[:, :60].max() < 1.0
