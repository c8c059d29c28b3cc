"""Trolleys that are pushed between rows of a glasshouse, ranged from its gutters: ranges, levels.

numpy and pandas alone; what it can hide is in `glasshouse_effects`, its waveforms in
`glasshouse_waves`. The house and the channel are known. Rows of plants weaken what crosses them; a
run along a row has from one to nine rounds.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.glasshouse_effects import EFFECTS
from bench.challenge.families.glasshouse_house import (
    DEPTH,
    GUTTERS_M,
    HOUSE_M,
    LAWS,
    PARTS,
    ROW_M,
    STROKE,
    TROLLEYS,
    Crop,
    Growth,
)

Floats = NDArray[np.float64]
ROUNDS = (1, 2, 2, 3, 3, 4, 4, 5, 5, 5, 6, 6, 7, 8, 9, 9)  # of runs, in any order
ROUND_S, ASK_S = 0.45, 0.031
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
    "leaf-film": "leaf_wet_percent",
    "screen-drawn": "screen_percent",
    "fogging-turns": "time_s",
    "sap-in-fruit": "fruit_kg",
    "pipes-heated": "pipe_c",
    "algae-on-panes": "days_unwashed",
    "lamps-dimmed": "lamp_percent",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
LAST = ("longer-of-two-kept", "speed-of-cable-in-one-gutter", "range-rounding")
THIN = 0.055


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the glasshouse's own."""
    rng = np.random.default_rng([811, seed])
    rows = picked(runs(rng, drawn.rare), 0.0 if drawn.same_mix else -1.0)
    clean = _asked(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = picked(runs(rng, drawn.rare), 0.0 if drawn.same_mix else 1.0)
        rows["link"] = ["in the plan, " + link for link in rows["link"]]
    many = rows.loc[np.tile(rows.index, drawn.ratio)].reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _asked(many, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return runs(np.random.default_rng([811, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _planted(clean, drawn, seed, "recorded")
    truth, _ = _planted(simulated, drawn, seed, "simulated")
    four = (recorded, clean, simulated, truth)
    shown, plain, model, true = (on_paper(one, drawn.listed) for one in four)
    return Tables(shown, plain, model, true, shifts)


def on_paper(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how trolleys are pushed, and what stands between unless listed."""
    away = list(STROKE) + ([] if listed else ["obstacles"])
    return table.drop(columns=away)


def runs(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a day: runs along rows, some of trolleys that stand."""
    many = rng.permutation(np.array(rounds))
    stands = np.zeros(len(many), bool)
    stands[rng.choice(len(many), 5, replace=False)] = True
    if rare == "exchange-motion":  # two short runs alone have a trolley that is pushed
        stands[:] = True
        stands[np.flatnonzero((many > 1) & (many < 5))[:2]] = False
    begins = np.sort(rng.uniform(0, 9 * 3600, len(many)))
    parts = [_run(rng, k, int(many[k]), begins[k], bool(stands[k])) for k in range(len(many))]
    return _climate(pd.concat(parts, ignore_index=True), rng, THIN if "diff" in rare else 0.18)


def _climate(table: pd.DataFrame, rng: np.random.Generator, steel: float) -> pd.DataFrame:
    """Return the table with what the glasshouse's computer logs of each row."""
    size = len(table)
    return table.assign(
        reply_time_s=0.006 + 0.075 * np.sqrt(rng.random(size)) * rng.random(size),
        leaf_wet_percent=100 * rng.beta(0.8, 0.9, size),
        screen_percent=100 * rng.beta(0.5, 0.6, size),
        fruit_kg=rng.gamma(1.6, 45.0, size),
        lamp_percent=rng.uniform(18, 100, size),
        obstacles=pd.Series(_stands_between(rng, table["link"], steel)),
    )


def picked(rows: pd.DataFrame, side: float) -> pd.DataFrame:
    """Return all rows for 0, or mostly those of near links for -1, of far ones for 1."""
    if side == 0:
        return rows.copy()
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=side < 0)
    wanted = np.maximum(1.2 * np.linspace(1, 0, len(far)) ** 1.5, 0.04)
    even = np.mod(0.41421356 * np.arange(1, len(far) + 1), 1)  # and not of chance
    return rows[rows["link"].isin(far.index[even < wanted])].reset_index(drop=True)


def _run(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one run: round after round, all gutters ask the tag of a trolley."""
    hooks = len(GUTTERS_M)
    gutter = np.tile(np.arange(hooks), rounds)
    since = np.repeat(np.arange(rounds), hooks) * ROUND_S + gutter * ASK_S
    stroke = _stroke(rng, since, stands)
    along = stroke.pop("along_m") + rng.uniform(6.5, HOUSE_M[1] - 6.5)
    across = ROW_M * (rng.integers(1, 20) + 0.5) + rng.normal(0, 0.05)
    at = np.array([0 * since + across, along, 0 * since + rng.uniform(0.8, 2.3)]).T
    way = GUTTERS_M[gutter] - at
    named = {f"{end}_{axis}_m": where[:, k]
             for end, where in (("tx", at), ("rx", GUTTERS_M[gutter]))
             for k, axis in enumerate("xyz")}  # fmt: skip
    rooms = {f"room_{axis}_m": side for axis, side in zip("xyz", HOUSE_M, strict=True)}
    once = _once(rng, len(since))
    return pd.DataFrame({**stroke, **named, **once}).assign(
        link=[f"run {number} below gutter {one}" for one in gutter],
        tx=f"trolley{rng.integers(TROLLEYS)}",
        rx=[f"gutter{one}" for one in gutter],
        environment="east bays" if across > HOUSE_M[0] / 2 else "west bays",
        time_s=begin_s + since,
        true_range_m=np.sqrt((way * way).sum(axis=1)),
        azimuth_deg=np.degrees(np.arctan2(-way[:, 0], way[:, 1])) + 180.0,
        channel=2,
        prf_mhz=64.0,
        **rooms,
    )


def _once(rng: np.random.Generator, size: int) -> dict[str, Floats]:
    """Return what changes little during a run."""
    return {
        "temperature_c": rng.uniform(16, 37) + 0.8 * rng.standard_normal(size),
        "pipe_c": rng.uniform(24, 72) + 1.5 * rng.standard_normal(size),
        "days_unwashed": rng.exponential(30.0) + rng.uniform(0, 1.5, size),
    }


def _stroke(rng: np.random.Generator, since: Floats, stands: bool) -> dict[str, Floats]:
    """Return how a trolley is pushed, with a beat of steps, and how far it has come in m."""
    push = 0.0 if stands else rng.choice([-1.0, 1.0]) * rng.uniform(0.45, 1.35)
    rate, phase = rng.uniform(0.5, 1.1), rng.uniform(0, 2 * np.pi)
    beats = (np.sin(phase + rate * since) - np.sin(phase)) / rate
    values = (push + 0 * since, rate + 0 * since, phase + rate * since)
    return dict(zip(STROKE, values, strict=True)) | {"along_m": push * (since - DEPTH * beats)}


def _stands_between(rng: np.random.Generator, links: pd.Series, steel: float) -> list[list[str]]:
    """Return what stands in straight paths: a cabinet of steel, parts of the house, or nothing."""
    codes, names = pd.factorize(links)
    met = []
    for _ in names:
        cabinet, *others = rng.random(1 + len(PARTS))
        some = [kind for kind, one in zip(PARTS, others, strict=True) if one < 0.15]
        met.append(["metal"] if cabinet < steel else some)
    return [met[code] for code in codes]


def through_plants(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: nearly as in the open, less what young plants take [n]."""
    across = (rows["tx_x_m"] - rows["rx_x_m"]).to_numpy(np.float64)
    decades = np.log10(rows["true_range_m"].to_numpy(np.float64))
    return np.asarray(-58.8 - 20.4 * decades - 0.27 * np.abs(across) / ROW_M)


def _asked(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the glasshouse's own radio."""
    size = len(rows)
    codes, names = pd.factorize(rows["link"])
    level = through_plants(rows) + (1.5 * rng.logistic(0, 0.45, len(names)))[codes]
    level = level + 0.5 * rng.uniform(-1, 1, size) + 0.25 * rng.standard_normal(size)
    error = 0.012 * scatter * (rng.standard_normal(size) + rng.uniform(-1.7, 1.7, size))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.8 - rng.weibull(1.5, size),
        noise_std=74.0 * np.exp(0.03 * rng.standard_normal(size)),
        preamble_count=np.rint(1009 - rng.gamma(3.0, 2.0, size)),
    )


def _planted(table: pd.DataFrame, drawn: Draw, seed: int, side: str) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([813, seed, len(side)])
    metres = {}
    for name in sorted(drawn.hidden, key=lambda one: LAST.index(one) if one in LAST else -1):
        growth = EFFECTS[name](Crop(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[name] = growth.metres
        table = _with(table, growth)
    shifts = [metres[name] for name in drawn.hidden]
    return table, np.array(shifts).reshape(len(shifts), len(table))


def _with(table: pd.DataFrame, growth: Growth) -> pd.DataFrame:
    """Return the table with what grows on its rows."""
    error = np.asarray(table["error_m"] + growth.metres)
    edge = np.asarray(growth.edge)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + growth.whole + 0.7 * edge,
        first_path_power_dbm=table["first_path_power_dbm"] + growth.whole + edge,
        noise_std=table["noise_std"] * np.power(10.0, np.asarray(growth.hiss) / 20),
        preamble_count=table["preamble_count"] * np.power(10.0, np.asarray(growth.count) / 20),
    )
