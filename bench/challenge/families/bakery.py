"""Racks that are pushed about a bakery, ranged from hoods over ovens: ranges and levels.

numpy and pandas alone; what it can hide is in `bakery_effects`, its waveforms in `bakery_waves`.
The room and the channel are known. A batch has from one to eight rounds, all hoods in each.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.bakery_effects import EFFECTS
from bench.challenge.families.bakery_house import (
    HOODS_M,
    HOUSE_M,
    LAWS,
    NIGHT_S,
    PARTS,
    PUSH,
    RACKS,
    Bake,
    Sheet,
    arc,
)
from bench.challenge.families.case import Draw, Tables

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 7, 8, 8)  # of batches, in any order
ROUND_S, NEXT_S = 0.31, 0.019
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
    "flour-settles": "flour_g",
    "prover-steams": "steam_percent",
    "burners-cycle": "time_s",
    "shutter-rolled-up": "shutter_percent",
    "fat-on-hoods": "fat_ml",
    "dough-rises": "dough_cm",
    "fan-belts-slip": "belt_n",
    "tag-a-shelf-away": "tx_z_m",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
WRITTEN = ("ranges-smoothed-slowly", "ells-from-one-hood", "range-rounding")  # last, in turn
MIXERS = {False: 0.17, True: 0.05}  # of links with steel in the way, usually and where it is rare


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the bakery's own."""
    rng = np.random.default_rng([921, 1, seed])
    rows = batches(rng, drawn.rare)
    rows = rows if drawn.same_mix else parted(rows, 1.0)
    clean = _weighed(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = batches(rng, drawn.rare)
        rows = rows if drawn.same_mix else parted(rows, -1.0)
        rows["link"] = "on paper " + rows["link"]
    rows = rows.loc[list(rows.index) * drawn.ratio].reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _weighed(rows, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return batches(np.random.default_rng([921, 1, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, metres = _baked(clean, drawn, seed, "found")
    truth, _ = _baked(simulated, drawn, seed, "truth")
    shown = [sold(table, drawn.listed) for table in (found, clean, simulated, truth)]
    return Tables(shown[0], shown[1], shown[2], shown[3], shifts_m=metres)


def sold(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how racks are pushed, and what stands between unless listed."""
    out = table.drop(columns=list(PUSH))
    return out if listed else out.drop(columns="obstacles")


def parted(rows: pd.DataFrame, sign: float) -> pd.DataFrame:
    """Return rows of the nearer 45 % of the links and a quarter of the others; of the farther."""
    rank = (sign * rows.groupby("link")["true_range_m"].mean()).rank(method="first")
    kept = rank.index[(rank <= 0.45 * len(rank)) | (rank % 4 == 0)]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def batches(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a night: batches, in some of which a rack stands."""
    order = [int(one) for one in rng.permutation(np.array(rounds))]
    stands = set(rng.permutation(len(order))[:5].tolist())
    if rare == "exchange-motion":  # all but one of two rounds and one of three
        stands = {*range(len(order))} - {order.index(2), order.index(3)}
    begin_s = np.sort(rng.uniform(0.0, NIGHT_S, len(order)))
    each = [_batch(rng, k, n, begin_s[k], k in stands) for k, n in enumerate(order)]
    table = pd.concat(each, ignore_index=True)
    between = _stand_between(rng, table["link"], MIXERS[rare == "diffraction"])
    return table.assign(**_noted(rng, len(table)), obstacles=pd.Series(between))


def _noted(rng: np.random.Generator, size: int) -> dict[str, Floats]:
    """Return what the bakery notes of each row."""
    return {
        "reply_time_s": 0.003 + 0.08 * rng.beta(1.2, 2.0, size),
        "flour_g": rng.gamma(1.3, 30.0, size),
        "steam_percent": 95.0 * rng.beta(1.2, 1.2, size),
        "shutter_percent": rng.uniform(0.0, 100.0, size),
        "fat_ml": rng.weibull(1.0, size) * 18.0,
        "dough_cm": rng.uniform(2.0, 34.0, size),
        "belt_n": rng.triangular(60.0, 120.0, 400.0, size),
    }


def _batch(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one batch: round after round, every hood asks the tag on a rack."""
    hood = np.arange(rounds * len(HOODS_M)) % len(HOODS_M)
    since_s = ROUND_S * (np.arange(len(hood)) // len(HOODS_M)) + NEXT_S * hood
    table = _pushed(rng, since_s, stands)
    off = HOODS_M[hood] - table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()
    seen = np.degrees(np.arctan2(off[:, 1], off[:, 0]) - table["heading_rad"])
    return table.assign(
        rx_x_m=HOODS_M[hood, 0],
        rx_y_m=HOODS_M[hood, 1],
        rx_z_m=HOODS_M[hood, 2],
        true_range_m=np.sqrt(np.square(off).sum(axis=1)),
        azimuth_deg=seen % 360.0,
        link=[f"batch {number} under hood {one}" for one in hood],
        tx=f"rack{rng.integers(RACKS)}",
        rx=[f"hood{one}" for one in hood],
        environment="bakehouse" if table["tx_y_m"].iloc[0] < 24 else "despatch",
        time_s=begin_s + since_s,
        temperature_c=rng.uniform(17.0, 57.0) + rng.uniform(-1.5, 1.5, len(hood)),
        channel=5,
        prf_mhz=64.0,
        room_x_m=HOUSE_M[0],
        room_y_m=HOUSE_M[1],
        room_z_m=HOUSE_M[2],
    )


def _pushed(rng: np.random.Generator, since_s: Floats, stands: bool) -> pd.DataFrame:
    """Return how a rack is pushed along an arc, and where its tag is."""
    pace = 0.0 if stands else rng.uniform(0.6, 1.5)
    turn = 0.0 if stands else rng.uniform(0.06, 0.5) * rng.choice([-1.0, 1.0])
    heading = rng.uniform(-np.pi, np.pi)
    start = rng.uniform([4.0, 4.0, 0.4], [HOUSE_M[0] - 4.0, HOUSE_M[1] - 4.0, 1.9])
    same = np.ones(len(since_s))
    place = start + arc(pace * same, turn * same, heading * same, since_s)
    return pd.DataFrame(place, columns=["tx_x_m", "tx_y_m", "tx_z_m"]).assign(
        heading_rad=heading + turn * since_s, pace_m_per_s=pace, turn_rad_per_s=turn
    )


def _stand_between(rng: np.random.Generator, links: pd.Series, mixers: float) -> list[list[str]]:
    """Return what stands in straight paths: a mixer of steel, parts of the house, or nothing."""
    names = links.drop_duplicates().to_list()
    steel = rng.random(len(names)) < mixers
    there = rng.random((len(names), len(PARTS))) < 0.17
    kinds = np.array(list(PARTS))
    found = {
        name: ["metal"] if steel[k] else kinds[there[k]].tolist() for k, name in enumerate(names)
    }
    return links.map(found).to_list()


def in_the_house(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: walls give back some of it, and flour takes a little [n]."""
    far = rows["true_range_m"].to_numpy(np.float64)
    return np.asarray(-63.5 - 17.6 * np.log10(far) - 0.06 * far)


def _weighed(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the bakery's own radio."""
    size, (number, names) = len(rows), pd.factorize(rows["link"])
    level = in_the_house(rows) + rng.uniform(-1.9, 1.9, len(names))[number]
    level = level + 0.35 * rng.standard_normal(size)
    even = rng.uniform(1e-4, 1 - 1e-4, size)
    error = scatter * 0.0115 * np.log(np.tan(0.5 * np.pi * even))  # a hyperbolic secant's scatter
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.4 - rng.gamma(2.0, 0.45, size),
        noise_std=69.0 * np.exp(rng.uniform(-0.05, 0.05, size)),
        preamble_count=254.0 - rng.poisson(3.0, size),
    )


def _baked(table: pd.DataFrame, drawn: Draw, seed: int, side: str) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([923, len(side), ord(side[0]), seed])
    metres = np.zeros((len(drawn.hidden), len(table)))
    last = [name for name in WRITTEN if name in drawn.hidden]
    for name in [*(one for one in drawn.hidden if one not in last), *last]:
        bake = EFFECTS[name](Sheet(table, seed, rng, drawn.rare != ""), drawn.strength)
        metres[drawn.hidden.index(name)] = bake.metres
        table = _with(table, bake)
    return table, metres


def _with(table: pd.DataFrame, bake: Bake) -> pd.DataFrame:
    """Return the table with what becomes of its rows."""
    out = table.copy()
    out["error_m"] += bake.metres
    out["range_m"] = out["true_range_m"] + out["error_m"]
    out["rx_power_dbm"] += np.asarray(bake.whole) + 0.6 * np.asarray(bake.front)
    out["first_path_power_dbm"] += np.asarray(bake.whole) + np.asarray(bake.front)
    out["noise_std"] *= 10 ** (np.asarray(bake.hiss) / 20)
    out["preamble_count"] *= 10 ** (np.asarray(bake.count) / 20)
    return out
