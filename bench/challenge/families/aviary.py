"""Storks, ibises and keepers of an aviary, ranged from its nestboxes: ranges and levels.

numpy and pandas alone; what it can hide is in `aviary_effects`, waveforms in `aviary_waves`. The
channel is known; neither a room nor line of sight is. From three to six nestboxes range a tag at
each watch, each whenever the air is free.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.aviary_effects import EFFECTS
from bench.challenge.families.aviary_faults import LEVEL_DB, lost_db
from bench.challenge.families.aviary_grounds import (
    BETWEEN,
    COURSE,
    DAY_S,
    DEEP_M,
    IBISES,
    LAWS,
    NESTBOXES,
    NESTBOXES_M,
    POND_M,
    STORKS,
    TAGS,
    WIDE_M,
    ZONES,
    Change,
    Watch,
    flown,
)
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Change", "Watch", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 7), [8, 7, 6, 4])
"""By how many nestboxes watches are ranged."""
OF_ROWS: Integers = np.repeat(np.arange(1, 12), [13, 14, 13, 12, 11, 10, 9, 8, 7, 6, 3])
"""How many rows links have."""
PERCHED = 6  # watches whose tag rests
ASKS_S, BUSY_S = 0.21, 0.12  # from one range of a link to the next: at least, and mean of the rest
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
    "droppings-on-lids": "droppings_g",
    "visitors-close-by": "visitors_m",
    "plumage-soaked": "rain_mm",
    "hoppers-full": "seed_kg",
    "powder-down-settles": "down_g",
    "wheel-paddles-pass": "rim_m",
    "winter-curtain-down": "curtain_pct",
    "masts-lean-downwind": "wind_ms",
}
RARELY = ("blocked-path", "diffraction")
LAST = ("gaz-from-one-nestbox", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 494.0, 4.2  # counted; counts of noise for each root of one
OWN_DB: Floats = np.random.default_rng(2101).uniform(-1.6, 1.6, NESTBOXES)
MEASURED = (
    "error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count"
)  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the aviary's own."""
    rng = np.random.default_rng([seed, 2102])
    clean = _ranged(sorted_out(watches(rng, drawn.rare), drawn, True), rng, drawn.scatter)
    rows = clean.drop(columns=list(MEASURED))
    if not drawn.paired:
        rows = elsewhere(watches(rng, drawn.rare), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return watches(np.random.default_rng([seed, 2102]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _with_effects(clean, drawn, seed, 1)
    truth, _ = _with_effects(simulated, drawn, seed, 2)
    found, plain, other, true = (
        as_told(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def as_told(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is told: no courses, and obstacles only if they are listed."""
    untold = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=untold, errors="ignore")


def elsewhere(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other watches, whose links are none of the recorded ones."""
    found = sorted_out(rows, drawn, False)
    return found.assign(link="another day, " + found["link"])


def sorted_out(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of the nearer half of links, or farther.

    And every fifth link of the other half.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    half = len(means) // 2
    stays = [*means.index[:half], *means.index[half::5]]
    return rows[rows["link"].isin(stays)].reset_index(drop=True)


def watches(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    boxes, sizes = rng.permutation(HEARD_BY), rng.permutation(of_rows)
    begins_s = np.sort(rng.uniform(0.0, DAY_S, len(boxes)))
    rests = rng.permutation(len(boxes)) < PERCHED
    lots = np.split(sizes, np.cumsum(boxes)[:-1])
    every = [
        _watch(rng, number, lot, float(begins_s[number]), bool(rests[number]))
        for number, lot in enumerate(lots)
    ]
    rows = pd.concat(every, ignore_index=True).assign(channel=3, prf_mhz=16.0)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows


def _watch(
    rng: np.random.Generator, number: int, sizes: Integers, begin_s: float, rests: bool
) -> pd.DataFrame:
    """Return the rows of one watch, by time."""
    who = int(rng.integers(len(TAGS)))
    asked = [_asked(rng, int(size)) for size in sizes]
    which = np.repeat(np.arange(len(sizes)), sizes)
    order = np.argsort(np.concatenate(asked), kind="stable")
    since_s, which = np.concatenate(asked)[order], which[order]
    one = _course(rng, who) | {"goes": 0.0 if rests else 1.0}
    course = {name: np.full(len(which), one[name]) for name in COURSE}
    course["into_s"] = rng.uniform(0.04, 0.4) * one["lasts_s"] + since_s
    there = flown(course, course["into_s"])
    box = _nestboxes(rng, there, len(sizes))[which]
    ends = np.concatenate([there, NESTBOXES_M[box]], axis=1)
    names = [f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"]
    seen = {"azimuth_deg": _azimuth(rng, course, NESTBOXES_M[box]), "time_s": begin_s + since_s}
    return pd.DataFrame(
        course | dict(zip(names, ends.T, strict=True)) | _logged(rng, there, begin_s) | seen
    ).assign(
        tx=TAGS[who],
        rx=[f"nestbox{k}" for k in box],
        link=[f"watch {number} at nestbox{k}" for k in box],
        environment=ZONES[int(one["kind"])],
        true_range_m=np.sqrt(((ends[:, :3] - ends[:, 3:]) ** 2).sum(axis=1)),
    )


def _asked(rng: np.random.Generator, size: int) -> Floats:
    """Return when a nestbox has ranges [size], in s: once it is its turn and the air is free."""
    return np.asarray(rng.uniform(0.0, 0.4) + np.cumsum(ASKS_S + rng.exponential(BUSY_S, size)))


def _course(rng: np.random.Generator, who: int) -> dict[str, float]:
    """Return the course of a tag: storks and ibises at up to 6 m/s, keepers at 1.4."""
    made = dict.fromkeys(COURSE, 0.0) | {"lasts_s": rng.uniform(6.0, 10.0)}
    made["heads"] = rng.uniform(0.0, 2 * np.pi)
    if who < STORKS:
        radius = rng.uniform(4.5, 8.5)
        turns = rng.choice([-1.0, 1.0]) * rng.uniform(3.0, 5.5) * made["lasts_s"] / radius
        made |= {"at_x": rng.uniform(11.0, WIDE_M - 11.0), "at_y": rng.uniform(11.0, DEEP_M - 11.0)}
        made |= {"at_z": rng.uniform(4.5, 9.0), "reach_m": radius, "wheel": float(turns)}
        return made | {"climb_m": rng.uniform(-0.15, 0.45) * made["lasts_s"]}
    if who < STORKS + IBISES:
        made |= {"kind": 1.0, "at_z": rng.uniform(2.5, 6.0), "wheel": rng.uniform(0.8, 3.6)}
        made |= {"climb_m": rng.uniform(-2.0, 2.0)}
        return made | _within(rng, made["heads"], rng.uniform(1.4, 2.9) * made["lasts_s"])
    made |= {"kind": 2.0, "at_z": rng.uniform(0.9, 1.5), "wheel": rng.normal(0.0, 0.5)}
    return made | _within(rng, made["heads"], 1.3 * rng.uniform(0.6, 1.1) * made["lasts_s"])


def _within(rng: np.random.Generator, heads: float, reach_m: float) -> dict[str, float]:
    """Return whence a straight way of such a length stays in the aviary, if need be turned."""
    size = np.array([WIDE_M, DEEP_M])
    while True:
        way = reach_m * np.array([np.cos(heads), np.sin(heads)])
        at = rng.uniform(2.5, size - 2.5)
        if ((at + way > 2.5) & (at + way < size - 2.5)).all():
            return {"at_x": at[0], "at_y": at[1], "heads": heads, "reach_m": reach_m}
        heads = rng.uniform(0.0, 2 * np.pi)


def _azimuth(rng: np.random.Generator, course: dict[str, Floats], hung: Floats) -> Floats:
    """Return where nestboxes are from the way that tags face, as collars sit, in degrees [n]."""
    here = flown(course, course["into_s"])
    ahead = flown(course, course["into_s"] + 0.03) - here
    faces = np.arctan2(ahead[:, 1], ahead[:, 0]) + rng.choice(np.arange(12)) * np.pi / 6
    to = hung - here
    return np.asarray(np.degrees(np.arctan2(to[:, 1], to[:, 0]) - faces) % 360.0)


def _nestboxes(rng: np.random.Generator, there: Floats, count: int) -> Integers:
    """Return which nestboxes range a tag [count]: the nearer, the likelier."""
    far = np.sqrt(((NESTBOXES_M - there.mean(axis=0)) ** 2).sum(axis=1))
    odds = 1 / (far + 4.0) ** 1.8
    return rng.choice(NESTBOXES, count, replace=False, p=odds / odds.sum()).astype(np.int64)


def _logged(rng: np.random.Generator, there: Floats, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: a day warms up and cools, most where crowns give shade.

    It is dampest beside the pond.
    """
    n, hours = len(there), begin_s / 3600
    noon_c = 8.0 + 15.0 * np.sin(np.pi * (hours + 1.2) / 12.5) ** 2 + rng.normal(0.0, 2.6)
    pond_m = np.hypot(there[:, 0] - POND_M[0], there[:, 1] - POND_M[1])
    damp = 46.0 + rng.normal(0.0, 8.0) + 17.0 * np.exp(-pond_m / 12.0)
    return {
        "temperature_c": noon_c + 4.5 * np.tanh(there[:, 2] / 8.0) + rng.normal(0.0, 1.3, n),
        "reply_time_s": 0.0035 + 0.055 * rng.beta(1.5, 2.6, n),
        "humidity_pct": np.clip(damp + rng.normal(0.0, 3.0, n), 25.0, 96.0),
        "droppings_g": rng.gamma(1.6, 5.0) + rng.gamma(1.5, 3.5, n),
        "visitors_m": np.clip(rng.uniform(1.2, 8.0) + rng.normal(0.0, 0.5, n), 0.9, 10.0),
        "rain_mm": np.clip(rng.uniform(0.0, 3.6) + rng.normal(0.0, 0.35, n), 0.0, 4.4),
        "seed_kg": np.clip(rng.uniform(1.0, 29.0) + rng.normal(0.0, 3.0, n), 0.5, 34.0),
        "down_g": 11.0 * rng.beta(1.1, 1.7) + rng.weibull(1.3, n) * 3.2,
        "rim_m": rng.uniform(0.0, 90.0) + np.cumsum(rng.gamma(2.2, 0.16, n)),
        "curtain_pct": np.clip(100 * rng.beta(0.7, 0.7) + rng.normal(0.0, 14.0, n), 0.0, 100.0),
        "wind_ms": np.clip(rng.uniform(0.5, 7.5) + rng.normal(0.0, 0.9, n), 0.0, 9.5),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through, as links have it.

    Crowns where ways are amid the grove; shutters of feed stores, of steel, by lot; else trunks,
    piers of rock and panes, each the likelier where it is.
    """
    watch = Watch(rows, 0, rng)
    seldom = 0.42 if rare in RARELY else 1.0
    low = np.exp(-np.minimum(watch.there[:, 2], watch.hung[:, 2]) / 3.2)
    wet = {
        "foliage": 0.8 * (watch.amid_m > 1.2),
        "wood": 0.34 * low,
        "brick": 0.07 + 0.16 * (watch.hung[:, 1] > DEEP_M - 1.0),
        "glass": 0.04 + 0.24 * (watch.hung[:, 0] < 1.0),
    }
    lots = {kind: watch.by_link(lambda n: rng.random(n)) for kind in BETWEEN}
    first = pd.Series(watch.link).groupby(watch.link).transform(lambda one: one.index[0]).to_numpy()
    met = {kind: (lots[kind] < seldom * odds)[first] for kind, odds in wet.items()}
    steel = watch.by_link(lambda n: rng.permutation(n) < round((0.05 if rare else 0.16) * n))
    return [
        ["metal"] if steel[k] else [kind for kind in BETWEEN if met[kind][k]]
        for k in range(len(rows))
    ]


def in_the_open(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: by distances, by listeners that differ, with fades of links."""
    watch = Watch(rows, 0, rng)
    fades = watch.by_link(lambda n: 1.2 - 1.5 * rng.weibull(1.35, n).clip(max=3.0))
    return LEVEL_DB[0] - lost_db(watch.far) + OWN_DB[watch.box] + fades


def counted(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    symbols = SYMBOLS - rng.negative_binomial(2, 0.24, len(rows)).clip(max=28)
    own = 1 + 0.02 * OWN_DB[Watch(rows, 0, rng).box]
    return symbols, GRAIN * np.sqrt(symbols) * own * np.exp(0.03 * rng.normal(size=len(rows)))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the aviary's own ranges and levels.

    Errors are seldom early and more often late: logarithms of a gamma draw, less their mean and by
    their scatter; wider where it is weak. Links keep a little of their own.
    """
    level, size = in_the_open(rows, rng), len(rows)
    wide = 0.0165 * np.sqrt(1 + 10 ** ((-87.0 - level) / 10))
    late = (0.92278434 - np.log(rng.gamma(3.0, 1.0, size))) / np.sqrt(0.39493407)
    kept = Watch(rows, 0, rng).by_link(lambda n: rng.logistic(0.0, 0.0042, n))
    error = scatter * (wide * late + kept)
    symbols, noise = counted(rows, rng)
    level = level + rng.standard_t(6, size) * 0.2
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - rng.gamma(2.4, 0.7, size).clip(max=8.0),
        noise_std=noise,
        preamble_count=symbols,
    )


def _with_effects(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added = {name: np.zeros(len(table)) for name in drawn.hidden}
    for name in sorted(
        drawn.hidden, key=lambda one: (LAST.index(one) + 1 if one in LAST else 0, one)
    ):
        own = np.random.default_rng([seed, 2103, side, *name.encode()])
        change = EFFECTS[name](Watch(table, seed, own, bool(drawn.rare)), drawn.strength)
        added[name] = added[name] + change.metres
        table = _changed(table, change)
    return table, np.stack(list(added.values())) if added else np.zeros((0, len(table)))


def _changed(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    """Return the table with what becomes of its rows; first paths are 0.58 of all that comes.

    Noise is less by the root of symbols that are not counted.
    """
    early = 10 * np.log10(1 - 0.58 * (1 - 10 ** (np.asarray(change.first_db) / 10)))
    error = table["error_m"] + change.metres
    noise = 10 ** ((np.asarray(change.noise_db) + 0.5 * np.asarray(change.count_db)) / 20)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + change.all_db + early,
        first_path_power_dbm=table["first_path_power_dbm"] + change.all_db + change.first_db,
        noise_std=table["noise_std"] * noise,
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(change.count_db) / 20),
    )
