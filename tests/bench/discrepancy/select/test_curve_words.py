"""What has no name is said in words."""

from __future__ import annotations

from bench.discrepancy.select.unnamed import curve_words
from bench.physics.effects.fitted.unnamed import Unnamed
from bench.physics.effects.ranging.antenna_delay import AntennaDelay


def test_a_curve_without_a_name_is_said() -> None:
    curve = Unnamed("load_t", (0.0, 2.0, 9.0), (0.0, 0.12, 0.3), 0.02)
    said = curve_words((AntennaDelay(delay_ns=1.0), curve))
    assert "smooth curve of 0 to 0.3 m over load_t, scatter 0.02 m" in said
    assert "constant 0.1 m; no" in curve_words((Unnamed("load_t", (0.0, 1.0), (0.1, 0.1)),))
    near = Unnamed("rx_z_m", (1.0, 2.0), (0.095, 0.109))
    assert "constant 0.102 m; no" in curve_words((near,))
    assert curve_words((AntennaDelay(delay_ns=1.0),)) == ""
