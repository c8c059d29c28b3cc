"""The rows a model takes, made from the recordings: blocks of columns, NaN where not known."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from zoo.inputs import COLUMNS, blocks_of

if TYPE_CHECKING:
    from bench.plugins import Plugin
    from bench.runner.material import Material
    from zoo.base import MitigationModel

Floats = NDArray[np.float32]


def rows_for(material: Material, reads: Collection[str]) -> Floats:
    """Return the rows float32 [n, width] of a model that reads this, laid out as `zoo.inputs` says.

    Where the table has nothing of it, a row is its range alone, so that there is one to predict.
    """
    names = blocks_of(reads)
    if names == ("cir",) and material.cirs.shape[1]:
        return material.cirs
    blocks = [_block(material, name) for name in names]
    rows = np.concatenate([*blocks, np.empty((len(material.errors_m), 0))], 1, dtype=np.float32)
    return rows if rows.shape[1] else _block(material, "range")


def widths(models: Iterable[Plugin], material: Material) -> dict[str, int]:
    """Return how many columns a row of each model has, by name; models that cannot be fed apart."""
    found = {plugin.name: plugin.load() for plugin in models}
    fed = {name: model for name, model in found.items() if missing(material, model) is None}
    return {name: rows_for(material, _reads(model)).shape[1] for name, model in fed.items()}


def missing(material: Material, model: type[MitigationModel]) -> str | None:
    """Return why the recordings cannot feed a model, or None."""
    needed = set(_reads(model)) - set(getattr(model, "does_without", ()))
    absent = [name for name in blocks_of(needed) if not _known(material, name)]
    unknown = [_described(name) for name in absent] or _unknown(material, model)
    if not unknown:
        return None
    what = " and ".join(unknown)
    return f"{material.name} has no {what}, which {model.__name__} reads"


def _unknown(material: Material, model: type[MitigationModel]) -> list[str]:
    """Return which columns no row knows of those that a model cannot do without."""
    columns: tuple[str, ...] = getattr(model, "needs_columns", ())
    frame = material.recordings.frame
    return [name for name in columns if not np.isfinite(_column(frame, name)).any()]


def _reads(model: type[MitigationModel]) -> tuple[str, ...]:
    """Return what a model reads: the CIR, where it does not say (a factory from elsewhere)."""
    reads: tuple[str, ...] = getattr(model, "reads", ("cir",))
    return reads


def _known(material: Material, name: str) -> bool:
    if name == "cir":
        return bool(material.cirs.shape[1])
    return bool(np.isfinite(_block(material, name)).any())


def _described(name: str) -> str:
    return "CIR" if name == "cir" else f"{name} ({', '.join(COLUMNS[name])})"


def _block(material: Material, name: str) -> Floats:
    if name == "cir":
        return material.cirs
    frame = material.recordings.frame
    return np.stack([_column(frame, column) for column in COLUMNS[name]], 1)


def _column(frame: pd.DataFrame, name: str) -> Floats:
    """Return a column [n], NaN where it is absent, unknown or infinite."""
    if name not in frame:
        return np.full(len(frame), np.nan, np.float32)
    values = pd.to_numeric(frame[name], errors="coerce").to_numpy(np.float32, na_value=np.nan)
    return np.where(np.isfinite(values), values, np.float32(np.nan))
