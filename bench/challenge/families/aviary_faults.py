"""Laws and faults of the set-up that the aviary hides, which no library has.

numpy alone; shared by the aviary's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.aviary_grounds import (
    DEEP_M,
    GAZ_M,
    NESTBOXES,
    NESTBOXES_M,
    ON_MASTS,
    PADDLES_M,
    Change,
    Watch,
)

Floats = NDArray[np.float64]
LEVEL_DB = (-61.0, 20.5, 1.6)  # at one metre; for each decade; m within which it is no louder
LEG_M, FALLS = 0.38, 9.81  # from storks' hearts to their tags; m/s2
DRIFT_MS, LEAN_M, SHEAR, AWAKE_M = 0.052, 0.115, 0.0052, 0.152


def _droppings(watch: Watch, strength: float) -> Change:
    """Come through lids that hold only so many droppings: by a hyperbola of Michaelis."""
    grams = watch.of("droppings_g")
    return Change(0.19 * strength * grams / (grams + 9.0))


def _visitors(watch: Watch, strength: float) -> Change:
    """Come past visitors, the later the closer these are."""
    return Change(0.185 * strength / watch.of("visitors_m"))


def _soaked(watch: Watch, strength: float) -> Change:
    """Come through plumage that holds ever more water: by its square."""
    return Change(0.0118 * strength * watch.of("rain_mm") ** 2)


def _hoppers(watch: Watch, strength: float) -> Change:
    """Come through hoppers with so much seed in them."""
    return Change(0.0059 * strength * watch.of("seed_kg"))


def _powder(watch: Watch, strength: float) -> Change:
    """Come through powder down, of which new layers lie ever closer: by a logarithm."""
    return Change(0.047 * strength * np.log1p(watch.of("down_g") / 1.6))


def _paddles(watch: Watch, strength: float) -> Change:
    """Read long and short as paddles of the pond's wheel go by."""
    return Change(0.06 * strength * np.sin(2 * np.pi * watch.of("rim_m") / PADDLES_M - 0.7))


def _curtain(watch: Watch, strength: float) -> Change:
    """Come through a curtain once it is let down far enough."""
    return Change(np.where(watch.of("curtain_pct") > 54.0, 0.094 * strength, 0.0))


def _bank(watch: Watch, strength: float) -> Change:
    """Bank in turns by speed and radius: tags below storks' hearts swing outward and up."""
    course = watch.course
    radius = course["reach_m"].clip(min=1e-9)
    rate = course["goes"] * course["wheel"] / course["lasts_s"]
    bank = np.arctan(rate**2 * radius / FALLS) * watch.worn_by("stork")
    angle = course["heads"] + rate * course["into_s"]
    out = np.stack([np.cos(angle), np.sin(angle), np.zeros(watch.rows)], axis=1)
    up = np.array([0.0, 0.0, 1.0])
    swing = np.sin(bank)[:, None] * out + (1 - np.cos(bank))[:, None] * up
    return Change(watch.lengthens(LEG_M * strength * swing))


def _downwind(watch: Watch, what: int) -> Floats:
    """Return whither winds blow in a case [3]."""
    whither = watch.shared(what).uniform(0.0, 2 * np.pi)
    return np.array([np.cos(whither), np.sin(whither), 0.0])


def _drift(watch: Watch, strength: float) -> Change:
    """Drift downwind while on the wing, by so much a second, where courses are dead reckoned."""
    course = watch.course
    wing_s = course["goes"] * course["into_s"] * watch.worn_by("stork", "ibis")
    return Change(watch.lengthens(DRIFT_MS * strength * wing_s[:, None] * _downwind(watch, 6)))


def lost_db(far: Floats) -> Floats:
    """Return how much ways lose, in dB of a metre's [n], by their lengths in m [n]."""
    return np.asarray(LEVEL_DB[1] * np.log10(np.hypot(far, LEVEL_DB[2])))


def _moved(watch: Watch, off_m: Floats) -> Change:
    """Return what becomes of rows whose nestboxes are off by so much [n, 3]."""
    more = watch.lengthens(0.0, off_m)
    return Change(more, lost_db(watch.far) - lost_db((watch.far + more).clip(0.1)))


def _lean(watch: Watch, strength: float) -> Change:
    """Hang on masts that lean downwind by the square of how hard it blows."""
    blows = (watch.of("wind_ms") / 6.0) ** 2 * (watch.box < ON_MASTS)
    return _moved(watch, LEAN_M * strength * blows[:, None] * _downwind(watch, 7))


def _sheared(watch: Watch, strength: float) -> Change:
    """Hang where a plan has them whose corners are not square: ever farther east up north."""
    north = NESTBOXES_M[:, 1] - 0.25 * DEEP_M
    off = SHEAR * 2.0 * strength * north[:, None] * np.array([1.0, 0.0, 0.0])
    return _moved(watch, off[watch.box])


def _wake(watch: Watch, strength: float) -> Change:
    """Answer late at first, while a tag's oscillator that slept is not yet up."""
    return Change(AWAKE_M * strength * np.exp(-watch.since_s / 1.1))


def _dragged(watch: Watch, strength: float) -> Change:
    off = 0.47 * strength * np.array([6.0, -3.0, -2.0]) / 7
    return _moved(watch, (watch.box == 7)[:, None] * off)


def _crosswise(watch: Watch, _: float) -> Change:
    whose = np.arange(NESTBOXES)
    whose[[4, 10]] = 10, 4
    return _moved(watch, (NESTBOXES_M[whose] - NESTBOXES_M)[watch.box])


def _gaz(watch: Watch, _: float) -> Change:
    """Write, at one nestbox, the gaz by which the gardens were laid out."""
    return Change(np.where(watch.box == 9, (1 / GAZ_M - 1) * watch.of("range_m"), 0.0))


UNLISTED: dict[str, Callable[[Watch, float], Change]] = {
    "droppings-on-lids": _droppings,
    "visitors-close-by": _visitors,
    "plumage-soaked": _soaked,
    "hoppers-full": _hoppers,
    "powder-down-settles": _powder,
    "wheel-paddles-pass": _paddles,
    "winter-curtain-down": _curtain,
    "storks-bank": _bank,
    "wind-drifts-flyers": _drift,
    "masts-lean-downwind": _lean,
    "plan-sheared": _sheared,
    "tags-wake-slowly": _wake,
    "nestbox-dragged-by-a-branch": _dragged,
    "nestboxes-noted-crosswise": _crosswise,
    "gaz-from-one-nestbox": _gaz,
}
