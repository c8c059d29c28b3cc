"""Gondolas that go round on a fairground, ranged from booths about it: ranges and levels.

numpy and pandas alone; what it can hide is in `fairground_effects`, its waveforms in
`fairground_waves`. There is no room, and the channel is known. A ride has from one to eight
rounds, in each of which all booths ask.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.fairground_effects import EFFECTS
from bench.challenge.families.fairground_rides import (
    AXLES,
    BARRIERS,
    BOOTHS_M,
    EVENING_S,
    GONDOLAS,
    HUBS_M,
    LAWS,
    RADII_M,
    RIDES,
    TURNING,
    Stall,
    Ticket,
    turned,
)

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5, 6, 7, 8, 8)  # of rides, in any order
ROUND_S, NEXT_S = 0.36, 0.031
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
    "canvas-soaks": "canvas_kg",
    "crowd-gathers": "people",
    "organ-plays": "time_s",
    "awning-let-down": "awning_deg",
    "sugar-settles": "sugar_g",
    "bunting-hung": "bunting_m",
    "ground-gives-way": "ground_mn_per_m",
    "wheel-set-askew": "tx_x_m",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
WRITTEN_LAST = ("louder-of-two-kept", "sazhens-from-one-booth", "range-rounding")
STEEL = (0.19, 0.05)  # of links that pass a wagon's edge; where that is rare


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the fairground's own."""
    rng = np.random.default_rng([seed, 3, 981])
    rows = mixed(rides(rng, drawn.rare), drawn, 1)
    clean = _rung_up(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = mixed(rides(rng, drawn.rare), drawn, -1)
        rows["link"] = [f"at another fair {link}" for link in rows["link"]]
    rows = rows.iloc[np.tile(np.arange(len(rows)), drawn.ratio)].reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _rung_up(rows, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return rides(np.random.default_rng([seed, 3, 981]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    dealt = [_dealt(one, drawn, seed, k) for k, one in enumerate((clean, simulated))]
    (recorded, metres), (truth, _) = dealt
    every = [open_to_all(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(every[0], every[1], every[2], every[3], metres)


def open_to_all(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how rides turn, and what stands between unless listed."""
    out = table.drop(columns=list(TURNING))
    return out if listed else out.drop(columns=["obstacles"])


def mixed(rows: pd.DataFrame, drawn: Draw, sign: int) -> pd.DataFrame:
    """Return all rows, or where the mix is to differ most near (sign 1) or most far links (-1).

    Of the half that is asked for all, of the other half one in four.
    """
    if drawn.same_mix:
        return rows
    far = sign * rows["true_range_m"].groupby(rows["link"]).mean()
    place = far.argsort().argsort()
    kept = far.index[(place < len(far) / 2) | (place % 4 == 1)]
    return rows.loc[rows["link"].isin(kept)].reset_index(drop=True)


def rides(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of an evening: rides, in some of which a ride stands."""
    many = rng.choice(rounds, len(rounds), replace=False)
    stands = np.isin(np.arange(len(many)), rng.choice(len(many), 5, replace=False))
    if rare == "exchange-motion":
        stands[:] = True
        stands[[np.flatnonzero(many == rounds_)[0] for rounds_ in (2, 3)]] = False
    begin_s = np.sort(rng.triangular(0.0, 0.6 * EVENING_S, EVENING_S, len(many)))
    each = [
        _ride(rng, number, int(n), float(begin_s[number]), bool(stands[number]))
        for number, n in enumerate(many)
    ]
    table = pd.concat(each, ignore_index=True)
    table["obstacles"] = _between(rng, table["link"], STEEL[rare == "diffraction"])
    return table.assign(**_till(rng, len(table)))


def _till(rng: np.random.Generator, size: int) -> dict[str, Floats]:
    """Return what is known of the evening, for each row."""
    return {
        "reply_time_s": 0.003 + 0.087 * rng.power(0.55, size),
        "canvas_kg": rng.lognormal(1.9, 0.8, size).clip(0.0, 60.0),
        "people": 400.0 * rng.beta(1.5, 1.5, size),
        "awning_deg": rng.uniform(4.0, 80.0, size),
        "sugar_g": rng.weibull(0.9, size) * 25.0,
        "bunting_m": rng.uniform(0.0, 120.0, size),
        "ground_mn_per_m": 0.9 + rng.gamma(1.6, 1.5, size).clip(0.0, 8.0),
    }


def _ride(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one ride: round after round, the booths ask the tag in a gondola in turn."""
    booth = np.tile(np.arange(len(BOOTHS_M)), rounds)
    since_s = np.arange(rounds).repeat(len(BOOTHS_M)) * ROUND_S + booth * NEXT_S
    ride = int(rng.choice(len(RIDES), p=(0.4, 0.3, 0.3)))
    spin = 0.0 if stands else rng.choice((-1, 1)) * rng.uniform(0.75, 1.5) / RADII_M[ride]
    start = np.tile(_seat(rng, ride), (len(booth), 1))
    tag = turned(start, np.full(len(booth), ride), spin * since_s)
    off = BOOTHS_M[booth] - tag
    out = tag - HUBS_M[ride] if ride else np.tile(AXLES[0], (len(booth), 1))
    ahead = np.arctan2(out[:, 1], out[:, 0])
    table = pd.DataFrame(
        np.hstack([tag, BOOTHS_M[booth]]),
        columns=[f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"],
    )
    return table.assign(
        ride=ride,
        spin_rad_per_s=spin,
        true_range_m=np.sqrt((off**2).sum(axis=1)),
        azimuth_deg=np.degrees(np.arctan2(off[:, 1], off[:, 0]) - ahead) % 360.0,
        link=[f"ride {number} past booth {one}" for one in booth],
        tx=f"gondola{rng.integers(GONDOLAS)}",
        rx=[f"booth{one}" for one in booth],
        environment=RIDES[ride],
        time_s=begin_s + since_s,
        temperature_c=rng.uniform(-3.0, 34.0) + rng.triangular(-1.5, 0.0, 1.5, len(booth)),
        channel=1,
        prf_mhz=16.0,
    )


def _seat(rng: np.random.Generator, ride: int) -> Floats:
    """Return a place in a gondola of a ride [3], in m."""
    axle = AXLES[ride]
    flat = np.cross(axle, (0.0, 0.0, 1.0) if ride == 0 else (0.0, 1.0, 0.0))
    flat /= np.linalg.norm(flat)
    turn = rng.uniform(0, 2 * np.pi)
    arm = np.cos(turn) * flat + np.sin(turn) * np.cross(axle, flat)
    return np.asarray(
        HUBS_M[ride] + rng.uniform(0.94, 1.0) * RADII_M[ride] * arm + rng.uniform(-0.4, 0.4) * axle
    )


def _between(rng: np.random.Generator, links: pd.Series, steel: float) -> list[list[str]]:
    """Return what stands in straight paths: a wagon of steel, parts of rides, or nothing."""
    number, names = pd.factorize(links)
    luck = rng.random((len(names), 1 + len(BARRIERS)))
    found = [
        [kind for kind, u in zip(BARRIERS, one, strict=True) if u < 0.17] for one in luck[:, 1:]
    ]
    some = [["metal"] if luck[k, 0] < steel else found[k] for k in range(len(names))]
    return [some[k] for k in number.tolist()]


def on_the_meadow(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, and a little less past people far off [n]."""
    way = rows["true_range_m"].to_numpy(np.float64)
    return np.asarray(-58.2 - 20.0 * np.log10(way) - 0.8 * np.square(way / 40.0))


def _rung_up(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the fairground's own radio."""
    size, (number, links) = len(rows), pd.factorize(rows["link"])
    level = on_the_meadow(rows) + rng.triangular(-2.6, 0.0, 2.6, len(links))[number]
    level = level + rng.logistic(0.0, 0.22, size)
    error = scatter * rng.logistic(0.0, 0.0135, size)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.3 - 1.1 * rng.beta(1.3, 3.0, size) * 2.0,
        noise_std=84.0 / np.sqrt(rng.chisquare(500.0, size) / 500.0),
        preamble_count=1015.0 - rng.negative_binomial(6, 0.5, size),
    )


def _dealt(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([983, side, seed])
    metres = np.zeros((len(drawn.hidden), len(table)))
    for k in sorted(range(len(metres)), key=lambda k: _turn_of(drawn.hidden[k])):
        ticket = Ticket(table, seed, rng, drawn.rare != "")
        stall = EFFECTS[drawn.hidden[k]](ticket, drawn.strength)
        metres[k], table = stall.metres, _changed(table, stall)
    return table, metres


def _turn_of(name: str) -> int:
    """Return when something is dealt out: what is about written ranges last."""
    return 1 + WRITTEN_LAST.index(name) if name in WRITTEN_LAST else 0


def _changed(table: pd.DataFrame, stall: Stall) -> pd.DataFrame:
    """Return the table with what is dealt out to its rows."""
    signal, first = stall.db("signal"), stall.db("first")
    error = table["error_m"] + stall.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + signal + 0.6 * first,
        first_path_power_dbm=table["first_path_power_dbm"] + signal + first,
        noise_std=table["noise_std"] * 10 ** (stall.db("hiss") / 20),
        preamble_count=table["preamble_count"] * 10 ** (stall.db("count") / 20),
    )
