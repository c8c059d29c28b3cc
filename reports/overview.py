"""The leaderboard on one screen: ten columns a board, rank intervals instead of a bold best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from reports.boards import Board, Entry
from reports.document import Bullets, Cell, Column, Document, Heading, Image, Link, Paragraph, Table
from reports.harm import HEADER, LEGEND, harmed, has_los
from reports.leaderboard import title
from reports.load import Results, Unreadable
from reports.measures import KEYS, Figure, Measure, accuracy_measures, cost_measures, table
from reports.numbers import metres
from reports.pareto import pareto_front
from reports.ranking.across import across
from reports.ranking.columns import rank_column, ties_column
from reports.ranking.paired import Paired
from reports.ranking.predictions import compared
from reports.ranking.ranks import Ranking, rank

SIDE_BY_SIDE = "side by side"

_INTRODUCTION = (
    "Ranging error that remains after mitigation and what each model costs, one table per data "
    "set and split. Models that share a letter cannot be told apart on these links."
)
_LEGEND = (
    "Error = measured - true range; corrected = measured - predicted. MAE: mean |error| that "
    "remains, in metres, with its 95 % interval over links.",
    "Rank: 95 % interval of the rank among all rows of the table, from paired differences over "
    "links, all pairs at once (wild cluster bootstrap, step-down): one false difference in a "
    "table is a 5 % event. Bold: may be the best.",
    "Ties: rows that share a letter cannot be told apart. Differences below 0.1 mm are none.",
    "Latency: median of one call, one thread, of the machine named in the details; a timing that "
    "is not steady says so. kB = 1000 bytes.",
    LEGEND,
    "Front ●: no other row is better in MAE, latency and file size at once (floors aside).",
)


@dataclass(frozen=True)
class Ranked:
    """A board and its ranking; None with the reason where its models cannot be compared.

    `chosen_of`: how many rows there are, where the board holds one of each model.
    """

    board: Board
    ranking: Ranking | None
    reason: str = ""
    left_out: Mapping[str, str] | None = None
    chosen_of: int | None = None


def ranked(board: Board, results: Results) -> Ranked:
    """Return a board with the ranking of its models on the NLoS rows (LoS where none are)."""
    los = all(entry.nlos is None for entry in board.entries)
    found = compared(board, results.folder, los)
    if found.paired is None:
        return Ranked(
            board, None, "no two models with predictions of the same rows", found.left_out
        )
    return Ranked(board, rank(found.paired), "", found.left_out)


def overview(
    boards: Sequence[Ranked],
    details: str | None = None,
    picture: str | None = None,
    unreadable: Sequence[Unreadable] = (),
) -> Document:
    """Return the short leaderboard. `details`, `picture`: paths relative to the report."""
    document: Document = [Heading("Leaderboard", 1), Paragraph(_INTRODUCTION)]
    if picture:
        document.append(Image(picture, "Latency against MAE, with the Pareto front"))
    for one in boards:
        document += _section(one)
    document += _over_all(boards)
    if unreadable:
        document.append(
            Paragraph(f"Files left out, with their reasons in the details: {len(unreadable)}.")
        )
    if details:
        document.append(Link("All columns, devices, versions, what the figures rest on", details))
    return [*document, Heading("How to read it", 2), Bullets(_LEGEND)]


def _section(one: Ranked) -> Document:
    board = one.board
    if not board.entries:
        return [Heading(title(board), 2), Paragraph("No run of this board has finished.")]
    return [
        Heading(title(board), 2),
        table(board.entries, _columns(one)),
        Paragraph(" ".join(_facts(one))),
    ]


def _over_all(boards: Sequence[Ranked]) -> Document:
    """Return the models over all data sets, where several data sets have the same models."""
    sets: dict[str, Paired] = {}
    for one in boards:
        if one.ranking is not None:
            sets.setdefault(one.board.data, one.ranking.family.paired)
    found = across(sets)
    if not found:
        return []
    columns = [Column("Model", number=False), Column("MAE ratio"), Column("Ranks")]
    columns.append(Column("P(best)"))
    rows = [
        (
            Cell(one.name),
            Cell(f"{one.ratio:.3f}", (f"[{one.low:.3f}, {one.high:.3f}]",)),
            Cell(f"{one.ranks[0]}-{one.ranks[1]}"),
            Cell(f"{one.best:.2f}"),
        )
        for one in found
    ]
    simulated = {one.board.data for one in boards if one.board.simulated}
    named = ", ".join(f"{name} (SIMULATED)" if name in simulated else name for name in sets)
    words = (
        f"Bayesian bootstrap over {len(sets)} data sets ({named}) and their links, 95 % credible "
        "intervals. Ratio: MAE over the geometric mean of these models. So few data sets say "
        "little of others."
    )
    return [
        Heading("Over all data sets", 2),
        Table(tuple(columns), tuple(rows)),
        Paragraph(words),
    ]


def _columns(one: Ranked) -> list[Measure]:
    known = {measure.column.header: measure for measure in (*accuracy_measures(), *cost_measures())}
    front = _front(one.board.entries)
    shown = [
        known["NLoS MAE (m)"],
        ties_column(one.ranking),
        known["LoS MAE (m)"],
        _harm_or_r2(one.board, known),
        known["Latency, batch 1 (µs)"],
        known["File (kB)"],
        Measure(
            Column("Front", number=False), lambda entry: Figure(Cell(front.get(entry.name, "")))
        ),
    ]
    return [rank_column(one.ranking), *KEYS, *map(_side_by_side, shown)]


def _side_by_side(measure: Measure) -> Measure:
    """Return the column without a mark for the best, beside as many others as a screen takes."""
    return replace(measure, better=None, column=replace(measure.column, group=SIDE_BY_SIDE))


def _harm_or_r2(board: Board, known: Mapping[str, Measure]) -> Measure:
    """Return the column on harm; R2, which the details have too, where no row is line of sight."""
    if has_los(board):
        return Measure(Column(HEADER, number=False), harmed(board))
    return known["NLoS R²"]


def _front(entries: Sequence[Entry]) -> dict[str, str]:
    """Return a dot for the rows that no other row beats in error, latency and size at once."""
    names, points = [], []
    for entry in entries:
        latency = entry.latency(1)
        scored = entry.nlos or entry.los
        if entry.is_floor or scored is None or entry.size is None:
            continue
        cost = (latency.median_us,) if latency is not None else ()
        names.append(entry.name)
        points.append((scored.mae_m.value, *cost, entry.size.file_bytes))
    same = [point for point in points if len(point) == max(map(len, points))]
    if len(same) < 2 or len(same) < len(points):
        return {}  # one point is no front, and points without a latency cannot be compared
    return {names[at]: "●" for at in pareto_front(points)}


def _facts(one: Ranked) -> list[str]:
    board, ranking = one.board, one.ranking
    texts = [_raw(board)]
    if ranking is None:
        texts.append(f"No ranks: {one.reason}.")
    else:
        texts.append(
            f"Ranks rest on {ranking.links} links; a difference of "
            f"{metres(ranking.detectable_m)} m between two models would be seen in four of five "
            "cases (median over pairs)."
        )
    if one.left_out:
        texts.append(f"Not ranked: {', '.join(sorted(one.left_out))}.")
    return [*texts, *_not_shown(one)]


def _not_shown(one: Ranked) -> list[str]:
    """Return what the table leaves out: pairs that did not run, backends of a shown model."""
    skipped = sorted({f"{pair.model}/{pair.backend}" for pair in one.board.skipped})
    if one.chosen_of is None:
        named = ", ".join(skipped)
        return [f"Skipped, with reasons in the details: {named}."] if skipped else []
    texts = [
        f"One row per model, of {one.chosen_of}: of the backends that cannot be told apart from "
        "the model's best, the fastest (where none was timed, the smallest file). All are in the "
        "details."
    ]
    return texts + ([f"Skipped, with reasons there: {len(skipped)} pairs."] if skipped else [])


def _raw(board: Board) -> str:
    parts = []
    for name, scores in (
        ("NLoS", [entry.nlos for entry in board.entries if entry.nlos]),
        ("LoS", [entry.los for entry in board.entries if entry.los]),
    ):
        if scores:
            first = scores[0]
            parts.append(
                f"{first.rows} {name} rows on {first.links} links "
                f"(MAE before {metres(first.raw_mae_m)} m)"
            )
    return f"Tested on {' and '.join(parts)}."
