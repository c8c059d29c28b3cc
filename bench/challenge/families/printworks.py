"""Trucks, grippers and reels of a printworks, ranged from its stanchions: ranges and levels.

numpy and pandas alone; what it can hide is in `printworks_effects`, waveforms in
`printworks_waves`. Hall and channel are known, line of sight is not. From three to six readers
range a tag at each run, each in a slot of its own of frames, some of which it leaves out.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.printworks_effects import EFFECTS
from bench.challenge.families.printworks_hall import (
    BETWEEN,
    COURSE,
    GRIPPERS,
    HALL_M,
    KINDS,
    LAWS,
    LOOP_M,
    NIGHT_S,
    PRESS_M,
    RIM_M,
    STANCHIONS,
    STANCHIONS_M,
    TAGS,
    TOWERS_M,
    TRUCKS,
    Change,
    Sheet,
    carried,
)

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Change", "Sheet", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
ASKED_BY: Integers = np.repeat(np.arange(3, 7), [7, 7, 6, 4])
"""By how many stanchions runs are ranged."""
OF_ROWS: Integers = np.repeat(np.arange(1, 13), [14, 13, 12, 12, 10, 10, 8, 8, 6, 4, 3, 3])
"""How many rows links have."""
STILL = 6  # runs whose tag stands, lies or hangs
FRAME_S, SLOT_S, HEARD = 0.31, 0.043, 0.74  # of frames: how long, of slots, how many are not left
TOWERED = {False: 0.17, True: 0.05}  # of links: behind a tower of steel, and where it is rare
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
    "noise-floor": "humidity_pct",
    "ink-mist-on-covers": "ink_mg",
    "webs-slack": "tension_n",
    "reels-unwound": "reel_cm",
    "spray-bars-on": "spray_lh",
    "folder-cuts": "web_m",
    "hood-lifted": "hood_pct",
    "covers-of-card-swell": "humidity_pct",
    "towers-shake": "copies_kh",
}
RARELY = ("blocked-path", "diffraction")
AT_LAST = ("ellen-from-one-stanchion", "range-rounding")
"""What becomes of ranges after all else, in this order."""
COUNTED, COARSE = 806.0, 3.15  # symbols; counts of noise for each root of one
OWN_DB: Floats = 0.75 * np.random.default_rng(1802).standard_t(7, STANCHIONS).clip(-2.2, 2.2)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the printworks' own."""
    rng = np.random.default_rng([seed, 1803])
    clean = _ranged(mixed(runs(rng, drawn.rare), drawn, True), rng, drawn.scatter)
    rows = clean.drop(columns=[*MEASURED])
    if not drawn.paired:
        rows = mixed(runs(rng, drawn.rare), drawn, False)
        rows = rows.assign(link="reprint, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return runs(np.random.default_rng([seed, 1803]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _changed(clean, drawn, seed, 1)
    truth, _ = _changed(simulated, drawn, seed, 2)
    found, plain, other, true = (
        written(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def written(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without courses, and without obstacles unless they are listed."""
    return table.drop(columns=[*COURSE, *([] if listed else ["obstacles"])])


MEASURED = (
    "error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count"
)  # fmt: skip
"""Columns that are not known before anything is measured."""


def mixed(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of more near links, or of more far ones.

    By how many links are nearer, of 100: of the first 35 all stay, then fewer and fewer.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean()
    place = means.rank(method="first", ascending=near) / len(means)
    every = np.ceil(1.0 + 9.0 * (place - 0.35).clip(lower=0.0))
    order = place.rank(method="first").astype(int)
    stays = order % every.astype(int) == 0
    return rows[rows["link"].map(stays)].reset_index(drop=True)


def runs(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a night."""
    asked, sizes = rng.permutation(ASKED_BY), rng.permutation(of_rows)
    begins_s = np.sort(NIGHT_S * rng.beta(1.1, 1.1, len(asked)))
    still = rng.choice(len(asked), STILL, replace=False)
    lots = np.split(sizes, np.cumsum(asked)[:-1])
    parts = [
        _run(rng, k, lot, float(begin_s), k in still)
        for k, (lot, begin_s) in enumerate(zip(lots, begins_s, strict=True))
    ]
    room = {f"room_{axis}_m": HALL_M[k] for k, axis in enumerate("xyz")}
    rows = pd.concat(parts, ignore_index=True).assign(channel=2, prf_mhz=64.0, **room)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows


def _run(
    rng: np.random.Generator, number: int, sizes: Integers, begin_s: float, still: bool
) -> pd.DataFrame:
    """Return the rows of one run, by time."""
    who = int(rng.integers(len(TAGS)))
    since_s = np.concatenate([_in_slots(rng, k, int(size)) for k, size in enumerate(sizes)])
    order = np.argsort(since_s)
    since_s, which = since_s[order], np.repeat(np.arange(len(sizes)), sizes)[order]
    one = _course(rng, who) | ({"long_m": 0.0} if still else {})
    course = {name: np.full(len(which), value) for name, value in one.items()}
    course["into_s"] = rng.uniform(0.05, 0.45) * one["lasts_s"] + since_s
    there = carried(course, course["into_s"])
    reader = _readers(rng, there, len(sizes))[which]
    ends = {"tx": there, "rx": STANCHIONS_M[reader]}
    places = {f"{end}_{axis}_m": p[:, k] for end, p in ends.items() for k, axis in enumerate("xyz")}
    return pd.DataFrame(course | places | _logged(rng, there, begin_s)).assign(
        tx=TAGS[who],
        rx=[f"stanchion{k}" for k in reader],
        link=[f"run {number} by stanchion{k}" for k in reader],
        environment=KINDS[int(one["kind"])],
        true_range_m=np.linalg.norm(there - ends["rx"], axis=1),
        azimuth_deg=_seen_at(rng, course, ends["rx"]),
        time_s=begin_s + since_s,
    )


def _in_slots(rng: np.random.Generator, slot: int, size: int) -> Floats:
    """Return when a reader has ranges [size], in s: in its slot of frames that it does not skip."""
    frames = rng.integers(2) + np.cumsum(rng.geometric(HEARD, size))
    return np.asarray(FRAME_S * frames + SLOT_S * slot)


def _course(rng: np.random.Generator, who: int) -> dict[str, float]:
    """Return the course of a tag, at 0.8 to 2.3 m/s at most."""
    made = dict.fromkeys(COURSE, 0.0) | {"lasts_s": rng.uniform(6.0, 10.0)}
    if who < TRUCKS:
        return made | _arc(rng, made["lasts_s"])
    if who < TRUCKS + GRIPPERS:
        fast = rng.uniform(0.8, 2.0)
        begun = rng.uniform(0.0, LOOP_M)
        return made | {"kind": 1.0, "aim": begun, "long_m": fast * made["lasts_s"]}
    aim = float(rng.choice([0.0, np.pi])) + rng.normal(0.0, 0.12)
    long_m = made["lasts_s"] * rng.uniform(0.4, 0.8)
    from_x = 26.0 - 0.5 * long_m * np.cos(aim) + rng.uniform(-14.0, 14.0)
    made |= {"from_x": from_x, "from_y": rng.uniform(19.0, 25.0), "from_z": RIM_M}
    return made | {"kind": 2.0, "aim": aim, "bend": rng.uniform(0, 2 * np.pi), "long_m": long_m}


def _arc(rng: np.random.Generator, lasts_s: float) -> dict[str, float]:
    """Return an arc that stays in one of the aisles on both sides of the press."""
    mean, step = rng.uniform(0.6, 1.4), np.linspace(0.0, 1.0, 9)
    while True:
        aisle = (1.5, PRESS_M[2] - 1.2) if rng.random() < 0.6 else (PRESS_M[3] + 1.2, 26.5)
        aim, bend = rng.choice([0.0, np.pi]) + rng.normal(0.0, 0.5), rng.normal(0.0, 0.09)
        from_x, from_y = rng.uniform(3.0, 49.0), rng.uniform(*aisle)
        turned = aim + bend * mean * lasts_s * step
        x, y = (mean * lasts_s * np.cumsum(f(turned)) / 9 for f in (np.cos, np.sin))
        if 2.0 < (from_x + x).min() <= (from_x + x).max() < 50.0 and (
            aisle[0] < (from_y + y).min() <= (from_y + y).max() < aisle[1]
        ):
            made = {"from_x": from_x, "from_y": from_y, "from_z": rng.uniform(0.5, 2.2)}
            return made | {"aim": float(aim), "bend": float(bend), "long_m": mean * lasts_s}


def _seen_at(rng: np.random.Generator, course: dict[str, Floats], hung: Floats) -> Floats:
    """Return where readers are from the way that tags go, turned as tags are, in degrees [n]."""
    now, soon = (carried(course, course["into_s"] + step) for step in (0.0, 0.02))
    goes, way = ((one @ np.array([1.0, 1.0j, 0.0])) for one in (soon - now, hung - now))
    turned = np.angle(way) - np.angle(goes) - 0.25 * np.pi * rng.integers(8)
    return np.asarray(np.degrees(turned) % 360.0)


def _readers(rng: np.random.Generator, there: Floats, count: int) -> Integers:
    """Return which stanchions range a tag [count]: the nearest ones of a few that listen."""
    far = np.linalg.norm(STANCHIONS_M - there.mean(axis=0), axis=1)
    listens = rng.choice(STANCHIONS, min(count + 4, STANCHIONS), replace=False)
    return rng.permutation(listens[np.argsort(far[listens])][:count])


def _logged(rng: np.random.Generator, there: Floats, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: a night warms up, and most beside towers."""
    n, hours = len(there), begin_s / 3600
    tower_m = np.abs(there[:, :1] - TOWERS_M).min(axis=1) + np.abs(there[:, 1] - 14.1)
    night_c = 15.5 + 11.0 * (1 - np.exp(-hours / 2.2)) + rng.normal(0.0, 2.2)
    humid = rng.uniform(29.0, 58.0)
    return {
        "temperature_c": night_c + 9.0 / (1 + (tower_m / 5.0) ** 2) + rng.normal(0.0, 1.4, n),
        "reply_time_s": 0.004 + rng.gamma(2.3, 0.0088, n).clip(max=0.066),
        "ink_mg": rng.weibull(1.5) * 9.0 + rng.weibull(1.4, n) * 5.5,
        "tension_n": np.clip(rng.uniform(120.0, 640.0) + rng.normal(0.0, 60.0, n), 80.0, 720.0),
        "reel_cm": np.clip(rng.uniform(15.0, 110.0) + rng.normal(0.0, 9.0, n), 10.0, 125.0),
        "spray_lh": np.clip(rng.uniform(0.5, 17.0) + rng.normal(0.0, 1.8, n), 0.2, 20.0),
        "web_m": rng.uniform(0.0, 60.0) + np.cumsum(rng.gamma(3.0, 0.09, n)),
        "hood_pct": np.clip(100 * rng.beta(0.8, 0.8) + rng.normal(0.0, 13.0, n), 0.0, 100.0),
        "humidity_pct": np.clip(humid + rng.normal(0.0, 3.2, n), 24.0, 66.0),
        "copies_kh": np.clip(rng.uniform(4.0, 40.0) + rng.normal(0.0, 3.0, n), 1.0, 44.0),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through: towers of steel by lot, else what stands there.

    Paper where ways are low, cladding of the press where they cross it, panes of its control room
    and pallets wherever these are.
    """
    sheet = Sheet(rows, 0, rng)
    first = np.unique(sheet.link, return_index=True)[1]
    low = np.minimum(sheet.there[first, 2] / sheet.hung[first, 2], 1.0)
    odds = {
        "paper": 0.42 * (1 - low),
        "plasterboard": 0.55 * (sheet.amid_m[first] > 0.8),
        "glass": np.where(sheet.far[first] > 9.0, 0.17, 0.06),
        "wood": np.where(sheet.there[first, 2] < 2.5, 0.13, 0.03),
    }
    odd = {kind: (0.45 if rare in RARELY else 1.0) * odds[kind] for kind in BETWEEN}
    met = {kind: rng.random(len(first)) < odd[kind] for kind in BETWEEN}
    towers = rng.permutation(len(first)) < round(TOWERED[rare == "diffraction"] * len(first))
    things = [
        ["metal"] if tower else [kind for kind in BETWEEN if met[kind][k]]
        for k, tower in enumerate(towers)
    ]
    return [list(things[k]) for k in sheet.link]


def in_the_hall(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as between towers, by readers that differ, with fades of links."""
    sheet = Sheet(rows, 0, rng)
    fades = sheet.by_link(lambda n: 0.9 - rng.gamma(2.2, 0.62, n).clip(max=3.4))
    return -58.6 - 18.4 * np.log10(sheet.far) - 0.03 * sheet.far + OWN_DB[sheet.reader] + fades


def counted(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    symbols = COUNTED - rng.geometric(0.18, len(rows)).clip(max=30).astype(np.float64)
    own = (1 - 0.015 * OWN_DB[Sheet(rows, 0, rng).reader]) * np.exp(rng.normal(0, 0.03, len(rows)))
    return symbols, np.asarray(COARSE * np.sqrt(symbols) * own, np.float64)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the printworks' own ranges and levels.

    Errors are of a bell whose variance is by chance itself (Madan and Seneta 1990), and larger
    where it is weak. Of all that comes a share by chance is of first paths.
    """
    level, size = in_the_hall(rows, rng), len(rows)
    wide = 0.0175 * np.sqrt(1 + 10 ** ((-86.0 - level) / 10))
    error = scatter * wide * rng.normal(size=size) * np.sqrt(rng.gamma(2.5, 0.4, size))
    symbols, noise = counted(rows, rng)
    level = level + rng.logistic(0.0, 0.16, size)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level + 10 * np.log10(rng.beta(6.0, 2.6, size).clip(0.12)),
        noise_std=noise,
        preamble_count=symbols,
    )


def _changed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    metres = np.zeros((len(drawn.hidden), len(table)))
    early = sorted({*drawn.hidden}.difference(AT_LAST))
    for name in (*early, *(one for one in AT_LAST if one in drawn.hidden)):
        own = np.random.default_rng([seed, 1804, side, *name.encode()])
        change = EFFECTS[name](Sheet(table, seed, own, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = change.metres
        table = _altered(table, change)
    return table, metres


def _altered(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    """Return the table with what becomes of its rows; 0.6 of all that comes is of first paths.

    Of symbols that are not counted noise is less by their root.
    """
    left = 10 * np.log10(0.6 * 10 ** (0.1 * np.asarray(change.first_db)) + 0.4)
    error = table["error_m"] + change.metres
    grown = 10 ** (np.asarray(change.noise_db) / 20 + np.asarray(change.count_db) / 40)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + change.all_db + left,
        first_path_power_dbm=table["first_path_power_dbm"] + change.all_db + change.first_db,
        noise_std=table["noise_std"] * grown,
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(change.count_db) / 20),
    )
