"""A device of one link has no delay of its own: it would be all that the link has by itself."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.per_device import device_delay
from bench.discrepancy.sets.blocks import of_library
from bench.physics.units import C_M_PER_NS

LINKS, EACH, LATE_M = 24, 5, 0.3


def test_anchors_have_delays_and_tags_of_one_place_have_none() -> None:
    rng = np.random.default_rng(2)
    link = np.repeat(np.arange(LINKS), EACH)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in link], "tx": [f"a{i % 3}" for i in link],
            "rx": [f"t{i}" for i in link], "true_range_m": 5.0 + link / 10,
        }
    )  # fmt: skip
    offset_m = np.where(link % 3 == 0, LATE_M, 0.0) + rng.normal(0, 0.2, LINKS)[link]
    error_m = offset_m + rng.normal(0, 0.02, len(link))
    frame = frame.assign(error_m=error_m, range_m=frame["true_range_m"] + error_m)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("error_m",), False)
    found = device_delay(rows, error_m)
    assert found is not None
    delays = dict(zip(found.devices, found.delays_ns, strict=True))
    assert {name for name, one in delays.items() if one} <= {"a0", "a1", "a2"}
    apart_m = (delays["a0"] - (delays["a1"] + delays["a2"]) / 2) * C_M_PER_NS / 2
    assert abs(apart_m - LATE_M) < 0.2
    assert of_library({}, rows)["antenna-delay"][1].shape == (len(frame), 3)
