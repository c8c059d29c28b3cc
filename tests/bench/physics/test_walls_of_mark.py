"""Forms that a mark of mirrored paths leaves open: nobody lists what walls are of."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.effects.propagation import specular
from bench.physics.effects.propagation.specular import MARKED_WALLS, SpecularReflections
from bench.physics.materials import material, reflection


def test_walls_of_both_kinds_are_tried_where_they_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(specular, "mirrored", lambda frame: True)
    forms = [vars(one) for one in SpecularReflections.by_mark(pd.DataFrame())]
    assert {one["walls"] for one in forms} == {one["ceiling"] for one in forms} == {*MARKED_WALLS}


def test_the_kinds_differ_over_the_angle_and_not_in_size_alone() -> None:
    """A conductor reflects alike what meets it squarely and what grazes it; a board does not."""
    angle = np.radians([0.0, 80.0])
    every = (reflection(material(kind).permittivity(6.5), angle) for kind in MARKED_WALLS)
    board, conductor = (float(abs(one[1]) / abs(one[0])) for one in every)
    assert conductor < 1.1
    assert board > 2
