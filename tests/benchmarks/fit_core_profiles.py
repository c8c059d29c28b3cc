"""Fits the estimating coefficients of every core to counts: writes bench/measure/devices/cores.

    bench count --model all --backend c-fp32,c-int8 --device all --rows 8 --json > counts.json
    python tests/benchmarks/fit_core_profiles.py counts.json

For each core, both precisions together: the form of `bench.measure.estimate`, fitted in logarithms
to the counts of every model (a part's middle, wait states included), pulled towards a guess where
the few models leave a coefficient open. `fit_factor` then holds how far any count, its table's ends
included, lies from its estimate. Each model is also estimated from a fit to the others, and what
that would have missed is printed. The counts themselves are kept for the tests of the profiles
(tests/bench/measure/counting/counted.json).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import convert
from scipy.optimize import least_squares

from bench import measure, plugins
from bench.measure.counting.core import load_core
from bench.measure.estimate import Call, call_of, latency_us
from bench.measure.profile import UNITS, Coefficient
from bench.results import Cost, Interval

KEPT = Path(__file__).parents[1] / "bench" / "measure" / "counting" / "counted.json"
FOLDER = Path(measure.__file__).parent / "devices" / "cores"
CORES = ("cortex-m4f", "cortex-m33", "cortex-m7", "cortex-m0plus", "rv32imc")
COMMON = {"call_cycles": 30.0, "cycles_per_input": 15.0, "launch_cycles": 30.0}
FLOATS = {
    "macs_per_cycle.conv": 0.3, "macs_per_cycle.dense": 0.2, "cycles_per_output": 8.0,
    "cycles_per_output.conv": 10.0, "cycles_per_output.dense": 20.0,
    "cycles_per_output.activation": 2.0, "cycles_per_output.function": 60.0,
    "cycles_per_output.convert": 15.0, "cycles_per_output.move": 2.0,
    "cycles_per_read.reduce": 4.0, "cycles_per_read.trees": 15.0,
}  # fmt: skip
INTEGERS = {
    "macs_per_cycle.conv": 0.5, "macs_per_cycle.dense": 0.5, "cycles_per_output": 15.0,
    "cycles_per_output.conv": 20.0, "cycles_per_output.dense": 40.0,
    "cycles_per_output.activation": 8.0, "cycles_per_output.convert": 20.0,
    "cycles_per_output.move": 3.0, "cycles_per_read.reduce": 4.0,
}  # fmt: skip
SOFT = 30.0  # times longer without a floating-point unit, but for what only moves values
UNSCALED = ("cycles_per_output.move", "cycles_per_read.trees")
PRIOR_SPREAD, ROW_SPREAD = 0.8, 0.05  # natural logarithms
MARGIN = 1.05


@dataclass
class Point:
    """One model and precision on a core: the counts of its parts, as cycles of their clocks.

    Low and high are those of the latency: they hold the range of the clock, too.
    """

    model: str
    backend: str
    call: Call
    counts: list[dict[str, Any]] = field(default_factory=list)
    cycles: list[Interval] = field(default_factory=list)

    @property
    def middle(self) -> float:
        """Cycles with wait states, the middle of the core's parts."""
        return float(np.exp(np.mean([np.log(one.value) for one in self.cycles])))

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest end of any part."""
        lows = (one.value if one.low is None else one.low for one in self.cycles)
        highs = (one.value if one.high is None else one.high for one in self.cycles)
        return min(lows), max(highs)


def points(rows: list[dict[str, Any]]) -> dict[str, list[Point]]:
    """Return the counts of `bench count --json` by core."""
    found: dict[str, dict[tuple[str, str], Point]] = {core: {} for core in CORES}
    for row in rows:
        profile = plugins.load("devices", row["device"])
        if row["how"] is None or profile.core not in CORES:
            continue
        call = call_of(convert(row["cost"], Cost), row["precision"])
        new = Point(row["model"], row["backend"], call)
        point = found[profile.core].setdefault((row["model"], row["backend"]), new)
        clock_mhz = profile.coefficients["frequency_mhz"].value
        taken_us = convert(row["figure"]["latency_us"], Interval)
        ends = [None if end is None else end * clock_mhz for end in (taken_us.low, taken_us.high)]
        point.cycles.append(Interval(taken_us.value * clock_mhz, *ends))
        point.counts.append(row["count"])
    return {core: list(some.values()) for core, some in found.items() if some}


def guesses(core: str) -> dict[str, float]:
    """Return where the coefficients of a core are pulled to."""
    soft = 1.0 if load_core(core).float_unit else SOFT
    floats = {
        name: value * (1.0 if name in UNSCALED else 1 / soft if "macs" in name else soft)
        for name, value in FLOATS.items()
    }
    typed = {f"{name}.fp32": value for name, value in floats.items()}
    return COMMON | typed | {f"{name}.int8": value for name, value in INTEGERS.items()}


def fit(guess: dict[str, float], some: Sequence[Point]) -> dict[str, float]:
    """Return the coefficients that tell these counts best."""
    names = list(guess)
    shares = np.array([[share(guess, name, one.call) for name in names] for one in some])
    wanted = np.array([one.middle for one in some])

    def residuals(logs: np.ndarray) -> np.ndarray:
        off = np.log(shares @ np.exp(logs) / wanted) / ROW_SPREAD
        return np.concatenate([off, logs / PRIOR_SPREAD])

    longer = np.exp(least_squares(residuals, np.zeros(len(names))).x).tolist()
    return {
        name: guess[name] / factor if name.startswith("macs") else guess[name] * factor
        for name, factor in zip(names, longer, strict=True)
    }


def share(guess: dict[str, float], name: str, call: Call) -> float:
    """Return the cycles that one coefficient adds: the form is a sum."""
    nothing = {other: np.inf if other.startswith("macs") else 0.0 for other in guess}
    return cycles({**nothing, name: guess[name]}, call)


def cycles(values: dict[str, float], call: Call) -> float:
    """Return the estimate at one megahertz: its microseconds are cycles."""
    return latency_us({**values, "frequency_mhz": 1.0}, call)


def fit_factor(values: dict[str, float], some: Sequence[Point]) -> tuple[float, float]:
    """Return the range that holds every count over its estimate, with a margin."""
    low = min(one.ends[0] / cycles(values, one.call) for one in some)
    high = max(one.ends[1] / cycles(values, one.call) for one in some)
    return min(low / MARGIN, 1.0), max(high * MARGIN, 1.0)


def check(core: str, guess: dict[str, float], values: dict[str, float], some: list[Point]) -> None:
    """Print estimates beside counts, and beside those of a fit that has not seen the model."""
    low, high = fit_factor(values, some)
    held = 0
    for one in some:
        told = cycles(values, one.call)
        unseen = fit(guess, [other for other in some if other.model != one.model])
        blind = cycles(unseen, one.call)
        inside = low * blind <= one.ends[0] <= one.ends[1] <= high * blind
        held += inside
        print(
            f"{core:14}{one.model:18}{one.backend:7}{one.middle:11.0f} counted "
            f"[{one.ends[0] / one.middle:.2f}, {one.ends[1] / one.middle:.2f}], "
            f"told {told / one.middle:.2f}, unseen {blind / one.middle:.2f}"
            f"{'' if inside else '  MISSED'}"
        )
    print(f"{core}: range [{low:.3f}, {high:.3f}]; of models not fitted to {held} of {len(some)}")


def entries(core: str, some: list[Point], values: dict[str, float]) -> dict[str, Coefficient]:
    """Return the coefficients of a core with their sources."""
    counts = [count for point in some for count in point.counts]
    source = f"counted (emulated): fitted to {len(some)} networks as C, {counts[0]['compiler']}"
    halves = {  # weights in 16 bits are widened as they are read
        name.replace("fp32", "fp16"): value
        for name, value in values.items()
        if name.endswith(".fp32")
    }
    found = {
        name: _entry(name, (value, value, value), f"{source}; how far off: fit_factor")
        for name, value in (values | halves).items()
    }
    low, high = fit_factor(values, some)
    held = f"{source}; holds the ends of every count on every part of this core"
    found["fit_factor"] = _entry("fit_factor", (1.0, low, high), held)
    for name, what in (("code_kib", "code_bytes"), ("runtime_ram_kib", "stack_bytes")):
        seen = [count[what] / 1024 for count in counts]
        found[name] = _entry(name, (float(np.median(seen)), min(seen), max(seen)), source)
    return found


def _entry(name: str, value_low_high: tuple[float, float, float], source: str) -> Coefficient:
    value, low, high = (float(f"{number:.4g}") for number in value_low_high)
    return Coefficient(value, low, high, UNITS[name.partition(".")[0]], source, "counted")


def write(core: str, generator: str, found: dict[str, Coefficient]) -> None:
    """Write one core's file."""
    lines = [
        f"# Coefficients of estimates on {core}: fitted to counts of this project's C by",
        "# tests/benchmarks/fit_core_profiles.py. Code generators differ threefold on one chip:",
        "# MLPerf Tiny v1.1 and v1.2, keyword spotting, Cortex-M4 at 120 MHz, inferences a second:",
        "# microTVM 6.9, STMicroelectronics 15.9 and 23.2, Plumerai 20.9.",
        "",
        f'generator = "C of bench export, {generator}"',
    ]
    for name, one in found.items():
        lines += ["", f"[{name}]", f"value = {one.value}", f"low = {one.low}", f"high = {one.high}"]
        lines += [f'unit = "{one.unit}"', f'kind = "{one.kind}"', f'source = "{one.source}"']
    (FOLDER / f"{core}.toml").write_text("\n".join(lines) + "\n")


