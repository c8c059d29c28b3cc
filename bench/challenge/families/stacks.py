"""Carts that are pushed between mobile shelves of an archive, ranged from readers: ranges, levels.

numpy and pandas alone; what it can hide is in `stacks_effects`, its waveforms in `stacks_waves`.
The room and the channel are known. Books weaken what crosses them; of eight polls in a row a link
answers some, one at least.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.stacks_effects import EFFECTS
from bench.challenge.families.stacks_plan import (
    CARRIAGE_M,
    CARTS,
    CORRIDOR_M,
    GAIT,
    LAWS,
    READERS_M,
    ROOM_M,
    SLABS,
    Entry,
    Files,
)

Floats = NDArray[np.float64]
VISITS, POLLS, POLL_S, TURN_S = 16, 8, 0.42, 0.021
ANSWERED = 0.44  # of the polls after the first, in the mean
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
    "paper-swells": "humidity_percent",
    "boxes-returned": "boxes",
    "air-handler": "time_s",
    "reading-lights": "lux",
    "dust-settles": "days_undusted",
    "rails-laden": "tonnes",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
ON_PAPER = ("half-metres-from-one-reader", "range-rounding")
A_FEW = 0.065


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the archive's own."""
    rng = np.random.default_rng([791, seed])
    rows = fetched(visits(rng, drawn.rare), "all" if drawn.same_mix else "near")
    clean = _polled(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = fetched(visits(rng, drawn.rare), "all" if drawn.same_mix else "far")
        rows = rows.assign(link="as planned, " + rows["link"])
    runs = pd.concat(drawn.ratio * [rows], ignore_index=True)
    return hidden_in(drawn, seed, clean, _polled(runs, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return visits(np.random.default_rng([791, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, shifts = _entered(clean, drawn, seed, np.random.default_rng([793, 0, seed]))
    truth, _ = _entered(simulated, drawn, seed, np.random.default_rng([793, 1, seed]))
    four = (found, clean, simulated, truth)
    shown, plain, model, true = (lent(table, drawn.listed) for table in four)
    return Tables(shown, plain, model, true, shifts)


def lent(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how carts are pushed, and what stands between unless listed."""
    hidden = {*GAIT} if listed else {*GAIT, "obstacles"}
    return table.loc[:, [name not in hidden for name in table.columns]].copy()


def visits(rng: np.random.Generator, rare: str, answered: float = ANSWERED) -> pd.DataFrame:
    """Return what is known of the rows of a day: visits, some of carts that are left to stand."""
    order = rng.permutation(VISITS)
    left = set(order[: VISITS - 2 if rare == "exchange-motion" else 5].tolist())
    begins = np.sort(rng.uniform(0, 8 * 3600, VISITS))
    every = [_visit(rng, n, begins[n], n in left) for n in range(VISITS)]
    table = pd.concat(every, ignore_index=True)
    table = table[_answers(rng, answered)].reset_index(drop=True)
    size = len(table)
    table["reply_time_s"] = 0.005 + np.minimum(rng.exponential(0.034, size), 0.12)
    table["boxes"] = np.floor(rng.gamma(1.3, 24.0, size))
    table["lux"] = rng.lognormal(5.4, 0.5, size)
    table["tonnes"] = rng.uniform(1.0, 27.0, size)
    table["obstacles"] = _shut(rng, table["link"], A_FEW if rare == "diffraction" else 0.17)
    return table


def fetched(rows: pd.DataFrame, which: str) -> pd.DataFrame:
    """Return all rows, or those of links that are mostly `near` or mostly `far`."""
    if which == "all":
        return rows.copy()
    mean = rows["true_range_m"].groupby(rows["link"]).mean()
    place = (mean.rank() - 0.5) / len(mean)
    place = place if which == "far" else 1 - place
    even = np.mod(0.7320508 * np.arange(len(mean)) + 0.2, 1)  # and not of chance
    taken = mean.index[even < np.minimum(0.05 + 1.2 * place**2, 1)]
    return rows[rows["link"].isin(taken)].reset_index(drop=True)


def _visit(rng: np.random.Generator, number: int, begin_s: float, left: bool) -> pd.DataFrame:
    """Return one visit: poll after poll, all readers in turn range a cart."""
    reader = np.arange(POLLS * len(READERS_M)) % len(READERS_M)
    when = np.arange(POLLS).repeat(len(READERS_M)) * POLL_S + TURN_S * reader
    gait = _gait(rng, when, left)
    table = gait.drop(columns=["aside_m", "along_m"])
    place = [rng.uniform(4.0, ROOM_M[0] - 4.0) + gait["aside_m"], gait["along_m"]]
    here = np.stack([*place, 0 * when + rng.uniform(0.6, 1.4)], axis=1)
    way = READERS_M[reader] - here
    for k, axis in enumerate("xyz"):
        table[f"tx_{axis}_m"], table[f"rx_{axis}_m"] = here[:, k], READERS_M[reader, k]
        table[f"room_{axis}_m"] = ROOM_M[k]
    table["true_range_m"] = np.linalg.norm(way, axis=1)
    facing = np.degrees(np.arctan2(way[:, 0], way[:, 1])) + rng.uniform(0, 360)
    table["azimuth_deg"] = np.mod(facing, 360)
    table["link"] = [f"visit {number}, reader {one}" for one in reader]
    table["tx"], table["rx"] = f"cart{rng.integers(CARTS)}", [f"reader{one}" for one in reader]
    table["environment"] = "north block" if here[0, 1] > CORRIDOR_M else "south block"
    table["temperature_c"] = rng.normal(18.5, 3.4) + 0.9 * rng.normal(size=len(when))
    table["humidity_percent"] = rng.uniform(30, 72) + rng.normal(0, 2, len(when))
    table["days_undusted"] = rng.exponential(18.0) + rng.uniform(0, 2, len(when))
    return table.assign(time_s=begin_s + when, channel=9, prf_mhz=64.0)


def _gait(rng: np.random.Generator, when: Floats, left: bool) -> pd.DataFrame:
    """Return how a cart is pushed along its aisle, and by how much it sways across."""
    begin = rng.uniform(2.0, ROOM_M[1] - 2.0)
    pace = 0.0 if left else rng.uniform(0.5, 1.4) * (1 if begin < CORRIDOR_M else -1)
    sway, rate = 0.0 if left else rng.uniform(0.08, 0.25), rng.uniform(0.7, 1.5)
    phase = rng.uniform(0, 2 * np.pi) + rate * when
    ones = np.ones(len(when))
    values = (pace * ones, sway * ones, rate * ones, phase, sway * np.sin(phase))
    named = dict(zip((*GAIT, "aside_m"), values, strict=True))
    return pd.DataFrame(named).assign(along_m=begin + pace * when)


def _answers(rng: np.random.Generator, mean: float) -> NDArray[np.bool_]:
    """Return which polls are answered: of each reader, in each visit, some in a row."""
    shape = (VISITS, 1, len(READERS_M))
    many = 1 + rng.binomial(POLLS - 1, np.clip(rng.normal(mean, 0.25, shape), 0.03, 0.97))
    begin = np.floor(rng.random(shape) * (POLLS + 1 - many))
    poll = np.arange(POLLS)[None, :, None]
    return np.asarray((poll >= begin) & (poll < begin + many)).ravel()


def _shut(rng: np.random.Generator, links: pd.Series, steel: float) -> pd.Series:
    """Return what stands in the straight path: a steel cabinet, slabs of some kind, or nothing."""
    names = links.unique()
    chance = rng.random((len(names), 1 + len(SLABS)))
    there = [
        ["metal"]
        if one[0] < steel
        else [k for k, c in zip(SLABS, one[1:], strict=True) if c < 0.14]
        for one in chance
    ]
    return links.map(dict(zip(names, there, strict=True)))


def through_books(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, less what carriages on the way take [n]."""
    carriages = (rows["tx_x_m"] - rows["rx_x_m"]).abs().to_numpy(np.float64) / CARRIAGE_M
    far = rows["true_range_m"].to_numpy(np.float64)
    return np.asarray(-64.8 - 19 * np.log10(far) - 0.8 * np.sqrt(carriages))


def _polled(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the archive's own radio."""
    size, links = len(rows), pd.Categorical(rows["link"])
    level = through_books(rows) + rng.laplace(0, 0.6, len(links.categories))[links.codes]
    level = level + rng.normal(0, 0.45, size)
    error = 0.0195 * scatter * (rng.beta(6.0, 6.0, size) - 0.5) * 7.2
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.4 - rng.gamma(3.0, 0.4, size),
        noise_std=61.0 * rng.lognormal(0, 0.028, size),
        preamble_count=np.rint(252 - rng.gamma(2.0, 1.2, size)),
    )


def _entered(
    table: pd.DataFrame, drawn: Draw, seed: int, rng: np.random.Generator
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    shifts = {name: np.zeros(len(table)) for name in drawn.hidden}
    first = [name for name in drawn.hidden if name not in ON_PAPER]
    for name in first + [name for name in ON_PAPER if name in drawn.hidden]:
        entry = EFFECTS[name](Files(table, seed, rng, bool(drawn.rare)), drawn.strength)
        shifts[name] = entry.metres
        table = _after(table, entry)
    return table, np.array([*shifts.values()]).reshape(len(shifts), len(table))


def _after(table: pd.DataFrame, entry: Entry) -> pd.DataFrame:
    """Return the table after an entry."""
    out = table.copy()
    out["error_m"] = table["error_m"] + entry.metres
    out["range_m"] = table["true_range_m"] + out["error_m"]
    for name, part in (("rx_power_dbm", 0.6), ("first_path_power_dbm", 1.0)):
        out[name] = table[name] + (entry.whole + part * np.asarray(entry.edge))
    out["noise_std"] = table["noise_std"] * 10 ** (0.05 * np.asarray(entry.hiss))
    out["preamble_count"] = table["preamble_count"] * 10 ** (0.05 * np.asarray(entry.count))
    return out
