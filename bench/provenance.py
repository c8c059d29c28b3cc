"""What a result rests on: the one place that hashes code, versions, files and content."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import psutil

from bench.errors import BenchError, foreign
from bench.files import cache_dir, read_json, write_atomically
from bench.plugin_source import places_of
from bench.plugins import Plugin, source_path

DECISIVE_PACKAGES = (
    *("numba", "numpy", "onnx", "onnxruntime", "onnxscript", "pandas", "pyarrow"),
    *("scikit-learn", "scipy", "torch", "uwb-bench"),
)
UNKNOWN = "unknown (not a git checkout)"
SEAL = "content_sha256"
_PATIENCE_S = 10
_SETTLED_S = 2.0
_SAYS, _THREADS = "says", "threads"
_THREAD_PREFIXES = ("OMP_", "MKL_", "KMP_", "GOMP_", "OPENBLAS_", "BENCH_THREADS")
_SET_BY_LIBRARIES = ("KMP_DUPLICATE_LIB_OK", "KMP_INIT_AT_FORK")  # when imported; no thread more
_SCORING = (
    *("bench/measure/metrics.py", "bench/recordings/window.py", "bench/recordings/splits.py"),
    *("bench/runner/evaluate.py", "bench/runner/material.py", "bench/runner/further.py"),
    *("bench/recordings/combine.py", "bench/recordings/draws.py", "bench/runner/rounding.py"),
)


def json_digest(content: Any, digits: int = 20) -> str:
    """Return hex digits that stand for plain data: its JSON with sorted keys, hashed."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:digits]


