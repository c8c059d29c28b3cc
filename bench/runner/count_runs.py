"""Counts beside runs: each artifact on the cores of the parts asked for, kept in the folder."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from bench.errors import BenchError
from bench.measure.counting import find_compiler, load_core
from bench.measure.counting.emulate import check_tools
from bench.measure.estimate import NetworkCost
from bench.measure.on_devices import estimates_of, load_device
from bench.measure.profile import Profile
from bench.plugins import Plugin, find
from bench.results import CountRecord, Estimate, RunRecord
from bench.runner.counting import (
    Floats,
    count_artifact,
    count_record,
    counted_estimate,
    recorded_rows,
)
from bench.runner.folder import ResultFolder
from bench.runner.inputs import rows_for
from bench.runner.material import Material
from bench.runner.observer import Observer
from bench.runner.timing import first_seeds, opener_of

if TYPE_CHECKING:
    from backends.base import Artifact


def count_runs(
    runs: Sequence[RunRecord],
    devices: Iterable[Plugin],
    material: Material,
    folder: ResultFolder,
    watch: Observer,
) -> None:
    """Count the first seed's artifact of every model and backend on every part with a core.

    What is missing, or cannot be counted, is noted: its estimate stays.
    """
    profiles = [one for one in _profiles(devices) if one.core]
    if not profiles:
        return
    try:
        check_tools()
    except BenchError as problem:
        watch.note(f"estimated, not counted: {problem}")
        return
    for run in first_seeds(runs):
        for profile in _one_per_core(profiles):
            if folder.find_count(str(run.artifact_sha256), profile.core, watch.note) is None:
                watch.stage(f"counting {run.key.model} on {run.key.backend}, {profile.core}")
                _count(run, profile, material, folder, watch)


class Built(Protocol):
    """A run as a record or a report holds it."""

    @property
    def cost(self) -> NetworkCost | None:
        """What estimates are made from."""

    @property
    def precision(self) -> str | None:
        """What it computes in."""

    @property
    def artifact_sha256(self) -> str | None:
        """The hash of its file."""


def devices_of(run: Built, devices: Iterable[Plugin], folder: ResultFolder) -> Iterator[Estimate]:
    """Yield a run's figure on every device: counted where its folder holds the count."""
    plugins = tuple(devices)
    for estimate, plugin in zip(
        estimates_of(run.cost, run.precision, plugins), plugins, strict=False
    ):
        count = _known(run, plugin, folder)
        yield estimate if count is None else counted_estimate(count, load_device(plugin))


def _known(run: Built, plugin: Plugin, folder: ResultFolder) -> CountRecord | None:
    try:
        core = load_device(plugin).core
    except BenchError:
        return None
    return folder.find_count(str(run.artifact_sha256), core) if core else None


def _count(
    run: RunRecord, profile: Profile, material: Material, folder: ResultFolder, watch: Observer
) -> None:
    try:
        find_compiler(load_core(profile.core))
        rows = _rows(run, material)
        counted = count_artifact(_artifact(run, folder), [profile], rows)[0]
        folder.write_count(count_record(counted, str(run.artifact_sha256)))
    except BenchError as problem:
        who = f"{run.key.model} on {run.key.backend}"
        watch.note(f"{who}, {profile.core}: estimated, not counted: {problem}")


def _rows(run: RunRecord, material: Material) -> Floats:
    model = find("models", run.key.model).load()
    fold = material.split.folds[0]
    test = np.concatenate([fold.test_nlos, fold.test_los])
    return recorded_rows(rows_for(material, getattr(model, "reads", ("cir",))), test)


def _artifact(run: RunRecord, folder: ResultFolder) -> Artifact:
    from backends.base import Artifact

    path: Path = folder.artifact_path(run.digest(), 0)
    return Artifact(path, run.precision, opener_of(run.key.backend))  # type: ignore[arg-type]


def _profiles(devices: Iterable[Plugin]) -> Iterator[Profile]:
    for plugin in devices:
        try:
            yield load_device(plugin)
        except BenchError:
            continue


def _one_per_core(profiles: Iterable[Profile]) -> list[Profile]:
    return list({profile.core: profile for profile in profiles}.values())
