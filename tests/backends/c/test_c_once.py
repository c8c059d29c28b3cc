"""C is compiled once in a run, whichever of its processes asks."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from backends import SCRATCH
from backends.c import run
from backends.c.compile import PLAIN
from bench.runner.scratch import scratch


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Return the folders that something was compiled in."""
    folders: list[Path] = []
    really = run.compile_shared

    def counting(files, folder, flags):
        folders.append(folder)
        return really(files, folder, flags)

    monkeypatch.setattr(run, "compile_shared", counting)
    return folders


def test_the_same_source_is_compiled_once_in_a_run(built, compiled) -> None:
    source = run.generate(built("none", "fp32").path, "fp32")
    rows = np.ones((3, run.row_width(source)), np.float32)
    with scratch():
        first, second = run.load(source, PLAIN), run.load(source, PLAIN)
        assert len(compiled) == 1
        run.load(source, (*PLAIN, "-DUWB_PLAIN"))
        assert len(compiled) == 2
        kept = Path(os.environ[SCRATCH])
        assert len(list(kept.iterdir())) == 2  # two libraries, nothing else left behind
        assert kept.stat().st_mode & 0o077 == 0
    assert not kept.exists()
    assert np.array_equal(first(rows), second(rows))


def test_outside_a_run_nothing_is_kept(built, compiled, monkeypatch) -> None:
    monkeypatch.delenv(SCRATCH, raising=False)
    source = run.generate(built("none", "fp32").path, "fp32")
    run.load(source, PLAIN)
    run.load(source, PLAIN)
    assert len(compiled) == 2
    assert not any(folder.exists() for folder in compiled)


def test_a_run_inside_another_leaves_the_outer_one_its_folder() -> None:
    with scratch():
        outer = os.environ[SCRATCH]
        with scratch():
            assert os.environ[SCRATCH] != outer
        assert os.environ[SCRATCH] == outer
