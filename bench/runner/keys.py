"""The key of a run: all that decides it, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.plugins import Plugin
from bench.provenance import decisive_versions, declared, run_code_hash
from bench.results import RunKey

if TYPE_CHECKING:
    from bench.runner.material import Material


@dataclass(frozen=True)
class Head:
    """What a run's key needs to know of recordings: data set, content, split, whether SIMULATED."""

    name: str
    fingerprint: str
    split: str
    simulated: bool


def head_of(material: Material) -> Head:
    """Return what keys need to know of recordings that were read."""
    simulated = material.recordings.simulated
    return Head(material.name, material.fingerprint, material.split.name, simulated)


def run_key(model: Plugin, backend: Plugin, material: Material | Head, seed: int) -> RunKey:
    """Return the key of one run. Raises BenchError where a plug-in cannot be had or asked."""
    head = material if isinstance(material, Head) else head_of(material)
    says = {"model": declared(model), "backend": declared(backend)}
    threads = [one.threads for one in says.values() if one.threads is not None]
    return RunKey(
        model=model.name,
        backend=backend.name,
        data=head.name,
        data_fingerprint=head.fingerprint,
        split=head.split,
        seed=seed,
        code_hash=run_code_hash(model, backend),
        versions=decisive_versions(name for one in says.values() for name in one.rests_on),
        simulated=head.simulated,
        model_target=model.target,
        backend_target=backend.target,
        declared={kind: one.cache_key for kind, one in says.items() if one.cache_key},
        threads=max(threads, default=None),
    )
