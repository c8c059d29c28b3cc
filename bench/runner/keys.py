"""The key of a run: all that decides it, and nothing else."""

from __future__ import annotations

from bench.plugins import Plugin
from bench.provenance import decisive_versions, declared, run_code_hash
from bench.results import RunKey
from bench.runner.material import Material


def run_key(model: Plugin, backend: Plugin, material: Material, seed: int) -> RunKey:
    """Return the key of one run. Raises BenchError where a plug-in cannot be had or asked."""
    says = {"model": declared(model), "backend": declared(backend)}
    threads = [one.threads for one in says.values() if one.threads is not None]
    return RunKey(
        model=model.name,
        backend=backend.name,
        data=material.name,
        data_fingerprint=material.fingerprint,
        split=material.split.name,
        seed=seed,
        code_hash=run_code_hash(model, backend),
        versions=decisive_versions(name for one in says.values() for name in one.rests_on),
        simulated=material.recordings.simulated,
        model_target=model.target,
        backend_target=backend.target,
        declared={kind: one.cache_key for kind, one in says.items() if one.cache_key},
        threads=max(threads, default=None),
    )
