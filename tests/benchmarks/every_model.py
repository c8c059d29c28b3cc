"""The models of the zoo, fitted in a moment, and the rows they read."""

from __future__ import annotations

import sys
from inspect import signature
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "zoo"))
from blocks import CIR, made_up_blocks

from bench.plugins import find, plugins
from zoo.base import MitigationModel
from zoo.inputs import ORDER, blocks_of

ROWS = made_up_blocks(240, seed=1)
TEST = made_up_blocks(100, seed=2)[0]
MODELS = [one.name for one in plugins("models")]
QUICKLY = {"epochs": 2, "most_steps": 30, "trees": 20, "points": 40}
_COLUMNS = {"cir": range(CIR), "levels": range(CIR, CIR + 8), "range": [CIR + 8]}


def columns_of(name: str) -> list[int]:
    """Return which columns of the rows a model reads."""
    reads = blocks_of(find("models", name).load().reads)
    return [column for block in ORDER if block in reads for column in _COLUMNS[block]]


def fit(name: str) -> MitigationModel:
    """Return a model, fitted briefly."""
    kind = find("models", name).load()
    taken = signature(kind).parameters
    model: MitigationModel = kind(**{key: n for key, n in QUICKLY.items() if key in taken})
    X, y, links = ROWS
    return model.fit(X[:, columns_of(name)], y, groups=links)
