"""Result folders: records as `bench run` writes them, then edited by somebody else."""

from __future__ import annotations

import json
import random
from contextlib import suppress
from pathlib import Path
from typing import Any

from bench.provenance import SEAL, json_digest, sealed
from tests import result_files
from tests.fuzz.hostile import damaged, odd_file, text

LEAVES: tuple[Any, ...] = (None, True, -1, 0, 1e308, 10**400, [], {}, [[]], {"a": {"b": 1}}, "")
RAW = ("NaN", "Infinity", "1e400", "-1e400", "[" * 100_000, "9" * 5000, '"\\ud800"')
MARK = "\x00here\x00"


def result_folder(rng: random.Random, folder: Path) -> tuple[Path, str]:
    """Write a result folder, honest, edited or none; return its path and what it is."""
    out = folder / "results"
    if rng.random() < 0.08:
        return out, "results " + odd_file(rng, out)
    first = result_files.run("remnet", "fp32")
    others = [result_files.run("mlp", "int8"), result_files.skipped("svm", "qat", text(rng))]
    records = [first, *others, result_files.run("none", data="apartment")]
    _write(out, [*records, result_files.timing(first)])
    edits = rng.choice((0, 1, 1, 2, 4))
    done = [_edit(rng, path) for path in rng.choices(sorted(out.rglob("*.json")), k=edits)]
    return out, "results " + (" + ".join(done) or "honest")


def _write(out: Path, records: list[Any]) -> None:
    for record in records:
        with suppress(ValueError):  # a lone surrogate in a reason
            result_files.write(out, record)


def _edit(rng: random.Random, path: Path) -> str:
    """Spoil one record; return how."""
    if rng.random() < 0.2 or not path.is_file():
        return odd_file(rng, path)
    if rng.random() < 0.15:
        path.write_bytes(damaged(rng, path.read_bytes()))
        return "damaged"
    try:
        content = json.loads(path.read_text())
        keys = edit_leaf(rng, content)
    except (ValueError, RecursionError):
        return "damaged already"
    if rng.random() < 0.7:
        path = _sealed_again(path, content)
    written = json.dumps(content).replace(json.dumps(MARK), rng.choice(RAW))
    path.write_text(written)
    return keys


def _sealed_again(path: Path, content: Any) -> Path:
    """Give an edited record the hash and the name it should have, as a cunning editor would."""
    content.pop(SEAL, None)
    content[SEAL] = sealed(content)[SEAL]
    with suppress(KeyError, TypeError, AttributeError):
        if content["kind"] == "run":
            path.unlink()
            path = path.with_name(f"{json_digest(content['key'])}.json")
    return path


def edit_leaf(rng: random.Random, content: Any) -> str:
    """Replace or remove one value somewhere inside; return its keys."""
    keys: list[str] = []
    while True:
        if not isinstance(content, dict) or not content:
            return ".".join(keys)
        key = rng.choice(sorted(content))
        keys.append(key)
        inner = content[key]
        if isinstance(inner, list) and inner and isinstance(inner[0], dict) and rng.random() < 0.7:
            inner = inner[0]
        if not isinstance(inner, dict) or rng.random() < 0.15:
            break
        content = inner
    if rng.random() < 0.15:
        del content[key]
    else:
        content[key] = rng.choice((*LEAVES, text(rng), text(rng), MARK, MARK))
    return ".".join(keys)