def sealed(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return a JSON object with the hash of all else in it, to be believed when read back."""
    bare = {name: value for name, value in content.items() if name != SEAL}
    return {**bare, SEAL: json_digest(bare, 64)}


def is_sealed(content: Any) -> bool:
    """Return True where a JSON object is what `sealed` gave, unedited."""
    return isinstance(content, dict) and content.get(SEAL) == sealed(content)[SEAL]


def decisive_versions(declared: Iterable[str] = ()) -> dict[str, str]:
    """Return the versions of the packages whose arithmetic decides a result, and those declared."""
    return {name: package_version(name) for name in sorted({*DECISIVE_PACKAGES, *declared})}


@cache  # what was imported stays what it is
def package_version(name: str) -> str:
    """Return an installed distribution's version, or 'absent'."""
    try:
        return version(name)
    except (PackageNotFoundError, ValueError):
        return "absent"


@dataclass(frozen=True)
class Declared:
    """What a plug-in says of itself that no source or fixed list tells.

    `rests_on`: distributions whose versions decide its figures. `cache_key`: text that changes
    with the files and environment variables it reads. `threads`: how many the figures were made
    with, None where it says that their number changes nothing.
    """

    rests_on: tuple[str, ...] = ()
    cache_key: str = ""
    threads: int | None = None


def declared(plugin: Plugin) -> Declared:
    """Ask a model or backend what it rests on. Raises BenchError where it cannot be made or asked.

    It says so with `rests_on`, `cache_key()` and `bits_depend_on_threads`; without the last its
    figures are taken to depend on the number of threads.
    """
    says = _said_before(plugin) or _asked(plugin)
    return Declared(says.rests_on, says.cache_key, _threads() if says.depends else None)


@dataclass(frozen=True)
class _Says:
    """What a plug-in says of itself: as `Declared`, `depends` whether threads change its bits."""

    rests_on: tuple[str, ...]
    cache_key: str
    depends: bool


def _asked(plugin: Plugin) -> _Says:
    before = (
        None if "torch" in sys.modules else _thread_settings()
    )  # imports change the environment
    made = plugin.make()
    if before is not None and "torch" in sys.modules:
        keep(_THREADS, before, _threads())
    with foreign(f"{plugin.name!r} cannot say what it rests on"):
        rests_on = getattr(made, "rests_on", ())
        if isinstance(rests_on, str) or not all(isinstance(name, str) for name in rests_on):
            raise BenchError(f"{plugin.name!r}: rests_on must be distribution names")
        key = made.cache_key() if hasattr(made, "cache_key") else ""
        depends = bool(getattr(made, "bits_depend_on_threads", True))
    if plugin.built_in and not key:  # ours read nothing else: what they say changes with the code
        _keep_says(cache_dir(), *_source_of(plugin), tuple(rests_on), depends)
    return _Says(tuple(rests_on), str(key), depends)


@lru_cache(maxsize=256)  # asked for every pair, written once
def _keep_says(_: Path, target: str, model: str, rest: str, rests_on: Any, depends: bool) -> None:
    keep(_SAYS, [target, model, rest], [list(rests_on), depends])


def _said_before(plugin: Plugin) -> _Says | None:
    """Return what one of ours said when its source was the same: it need not be imported."""
    if not plugin.built_in or "torch" in sys.modules:
        return None
    if (found := kept(_SAYS, _source_of(plugin))) is None:
        return None
    return _Says(tuple(found[0]), "", bool(found[1]))


def _source_of(plugin: Plugin) -> list[str]:
    return [plugin.target, model_code_hash(plugin), packages_code_hash("backends")]


def _threads() -> int:
    """Return the number of threads that arithmetic is done with in this process."""
    if "torch" in sys.modules:
        return _torch_threads()
    if found := kept(_THREADS, _thread_settings()):
        return int(found)
    keep(_THREADS, _thread_settings(), answer := _torch_threads())
    return answer


def _torch_threads() -> int:
    import torch

    return torch.get_num_threads()


def _thread_settings() -> list[Any]:
    """Return all that torch chooses its number of threads by when it is imported."""
    ours = {name for name in os.environ if name.startswith(_THREAD_PREFIXES)}
    said = {name: os.environ[name] for name in ours - set(_SET_BY_LIBRARIES)}
    me = psutil.Process()
    cores = list(me.cpu_affinity()) if hasattr(me, "cpu_affinity") else []
    return [sorted(said.items()), cores, psutil.cpu_count(), package_version("torch")]


def keep(kind: str, question: Any, answer: Any) -> None:
    """Keep a plain answer to a plain question for later processes, where the cache can be written.

    The question must hold all that decides the answer.
    """
    with suppress(BenchError, OSError):
        content = sealed({"question": question, "answer": answer})
        write_atomically(_kept_place(kind, question), json.dumps(content))


def kept(kind: str, question: Any) -> Any:
    """Return the answer kept to a question; None where there is none that can be believed."""
    try:
        found = read_json(_kept_place(kind, question))
    except (BenchError, OSError):
        return None
    same = is_sealed(found) and found.get("question") == json.loads(json.dumps(question))
    return found.get("answer") if same else None


def _kept_place(kind: str, question: Any) -> Path:
    return cache_dir() / "answers" / f"{kind}-{json_digest(question)}.json"


def model_code_hash(model: Plugin) -> str:
    """Hash the source of the distribution a model comes from, of `zoo`, and what names it."""
    return _hash_sources({*places_of(model), _package_root_of("zoo")}, [model.target])


def run_code_hash(model: Plugin, backend: Plugin) -> str:
    """Hash every source file that decides a run's figures: model, backend, windowing, scoring."""
    bench_root = _package_root_of("bench").parent
    places = {*places_of(model), *places_of(backend)}
    places |= {_package_root_of("zoo"), _package_root_of("backends")}
    places |= {bench_root / place for place in _SCORING}
    return _hash_sources(places, [model.target, backend.target])


def packages_code_hash(*places: str) -> str:
    """Hash the source of whole packages, named by folder or file (`zoo`, `bench/physics`)."""
    roots = {place: _package_root_of(place.partition("/")[0]) for place in places}
    return _hash_sources(root.parent / place for place, root in roots.items())


def plugins_code_hash(found: Iterable[Plugin]) -> str:
    """Hash names, targets and source of plug-ins; of ours the source is hashed elsewhere."""
    some = list(found)
    places = {place for plugin in some if not plugin.built_in for place in places_of(plugin)}
    return _hash_sources(places, sorted(f"{plugin.name}={plugin.target}" for plugin in some))


def modules_code_hash(modules: Iterable[str]) -> str:
    """Hash the source of modules by their dotted names."""
    return _hash_sources(source_path(module) for module in modules)


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file, in hex."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


@cache
def _package_root_of(name: str) -> Path:
    origin = source_path(name)
    return origin.parent if origin.name == "__init__.py" else origin


def _hash_sources(places: Iterable[Path], texts: Iterable[str] = ()) -> str:
    digest = hashlib.sha256()
    for text in texts:
        digest.update(text.encode() + b"\0")
    for place in sorted(places):
        above = len(str(place.parent))
        for path in _sources(place):
            digest.update(f"{path[above:]}\0{_source_digest(path)}".encode())
    return digest.hexdigest()[:16]


def _sources(place: Path) -> list[str]:
    """Return the source files of a folder in order, or a file itself."""
    if not place.is_dir():
        return [str(place)] if place.is_file() else []
    found = (f"{at}{os.sep}{name}" for at, _, names in os.walk(place) for name in names)
    return sorted(path for path in found if path.endswith((".py", ".toml")))


def _source_digest(path: str) -> str:
    """Return a file's hash, read again only where it has changed, or has only just."""
    seen = os.stat(path)  # noqa: PTH116 - half a second sooner over the pairs of a board
    unsettled = time.time() - seen.st_mtime < _SETTLED_S  # the clock's step may hide a change
    moment = time.monotonic() if unsettled else 0.0
    return _digest_as_of(path, (seen.st_mtime_ns, seen.st_size, seen.st_ino), moment)


@lru_cache(maxsize=4096)
def _digest_as_of(path: str, seen: tuple[int, int, int], moment: float) -> str:
    del seen, moment
    return file_sha256(Path(path))


def commit(places: Iterable[str]) -> str:
    """Return the commit of the source, and whether anything in `places` differs from it."""
    folder = Path(__file__).parents[1]
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
