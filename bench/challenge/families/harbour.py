"""Straddle carriers between containers on a quay, ranged from cranes: ranges and levels, no CIR.

numpy and pandas alone; what it can hide is in `harbour_effects`, its waveforms are in
`harbour_waves`. Here the fixed end transmits; there is no room.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.harbour_effects import (
    CARGO,
    CARRIERS,
    CRANES_M,
    EFFECTS,
    LAWS,
    MOTION,
    Log,
)

Floats = NDArray[np.float64]
RUNS, TURNS, TURN_S, SLOT_S = 14, 4, 0.6, 0.035
NEARER_M, FARTHER_M = 42.0, 24.0  # limits of the links where the mix of distances is another one
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "time-lag": "time_s",
    "exchange-motion": "reply_time_s",
    "antenna-delay": "time_s",
    "clock-offset": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "salt-crust": "salt_g_m2",
    "boom-in-the-wind": "wind_m_per_s",
    "twistlocks-closed": "hook_load_t",
}
RARELY = ("material-delay", "blocked-path", "exchange-motion")
WRITTEN_LAST = ("fathoms-from-one-crane", "stuck-bit", "range-rounding")
NOT_LOGGED = "preamble_count"  # the harbour's ranges come without


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the harbour's own."""
    rng = np.random.default_rng([411, seed])
    rows = of_mix(shifted(rng, drawn.rare), drawn.same_mix, nearer=True)
    clean = _measured(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = of_mix(shifted(rng, drawn.rare), drawn.same_mix, nearer=False)
        rows = rows.assign(link="modelled " + rows["link"])
    made = [_measured(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(made, ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return shifted(np.random.default_rng([411, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _altered(clean, drawn, [412, seed])
    truth, _ = _altered(simulated, drawn, [413, seed], seed)
    gone = [*MOTION, NOT_LOGGED] + ([] if drawn.listed else ["obstacles"])
    recorded, clean, simulated, truth = (
        one.drop(columns=gone) for one in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth, shifts)


def shifted(
    rng: np.random.Generator, rare: str, turns: int = TURNS, runs: int = RUNS
) -> pd.DataFrame:
    """Return what is known of the rows of a shift: carriers that drive off, brake, or stand."""
    stands = rng.random(runs) < 0.22
    if rare == "exchange-motion":
        stands = np.arange(runs) % 7 != 3
    begins = np.cumsum(250 + rng.exponential(650, runs))
    parts = [_run(rng, n, turns, begins[n], stands[n]) for n in range(runs)]
    frame = pd.concat(parts, ignore_index=True)
    count = len(frame)
    return frame.assign(
        reply_time_s=np.clip(0.034 * rng.lognormal(0, 0.7, count), 0.004, 0.15),
        hook_load_t=rng.beta(1.3, 1.1, count) * 41,
        obstacles=_between(rng, frame["link"], 0.06 if rare == "material-delay" else 0.27),
    )


def of_mix(rows: pd.DataFrame, same: bool, nearer: bool) -> pd.DataFrame:
    """Return all rows, or those of the links that are nearer or farther than a limit."""
    if same:
        return rows
    middle = rows["true_range_m"].groupby(rows["link"]).transform("median")
    chosen = middle < NEARER_M if nearer else middle > FARTHER_M
    return rows.loc[chosen].reset_index(drop=True)


def _run(
    rng: np.random.Generator, number: int, turns: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one run: all cranes range a carrier in turn while its speed dies away."""
    crane = np.tile(np.arange(len(CRANES_M)), turns)
    when = np.repeat(np.arange(turns) * TURN_S, len(CRANES_M)) + SLOT_S * crane
    course = rng.choice([0.0, np.pi]) + rng.normal(0, 0.25)
    brake, pace = rng.uniform(2.0, 9.0), 0.0 if stands else rng.uniform(1.2, 5.5)
    gone = pace * brake * (1 - np.exp(-when / brake))
    begin = rng.uniform([14, 9, 2.6], [78, 33, 10.5])
    carrier = begin + np.outer(gone, [np.cos(course), np.sin(course), 0.0])
    gap = CRANES_M[crane] - carrier
    seen = np.degrees(np.arctan2(gap[:, 1], gap[:, 0]) - course)
    now = pace * np.exp(-when / brake)
    columns = [f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"]
    made: dict[str, Any] = dict(zip(columns, np.hstack([CRANES_M[crane], carrier]).T, strict=True))
    made |= {
        "true_range_m": np.sqrt((gap**2).sum(axis=1)),
        "tx": [f"crane{one}" for one in crane],
        "rx": f"carrier{rng.integers(CARRIERS)}",
        "link": [f"c{one} run {number}" for one in crane],
        "environment": "outer berth" if begin[0] > 46 else "inner berth",
        "time_s": begin_s + when,
        "azimuth_deg": seen - 360 * np.round(seen / 360),
    }
    made |= dict(zip(MOTION, (now * np.cos(course), now * np.sin(course), brake), strict=True))
    return pd.DataFrame(made | _weather(rng, begin_s, when))


def _weather(rng: np.random.Generator, begin_s: float, when: Floats) -> dict[str, Floats]:
    """Return temperatures, wind and salt of a run that begins at a time."""
    engine = 16 * np.exp(-rng.exponential(0.8)) * (1 - np.exp(-(when + 20) / 240))
    air = 11 + 9 * np.sin(begin_s / 5200) + rng.normal(0, 5)
    gusts = rng.rayleigh(6.5) * rng.lognormal(0, 0.25, len(when))
    salt = rng.exponential(3.0) * rng.lognormal(0, 0.45, len(when))  # each antenna has its own
    return {"temperature_c": air + engine, "wind_m_per_s": gusts, "salt_g_m2": salt}


def _between(rng: np.random.Generator, links: pd.Series, share: float) -> pd.Series:
    """Return what stands in the straight path: cargo or walls on a share, else iron or nothing."""
    found: dict[str, list[str]] = {}
    for link in sorted(set(links)):
        drawn, kinds = rng.random(), list(rng.permutation(list(CARGO)))
        some = kinds[: 1 + int(rng.random() < 0.3)]
        found[link] = some if drawn < share else ["metal"] if drawn > 0.83 else []
    return links.map(found)


def _measured(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the harbour's own radio."""
    far, count = rows["true_range_m"].to_numpy(np.float64), len(rows)
    places, names = pd.factorize(rows["link"])
    level = -53.8 - 19.2 * np.log10(far) + (0.9 * rng.standard_t(7, len(names)))[places]
    level = level + rng.uniform(-0.6, 0.6, count)
    error = scatter * 0.016 * rng.standard_t(6, count) * (1 + np.exp((-86 - level) / 4) / 6)
    return rows.assign(
        range_m=far + error, error_m=error, rx_power_dbm=level,
        first_path_power_dbm=level - 0.5 - rng.weibull(1.4, count),
        noise_std=52.0 + 2.4 * rng.gumbel(0, 1, count), preamble_count=128.0,
        channel=5, prf_mhz=64.0, tx_power_dbm=-14.3,
    )  # fmt: skip


def _altered(
    table: pd.DataFrame, drawn: Draw, part: list[int], seed: int | None = None
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    own = int(np.random.default_rng([414, part[1] if seed is None else seed]).integers(2**30))
    shifts, rng = {}, np.random.default_rng(part)
    for name in sorted(drawn.hidden, key=lambda one: (one in WRITTEN_LAST, one)):
        got = EFFECTS[name](Log(table, own, rng, bool(drawn.rare)), drawn.strength)
        table, shifts[name] = _gained(table, got), got.get("m", np.zeros(len(table)))
    listed = [np.asarray(shifts[name], np.float64) for name in drawn.hidden]
    return table, np.array(listed).reshape(len(listed), len(table))


def _gained(table: pd.DataFrame, got: dict[str, Floats]) -> pd.DataFrame:
    """Return the table with what its rows gained: metres, and dB of several things."""
    none = np.zeros(len(table))
    every, edge = got.get("db", none), got.get("edge_db", none)
    error = table["error_m"] + got.get("m", none)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every + 0.7 * edge,
        first_path_power_dbm=table["first_path_power_dbm"] + every + edge,
        noise_std=table["noise_std"] * 10 ** (got.get("hiss_db", none) / 20),
        preamble_count=table["preamble_count"] * 10 ** (got.get("count_db", none) / 20),
    )
