"""Why a measurement is worth making: what each explanation predicts there, in words."""

from __future__ import annotations

import numpy as np

from bench.planning.outlook import Outlook
from bench.planning.scatter import Floats

NAMES = {
    "error_m": ("range", "m", 3),
    "rx_power_dbm": ("receive level", "dB", 1),
    "first_path_power_dbm": ("first-path level", "dB", 1),
}


def expected(outlook: Outlook, observables: tuple[str, ...], place: int) -> str:
    """Return what tells explanations apart best at one measurement, each with what it predicts.

    Beside what is simulated without any of them; a span where parameters left open predict one.
    """
    shifts = [one.means[:, place] - outlook.bare[place] for one in outlook.predictions]
    roots = [np.sqrt(np.diagonal(one.scatter[place])) for one in outlook.predictions]
    scatter = np.mean(roots, axis=0)
    middle = np.array([one.mean(axis=0) for one in shifts])
    open_ = np.mean([one.std(axis=0) for one in shifts], axis=0)
    at = int(np.argmax(np.ptp(middle, axis=0) / (scatter + open_)))
    what, unit, digits = NAMES[observables[at]]
    each = (
        f"{_span(shift[:, at], float(scatter[at]), digits)} {unit} if {name}"
        for name, shift in zip(outlook.names, shifts, strict=True)
    )
    least = f"a link's mean scatters by {scatter[at]:.{digits}f} {unit}"
    return f"recorded - simulated {what}: {', '.join(each)}; {least}"


def _span(values: Floats, scatter: float, digits: int) -> str:
    """Return a value, or nine tenths of the values where they differ more than rows scatter."""
    low, high = (float(q) for q in np.quantile(values, (0.05, 0.95)))
    if high - low > scatter:
        return f"{low:+.{digits}f} to {high:+.{digits}f}"
    return f"{float(values.mean()):+.{digits}f}"
