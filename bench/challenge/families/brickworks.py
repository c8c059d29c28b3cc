"""Cars, traversers and grabs of a brickworks, ranged from its kilns' buckstays: ranges and levels.

numpy and pandas alone; what it can hide is in `brickworks_effects`, waveforms in
`brickworks_waves`. Hall, channel and line of sight are known. From two to eight readers range a tag
at each push, and skip some turns of it.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.brickworks_effects import EFFECTS
from bench.challenge.families.brickworks_yard import (
    BETWEEN,
    BUCKSTAYS,
    BUCKSTAYS_M,
    CARS,
    COLUMNS_M,
    COURSE,
    DAY_S,
    HALL_M,
    LAWS,
    TAGS,
    TRACKS_Y_M,
    TRAVERSERS,
    Push,
    Upshot,
    carried,
)
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Push", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
READ_BY: Integers = np.repeat([2, 3, 4, 5, 6, 7, 8], [3, 4, 5, 5, 4, 1, 1])
"""By how many buckstays pushes are read."""
OF_ROWS: Integers = np.repeat(np.arange(1, 12), [13, 12, 11, 11, 10, 9, 9, 8, 8, 6, 5])
"""How many rows links have."""
STILL = 5  # pushes whose tag stands or hangs
TURN_S, WITHIN_S, SKIPPED = 0.31, 0.017, 0.14  # of all readers; of one; of turns, a share
SHARES, DOORS = {False: 0.2, True: 0.08}, {False: 0.15, True: 0.05}  # of links
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
    "glaze-dust-on-covers": "glaze_mg",
    "ware-still-wet": "water_pct",
    "draught-bends-flues": "draught_pa",
    "tie-rods-passed": "rods_m",
    "damper-opened": "damper_deg",
    "clay-press-near": "press_m",
    "soot-on-radomes": "soot_mg",
}
RARELY = ("blocked-path", "diffraction")
AT_LAST = ("alnar-from-one-buckstay", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SUMS, GRAIN = 238.0, 4.15  # symbols that are summed; counts of noise for each root of one
OWN_DB: Floats = np.random.default_rng(1602).uniform(-1.5, 1.5, BUCKSTAYS)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the brickworks' own."""
    rng = np.random.default_rng([seed, 1603])
    rows = chosen(pushes(rng, drawn.rare), drawn, near=True)
    clean = _read(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = chosen(pushes(rng, drawn.rare), drawn, near=False)
        rows = rows.assign(link="on the late shift, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _read(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return pushes(np.random.default_rng([seed, 1603]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _with_all(clean, drawn, seed, 1)
    truth, _ = _with_all(simulated, drawn, seed, 2)
    found, plain, other, true = (
        as_told(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def as_told(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without courses, and without obstacles unless they are listed."""
    away = {*COURSE} if listed else {*COURSE, "obstacles"}
    return table[[name for name in table if name not in away]]


def chosen(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of more near links, or of more far ones.

    Of links in the order of distance, from one end on: all of a third, half of the next, a sixth.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    place = np.arange(len(means))
    third = 3 * place // len(place)
    kept = np.select([third == 0, third == 1], [True, place % 2 == 0], place % 6 == 0)
    return rows[rows["link"].isin(means.index[kept.astype(bool)])].reset_index(drop=True)


def pushes(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    many, sizes = rng.permutation(READ_BY), rng.permutation(of_rows)
    begins_s = np.sort(rng.uniform(0.0, DAY_S, len(many)))
    still = rng.permutation(np.arange(len(many)) < STILL)
    ends = np.cumsum(many)
    parts = [
        _push(rng, k, sizes[ends[k] - many[k] : ends[k]], float(begins_s[k]), bool(still[k]))
        for k in range(len(many))
    ]
    rows = pd.concat(parts, ignore_index=True).assign(channel=3, prf_mhz=64.0)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(los=rows["obstacles"].map(len).eq(0))


def _push(
    rng: np.random.Generator, number: int, sizes: Integers, begin_s: float, still: bool
) -> pd.DataFrame:
    """Return one push, by time: readers have turns, begin some later and skip some."""
    who = int(rng.choice(len(TAGS), p=[0.11] * CARS + [0.08] * TRAVERSERS + [0.4 / 3] * 3))
    reader = np.repeat(np.arange(len(sizes)), sizes)
    turns = [int(rng.integers(0, 3)) + _turns(rng, int(size)) for size in sizes]
    since_s = TURN_S * np.concatenate(turns) + WITHIN_S * reader
    since_s = since_s + rng.uniform(0.0, 0.005, len(reader))
    order = np.argsort(since_s)
    reader, since_s = reader[order], since_s[order]
    one = _course(rng, who)
    if still:
        one |= dict.fromkeys(("go_x", "go_y", "go_z", "slew_rad"), 0.0)
    into_s = rng.uniform(0.0, 0.45) * one["lasts_s"] + since_s
    course = {name: np.full(len(reader), value) for name, value in one.items()}
    course |= {"into_s": into_s}
    there = carried(course, into_s)
    heard = _heard(rng, there.mean(axis=0), len(sizes))[reader]
    places = {f"tx_{axis}_m": there[:, k] for k, axis in enumerate("xyz")}
    places |= {f"rx_{axis}_m": BUCKSTAYS_M[heard, k] for k, axis in enumerate("xyz")}
    places |= {f"room_{axis}_m": np.full(len(reader), HALL_M[k]) for k, axis in enumerate("xyz")}
    apart = BUCKSTAYS_M[heard] - there
    seen = np.arctan2(apart[:, 1], apart[:, 0]) - _faces(rng, there, one)
    return pd.DataFrame(course | places | _logged(rng, there, begin_s)).assign(
        tx=TAGS[who],
        rx=[f"buckstay{one}" for one in heard],
        link=[f"push {number} by buckstay{one}" for one in heard],
        environment=("kiln", "transfer", "setting")[int(one["gait"])],
        true_range_m=np.linalg.norm(apart, axis=1),
        azimuth_deg=np.degrees(seen) % 360.0,
        time_s=begin_s + since_s,
    )


def _turns(rng: np.random.Generator, size: int) -> Integers:
    """Return in which turns a reader has a range [size], from 0 on."""
    gaps = 1 + (rng.random(size) < SKIPPED)
    return np.asarray(np.cumsum(gaps) - gaps[0], np.int64)


def _course(rng: np.random.Generator, who: int) -> dict[str, float]:
    """Return the course of a tag: cars begin at 0.8 to 2.2 m/s, others reach 0.5 to 1.7 m/s."""
    lasts_s, sense = rng.uniform(5.5, 10.5), float(rng.choice([-1.0, 1.0]))
    made = dict.fromkeys(COURSE, 0.0) | {"lasts_s": lasts_s}
    if who < CARS:
        long_m = 0.4 * lasts_s * rng.uniform(0.8, 2.2)
        middle_m = rng.uniform(4.0 + long_m / 2, HALL_M[0] - 4.0 - long_m / 2)
        made |= {"from_x": middle_m - sense * long_m / 2, "go_x": sense * long_m}
        return made | {"from_y": float(TRACKS_Y_M[who]), "from_z": rng.uniform(1.1, 2.7)}
    if who < CARS + TRAVERSERS:
        long_m = 0.5 * lasts_s * rng.uniform(0.6, 1.7)
        middle_m = rng.uniform(2.0 + long_m / 2, HALL_M[1] - 2.0 - long_m / 2)
        made |= {"from_x": 2.6 if who == CARS else HALL_M[0] - 2.9, "gait": 1.0}
        made |= {"from_y": middle_m - sense * long_m / 2, "go_y": sense * long_m}
        return made | {"from_z": rng.uniform(0.5, 1.3)}
    boom_m, column = rng.uniform(2.4, 7.4), COLUMNS_M[int(rng.integers(len(COLUMNS_M)))]
    round_m = 2 / np.pi * lasts_s * rng.uniform(0.5, 1.7)
    made |= {"from_x": float(column[0]), "from_y": float(column[1]), "gait": 2.0}
    made |= {"boom_m": boom_m, "from_rad": rng.uniform(0.0, 2 * np.pi)}
    made |= {"from_z": rng.uniform(2.6, 4.8), "go_z": rng.uniform(-1.6, 1.6)}
    return made | {"slew_rad": sense * round_m / boom_m}


def _faces(rng: np.random.Generator, there: Floats, course: dict[str, float]) -> Floats:
    """Return which way tags look, in radians [n]: grabs outward, all else along or across."""
    ahead = 0.5 * np.pi * float(rng.integers(4))
    column = np.array([course["from_x"], course["from_y"]])
    out = np.arctan2(there[:, 1] - column[1], there[:, 0] - column[0])
    return np.asarray(np.where(course["boom_m"] > 0, out, ahead))


def _heard(rng: np.random.Generator, middle: Floats, count: int) -> Integers:
    """Return which buckstays range a tag [count]: by lots, of which far ones have fewer."""
    far = np.linalg.norm(BUCKSTAYS_M - middle, axis=1)
    return rng.choice(BUCKSTAYS, count, replace=False, p=_shares(np.exp(-far / 14.0)))


def _shares(weight: Floats) -> Floats:
    return np.asarray(weight / weight.sum())


def _logged(rng: np.random.Generator, there: Floats, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: it is hottest in the kilns' middle, and in the day."""
    size, hour = len(there), begin_s / 3600.0
    kiln_c = 16.0 / (1 + ((there[:, 0] - 24.0) / 9.0) ** 2)
    day_c = 24.0 + 5.0 * np.sin(np.pi * hour / 10.4) + rng.normal(0.0, 2.0)
    return {
        "temperature_c": day_c + kiln_c + rng.normal(0.0, 1.4, size),
        "reply_time_s": 0.0035 + 0.058 * rng.beta(1.1, 1.8, size),
        "glaze_mg": rng.gamma(1.5, 1.9) + rng.gamma(1.3, 2.0, size),
        "water_pct": np.clip(rng.uniform(4.0, 24.0) + rng.normal(0.0, 2.2, size), 1.0, 27.0),
        "draught_pa": np.clip(rng.uniform(10.0, 150.0) + rng.normal(0.0, 22.0, size), 2.0, 175.0),
        "rods_m": rng.uniform(0.0, 60.0) + np.cumsum(rng.uniform(0.1, 1.0, size)),
        "damper_deg": np.clip(rng.uniform(0.0, 90.0) + rng.normal(0.0, 14.0, size), 0.0, 90.0),
        "press_m": 1.3 + rng.gamma(1.6, 1.6) + rng.exponential(1.3, size),
        "soot_mg": rng.gamma(1.8, 6.0) + rng.gamma(1.5, 4.0, size),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through: doors of steel by lot, else stacks and cabins.

    Stacks of ware are met the more the longer the way is, pallets by low tags, panes by high ones.
    """
    push = Push(rows, 0, rng)
    first = np.unique(push.link, return_index=True)[1]
    odds = SHARES[rare in RARELY] * np.ones((len(first), len(BETWEEN)))
    odds[:, 0] *= np.clip(push.far[first] / 14.0, 0.5, 1.6)
    odds[:, 1] *= np.where(push.there[first, 2] < 2.2, 1.25, 0.6)
    odds[:, 2] *= np.where(push.there[first, 2] < 2.2, 0.5, 1.0)
    met = rng.random(odds.shape) < odds
    lot = rng.permutation(len(first)) < round(DOORS[rare == "diffraction"] * len(first))
    kinds = [*BETWEEN]
    each = [
        ["metal"] if lot[k] else [kinds[one] for one in np.flatnonzero(met[k])]
        for k in range(len(first))
    ]
    return [[*each[one]] for one in push.link]


def in_the_hall(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in an aisle with dust in it, readers that differ, hooks."""
    push = Push(rows, 0, rng)
    hooks = push.each_link(lambda n: 1.1 - 1.3 * rng.weibull(1.7, n).clip(max=2.6))
    lost = 16.4 * np.log10(push.far) + 0.12 * push.far
    return np.asarray(-59.1 - lost + OWN_DB[push.buckstay] + hooks, np.float64)


def summed(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each."""
    symbols = SUMS - rng.poisson(2.3, len(rows)).clip(max=9).astype(np.float64)
    own = 1 + 0.022 * OWN_DB[Push(rows, 0, rng).buckstay]
    noise = GRAIN * np.sqrt(symbols) * own * rng.gamma(820.0, 1 / 820.0, len(rows))
    return symbols, np.asarray(noise, np.float64)


def _read(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the brickworks' own ranges and levels.

    Errors follow a hyperbolic secant (Fisher 1921), the wider the weaker it is.
    """
    level = in_the_hall(rows, rng)
    wide = 0.0118 * np.sqrt(1 + 10 ** ((-88.0 - level) / 9))
    even = rng.uniform(0.002, 0.998, len(rows))
    error = scatter * wide * (2 / np.pi) * np.log(np.tan(0.5 * np.pi * even))
    symbols, noise = summed(rows, rng)
    level = level + rng.normal(0.0, 0.3, len(rows))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.3 - rng.rayleigh(0.9, len(rows)),
        noise_std=noise,
        preamble_count=symbols,
    )


def _with_all(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    turn = {name: AT_LAST.index(name) if name in AT_LAST else -1 for name in drawn.hidden}
    metres: dict[str, Floats] = {}
    for name in sorted(drawn.hidden, key=lambda one: (turn[one], one)):
        own = np.random.default_rng([seed, 1604, side, *name.encode()])
        upshot = EFFECTS[name](Push(table, seed, own, bool(drawn.rare)), drawn.strength)
        metres[name] = upshot.metres + np.zeros(len(table))
        table = _after(table, upshot)
    return table, np.array([metres[n] for n in drawn.hidden]).reshape(-1, len(table))


def _after(table: pd.DataFrame, upshot: Upshot) -> pd.DataFrame:
    """Return the table with what becomes of its rows; two thirds of all come by first paths.

    Of symbols that are not summed noise is less by their root.
    """
    rest = 10 * np.log10((2 * 10 ** (upshot.first_db / 10) + 1) / 3)
    error = table["error_m"] + upshot.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + upshot.whole_db + rest,
        first_path_power_dbm=table["first_path_power_dbm"] + upshot.whole_db + upshot.first_db,
        noise_std=table["noise_std"] * 10 ** (upshot.hiss_db / 20 + upshot.sums_db / 40),
        preamble_count=table["preamble_count"] * 10 ** (upshot.sums_db / 20),
    )
