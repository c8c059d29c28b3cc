"""`bench doctor`: what this machine has, what is missing and how to get it."""

from __future__ import annotations

import json
import os
import platform
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Literal, get_args

import click

from bench.cli.console import say
from bench.errors import BenchError, foreign
from bench.files import cache_dir, write_atomically
from bench.measure.cpu import INTEGER_DOT
from bench.measure.energy import NoMeter, host_meter
from bench.measure.machine import describe_machine
from bench.plugins import Group, plugins

PACKAGES = (
    *("torch", "onnx", "onnxruntime", "onnxscript", "numpy", "numba", "scipy", "scikit-learn"),
    *("pandas", "pyarrow", "matplotlib", "pooch", "psutil", "rich", "click"),
)
Verdict = Literal["ok", "missing", "info"]


@dataclass(frozen=True)
class Finding:
    """One thing looked at: `verdict` "missing" means something does not work without it."""

    what: str
    verdict: Verdict
    found: str
    remedy: str = ""


@click.command(epilog="Example: bench doctor --json")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of lines.")
def command(as_json: bool) -> None:
    """Say what this machine has, what is missing and how to get it.

    Exit code 1 where something needed is missing, else 0.
    """
    findings = [
        *_python(),
        *_machine(),
        *_counting(),
        *_places(),
        *_data_sets(),
        *_broken_plugins(),
    ]
    if as_json:
        say(json.dumps([asdict(one) for one in findings], indent=1))
    else:
        for one in findings:
            _print(one)
    missing = any(one.verdict == "missing" for one in findings)
    click.get_current_context().exit(1 if missing else 0)


def _print(one: Finding) -> None:
    mark = {"ok": "ok     ", "missing": "MISSING", "info": "note   "}[one.verdict]
    remedy = f"\n          -> {one.remedy}" if one.remedy else ""
    say(f"{mark}  {one.what}: {one.found}{remedy}")


def _python() -> Iterator[Finding]:
    new_enough = sys.version_info >= (3, 11)
    remedy = "" if new_enough else "install Python 3.11 or newer"
    verdict: Verdict = "ok" if new_enough else "missing"
    yield Finding("Python", verdict, platform.python_version(), remedy)
    for name in PACKAGES:
        try:
            yield Finding(name, "ok", version(name))
        except PackageNotFoundError:
            how = f"pip install -c constraints.txt {name}"
            yield Finding(name, "missing", "not installed", how)


def _machine() -> Iterator[Finding]:
    machine = describe_machine()
    sets = ", ".join(machine["instruction_sets"]) or "not listed by this system"
    yield Finding("processor", "ok", f"{machine['cpu']}, {machine['cores']} cores")
    yield Finding("memory", "ok", f"{machine['memory_gib']} GiB")
    yield Finding("instruction sets", "info", sets, _integer_advice(machine["instruction_sets"]))
    pinning = "yes" if hasattr(os, "sched_setaffinity") else "no: timings are not pinned to a core"
    yield Finding("core pinning", "info", pinning)
    meter = host_meter()
    advice = "energy stays an estimate from device profiles" if isinstance(meter, NoMeter) else ""
    yield Finding("energy counters (RAPL)", "info", meter.how, advice)


def _counting() -> Iterator[Finding]:
    """Yield what `bench count` needs: an emulator, and a cross compiler."""
    from bench.measure.counting import find_compiler, load_core
    from bench.measure.counting.emulate import check_tools

    try:
        check_tools()
        yield Finding("emulator of microcontrollers", "ok", "unicorn")
    except BenchError as problem:
        yield Finding("emulator of microcontrollers", "info", "not here", str(problem))
    try:
        compiler = find_compiler(load_core("cortex-m4f"))
        yield Finding("cross compiler", "ok", f"{compiler.kind} {compiler.version}")
    except BenchError as problem:
        yield Finding("cross compiler", "info", "not here", str(problem))


def _integer_advice(sets: list[str]) -> str:
    if set(INTEGER_DOT) & set(sets) or not sets:
        return ""
    return (
        "no 8-bit dot products (VNNI, SDOT): int8 runs, but gains little speed here; elsewhere "
        "than in `bench`, give ONNX Runtime session.x64quantprecision = 1, or sums overflow"
    )


def _places() -> Iterator[Finding]:
    folder = cache_dir()
    probe = folder / ".doctor"
    try:
        write_atomically(probe, "probe")
        probe.unlink()
        yield Finding("cache folder", "ok", f"{folder} (writable)")
    except BenchError as problem:
        yield Finding("cache folder", "missing", str(problem), "set BENCH_CACHE to a folder")
    named = os.environ.get("BENCH_DATA")
    if named is None:
        advice = "set BENCH_DATA to a folder of recordings, or: bench data fetch NAME"
        yield Finding("BENCH_DATA", "info", "not set", advice)
    elif Path(named).is_dir():
        yield Finding("BENCH_DATA", "ok", named)
    else:
        yield Finding("BENCH_DATA", "missing", f"{named} is no folder", "correct or unset it")


def _data_sets() -> Iterator[Finding]:
    from bench.recordings.sources.base import open_source

    for plugin in plugins("datasets"):
        try:
            with foreign(f"data set {plugin.name!r} is unavailable"):
                reason = open_source(plugin.name).available()
        except BenchError as problem:
            reason = str(problem)
        if reason is None:
            yield Finding(f"data set {plugin.name}", "ok", "readable")
        else:
            yield Finding(f"data set {plugin.name}", "info", "not here", reason)


def _broken_plugins() -> Iterator[Finding]:
    for group in get_args(Group):
        for plugin in plugins(group):
            problem = plugin.problem()
            if problem is not None:
                remedy = f"update or uninstall {plugin.distribution}"
                yield Finding(f"{group} plug-in {plugin.name}", "missing", problem, remedy)
