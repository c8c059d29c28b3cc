"""Mowers and steeplejacks about a belfry, ranged from gargoyles high and low: ranges and levels.

numpy and pandas alone; what it can hide is in `belfry_effects`, its waveforms in `belfry_waves`.
There is no room, and the channel is known. A visit has from one to eight rounds.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.belfry_close import (
    CLOSE_M,
    DAY_S,
    GARGOYLES_M,
    GOING,
    HALF_M,
    LAWS,
    MASONS,
    SCREENS,
    TOWER_M,
    Toll,
    Watch,
    ahead,
)
from bench.challenge.families.belfry_effects import EFFECTS
from bench.challenge.families.case import Draw, Tables

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5, 6, 7, 8)  # of visits, in any order
ROUND_S, AFTER_S = 0.34, 0.029
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
    "lichen-on-radomes": "lichen_mm",
    "dew-gathers": "dew_um",
    "quarters-struck": "time_s",
    "louvres-shut": "louvre_deg",
    "moss-grows": "moss_mm",
    "nests-grow": "twigs_g",
    "brackets-sag": "pull_kn",
    "barometer-drifts": "time_s",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
AT_LAST = ("leaps-cut", "toises-from-one-gargoyle", "range-rounding")
RAILINGS, FEW_RAILINGS = 0.18, 0.05  # of links


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the belfry's own."""
    rng = np.random.default_rng([seed, 941])
    rows = drawn_up(rng, drawn, near=True)
    clean = _struck(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = drawn_up(rng, drawn, near=False)
        rows = rows.assign(link="in another parish " + rows["link"])
    many = pd.concat([rows for _ in range(drawn.ratio)], ignore_index=True)
    return hidden_in(drawn, seed, clean, _struck(many, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return visits(np.random.default_rng([seed, 941]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    (found, metres), (truth, _) = (
        _tolled(table, drawn, seed, np.random.default_rng([seed, 943 + number]))
        for number, table in enumerate((clean, simulated))
    )
    known_of = [in_public(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(known_of[0], known_of[1], known_of[2], known_of[3], metres)


def in_public(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how masons move, and what stands between unless listed."""
    secret = {*GOING} if listed else {*GOING, "obstacles"}
    return table.loc[:, [name not in secret for name in table]]


def drawn_up(
    rng: np.random.Generator, drawn: Draw, near: bool, rounds: tuple[int, ...] = ROUNDS
) -> pd.DataFrame:
    """Return the rows of a day, or where the mix is to differ those of its near or far links.

    Of these half, of the rest every third.
    """
    rows = visits(rng, drawn.rare, rounds)
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean()
    asked = (far < far.median()) if near else (far >= far.median())
    some = {*asked.index[asked], *asked.index[~asked][::3]}
    return rows[rows["link"].isin(some)].reset_index(drop=True)


def visits(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a day: visits, in some of which a mason rests."""
    many = rng.choice(np.array(rounds), len(rounds), replace=False).tolist()
    rests = _resting(rng, many, rare)
    begin_s = DAY_S * np.sort(rng.beta(1.2, 1.2, len(many)))
    table = pd.concat(
        [_visit(rng, k, many[k], begin_s[k], rests[k]) for k in range(len(many))],
        ignore_index=True,
    )
    few = FEW_RAILINGS if rare == "diffraction" else RAILINGS
    size = len(table)
    return table.assign(
        reply_time_s=np.exp(rng.uniform(np.log(0.004), np.log(0.085), size)),
        lichen_mm=rng.exponential(1.6, size),
        dew_um=80.0 * np.sqrt(rng.random(size)) * rng.random(size),
        louvre_deg=rng.uniform(0.0, 75.0, size),
        moss_mm=rng.gamma(1.4, 9.0, size),
        twigs_g=rng.uniform(0.0, 700.0, size),
        pull_kn=0.7 + 4.0 * rng.beta(1.3, 1.6, size),
        obstacles=_screens(rng, table["link"], few),
    )


def _resting(rng: np.random.Generator, many: list[int], rare: str) -> list[bool]:
    """Return which visits rest: five, or all but two short ones where motion is to be rare."""
    if rare == "exchange-motion":
        short = [k for k, rounds in enumerate(many) if rounds in (2, 3)][:2]
        return [k not in short for k in range(len(many))]
    some = rng.choice(len(many), 5, replace=False)
    return [k in some for k in range(len(many))]


def _visit(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, rests: bool
) -> pd.DataFrame:
    """Return one visit: round after round, all gargoyles ask the tag of a mason."""
    each = len(GARGOYLES_M)
    gargoyle = np.tile(np.arange(each), rounds)
    since_s = np.repeat(np.arange(rounds), each) * ROUND_S + gargoyle * AFTER_S
    on_rope = bool(rng.random() < 0.35)
    going = _going(rng, on_rope, rests)
    speed, gain = going["speed_m_per_s"], going["gain_m_per_s2"]
    gone = since_s * (speed + 0.5 * gain * since_s)
    way = ahead(*(np.array(going[name]) for name in GOING[:2]))
    tag = (_on_a_rope(rng) if on_rope else _on_grass(rng)) + gone[:, None] * way
    off = GARGOYLES_M[gargoyle] - tag
    turn = np.arctan2(off[:, 1], off[:, 0]) - going["course_rad"]
    columns = dict(zip(("tx_x_m", "tx_y_m", "tx_z_m"), tag.T, strict=True))
    columns |= dict(zip(("rx_x_m", "rx_y_m", "rx_z_m"), GARGOYLES_M[gargoyle].T, strict=True))
    return pd.DataFrame(columns).assign(
        **going | {"speed_m_per_s": speed + gain * since_s},
        true_range_m=np.linalg.norm(off, axis=1),
        azimuth_deg=np.mod(np.rad2deg(turn), 360.0),
        link=[f"visit {number} seen by gargoyle {one}" for one in gargoyle],
        tx=f"mason{rng.integers(MASONS)}",
        rx=[f"gargoyle{one}" for one in gargoyle],
        environment="tower face" if on_rope else "churchyard",
        time_s=begin_s + since_s,
        temperature_c=rng.uniform(-6.0, 35.0) + rng.normal(0.0, 0.9, len(since_s)),
        channel=3,
        prf_mhz=16.0,
    )


def _going(rng: np.random.Generator, on_rope: bool, rests: bool) -> dict[str, float]:
    """Return which way a mason goes, how fast, and by how much faster each second."""
    up = rng.choice([-1.0, 1.0]) * rng.uniform(1.44, 1.57)
    return {
        "course_rad": rng.uniform(0.0, 2 * np.pi),
        "climb_rad": float(up) if on_rope else 0.0,
        "speed_m_per_s": 0.0 if rests else rng.uniform(0.7, 1.5),
        "gain_m_per_s2": 0.0 if rests else rng.uniform(-0.15, 0.2),
    }


def _on_a_rope(rng: np.random.Generator) -> Floats:
    """Return a place before a face of the tower [3], in m."""
    along, out = rng.uniform(-2.5, 2.5), HALF_M + rng.uniform(0.5, 1.1)
    aside = [(along, out), (along, -out), (out, along), (-out, along)][rng.integers(4)]
    return np.array([TOWER_M[0] + aside[0], TOWER_M[1] + aside[1], rng.uniform(6.0, 23.0)])


def _on_grass(rng: np.random.Generator) -> Floats:
    """Return a place on the grass, not too near to the tower [3], in m."""
    while True:
        x, y = rng.uniform(5.0, np.array(CLOSE_M) - 5.0)
        if max(abs(x - TOWER_M[0]), abs(y - TOWER_M[1])) > HALF_M + 4.5:
            return np.array([x, y, rng.uniform(0.3, 1.5)])


def _screens(rng: np.random.Generator, links: pd.Series, railings: float) -> pd.Series:
    """Return what stands in straight paths: iron railings, screens, or nothing."""
    each = {}
    for link in links.unique():
        some = [kind for kind in SCREENS if rng.random() < 0.16]
        each[link] = ["metal"] if rng.random() < railings else some
    return links.map(each)


def about_the_tower(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, less for what looks steeply down [n]."""
    far = rows["true_range_m"].to_numpy(np.float64)
    steep = (rows["rx_z_m"] - rows["tx_z_m"]).to_numpy(np.float64) / far
    return np.asarray(-59.6 - 20.0 * np.log10(far) - 1.3 * steep**2)


def _struck(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the belfry's own radio."""
    link = pd.factorize(rows["link"])[0]
    level = about_the_tower(rows) + rng.gumbel(-0.5, 0.9, link.max() + 1)[link]
    level = level + rng.uniform(-0.7, 0.7, len(rows))
    error = scatter * 0.03 * (rng.random((4, len(rows))).sum(axis=0) - 2.0)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.35 - rng.exponential(0.8, len(rows)),
        noise_std=91.0 + rng.logistic(0.0, 1.6, len(rows)),
        preamble_count=1012.0 - np.floor(rng.exponential(9.0, len(rows))),
    )


def _tolled(
    table: pd.DataFrame, drawn: Draw, seed: int, rng: np.random.Generator
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    metres = {name: np.zeros(len(table)) for name in drawn.hidden}
    for name in (*(n for n in metres if n not in AT_LAST), *(n for n in AT_LAST if n in metres)):
        toll = EFFECTS[name](Watch(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[name], table = toll.metres, _with(table, toll)
    return table, np.array(list(metres.values())).reshape(len(metres), len(table))


def _with(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table with what is added to its rows."""
    first = np.asarray(toll.first, np.float64)
    return table.assign(
        error_m=lambda t: t["error_m"] + toll.metres,
        range_m=lambda t: t["true_range_m"] + t["error_m"],
        rx_power_dbm=lambda t: t["rx_power_dbm"] + toll.all + 0.58 * first,
        first_path_power_dbm=lambda t: t["first_path_power_dbm"] + toll.all + first,
        noise_std=lambda t: t["noise_std"] * 10 ** (np.asarray(toll.hiss) / 20),
        preamble_count=lambda t: t["preamble_count"] * 10 ** (np.asarray(toll.count) / 20),
    )
