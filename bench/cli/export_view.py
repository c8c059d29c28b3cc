"""What `bench export` shows: files, agreement, what was counted."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from bench.cli.console import print_json, say
from bench.export.agreement import at_most
from bench.export.report import NOT_CHECKED
from bench.text import named

if TYPE_CHECKING:
    from bench.export import Chosen, Exported
    from bench.export.agreement import Agreement
    from bench.runner.counting import Counted


def as_json(chosen: Chosen, exported: Exported) -> None:
    """Print what was written as one JSON object."""
    found = exported.agreement
    told = found and {"rows": found.rows, "equal": found.equal, "largest_m": found.largest_m}
    print_json(
        {
            **{"model": chosen.model, "backend": chosen.backend, "data": chosen.data},
            **{"folder": str(exported.folder), "files": list(exported.files)},
            **{"arena_bytes": exported.arena_bytes, "agreement": told},
            "counted": [_facts(one) for one in exported.counted],
            **{"counts_kept": list(exported.kept), "counts_dropped": list(exported.dropped)},
        }
    )


def show(chosen: Chosen, exported: Exported) -> None:
    """Print what was written where, and what is known of it."""
    say(f"{chosen.model} on {chosen.backend}, {named(chosen.origin)}")
    say(f"{named(exported.folder)}: {', '.join(exported.files)}")
    if exported.arena_bytes is not None:
        say(f"RAM for activations: {exported.arena_bytes} bytes")
        say(_agreement(chosen, exported.agreement))
    for line in _counts(exported):
        say(line)


def _agreement(chosen: Chosen, found: Agreement | None) -> str:
    if found is None:
        return f"agreement with ONNX Runtime {NOT_CHECKED}"
    integer = chosen.artifact.precision == "int8"
    same = f", {100 * found.equal:.2f} % equal bit by bit" if integer else ""
    return f"{found.rows} held-out rows: {at_most(found.largest_m)} from ONNX Runtime{same}"


def _counts(exported: Exported) -> Iterator[str]:
    for one in exported.counted:
        facts = _facts(one)
        yield (
            f"{facts['device']}, counted: {facts['cycles']:,} cycles, "
            f"{facts['latency_ms']:.3g} ms; {facts['fits']}"
        )
    if exported.unitless:
        named_parts = ", ".join(exported.unitless)
        yield f"{named_parts}: no floating-point unit; --requantise fixed is for such parts"
    if exported.kept:
        kept = ", ".join(exported.kept)
        yield f"the C is as it was: REPORT.md keeps what was counted for {kept}"
    if exported.dropped:
        gone = ",".join(exported.dropped)
        yield f"REPORT.md had counts of other C, now gone: --device {gone} counts this one"


def _facts(one: Counted) -> dict[str, Any]:
    """Return what a part takes for a call: its cycles with wait states, ms, whether it fits."""
    figure = one.figure
    return {
        "device": figure.device,
        "cycles": round(figure.cycles.value),
        "latency_ms": figure.latency_us.value / 1e3,
        "fits": figure.fits,
    }
