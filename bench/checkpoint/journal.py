"""The steps of a search, kept in files, so that a killed search goes on where it was.

From the same input and seed a search takes the same steps in the same order. So it is simply run
again: steps whose results are kept are read instead of done. What is kept belongs to a fingerprint
of all that decides it (code, tables, options); that of another fingerprint is never read.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from shutil import rmtree
from typing import Any, ParamSpec, TypeVar

from bench.checkpoint.codec import NotPlainError, from_plain, to_plain
from bench.errors import BenchError
from bench.files import read_json, write_atomically
from bench.physics.effect import Effect
from bench.provenance import is_sealed, sealed

P = ParamSpec("P")
T = TypeVar("T")
FOLDER = ".unfinished"


class Journal:
    """Keeps nothing: every step is done."""

    def kept(self, step: Callable[P, T]) -> Callable[P, T]:
        """Return a step; it depends on nothing but its arguments and earlier steps."""
        return step

    def rounds(self, most: int) -> Iterator[int]:
        """Yield 0, 1, ...: asking for the next says that a round is finished."""
        yield from range(most)

    def know(self, kinds: Mapping[str, type[Effect]]) -> None:
        """Take the library of effects whose names the results may hold."""


class Kept(Journal):
    """Keeps the result of every step under `folder`/.unfinished/`fingerprint`, one file each.

    Results pass through the form they are kept in, also the first time, so that a search that was
    interrupted and one that was not go on from the same bits. One without a plain form is not kept
    and comes from its step again. Raises WriteError where the folder cannot be written.
    """

    def __init__(self, folder: Path, fingerprint: str) -> None:
        self._above = folder / FOLDER
        self._folder = self._above / fingerprint
        self._kinds: Mapping[str, type[Effect]] = {}
        self._taken = 0
        self.finished = self._read("rounds.json", int, 0)

    @property
    def started(self) -> bool:
        """True where an earlier search left something."""
        return self._folder.exists()

    @property
    def steps(self) -> int:
        """How many steps of an earlier search are kept."""
        return len(list(self._folder.glob("[0-9]*-*.json")))

    def know(self, kinds: Mapping[str, type[Effect]]) -> None:
        """Take the library of effects whose names the results may hold."""
        self._kinds = {kind.name: kind for kind in kinds.values()}

    def kept(self, step: Callable[P, T]) -> Callable[P, T]:
        """Return the step; called, it gives the result that is kept of it, else keeps its own."""

        def once(*args: P.args, **kwargs: P.kwargs) -> T:
            name = f"{self._taken:04d}-{getattr(step, '__name__', 'step')}.json"
            self._taken += 1
            old: tuple[T, ...] = self._read(name, lambda data: (from_plain(data, self._kinds),), ())
            return old[0] if old else self._keep(name, step(*args, **kwargs))

        return once

    def rounds(self, most: int) -> Iterator[int]:
        """Yield 0, 1, ...: asking for the next says that a round is finished."""
        for turn in range(most):
            yield turn
            if turn + 1 > self.finished:
                self.finished = turn + 1
                self._write("rounds.json", self.finished)

    def clear(self) -> None:
        """Remove what is kept, that of other fingerprints too."""
        rmtree(self._above, ignore_errors=True)

    def _keep(self, name: str, made: T) -> T:
        """Return a result as it is read back from its file, which is written."""
        try:
            data = to_plain(made, self._kinds)
        except NotPlainError:
            return made
        self._write(name, data)
        back: T = from_plain(data, self._kinds)
        return back

    def _write(self, name: str, data: Any) -> None:
        """Write data with the hash of its content."""
        plain = json.loads(json.dumps({"kept": data}))
        write_atomically(self._folder / name, json.dumps(sealed(plain)))

    def _read(self, name: str, form: Callable[[Any], T], default: T) -> T:
        """Return what a file holds, `default` where there is none that can be believed."""
        try:
            content = read_json(self._folder / name)
            return form(content["kept"]) if is_sealed(content) else default
        except (BenchError, ValueError, KeyError, TypeError):
            return default
