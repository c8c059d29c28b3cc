from __future__ import annotations

import sys
from pathlib import Path

import pytest

from bench.errors import BenchError
from bench.measure.counting import find_compiler, load_core
from bench.measure.counting.emulate import check_tools

sys.path.insert(0, str(Path(__file__).parent))


def _core():
    core = load_core("cortex-m4f")
    try:
        check_tools()
        find_compiler(core)
    except BenchError as problem:
        pytest.skip(str(problem))
    return core


@pytest.fixture
def tools():
    """The core to count on; skips where a compiler or an emulator is missing."""
    return _core()


@pytest.fixture(scope="module")
def shared_tools(tmp_path_factory):
    """The same for fixtures of a whole module, with a cache of their own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BENCH_CACHE", str(tmp_path_factory.mktemp("images")))
        yield _core()
