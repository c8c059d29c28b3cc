"""Fits the estimating coefficients of every core to counts: writes bench/measure/devices/cores.

    bench count --model all --backend c-fp32,c-int8 --device all --rows 8 --json > counts.json
    python tests/benchmarks/fit_core_profiles.py counts.json

What "none" takes, which checks its input and returns, is the fixed part (t0_us). Beyond that, for
each core and precision: cycles = kernels x launch + MACs / macs_per_cycle + outputs x
cycles_per_output, fitted in logarithms to the counts of every model, pulled towards a guess where
the few models leave a coefficient open. One common factor then widens every coefficient's range
until each part's estimate contains each count, ends and wait states included.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import convert
from scipy.optimize import least_squares

from bench import measure, plugins
from bench.measure.counting.core import load_core
from bench.measure.estimate import Call, call_of, estimate, latency_us
from bench.measure.profile import UNITS, Coefficient, Profile
from bench.results import Cost, Interval

FOLDER = Path(measure.__file__).parent / "devices" / "cores"
CORES = ("cortex-m4f", "cortex-m33", "cortex-m7", "cortex-m0plus", "rv32imc")
GUESS = {"launch_cycles": 100.0, "macs_per_cycle.conv": 0.3, "macs_per_cycle.dense": 0.2,
         "cycles_per_output": 8.0}  # fmt: skip
SOFT = {"macs_per_cycle.conv": 0.005, "macs_per_cycle.dense": 0.005, "cycles_per_output": 100.0}
PRIOR_SPREAD, ROW_SPREAD = 1.0, 0.05  # natural logarithms
MARGIN = 1.1


@dataclass
class Point:
    """One model and precision on every part of a core, with cycles and latency (us) by part."""

    model: str
    precision: str
    call: Call
    cost: Cost
    counts: list[dict[str, Any]]
    parts: list[tuple[Profile, Interval, Interval]]


def points(rows: list[dict[str, Any]]) -> dict[str, list[Point]]:
    """Return the counts of `bench count --json` by core."""
    found: dict[str, dict[tuple[str, str], Point]] = {core: {} for core in CORES}
    for row in rows:
        profile = plugins.load("devices", row["device"])
        if row["how"] is None or profile.core not in CORES:
            continue
        cost = convert(row["cost"], Cost)
        call = call_of(cost, row["precision"])
        new = Point(row["model"], row["precision"], call, cost, [], [])
        point = found[profile.core].setdefault((row["model"], row["backend"]), new)
        cycles, latency = (convert(row["figure"][n], Interval) for n in ("cycles", "latency_us"))
        point.parts.append((profile, cycles, latency))
        point.counts.append(row["count"])
    return {core: list(some.values()) for core, some in found.items()}


def fit(core: str, some: list[Point], precision: str) -> dict[str, float]:
    """Return the coefficients of one core and precision."""
    guess = dict(GUESS)
    if not load_core(core).float_unit and precision == "fp32":
        guess |= SOFT
    names = list(guess)
    fixed = [target(point) for point in some if not point.call.work]
    rows = [point for point in some if point.precision == precision and point.call.work]

    def residuals(logs: np.ndarray) -> np.ndarray:
        values = named(names, logs, precision)
        off = [np.log(latency_us(values, row.call) / target(row)) / ROW_SPREAD for row in rows]
        return np.array([*off, *(logs / PRIOR_SPREAD)])

    def named(names: list[str], logs: np.ndarray, precision: str) -> dict[str, float]:
        found = {f"{n}.{precision}": guess[n] * np.exp(x) for n, x in zip(names, logs, strict=True)}
        other = "fp32" if precision == "int8" else "int8"  # what 8 bits leave in floats
        mixed = {f"{n}.{other}": guess[n] for n in names if n.startswith("macs")}
        return {**mixed, **found, "t0_us": fixed[0], "frequency_mhz": 1.0}

    logs = least_squares(residuals, np.zeros(len(names))).x
    values = named(names, logs, precision)
    for row in rows:
        told = latency_us(values, row.call)
        print(f"{core:14}{row.model:9}{precision:6}{target(row):12.0f} counted {told:12.0f} told")
    return {name: value for name, value in values.items() if name.endswith(precision)} | {
        name.replace("fp32", "fp16"): value
        for name, value in values.items()
        if precision == name[-4:] == "fp32"
    }


def target(point: Point) -> float:
    """Return the cycles with wait states, the middle of the core's parts."""
    values = [cycles.value for _, cycles, _ in point.parts]
    return float(np.exp(np.mean(np.log(values))))


