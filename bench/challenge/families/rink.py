"""Skaters on an ice rink, ranged from trusses of its roof: ranges and levels.

numpy and pandas alone; what it can hide is in `rink_effects`, its waveforms in `rink_waves`. The
hall and the channel are known. A shift on the ice has from one to eight rounds.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.rink_effects import EFFECTS
from bench.challenge.families.rink_ice import (
    BARRIERS,
    GLIDE,
    LAWS,
    RINK_M,
    SKATERS,
    SLOWS_S,
    TRUSSES_M,
    Cut,
    Sheet,
)

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 8)  # of shifts, in any order
ROUND_S, PING_S, EVENING_S = 0.3, 0.019, 6 * 3600.0
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
    "visor-fogs": "breath_percent",
    "drier-cycles": "time_s",
    "second-brine-pump": "brine_percent",
    "spectators-rise": "spectators",
    "rime-on-trusses": "rime_mm",
    "floodlights-burn": "lux_klx",
    "cell-sags-in-cold": "cell_mah",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
AT_THE_END = ("coasts-on-speed", "counter-of-another-clock", "range-rounding")
FEW = 0.05


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the rink's own."""
    rng = np.random.default_rng([852, seed])
    rows = chosen(shifts(rng, drawn.rare), None if drawn.same_mix else "near")
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = chosen(shifts(rng, drawn.rare), None if drawn.same_mix else "far")
        rows = rows.assign(link="as booked, " + rows["link"])
    many = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(many, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return shifts(np.random.default_rng([852, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _skated(clean, drawn, seed, 1)
    truth, _ = _skated(simulated, drawn, seed, 2)
    out = [shown(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(out[0], out[1], out[2], out[3], metres)


def shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how skaters glide, and what stands between unless listed."""
    return table.drop(columns=[*GLIDE, *([] if listed else ["obstacles"])])


def shifts(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of an evening: shifts, in some of which a skater stands."""
    many = [int(one) for one in rng.permutation(rounds)]
    rests = {*rng.choice(len(many), 5, replace=False).tolist()}
    if rare == "exchange-motion":  # but two short shifts all stand
        short = [k for k, one in enumerate(many) if 2 <= one <= 4][:2]
        rests = {*range(len(many))} - {*short}
    starts_s = np.sort(rng.random(len(many))) * EVENING_S
    each = [_shift(rng, k, many[k], starts_s[k], k in rests) for k in range(len(many))]
    return _hall(pd.concat(each, ignore_index=True), rng, FEW if rare == "diffraction" else 0.19)


def _hall(table: pd.DataFrame, rng: np.random.Generator, steel: float) -> pd.DataFrame:
    """Return the table with what the hall's desk logs of each row."""
    size = len(table)
    return table.assign(
        reply_time_s=0.004 + 0.07 * rng.beta(1.2, 1.6, size),
        breath_percent=100 * rng.beta(1.0, 1.2, size),
        brine_percent=rng.triangular(10, 55, 100, size),
        spectators=rng.gamma(1.3, 260.0, size),
        rime_mm=rng.exponential(3.5, size),
        lux_klx=rng.uniform(0.0, 4.0, size),
        cell_mah=rng.uniform(25, 160, size),
        obstacles=pd.Series(_between(rng, table["link"], steel)),
    )


def chosen(rows: pd.DataFrame, side: str | None) -> pd.DataFrame:
    """Return all rows, or mostly those of `near` links or of `far` ones."""
    if side is None:
        return rows.copy()
    mean_m = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=side == "near")
    part = np.linspace(0, 1, len(mean_m))
    keep = np.mod(0.7548776662 * np.arange(len(part)), 1) < np.clip(1.15 - 1.5 * part, 0.05, 1)
    return rows[rows["link"].isin(mean_m.index[keep])].reset_index(drop=True)


def _shift(
    rng: np.random.Generator, number: int, rounds: int, start_s: float, rests: bool
) -> pd.DataFrame:
    """Return one shift: round after round, all trusses ask the tag in a helmet."""
    truss = np.tile(np.arange(len(TRUSSES_M)), rounds)
    since_s = np.arange(rounds).repeat(len(TRUSSES_M)) * ROUND_S + PING_S * truss
    made = _glide(rng, since_s, rests)
    at = made[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()
    way = TRUSSES_M[truss] - at
    made[["rx_x_m", "rx_y_m", "rx_z_m"]] = TRUSSES_M[truss]
    turned = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - made["heading_rad"].to_numpy())
    return made.assign(
        true_range_m=np.linalg.norm(way, axis=1),
        azimuth_deg=np.mod(turned, 360.0),
        link=[f"shift {number} heard by truss {one}" for one in truss],
        tx=f"skater{rng.integers(SKATERS)}",
        rx=[f"truss{one}" for one in truss],
        environment="home end" if at[0, 1] < RINK_M[1] / 2 else "guest end",
        time_s=start_s + since_s,
        temperature_c=rng.uniform(-6.5, 13.0) + rng.normal(0, 0.7, len(truss)),
        room_x_m=RINK_M[0],
        room_y_m=RINK_M[1],
        room_z_m=RINK_M[2],
        channel=5,
        prf_mhz=64.0,
    )


def _glide(rng: np.random.Generator, since_s: Floats, rests: bool) -> pd.DataFrame:
    """Return how a skater glides along an arc, ever slower, and where the tag is."""
    speed = 0.0 if rests else rng.uniform(1.4, 3.8)
    arc = rng.choice([-1.0, 1.0]) * rng.uniform(3.0, 7.0)
    begin = rng.uniform(0, 2 * np.pi)
    heading = begin - speed * SLOWS_S * np.expm1(-since_s / SLOWS_S) / arc
    middle = rng.uniform([9.5, 9.5], [RINK_M[0] - 9.5, RINK_M[1] - 9.5])
    return pd.DataFrame(
        {
            "arc_m": np.full_like(since_s, arc),
            "heading_rad": heading,
            "speed_m_per_s": speed * np.exp(-since_s / SLOWS_S),
            "tx_x_m": middle[0] + arc * np.sin(heading),
            "tx_y_m": middle[1] - arc * np.cos(heading),
            "tx_z_m": np.full_like(since_s, rng.uniform(1.2, 1.9)),
        }
    )


def _between(rng: np.random.Generator, links: pd.Series, steel: float) -> list[list[str]]:
    """Return what stands in straight paths: a scoreboard of steel, barriers, or nothing."""

    def one() -> list[str]:
        if rng.random() < steel:
            return ["metal"]
        return [kind for kind in BARRIERS if rng.random() < 0.16]

    met = {link: one() for link in dict.fromkeys(links)}
    return [met[link] for link in links]


def over_ice(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, and a little less for tags low above the ice [n]."""
    low = 1.9 - rows["tx_z_m"].to_numpy(np.float64)
    return np.asarray(-63.2 - 19.7 * np.log10(rows["true_range_m"].to_numpy(np.float64)) - low)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the rink's own radio."""
    size = len(rows)
    place, links = pd.factorize(rows["link"])
    level = over_ice(rows) + rng.normal(0, 1.2, len(links))[place]
    level = level + rng.triangular(-0.9, 0, 0.9, size)
    error = scatter * (0.015 * rng.standard_normal(size) + 0.006 * rng.logistic(size=size))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.6 - rng.gamma(2.2, 0.45, size),
        noise_std=61.0 * np.exp(0.028 * rng.standard_normal(size)),
        preamble_count=1017.0 - rng.poisson(8.0, size),
    )


def _skated(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([853, side, seed])
    metres = np.zeros((len(drawn.hidden), len(table)))
    order = [name for name in drawn.hidden if name not in AT_THE_END]
    order += [name for name in AT_THE_END if name in drawn.hidden]
    for name in order:
        cut = EFFECTS[name](Sheet(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = cut.metres
        table = _with(table, cut)
    return table, metres


def _with(table: pd.DataFrame, cut: Cut) -> pd.DataFrame:
    """Return the table with what is cut into its rows."""
    error = table["error_m"].to_numpy(np.float64) + cut.metres
    both = np.asarray(cut.whole) + 0.0
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + both + 0.6 * np.asarray(cut.edge),
        first_path_power_dbm=table["first_path_power_dbm"] + both + cut.edge,
        noise_std=table["noise_std"] * 10 ** (np.asarray(cut.hiss) / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(cut.count) / 20),
    )
