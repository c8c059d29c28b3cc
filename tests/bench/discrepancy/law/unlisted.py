"""Cases that no library effect is: laws and faults of the set-up, made with numpy alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd

Floats = np.ndarray
Hidden = Callable[[pd.DataFrame], Floats]
SCATTER_M = 0.025
ANCHORS = np.array(
    [[0, 0, 2.6], [24, 0, 2.2], [24, 15, 2.9], [0, 15, 2.4], [12, -1, 2.7], [11, 16, 2.1]], float
)


@dataclass(frozen=True)
class Case:
    """What is hidden: its error in metres, and what a right answer says.

    `forms` that are right; `columns` any of which is; `constants`: name -> value that must be met
    within 10 %; `fault` with `devices` for faults of the set-up.
    """

    name: str
    hidden: Hidden
    forms: tuple[str, ...]
    columns: tuple[str, ...]
    constants: dict[str, float]
    fault: str = ""
    devices: tuple[str, ...] = ()


def rows(rng: np.random.Generator, places: int = 40, again: int = 3) -> pd.DataFrame:
    """Return tags put down at places, ranging to six anchors `again` times each."""
    spots = np.stack(
        [
            rng.uniform(0.5, 23.5, places),
            rng.uniform(0.5, 14.5, places),
            rng.uniform(0.6, 1.9, places),
        ],
        axis=1,
    )
    place, anchor = np.meshgrid(np.arange(places), np.arange(len(ANCHORS)), indexing="ij")
    place, anchor = np.repeat(place.ravel(), again), np.repeat(anchor.ravel(), again)
    tag = rng.integers(0, 3, places)[place]
    frame = pd.DataFrame({"link": [f"p{p}-a{a}" for p, a in zip(place, anchor, strict=True)]})
    frame["tx"], frame["rx"] = [f"t{i}" for i in tag], [f"a{i}" for i in anchor]
    for axis, name in enumerate("xyz"):
        frame[f"tx_{name}_m"] = spots[place, axis]
        frame[f"rx_{name}_m"] = ANCHORS[anchor, axis]
    frame["true_range_m"] = np.linalg.norm(spots[place] - ANCHORS[anchor], axis=1)
    turn = np.arange(len(frame)) % (again * len(ANCHORS))
    frame["time_s"] = place * 45.0 + 2 * turn + rng.uniform(0, 1.5, len(frame))
    frame["temperature_c"] = 22 + 6 * np.sin(place / 9.0) + rng.normal(0, 0.2, len(frame))
    frame["reply_time_s"] = rng.choice([3e-4, 8e-4, 2e-3], len(frame))
    frame["azimuth_deg"] = rng.uniform(0, 360, places)[place]
    frame["supply_v"] = rng.uniform(2.9, 3.6, len(frame))
    return frame


def measured(frame: pd.DataFrame, rng: np.random.Generator, hidden: Hidden | None) -> pd.DataFrame:
    """Return the rows with ranges and levels as a radio would give them."""
    true = frame["true_range_m"].to_numpy()
    error = rng.normal(0, SCATTER_M, len(frame))
    error = error + (hidden(frame) if hidden else 0.0)
    level = -60 - 20 * np.log10(true) + rng.normal(0, 0.6, len(frame))
    made = frame.assign(range_m=true + error, error_m=error, rx_power_dbm=level)
    if hidden in ROUNDED:
        step, way = ROUNDED[hidden]
        made["range_m"] = way(made["range_m"] / step) * step
        made["error_m"] = made["range_m"] - true
    return made


def tables(case: Case | None, seed: int, replicas: int = 4) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return a recorded table with something hidden, and `replicas` simulated rows per row."""
    rng = np.random.default_rng([seed, 771])
    frame = rows(rng)
    recorded = measured(frame, rng, case.hidden if case else None)
    simulated = pd.concat([measured(frame, rng, None) for _ in range(replicas)], ignore_index=True)
    return recorded, simulated


def number(name: str) -> Callable[[pd.DataFrame], Floats]:
    return lambda frame: frame[name].to_numpy(float)


D, T, C, REPLY, AZ, V = map(
    number,
    ("true_range_m", "time_s", "temperature_c", "reply_time_s", "azimuth_deg", "supply_v"),
)


