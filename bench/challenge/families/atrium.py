"""Lifts and robots of a hotel's court, ranged from its balconies: ranges and levels.

numpy and pandas alone; what it can hide is in `atrium_effects`, waveforms in `atrium_waves`. Court
and channel are known, line of sight is not. Four balconies range each who rides or rolls.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.atrium_effects import EFFECTS
from bench.challenge.families.atrium_well import (
    BALCONIES,
    BALCONIES_M,
    BETWEEN,
    CARS,
    COURT_M,
    DAY_S,
    LAWS,
    LID_M,
    NAMES,
    RIDE,
    ROOF_M,
    STOREY_M,
    STOREYS,
    WELLS_M,
    Ride,
    Upset,
    whereabouts,
)
from bench.challenge.families.case import Draw, Tables

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]
OF_ROWS: Numbers = np.repeat(np.arange(1, 10), [12, 11, 11, 11, 11, 11, 11, 11, 11])
"""How many rows links have."""
HEARD, RESTING = 4, 6  # balconies of a ride; rides of which a tag rests
ROUND_S, UNEVEN_S, STEP_S = 0.28, 0.03, 0.019  # between rounds, how uneven, between balconies
OFTEN, IRON = {False: 0.14, True: 0.03}, {False: 0.17, True: 0.05}  # shares of links
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "antenna-delay": "time_s",
    "time-lag": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "wax-on-covers": "wax_um",
    "cars-laden": "load_kg",
    "guide-rails-jointed": "shaft_m",
    "smoke-vents-open": "vent_deg",
    "steam-on-panes": "steam_g",
    "panes-tinted": "tint_percent",
    "fountain-plays-near": "spray_m",
}
RARELY = ("blocked-path", "diffraction")
LASTLY = ("snapped-to-landings", "toises-from-one-balcony", "range-rounding")  # in this order
MOST, HISS = 384, 3.3  # symbols added up; counts of noise for each root of one
UNLIKE_DB: Floats = np.random.default_rng(1302).normal(0.0, 0.8, BALCONIES)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the atrium's own."""
    rng = np.random.default_rng([1303, seed])
    rows = mixed(rides(rng, drawn.rare), drawn, near=True)
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = mixed(rides(rng, drawn.rare), drawn, near=False)
        rows = rows.assign(link=[f"next day, {one}" for one in rows["link"]])
    many = rows.iloc[np.tile(np.arange(len(rows)), drawn.ratio)].reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _ranged(many, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return rides(np.random.default_rng([1303, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    upset, metres = _upset(clean, drawn, seed, 1)
    truth, _ = _upset(simulated, drawn, seed, 2)
    kept = [shown(table, drawn.listed) for table in (upset, clean, simulated, truth)]
    return Tables(kept[0], kept[1], kept[2], kept[3], metres)


def shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without rides, and without what is between unless that is listed."""
    away = [*RIDE] + ([] if listed else ["obstacles"])
    return table[[name for name in table.columns if name not in away]]


def mixed(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows, or where mixes are to differ those of more near links, or of more far ones.

    Of the nearer, or the farther, seven of twelve all; of the rest every sixth.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near, kind="stable")
    place = np.arange(len(far))
    stays = far.index[(place < 7 * len(far) // 12) | (place % 6 == 0)]
    return rows.loc[rows["link"].isin(stays)].reset_index(drop=True)


def rides(rng: np.random.Generator, rare: str, of_rows: Numbers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    sizes = rng.permutation(of_rows).reshape(-1, HEARD)
    count = len(sizes)
    begins_s = np.sort(rng.triangular(0.0, 0.4 * DAY_S, DAY_S, count))
    rests = rng.permutation(count) < RESTING
    parts = [_ride(rng, k, sizes[k], bool(rests[k])) for k in range(count)]
    for k, part in enumerate(parts):
        part["time_s"] = begins_s[k] + part["into_s"] - part["into_s"].min()
    table = pd.concat(parts, ignore_index=True).assign(channel=9, prf_mhz=64.0)
    table["obstacles"] = _between(rng, table, rare)
    return table


def _ride(rng: np.random.Generator, number: int, sizes: Numbers, rests: bool) -> pd.DataFrame:
    """Return one ride: balconies range a tag in rounds, and begin one or two rounds late."""
    who = int(rng.integers(CARS)) if rng.random() < 0.55 else int(rng.integers(CARS, len(NAMES)))
    order = np.repeat(np.arange(HEARD), sizes)
    first = rng.integers(0, 3, HEARD)
    rounds = np.concatenate([first[k] + np.arange(size) for k, size in enumerate(sizes)])
    begun_s = np.cumsum(ROUND_S + UNEVEN_S * rng.uniform(-1.0, 1.0, 16))
    way = _from_rest_to_rest(rng, who, rests)
    frame = pd.DataFrame(way, index=range(len(order)))
    frame["into_s"] = rng.uniform(0.0, way["lasts_s"] / 3) + begun_s[rounds] + STEP_S * order
    tag = whereabouts({name: frame[name].to_numpy(np.float64) for name in RIDE}, _col(frame))
    balcony = _hear(rng, tag.mean(axis=0))[order]
    frame[["tx_x_m", "tx_y_m", "tx_z_m"]] = tag
    frame[["rx_x_m", "rx_y_m", "rx_z_m"]] = BALCONIES_M[balcony]
    line = BALCONIES_M[balcony] - tag
    ahead = rng.normal(np.arctan2(way["way_y"], way["way_x"]), 0.3 if who >= CARS else 2.0)
    return frame.assign(
        tx=NAMES[who],
        rx=[f"balcony{one}" for one in balcony],
        link=[f"ride {number}, balcony {one}" for one in balcony],
        environment="wells" if who < CARS else "galleries",
        true_range_m=np.linalg.norm(line, axis=1),
        azimuth_deg=np.degrees(np.arctan2(line[:, 1], line[:, 0]) - ahead) % 360.0,
        shaft_m=rng.uniform(0.0, 40.0) + tag[:, 2],
        **{f"room_{axis}_m": COURT_M[k] for k, axis in enumerate("xyz")},
        **_logged(rng, len(order), float(tag[:, 2].mean())),
    )


def _col(frame: pd.DataFrame) -> Floats:
    return np.asarray(frame["into_s"], np.float64)


def _from_rest_to_rest(rng: np.random.Generator, who: int, rests: bool) -> dict[str, float]:
    """Return how a tag goes on a ride: a car by whole storeys, a robot some way over a floor."""
    if who < CARS:
        begin, end = rng.choice(STOREYS, 2, replace=False)
        here = np.array([*WELLS_M[who], ROOF_M + STOREY_M * begin])
        way = np.array([0.0, 0.0, STOREY_M * (end - begin)])
    else:
        floor, turn = int(rng.integers(STOREYS)), rng.uniform(-np.pi, np.pi)
        here = np.array([rng.uniform(5.0, 19.0), rng.uniform(4.0, 13.0), LID_M + STOREY_M * floor])
        if floor:  # along a gallery
            here[1], turn = rng.choice([1.6, 15.3]), rng.choice([0.0, np.pi])
        way = rng.uniform(2.5, 4.0) * np.array([np.cos(turn), np.sin(turn), 0.0])
    pace = rng.uniform(0.75, 1.5) if who < CARS else rng.uniform(0.7, 1.1)
    lasts_s = float(np.linalg.norm(way)) / pace
    made = {f"begin_{axis}": float(here[k]) for k, axis in enumerate("xyz")}
    made |= {f"way_{axis}": float(way[k]) * (not rests) for k, axis in enumerate("xyz")}
    weave = 0.0 if rests or who < CARS else rng.uniform(0.02, 0.1)
    return made | {"lasts_s": lasts_s, "weave_m": float(weave)}


def _hear(rng: np.random.Generator, tag: Floats) -> Numbers:
    """Return which balconies range a tag [HEARD]: by lots that far ones draw less often."""
    far = np.linalg.norm(BALCONIES_M - tag, axis=1)
    lots = rng.gumbel(0.0, 1.0, BALCONIES) - far / 12.0
    return np.asarray(np.argsort(lots)[-HEARD:], np.int64)


def _logged(rng: np.random.Generator, size: int, high_m: float) -> dict[str, Floats]:
    """Return what is logged for each row: it is warmer below glass."""
    warm = 18.0 + 0.55 * high_m + rng.normal(0.0, 2.8)
    return {
        "temperature_c": warm + rng.uniform(-1.2, 1.2, size),
        "reply_time_s": rng.lognormal(np.log(0.02), 0.6, size).clip(0.004, 0.07),
        "wax_um": rng.gamma(1.4, 6.0) + rng.gamma(1.0, 4.0, size),
        "load_kg": (rng.uniform(0.0, 560.0) + rng.normal(0.0, 60.0, size)).clip(0.0, 630.0),
        "vent_deg": (rng.uniform(0.0, 70.0) + rng.normal(0.0, 10.0, size)).clip(0.0, 75.0),
        "steam_g": rng.exponential(5.0) + rng.exponential(4.0, size),
        "tint_percent": (rng.uniform(2.0, 66.0) + rng.normal(0.0, 8.0, size)).clip(0.0, 72.0),
        "spray_m": 1.3 + rng.gamma(1.3, 2.2) * rng.uniform(0.6, 1.4, size),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through: frames of steel on some links, else what is built."""
    number, names = pd.factorize(rows["link"])
    share = OFTEN[rare in RARELY]
    some = [[kind for kind in BETWEEN if rng.random() < share] for _ in names]
    count = round(IRON[rare == "diffraction"] * len(names))
    for link in rng.choice(len(names), count, replace=False):
        some[link] = ["metal"]
    return [some[one] for one in number]


def across_the_court(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in the open, units that differ, plants and guests by links."""
    ride = Ride(rows, 0, rng)
    plants = ride.by_link(lambda n: 0.7 - rng.gamma(1.5, 0.7, n))
    return np.asarray(-64.2 - 18.5 * np.log10(ride.apart) + UNLIKE_DB[ride.balcony] + plants)


def added_up(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is told of noise in counts, [n] each."""
    symbols = np.asarray(MOST - rng.binomial(16, 0.2, len(rows)), np.float64)
    unlike = 10 ** (UNLIKE_DB[Ride(rows, 0, rng).balcony] / 50)
    return symbols, HISS * np.sqrt(symbols) * unlike * rng.normal(1.0, 0.034, len(rows))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the atrium's own ranges and levels.

    Ranges scatter by a logistic law, weak ones more.
    """
    level = across_the_court(rows, rng)
    wide = 0.0052 * (1 + np.exp((-88.0 - level) / 4.5))
    error = scatter * rng.logistic(0.0, 1.0, len(rows)) * wide
    level = level + rng.uniform(-0.6, 0.6, len(rows))
    symbols, noise = added_up(rows, rng)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.4 - rng.gamma(1.6, 0.6, len(rows)),
        noise_std=noise,
        preamble_count=symbols,
    )


def _upset(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    metres = np.zeros((len(drawn.hidden), len(table)))
    late = [name for name in LASTLY if name in drawn.hidden]
    for name in [*sorted({*drawn.hidden} - {*late}), *late]:
        own = np.random.default_rng([1304, seed, side, int.from_bytes(name.encode()[:24], "big")])
        upset = EFFECTS[name](Ride(table, seed, own, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = upset.metres
        table = _with(table, upset)
    return table, metres


def _with(table: pd.DataFrame, upset: Upset) -> pd.DataFrame:
    """Return the table with what upsets its rows."""
    error = table["error_m"] + upset.metres
    whole, first = np.asarray(upset.whole), np.asarray(upset.first)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + whole + 0.5 * first,
        first_path_power_dbm=table["first_path_power_dbm"] + whole + first,
        noise_std=table["noise_std"] * np.exp(np.asarray(upset.noise) * np.log(10) / 20),
        preamble_count=table["preamble_count"] * np.exp(np.asarray(upset.symbols) * 0.115129),
    )