def keep(rows: list[dict[str, Any]]) -> None:
    """Write what the tests of the profiles need: what each network takes, its count by core."""
    networks: dict[str, Any] = {}
    counts: dict[tuple[str, str], dict[str, Any]] = {}
    for row in rows:
        if row["how"] is None:
            continue
        network, cost, count = f"{row['model']}/{row['precision']}", row["cost"], row["count"]
        layers = [list(layer.values()) for layer in cost["layers"]]
        networks[network] = {**cost, "layers": layers}
        cycles = [round(count["cycles"][end], 1) for end in ("low", "typical", "high")]
        same = {name: count[name] for name in ("core", "flash_reads", "flash_bytes", "ram_bytes")}
        named = {"network": network, "precision": row["precision"]}
        counts[network, count["core"]] = {**named, **same, "cycles": cycles}
    lines = [",\n".join(json.dumps(one) for one in counts.values())]
    tables = ",\n".join(f"{json.dumps(name)}: {json.dumps(one)}" for name, one in networks.items())
    KEPT.write_text(f'{{"networks": {{\n{tables}\n}},\n"counts": [\n{"".join(lines)}\n]}}\n')


def main() -> None:
    """Fit every core of the counts in the files named on the command line."""
    rows = [row for path in sys.argv[1:] for row in json.loads(Path(path).read_text())]
    keep(rows)
    for core, some in points(rows).items():
        guess = guesses(core)
        values = fit(guess, some)
        check(core, guess, values, some)
        write(core, some[0].counts[0]["compiler"], entries(core, some, values))


if __name__ == "__main__":
    main()
