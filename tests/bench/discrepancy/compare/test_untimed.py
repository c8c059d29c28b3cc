"""Effects that leave ranges alone change waveforms and nothing else; others change both."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.untimed import Untimed, untimed
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.receiver.pulse_ringing import PulseRinging

LINKS = np.arange(4)
RINGING, SCALE = PulseRinging(ring_db=-10.0), RangeScale()


class Shifting:
    """A comparison in which every effect shifts ranges and levels of simulated rows by 1."""

    def ensemble(self, *asked: object) -> Ensemble:
        added = asked[1]
        versions = np.zeros((3, len(LINKS), 2))
        versions[1:] += len(added)  # type: ignore[arg-type]
        return Ensemble(("rx_power_dbm", "error_m"), ("dB", "m"), versions, LINKS)


def test_ranges_stay_as_they_are_without_what_leaves_them_alone() -> None:
    apart = Untimed(Shifting(), (RINGING.name,))  # type: ignore[arg-type]
    made = apart.ensemble(None, (RINGING, SCALE), 2)  # type: ignore[arg-type]
    assert (made.simulated_of("rx_power_dbm") == 2).all()
    assert (made.simulated_of("error_m") == 1).all()
    assert (made.recorded == 0).all()


def test_nothing_to_leave_alone_is_the_comparison_itself() -> None:
    plain = Shifting()
    assert untimed(plain, ()) is plain  # type: ignore[arg-type, comparison-overlap]
