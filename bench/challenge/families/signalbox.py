"""Wagons in the sidings below a signal box, ranged from semaphores: ranges and levels.

numpy and pandas alone; what it can hide is in `signalbox_effects`, its waveforms in
`signalbox_waves`. There is no room, and the channel is known. Six semaphores of ten hear a run,
which has from one to ten rounds.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.signalbox_effects import EFFECTS
from bench.challenge.families.signalbox_yard import (
    BETWEEN,
    HEARD,
    LAWS,
    LONG_M,
    ROLL,
    SEMAPHORES_M,
    SIDINGS,
    TURN_S,
    WAGONS,
    Change,
    Train,
    rolled,
)

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 1, 2, 2, 3, 3, 3, 4, 4, 5, 5, 6, 6, 8, 9, 10)  # of runs, in any order
ROUND_S, TURN_OF_EACH_S = 0.33, 0.037
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
    "grease-on-domes": "grease_g",
    "rail-joints": "chainage_m",
    "point-heaters-on": "heater_kw",
    "coal-dust": "dust_g",
    "frost-on-arms": "frost_mm",
    "wires-lengthen-in-sun": "sun_w_per_m2",
    "ballast-conducts": "ballast_ohm",
    "clocks-run-between-bells": "time_s",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
OF_NUMBERS = ("rods-from-one-semaphore", "range-rounding")  # after all else
TANKS = {True: 0.055, False: 0.18}  # of links, seldom and usually


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the signal box's own."""
    rng = np.random.default_rng([901, seed])
    side = 0 if drawn.same_mix else 1
    rows = sorted_out(runs(rng, drawn.rare), side)
    clean = _timed(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = sorted_out(runs(rng, drawn.rare), -side)
        rows["link"] = "by the timetable, " + rows["link"]
    many = pd.concat(drawn.ratio * [rows], ignore_index=True)
    return hidden_in(drawn, seed, clean, _timed(many, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return runs(np.random.default_rng([901, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _changed(clean, drawn, seed, 0)
    truth, _ = _changed(simulated, drawn, seed, 1)
    out = [put_out(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(out[0], out[1], out[2], out[3], shifts_m=metres)


def put_out(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how wagons roll, and what stands between unless listed."""
    kept = [name for name in table if name not in ROLL and (listed or name != "obstacles")]
    return table[kept]


def sorted_out(rows: pd.DataFrame, side: int) -> pd.DataFrame:
    """Return all rows for 0; for 1 those of near links, for -1 of far ones, and a few others.

    Of three parts, all of the first, every second link of the next, every fifth of the last.
    """
    if side == 0:
        return rows.copy()
    order = (side * rows.groupby("link")["true_range_m"].mean()).sort_values().index
    third = len(order) // 3
    some = {*order[:third], *order[third : 2 * third : 2], *order[2 * third :: 5]}
    return rows[[link in some for link in rows["link"]]].reset_index(drop=True)


def runs(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a turn of duty: runs, in some of which wagons stand."""
    many = rng.permutation(np.asarray(rounds))
    stand = np.zeros(many.size, bool)
    stand[rng.permutation(many.size)[:5]] = True
    if rare == "exchange-motion":  # of which two, of few rounds, are all that rolls
        few = np.flatnonzero((many == 2) | (many == 3) | (many == 4))
        stand = ~np.isin(np.arange(many.size), few[:2])
    begins_s = np.cumsum(rng.dirichlet(np.full(many.size + 1, 3.0)))[:-1] * TURN_S
    made = [_run(rng, k, many[k], begins_s[k], stand[k]) for k in range(many.size)]
    table = pd.concat(made, ignore_index=True)
    table["obstacles"] = _stands_between(rng, table["link"], TANKS[rare == "diffraction"])
    return table.assign(**_logged(rng, len(table)))


def _logged(rng: np.random.Generator, size: int) -> dict[str, Floats]:
    """Return what the box's book has of each row."""
    return {
        "reply_time_s": 0.004 + 0.076 * (1 - np.sqrt(rng.random(size))),
        "grease_g": 40.0 * rng.beta(1.1, 1.2, size),
        "heater_kw": rng.uniform(0.0, 4.6, size),
        "dust_g": rng.gamma(1.2, 42.0, size),
        "frost_mm": rng.exponential(3.0, size),
        "sun_w_per_m2": rng.uniform(0.0, 870.0, size),
        "ballast_ohm": rng.triangular(1.7, 4.0, 11.0, size),
    }


def _run(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one run: round after round, those that hear a wagon ask its tag."""
    hear = np.sort(rng.permutation(len(SEMAPHORES_M))[:HEARD])
    which, turn = np.tile(hear, rounds), np.arange(HEARD * rounds)
    since_s = ROUND_S * (turn // HEARD) + TURN_OF_EACH_S * (turn % HEARD)
    table = _rolling(rng, since_s, stands)
    arms = SEMAPHORES_M[which]
    to_arm = arms - table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()
    table[["rx_x_m", "rx_y_m", "rx_z_m"]] = arms
    table["true_range_m"] = np.linalg.norm(to_arm, axis=1)
    seen = np.arctan2(to_arm[:, 0], to_arm[:, 1]) - table["bearing_rad"]
    table["azimuth_deg"] = np.mod(np.degrees(seen), 360.0)
    table["link"] = [f"run {number} heard by semaphore {one}" for one in which]
    table["tx"] = f"wagon{rng.integers(WAGONS)}"
    table["rx"] = [f"semaphore{one}" for one in which]
    table["environment"] = np.where(table["siding"] == 0, "goods siding", "sorting sidings")
    table["time_s"] = begin_s + since_s
    table["temperature_c"] = rng.uniform(-9.0, 32.0) + 1.1 * rng.standard_normal(len(turn))
    return table.assign(channel=2, prf_mhz=16.0)


def _rolling(rng: np.random.Generator, since_s: Floats, stands: bool) -> pd.DataFrame:
    """Return how a wagon rolls down a siding into a retarder, and where its tag is."""
    siding = int(rng.integers(len(SIDINGS)))
    at_x, fan, _ = SIDINGS[siding]
    entry = 0.0 if stands else rng.uniform(1.6, 4.2)
    leaving = entry * rng.uniform(0.35, 0.75)
    gripped = since_s - rng.uniform(-0.5, 2.2)
    gone = rolled(entry, leaving, gripped) - rolled(entry, leaving, gripped[:1])
    begin = rng.uniform(7.0, LONG_M - 7.0)
    bearing = fan if begin < 0.5 * LONG_M else fan + np.pi  # toward the farther end
    x = at_x + np.sin(fan) * begin + rng.normal(0, 0.15) + np.sin(bearing) * gone
    y = begin + np.cos(bearing) * gone
    z = rng.uniform(0.8, 3.1)
    chainage = rng.uniform(0.0, 260.0) + gone
    known_of = {"tx_x_m": x, "tx_y_m": y, "gripped_s": gripped, "chainage_m": chainage}
    return pd.DataFrame(known_of).assign(
        tx_z_m=z, siding=siding, bearing_rad=bearing, entry_m_per_s=entry, exit_m_per_s=leaving
    )


def _stands_between(rng: np.random.Generator, links: pd.Series, tanks: float) -> list[list[str]]:
    """Return what stands in straight paths: a tank wagon of steel, walls, or nothing."""
    number, names = pd.factorize(links)
    steel, chance = rng.random(len(names)), rng.random((len(names), len(BETWEEN)))
    kinds = list(BETWEEN)
    each = [
        ["metal"] if steel[k] < tanks else [kinds[j] for j in np.flatnonzero(chance[k] < 0.16)]
        for k in range(len(names))
    ]
    return [each[k] for k in number]


def in_the_yard(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, and less for semaphores that stand high [n]."""
    far, high = (rows[name].to_numpy(np.float64) for name in ("true_range_m", "rx_z_m"))
    return np.asarray(-58.6 - 20.4 * np.log10(far) - 0.35 * (high - 4.0))


def _timed(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the signal box's own radio."""
    size, (number, names) = len(rows), pd.factorize(rows["link"])
    level = in_the_yard(rows) + 1.1 * rng.standard_normal(len(names))[number]
    level += 0.3 * rng.laplace(size=size)
    error = scatter * 0.017 * (rng.beta(2.0, 2.0, size) - 0.5) * np.sqrt(20.0)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.45 - 0.8 * np.hypot(*rng.standard_normal((2, size))),
        noise_std=82.0 * rng.lognormal(0, 0.03, size),
        preamble_count=1003.0 - rng.geometric(0.1, size),
    )


def _changed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([side, 903, seed])
    first = [name for name in drawn.hidden if name not in OF_NUMBERS]
    done: dict[str, Floats] = {}
    for name in (*first, *(name for name in OF_NUMBERS if name in drawn.hidden)):
        change = EFFECTS[name](Train(table, seed, rng, drawn.rare != ""), drawn.strength)
        done[name], table = change.metres, _with(table, change)
    metres = [done[name] for name in drawn.hidden]
    return table, np.stack(metres) if metres else np.zeros((0, len(table)))


def _with(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    """Return the table with what changes in its rows."""
    out = table.assign(error_m=table["error_m"] + change.metres)
    both, edge = np.asarray(change.whole), np.asarray(change.edge)
    return out.assign(
        range_m=out["true_range_m"] + out["error_m"],
        rx_power_dbm=out["rx_power_dbm"] + both + 0.62 * edge,
        first_path_power_dbm=out["first_path_power_dbm"] + both + edge,
        noise_std=out["noise_std"] * 10 ** (0.05 * np.asarray(change.hiss)),
        preamble_count=out["preamble_count"] * 10 ** (0.05 * np.asarray(change.count)),
    )
