"""Whether a model makes lines of sight worse: against no mitigation, and against the floors."""

from __future__ import annotations

from collections.abc import Callable

from reports.boards import Board, Entry
from reports.document import Cell
from reports.measures import Figure
from reports.numbers import UNKNOWN

LEAST_M = 1e-4  # differences below 0.1 mm are none, as in the ranks
HEADER = "Harm on LoS"
LEGEND = (
    "Harm on LoS: what a model leaves more error than on line-of-sight rows, raw (uncorrected) "
    "ranges or a floor of the board (a floor: raw alone); figures as they stand, without their "
    "intervals."
)


def harmed(board: Board) -> Callable[[Entry], Figure]:
    """Return the figure of one entry: "no", or all that it is worse than."""
    floors = _floors(board)

    def read(entry: Entry) -> Figure:
        if entry.los is None:
            return Figure(Cell(UNKNOWN))
        worse = worse_than(entry, floors)
        return Figure(Cell(f"worse than {', '.join(worse)}" if worse else "no"))

    return read


def worse_than(entry: Entry, floors: dict[str, float]) -> list[str]:
    """Return "raw" and the names of floors that leave less error on the LoS rows."""
    if entry.los is None:
        return []
    left = entry.los.mae_m.value
    others = {} if entry.is_floor else floors
    known = {"raw": entry.los.raw_mae_m, **others}
    return [name for name, floor in known.items() if left > floor + LEAST_M]


def has_los(board: Board) -> bool:
    """Tell whether some entry was scored on line-of-sight rows."""
    return any(entry.los is not None for entry in board.entries)


def _floors(board: Board) -> dict[str, float]:
    """Return each floor's LoS MAE by model, least over backends; without those equal to raw."""
    found: dict[str, float] = {}
    for entry in board.entries:
        if entry.is_floor and entry.los is not None:
            left = entry.los.mae_m.value
            if abs(left - entry.los.raw_mae_m) > LEAST_M:
                found[entry.model] = min(left, found.get(entry.model, left))
    return found
