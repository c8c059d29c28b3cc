"""A plug-in effect with values per device gets what ours get: fitted, named, with intervals."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pandas as pd

from bench.discrepancy import Options, diagnose
from bench.discrepancy.select.verdict import LeftOut
from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_values import as_tuples, at_end
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.randomness import Draws
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings


@dataclass(frozen=True)
class DeviceScale(Effect):
    """Every transmitter has a scale of its own: error = scale x range."""

    name = "device-scale"
    fitted: ClassVar[bool] = False
    values_unit: ClassVar[str] = "mm/m"
    stage = "ranging"
    source = "none: a test"
    signature = "error proportional to range, per transmitter"

    devices: tuple[str, ...] = ()
    scale_mm_per_m: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        as_tuples(self, devices=None, scale_mm_per_m=len(self.devices))

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        scale = at_end(batch.rows, "tx", self.devices, self.scale_mm_per_m)
        return batch.longer(scale / 1000 * batch.rows.true_range_m)

    @classmethod
    def fit_values(cls, frame, residual_m):
        known = frame.assign(left=residual_m).dropna(subset="left")
        slope = {
            device: 1000 * (rows["left"] @ rows["true_range_m"]) / (rows["true_range_m"] ** 2).sum()
            for device, rows in known.groupby("tx")
        }
        return cls(tuple(slope), tuple(slope.values()))

    def values(self):
        return {f"scale[{d}]": s for d, s in zip(self.devices, self.scale_mm_per_m, strict=True)}


TRUTH = {"t0": 12.0, "t1": -8.0, "t2": 3.0}


def _recorded() -> Recordings:
    rng = np.random.default_rng(4)
    link = np.repeat(np.arange(48), 6)
    distance = rng.uniform(2, 20, 48)[link]
    tx = np.array([f"t{i % 3}" for i in link])
    error = np.vectorize(TRUTH.get)(tx) / 1000 * distance + rng.normal(0, 0.024, len(link))
    frame = pd.DataFrame({"link": [f"l{i}" for i in link], "true_range_m": distance, "tx": tx})
    frame = frame.assign(rx=[f"r{i % 4}" for i in link], error_m=error, range_m=distance + error)
    return Recordings(frame, "numpy")


def test_values_of_a_plug_in_are_fitted_named_and_have_intervals():
    base = Simulator(Base(), (TimestampJitter(),), 3, "mine")
    options = Options(search_rows=300, fit_rows=200, observables=("error_m",), waveform=False)
    found = diagnose(_recorded(), base, options, kinds={"device-scale": DeviceScale})
    first = found.selection.verdicts[0]
    assert "device-scale" in first.names
    option = first if isinstance(first, LeftOut) else first.options[0]
    seen = {p.name: p for p in option.parameters}
    assert set(seen) == {f"scale[{device}]" for device in TRUTH}
    assert all(p.unit == "mm/m" for p in seen.values())
    for device, true in TRUTH.items():
        one = seen[f"scale[{device}]"]
        assert 0.1 < one.high - one.low < 3.0
        assert abs(one.value - true) < one.high - one.low
    assert found.confirmed.mae_after_m.value < 0.6 * found.confirmed.mae_before_m.value


def test_a_plug_in_that_cannot_fit_its_values_is_skipped_and_named():
    @dataclass(frozen=True)
    class Broken(DeviceScale):
        name = "broken-scale"

        @classmethod
        def fit_values(cls, frame, residual_m):
            raise KeyError("no such column")

    base = Simulator(Base(), (TimestampJitter(),), 3, "mine")
    options = Options(search_rows=200, fit_rows=100, observables=("error_m",), waveform=False)
    found = diagnose(_recorded(), base, options, kinds={"broken-scale": Broken})
    assert "no such column" in found.selection.skipped["broken-scale"]


def test_what_an_effect_frees_is_what_it_holds():
    assert DeviceScale(("a", "b"), (1.0, 2.0)).freed == 2
    assert replace(TimestampJitter()).freed == 2
