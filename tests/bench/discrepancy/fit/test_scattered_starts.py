"""An effect without an amplitude is tried all over its bounds, or a fit ends where it began."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.fit.starts import starts
from bench.physics.effects.propagation.diffraction import Diffraction


def test_points_are_spread_into_every_corner() -> None:
    """A wide body whose edges send more takes as much of a level as a narrow one, and is later."""
    points = starts(Diffraction, True, True)
    strong, wide = (
        np.array([point[name] for point in points]) for name in ("strength_db", "body_half_width_m")
    )
    assert np.sum((strong > 5) & (wide > 1)) >= 3
    assert np.sum((strong < -10) & (wide < 0.5)) >= 3
    assert len(starts(Diffraction, False, True)) < len(points) / 4  # waveforms cost more
