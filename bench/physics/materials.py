"""What obstacles are made of, and what a slab does to a wave.

Electrical properties: ITU-R P.2040-3 (2023), table 3: eps_r = a f^b, sigma = c f^d S/m, f in GHz.
Slab formulas: the same recommendation, section 2.2.2, single pass (no multiple reflections).
"""

from __future__ import annotations

from dataclasses import dataclass
from re import findall

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError, unknown_name
from bench.physics.units import C_M_PER_NS, Floats, decibel

Complex = NDArray[np.complex128]
MAX_LOSS_DB = 60.0  # no slab isolates better in a room: the rest leaks around and through joints


# Thickness in metres where none is recorded (assumed: usual building practice).
TYPICAL_M = {
    "concrete": 0.2,
    "brick": 0.14,
    "plasterboard": 0.025,
    "wood": 0.04,
    "glass": 0.008,
    "ceiling board": 0.015,
    "chipboard": 0.03,
    "plywood": 0.015,
    "marble": 0.02,
    "metal": 0.003,
    "plastic": 0.01,
    "foam": 0.06,
    "cardboard": 0.02,
}


@dataclass(frozen=True)
class Material:
    """Relative permittivity a f^b and conductivity c f^d in S/m, f in GHz."""

    a: float
    b: float
    c: float
    d: float

    def permittivity(self, centre_ghz: float) -> complex:
        """Return the complex relative permittivity at a frequency in GHz."""
        conductivity = self.c * centre_ghz**self.d
        return complex(self.a * centre_ghz**self.b, -17.98 * conductivity / centre_ghz)


BODIES = frozenset({
    "person", "people", "human", "body", "bodie", "man", "men", "woman", "women", "child",
    "children", "pedestrian", "worker", "visitor", "spectator", "audience", "crowd",
})  # fmt: skip
"""Words for people, without the s of many."""
BUILT = frozenset({
    "wall", "floor", "ceiling", "roof", "slab", "door", "window", "partition", "panel", "pane",
    "board", "plate", "sheet", "facade", "cladding", "plaster", "curtain", "screen", "gate",
    "shutter", "blind", "hedge",
})  # fmt: skip
"""Words for what is built or hung in the whole of a way, without the s of many."""
WATER = Material(99.0, -0.19, 0.31, 1.79)
"""Fresh water of 20 degrees between 3 and 10 GHz: Debye's law, relaxing at 17.1 GHz [P.527-6]."""


@dataclass(frozen=True)
class Obstacle:
    """An obstacle kind: its material and a typical thickness of that material in metres."""

    material: str
    thickness_m: float


def material(name: str) -> Material:
    """Return a material by name. Raises BenchError with a did-you-mean."""
    known = _materials()
    if not isinstance(name, str):
        raise BenchError(f"{name!r}: expected a material, such as 'concrete'")
    if name not in known:
        raise unknown_name("material", name, known)
    return known[name]


def is_listed(kind: str) -> bool:
    """Return whether an obstacle kind is known as it is named, not by a word in its name."""
    return kind in _obstacles() or kind.casefold() in _materials()


def obstacle(kind: str) -> Obstacle:
    """Return what an obstacle kind is made of: by its name, or by the material it names.

    "brick wall" is of brick, "concrete" of concrete; of what names no material, a chipboard panel.
    """
    if kind in _obstacles():
        return _obstacles()[kind]
    words = kind.casefold()
    by_length = sorted(TYPICAL_M, key=len, reverse=True)  # "plywood" before "wood"
    named = next((name for name in by_length if name in words), "chipboard")
    return Obstacle(named, TYPICAL_M[named])


def is_opaque(kind: str) -> bool:
    """Return whether nothing goes through an obstacle of a kind: of metal, or somebody's body.

    Bodies take 30 dB and more; what is received came around them (ITU-R P.526-15, section 4.1).
    """
    return obstacle(kind).material == "metal" or bool(_words(kind) & BODIES)


def is_object(kind: str) -> bool:
    """Return whether an obstacle's name tells neither a material nor a part of a building.

    Nobody knows then whether waves go through or around it: a crate, a rack, a cabinet.
    """
    named = is_listed(kind) or any(name in kind.casefold() for name in TYPICAL_M)
    return not (named or is_opaque(kind) or _words(kind) & BUILT)


