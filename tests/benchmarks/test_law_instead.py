"""A law takes the place of names that do worse than it, and never of the truth."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from bench.discrepancy import Diagnosis, Options, diagnose
from bench.discrepancy.report.document import summary
from bench.discrepancy.select.verdict import Unknown
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.law import Law
from bench.recordings.open import read

sys.path.insert(0, str(Path(__file__).parents[1] / "bench" / "discrepancy" / "law"))
from unlisted import CASES, Case, tables

QUICK = Options(search_rows=400, fit_rows=200, observables=("error_m",), waveform=False)
KINDS = {"antenna-delay": AntennaDelay, "device-delay": DeviceDelay}


def diagnosed(case: Case) -> Diagnosis:
    """Return the diagnosis of 110 links of a case, with antenna delays as the whole library."""
    recorded, simulated = tables(case, 5, 2)
    some = np.random.default_rng(5).permutation(recorded["link"].unique())[:110]
    both = [read(t[t["link"].isin(some)].reset_index(drop=True)) for t in (recorded, simulated)]
    return diagnose(*both, QUICK, kinds=KINDS)


def test_swapped_anchors_are_no_delays_of_anchors() -> None:
    found = diagnosed(next(c for c in CASES if c.name == "anchors 0 and 1 swapped"))
    assert found.selection.names == ()
    assert isinstance(found.selection.verdicts[-1], Unknown)
    assert found.setup_fault is not None
    assert found.setup_fault.devices == ("a0", "a1")
    assert [type(effect) for effect in found.added] == [Law]
    assert "fault of the set-up: devices a0 and a1 (rx) are swapped" in found.headline
    said = summary(found)
    assert said["setup_fault"]["kind"] == said["law"]["form"] == "swap"


def test_delays_of_anchors_stay_delays() -> None:
    by = {f"a{i}": 0.05 * (i - 2) for i in range(6)}
    found = diagnosed(Case("delays", lambda f: f["rx"].map(by).to_numpy() + 0.1, (), (), {}))
    assert found.selection.names == (("antenna-delay",),)
    assert found.law is None
    assert found.setup_fault is None
