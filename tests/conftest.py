"""Every test runs with its own cache and one thread, so results depend on nothing else."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import pytest

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["BENCH_WAIT_S"] = "0"  # the tests themselves keep the machine busy

TOGETHER = ("tests/backends/",)  # folders whose fixtures cost more than their tests
CLUSTER = (  # what a cluster of processes is started for
    "tests/bench/reproduce/test_sweep.py",
    "tests/bench/runner/test_spread_fits.py",
    "tests/bench/discrepancy/select/test_side_by_side.py",
)
LONG = ("tests/fuzz/", "tests/bench/cli/test_plugin.py", "tests/bench/reproduce/")
FIRST = (*TOGETHER, *CLUSTER, *LONG)  # or one process waits for the other in the end


@pytest.fixture(scope="session")
def _caches(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Return fresh paths; `mktemp` per test looks through those of all tests before."""
    folder = tmp_path_factory.mktemp("caches")
    return (folder / str(number) for number in count())


@pytest.fixture(autouse=True)
def _own_cache(_caches: Iterator[Path], monkeypatch: pytest.MonkeyPatch) -> None:
    own = next(_caches)
    own.mkdir()
    monkeypatch.setenv("BENCH_CACHE", str(own))
    _read_translations_once()
    # A diagnosis goes on where a step fails; an assertion is a mistake of ours, and is to be seen.
    monkeypatch.setattr("bench.discrepancy.select.guard.Guard.through", (AssertionError,))


def _read_translations_once() -> None:
    """Have torch keep its ONNX translations: it reads 500 anew per export, half of a small one."""
    module = sys.modules.get("torch.onnx._internal.exporter._registration")
    registry = getattr(module, "ONNXRegistry", None)
    if registry is not None and "from_torchlib" in vars(registry):
        read = registry.from_torchlib
        if not hasattr(read, "cache_info"):
            registry.from_torchlib = staticmethod(cache(read))


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Return the folder of real recordings; skips the test, saying so, where there is none."""
    named = os.environ.get("BENCH_DATA")
    if not named or not Path(named).is_dir():
        pytest.skip("real recordings not present: set BENCH_DATA to their folder")
    return Path(named)


@pytest.fixture(scope="session")
def cluster() -> Iterator[str]:
    """Start a Dask worker with a scheduler on this machine; yield its address."""
    distributed = pytest.importorskip("distributed")
    local = distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=True, dashboard_address=None,
        protocol="tcp://", silence_logs=50,
    )  # fmt: skip
    with local:
        yield local.scheduler_address


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes long, so that two processes end at about the same time."""
    items.sort(key=lambda item: not item.nodeid.startswith(FIRST))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Keep the tests of a file in one process: what they share is then made once."""
    from xdist.scheduler import LoadScopeScheduling

    class ByFile(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            if nodeid.startswith(CLUSTER):
                return "cluster"
            folder = next((one for one in TOGETHER if nodeid.startswith(one)), "")
            return folder or nodeid.partition("::")[0]

    config.option.loadscopereorder = False
    return ByFile(config, log)
