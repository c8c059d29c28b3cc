"""What a page says it was made by."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench import provenance
from bench.cli.reproduce_page import _typed


@pytest.mark.parametrize(
    ("typed", "shown"),
    [
        ("reproduce all --out /tmp/x --quick", "reproduce all --quick"),
        ("reproduce all --out=/tmp/x", "reproduce all"),
        ("reproduce all --jobs 2", "reproduce all --jobs 2"),
    ],
)
def test_the_result_folder_is_left_out_of_the_command(typed: str, shown: str) -> None:
    assert " ".join(_typed(typed.split())) == shown


def test_the_commit_says_whether_the_source_differs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    git = provenance._git
    (tmp_path / "zoo").mkdir()
    (tmp_path / "zoo" / "a.py").write_text("")
    monkeypatch.setattr(provenance, "__file__", str(tmp_path / "bench" / "provenance.py"))
    assert provenance.commit(["zoo"]) == provenance.UNKNOWN
    git(tmp_path, "init", "-q")
    for command in (("add", "."), ("commit", "-q", "-m", "first")):
        git(tmp_path, "-c", "user.name=a", "-c", "user.email=a@b.example", *command)
    name = provenance.commit(["zoo"])
    assert len(name) == 12
    (tmp_path / "zoo" / "a.py").write_text("1")
    assert provenance.commit(["zoo"]) == f"{name} with uncommitted changes"


def test_without_git_the_commit_is_unknown(tmp_path: Path) -> None:
    assert provenance._git(tmp_path, "rev-parse", "HEAD") == ""
