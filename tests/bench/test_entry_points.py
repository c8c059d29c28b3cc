"""Entry points of installed distributions are read once, and again where one comes."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench import entry_points
from bench.entry_points import entries


def _install(folder: Path, name: str) -> None:
    """Put a distribution with one model there, as an installer does."""
    own = folder / f"{name}-1.0.dist-info"
    own.mkdir()
    (own / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (own / "entry_points.txt").write_text(f"[bench.models]\n{name} = {name}:Model\n")


def _models() -> set[str]:
    return {entry.name for entry in entries("bench.models")}


def test_what_is_installed_later_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    _install(tmp_path, "first")
    before = _models()
    _install(tmp_path, "second")
    assert "first" in before
    assert _models() == before | {"second"}


def test_files_are_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    _install(tmp_path, "first")
    before = _models()
    monkeypatch.setattr(entry_points, "distributions", None)
    assert _models() == before
