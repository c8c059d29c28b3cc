"""Ambiguous cases, a plan for each, the planned rows recorded by the generator, diagnosed again.

    python tests/benchmarks/plan_cases.py results.jsonl [first case] [cases]

A generator of its own (numpy alone; other forms than the library's) makes recordings in which a
setting never varies, so that two causes predict the same rows. Default options throughout: what
`bench.diagnose` calls ambiguous, `bench.plan` plans, the generator measures with the hidden truth,
and `bench.diagnose` sees old and new rows together. One line of JSON a case; finished ones stay.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd

import bench
from bench.discrepancy.report.evidence import KEPT
from bench.physics.base import Base
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.planning.plan import Answer, MeasurementPlan
from bench.planning.world import World

LINKS, ROWS, RATIO = 32, 4, 3
SEEDS = (0, 1)
WALL_M = {"brick": 0.11, "concrete": 0.2}
# What never varies, and which causes that leaves open: (setting, truths).
KINDS: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "one reply time": ({"reply_time_s": 1e-3}, ("antenna-delay", "clock-offset")),
    "one temperature": ({"temperature_c": 38.0}, ("antenna-delay", "temperature-drift")),
    "one distance": ({"true_range_m": 11.0}, ("antenna-delay", "range-scale", "power-bias")),
    "one wall everywhere": ({"obstacles": ["brick"]}, ("antenna-delay", "material-delay")),
    "one heading": ({"azimuth_deg": 30.0}, ("antenna-delay", "antenna-pattern")),
    "few distances": ({"true_range_m": (9.0, 13.0)}, ("range-scale", "power-bias")),
    "one reply time and distance": (
        {"reply_time_s": 1e-3, "true_range_m": 11.0}, ("clock-offset", "range-scale")),
    "one temperature and reply time": (
        {"temperature_c": 38.0, "reply_time_s": 1e-3}, ("clock-offset", "temperature-drift")),
}  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One case: what never varies, what is hidden, whether the simulator can be run again."""

    kind: str
    truth: str
    seed: int

    @property
    def again(self) -> bool:
        """Every other seed is compared with the simulator, the others with a table of rows."""
        return self.seed % 2 == 1


def cases() -> list[Case]:
    """Return every case: seeds, what never varies, what is hidden."""
    return [Case(k, t, s) for s, (k, (_, ts)) in product(SEEDS, KINDS.items()) for t in ts]


def known(case: Case, rng: np.random.Generator) -> pd.DataFrame:
    """Return what is known of the rows before they are measured."""
    link = np.repeat(np.arange(LINKS), ROWS)
    fixed = KINDS[case.kind][0]
    near, far = fixed["true_range_m"] if isinstance(fixed.get("true_range_m"), tuple) else (3, 20)
    frame = pd.DataFrame({"link": [f"l{i}" for i in link]})
    frame["tx"] = [f"t{i % 3}" for i in link]
    frame["rx"] = [f"a{i % 4}" for i in link]
    frame["true_range_m"] = rng.uniform(near, far, LINKS)[link]
    frame["reply_time_s"] = rng.choice([3e-4, 8e-4, 2e-3], LINKS)[link]
    frame["temperature_c"] = rng.uniform(10, 40, LINKS)[link]
    if "azimuth_deg" in fixed:
        frame["azimuth_deg"] = fixed["azimuth_deg"] + rng.normal(0, 0.5, len(link))
    if "obstacles" in fixed:
        frame["obstacles"] = [list(fixed["obstacles"]) for _ in link]
    for name in ("reply_time_s", "temperature_c", "true_range_m"):
        if isinstance(fixed.get(name), float):
            frame[name] = fixed[name] * (1 + rng.normal(0, 0.001, LINKS)[link])
    return frame


def measured(
    frame: pd.DataFrame, truth: str, rng: np.random.Generator, noise: float = 1.0
) -> pd.DataFrame:
    """Return the rows as a radio would write them, with what is hidden."""
    distance = frame["true_range_m"].to_numpy(float)
    sent = frame["tx_power_dbm"].to_numpy(float) if "tx_power_dbm" in frame else -14.3
    sent = np.where(np.isnan(sent), -14.3, sent)
    # The budget of free space at 3 993.6 MHz.
    level = sent - 20 * np.log10(4 * np.pi * distance * 3.9936e9 / 299_792_458)
    codes = pd.factorize(frame["link"])[0]
    cells = frame["obstacles"] if "obstacles" in frame else [[] for _ in codes]
    walls = np.array([sum(WALL_M.get(kind, 0.1) for kind in cell) for cell in cells])
    if truth == "material-delay":
        level = level - 3.5 * (walls > 0)
    shift = {
        "none": lambda: 0.0,
        "antenna-delay": lambda: 0.11,
        "clock-offset": lambda: 0.5 * 299_792_458 * 0.75e-6 * frame["reply_time_s"],
        "temperature-drift": lambda: 0.008 * (frame["temperature_c"] - 25),
        "range-scale": lambda: 0.01 * distance,
        "power-bias": lambda: 0.2 / (1 + np.exp((level + 78) / 3.2)) - 0.1,
        "material-delay": lambda: walls,
        "antenna-pattern": lambda: 0.12 * np.cos(np.radians(frame["azimuth_deg"] - 20)),
    }[truth]()
    error = np.asarray(shift) + noise * rng.normal(0, 0.025, len(frame))
    error = error + noise * rng.normal(0, 0.01, codes.max() + 1)[codes]
    seen = level + noise * rng.normal(0, 0.3, len(frame))
    return frame.assign(error_m=error, range_m=distance + error, rx_power_dbm=seen)


