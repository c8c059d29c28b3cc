"""The rows that laws are looked for in, and the law that they speak for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.law.material import BEHIND, NO_SIGHT, Material, material
from bench.discrepancy.law.rounding import rounds_alike
from bench.discrepancy.law.search import Proposal, propose
from bench.discrepancy.law.settings import LAW_MEMBERS
from bench.discrepancy.select.state import Search
from bench.physics.materials import is_listed

OBSTACLES, SIGHT, CONSTANT = "obstacles", "los", "constant"


def gathered(
    comparison: Comparison, views: tuple[View, ...], added: Added, like: Material | None = None
) -> Material | None:
    """Return recorded - simulated ranges of all rows of views, None where ranges are not known.

    `like`: see `material`.
    """
    made = [one for view in views if (one := residual_range(comparison, view, added, LAW_MEMBERS))]
    if len(made) < len(views):
        return None
    frame = pd.concat([view.frame for view in views], ignore_index=True)
    residual = np.concatenate([left for _, left in made])
    rows = material(frame, residual, np.concatenate([view.links for view in views]), like)
    bears = any(type(one).marked for one in added)
    return replace(rows, rounded=bears or rounds_alike(comparison, rows))


def proposed(search: Search, rows: Material | None) -> Proposal | None:
    """Return the law that rows speak for, None where the library has effects for all such laws.

    What holds only behind something in the way is a delay or a detour by it, whatever its form. A
    constant behind what the library does not list is said: a rack is more than its metal.
    """
    law = None if rows is None else propose(rows, search.seed)
    if law is None or not law.best.structure.where.startswith((BEHIND, NO_SIGHT)):
        return law
    of_kind = law.best.structure.where.removeprefix(BEHIND)
    if law.best.structure.form == CONSTANT and of_kind != law.best.structure.where:
        return None if is_listed(of_kind) else law
    column = SIGHT if law.best.structure.where.startswith(NO_SIGHT) else OBSTACLES
    ways = [way for kind in search.kinds.values() for way in kind.needs]
    return None if any(column in way for way in ways) else law
