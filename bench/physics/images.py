"""Image sources of a box-shaped room: where reflections come from, and how strong they are.

Allen and Berkley, J. Acoust. Soc. Am. 65 (1979) 943: mirroring an antenna in the six walls, again
and again, turns every reflection into a straight line from an image.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bench.physics.materials import material, reflection
from bench.physics.units import Complexes, Floats

Ints = NDArray[np.intp]
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
    mirrored = np.where(image % 2 == 0, tx[:, None], -tx[:, None])
    source = mirrored + (image + image % 2) * room[:, None]
    way = source - rx[:, None]
    length = np.sqrt(np.einsum("nqa,nqa->nq", way, way))
    cosine = np.abs(way) / np.maximum(length, 1e-6)[:, :, None]
    return length, _coefficients(image, cosine, walls, ghz)


def _coefficients(
    image: Ints, cosine: Floats, walls: tuple[str, str, str], ghz: float
) -> Complexes:
    """Return the product of the Fresnel coefficients of all reflections of each image [n, Q]."""
    side, floor, ceiling = (_table(name, ghz) for name in walls)
    step = np.rint(cosine * _STEPS).astype(np.int16)
    total = np.ones(cosine.shape[:2], np.complex64)
    for at, counts in enumerate(np.abs(image)):
        for axis in (0, 1):
            if counts[axis]:
                total[:, at] *= side[step[:, at, axis]] ** int(counts[axis])
        if counts[2]:
            low, high = floor_ceiling(image[at, 2:])
            total[:, at] *= (floor ** int(low[0]) * ceiling ** int(high[0]))[step[:, at, 2]]
    return total


@lru_cache(maxsize=64)
def _table(name: str, ghz: float) -> Complexes:
    """Return a material's reflection coefficient at _STEPS + 1 cosines of incidence, 0 to 1."""
    angle = np.arccos(np.linspace(0, 1, _STEPS + 1))
    return reflection(material(name).permittivity(ghz), angle).astype(np.complex64)


def floor_ceiling(image: Ints) -> tuple[Ints, Ints]:
    """Return how often image `image` along z meets the floor (z = 0) and the ceiling."""
    count = np.abs(image)
    negative_first = (count + 1) // 2
    low = np.where(image < 0, negative_first, count // 2)
    return low, count - low