def simulated(frame: pd.DataFrame, case: Case, rng: np.random.Generator) -> Any:
    """Return what recordings are compared with."""
    if case.again:
        return Simulator(Base(), name="base")
    return pd.concat([measured(frame, "none", rng) for _ in range(RATIO)], ignore_index=True)


def names(found: Any) -> list[list[str]]:
    return [list(group) for group in found.selection.names]


def run(case: Case, folder: Path) -> dict[str, Any]:
    """Diagnose, plan, record, diagnose again."""
    rng = np.random.default_rng([case.seed, *map(ord, case.kind + case.truth)])
    old = known(case, rng)
    recorded = measured(old, case.truth, rng)
    first = bench.diagnose(recorded, simulated(old, case, rng), out=folder)
    made: dict[str, Any] = {**vars(case), "first": names(first)}
    made["verdicts"] = [str(v) for v in first.selection.verdicts]
    plan = bench.plan(folder)
    open_ = [one for one in plan.answers if case.truth in one.names and one.planned()]
    if not open_:
        return made | {"planned": 0, "notes": [one.note for one in plan.answers]}
    new = pd.concat([one.geometry(f"plan {i}") for i, one in enumerate(open_)], ignore_index=True)
    new = new.drop(columns=[c for c in new if c not in old and c not in SETTINGS])
    later = measured(new, case.truth, rng)
    made |= nats(open_[0], case, later, measured(new, "none", rng, 0.0))
    both = pd.concat([old, new], ignore_index=True)
    every = pd.concat([recorded, later], ignore_index=True)
    second = bench.diagnose(every, simulated(both, case, rng))
    made["second"] = names(second)
    made["resolved"] = shrunk(made["first"], made["second"], case.truth)
    return made | {"planned": len(new["link"].unique()), "plan": described(plan)}


def shrunk(first: list[list[str]], second: list[list[str]], truth: str) -> bool:
    """Return whether the class of the truth became the truth alone.

    Names outside that class do not count: this generator's scatter is not the simulator's.
    """
    rivals = {name for group in first if truth in group for name in group} - {truth}
    return [truth] in second and not any(rivals & set(group) for group in second)


SETTINGS = ("obstacles", "tx_power_dbm", "azimuth_deg")


def described(plan: MeasurementPlan) -> list[str]:
    return [f"{n} x {m.words}" for one in plan.answers for m, n in one.planned()]


def nats(answer: Answer, case: Case, later: pd.DataFrame, none: pd.DataFrame) -> dict[str, Any]:
    """Return expected and reached nats for the truth over its hardest rival."""
    assert answer.outlook is not None
    counts = np.array(answer.links)
    right = answer.names.index(case.truth)
    expected = answer.outlook.nats(counts)[right]
    rivals = [i for i in range(len(answer.names)) if i != right]
    rival = min(rivals, key=lambda i: expected[i])
    kept = [n for n in KEPT if n in later][: answer.outlook.predictions[0].means.shape[2]]
    mine = later["link"].str.startswith("plan 0 ").to_numpy()
    gap = (later[kept] - none[kept]).to_numpy(float)[mine]
    bare = World(Simulator(Base()), tuple(kept), False).values(scene(later[mine]), (), 2)
    values = gap + bare.mean(axis=0)
    place = later.loc[mine, "link"].str.extract(r" (\d+)\.")[0].astype(int).to_numpy()
    used = np.flatnonzero(counts)
    means = np.zeros((len(counts), len(kept)))
    for number, at in enumerate(used):
        means[at] = values[place == number].mean(axis=0)
    reached = answer.outlook.reached(counts, means, right, rival)
    return {"rival": answer.names[rival], "expected_nats": float(expected[rival]),
            "reached_nats": float(reached)}  # fmt: skip


def report(lines: list[dict[str, Any]]) -> str:
    """Return the counts."""
    planned = [one for one in lines if one.get("planned")]
    solved = sum(one["resolved"] for one in planned)
    alone = sum(one["second"] == [[one["truth"]]] for one in planned)
    ratio = [one["reached_nats"] / one["expected_nats"] for one in planned]
    within = sum(0.5 <= one <= 2 for one in ratio)
    return (
        f"{len(lines)} cases, {len(planned)} ambiguous with the truth among the explanations; "
        f"resolved to the truth {solved} of {len(planned)} ({alone} with no other name); "
        f"reached / expected nats: median {np.median(ratio):.2f}, {within} of {len(planned)} "
        "within a factor of two"
    )


def main(path: Path, first: int = 0, count: int = 10_000) -> None:
    """Run what is not in the file yet, and print the counts."""
    lines = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    done = {(one["kind"], one["truth"], one["seed"]) for one in lines}
    for case in cases()[first : first + count]:
        if (case.kind, case.truth, case.seed) in done:
            continue
        with TemporaryDirectory() as folder:
            lines.append(run(case, Path(folder)))
        with path.open("a") as file:
            file.write(json.dumps(lines[-1]) + "\n")
        print(json.dumps(lines[-1]), flush=True)
    print(report(lines))


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(int, sys.argv[2:]))