def at(name: str, device: str, law: Hidden) -> Hidden:
    """Return a law for the rows of one device."""
    return lambda f: np.where(f[name] == device, law(f), 0.0)


def moved(device: str, by: tuple[float, float, float], end: str = "rx") -> Hidden:
    """Return the error where a device really stands elsewhere by so much."""
    other = "tx" if end == "rx" else "rx"

    def hidden(frame: pd.DataFrame) -> Floats:
        here, there = (frame[[f"{e}_{a}_m" for a in "xyz"]].to_numpy() for e in (end, other))
        far = np.linalg.norm(here + np.array(by) - there, axis=1)
        return np.where(frame[end] == device, far - frame["true_range_m"], 0.0)

    return hidden


def exchanged(one: int, two: int) -> Hidden:
    """Return the error where two anchors have each other's name."""

    def hidden(frame: pd.DataFrame) -> Floats:
        tags = frame[[f"tx_{a}_m" for a in "xyz"]].to_numpy()
        total = np.zeros(len(frame))
        for mine, real in ((one, two), (two, one)):
            far = np.linalg.norm(tags - ANCHORS[real], axis=1)
            total = np.where(frame["rx"] == f"a{mine}", far - frame["true_range_m"], total)
        return total

    return hidden


def nothing(_: pd.DataFrame) -> Floats:
    return 0.0


def nothing_down(_: pd.DataFrame) -> Floats:
    return 0.0


