"""Numbers as text, with as many digits as they deserve."""

from __future__ import annotations

import math

from reports.load import Interval
from reports.seeds import SeedMean

UNKNOWN = "–"
SMALLEST_PLAIN = 0.001


def metres(value: float) -> str:
    """Return metres with four decimals (a tenth of a millimetre), two from ten metres up."""
    if not math.isfinite(value):
        return "n/a"
    return f"{value:.4f}" if abs(value) < 10 else f"{value:,.2f}"


def ratio(value: float) -> str:
    """Return a dimensionless figure such as R² with three decimals."""
    return f"{value:.3f}" if math.isfinite(value) else "n/a"


def count(value: float) -> str:
    """Return a whole number with thousands separated."""
    return f"{round(value):,}" if math.isfinite(value) else "n/a"


def significant(value: float, digits: int = 3) -> str:
    """Return a number with that many significant digits; with an exponent below 0.001."""
    if not math.isfinite(value):
        return "n/a"
    if value == 0:
        return "0"
    if abs(value) < SMALLEST_PLAIN:
        return f"{value:.{digits - 1}e}"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:,.{decimals}f}"


def seed_details(mean: SeedMean, decimals: int) -> tuple[str, ...]:
    """Return `[low, high]` over links and `±half` over seeds, each where known."""
    parts: list[str] = []
    if mean.low is not None and mean.high is not None:
        parts.append(f"[{mean.low:.{decimals}f}, {mean.high:.{decimals}f}]")
    if mean.seed_half is not None:
        parts.append(f"±{mean.seed_half:.{decimals}f}")
    return tuple(parts)


def low_to_high(figure: Interval) -> tuple[str, ...]:
    """Return `low to high` of an estimate, nothing where not known."""
    if figure.low is None or figure.high is None:
        return ()
    return (f"{significant(figure.low)} to {significant(figure.high)}",)
