"""Bars and wagons of an opera's stage, ranged from its galleries: ranges and levels.

numpy and pandas alone; what it can hide is in `opera_effects`, waveforms in `opera_waves`. House,
channel and line of sight are known. From two to seven cleats range a tag at each cue, and lose some
rounds of it.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.opera_effects import EFFECTS
from bench.challenge.families.opera_stage import (
    BARS,
    BARS_Y_M,
    BETWEEN,
    CLEATS,
    CLEATS_M,
    COURSE,
    DAY_S,
    LAWS,
    ON_GALLERIES,
    REVOLVE_M,
    STAGE_M,
    TAGS,
    Change,
    Cue,
    carried,
)

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Cue", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat([2, 3, 4, 5, 6, 7], [2, 4, 6, 6, 4, 1])
"""By how many cleats cues are heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 13), [12, 11, 11, 10, 10, 9, 9, 8, 8, 5, 4, 4])
"""How many rows links have."""
STILL = 5  # cues whose tag hangs or stands
ROUND_S, SLOT_S, LOST = 0.28, 0.019, 0.16  # of rounds; of cleats in these; of rounds, a share
SHARES, STEEL = {False: 0.19, True: 0.08}, {False: 0.16, True: 0.05}  # of links
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
    "haze-on-radomes": "haze_mg",
    "bars-ballasted": "ballast_kg",
    "revolve-castors-passed": "rim_m",
    "iron-curtain-lowered": "curtain_m",
    "velour-takes-up-damp": "damp_g",
    "follow-spot-near": "spot_m",
    "rosin-settles": "rosin_mg",
}
RARELY = ("blocked-path", "diffraction")
IN_THE_END = ("varas-from-one-cleat", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SUMS, GRAIN = 124.0, 5.8  # symbols that are summed; counts of noise for each root of one
OWN_DB: Floats = np.random.default_rng(1502).triangular(-1.6, 0.0, 1.6, CLEATS)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the opera's own."""
    rng = np.random.default_rng([seed, 1503])
    rows = picked(cues(rng, drawn.rare), drawn, near=True)
    clean = _told(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = picked(cues(rng, drawn.rare), drawn, near=False)
        rows = rows.assign(link="in the evening, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _told(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return cues(np.random.default_rng([seed, 1503]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _changed(clean, drawn, seed, 1)
    truth, _ = _changed(simulated, drawn, seed, 2)
    found, plain, other, true = (
        as_written(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def as_written(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without courses, and without obstacles unless they are listed."""
    dropped = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=[name for name in dropped if name in table])


def picked(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of more near links, or of more far ones.

    Links are kept from one end of the order by distance: all, then two of five, then one of five.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    place = np.arange(len(means))
    third, fifth = place * 3 // len(place), place % 5
    kept = (third == 0) | ((third == 1) & (fifth < 2)) | (fifth == 0)
    return rows[rows["link"].isin(means.index[kept])].reset_index(drop=True)


def cues(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    many = rng.permutation(HEARD_BY)
    sizes = np.split(rng.permutation(of_rows), np.cumsum(many)[:-1])
    begins_s = np.sort(rng.uniform(0.0, DAY_S, len(many)))
    still = rng.permutation(len(many)) < STILL
    parts = [_cue(rng, k, sizes[k], float(begins_s[k]), bool(still[k])) for k in range(len(many))]
    rows = pd.concat(parts, ignore_index=True).assign(channel=4, prf_mhz=16.0)
    rows["obstacles"] = _on_the_way(rng, rows, rare)
    return rows.assign(los=[not things for things in rows["obstacles"]])


def _cue(
    rng: np.random.Generator, number: int, sizes: Integers, begin_s: float, still: bool
) -> pd.DataFrame:
    """Return one cue, by time: cleats have slots, begin some rounds later and lose some."""
    who = int(rng.integers(BARS)) if rng.random() < 0.6 else int(rng.integers(BARS, len(TAGS)))
    slot = np.repeat(np.arange(len(sizes)), sizes)
    gaps = 1 + (rng.random(len(slot)) < LOST)
    begun = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    gaps[begun] = rng.integers(0, 4, len(sizes))
    whole = np.cumsum(gaps)
    rounds = whole - np.repeat(whole[begun] - gaps[begun], sizes)
    one = _bar(rng, who) if who < BARS else _wagon(rng)
    if still:
        one |= dict.fromkeys(("go_x", "go_y", "go_z", "turn_rad"), 0.0)
    since_s = ROUND_S * rounds + SLOT_S * slot + rng.uniform(0.0, 0.004, len(slot))
    order = np.argsort(since_s)
    slot, since_s = slot[order], since_s[order]
    into_s = rng.uniform(0.0, 0.5) * one["lasts_s"] + since_s
    course = {name: np.full(len(slot), value) for name, value in one.items()} | {"into_s": into_s}
    there = carried(course, into_s)
    cleat = _hear(rng, there.mean(axis=0), len(sizes))[slot]
    apart = CLEATS_M[cleat] - there
    looks = rng.choice([0.5, 1.5]) * np.pi if who < BARS else _ahead(there, course)
    places = {f"tx_{axis}_m": there[:, k] for k, axis in enumerate("xyz")}
    places |= {f"rx_{axis}_m": CLEATS_M[cleat, k] for k, axis in enumerate("xyz")}
    places |= {f"room_{axis}_m": np.full(len(slot), STAGE_M[k]) for k, axis in enumerate("xyz")}
    return pd.DataFrame(course | places | _logged(rng, there, begin_s)).assign(
        tx=TAGS[who],
        rx=[f"cleat{one}" for one in cleat],
        link=[f"cue {number} by cleat{one}" for one in cleat],
        environment="flies" if there[:, 2].mean() > 8.0 else "deck",
        true_range_m=np.linalg.norm(apart, axis=1),
        azimuth_deg=np.degrees(np.arctan2(apart[:, 1], apart[:, 0]) - looks) % 360.0,
        time_s=begin_s + since_s,
    )


def _bar(rng: np.random.Generator, who: int) -> dict[str, float]:
    """Return the course of a bar: down or up, at most at 0.6 m/s to 1.8 m/s."""
    lasts_s = rng.uniform(4.5, 10.0)
    rise_m = 0.5 * lasts_s * rng.uniform(0.6, 1.8)
    low_m = rng.uniform(1.2, 24.0 - rise_m)
    up = rng.random() < 0.5
    made = dict.fromkeys(COURSE, 0.0) | {"lasts_s": lasts_s, "from_x": rng.uniform(4.0, 24.0)}
    made |= {"from_y": float(BARS_Y_M[who]), "go_z": rise_m if up else -rise_m}
    return made | {"from_z": low_m if up else low_m + rise_m}


def _wagon(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a wagon: round with the revolve, or aside; at most 0.4 to 1.4 m/s."""
    lasts_s, sense = rng.uniform(5.0, 11.0), float(rng.choice([-1.0, 1.0]))
    long_m = 0.5 * lasts_s * rng.uniform(0.4, 1.4)
    made = dict.fromkeys(COURSE, 0.0) | {"lasts_s": lasts_s, "from_z": rng.uniform(0.3, 1.2)}
    if rng.random() < 0.55:
        arm_m = rng.uniform(2.6, 7.2)
        made |= {"from_x": float(REVOLVE_M[0]), "from_y": float(REVOLVE_M[1]), "arm_m": arm_m}
        return made | {"from_rad": rng.uniform(0, 2 * np.pi), "turn_rad": sense * long_m / arm_m}
    middle_m = rng.uniform(1.5 + long_m / 2, STAGE_M[0] - 1.5 - long_m / 2)
    made |= {"from_x": middle_m - sense * long_m / 2, "go_x": sense * long_m}
    return made | {"from_y": rng.uniform(2.5, 18.5)}


def _ahead(there: Floats, course: dict[str, Floats]) -> Floats:
    """Return which way wagons look, in radians [n]: outward on the revolve, else to the house."""
    out = np.arctan2(*(there[:, :2] - REVOLVE_M).T[::-1])
    return np.where(course["arm_m"] > 0, out, -np.pi / 2)


def _hear(rng: np.random.Generator, middle: Floats, count: int) -> Integers:
    """Return which cleats range a tag [count]: by lots, in which near ones do better."""
    far = np.linalg.norm(CLEATS_M - middle, axis=1)
    return np.asarray(np.argsort(far + rng.gumbel(0.0, 8.0, CLEATS))[:count], np.int64)


def _logged(rng: np.random.Generator, there: Floats, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: it is warm where lamps have been on, and high up."""
    size, hour = len(there), begin_s / 3600.0
    house_c = 18.5 + 8.5 * (1 - np.exp(-hour / 3.0)) + rng.normal(0.0, 2.4)
    return {
        "temperature_c": house_c + 0.22 * there[:, 2] + rng.normal(0.0, 1.1, size),
        "reply_time_s": 0.004 + 0.052 * rng.beta(1.2, 1.9, size),
        "haze_mg": rng.exponential(2.4) + rng.exponential(2.4, size),
        "ballast_kg": np.clip(rng.uniform(20.0, 400.0) + rng.normal(0.0, 55.0, size), 5.0, 450.0),
        "rim_m": rng.uniform(0.0, 40.0) + np.cumsum(rng.uniform(0.1, 0.9, size)),
        "curtain_m": np.clip(rng.uniform(0.0, 8.0) + rng.normal(0.0, 1.3, size), 0.0, 8.0),
        "damp_g": np.clip(rng.uniform(4.0, 13.0) + rng.normal(0.0, 1.2, size), 2.5, 15.0),
        "spot_m": 1.2 + rng.weibull(1.2) * 2.7 + rng.weibull(1.1, size) * 1.4,
        "rosin_mg": rng.weibull(1.3) * 12.0 + rng.weibull(1.2, size) * 6.0,
    }


def _on_the_way(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight paths go through: steel portals by lot, else what is upright or lies.

    Flats and rostra are met by ways up or down stage, parapets by steep ways from galleries.
    """
    cue = Cue(rows, 0, rng)
    first = np.unique(cue.link, return_index=True)[1]
    lean = np.abs(cue.at - cue.post)[first] / cue.way[first, None]
    odds = SHARES[rare in RARELY] * np.ones((len(first), len(BETWEEN)))
    odds[:, :2] *= np.where(lean[:, 1] > 0.25, 1.0, 0.3)[:, None]
    odds[:, 2] *= (lean[:, 2] > 0.3) * (cue.cleat[first] < ON_GALLERIES) * 1.3
    met = rng.random(odds.shape) < odds
    lot = rng.permutation(len(first)) + 1000 * (cue.at[first, 2] > 20.0)  # portals end below
    steel = np.argsort(np.argsort(lot)) < round(STEEL[rare == "diffraction"] * len(first))
    per_link = [
        ["metal"] if steel[k] else [kind for kind, one in zip(BETWEEN, met[k], strict=True) if one]
        for k in range(len(first))
    ]
    return [per_link[one] for one in cue.link]


def on_stage(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: as in a high house, cleats that differ, ropes by links."""
    cue = Cue(rows, 0, rng)
    ropes = cue.by_link(lambda n: 0.7 - rng.gamma(2.2, 0.6, n))
    return np.asarray(-59.7 - 18.3 * np.log10(cue.way) + OWN_DB[cue.cleat] + ropes, np.float64)


def summed(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each."""
    symbols = SUMS - rng.binomial(12, 0.14, len(rows)).astype(np.float64)
    own = 1 + 0.025 * OWN_DB[Cue(rows, 0, rng).cleat]
    noise = GRAIN * np.sqrt(symbols) * own * np.exp(rng.normal(0.0, 0.034, len(rows)))
    return symbols, np.asarray(noise, np.float64)


def _told(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the opera's own ranges and levels: a logistic law, wider where weak."""
    level = on_stage(rows, rng)
    wide = 0.0069 * (1 + 10 ** ((-89.0 - level) / 12))
    error = scatter * wide * rng.logistic(size=len(rows))
    symbols, noise = summed(rows, rng)
    level = level + rng.normal(0.0, 0.28, len(rows))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.25 - rng.gamma(2.4, 0.5, len(rows)),
        noise_std=noise,
        preamble_count=symbols,
    )


def _changed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    late = {name: 1 + place for place, name in enumerate(IN_THE_END)}
    metres: dict[str, Floats] = {}
    for name in sorted(drawn.hidden, key=lambda one: (late.get(one, 0), one)):
        own = np.random.default_rng([seed, 1504, side, *name.encode()])
        change = EFFECTS[name](Cue(table, seed, own, bool(drawn.rare)), drawn.strength)
        metres[name] = change.metres + np.zeros(len(table))
        table = _with(table, change)
    rows = [metres[name] for name in drawn.hidden]
    return table, np.array(rows, np.float64).reshape(len(rows), len(table))


def _with(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    """Return the table with what becomes of its rows; six tenths of all come by first paths."""
    everything, first = np.asarray(change.all_db), np.asarray(change.first_db)
    left = 10 * np.log10(0.6 * 10 ** (first / 10) + 0.4)
    error = table["error_m"] + change.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + everything + left,
        first_path_power_dbm=table["first_path_power_dbm"] + everything + first,
        noise_std=table["noise_std"] * 10 ** (np.asarray(change.hiss_db) / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(change.sums_db) / 20),
    )
