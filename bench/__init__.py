"""uwb-bench: benchmark UWB range-error mitigation, and diagnose what a simulator leaves out.

Recordings are named (`bench data list`), a file's path, a pandas frame or `Recordings`; everything
the command line does can be asked for here, with the same checks.

>>> import bench
>>> runs = bench.run(model="remnet", backend="int8", data="rooms")  # doctest: +SKIP
>>> runs.frame()  # doctest: +SKIP
>>> found = bench.diagnose("mine.parquet", simulated="rooms", out="diagnosis")  # doctest: +SKIP
>>> made = bench.simulate("rooms", geometry="rooms", rows=40)
>>> bench.read(made.recordings.frame).errors_m().shape
(40,)
>>> bench.challenge(cases=40, out="challenge").scores  # doctest: +SKIP
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.challenge.api import run_challenge as challenge
    from bench.errors import BenchError as BenchError
    from bench.recordings.io import read_recordings as read_recordings
    from bench.recordings.io import write_recordings as write_recordings
    from bench.recordings.open import read as read
    from bench.recordings.table import Recordings as Recordings
    from bench.runner.api import run as run
    from bench.runner.diagnosis import diagnose as diagnose
    from bench.runner.planning import plan as plan
    from bench.runner.simulation import simulate as simulate
    from bench.runner.worth.api import worth as worth

__version__ = "0.1.0"
_HOMES = {
    "BenchError": "bench.errors",
    "Recordings": "bench.recordings.table",
    "diagnose": "bench.runner.diagnosis",
    "plan": "bench.runner.planning",
    "read": "bench.recordings.open",
    "read_recordings": "bench.recordings.io",
    "run": "bench.runner.api",
    "simulate": "bench.runner.simulation",
    "worth": "bench.runner.worth.api",
    "write_recordings": "bench.recordings.io",
}
__all__ = [*_HOMES, "__version__", "challenge"]
_named = lazily(__name__, _HOMES)


def __getattr__(name: str) -> Any:
    if name == "challenge":  # a package that can be called: see there
        return import_module("bench.challenge")
    return _named(name)
