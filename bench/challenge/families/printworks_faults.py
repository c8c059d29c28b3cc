"""Laws and faults of the set-up that the printworks hides, which no library has.

numpy alone; shared by the printworks' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.printworks_hall import (
    CUT_M,
    ELLE_M,
    LOOP_M,
    ON_TOWERS,
    STANCHIONS,
    STANCHIONS_M,
    TAGS,
    Change,
    Sheet,
    gone_m,
    looped,
)

Floats = NDArray[np.float64]
DRIFT, LONGER = 0.016, 0.0065  # trucks' bend in 1/m; of the chain
SHAKE_M, SURVEY_M, TIRED_M = 0.066, 0.062, 0.128


def _ink_mist(sheet: Sheet, strength: float) -> Change:
    """Come through covers with ink on them, which take up no more by and by."""
    return Change(0.16 * strength * (1 - np.exp(-sheet["ink_mg"] / 13.0)))


def _webs_slack(sheet: Sheet, strength: float) -> Change:
    """Come past webs that hang the lower the less they are drawn: by one over their tension."""
    return Change(34.0 * strength / sheet["tension_n"])


def _unwound(sheet: Sheet, strength: float) -> Change:
    """Come past reels of which the more is left the wider they are: by their disc."""
    return Change(0.165 * strength * (sheet["reel_cm"] / 100.0) ** 2)


def _spray(sheet: Sheet, strength: float) -> Change:
    """Come through spray of plates, the longer the more of it there is."""
    return Change(0.0105 * strength * sheet["spray_lh"])


def _cuts(sheet: Sheet, strength: float) -> Change:
    """Read long and short as a folder's cylinder goes round."""
    return Change(0.059 * strength * np.cos(2 * np.pi * sheet["web_m"] / CUT_M + 1.1))


def _hood(sheet: Sheet, strength: float) -> Change:
    """Come by another way once hoods over the towers are lifted far enough."""
    return Change(np.where(sheet["hood_pct"] > 48.0, 0.098 * strength, 0.0))


def _swells(sheet: Sheet, strength: float) -> Change:
    """Come through covers of card that swell: by the root of how humid it is."""
    return Change(0.029 * strength * np.sqrt(sheet["humidity_pct"] - 20.0))


def _unlike_wheels(sheet: Sheet, strength: float) -> Change:
    """Steer to one side, as one wheel is smaller: off by the square of what a truck has gone."""
    gone = gone_m(sheet.course, sheet.course["into_s"]) * sheet.carries("truck")
    aim = sheet.course["aim"] + sheet.course["bend"] * gone
    side = np.stack([-np.sin(aim), np.cos(aim), np.zeros(sheet.size)], axis=1)
    sense = sheet.shared(6).choice([-1.0, 1.0], len(TAGS))[sheet.tag]
    return Change(sheet.lengthens((0.5 * DRIFT * strength * sense * gone**2)[:, None] * side))


def _worn_chain(sheet: Sheet, strength: float) -> Change:
    """Hang farther along a chain than links are counted, the farther from where it is driven."""
    along = sheet.course["aim"] + gone_m(sheet.course, sheet.course["into_s"])
    more = LONGER * strength * np.mod(along, LOOP_M) * sheet.carries("gripper")
    return Change(sheet.lengthens(looped(along + more) - looped(along)))


def _shake(sheet: Sheet, strength: float) -> Change:
    """Be read from towers that shake, each way, the more the faster a press runs."""
    fast = (sheet["copies_kh"] / 30.0) ** 1.5 * (sheet.reader < ON_TOWERS)
    swings = (
        SHAKE_M * strength * fast * np.sqrt(2) * np.sin(2 * np.pi * sheet.rng.random(sheet.size))
    )
    across = np.abs(sheet.there - sheet.hung)[:, :2].sum(axis=1) / sheet.far
    return Change(swings * across)


def _elsewhere(sheet: Sheet, hung_m: Floats) -> Change:
    """Return what becomes of rows whose readers are elsewhere in truth [STANCHIONS, 3]."""
    more = sheet.lengthens(0.0, (hung_m - STANCHIONS_M)[sheet.reader])
    return Change(more, -18.4 * np.log10(1 + more / sheet.far) - 0.03 * more)


def _one_from_the_next(sheet: Sheet, strength: float) -> Change:
    """Hang where a survey has them that went from each to the next: errors are carried on."""
    steps = sheet.shared(7).normal(0.0, SURVEY_M, (STANCHIONS, 3)) * [1.0, 1.0, 0.4]
    off = np.cumsum(steps, axis=0) - steps[:1]
    return _elsewhere(sheet, STANCHIONS_M + strength * off)


def _tire(sheet: Sheet, strength: float) -> Change:
    """Answer later and later within a run, as a tag's capacitor empties, till it holds."""
    return Change(TIRED_M * strength * -np.expm1(-sheet.since_s / 1.3))


def _hit(sheet: Sheet, strength: float) -> Change:
    moved = 0.49 * strength * np.array([-4.0, 7.0, -4.0]) / 9
    return _elsewhere(sheet, STANCHIONS_M + (np.arange(STANCHIONS) == 9)[:, None] * moved)


def _plugged(sheet: Sheet, _: float) -> Change:
    order = np.arange(STANCHIONS)
    order[[5, 10]] = 10, 5
    return _elsewhere(sheet, STANCHIONS_M[order])


def _ellen(sheet: Sheet, _: float) -> Change:
    """Write, at one stanchion, Prussian ellen, as the old presses' drawings have them."""
    return Change((sheet.reader == 6) * (1 / ELLE_M - 1) * sheet["range_m"])


UNLISTED: dict[str, Callable[[Sheet, float], Change]] = {
    "ink-mist-on-covers": _ink_mist,
    "webs-slack": _webs_slack,
    "reels-unwound": _unwound,
    "spray-bars-on": _spray,
    "folder-cuts": _cuts,
    "hood-lifted": _hood,
    "covers-of-card-swell": _swells,
    "wheels-of-unlike-size": _unlike_wheels,
    "chain-worn-long": _worn_chain,
    "towers-shake": _shake,
    "surveyed-one-from-the-next": _one_from_the_next,
    "tags-tire": _tire,
    "stanchion-hit-by-a-reel": _hit,
    "stanchions-plugged-crosswise": _plugged,
    "ellen-from-one-stanchion": _ellen,
}
