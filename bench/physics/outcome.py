"""What a simulated receiver reports, as arrays and as columns of the recordings table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import pandas as pd

from bench.physics.base import Base, there
from bench.physics.batch import Batch
from bench.physics.units import Complexes, Floats, Reals


@dataclass(frozen=True)
class Outcome:
    """n simulated rows: ranges in metres, CIR [n, K] in counts (None without a waveform).

    `first_path_index` is in samples from the row's first CIR value. `clock_offset_ppm` is None
    where no effect set it.
    """

    true_range_m: Floats
    range_m: Floats
    rx_power_dbm: Floats
    first_path_power_dbm: Floats
    noise_std: Floats
    preamble_count: Floats
    cir: Reals | None = None
    cir_complex: Complexes | None = None
    first_path_index: Floats | None = None
    clock_offset_ppm: Floats | None = None
    sample_period_ns: float = 1.0016

    def __len__(self) -> int:
        return len(self.range_m)

    @property
    def error_m(self) -> Floats:
        """Measured minus true range [n] in metres."""
        return self.range_m - self.true_range_m

    def table(self, geometry: pd.DataFrame) -> pd.DataFrame:
        """Return the geometry's columns with the simulated ones in their place."""
        made: dict[str, object] = {
            name: getattr(self, name) for name in _COLUMNS if getattr(self, name) is not None
        }
        made |= {"error_m": self.error_m, "sample_period_ns": self.sample_period_ns}
        if self.cir is not None:
            made["cir"] = list(self.cir)
        if self.cir_complex is not None:
            made["cir_i"] = list(np.ascontiguousarray(self.cir_complex.real))
            made["cir_q"] = list(np.ascontiguousarray(self.cir_complex.imag))
        kept = geometry.drop(columns=[*_SIMULATED, *made], errors="ignore")
        return pd.concat([kept.reset_index(drop=True), pd.DataFrame(made)], axis=1)


_COLUMNS = (
    "range_m",
    "true_range_m",
    "rx_power_dbm",
    "first_path_power_dbm",
    "noise_std",
    "preamble_count",
    "first_path_index",
    "clock_offset_ppm",
)
_SIMULATED = ("cir", "cir_i", "cir_q", "error_m", "range_m", "first_path_index")


def outcome(batch: Batch, base: Base, *, complex_cir: bool = False) -> Outcome:
    """Return what the chip reports of a detected batch, the complex CIR too if asked for."""
    crop = base.cropped(batch)
    cir, index = crop if crop is not None else (None, None)
    return Outcome(
        true_range_m=batch.rows.true_range_m,
        range_m=there(batch.range_m),
        rx_power_dbm=there(batch.rx_power_dbm),
        first_path_power_dbm=there(batch.first_path_power_dbm),
        noise_std=there(batch.noise_std),
        preamble_count=there(batch.symbols),
        cir=cir,
        cir_complex=base.cropped_complex(batch) if complex_cir else None,
        first_path_index=index,
        clock_offset_ppm=batch.clock_offset_ppm,
        sample_period_ns=batch.sample_period_ns,
    )


def joined(parts: Sequence[Outcome]) -> Outcome:
    """Return the rows of several outcomes as one."""
    columns: dict[str, Any] = {}
    for item in fields(Outcome):
        values = [getattr(part, item.name) for part in parts]
        array = isinstance(values[0], np.ndarray)
        columns[item.name] = np.concatenate(values) if array else values[0]
    return Outcome(**columns)
