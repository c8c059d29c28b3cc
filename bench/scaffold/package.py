"""Writing a plug-in package from its templates, all of it or nothing."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Literal

from bench.errors import BenchError, WriteError
from bench.plugins import Group
from bench.scaffold.names import PluginName

Kind = Literal["model", "dataset"]
_GROUPS: Mapping[Kind, Group] = {"model": "models", "dataset": "datasets"}
_CLASS_ENDINGS: Mapping[Kind, str] = {"model": "Regressor", "dataset": "Recorded"}
_COMMON = {
    "pyproject.toml.tmpl": "pyproject.toml",
    "README.md.tmpl": "README.md",
    "init.py.tmpl": "src/$module/__init__.py",
    "typed.tmpl": "src/$module/py.typed",
}
_LAYOUT: Mapping[Kind, Mapping[str, str]] = {
    "model": {
        **_COMMON,
        "model.py.tmpl": "src/$module/model.py",
        "network.py.tmpl": "src/$module/network.py",
        "test_model.py.tmpl": "tests/test_$module.py",
    },
    "dataset": {
        **_COMMON,
        "source.py.tmpl": "src/$module/source.py",
        "test_source.py.tmpl": "tests/test_$module.py",
    },
}


def write_package(name: str, kind: Kind, parent: Path) -> tuple[Path, list[str]]:
    """Write the package `parent/name`; return its folder and its files, relative to it.

    Raises BenchError for a bad name or a folder that is not empty, WriteError where it cannot be
    written; then nothing is left behind.
    """
    names = PluginName(name)
    names.check(_GROUPS[kind])
    target = parent / name
    _check_free(target)
    content = _render(names, kind)
    with _all_or_nothing(target) as scratch:
        for relative, text in content.items():
            path = scratch / relative
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
    return target, sorted(content)


def _render(names: PluginName, kind: Kind) -> dict[str, str]:
    """Return the text of every file by its path in the package."""
    class_name = names.words + _CLASS_ENDINGS[kind]
    values = {"name": names.text, "module": names.module, "class_name": class_name}
    folder = files(f"bench.scaffold.{kind}")
    return {
        Template(path).substitute(values): Template(
            (folder / template).read_text(encoding="utf-8")
        ).substitute(values)
        for template, path in _LAYOUT[kind].items()
    }


def _check_free(target: Path) -> None:
    if target.is_symlink() or (target.exists() and not target.is_dir()):
        raise BenchError(f"{target} is already there, expected no such name or an empty folder")
    if target.is_dir() and any(target.iterdir()):
        raise BenchError(f"{target} is not empty, expected no such name or an empty folder")


@contextmanager
def _all_or_nothing(target: Path) -> Iterator[Path]:
    """Yield a folder beside `target` that becomes `target` only if the block succeeds."""
    scratch: Path | None = None
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        scratch = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
        package = scratch / target.name  # mkdtemp's own folder is private to this user
        package.mkdir()
        yield package
        if target.is_dir():
            target.rmdir()
        package.rename(target)
    except OSError as problem:
        raise WriteError(f"cannot write {target}: {problem.strerror or problem}") from problem
    finally:
        if scratch is not None:
            shutil.rmtree(scratch, ignore_errors=True)
