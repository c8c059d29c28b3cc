"""Writing a plug-in package from its templates, all of it or nothing."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Literal

from bench.errors import BenchError, WriteError
from bench.plugins import Group
from bench.scaffold.names import PluginName

Kind = Literal["model", "backend", "dataset", "effect", "simulator", "device"]


@dataclass(frozen=True)
class Layout:
    """What a package of one kind has of its own.

    `file` is the module of the plug-in, `ending` of its class's name, `more` further templates and
    where they go.
    """

    group: Group
    what: str
    file: str
    ending: str
    dependencies: tuple[str, ...]
    more: Mapping[str, str] = field(default_factory=dict)


LAYOUTS: Mapping[Kind, Layout] = {
    "model": Layout(
        "models",
        "A range-error mitigation model",
        "model",
        "Regressor",
        ("numpy", "scikit-learn", "torch", "uwb-bench"),
        {"network.py.tmpl": "src/$module/network.py"},
    ),
    "backend": Layout(
        "backends", "A backend", "backend", "Runtime", ("numpy", "onnx", "uwb-bench")
    ),
    "dataset": Layout(
        "datasets", "A data set", "source", "Recorded", ("numpy", "pandas", "uwb-bench")
    ),
    "effect": Layout("effects", "A physical effect", "effect", "Physics", ("numpy", "uwb-bench")),
    "simulator": Layout(
        "simulators", "A simulator", "simulator", "Simulated", ("numpy", "pandas", "uwb-bench")
    ),
    "device": Layout(
        "devices",
        "A device profile",
        "device",
        "Profile",
        ("uwb-bench",),
        {"profile.toml.tmpl": "src/$module/profile.toml"},
    ),
}
_COMMON = {
    "pyproject.toml.tmpl": "pyproject.toml",
    "init.py.tmpl": "src/$module/__init__.py",
    "typed.tmpl": "src/$module/py.typed",
}


def write_package(name: str, kind: Kind, parent: Path) -> tuple[Path, list[str]]:
    """Write the package `parent/name`; return its folder and its files, relative to it.

    Raises BenchError for a bad name or a folder that is not empty, WriteError where it cannot be
    written; then nothing is left behind.
    """
    names = PluginName(name)
    names.check(LAYOUTS[kind].group)
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
    layout = LAYOUTS[kind]
    values = {
        "name": names.text,
        "module": names.module,
        "class_name": names.words + layout.ending,
        "kind": kind,
        "group": layout.group,
        "what": layout.what,
        "file": layout.file,
        "dependencies": ", ".join(f'"{one}"' for one in layout.dependencies),
    }
    return {
        Template(path).substitute(values): Template(text).substitute(values)
        for path, text in _templates(kind, layout)
    }


def _templates(kind: Kind, layout: Layout) -> Iterator[tuple[str, str]]:
    """Yield the path in the package and the text of every template of a kind."""
    own = {
        "README.md.tmpl": "README.md",
        f"{layout.file}.py.tmpl": f"src/$module/{layout.file}.py",
        f"test_{layout.file}.py.tmpl": "tests/test_$module.py",
        **layout.more,
    }
    for folder, paths in (("common", _COMMON), (kind, own)):
        for template, path in paths.items():
            found = files(f"bench.scaffold.{folder}") / template
            yield path, found.read_text(encoding="utf-8")


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
