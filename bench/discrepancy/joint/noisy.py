"""Whether what makes few devices' noise louder is noise: samples of a tone are alike, no noise's.

A log of noise tells how loud it is, and not of what. The samples before the path of these devices
do (see `quiet`): where they are steadier than with noise as loud as the log says, something else is
there, and all of the library that raises noise is tried for it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.data.device_rows import devices_of
from bench.discrepancy.joint.quiet import Quiet
from bench.discrepancy.joint.rows import fewer, taken
from bench.discrepancy.joint.settings import ROWS
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.select.state import Search
from bench.physics.effects.fitted.noise_of_devices import NoiseOfDevices
from bench.physics.effects.receiver.noise_floor import NoiseFloor


def without_steady(search: Search) -> Search:
    """Return the search without a noise floor of devices whose samples are no noise's."""
    noisy = next((one for one in search.logged if isinstance(one, NoiseOfDevices)), None)
    if noisy is None or not steady_at(search, noisy):
        return search
    logged = tuple(one for one in search.logged if one is not noisy)
    return replace(search, logged=logged, kinds={**search.kinds, NoiseFloor.name: NoiseFloor})


def steady_at(search: Search, noisy: NoiseOfDevices) -> bool:
    """Return whether samples of the devices are surely more alike than noise as loud is."""
    masks = devices_of(search.both.frame)
    theirs = np.any([masks[name] for name in noisy.devices], axis=0)
    rows = fewer(taken(search.both, np.flatnonzero(theirs)), ROWS)
    return Quiet(Statistics(search.comparison, rows)).steadier((noisy,))
