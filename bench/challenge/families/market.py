"""Trolleys that halt and go along aisles, ranged from lamps of a supermarket: ranges and levels.

numpy and pandas alone; what it can hide is in `market_effects`, its waveforms in `market_waves`.
No room is known, but the channel is. Steel shelves weaken what crosses them; exchanges are
double-sided.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.market_effects import EFFECTS
from bench.challenge.families.market_plan import (
    AISLES_M,
    FLOOR_M,
    GOODS,
    LAMPS_M,
    LAWS,
    SHELVES_M,
    TROLLEYS,
    WALK,
    Bill,
    Goods,
    on_the_floor,
)

Floats = NDArray[np.float64]
TOURS, POLLS, POLL_S, STEP_S = 15, 4, 0.45, 0.017
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
    "trolley-load": "load_kg",
    "fridges-run": "time_s",
    "tills-open": "queue_m",
    "cell-runs-down": "cell_v",
    "shoppers-crowd": "shoppers",
    "wax-on-floor": "wax_um",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
LAST = ("old-ranges-kept", "ticks-for-millimetres", "range-rounding")
A_FEW = 0.07


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the supermarket's own."""
    rng = np.random.default_rng([751, seed])
    rows = chosen(tours(rng, drawn.rare), "" if drawn.same_mix else "short")
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = chosen(tours(rng, drawn.rare), "" if drawn.same_mix else "long")
        rows["link"] = "planned " + rows["link"]
    runs = (_ranged(rows, rng, drawn.scatter) for _ in range(drawn.ratio))
    return hidden_in(drawn, seed, clean, pd.concat(list(runs), ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return tours(np.random.default_rng([751, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _sold(clean, drawn, seed, np.random.default_rng([753, seed]))
    truth, _ = _sold(simulated, drawn, seed, np.random.default_rng([754, seed]))
    listed = drawn.listed
    return Tables(
        to_hand_out(recorded, listed),
        to_hand_out(clean, listed),
        to_hand_out(simulated, listed),
        to_hand_out(truth, listed),
        shifts,
    )


def to_hand_out(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how trolleys are walked, and what stands between unless listed."""
    out = table.drop(columns=list(WALK), errors="ignore")
    return out if listed else out.drop(columns="obstacles", errors="ignore")


def tours(
    rng: np.random.Generator, rare: str, polls: int = POLLS, count: int = TOURS
) -> pd.DataFrame:
    """Return what is known of the rows of a day: tours along aisles, some trolleys left alone."""
    alone = np.zeros(count, bool)
    alone[rng.permutation(count)[: count - 2 if rare == "exchange-motion" else 4]] = True
    opens = np.sort(rng.uniform(0, 12 * 3600, count))
    every = [_tour(rng, one, polls, opens[one], bool(alone[one])) for one in range(count)]
    table = pd.concat(every, ignore_index=True)
    size = len(table)
    table["reply_time_s"] = 0.003 + rng.gamma(1.3, 0.028, size)
    table["queue_m"] = 9 * rng.beta(1.2, 1.5, size)
    table["load_kg"] = rng.uniform(0, 80, size)
    table["cell_v"] = 2.3 + 1.9 * rng.beta(1.3, 1.1, size)
    table["wax_um"] = rng.uniform(0, 60, size)
    table["obstacles"] = _stands(rng, table["link"], A_FEW if rare == "diffraction" else 0.17)
    return table


def chosen(rows: pd.DataFrame, which: str) -> pd.DataFrame:
    """Return all rows, or those of links that are mostly `short` or mostly `long`."""
    if which == "":
        return rows.copy()
    mean = rows.groupby("link", sort=False)["true_range_m"].mean().sort_values()
    wanted = np.linspace(1.15, 0.03, len(mean)) ** 1.5
    wanted = wanted if which == "short" else wanted[::-1]
    even = np.mod(0.5 + 0.41421356 * np.arange(len(mean)), 1)  # and not of chance
    return rows[rows["link"].isin(mean.index[even < wanted])].reset_index(drop=True)


def _tour(
    rng: np.random.Generator, number: int, polls: int, begin_s: float, alone: bool
) -> pd.DataFrame:
    """Return one tour: poll after poll, all lamps range a trolley in an aisle."""
    lamp = np.arange(polls * len(LAMPS_M)) % len(LAMPS_M)
    poll = np.arange(len(lamp)) // len(LAMPS_M)
    when = poll * POLL_S + lamp * STEP_S
    table = _walks(rng, when, alone)
    here = np.stack(
        [
            rng.choice(AISLES_M) + rng.uniform(-0.5, 0.5) + 0 * when,
            on_the_floor(table["walked_m"].to_numpy()),
            rng.uniform(0.75, 1.2) + 0 * when,
        ]
    )
    way = LAMPS_M[lamp].T - here
    for axis, own, other in zip("xyz", here, LAMPS_M[lamp].T, strict=True):
        table[f"tx_{axis}_m"], table[f"rx_{axis}_m"] = own, other
    table["true_range_m"] = np.linalg.norm(way, axis=0)
    table["azimuth_deg"] = np.mod(np.degrees(np.arctan2(-way[0], way[1])) + _bend(rng, when), 360)
    table["tx"] = f"trolley{rng.integers(TROLLEYS)}"
    table["rx"] = [f"lamp{one}" for one in lamp]
    table["link"] = [f"tour {number} / lamp {one}" for one in lamp]
    table["environment"] = "cold aisles" if here[0, 0] > FLOOR_M[0] * 0.6 else "dry aisles"
    cold = 11.0 if here[0, 0] > FLOOR_M[0] * 0.6 else 20.0
    table["temperature_c"] = cold + rng.normal(0, 3) + rng.normal(0, 1.5, len(when))
    table["time_s"] = begin_s + when
    table["shoppers"] = rng.gamma(1.4, 11.0) * rng.uniform(0.7, 1.3, len(when))
    return table.assign(channel=9, prf_mhz=64.0)


def _bend(rng: np.random.Generator, when: Floats) -> Floats:
    """Return by how much the trolley is turned away from its aisle, in degrees [n]."""
    return rng.uniform(-180, 180) + 12 * np.sin(rng.uniform(0.3, 0.9) * when)


def _walks(rng: np.random.Generator, when: Floats, alone: bool) -> pd.DataFrame:
    """Return how one walks: as fast as one does in the mean, slower and faster by turns."""
    begin, way = rng.uniform(0, FLOOR_M[1] - 2), rng.uniform(0.6, 1.5)
    speed = 0.0 if alone else way if begin < FLOOR_M[1] / 2 - 1 else -way  # to the farther wall
    halts, phase = rng.uniform(0.35, 1.0), rng.uniform(0, 2 * np.pi)
    sway = (np.sin(phase + halts * when) - np.sin(phase)) / halts
    walked = begin + speed * (when - sway)
    values = (walked, speed + 0 * when, halts + 0 * when, phase + halts * when)
    return pd.DataFrame(dict(zip(WALK, values, strict=True)))


def _stands(rng: np.random.Generator, links: pd.Series, steel: float) -> pd.Series:
    """Return what stands in the straight path: a pillar of steel, goods of any kind, or nothing."""
    kinds: dict[str, list[str]] = {}
    for link in dict.fromkeys(links):
        some = [kind for kind in GOODS if rng.random() < 0.14]
        kinds[link] = ["metal"] if rng.random() < steel else some
    return links.map(kinds)


def under_lamps(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, less what steel shelves in between take [n]."""
    far = rows["true_range_m"].to_numpy(np.float64)
    ends = np.sort(rows[["tx_x_m", "rx_x_m"]].to_numpy(np.float64), axis=1)
    within = (ends[:, :1] < SHELVES_M) & (ends[:, 1:] > SHELVES_M)
    return np.asarray(-60.0 - 17.5 * np.log10(far) - 1.2 * np.sqrt(within.sum(axis=1)))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the supermarket's own radio."""
    size, (which, links) = len(rows), pd.factorize(rows["link"])
    level = under_lamps(rows) + rng.normal(0, 0.8, len(links))[which] + rng.normal(0, 0.5, size)
    wide = np.where(rng.random(size) < 0.1, 0.05, 0.017)
    error = scatter * wide * rng.normal(size=size)
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error, rx_power_dbm=level)
    out["first_path_power_dbm"] = level - 0.6 - rng.exponential(1.1, size)
    out["noise_std"] = rng.gamma(400.0, 0.13, size)
    return out.assign(preamble_count=np.rint(121 - rng.exponential(1.5, size)))


def _sold(
    table: pd.DataFrame, drawn: Draw, seed: int, rng: np.random.Generator
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    added: dict[str, Floats] = {}
    for name in sorted(drawn.hidden, key=lambda one: one in LAST):
        bill = EFFECTS[name](Goods(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added[name], table = bill.metres, _billed(table, bill)
    empty = np.zeros((0, len(table)))
    return table, np.stack([added[name] for name in drawn.hidden]) if added else empty


def _billed(table: pd.DataFrame, bill: Bill) -> pd.DataFrame:
    """Return the table with what rows are billed."""
    out = table.copy()
    out["error_m"] += bill.metres
    out["range_m"] = out["true_range_m"] + out["error_m"]
    for column, share in (("rx_power_dbm", 0.7), ("first_path_power_dbm", 1.0)):
        out[column] += bill.whole + share * np.asarray(bill.edge)
    for column, db in (("noise_std", bill.hiss), ("preamble_count", bill.count)):
        out[column] *= np.power(10.0, np.asarray(db) / 20)
    return out
