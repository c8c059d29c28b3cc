"""What a model may read beside the CIR, and how one row of an array holds it.

`X` stays one float32 array [n, width], so that cloning, cross-validation and pipelines work as for
any scikit-learn regressor. Its columns are blocks in the order of `ORDER`: the CIR takes what the
others leave, and those have fixed columns, NaN where a value is not known. The exported graph has
one input of each block's name.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

LEVELS = (
    "rx_power_dbm",
    "first_path_power_dbm",
    "noise_std",
    "preamble_count",
    "peak_ampl",
    "fp_ampl1",
    "fp_ampl2",
    "fp_ampl3",
)
"""Receive and first-path power (dBm), noise (counts), accumulated symbols, amplitudes (counts)."""
COLUMNS = {
    "levels": LEVELS,
    "range": ("range_m",),
    "settings": ("channel", "prf_mhz", "tx_power_dbm"),
}
"""The columns of the blocks beside `cir`, by the names of the recordings table."""
ORDER = ("cir", *COLUMNS)
READS = (*ORDER, "features")
"""What `MitigationModel.reads` may name; `features` are made from the CIR inside the graph."""


@dataclass(frozen=True)
class Input:
    """One named input of a graph: float32 [n, width]."""

    name: str
    width: int


def blocks_of(reads: Collection[str]) -> tuple[str, ...]:
    """Return the blocks of columns that hold what is read, in order; ValueError if unknown."""
    if unknown := set(reads) - set(READS):
        raise ValueError(f"reads {sorted(unknown)}: expected some of {', '.join(READS)}")
    wanted = {"cir" if name == "features" else name for name in reads}
    return tuple(name for name in ORDER if name in wanted)


def layout(reads: Collection[str], width: int) -> tuple[Input, ...]:
    """Return the inputs that rows of `width` hold, empty blocks left out.

    Raises ValueError where rows are narrower than the fixed blocks, or wider with no CIR to take
    the rest.

    >>> [(one.name, one.width) for one in layout(("cir", "levels", "range"), 166)]
    [('cir', 157), ('levels', 8), ('range', 1)]
    """
    names = blocks_of(reads)
    fixed = {name: len(COLUMNS[name]) for name in names if name != "cir"}
    rest = width - sum(fixed.values())
    if rest < 0 or (rest > 0 and "cir" not in names):
        wanted = ", ".join(f"{count} of {name}" for name, count in fixed.items())
        raise ValueError(f"n_features = {width}: rows need {wanted}; what is left is the CIR")
    found = [Input(name, fixed.get(name, rest)) for name in names]
    return tuple(one for one in found if one.width)