def _words(kind: str) -> set[str]:
    """Return the words of an obstacle's name, without the s of many."""
    return {word.removesuffix("s") for word in findall("[a-z]+", kind.casefold())}


def excess_m(thickness_m: Floats, permittivity: complex, incidence_rad: Floats) -> Floats:
    """Return the excess path of a wave through a slab: t (sqrt(eps - sin^2) - cos), metres."""
    real = max(permittivity.real, 1.0)
    inside = np.sqrt(real - np.sin(incidence_rad) ** 2)
    return np.asarray(thickness_m * (inside - np.cos(incidence_rad)))


def loss_db(
    thickness_m: Floats, permittivity: complex, incidence_rad: Floats, centre_ghz: float
) -> Floats:
    """Return the transmission loss of a slab in dB, both interfaces and the way between them."""
    cosine = np.cos(incidence_rad)
    inside = np.sqrt(permittivity - np.sin(incidence_rad) ** 2 + 0j)
    through = 4 * cosine * inside / (cosine + inside) ** 2
    path = 2 * np.pi * centre_ghz / C_M_PER_NS * np.asarray(thickness_m)
    decay = np.exp(np.maximum(path * inside.imag, -20.0))
    loss = -decibel(np.abs(through * decay) ** 2)
    return np.asarray(np.clip(np.where(np.asarray(thickness_m) > 0, loss, 0.0), 0, MAX_LOSS_DB))


def reflection(permittivity: complex, incidence_rad: Floats) -> Complex:
    """Return the Fresnel reflection coefficient, electric field normal to the plane of incidence.

    At normal incidence: concrete -8 dB, glass -7 dB, plasterboard -12 dB.
    """
    cosine = np.cos(incidence_rad)
    inside = np.sqrt(permittivity - np.sin(incidence_rad) ** 2 + 0j)
    return np.asarray((cosine - inside) / (cosine + inside))


def upright_reflection(permittivity: complex, incidence_rad: Floats) -> Complex:
    """Return the Fresnel coefficient of a field within the plane of incidence: of upright antennas.

    -1 at grazing incidence, as `reflection`; from Brewster's angle on it is turned around.
    """
    cosine = np.cos(incidence_rad)
    inside = np.sqrt(permittivity - np.sin(incidence_rad) ** 2 + 0j)
    return np.asarray((permittivity * cosine - inside) / (permittivity * cosine + inside))


def _materials() -> dict[str, Material]:
    """Return table 3 of ITU-R P.2040-3; plastic and foam are handbook values, not the table's."""
    return {
        "concrete": Material(5.24, 0, 0.0462, 0.7822),
        "brick": Material(3.91, 0, 0.0238, 0.16),
        "plasterboard": Material(2.73, 0, 0.0085, 0.9395),
        "wood": Material(1.99, 0, 0.0047, 1.0718),
        "glass": Material(6.31, 0, 0.0036, 1.3394),
        "ceiling board": Material(1.48, 0, 0.0011, 1.075),
        "chipboard": Material(2.58, 0, 0.0217, 0.78),
        "plywood": Material(2.71, 0, 0.33, 0),
        "marble": Material(7.074, 0, 0.0055, 0.9262),
        "metal": Material(1.0, 0, 1e7, 0),
        "plastic": Material(2.55, 0, 0.003, 1.0),
        "foam": Material(1.05, 0, 0.0002, 1.0),
        "cardboard": Material(1.6, 0, 0.006, 1.0),
    }


def _obstacles() -> dict[str, Obstacle]:
    """Return the ten obstacle kinds of the Deep UWB dataset (Zenodo 10.5281/zenodo.4290069)."""
    return {
        "wall": Obstacle("brick", 0.14),
        "polystyrene plate": Obstacle("foam", 0.06),
        "plastic": Obstacle("plastic", 0.01),
        "plywood plate": Obstacle("plywood", 0.015),
        "cardboard box": Obstacle("cardboard", 0.02),
        "LCD TV": Obstacle("metal", 0.002),
        "metal plate": Obstacle("metal", 0.003),
        "wood door": Obstacle("wood", 0.04),
        "glass plate": Obstacle("glass", 0.008),
        "metal window": Obstacle("metal", 0.002),
    }
