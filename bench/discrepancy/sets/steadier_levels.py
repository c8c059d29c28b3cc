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
from bench.discrepancy.sets.blocks import Blocks, Kinds, kept_rows
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.settings import STEADIER_NATS


def over_steadier_levels(
    evidence: Evidence, kinds: Kinds, rows: View, known: NDArray[np.intp]
) -> Blocks:
    """Return parts [n, k] over mean levels of links, by the names that are likelier by these."""
    scene = with_levels_of_links(rows).scene
    ways = {kind.name: kind.ways(scene) for kind in kinds.values() if kind.follows}
    made = kept_rows({name: block for name, block in ways.items() if block is not None}, known)
    other = evidence.with_blocks(evidence.blocks | made)
    return {
        name: block
        for name, block in made.items()
        if other.of((name,)).nats > evidence.of((name,)).nats + STEADIER_NATS
    }
