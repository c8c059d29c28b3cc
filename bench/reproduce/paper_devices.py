"""The paper's device table as this project names things: backend, device mode, kernels."""

from __future__ import annotations

from collections.abc import Sequence

from backends.cost import GraphCost, graph_cost
from bench.reproduce import paper
from bench.reproduce.context import Context
from bench.results import RunRecord


def cost_of(context: Context, record: RunRecord) -> GraphCost:
    """Return the kernels of a run's file."""
    return graph_cost(context.results.artifact_path(record.digest(), 0))


def backend_of(row: paper.Printed) -> str:
    """Return the backend whose file stands for the row's network."""
    if not row["optimised"]:
        return "fp32"
    return "graph" if row["precision"] == "fp32" else str(row["precision"])


def mode_of(row: paper.Printed, printed: Sequence[paper.Printed]) -> str:
    """Return the profile's mode: of two rows alike the slower is the board's 5 W mode."""
    same = ("device", "optimised", "precision")
    twins = [one for one in printed if all(one[key] == row[key] for key in same)]
    slower = len(twins) > 1 and row["latency_ms"] == max(one["latency_ms"] for one in twins)
    return "5w" if slower else ""


def profile_of(row: paper.Printed, printed: Sequence[paper.Printed]) -> str:
    """Return the name, with its mode, of the profile that the row was measured on.

    The graphics card ran the network as trained under another runtime than the optimised ones.
    """
    if row["device"] == "rtx-2080" and not row["optimised"]:
        return mode_name(row["device"], "tensorflow")
    return mode_name(row["device"], mode_of(row, printed))


def mode_name(device: str, mode: str) -> str:
    """Return a device's name with its mode, where it is in one."""
    return f"{device}, {mode}" if mode else device
