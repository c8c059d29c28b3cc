"""Four indoor sites, six channels, CIRs and positions (Bregar 2023).

"Indoor UWB positioning and position tracking data set", Zenodo 10.5281/zenodo.7629141; DWM1000
radios, eight anchors, a tag at the points of a walking path. Per site `locationN/data.json`:
`{path: [{x, y, z, name}], anchors: [A1, ..], channels: [ch1, ..], measurements: {POINT: {ANCHOR:
{CHANNEL: [measurement, ..]}}}}`, a measurement being a dict of `x_tag` .. `z_anchor` (m), `nlos`
(1 = NLOS), `range` (m), `fp_index` (samples), `rss` and `rss_fp` (dBm), `fp_point1..3`,
`stdev_noise`, `cir_power`, `rxpacc`, `channel_number` and `cir`, complex numbers as text.

- `true_range_m` = the distance between the two positions; `environment` = the site's folder.
- `link` = site, point and anchor: the six channels of one pair of positions are one link.
- Anchor A6 of location2 is left out and counted: its position was not right, says the publisher's
  own code, which leaves it out too.

UNTESTED on a real file: written by the publisher's code (github.com/KlemenBr/uwb_positioning).
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.clean import Cleaned, add_counts, clean
from bench.recordings.table import SAMPLE_PERIOD_NS

WRONG_ANCHOR = ("location2", "A6")
LEFT_OUT = "anchor A6 of location2 (position not right)"
MODULES = (__name__, "bench.recordings.clean")
_NUMBERS = {
    "range": "range_m",
    "fp_index": "first_path_index",
    "rss": "rx_power_dbm",
    "rss_fp": "first_path_power_dbm",
    "stdev_noise": "noise_std",
    "rxpacc": "preamble_count",
    "cir_power": "cir_power",
    "fp_point1": "fp_ampl1",
    "fp_point2": "fp_ampl2",
    "fp_point3": "fp_ampl3",
    "max_noise": "max_noise",
    "channel_number": "channel",
    "x_tag": "tx_x_m",
    "y_tag": "tx_y_m",
    "z_tag": "tx_z_m",
    "x_anchor": "rx_x_m",
    "y_anchor": "rx_y_m",
    "z_anchor": "rx_z_m",
}


def read_bregar(files: list[Path]) -> Cleaned:
    """Return the rows of some sites' data.json (environment: the folder each stands in).

    Raises BenchError where a file has another form.
    """
    frames, dropped = [], dict[str, int]()
    for path in files:
        rows = list(_rows(path))
        kept = [row for row in rows if (row["environment"], row["rx"]) != WRONG_ANCHOR]
        if len(rows) > len(kept):
            dropped = add_counts(dropped, {LEFT_OUT: len(rows) - len(kept)})
        frames.append(pd.DataFrame(kept))
    frame = pd.concat(frames, ignore_index=True)
    ends = [frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy() for end in ("tx", "rx")]
    distance_m = np.linalg.norm(ends[0] - ends[1], axis=1)
    cleaned = clean(frame.assign(true_range_m=distance_m), "bregar")
    return Cleaned(cleaned.frame, add_counts(dropped, cleaned.dropped))


def _rows(path: Path) -> Iterator[dict[str, Any]]:
    """Yield every measurement of a site. Raises BenchError where the form is another."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        measurements: Mapping[str, Any] = content["measurements"]
        site = path.parent.name
        for point, anchors in measurements.items():
            for anchor, channels in anchors.items():
                for found in (one for several in channels.values() for one in several):
                    yield _row(found, site, point, anchor)
    except KeyError as problem:
        raise BenchError(f"{path}: no {problem} where expected; not as published") from problem
    except (OSError, ValueError, AttributeError, TypeError) as problem:
        raise BenchError(f"{path}: not as published: {problem}") from problem


def _row(found: Mapping[str, Any], site: str, point: str, anchor: str) -> dict[str, Any]:
    """Return one measurement in the exchange format."""
    parts = _complex(found["cir"])
    return {
        "environment": site,
        "link": f"{site} {point} {anchor}",
        "tx": "tag",
        "rx": anchor,
        "los": float(found["nlos"]) == 0,
        "sample_period_ns": SAMPLE_PERIOD_NS,
        **{ours: float(found[theirs]) for theirs, ours in _NUMBERS.items()},
        "cir_i": parts.real.astype(np.float32),
        "cir_q": parts.imag.astype(np.float32),
    }


def _complex(cells: Any) -> NDArray[np.complex128]:
    """Return complex numbers written as text, such as (12-3j)."""
    return np.array([complex(str(cell).replace(" ", "")) for cell in cells], np.complex128)
