"""Horses and harrows in a riding hall, ranged from the letters of its arena: ranges and levels.

numpy and pandas alone; what it can hide is in `manege_effects`, waveforms in `manege_waves`. Hall
and channel are known, line of sight is not. From three to seven letters range each lesson.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.manege_effects import EFFECTS
from bench.challenge.families.manege_hall import (
    BETWEEN,
    DAY_S,
    FIGURE,
    HALL_M,
    HORSES,
    LAWS,
    LETTERS,
    LETTERS_M,
    TAGS,
    Lesson,
    Strain,
    ridden,
    velocity,
)

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Lesson", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat([3, 4, 5, 6, 7], [4, 5, 5, 4, 4])
"""By how many letters lessons are heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 11), [15, 13, 12, 11, 11, 10, 10, 9, 9, 9])
"""How many rows links have."""
HALTS = 5  # lessons of which a tag stands
ROUND_S, TURN_S = 0.24, 0.021  # from one round to the next, and from letter to letter
SHARES, STEEL = {False: 0.15, True: 0.035}, {False: 0.17, True: 0.055}  # of links
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
    "sweat-under-the-cloth": "sweat_g",
    "dust-raised": "dust_mg",
    "footing-watered": "moisture_percent",
    "kickboard-posts-passed": "boards_m",
    "sprinklers-on": "water_bar",
    "girth-tightened": "girth_n",
    "gate-of-tubes-near": "gate_m",
}
RARELY = ("blocked-path", "diffraction")
AT_LAST = ("paces-from-one-letter", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 252.0, 4.5  # symbols of a count; counts of noise for each root of one
UNEQUAL_DB: Floats = np.random.default_rng(1402).uniform(-1.1, 1.1, LETTERS)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the manege's own."""
    rng = np.random.default_rng([1403, seed])
    rows = chosen(lessons(rng, drawn.rare), drawn, near=True)
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = chosen(lessons(rng, drawn.rare), drawn, near=False)
        rows = rows.assign(link="in the afternoon, " + rows["link"])
    again = rows.loc[np.tile(rows.index, drawn.ratio)].reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return lessons(np.random.default_rng([1403, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _strained(clean, drawn, seed, 3)
    truth, _ = _strained(simulated, drawn, seed, 4)
    found, plain, other, true = (
        said(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def said(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without figures, and without obstacles unless they are listed."""
    kept = table.loc[:, [name not in FIGURE for name in table.columns]]
    return kept if listed else kept.drop(columns="obstacles")


def chosen(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of more near links, or of more far ones.

    All of the nearer half of links, or of the farther; a third of the next quarter, and of the
    last one a sixth.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    place = np.arange(len(far))
    every = np.select([place < len(far) / 2, place < 3 * len(far) / 4], [1, 3], 6)
    return rows[rows["link"].isin(far.index[place % every == 0])].reset_index(drop=True)


def lessons(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard = rng.permutation(HEARD_BY)
    sizes = np.split(rng.permutation(of_rows), np.cumsum(heard)[:-1])
    begins_s = np.sort(DAY_S * rng.beta(1.3, 1.1, len(heard)))
    stands = rng.permutation(len(heard)) < HALTS
    made = [
        _lesson(rng, k, own, float(begins_s[k]), bool(stands[k])) for k, own in enumerate(sizes)
    ]
    rows = pd.concat(made, ignore_index=True).assign(channel=1, prf_mhz=64.0)
    rows["obstacles"] = _things(rng, rows, rare)
    return rows


def _lesson(
    rng: np.random.Generator, number: int, sizes: Integers, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one lesson, by time: letters take turns, and some are heard some rounds later."""
    who = int(rng.integers(HORSES)) if rng.random() < 0.7 else int(rng.integers(HORSES, len(TAGS)))
    turn = np.repeat(np.arange(len(sizes)), sizes)
    late = rng.integers(0, 3, len(sizes))
    rounds = np.concatenate([late[k] + np.arange(size) for k, size in enumerate(sizes)])
    into_s = ROUND_S * rounds + TURN_S * turn + rng.uniform(0.0, 0.006, len(turn))
    order = np.argsort(into_s)
    turn, into_s = turn[order], into_s[order]
    figure = _figure(rng, who < HORSES, stands)
    way = {name: np.full(len(turn), value) for name, value in figure.items()} | {"into_s": into_s}
    there, fast = ridden(way, into_s), velocity(way, into_s)
    letter = _hear(rng, there.mean(axis=0), len(sizes))[turn]
    line = LETTERS_M[letter] - there
    looks = rng.uniform(-np.pi, np.pi) if stands else np.arctan2(fast[:, 1], fast[:, 0])
    places = {f"rx_{axis}_m": there[:, k] for k, axis in enumerate("xyz")}
    places |= {f"tx_{axis}_m": LETTERS_M[letter, k] for k, axis in enumerate("xyz")}
    places |= {f"room_{axis}_m": np.full(len(turn), HALL_M[k]) for k, axis in enumerate("xyz")}
    return pd.DataFrame(way | places | _logged(rng, into_s, begin_s, fast)).assign(
        tx=[f"letter{one}" for one in letter],
        rx=TAGS[who],
        link=[f"lesson {number} by letter{one}" for one in letter],
        environment="jumps" if there[:, 0].mean() > HALL_M[0] / 2 else "dressage",
        true_range_m=np.sqrt((line**2).sum(axis=1)),
        azimuth_deg=np.degrees(np.arctan2(line[:, 1], line[:, 0]) - looks) % 360.0,
        time_s=begin_s + into_s,
    )


def _figure(rng: np.random.Generator, horse: bool, stands: bool) -> dict[str, float]:
    """Return a figure: a circle, an eight or a serpentine; a lane that weaves of a harrow."""
    kind = str(rng.choice(["circle", "eight", "serpentine"])) if horse else "lane"
    speed, sense = rng.uniform(1.3, 3.6), float(rng.choice([-1.0, 1.0]))
    turn, wide = rng.uniform(0.0, 2 * np.pi), rng.uniform(3.5, 9.0)
    made = dict.fromkeys(FIGURE, 0.0) | {"turn_x": turn, "turn_y": turn, "twice": 1.0}
    if kind == "circle":
        made |= {"wide_x": wide, "wide_y": wide, "turn_y": turn + sense * np.pi / 2}
        made["pace"] = speed / wide
    elif kind == "eight":
        made |= {"wide_x": 1.3 * wide, "wide_y": 0.8 * wide, "twice": 2.0}
        made["pace"] = speed / (1.7 * wide)
    elif kind == "serpentine":
        made |= {"wide_y": 0.8 * wide, "goes_x": 0.7 * sense * speed}
        made["pace"] = 0.8 * speed / wide
    else:
        made |= {"wide_y": 0.3, "goes_x": sense * rng.uniform(0.9, 2.1), "pace": 0.9}
    aside = made["wide_y"] + 1.7
    made["mid_x"] = rng.uniform(14.5, 49.5)
    made["mid_y"] = rng.uniform(aside, HALL_M[1] - aside)
    made["mid_z"] = rng.uniform(1.5, 1.85) if horse else rng.uniform(0.85, 1.1)
    made |= {"nod_m": horse * rng.uniform(0.01, 0.04), "gait_hz": rng.uniform(0.8, 1.5)}
    made["turn_z"] = rng.uniform(0.0, 2 * np.pi)
    if stands:
        made |= dict.fromkeys(("pace", "goes_x", "nod_m"), 0.0)
    return made


def _hear(rng: np.random.Generator, there: Floats, count: int) -> Integers:
    """Return which letters range a tag [count]: without replacement, far ones less often."""
    far = np.sqrt(((LETTERS_M - there) ** 2).sum(axis=1))
    odds = np.exp(-far / 26.0)
    return np.asarray(rng.choice(LETTERS, count, replace=False, p=odds / odds.sum()), np.int64)


def _logged(
    rng: np.random.Generator, into_s: Floats, begin_s: float, fast: Floats
) -> dict[str, Floats]:
    """Return what is logged for each row: the hall is warmest at noon."""
    size = len(into_s)
    noon = 2.0 + 11.0 * np.sin(np.pi * begin_s / DAY_S) + rng.normal(0.0, 4.0)
    run = np.hypot(fast[:, 0], fast[:, 1]).mean() * into_s
    return {
        "temperature_c": noon + rng.normal(0.0, 0.9, size),
        "reply_time_s": 0.005 + 0.05 * rng.beta(1.1, 2.0, size),
        "sweat_g": rng.weibull(1.3) * 14.0 + rng.weibull(1.2, size) * 7.0,
        "dust_mg": rng.exponential(2.6) + rng.exponential(2.6, size),
        "moisture_percent": np.clip(rng.uniform(1.0, 30.0) + rng.normal(0.0, 5.0, size), 0.5, 36.0),
        "boards_m": rng.uniform(0.0, 30.0) + run + np.cumsum(rng.uniform(0.1, 0.7, size)),
        "water_bar": np.clip(rng.uniform(0.0, 6.0) + rng.normal(0.0, 1.1, size), 0.0, 7.0),
        "girth_n": np.clip(rng.uniform(30.0, 190.0) + rng.normal(0.0, 22.0, size), 10.0, 220.0),
        "gate_m": 1.1 + rng.weibull(1.2) * 2.9 + rng.weibull(1.1, size) * 1.3,
    }


def _things(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths cross: a trailer on some links, by lot; what else is about."""
    number, links = pd.factorize(rows["link"])
    horse = rows.groupby(number)["rx"].first().str.startswith("horse").to_numpy()
    lot = rng.random(len(links)) + 0.25 * ~horse  # harrows are low
    trailer = np.argsort(np.argsort(-lot)) < round(STEEL[rare == "diffraction"] * len(links))
    share = SHARES[rare in RARELY]
    per_link = [
        ["metal"] if hidden else [kind for kind in BETWEEN if rng.random() < share]
        for hidden in trailer
    ]
    return [per_link[one] for one in number]


def in_the_hall(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in a long hall, letters that differ, riders by links."""
    lesson = Lesson(rows, 0, rng)
    riders = lesson.per_link(lambda n: 0.6 - 1.5 * rng.weibull(1.3, n))
    return np.asarray(
        -59.6 - 18.7 * np.log10(lesson.reach) + UNEQUAL_DB[lesson.letter] + riders, np.float64
    )


def counted(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    symbols = SYMBOLS - rng.poisson(2.2, len(rows)).clip(max=9).astype(np.float64)
    own = 1 - 0.03 * UNEQUAL_DB[Lesson(rows, 0, rng).letter]
    return symbols, GRAIN * np.sqrt(symbols) * own * rng.gamma(900.0, 1 / 900.0, len(rows))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the manege's own ranges and levels: a bell, wider where it is weak."""
    level = in_the_hall(rows, rng)
    wide = 0.0105 * np.sqrt(1 + 10 ** ((-88.5 - level) / 10))
    error = scatter * wide * rng.normal(size=len(rows))
    symbols, noise = counted(rows, rng)
    level = level + rng.normal(0.0, 0.32, len(rows))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.35 - 1.1 * rng.weibull(1.6, len(rows)),
        noise_std=noise,
        preamble_count=symbols,
    )


def _strained(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    order = sorted(drawn.hidden, key=lambda name: (name in AT_LAST, name))
    metres = {}
    for name in order:
        own = np.random.default_rng([side, 1404, seed, *name.encode()])
        strain = EFFECTS[name](Lesson(table, seed, own, bool(drawn.rare)), drawn.strength)
        metres[name] = strain.metres + np.zeros(len(table))
        table = _under(table, strain)
    rows = [metres[name] for name in drawn.hidden]
    return table, np.reshape(rows, (len(rows), len(table))).astype(np.float64)


def _under(table: pd.DataFrame, strain: Strain) -> pd.DataFrame:
    """Return the table with what strains its rows; 55 % of all comes by first paths."""
    whole, first = np.asarray(strain.whole_db), np.asarray(strain.first_db)
    rest = 10 * np.log10(0.55 * 10 ** (first / 10) + 0.45)
    error = table["error_m"] + strain.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + whole + rest,
        first_path_power_dbm=table["first_path_power_dbm"] + whole + first,
        noise_std=table["noise_std"] * 10 ** (np.asarray(strain.noise_db) / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(strain.count_db) / 20),
    )
