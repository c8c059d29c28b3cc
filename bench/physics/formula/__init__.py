"""Expressions that are data: parsed by an allow-list, units checked, evaluated on arrays.

Nothing of a text is ever run as code: `parse.walk` knows every construct that may occur, and three
readings of it are in `algebras.py` (numbers) and `symbolic.py` (units, and sympy to be read).
"""