def spread(core: str, some: list[Point], values: dict[str, float]) -> float:
    """Return the factor that every range needs so that each estimate contains each count."""
    factor = 1.1
    start = fixed_part(some)
    while not all(contains(point, values, factor, start) for point in some):
        factor *= 1.05
        if factor > 20:
            raise SystemExit(f"{core}: no range contains the counts")
    return factor * MARGIN


def contains(point: Point, values: dict[str, float], factor: float, start: Coefficient) -> bool:
    """Return whether the estimate on each of the core's parts contains the whole count."""
    for profile, _, span in point.parts:
        entries = {**profile.coefficients, **coefficients(values, factor, "trial")}
        entries["t0_us"] = start
        trial = Profile(profile.name, "", profile.precisions, entries)
        told = estimate(trial, point.cost, point.precision).latency_us
        if told is None or not told.low <= span.low <= span.high <= told.high:
            return False
    return True


def fixed_part(some: list[Point]) -> Coefficient:
    """Return what a network without work takes, over the core's parts and their clocks."""
    spans = [span for point in some if not point.call.work for _, _, span in point.parts]
    ends = [end for span in spans for end in (span.low, span.high)]
    middle = float(np.exp(np.mean([np.log(span.value) for span in spans])))
    low, high = min(ends) / MARGIN, max(ends) * MARGIN
    values = [float(f"{value:.3g}") for value in (middle, low, high)]
    return Coefficient(*values, "us", "counted: input checked, nothing computed", "counted")


def coefficients(values: dict[str, float], factor: float, source: str) -> dict[str, Coefficient]:
    """Return values as coefficients with that range around them."""
    return {
        name: Coefficient(
            float(f"{value:.4g}"), float(f"{value / factor:.3g}"), float(f"{value * factor:.3g}"),
            UNITS[name.partition(".")[0]], source, "counted",
        )
        for name, value in values.items()
    }  # fmt: skip


def write(core: str, some: list[Point], values: dict[str, float], factor: float) -> None:
    """Write one core's file."""
    counts = [count for point in some for count in point.counts]
    made = counts[0]["compiler"]
    flash = [count["code_bytes"] / 1024 for count in counts]
    ram = [count["stack_bytes"] / 1024 for count in counts]
    source = f"counted (emulated): {len(some)} networks as C, {made}; the range holds them all"
    entries = coefficients(values, factor, source)
    entries["t0_us"] = fixed_part(some)
    for name, seen in (("code_kib", flash), ("runtime_ram_kib", ram)):
        middle, low, high = (float(f"{x:.3g}") for x in (np.median(seen), min(seen), max(seen)))
        entries[name] = Coefficient(middle, low, high, "KiB", source, "counted")
    lines = [
        f"# Coefficients of estimates on {core}: fitted to counts of this project's C by",
        "# tests/benchmarks/fit_core_profiles.py. Code generators differ threefold on one chip:",
        "# MLPerf Tiny v1.1 and v1.2, keyword spotting, Cortex-M4 at 120 MHz, inferences a second:",
        "# microTVM 6.9, STMicroelectronics 15.9 and 23.2, Plumerai 20.9.",
        "",
        f'generator = "C of bench export, {made}"',
    ]
    for name, one in entries.items():
        lines += ["", f"[{name}]", f"value = {one.value}", f"low = {one.low}", f"high = {one.high}"]
        lines += [f'unit = "{one.unit}"', f'kind = "{one.kind}"', f'source = "{one.source}"']
    (FOLDER / f"{core}.toml").write_text("\n".join(lines) + "\n")


def main() -> None:
    """Fit every core of the counts named on the command line."""
    for core, some in points(json.loads(Path(sys.argv[1]).read_text())).items():
        values: dict[str, float] = {}
        for precision in sorted({point.precision for point in some}):
            values |= fit(core, some, precision)
        factor = spread(core, some, values)
        print(f"{core}: ranges times {factor:.2f}")
        write(core, some, values, factor)


if __name__ == "__main__":
    main()
