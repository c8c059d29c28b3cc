"""One timing worker seen from the process that asks it."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping
from contextlib import suppress
from types import TracebackType
from typing import IO, Any, Self

from bench.errors import BenchError

_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
_ENDED = ""


class WorkerProcess:
    """A fresh Python process running `bench.measure.timing_worker`; a context manager.

    `ask` is `send` and `receive`; each raises BenchError where the worker reported an error, died,
    or took longer than `timeout_s` to answer.
    """

    def __init__(self, label: str, timeout_s: float) -> None:
        self._label, self._timeout_s = label, timeout_s
        self._errors: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed in __exit__
        self._process = subprocess.Popen(
            [sys.executable, "-m", "bench.measure.timing_worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
            env=_environment(),
        )
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        threading.Thread(target=self._listen, daemon=True).start()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._process.kill()
        self._process.wait()
        self._errors.close()
        with suppress(OSError):  # what was never read by a dead worker
            assert self._process.stdin is not None
            self._process.stdin.close()

    def ask(self, **request: Any) -> Mapping[str, Any]:
        """Send one request and return its answer."""
        self.send(**request)
        return self.receive()

    def send(self, **request: Any) -> None:
        """Send one request and return at once."""
        assert self._process.stdin is not None
        with suppress(OSError):  # a dead worker is noticed by `receive`, which knows why
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()

    def receive(self) -> Mapping[str, Any]:
        """Return the answer to the oldest unanswered request."""
        try:
            line = self._answers.get(timeout=self._timeout_s)
        except queue.Empty:
            raise self._failed(f"no answer within {self._timeout_s:g} s") from None
        if line == _ENDED:
            raise self._failed(self._last_words())
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            raise self._failed(answer["error"])
        return answer

    def _listen(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as lines:
            for line in lines:
                self._answers.put(line)
        self._answers.put(_ENDED)

    def _failed(self, why: str) -> BenchError:
        return BenchError(f"timing {self._label} failed: {why}")

    def _last_words(self) -> str:
        """Return how the process ended and the last line it wrote to standard error."""
        code = self._process.wait(timeout=self._timeout_s)
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        how = f"killed by signal {-code}" if code < 0 else f"exit code {code}"
        return f"the worker ended ({how})" + (f": {lines[-1]}" if lines else "")


def _environment() -> dict[str, str]:
    """Return the environment of a worker: ours, one thread, and everything we can import."""
    path = os.pathsep.join(entry for entry in sys.path if entry)
    return {**os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": path}
