"""`bench.run`: the whole benchmark as one Python call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.parallel import Spread
from bench.plugins import Plugin
from bench.recordings.open import Table
from bench.results import Estimate, RunRecord, TimingRecord
from bench.runner.across import DEFAULT_DRAWS, asked, ready
from bench.runner.count_runs import count_runs, devices_of
from bench.runner.curve import CurvePoint, curve_points
from bench.runner.execute import execute
from bench.runner.failure import Failure
from bench.runner.folder import ResultFolder
from bench.runner.guarding import with_guard
from bench.runner.inputs import widths
from bench.runner.keys import head_of
from bench.runner.material import load_material
from bench.runner.observer import Observer
from bench.runner.plan import Plan, make_plan
from bench.runner.repeated import finished_runs, question_of, recalled, remember
from bench.runner.scratch import scratch
from bench.runner.timing import known_timings, time_artifacts

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class RunSet:
    """What `bench.run` returns: a record per run, a timing per artifact, and what failed.

    `curve` has a point per model, backend and number of links, where links were asked for.
    """

    runs: list[RunRecord]
    timings: list[TimingRecord]
    failures: list[Failure]
    folder: Path
    devices: tuple[Plugin, ...] = ()
    curve: list[CurvePoint] = field(default_factory=list)

    def estimates(self, run: RunRecord) -> list[Estimate]:
        """Return one run's figures on the devices asked for, from their profiles as of now.

        Counted where its artifact was counted on the part's core, else ESTIMATES.
        """
        return list(devices_of(run, self.devices, ResultFolder(self.folder)))

    def frame(self) -> pd.DataFrame:
        """Return one row per run: names, errors in metres, latency in us, sizes in bytes."""
        from bench.runner.frame import frame_of

        return frame_of(self.runs, self.timings)


def run(
    model: str = "remnet",
    backend: str = "int8",
    data: Table = "rooms",
    *,
    split: str | None = None,
    train: Table | Sequence[Table] | None = None,
    test: Table | None = None,
    pretrain: Table | Sequence[Table] | None = None,
    finetune: str | None = None,
    links: int | str | Sequence[int] | None = None,
    draws: int = DEFAULT_DRAWS,
    device: str = "all",
    seeds: int = 1,
    out: str | Path = "results",
    jobs: int | None = None,
    scheduler: str | None = None,
    observer: Observer | None = None,
    wait: bool = True,
    timed: bool = True,
    guard: bool = False,
) -> RunSet:
    """Benchmark models on backends and return the records, also written under `out`.

    `model`, `backend`, `device`: a name, several with commas, or "all". `data`: a data set name, a
    recordings file, a frame or `Recordings`. `split`: "leave-environment-out[:ENV]" or
    "link-kfold[:K]"; None takes what suits the data. Finished runs found under `out` are reused
    while nothing that determines them has changed. On devices that are named (not "all") and have
    a core, what a call takes is counted in an emulator where that is installed. `jobs` processes
    (None: as many as there are cores where the fits are long) or a Dask `scheduler` share the fits,
    never the timings. `wait` waits up to two minutes for a
    quiet machine before timing; what a busy one disturbed is not reported either way. Not `timed`:
    no latency is measured.

    Across data: `train` (names with commas, or several) and `test` train on some and test on
    another; each is a data set, a recordings file or a simulator's TOML. `links`, a number or
    several, trains on so many links of the tested data (of `data`, where nothing else is named)
    and tests on others, in `draws` draws: `curve` has the learning curve. `pretrain` with
    `finetune="DATA:LINKS"` fits on the one and trains further on links of the other. What takes
    several draws is not timed.

    `guard` runs every model as NAME+guard: its correction shrunk so that lines of sight on links it
    has not seen are no worse than uncorrected, on average (three more fits).

    Raises BenchError on bad input, before anything is written.

    >>> run(model="remnett")
    Traceback (most recent call last):
    bench.errors.BenchError: unknown model 'remnett'; did you mean 'remnet'? ...
    """
    watch = observer or Observer()
    spread = (
        None
        if jobs is None and scheduler is None
        else Spread(1 if jobs is None else jobs, scheduler)
    )
    plan = make_plan(model, backend, device, seeds)
    plan = with_guard(plan) if guard else plan
    folder = ResultFolder(Path(out))
    folder.check_writable()
    watch.stage("reading the recordings")
    across = asked(data, train, test, pretrain, finetune, links, draws)
    question = question_of(data, split) if across is None else None
    if (known := _known(question, plan, folder, timed)) and device.strip() == "all":
        return known
    if across is None:
        materials = [load_material(data, split)]
        question = question or question_of(data, split)  # what is simulated is there only now
    else:
        plan, materials = ready(across, split, plan, watch)
    with scratch():
        done = [execute(plan, material, folder, watch, spread) for material in materials]
        runs, failures = (
            [one for part in parts for one in part] for parts in zip(*done, strict=True)
        )
        if across and across.links:
            curve = curve_points(runs, materials, across.links, folder)
            return RunSet(runs, [], failures, folder.root, plan.devices, curve)
        timings, late = list[TimingRecord](), list[Failure]()
        if timed:
            timings, late = time_artifacts(
                runs, folder, widths(plan.models, materials[0]), watch, wait
            )
        if question is not None:
            remember(question, data, split, head_of(materials[0]))
        if device.strip() != "all":
            count_runs(runs, plan.devices, materials[0], folder, watch)
    return RunSet(runs, timings, failures + late, folder.root, plan.devices)


def _known(
    question: list[Any] | None, plan: Plan, folder: ResultFolder, timed: bool
) -> RunSet | None:
    """Return what a run would, where all of it is there and the recordings are known unread."""
    head = recalled(question)
    runs = None if head is None else finished_runs(plan, head, folder)
    if runs is None:
        return None
    timings = known_timings(runs, folder) if timed else []
    return None if timings is None else RunSet(runs, timings, [], folder.root, plan.devices)
