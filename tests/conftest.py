"""Every test runs with its own cache and one thread, so results depend on nothing else."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["BENCH_WAIT_S"] = "0"  # the tests themselves keep the machine busy


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path_factory.mktemp("cache")))


@pytest.fixture(scope="session")
def real_data() -> Path:
    """Return the folder of real recordings; skips the test, saying so, where there is none."""
    named = os.environ.get("BENCH_DATA")
    if not named or not Path(named).is_dir():
        pytest.skip("real recordings not present: set BENCH_DATA to their folder")
    return Path(named)
