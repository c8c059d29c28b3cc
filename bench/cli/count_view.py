"""What `bench count` shows: a table of parts, layers of one network, JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from bench.cli.console import print_json, print_table, say
from bench.measure.counting.measured import Measured
from bench.results import Interval
from bench.runner.count_models import CountRow
from bench.runner.counting import Counted
from bench.text import named

NARROW = ("device", "network", "how", "cycles\n(M)", "latency\n(ms)", "energy\n(mJ)", "flash\n(KB)")
FAR = 3.0  # times the count: more than flash waits and other compilers were seen to do
NOTE = (
    "counted: instructions exact in an emulator, cycles by the core's table; brackets: its low and "
    "high ends with the part's wait states. Energy: from data sheets."
)


def print_rows(rows: Sequence[CountRow], board: Measured | None) -> None:
    """Print the table, what fits, and for a single network its layers and kinds."""
    title = f"Counted on rows of {named(rows[0].data)}"
    print_table(title, (*NARROW, "RAM\n(KB)"), map(_narrow, lines(rows, board)))
    say(NOTE)
    for row in rows:
        say(f"{row.model} on {row.backend}, {row.device}: {_verdict(row)}")
    counted = [row.counted for row in rows if row.counted is not None]
    if board is not None and counted and (doubt := _doubt(counted[0], board)):
        say(doubt)
    if len(counted) == 1:
        _print_details(counted[0])


def _doubt(one: Counted, board: Measured) -> str | None:
    """Return a line where a board's cycles are far from the count, None where they are near."""
    share = board.mean / one.figure.cycles.value
    if 1 / FAR < share < FAR:
        return None
    times = f"{share:,.0f}" if share > 1 else f"{share:.2g}"
    return f"{board.file}: {times} times the cycles counted: is it of this model, on this part?"


def rows_as_json(rows: Sequence[CountRow], board: Measured | None) -> None:
    """Print every row as one JSON list; a board's figures stand beside the count."""
    print_json([_facts(row, board) for row in rows])


def lines(rows: Sequence[CountRow], board: Measured | None) -> Iterator[tuple[str, ...]]:
    """Yield every row's cells: part, model, backend, how, figures; a refusal with its reason."""
    for row in rows:
        names = (row.device, row.model, row.backend)
        if row.counted is None:
            yield (*names, f"- ({row.reason})", *("",) * 5)
            continue
        if board is not None:
            yield (*names, "measured", *_board_cells(row.counted, board), "", "")
        problem = row.counted.figure.problem
        yield (*names, f"counted, {problem}" if problem else "counted", *_cells(row.counted))


def _narrow(line: tuple[str, ...]) -> tuple[str, ...]:
    """Return a line for 80 columns: model and backend in one, ranges under their figures.

    Why something was not counted stands below the table.
    """
    device, model, backend, how, *rest = line
    how = "not\ncounted" if how.startswith("- (") else how.partition(",")[0]
    return device, f"{model}\n{backend}", how, *(cell.replace(" [", "\n[") for cell in rest)


def _cells(one: Counted) -> tuple[str, ...]:
    figure, count = one.figure, one.count
    return (
        _span(figure.cycles, 1e-6),
        _span(figure.latency_us, 1e-3),
        _span(figure.energy_mj, 1.0) if figure.energy_mj else "-",
        _kb(count.flash_bytes),
        _kb(count.ram_bytes),
    )


def _kb(size_bytes: int) -> str:
    """Return kilobytes with one digit; what would read as none at all says so."""
    return "<0.1" if 0 < size_bytes < 51.2 else f"{size_bytes / 1024:.1f}"


def _board_cells(one: Counted, board: Measured) -> tuple[str, ...]:
    """Return a board's cycles, and its latency and energy by the part's own clock and energy."""
    share = board.mean / one.figure.cycles.value
    energy = one.figure.energy_mj
    return (
        _span(board.interval(), 1e-6),
        f"{one.figure.latency_us.value * share / 1000:.3g}",
        f"{energy.value * share:.3g}" if energy else "-",
    )


def _span(figure: Interval, scale: float) -> str:
    text = f"{figure.value * scale:.3g}"
    if figure.low is None or figure.high is None or figure.low == figure.high:
        return text
    return f"{text} [{figure.low * scale:.3g}, {figure.high * scale:.3g}]"


def _verdict(row: CountRow) -> str:
    if row.counted is None:
        return f"not counted: {row.reason}"
    check = row.counted.agreement
    equal = f"{check.equal} of {check.rows} outputs equal this machine's bit by bit"
    off = "" if check.equal == check.rows else f", at most {check.largest_m * 1000:.2g} mm off"
    return f"{row.counted.figure.fits}; {equal}{off}"


def _print_details(one: Counted) -> None:
    count = one.count
    say(
        f"{count.instructions:,.0f} instructions a call ({count.fewest:,} to {count.most:,} over "
        f"{count.counted_rows} rows), {count.compiler}; code {count.code_bytes} B, constants "
        f"{count.constant_bytes} B, variables {count.static_ram_bytes} B, stack "
        f"{count.stack_bytes} B, {count.flash_reads:,} data reads from flash"
    )
    shares = [f"{kind} {number:,.0f}" for kind, number in count.kinds.items()]
    say("by kind: " + ", ".join(shares))
    layers = [
        (one.name, one.kind, f"{one.instructions:,.0f}", f"{one.cycles.typical:,.0f}")
        for one in count.layers
    ]
    print_table("By layer", ("layer", "kind", "instructions", "cycles"), layers)


def _facts(row: CountRow, board: Measured | None) -> dict[str, Any]:
    facts: dict[str, Any] = {
        **{"model": row.model, "backend": row.backend, "device": row.device},
        **{"how": "counted", "reason": row.reason, "measured_cycles": None},
        **{
            "data": row.data,
            "precision": row.precision,
            "cost": asdict(row.cost) if row.cost else None,
        },
    }
    if row.counted is None:
        return facts | {"how": None}
    content = asdict(row.counted)
    content["count"] |= {
        "outputs_m": row.counted.count.outputs_m.tolist(),
        "statuses": row.counted.count.statuses.tolist(),
        "ram_bytes": row.counted.count.ram_bytes,
    }
    return facts | content | {"measured_cycles": list(board.cycles) if board else None}
