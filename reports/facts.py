"""What stands under a board: raw figures, skipped pairs, data, machine, versions, date."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from reports.boards import Board, Entry
from reports.document import Block, Bullets, Paragraph
from reports.machines import machine_label
from reports.numbers import count, metres
from reports.seeds import Accuracy

LONGEST_FACT = 120  # characters of one machine property worth printing


def facts(board: Board) -> list[Block]:
    """Return the notes, the pairs without figures and what the board rests on."""
    blocks: list[Block] = []
    for heading, items in (
        ("Notes:", _notes(board.entries)),
        ("Skipped:", [f"{one.model}/{one.backend}: {one.reason}" for one in board.skipped]),
        ("No result yet:", [", ".join("/".join(pair) for pair in board.missing)]),
        ("These figures rest on:", list(_basis(board))),
    ):
        if any(items):
            blocks += [Paragraph(heading), Bullets(tuple(items))]
    return blocks


def _notes(entries: Sequence[Entry]) -> list[str]:
    """Return each note once, with the pairs it is about."""
    found: dict[str, list[str]] = {}
    for entry in entries:
        for note in entry.notes:
            found.setdefault(note, []).append(entry.name)
    return [f"{', '.join(names)}: {note}" for note, names in found.items()]


def _basis(board: Board) -> Iterator[str]:
    simulated = ", SIMULATED" if board.simulated else ""
    yield f"data: {board.data}{simulated}, fingerprint {board.fingerprint}"
    yield from _rows_and_raw(board.entries)
    yield _machine(board)
    if board.other_machines:
        others = ", ".join(board.other_machines)
        yield f"timings of other machines, not shown (choose with --machine): {others}"
    yield from _versions(board)
    yield from _replaced(board)
    yield f"newest record: {board.newest_utc or 'undated'}"


def _rows_and_raw(entries: Sequence[Entry]) -> Iterator[str]:
    kinds: tuple[tuple[str, Callable[[Entry], Accuracy | None]], ...] = (
        ("NLoS", lambda entry: entry.nlos),
        ("LoS", lambda entry: entry.los),
    )
    for kind, pick in kinds:
        scored = [accuracy for entry in entries if (accuracy := pick(entry)) is not None]
        if scored:
            yield _raw(kind, scored)


def _raw(kind: str, scored: Sequence[Accuracy]) -> str:
    rows = _span([one.rows for one in scored], count)
    links = _span([one.links for one in scored], count)
    mae = _span([one.raw_mae_m for one in scored], metres)
    sigma = _span([one.raw_sigma_m for one in scored], metres)
    return f"{kind} test rows: {rows} on {links} links; before mitigation MAE {mae} m, σ {sigma} m"


def _span(values: Sequence[float], text: Callable[[float], str]) -> str:
    """Return one text where all values read alike, else the lowest and highest."""
    low, high = text(min(values)), text(max(values))
    return low if low == high else f"{low} to {high}"


def _machine(board: Board) -> str:
    if board.machine is None:
        return "machine: no timings"
    label = machine_label(board.machine)
    known = [(key, _fact(value)) for key, value in board.machine.items() if key != "id"]
    told = label.partition(", id ")[0]
    details = [f"{key.replace('_', ' ')} {text}" for key, text in known if text not in ("", told)]
    return f"machine: {label} ({'; '.join(details)})"


def _fact(value: Any) -> str:
    """Return a machine's property as short text, empty where it is none."""
    if isinstance(value, Mapping):
        value = [f"{key} {item}" for key, item in value.items()]
    text = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if value is not None and len(text) <= LONGEST_FACT else ""


def _versions(board: Board) -> Iterator[str]:
    for versions in board.versions:
        yield "versions: " + ", ".join(f"{name} {version}" for name, version in versions.items())
    if len(board.versions) > 1:
        yield f"WARNING: rows made with {len(board.versions)} different sets of versions"
    if len(board.code_hashes) > 1:
        hashes = ", ".join(board.code_hashes)
        yield f"code that made the rows: {hashes}"


def _replaced(board: Board) -> Iterator[str]:
    if board.older_data:
        yield f"left out, on older data of the same name: {_records(board.older_data)}"
    if board.older_code:
        yield f"left out, replaced by newer code, versions or runs: {_records(board.older_code)}"


def _records(number: int) -> str:
    return "1 record" if number == 1 else f"{number} records"
