"""Which experiments there are; a module is imported when its experiment is named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from bench.errors import BenchError, unknown_name

if TYPE_CHECKING:
    from bench.reproduce.context import Context
    from bench.reproduce.outcome import Outcome


@dataclass(frozen=True)
class Experiment:
    """One table or figure of the paper: `module` has a `run(context) -> Outcome`.

    `for_device`: the outcome depends on the device that was chosen.
    """

    name: str
    module: str
    summary: str
    for_device: bool = False

    def load(self) -> Callable[[Context], Outcome]:
        """Import the module and return its `run`."""
        run: Callable[[Context], Outcome] = import_module(self.module).run
        return run


def experiments() -> tuple[Experiment, ...]:
    """Return every experiment, in the order of the paper."""
    return tuple(
        Experiment(
            name,
            f"bench.reproduce.experiments.{name.replace('-', '_')}",
            summary,
            for_device=name == "latency-vs-accuracy",
        )
        for name, summary in (
            ("optimisation", "Table I: models and backends, error left after mitigation."),
            ("rooms", "Table II: REMnet with each room left out in turn."),
            ("residuals", "Error before and after: histograms, Q-Q plot, normality."),
            ("devices", "Table III: every device row predicted from the others."),
            ("energy", "Energy against latency over all devices and backends."),
            ("positioning", "Table IV: positions from raw and mitigated ranges."),
            ("cir-size", "MAE against the number of CIR samples."),
            ("generalisation", "Trained on one room or obstacle, tested on each other."),
            ("pca", "CIRs in three principal components, by room and by material."),
            ("latency-vs-accuracy", "Pareto front of all models and backends on --device."),
        )
    )


def chosen(names: str) -> tuple[Experiment, ...]:
    """Return the experiments of a comma-separated list or `all`.

    Raises BenchError with a did-you-mean for a name that is not one.
    """
    known = {one.name: one for one in experiments()}
    if names.strip() == "all":
        return tuple(known.values())
    wanted = [name.strip() for name in names.split(",") if name.strip()]
    if not wanted:
        raise BenchError("no experiment named: expected a name, several with commas, or 'all'")
    for name in wanted:
        if name not in known:
            raise unknown_name("experiment", name, [*known, "all"])
    return tuple(known[name] for name in dict.fromkeys(wanted))
