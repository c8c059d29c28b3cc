"""Positions from ranges to known anchors, by Gauss-Newton and by robust least squares."""

from bench.positioning.geometry import DegenerateGeometryError, check_anchors, dilution_of_precision
from bench.positioning.solve import Fixes, gauss_newton, robust_least_squares

__all__ = [
    "DegenerateGeometryError",
    "Fixes",
    "check_anchors",
    "dilution_of_precision",
    "gauss_newton",
    "robust_least_squares",
]
