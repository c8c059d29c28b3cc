"""What effects that are named may do to ranges in other forms than the library's."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.residual_range import moved_m
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.sets.blocks import deformed, off_by
from bench.discrepancy.settings import RESIDUAL_MEMBERS
from bench.physics.effect import Effect
from bench.physics.units import Floats


def forms_of_names(search: Search, found: Selection, views: tuple[View, ...]) -> Floats:
    """Return the forms [n, k], in metres, of the rows of views one after the other.

    Every effect that is named and shifts ranges as such is of another size over covariates and
    devices, of another curve, and off by a constant. Scatter and marks have no form.
    """
    names = {name for verdict in found.verdicts for name in verdict.names}
    shifting = [one for one in found.added if one.physics in names and one.stage == "ranging"]
    able = [e for e in shifting if not (type(e).independent or type(e).marked)]
    every = [_forms(search, views, found.added, effect) for effect in able]
    return np.hstack(every) if every else np.zeros((sum(len(v.rows) for v in views), 0))


def _forms(search: Search, views: tuple[View, ...], added: Added, effect: Effect) -> Floats:
    """Return the forms of one effect [n, k], in metres."""
    parts: list[Floats] = []
    for rows in views:
        shift = moved_m(search.comparison, rows, added, effect, RESIDUAL_MEMBERS)
        kind = type(effect)
        made = (shift[:, None], deformed(shift, rows, kind), off_by(shift, rows, kind))
        parts.append(np.hstack(made))
    return np.concatenate(parts)
