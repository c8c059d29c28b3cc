"""An error that follows the level, over levels as links have them where those tell it better.

A receiver's reading scatters from row to row, and a bias goes by what arrives, not by what is read:
over readings it is blurred, and a law of the distance, which the level follows, would take its
place (errors in variables: Fuller 1987). The mean reading of a link scatters less.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.beside_level import with_levels_of_links
from bench.discrepancy.compare.view import View
from bench.discrepancy.sets.blocks import Blocks, Kinds, kept_rows, of_library
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.settings import STEADIER_NATS


def over_steadier_levels(
    evidence: Evidence, kinds: Kinds, rows: View, known: NDArray[np.intp]
) -> Blocks:
    """Return parts [n, k] over mean levels of links, by the names that are likelier by these."""
    follow = {name: kind for name, kind in kinds.items() if kind.follows and name == kind.name}
    if not follow:
        return {}
    made = kept_rows(of_library(follow, with_levels_of_links(rows)), known)
    other = evidence.with_blocks(evidence.blocks | made)
    return {
        name: made[name]
        for name in follow
        if name in made and other.of((name,)).nats > evidence.of((name,)).nats + STEADIER_NATS
    }
