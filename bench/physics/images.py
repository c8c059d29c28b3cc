"""Image sources of a box-shaped room: where reflections come from, and how strong they are.

Allen and Berkley, J. Acoust. Soc. Am. 65 (1979) 943: mirroring an antenna in the six walls, again
and again, turns every reflection into a straight line from an image.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product

import numpy as np

from bench.physics.loops import Ints, compiled, image_rows, parts
from bench.physics.materials import material, reflection
from bench.physics.units import Complexes, Floats

_STEPS = 2000


@lru_cache(maxsize=8)
def orders(highest: int) -> Ints:
    """Return all images [Q, 3] of one to `highest` reflections: which image along x, y, z.

    Image m along an axis has |m| reflections on that axis's two walls.
    """
    steps = product(range(-highest, highest + 1), repeat=3)
    kept = [step for step in steps if 1 <= sum(map(abs, step)) <= highest]
    return np.array(sorted(kept, key=lambda step: sum(map(abs, step))), np.intp)


def image_paths(
    tx: Floats, rx: Floats, room: Floats, highest: int, walls: tuple[str, str, str], ghz: float
) -> tuple[Floats, Complexes]:
    """Return lengths [n, Q] in metres and reflection coefficients [n, Q] of all image paths.

    `tx`, `rx` [n, 3] are positions in a room [n, 3] with one corner at the origin; `walls` names
    the materials of side walls, floor and ceiling.
    """
    image = orders(highest)
    length = np.empty((len(tx), len(image)))
    factor = np.empty((len(tx), len(image)), np.complex64)
    tables = np.stack([parts(_table(name, ghz)[None, :])[0] for name in walls])
    ends = np.ascontiguousarray(np.column_stack([tx, rx, room]), np.float64)
    compiled(image_rows)(length, parts(factor), ends, image, floor_hits(image[:, 2]), tables)
    return length, factor


def floor_hits(image: Ints) -> Ints:
    """Return how often images along z meet the floor (z = 0); the ceiling has the rest."""
    count = np.abs(image)
    return np.where(image < 0, (count + 1) // 2, count // 2)


@lru_cache(maxsize=64)
def _table(name: str, ghz: float) -> Complexes:
    """Return a material's reflection coefficient at _STEPS + 1 cosines of incidence, 0 to 1."""
    angle = np.arccos(np.linspace(0, 1, _STEPS + 1))
    return reflection(material(name).permittivity(ghz), angle).astype(np.complex64)
