"""What a result rests on: hashes of code and files, versions of packages, the commit."""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Iterable
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import bench
from bench.plugins import Plugin, source_path

DECISIVE_PACKAGES = ("numpy", "numba", "onnx", "onnxruntime", "scikit-learn", "scipy", "torch")
UNKNOWN = "unknown (not a git checkout)"
_PATIENCE_S = 10
_SCORING = (
    *("bench/measure/metrics.py", "bench/measure/estimate.py", "bench/measure/profile.py"),
    *("bench/measure/devices", "bench/recordings/window.py", "bench/recordings/splits.py"),
    "bench/runner/evaluate.py",
)


def decisive_versions() -> dict[str, str]:
    """Return the versions of the packages whose arithmetic decides a result."""
    return {name: package_version(name) for name in DECISIVE_PACKAGES}


def package_version(name: str) -> str:
    """Return an installed distribution's version, or 'absent'."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"


def model_code_hash(model: Plugin) -> str:
    """Hash the source of the package a model lives in, and of `zoo`."""
    return _hash_sources({_package_root(model), _package_root_of("zoo")})


def run_code_hash(model: Plugin, backend: Plugin) -> str:
    """Hash every source file that decides a run's figures: model, backend, windowing, scoring."""
    bench_root = _package_root_of("bench").parent
    places = {_package_root(model), _package_root(backend)}
    places |= {_package_root_of("zoo"), _package_root_of("backends")}
    return _hash_sources(places | {bench_root / place for place in _SCORING})


def packages_code_hash(*places: str) -> str:
    """Hash the source of whole packages, named by folder (`zoo`, `bench/physics`)."""
    roots = {place: _package_root_of(place.partition("/")[0]) for place in places}
    return _hash_sources(root.parent / place for place, root in roots.items())


def effects_code_hash(effects: Iterable[Plugin]) -> str:
    """Hash the source of every package that brings effects but ours."""
    return _hash_sources({_package_root(plugin) for plugin in effects if not plugin.built_in})


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file, in hex."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _package_root(plugin: Plugin) -> Path:
    return _package_root_of(plugin.target.partition(":")[0].partition(".")[0])


@cache
def _package_root_of(name: str) -> Path:
    origin = source_path(name)
    return origin.parent if origin.name == "__init__.py" else origin


def _hash_sources(places: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for place in sorted(places):
        files = sorted(place.rglob("*")) if place.is_dir() else [place]
        for file in (f for f in files if f.suffix in {".py", ".toml"}):
            digest.update(str(file.relative_to(place.parent)).encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def commit(places: Iterable[str]) -> str:
    """Return the commit of the source, and whether anything in `places` differs from it."""
    folder = Path(bench.__file__).parents[1]
    if not (folder / ".git").exists():
        return UNKNOWN
    name = _git(folder, "rev-parse", "--short=12", "HEAD")
    changed = _git(folder, "status", "--porcelain", "--", *places)
    return (name or UNKNOWN) + (" with uncommitted changes" if changed else "")


def _git(folder: Path, *words: str) -> str:
    """Return what git prints, nothing where it cannot be asked."""
    try:
        done = subprocess.run(  # noqa: S603 - fixed command
            ["git", "-C", str(folder), *words],  # noqa: S607 - the user's own git
            capture_output=True,
            text=True,
            timeout=_PATIENCE_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip()
