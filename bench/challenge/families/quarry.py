"""Diggers that slew in a quarry, ranged from masts on floor and bench: ranges and levels.

numpy and pandas alone; what it can hide is in `quarry_effects`, its waveforms in `quarry_waves`.
No room is known, but the channel is. A spell of digging has from one to ten rounds; some of the
calls of each are not answered.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.quarry_effects import EFFECTS
from bench.challenge.families.quarry_pit import (
    BENCH_M,
    DIGGERS,
    LAWS,
    MASTS_M,
    SHIFT_S,
    SLEW,
    STONE,
    Load,
    Spoil,
)

Floats = NDArray[np.float64]
ROUNDS = (1, 2, 3, 3, 4, 5, 6, 6, 7, 8, 9, 10, 10)  # of spells, in any order
ROUND_S, CALL_S = 0.38, 0.027
HEARD = 0.86  # of calls after the first
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
    "dust-cloud": "dust_mg",
    "sump-pumped": "time_s",
    "bucket-laden": "bucket_t",
    "rock-settles": "minutes_since_blast",
    "mud-on-domes": "mud_mm",
    "puddles-spread": "rain_mm",
    "generator-hunts": "supply_hz",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
IN_THE_OFFICE = ("reports-by-exception", "chain-links-from-one-mast", "range-rounding")
SCANT = 0.06


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the quarry's own."""
    rng = np.random.default_rng([831, seed])
    rows = quarried(spells(rng, drawn.rare), "both" if drawn.same_mix else "floor")
    clean = _heard(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = quarried(spells(rng, drawn.rare), "both" if drawn.same_mix else "rim")
        rows["link"] = "as drafted: " + rows["link"].astype(str)
    model = _heard(pd.concat([rows for _ in range(drawn.ratio)]), rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, model.reset_index(drop=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return spells(np.random.default_rng([831, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    streams = (np.random.default_rng([seed, 833, side]) for side in range(2))
    found, metres = _loaded(clean, drawn, seed, next(streams))
    truth, _ = _loaded(simulated, drawn, seed, next(streams))
    four = (published(one, drawn.listed) for one in (found, clean, simulated, truth))
    shown, plain, model, true = four
    return Tables(shown, plain, model, true, metres)


def published(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how booms move, and what stands between unless listed."""
    shown = [name for name in table.columns if name not in SLEW]
    return table[shown if listed else [name for name in shown if name != "obstacles"]].copy()


def spells(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a shift: spells, in some of which nothing moves."""
    order = rng.permutation(len(rounds))
    still = set(rng.permutation(len(rounds))[:4].tolist())
    if rare == "exchange-motion":  # two short spells alone have a boom that moves
        short = [k for k, one in enumerate(order) if 1 < rounds[one] < 5][:2]
        still = {*range(len(rounds))} - {*short}
    starts = np.sort(rng.uniform(0, SHIFT_S, len(rounds)))
    made = [_spell(rng, k, rounds[order[k]], starts[k], k in still) for k in range(len(rounds))]
    table = pd.concat(made, ignore_index=True)
    first = ~table["link"].duplicated().to_numpy()
    table = table[first | (rng.random(len(table)) < HEARD)].reset_index(drop=True)
    return _weather(table, rng, SCANT if rare == "diffraction" else 0.17)


def _weather(table: pd.DataFrame, rng: np.random.Generator, steel: float) -> pd.DataFrame:
    """Return the table with what the quarry's office logs of each row."""
    size = len(table)
    table["reply_time_s"] = 0.0035 + 0.085 * rng.power(0.7, size)
    table["dust_mg"] = 10.0 * rng.beta(1.1, 1.7, size)
    table["bucket_t"] = np.maximum(rng.uniform(-1.2, 6.0, size), 0.0)
    table["mud_mm"] = rng.weibull(1.1, size) * 7.0
    table["rain_mm"] = rng.gamma(0.8, 6.0, size)
    table["supply_hz"] = rng.normal(49.6, 0.45, size)
    table["obstacles"] = _in_the_way(rng, table["link"], steel)
    return table


def quarried(rows: pd.DataFrame, where: str) -> pd.DataFrame:
    """Return all rows, or mostly those of near links (`floor`) or of far ones (`rim`)."""
    if where == "both":
        return rows.copy()
    far = rows.groupby("link")["true_range_m"].mean().rank(pct=True)
    place = far if where == "rim" else 1 - far
    wanted = (1.15 * place**1.8).clip(0.03, 1)
    even = np.mod(0.2360679775 * np.arange(len(far)) + 0.1, 1)  # and not of chance
    return rows[rows["link"].isin(far.index[even < wanted])].reset_index(drop=True)


def _spell(
    rng: np.random.Generator, number: int, rounds: int, start_s: float, still: bool
) -> pd.DataFrame:
    """Return one spell: round after round, all masts call the tag on a boom."""
    mast = np.resize(np.arange(len(MASTS_M)), rounds * len(MASTS_M))
    since = ROUND_S * (np.arange(mast.size) // len(MASTS_M)) + CALL_S * mast
    table = _boom(rng, since, still)
    here = table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()
    table[["rx_x_m", "rx_y_m", "rx_z_m"]] = MASTS_M[mast]
    table["true_range_m"] = np.linalg.norm(MASTS_M[mast] - here, axis=1)
    table["azimuth_deg"] = _seen_from(table, MASTS_M[mast] - here)
    table["link"] = [f"spell {number} seen from mast {one}" for one in mast]
    table["tx"] = f"digger{rng.integers(DIGGERS)}"
    table["rx"] = [f"mast{one}" for one in mast]
    table["environment"] = "bench" if here[0, 2] > BENCH_M else "floor"
    table["time_s"] = start_s + since
    table["temperature_c"] = rng.uniform(-5, 29) + 1.1 * rng.standard_normal(mast.size)
    table["minutes_since_blast"] = rng.uniform(3.5, 60.0) + rng.exponential(4.0, mast.size)
    return table.assign(channel=3, prf_mhz=64.0)


def _boom(rng: np.random.Generator, since: Floats, still: bool) -> pd.DataFrame:
    """Return how a boom slews and rises, and where its end is."""
    slew, hoist = (0.0, 0.0) if still else (rng.uniform(0.16, 0.5), rng.uniform(-0.1, 0.3))
    slew *= rng.choice([-1, 1])
    arm, bearing = rng.uniform(3.0, 6.5), rng.uniform(0, 2 * np.pi) + slew * since
    up = BENCH_M * (rng.random() < 0.25)
    east = rng.uniform(14.0, 50.0)
    north = rng.uniform(29.0, 30.5) if up else rng.uniform(13.0, 27.0)
    ones = np.ones_like(since)
    held = dict(zip(SLEW, (arm * ones, bearing, slew * ones, hoist * ones), strict=True))
    return pd.DataFrame(held).assign(
        tx_x_m=east + arm * np.cos(bearing),
        tx_y_m=north + arm * np.sin(bearing),
        tx_z_m=up + rng.uniform(2.0, 4.5) + hoist * since,
    )


def _seen_from(table: pd.DataFrame, way: Floats) -> Floats:
    """Return from where, next to their booms, diggers see masts, in degrees [n]."""
    turned = np.arctan2(way[:, 1], way[:, 0]) - table["bearing_rad"].to_numpy()
    return np.asarray(np.mod(np.degrees(turned), 360.0))


def _in_the_way(rng: np.random.Generator, links: pd.Series, steel: float) -> pd.Series:
    """Return what stands in straight paths: a dumper's skip of steel, stones, or nothing."""
    kinds = np.array(list(STONE))

    def met() -> list[str]:
        there = kinds[rng.random(kinds.size) < 0.15].tolist()
        return ["metal"] if rng.random() < steel else there

    return links.map({link: met() for link in links.unique()})


def over_rock(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, and less from the bench down to the floor [n]."""
    far = rows["true_range_m"].to_numpy(np.float64)
    fall = (rows["rx_z_m"] - rows["tx_z_m"]).abs().to_numpy(np.float64) / far
    return np.asarray(-59.8 - 19.8 * np.log10(far) - 4.5 * fall)


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the quarry's own radio."""
    size = len(rows)
    number, links = rows["link"].factorize()
    level = over_rock(rows) + rng.uniform(-1.6, 1.6, links.size)[number]
    level = level + 0.35 * rng.laplace(size=size)
    error = scatter * 0.0118 * rng.standard_t(9.0, size)
    made = rows.assign(error_m=error, range_m=rows["true_range_m"] + error)
    made["rx_power_dbm"] = level
    made["first_path_power_dbm"] = level - 0.5 - rng.exponential(0.9, size)
    made["noise_std"] = 88.0 + 2.4 * rng.normal(size=size)
    made["preamble_count"] = 122.0 - rng.binomial(7, 0.3, size)
    return made


def _loaded(
    table: pd.DataFrame, drawn: Draw, seed: int, rng: np.random.Generator
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    metres = np.zeros((len(drawn.hidden), len(table)))
    outside = [name for name in drawn.hidden if name not in IN_THE_OFFICE]
    inside = [name for name in IN_THE_OFFICE if name in drawn.hidden]
    for name in outside + inside:
        load = EFFECTS[name](Spoil(table, seed, rng, drawn.rare != ""), drawn.strength)
        metres[drawn.hidden.index(name)] = load.metres
        table = _carrying(table, load)
    return table, metres


def _carrying(table: pd.DataFrame, load: Load) -> pd.DataFrame:
    """Return the table with a load on its rows."""
    out = table.copy()
    out["error_m"] += load.metres
    out["range_m"] = out["true_range_m"] + out["error_m"]
    out["first_path_power_dbm"] += load.edge + np.asarray(load.whole)
    out["rx_power_dbm"] += 0.55 * np.asarray(load.edge) + load.whole
    out["noise_std"] *= 10.0 ** (np.asarray(load.hiss) / 20)
    out["preamble_count"] *= 10.0 ** (np.asarray(load.count) / 20)
    return out
