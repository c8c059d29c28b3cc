"""Cows that walk about a shed and halt, ranged from its rafters: ranges and levels.

numpy and pandas alone; what it can hide is in `cowshed_effects`, its waveforms in
`cowshed_waves`. The shed and the channel are known. A walk has from one to eight rounds, all
rafters in each.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.cowshed_barn import (
    COWS,
    DAY_S,
    GAIT,
    LAWS,
    RAFTERS_M,
    SHED_M,
    WALLS,
    Herd,
    Trouble,
    walked,
)
from bench.challenge.families.cowshed_effects import EFFECTS

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 8)  # of walks, in any order
ROUND_S, NEXT_S = 0.42, 0.023
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
    "muck-on-domes": "muck_mm",
    "straw-piles-up": "straw_kg",
    "scrapers-run": "time_s",
    "curtain-lowered": "curtain_percent",
    "breath-condenses": "breath_g",
    "mangers-filled": "feed_kg",
    "collars-hang": "neck_cm",
    "heads-lowered": "tx_x_m",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
ON_PAPER = ("changes-underrated", "varas-from-one-rafter", "range-rounding")  # last, in this order
OF_STEEL, HARDLY_STEEL = 0.18, 0.05  # of links with a trough in the way; where that is rare


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the cowshed's own."""
    rng = np.random.default_rng([961, seed])
    here = part_of(walks(rng, drawn.rare), drawn, nearer=True)
    clean = _heard(here, rng, drawn.scatter)
    if not drawn.paired:
        here = part_of(walks(rng, drawn.rare), drawn, nearer=False)
        here["link"] = "next door " + here["link"]
    again = pd.concat([here] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _heard(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return walks(np.random.default_rng([961, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    first, second = np.random.default_rng([963, seed]).spawn(2)
    recorded, metres = _befallen(clean, drawn, seed, first)
    truth, _ = _befallen(simulated, drawn, seed, second)
    one, two, three, four = (
        shown(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(one, two, three, four, metres)


def shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how cows walk, and what stands between unless listed."""
    return table.drop(columns=[*GAIT] if listed else [*GAIT, "obstacles"])


def part_of(rows: pd.DataFrame, drawn: Draw, nearer: bool) -> pd.DataFrame:
    """Return all rows, or where the mix is to differ those of the nearer or farther links.

    Half of all, and every fourth of the others.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=nearer).index
    half = len(order) // 2
    return rows[rows["link"].isin({*order[:half], *order[half::4]})].reset_index(drop=True)


def walks(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a day: walks, in some of which a cow lies."""
    many = rng.permutation(rounds).tolist()
    lies = np.argsort(rng.random(len(many))) < 5
    if rare == "exchange-motion":  # one walk of two rounds and one of three alone
        lies = ~np.isin(np.arange(len(many)), [many.index(2), many.index(3)])
    begin_s = np.sort(DAY_S * rng.beta(1.4, 1.1, len(many)))
    every = [_walk(rng, k, many[k], float(begin_s[k]), bool(lies[k])) for k in range(len(many))]
    table = pd.concat(every, ignore_index=True)
    steel = HARDLY_STEEL if rare == "diffraction" else OF_STEEL
    return table.assign(**_of_the_day(rng, len(table)), obstacles=_in_the_way(rng, table, steel))


def _of_the_day(rng: np.random.Generator, size: int) -> dict[str, Floats]:
    """Return what is kept in the book of the shed, for each row."""
    return {
        "reply_time_s": np.minimum(0.004 + rng.gamma(2.0, 0.014, size), 0.09),
        "muck_mm": rng.weibull(1.1, size) * 2.4,
        "straw_kg": rng.triangular(0.0, 25.0, 60.0, size),
        "curtain_percent": 100.0 * rng.random(size),
        "breath_g": rng.exponential(17.0, size),
        "feed_kg": 75.0 * rng.beta(1.1, 1.3, size),
        "neck_cm": rng.uniform(58.0, 140.0, size),
    }


def _walk(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, lies: bool
) -> pd.DataFrame:
    """Return one walk: round after round, all rafters ask a cow's collar."""
    turn = np.arange(rounds * len(RAFTERS_M))
    rafter = turn % len(RAFTERS_M)
    since_s = ROUND_S * (turn // len(RAFTERS_M)) + NEXT_S * rafter
    table = _halting(rng, since_s, lies)
    to_rafter = RAFTERS_M[rafter] - table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()
    bearing = np.arctan2(to_rafter[:, 1], to_rafter[:, 0]) - table["heading_rad"]
    table[["rx_x_m", "rx_y_m", "rx_z_m"]] = RAFTERS_M[rafter]
    table[["room_x_m", "room_y_m", "room_z_m"]] = SHED_M
    return table.assign(
        true_range_m=np.linalg.norm(to_rafter, axis=1),
        azimuth_deg=np.rad2deg(bearing % (2 * np.pi)),
        link=[f"walk {number} below rafter {one}" for one in rafter],
        tx=f"cow{rng.integers(COWS)}",
        rx=[f"rafter{one}" for one in rafter],
        environment="feeding alley" if abs(table["tx_x_m"].iloc[0] - 11) < 4 else "cubicles",
        time_s=begin_s + since_s,
        temperature_c=rng.uniform(-5.0, 30.0) + rng.laplace(0.0, 0.6, len(turn)),
        channel=5,
        prf_mhz=16.0,
    )


def _halting(rng: np.random.Generator, since_s: Floats, lies: bool) -> pd.DataFrame:
    """Return how a cow walks ever slower, and where its collar is."""
    fast = 0.0 if lies else rng.uniform(0.7, 1.5)
    halt_s, heading = rng.uniform(2.2, 6.0), rng.uniform(0.0, 2 * np.pi)
    x, y = rng.uniform(4.0, (SHED_M[0] - 4.0, SHED_M[1] - 4.0))
    z = rng.uniform(0.45, 0.75) if lies else rng.uniform(0.9, 1.45)
    gone = walked(np.full(len(since_s), fast), np.full(len(since_s), halt_s), since_s)
    return pd.DataFrame(
        {
            "tx_x_m": x + gone * np.cos(heading),
            "tx_y_m": y + gone * np.sin(heading),
            "tx_z_m": z,
            "heading_rad": heading,
            "step_m_per_s": fast * np.exp(-since_s / halt_s),
            "halt_s": halt_s,
        }
    )


def _in_the_way(rng: np.random.Generator, table: pd.DataFrame, steel: float) -> pd.Series:
    """Return what stands in straight paths: a trough of steel, walls of the shed, or nothing."""
    links = table["link"].unique()
    walls = {link: [kind for kind in WALLS if rng.random() < 0.16] for link in links}
    trough = {link: ["metal"] for link in links if rng.random() < steel}
    return table["link"].map(walls | trough)


def below_the_roof(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: steel above and beside gives back a little of it [n]."""
    return np.asarray(-63.4 - 18.6 * np.log10(rows["true_range_m"].to_numpy(np.float64)))


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the cowshed's own radio."""
    size, link = len(rows), rows.groupby("link", sort=False).ngroup().to_numpy()
    level = below_the_roof(rows) + rng.logistic(0.0, 0.7, link.max() + 1)[link]
    level = level + rng.triangular(-0.9, 0.0, 0.9, size)
    error = scatter * rng.triangular(-0.062, 0.0, 0.062, size)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.4 - 0.9 * rng.weibull(1.3, size),
        noise_std=rng.triangular(66.0, 71.0, 80.0, size),
        preamble_count=509.0 - rng.binomial(22, 0.3, size),
    )


def _befallen(
    table: pd.DataFrame, drawn: Draw, seed: int, rng: np.random.Generator
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    metres = np.zeros((len(drawn.hidden), len(table)))
    order = [name for name in drawn.hidden if name not in ON_PAPER]
    for name in order + [name for name in ON_PAPER if name in drawn.hidden]:
        trouble = EFFECTS[name](Herd(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = trouble.metres
        table = _noted(table, trouble)
    return table, metres


def _noted(table: pd.DataFrame, trouble: Trouble) -> pd.DataFrame:
    """Return the table with what befell its rows."""
    out, edge = table.copy(), np.asarray(trouble.edge_db)
    error = out["error_m"] + trouble.metres
    out["error_m"], out["range_m"] = error, out["true_range_m"] + error
    out["rx_power_dbm"] += trouble.all_db + 0.62 * edge
    out["first_path_power_dbm"] += trouble.all_db + edge
    out["noise_std"] *= np.power(10.0, np.asarray(trouble.noise_db) / 20)
    out["preamble_count"] *= np.power(10.0, np.asarray(trouble.count_db) / 20)
    return out
