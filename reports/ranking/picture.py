"""Tie groups as a picture: models by their error, bars over those that cannot be told apart.

After the critical-difference diagram of Demsar (JMLR 7, 2006), on the scale of the error itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from reports.errors import ReportError
from reports.leaderboard import title
from reports.overview import Ranked

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from reports.ranking.ranks import Ranking

ROW_INCHES, WIDTH_INCHES = 0.24, 8.0


def tie_groups(boards: Sequence[Ranked]) -> Figure:
    """Return one panel per ranked board. Raises ReportError where none is ranked."""
    from matplotlib.figure import Figure

    drawn = [(one, one.ranking) for one in boards if one.ranking is not None]
    if not drawn:
        raise ReportError("nothing to draw: no board has two models with predictions")
    heights = [1.2 + ROW_INCHES * len(ranking.models) for _, ranking in drawn]
    figure = Figure(figsize=(WIDTH_INCHES, sum(heights)), layout="constrained")
    panels = figure.subplots(len(drawn), 1, squeeze=False, height_ratios=heights)[:, 0]
    for axes, (one, ranking) in zip(panels, drawn, strict=True):
        axes.set_title(title(one.board), fontsize=10)
        _panel(axes, ranking)
    return figure


def _panel(axes: Axes, ranking: Ranking) -> None:
    """Draw one row per model: its error, its rank interval in words, its groups as bars."""
    models = ranking.models
    rows = range(len(models))
    axes.plot([one.mae_m for one in models], rows, "o", color="black", ms=4)
    axes.set_yticks(list(rows), [f"{one.name}  ({one.ranks})" for one in models], fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel("MAE after mitigation (m); in brackets the 95 % interval of the rank")
    axes.grid(axis="x", alpha=0.3)
    beside = axes.get_yaxis_transform()
    for number, letter in enumerate(_letters(ranking)):
        members = [row for row, one in enumerate(models) if letter in one.groups]
        place = 1.02 + 0.03 * number
        ends = [min(members) - 0.3, max(members) + 0.3]
        axes.plot([place, place], ends, transform=beside, clip_on=False, color="C0", lw=3)


def _letters(ranking: Ranking) -> list[str]:
    found = {letter for one in ranking.models for letter in one.groups}
    return sorted(found, key=lambda letter: (letter[1:].zfill(3), letter[0]))
