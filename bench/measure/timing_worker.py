"""The process that times one configuration: `python -m bench.measure.timing_worker`.

It reads one JSON request per line from standard input and answers each with one JSON line. It
ends when its input does, so it never outlives the process that asked.

    {"do": "open", "path": .., "opener": "module:function", "width": 157, "batches": [1, 4],
     "rows": 256, "preload": ["onnxruntime"]}      -> {"peak_memory_bytes": .., "core": 1}
    {"do": "calibrate", "sample_s": 0.002}         -> {"calls": {"1": 20, "4": 9, "256": 1}}
    {"do": "round", "samples": {"1": 3, "256": 1}} -> {"1": {"samples_us": [..],
                          "core_share": 0.998, "reference_us": [17.1, 17.2]}, "256": {..}}
    {"do": "burst", "batch": 1, "seconds": 0.5}    -> {"calls": 5012, "seconds": 0.5001}
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from itertools import repeat
from pathlib import Path
from typing import IO, Any

import numpy as np
import psutil
from numpy.typing import NDArray

from bench.measure.memory import PeakMemory

Floats = NDArray[np.float32]
Runner = Callable[[Floats], Floats]
THREADS = 1
WARM_UP_S = 0.01  # each sample settles again before it is taken
SETTLE_S = 0.002  # re-warms caches after other workers, or the reference, had the core
REFERENCE_SHARE = 0.5  # of a sample's time
REFERENCE_SIZE = 96  # the reference loop multiplies two such matrices: 108 kB, 1.8 million flops


class Reference:
    """Work that is always the same, so that its time tells what the machine is doing."""

    def __init__(self, size: int = REFERENCE_SIZE) -> None:
        rng = np.random.default_rng(0)
        self.left, self.right = rng.random((2, size, size), dtype=np.float32)
        self.result = np.empty((size, size), np.float32)
        self.calls = 1

    def calibrate(self, sample_s: float) -> None:
        """Warm up, then choose how many products make one sample."""
        for _ in range(50):
            self.time_us()
        fastest_s = min(self.time_us() for _ in range(20)) * 1e-6
        self.calls = max(1, -int(-sample_s // fastest_s))

    def time_us(self) -> float:
        """Return microseconds for one product, the mean over the calibrated number.

        One more goes before them: whatever had the core left its caches cold.
        """
        np.matmul(self.left, self.right, out=self.result)
        start = time.perf_counter_ns()
        for _ in repeat(None, self.calls):
            np.matmul(self.left, self.right, out=self.result)
        return max(time.perf_counter_ns() - start, 1) * 1e-3 / self.calls


class Timer:
    """Times one runner on fixed inputs of several batch sizes."""

    def __init__(self, run: Runner, width: int, batches: list[int]) -> None:
        self.run = run
        self.inputs = {batch: cirs(batch, width) for batch in batches}
        self.calls = dict.fromkeys(batches, 1)
        self.reference = Reference()

    def check(self, batch: int) -> None:
        """Run once. Raises ValueError where the answer is not one finite number per row."""
        answer = np.asarray(self.run(self.inputs[batch]))
        if answer.shape != (batch,) or not np.isfinite(answer).all():
            raise ValueError(f"{batch} CIRs gave an answer of shape {answer.shape} or not finite")

    def calibrate(self, sample_s: float) -> dict[int, int]:
        """Warm up, then choose how many calls make one sample of at least `sample_s` seconds."""
        self.reference.calibrate(sample_s * REFERENCE_SHARE)
        for batch in self.inputs:
            self._run_for(batch, WARM_UP_S)
            fastest = min(self._time(batch, 1) for _ in range(5))
            self.calls[batch] = max(1, -int(-sample_s // fastest))
        return self.calls

    def round(self, samples: Mapping[int, int]) -> dict[int, dict[str, Any]]:
        """Return so many samples of each batch: means over the calibrated calls, microseconds each.

        `core_share` is the processor time they took over the time that passed: below 1 where
        other processes had the core meanwhile. `reference_us` is the reference loop, a product in
        microseconds, just before and just after.
        """
        self.reference.time_us()  # the core wakes up
        found, before = {}, self.reference.time_us()
        for batch, count in samples.items():
            found[batch] = self._sample(batch, count)
            after = self.reference.time_us()
            found[batch]["reference_us"], before = [before, after], after
        return found

    def _sample(self, batch: int, count: int) -> dict[str, Any]:
        self._run_for(batch, SETTLE_S)
        calls = self.calls[batch]
        start, start_busy = time.perf_counter(), time.process_time()
        samples_us = [self._time(batch, calls) * 1e6 / calls for _ in range(count)]
        busy, passed = time.process_time() - start_busy, time.perf_counter() - start
        return {"samples_us": samples_us, "core_share": busy / max(passed, 1e-9)}

    def burst(self, batch: int, seconds: float) -> dict[str, float]:
        """Run without pause for about `seconds`; return how many calls that took, and how long."""
        start = time.perf_counter()
        calls = self._run_for(batch, seconds)
        return {"calls": calls, "seconds": time.perf_counter() - start}

    def _time(self, batch: int, calls: int) -> float:
        run, rows = self.run, self.inputs[batch]
        start = time.perf_counter_ns()
        for _ in repeat(None, calls):
            run(rows)
        return max(time.perf_counter_ns() - start, 1) * 1e-9

    def _run_for(self, batch: int, seconds: float) -> int:
        calls = 0
        end = time.perf_counter() + seconds
        while calls < 1 or time.perf_counter() < end:
            self._time(batch, self.calls[batch])
            calls += self.calls[batch]
        return calls


def cirs(rows: int, width: int) -> Floats:
    """Return made-up CIR magnitudes [rows, width]: noise and a decaying tail, in counts."""
    rng = np.random.default_rng(rows)
    level = 100 + 10_000 * np.exp(-np.maximum(np.arange(width) - 5, 0) / 20)
    return (level * rng.rayleigh(1, (rows, width))).astype(np.float32)


def pin() -> int | None:
    """Pin this process to the last core it may use; None where the system does not allow it.

    Low-numbered cores serve most interrupts. Every worker takes the same core: one runs at a time.
    """
    process = psutil.Process()
    try:
        core = int(max(process.cpu_affinity()))
        process.cpu_affinity([core])
    except (AttributeError, OSError, psutil.Error):
        return None
    return core


def open_runner(request: dict[str, Any]) -> tuple[Timer, dict[str, Any]]:
    """Open the file and run every latency batch once, noting the memory that takes; then pin.

    Files are opened, and C compiled, on any core: nothing is timed yet. The runtime is imported
    first, so that the memory is the model's: weights, arenas, buffers.
    """
    module, _, function = request["opener"].partition(":")
    opener = getattr(importlib.import_module(module), function)
    for name in request["preload"]:
        with suppress(ImportError):
            importlib.import_module(name)
    memory = PeakMemory()
    runner = opener(Path(request["path"]), THREADS)
    timer = Timer(runner, request["width"], [*request["batches"], request["rows"]])
    for batch in request["batches"]:
        timer.check(batch)
    peak = memory.peak_bytes()
    timer.check(request["rows"])
    gc.collect()
    gc.freeze()  # what is here stays: collecting before a request then takes no time
    return timer, {"peak_memory_bytes": peak, "core": pin()}


def serve(requests: IO[str], answers: IO[str]) -> None:
    """Answer requests until there are no more; an exception is an answer too."""
    timer: Timer | None = None
    for line in requests:
        request = json.loads(line)
        try:
            if request["do"] == "open":
                timer, answer = open_runner(request)
            else:
                assert timer is not None
                answer = _timed(timer, request)
        except Exception as problem:
            answer = {"error": f"{type(problem).__name__}: {problem}"}
        print(json.dumps(answer), file=answers, flush=True)


def _timed(timer: Timer, request: dict[str, Any]) -> dict[str, Any]:
    """Do one timing request with the garbage collector out of the way."""
    gc.collect()
    gc.disable()
    try:
        match request["do"]:
            case "calibrate":
                return {"calls": timer.calibrate(request["sample_s"])}
            case "burst":
                return timer.burst(request["batch"], request["seconds"])
            case _:
                wanted = {int(batch): count for batch, count in request["samples"].items()}
                return {str(batch): one for batch, one in timer.round(wanted).items()}
    finally:
        gc.enable()


def main() -> None:
    """Serve on standard input and output; whatever a library prints goes to standard error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the asking process ends us by closing the pipe
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), 1)
    with suppress(BrokenPipeError):
        serve(sys.stdin, answers)


if __name__ == "__main__":
    main()
