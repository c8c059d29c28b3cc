"""Engines, a turntable and hoists of a roundhouse, ranged from its piers: ranges and levels.

numpy and pandas alone; what it can hide is in `roundhouse_effects`, waveforms in
`roundhouse_waves`. Channel and line of sight are known, the house is round and of no size that
columns have. From two to seven readers range a tag at each shunt, each after waits of its own.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.roundhouse_effects import EFFECTS
from bench.challenge.families.roundhouse_stalls import (
    BETWEEN,
    CENTRE_M,
    COURSE,
    DAY_S,
    DOORS_M,
    DRAGGED,
    ENDS,
    ENGINES,
    LAWS,
    PIERS,
    PIERS_M,
    RING_M,
    ROADS_RAD,
    TABLE_M,
    TAGS,
    Shunt,
    Toll,
    carried,
)

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Shunt", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
READ_BY: Integers = np.repeat(np.arange(2, 8), [4, 6, 6, 5, 4, 1])
"""By how many piers shunts are read."""
OF_ROWS: Integers = np.repeat(np.arange(1, 11), [15, 13, 12, 12, 11, 10, 10, 9, 8, 6])
"""How many rows links have."""
STILL = 6  # shunts whose tag stands or hangs
WAITS, WAIT_S = 5.0, 0.062  # of readers between ranges: a sum of as many waits, each as long
STEEL = {False: 0.17, True: 0.05}  # of links, and where it is rare
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "time-lag": "time_s",
    "antenna-delay": "time_s",
    "exchange-motion": "reply_time_s",
    "clock-offset": "reply_time_s",
    "range-scale": "true_range_m",
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "level-control": "true_range_m",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "steam-leaks": "steam_kgh",
    "bunker-filled": "coal_t",
    "pit-takes-water": "pit_cm",
    "rail-chairs-passed": "chairs_m",
    "louvres-opened": "louvre_pct",
    "welder-near": "welder_m",
    "oil-creeps-on-covers": "oil_ml",
}
RARELY = ("blocked-path", "diffraction")
AT_LAST = ("arshins-from-one-pier", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SUMS, GRAIN = 486.0, 4.05  # symbols that are summed; counts of noise for each root of one
OWN_DB: Floats = np.random.default_rng(1702).triangular(-1.8, 0.2, 1.6, PIERS)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the roundhouse's own."""
    rng = np.random.default_rng([seed, 1703])
    clean = _ranged(some(shunts(rng, drawn.rare), drawn, "near"), rng, drawn.scatter)
    rows = clean.drop(columns=[*MEASURED])
    if not drawn.paired:
        rows = some(shunts(rng, drawn.rare), drawn, "far")
        rows = rows.assign(link="by night, " + rows["link"])
    more = rows.loc[np.tile(rows.index, drawn.ratio)].reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _ranged(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return shunts(np.random.default_rng([seed, 1703]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _with(clean, drawn, seed, 1)
    truth, _ = _with(simulated, drawn, seed, 2)
    found, plain, other, true = (
        as_told(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def as_told(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without courses, and without obstacles unless they are listed."""
    return table.drop(columns=[*COURSE] if listed else [*COURSE, "obstacles"])


MEASURED = (
    "error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count"
)  # fmt: skip
"""Columns that are not known before anything is measured."""


def some(rows: pd.DataFrame, drawn: Draw, more: str) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of more `near` links, or of more `far`.

    Of the third of links that there are to be more of, all, of the next a half, then a sixth.
    """
    if drawn.same_mix:
        return rows
    rank = rows.groupby("link")["true_range_m"].mean().rank(method="first") - 1
    rank = rank if more == "near" else rank.max() - rank
    kept = np.select(
        [rank < len(rank) / 3, rank < len(rank) / 1.5], [True, rank % 2 == 0], rank % 6 == 0
    )
    return rows[rows["link"].map(dict(zip(rank.index, kept, strict=True)))].reset_index(drop=True)


def shunts(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    by, sizes = rng.permutation(READ_BY), rng.permutation(of_rows)
    begins_s = np.sort(rng.uniform(0.0, DAY_S, len(by)))
    still = rng.permutation(len(by)) < STILL
    lots = np.split(sizes, np.cumsum(by)[:-1])
    parts = [_shunt(rng, k, lots[k], float(begins_s[k]), bool(still[k])) for k in range(len(by))]
    rows = pd.concat(parts, ignore_index=True).assign(channel=5, prf_mhz=64.0)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(los=rows["obstacles"].str.len() == 0)


def _shunt(
    rng: np.random.Generator, number: int, sizes: Integers, begin_s: float, still: bool
) -> pd.DataFrame:
    """Return the rows of one shunt, by time."""
    who = int(rng.choice(len(TAGS), p=[0.11] * ENGINES + [0.09] * ENDS + [0.38 / 3] * 3))
    since_s = np.concatenate([_waited(rng, int(size)) for size in sizes])
    order = np.argsort(since_s)
    since_s, reader = since_s[order], np.repeat(np.arange(len(sizes)), sizes)[order]
    one = _course(rng, who)
    if still:
        one |= {"go_r": 0.0, "go_rad": 0.0, "go_z": 0.0}
    course = {name: np.full(len(reader), value) for name, value in one.items()}
    course["into_s"] = rng.uniform(0.02, 0.42) * one["lasts_s"] + since_s
    there = carried(course, course["into_s"])
    pier = _asked(rng, there, len(sizes))[reader]
    both = {"tx": there, "rx": PIERS_M[pier]}
    places = {f"{end}_{axis}_m": p[:, k] for end, p in both.items() for k, axis in enumerate("xyz")}
    return pd.DataFrame(course | places | _logged(rng, there, begin_s)).assign(
        tx=TAGS[who],
        rx=[f"pier{one}" for one in pier],
        link=[f"shunt {number} by pier{one}" for one in pier],
        environment=("stalls", "turntable", "ring")[int(one["way_of_going"])],
        true_range_m=np.linalg.norm(PIERS_M[pier] - there, axis=1),
        azimuth_deg=_seen_at(rng, there, PIERS_M[pier]),
        time_s=begin_s + since_s,
    )


def _waited(rng: np.random.Generator, size: int) -> Floats:
    """Return when a reader has ranges [size], in s: after waits, which differ."""
    return np.cumsum(0.02 + rng.gamma(WAITS, WAIT_S, size))


def _course(rng: np.random.Generator, who: int) -> dict[str, float]:
    """Return the course of a tag: engines begin at 0.8 to 2.2 m/s, others reach 0.5 to 1.6 m/s."""
    lasts_s, sense = rng.uniform(5.5, 10.5), float(rng.choice([-1.0, 1.0]))
    made = dict.fromkeys(COURSE, 0.0) | {"lasts_s": lasts_s}
    if who < ENGINES:
        long_m = lasts_s * rng.uniform(0.8, 2.2) * np.log1p(DRAGGED) / DRAGGED
        room_m = 13.6 - 1.16 * long_m  # of what roads are long from doors to buffers
        begin_m = 17.8 + rng.uniform(0.0, room_m) + (1.16 * long_m if sense < 0 else 0.0)
        made |= {"from_r": begin_m, "go_r": sense * long_m, "from_rad": float(ROADS_RAD[who])}
        return made | {"from_z": rng.uniform(1.3, 3.1)}
    if who < ENGINES + ENDS:
        arc = lasts_s * rng.uniform(0.5, 1.6) / 1.875 / TABLE_M
        made |= {"from_r": TABLE_M, "from_rad": rng.uniform(0.0, 2 * np.pi), "go_rad": sense * arc}
        return made | {"from_z": rng.uniform(0.7, 1.4), "way_of_going": 1.0}
    arc = lasts_s * rng.uniform(0.5, 1.6) / 1.5 / RING_M
    made |= {"from_r": RING_M, "go_rad": sense * arc, "way_of_going": 2.0}
    made |= {"from_rad": 0.5 * np.pi + sense * rng.uniform(-1.3, 1.3 - arc)}
    return made | {"from_z": rng.uniform(2.7, 4.7), "go_z": rng.uniform(-1.6, 1.6)}


def _seen_at(rng: np.random.Generator, there: Floats, hung: Floats) -> Floats:
    """Return where readers are from what tags look at, in degrees [n]: inward, outward or round."""
    look = 0.5 * np.pi * rng.integers(4)
    ray, way = (
        (one @ np.array([1.0, 1.0j, 0.0])) for one in (there - [*CENTRE_M, 0], hung - there)
    )
    return np.asarray(np.degrees(np.angle(way / ray) - look) % 360.0)


def _asked(rng: np.random.Generator, there: Floats, count: int) -> Integers:
    """Return which piers range a tag [count]: by lots, of which far ones have fewer."""
    lots = np.exp(-np.linalg.norm(PIERS_M - there.mean(axis=0), axis=1) / 10.0)
    return rng.choice(PIERS, count, replace=False, p=lots / lots.sum())


def _logged(rng: np.random.Generator, there: Floats, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: it is warm where engines' fires are, and by day."""
    n, part = len(there), begin_s / DAY_S
    out_m = np.hypot(*(there[:, :2] - CENTRE_M).T)
    day_c = 12.0 + 8.0 * np.sin(np.pi * part) + rng.normal(0.0, 2.5)
    fires_c = 13.0 * np.exp(-(((out_m - 22.0) / 7.0) ** 2))
    return {
        "temperature_c": day_c + fires_c + rng.normal(0.0, 1.6, n),
        "reply_time_s": rng.triangular(0.003, 0.011, 0.064, n),
        "steam_kgh": rng.gamma(1.4, 5.0) + rng.gamma(1.5, 5.0, n),
        "coal_t": np.clip(rng.uniform(0.5, 9.5) + rng.normal(0.0, 1.0, n), 0.2, 11.0),
        "pit_cm": np.clip(rng.uniform(4.0, 54.0) + rng.normal(0.0, 7.0, n), 1.0, 62.0),
        "chairs_m": rng.uniform(0.0, 40.0) + np.cumsum(rng.uniform(0.08, 0.7, n)),
        "louvre_pct": np.clip(rng.uniform(0.0, 100.0) + rng.normal(0.0, 15.0, n), 0.0, 100.0),
        "welder_m": 1.4 + rng.gamma(1.5, 1.7) + rng.exponential(1.2, n),
        "oil_ml": rng.gamma(1.6, 3.2) + rng.gamma(1.6, 2.4, n),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through: engines of steel by lot, else what stands there.

    Doors where a way leads out of the house, if they are shut; flanks of piers by how many stalls
    it crosses; panes by what is high.
    """
    shunt = Shunt(rows, 0, rng)
    first = np.unique(shunt.link, return_index=True)[1]
    out_m = [np.hypot(*(end[first, :2] - CENTRE_M).T) for end in (shunt.there, shunt.hung)]
    inside = out_m[0] > DOORS_M, out_m[1] > DOORS_M
    odds = {
        "brick": (1 - 0.82 ** shunt.crossed[first]) * (inside[0] & inside[1]),
        "wood": 0.42 * (inside[0] != inside[1]),
        "glass": np.where(shunt.there[first, 2] > 2.6, 0.2, 0.09),
    }
    met = {
        kind: rng.random(len(first)) < (0.45 if rare in RARELY else 1.0) * odds[kind]
        for kind in BETWEEN
    }
    steel = rng.permutation(len(first)) < round(STEEL[rare == "diffraction"] * len(first))
    each = [
        ["metal"] if steel[k] else [kind for kind in BETWEEN if met[kind][k]]
        for k in range(len(first))
    ]
    return [list(each[k]) for k in shunt.link]


def in_the_house(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as among engines, by readers that differ, with fades of links."""
    shunt = Shunt(rows, 0, rng)
    fades = shunt.per_link(lambda n: 1.0 - 3.6 * rng.beta(1.6, 3.2, n))
    return -63.4 - 17.2 * np.log10(shunt.far) - 0.05 * shunt.far + OWN_DB[shunt.pier] + fades


def summed(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each."""
    symbols = SUMS - rng.binomial(16, 0.22, len(rows)).astype(np.float64)
    own = (1 - 0.018 * OWN_DB[Shunt(rows, 0, rng).pier]) * rng.lognormal(0.0, 0.033, len(rows))
    return symbols, np.asarray(GRAIN * np.sqrt(symbols) * own, np.float64)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the roundhouse's own ranges and levels.

    Errors follow a law between a bell and Laplace's (Subbotin 1923), the wider the weaker it is.
    """
    level, size = in_the_house(rows, rng), len(rows)
    wide = 0.0165 * np.hypot(1.0, 10 ** ((-90.0 - level) / 20))
    sizes = rng.gamma(1 / 1.4, 1.0, size) ** (1 / 1.4) * rng.choice([-1.0, 1.0], size)
    symbols, noise = summed(rows, rng)
    level = level + rng.normal(0.0, 0.28, size)
    error = scatter * wide * sizes
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.35 - rng.gamma(2.4, 0.45, size),
        noise_std=noise,
        preamble_count=symbols,
    )


def _with(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    metres = np.zeros((len(drawn.hidden), len(table)))
    late = {name: k for k, name in enumerate(AT_LAST, 1)}
    for name in sorted(sorted(drawn.hidden), key=lambda one: late.get(one, 0)):
        own = np.random.default_rng([seed, 1704, side, *name.encode()])
        toll = EFFECTS[name](Shunt(table, seed, own, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = toll.metres
        table = _paid(table, toll)
    return table, metres


def _paid(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table with what becomes of its rows; 0.64 of all that comes is of first paths.

    Of symbols that are not summed noise is less by their root.
    """
    rest = 10 * np.log10(0.64 * 10 ** (np.asarray(toll.first_db) / 10) + 0.36)
    error = table["error_m"] + toll.metres
    quiet_db = toll.hiss_db + 0.5 * np.asarray(toll.sums_db)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + toll.whole_db + rest,
        first_path_power_dbm=table["first_path_power_dbm"] + toll.whole_db + toll.first_db,
        noise_std=table["noise_std"] * 10 ** (quiet_db / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(toll.sums_db) / 20),
    )
