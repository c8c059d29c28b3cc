"""What an experiment is given: the recordings, the folders, and how to spread its work."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.parallel import Spread
from bench.recordings.open import open_recordings
from bench.recordings.splits import default_split, make_split
from bench.recordings.table import Recordings
from bench.reproduce.thinning import thinned
from bench.results import RunRecord
from bench.runner.execute import execute
from bench.runner.folder import ResultFolder
from bench.runner.material import Material, load_material
from bench.runner.observer import Observer
from bench.runner.plan import make_plan

if TYPE_CHECKING:
    import pandas as pd

    from bench.recordings.sources.base import Source


@dataclass(frozen=True)
class Context:
    """One `bench reproduce` on one data set.

    `data`: a data set name or a file. `split` None takes what suits the data. `quick` thins the
    recordings (by whole links) and the sweeps. `device`: names of device profiles, with commas
    between; `host` is measured, the others are estimates. Runs are kept under `out` beside those of
    `bench run`, quick ones apart, since a leaderboard must never show them.
    """

    data: str
    out: Path
    split: str | None = None
    quick: bool = False
    watch: Observer = field(default_factory=Observer)
    spread: Spread = field(default_factory=Spread)
    device: str = "cortex-a53"

    @cached_property
    def _opened(self) -> tuple[Recordings, Source | None]:
        self.watch.stage("reading the recordings")
        whole, source = open_recordings(self.data)
        return (thinned(whole) if self.quick else whole), source

    @property
    def recordings(self) -> Recordings:
        """The recordings, thinned where quick."""
        return self._opened[0]

    @property
    def source(self) -> Source | None:
        """The data set they come from, None for a file."""
        return self._opened[1]

    @property
    def name(self) -> str:
        """The data set's name, or the file, as asked for."""
        return self.data

    @property
    def folder(self) -> Path:
        """Where outcomes, sweeps and pages of this data set belong."""
        slug = re.sub(r"[^A-Za-z0-9]+", "-", Path(self.name).stem).strip("-") or "data"
        return self.out / "reproduction" / (f"{slug}-quick" if self.quick else slug)

    @property
    def results(self) -> ResultFolder:
        """Where runs are kept: `bench run`'s own folder, unless quick."""
        return ResultFolder(self.folder / "results" if self.quick else self.out)

    @cached_property
    def material(self) -> Material:
        """The recordings as arrays, split as asked (or as suits them).

        Raises BenchError where they hold no CIR.
        """
        if "cir" not in self.recordings.frame:
            raise BenchError(f"{self.name}: no CIRs (column 'cir'), which this needs")
        chosen = self.split or default_split(self.recordings, self.source)
        made = load_material(self.recordings, chosen)
        return self._named(made)

    def material_split(self, split: str) -> Material:
        """Return the same arrays under another split."""
        made = make_split(self.material.recordings, split, source=self.source)
        return self._named(self.material, split=made)

    def _named(self, material: Material, **changes: object) -> Material:
        from dataclasses import replace

        return replace(material, name=self.name, **changes)  # type: ignore[arg-type]

    def runs(
        self, model: str, backend: str, material: Material | None = None, seeds: int = 1
    ) -> list[RunRecord]:
        """Return the records of these runs, done now unless they were before.

        Raises BenchError where one fails, naming the first that did.
        """
        plan = make_plan(model, backend, "all", seeds)
        found, failures = execute(
            plan, material or self.material, self.results, self.watch, self.spread
        )
        if failures:
            raise BenchError(str(failures[0]))
        return found

    def tried(self, model: str, backend: str) -> tuple[list[RunRecord], list[str]]:
        """Return the records of these runs, and a line for each that failed."""
        plan = make_plan(model, backend, "all", 1)
        found, failures = execute(plan, self.material, self.results, self.watch, self.spread)
        return found, [str(one) for one in failures]

    def predictions(self, run: RunRecord) -> pd.DataFrame:
        """Return a run's rows: link, error_m, predicted_m, scored_as_los (metres).

        Raises BenchError where the file beside the record is gone.
        """
        import pandas as pd

        path = self.results.predictions_path(run.key.digest())
        try:
            return pd.read_parquet(path)
        except (OSError, ValueError) as problem:
            record = self.results.root / "runs" / f"{run.key.digest()}.json"
            raise BenchError(
                f"{path} cannot be read; delete {record} and run this again"
            ) from problem

    def environments(self) -> Sequence[str]:
        """Return the environments of the recordings."""
        from bench.recordings.splits import environments

        return environments(self.recordings)
