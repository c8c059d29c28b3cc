"""Makers of recordings and simulated tables that share no code with the library or each other.

Each family is a world of its own (geometry, radio, forms of every effect), written with numpy
alone, so that a diagnosis is proven on input its own generator did not make.
"""

from __future__ import annotations

from bench.challenge.families.case import FamilyCase, make

__all__ = ["FamilyCase", "make"]