ROUNDED: dict[Hidden | None, tuple[float, Callable[[Floats], Floats]]] = {
    nothing: (0.25, np.rint),
    nothing_down: (0.2, np.floor),
}
DIST, TIME = ("true_range_m",), ("time_s",)
LAWS = [
    Case("scale 8 %", lambda f: 0.08 * D(f), ("linear",), DIST, {"a": 0.08}),
    Case("scale -1.2 %", lambda f: -0.012 * D(f), ("linear",), DIST, {"a": -0.012}),
    Case("scale and delay", lambda f: 0.02 * D(f) - 0.3, ("linear",), DIST, {"a": 0.02, "b": -0.3}),
    Case("square", lambda f: 0.0012 * D(f) ** 2, ("power",), DIST, {"p": 2}),
    Case("root", lambda f: 0.12 * np.sqrt(D(f)), ("power",), DIST, {"p": 0.5}),
    Case("power 1.5", lambda f: 0.006 * D(f) ** 1.5, ("power",), DIST, {"p": 1.5}),
    Case("inverse", lambda f: 1.1 / D(f), ("inverse",), DIST, {"a": 1.1}),
    Case("inverse square", lambda f: 4.0 / D(f) ** 2, ("inverse square",), DIST, {"a": 4.0}),
    Case("logarithm", lambda f: 0.14 * np.log(D(f) / 4), ("logarithm",), DIST, {"a": 0.14}),
    Case("saturation", lambda f: 0.5 * D(f) / (D(f) + 3), ("saturation",), DIST, {}),
    Case("warm-up", lambda f: 0.25 * np.exp(-T(f) / 300), ("relaxation",), TIME,
         {"a": 0.25, "tau": 300}),
    Case("cooling", lambda f: -0.3 * np.exp(-T(f) / 120), ("relaxation",), TIME,
         {"a": -0.3, "tau": 120}),
    Case("step in time", lambda f: 0.1 * (T(f) > 1000), ("step",), TIME, {"a": 0.1, "x0": 1000}),
    Case("two firmwares", lambda f: -0.07 * (T(f) > 600), ("step",), TIME, {"a": -0.07, "x0": 600}),
    Case("half of the hall", lambda f: 0.09 * (f["tx_x_m"].to_numpy() > 14), ("step",),
         ("tx_x_m",), {"a": 0.09, "x0": 14}),
    Case("north end", lambda f: 0.12 * (f["tx_y_m"].to_numpy() > 6), ("step",), ("tx_y_m",),
         {"a": 0.12, "x0": 6}),
    Case("far away", lambda f: 0.1 * (D(f) > 12), ("step",), DIST, {"a": 0.1, "x0": 12}),
    Case("cycle of 310 s", lambda f: 0.08 * np.sin(2 * np.pi * T(f) / 310), ("periodic",), TIME,
         {"a": 0.08, "period": 310}),
    Case("cycle of 90 s", lambda f: 0.06 * np.cos(2 * np.pi * T(f) / 90), ("periodic",), TIME,
         {"a": 0.06, "period": 90}),
    Case("ripple of 4 m", lambda f: 0.07 * np.sin(2 * np.pi * D(f) / 4 + 1), ("periodic",), DIST,
         {"a": 0.07, "period": 4}),
    Case("ripple of 1.7 m", lambda f: 0.06 * np.sin(2 * np.pi * D(f) / 1.7), ("periodic",), DIST,
         {"a": 0.06, "period": 1.7}),
    Case("three lobes", lambda f: 0.07 * np.sin(3 * np.radians(AZ(f)) + 0.4), ("periodic",),
         ("azimuth_deg",), {"a": 0.07, "k": 3}),
    Case("off centre", lambda f: 0.08 * np.cos(np.radians(AZ(f))), ("periodic",), ("azimuth_deg",),
         {"a": 0.08, "k": 1}),
    Case("supply", lambda f: 0.3 * (V(f) - 3.2), ("linear",), ("supply_v",), {"a": 0.3}),
    Case("brown-out", lambda f: 0.1 * (V(f) < 3.1), ("step",), ("supply_v",), {"x0": 3.1}),
    Case("one anchor stretched", at("rx", "a3", lambda f: 0.015 * D(f)), ("linear",), DIST,
         {"a": 0.015}),
    Case("one tag squared", at("tx", "t1", lambda f: 0.0009 * D(f) ** 2), ("power",), DIST,
         {"p": 2}),
    Case("one tag drifts", at("tx", "t2", lambda f: 1e-4 * T(f)), ("linear",), TIME, {"a": 1e-4}),
    Case("heat with distance", lambda f: 0.0012 * C(f) * D(f), ("linear",),
         ("true_range_m", "temperature_c"), {"a": 0.0012}),
    Case("supply with distance", lambda f: 0.02 * (V(f) - 3.2) * D(f), ("linear",),
         ("true_range_m", "supply_v"), {"a": 0.02}),
    Case("rounded", nothing, ("rounding",), ("range_m",), {"q": 0.25}),
    Case("rounded down", nothing_down, ("rounding",), ("range_m",), {"q": 0.2}),
]  # fmt: skip
FAULTS = [
    Case("anchor off 0.5 m", moved("a2", (0.4, -0.3, 0.1)), ("position",), (),
         {"dx": 0.4, "dy": -0.3}, "position", ("a2",)),
    Case("anchor off 0.3 m", moved("a0", (0.0, 0.3, 0.0)), ("position",), (), {"dy": 0.3},
         "position", ("a0",)),
    Case("anchor off 2 m", moved("a5", (-1.5, -1.4, 0.0)), ("position",), (),
         {"dx": -1.5, "dy": -1.4}, "position", ("a5",)),
    Case("tag's lever arm", moved("t1", (0.25, 0.0, 0.0), "tx"), ("position",), (), {"dx": 0.25},
         "position", ("t1",)),
    Case("anchors 0 and 1 swapped", exchanged(0, 1), ("swap",), (), {}, "swap", ("a0", "a1")),
    Case("anchors 4 and 5 swapped", exchanged(4, 5), ("swap",), (), {}, "swap", ("a4", "a5")),
    Case("feet", lambda f: (1 / 0.3048 - 1) * D(f), ("unit",), DIST, {"ratio": 1 / 0.3048}, "unit"),
    Case("truth in feet", lambda f: (0.3048 - 1) * D(f) + 0.1, ("unit",), DIST, {"ratio": 0.3048},
         "unit"),
    Case("one anchor in feet", at("rx", "a4", lambda f: (1 / 0.3048 - 1) * D(f)), ("unit",), DIST,
         {"ratio": 1 / 0.3048}, "unit"),
    Case("round trip", lambda f: D(f), ("unit",), DIST, {"ratio": 2.0}, "unit"),
]  # fmt: skip
CASES = [*LAWS, *FAULTS]
