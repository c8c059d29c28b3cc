"""Cars that brake into their places on a ferry, ranged from pillars of steel: ranges and levels.

numpy and pandas alone; what it can hide is in `ferry_effects`, its waveforms in `ferry_waves`.
No room is known, but the channel is. Lanes of cars weaken what crosses them; a sailing has from
one to eight rounds.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.ferry_deck import (
    BETWEEN,
    COURSE,
    DECK_M,
    LANE_M,
    LANES_M,
    LAWS,
    PILLARS_M,
    TAGS,
    Lading,
    Swell,
)
from bench.challenge.families.ferry_effects import EFFECTS

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 2, 2, 3, 3, 4, 4, 5, 6, 6, 7, 8, 8)  # of sailings, in any order
ROUND_S, CALL_S = 0.62, 0.043
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
    "tyres-insulate": "cars_aboard",
    "ballast-pumped": "time_s",
    "ramp-let-down": "ramp_deg",
    "soaked-tarpaulin": "wet_minutes",
    "spray-on-lenses": "wind_m_per_s",
    "shore-power": "supply_v",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
WRITTEN = ("two-ranges-averaged", "yards-from-one-pillar", "range-rounding")
SCARCE = 0.06


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the ferry's own."""
    rng = np.random.default_rng([771, seed])
    rows = berthed(sailings(rng, drawn.rare), 0 if drawn.same_mix else -1)
    clean = _called(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = berthed(sailings(rng, drawn.rare), 0 if drawn.same_mix else 1)
        rows["link"] = "drawn up: " + rows["link"]
    simulated = _called(pd.concat([rows] * drawn.ratio, ignore_index=True), rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, simulated)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return sailings(np.random.default_rng([771, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _at_sea(clean, drawn, seed, 1)
    truth = _at_sea(simulated, drawn, seed, 2)[0]
    four = (recorded, clean, simulated, truth)
    found, plain, model, true = (ashore(one, drawn.listed) for one in four)
    return Tables(found, plain, model, true, shifts)


def ashore(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how cars brake, and what stands between unless listed."""
    kept = [n for n in table if n not in COURSE and (listed or n != "obstacles")]
    return table[kept].copy()


def sailings(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a week: sailings, some of cars that stand."""
    count = len(rounds)
    many = rng.permutation(rounds)
    stands = np.isin(np.arange(count), rng.permutation(count)[:4])
    if rare == "exchange-motion":  # two short sailings alone have a car that still moves
        stands = ~np.isin(np.arange(count), np.flatnonzero((many > 1) & (many < 5))[:2])
    begins = np.sort(rng.uniform(0, 7 * 3600, count))
    parts = [_sailing(rng, n, int(many[n]), begins[n], bool(stands[n])) for n in range(count)]
    table = pd.concat(parts, ignore_index=True)
    size = len(table)
    table["reply_time_s"] = 0.004 + 0.09 * rng.beta(1.3, 2.6, size)
    table["ramp_deg"] = rng.uniform(-11.0, 3.0, size)
    table["wet_minutes"] = rng.exponential(22.0, size)
    table["wind_m_per_s"] = np.minimum(9.0 * rng.weibull(1.8, size), 24.0)
    table["supply_v"] = 18.0 + 38.0 * rng.beta(0.9, 1.3, size)
    table["obstacles"] = _blocks(rng, table["link"], SCARCE if rare == "diffraction" else 0.16)
    return table


def berthed(rows: pd.DataFrame, side: int) -> pd.DataFrame:
    """Return all rows for 0, or mostly those of near links for -1, of far ones for 1."""
    if not side:
        return rows.copy()
    order = (side * -rows.groupby("link", sort=False)["true_range_m"].mean()).sort_values().index
    chance = np.clip(1.25 - 1.35 * np.linspace(0, 1, len(order)), 0.03, 1)
    even = np.mod(0.61803398875 * np.arange(len(order)), 1)  # and not of chance
    return rows[rows["link"].isin(order[even < chance])].reset_index(drop=True)


def _sailing(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one sailing: round after round, all pillars call the tag of a car."""
    pillar = np.tile(np.arange(len(PILLARS_M)), rounds)
    when = np.repeat(np.arange(rounds) * ROUND_S, len(PILLARS_M)) + CALL_S * pillar
    left, brakes = _brakes(rng, when, stands)
    here = np.column_stack([_place(rng) - left, 0 * when, 0 * when])
    here[:, 1:] = rng.choice(LANES_M) + rng.normal(0, 0.2), rng.uniform(1.1, 1.9)
    way = PILLARS_M[pillar] - here
    table = pd.DataFrame(
        {
            "link": [f"sailing {number} to pillar {one}" for one in pillar],
            "tx": f"tag{rng.integers(TAGS)}",
            "rx": [f"pillar{one}" for one in pillar],
            "environment": "fore deck" if here[0, 0] > DECK_M[0] / 2 else "aft deck",
            "time_s": begin_s + when,
            "true_range_m": np.sqrt(np.square(way).sum(axis=1)),
            "azimuth_deg": np.degrees(np.arctan2(way[:, 1], way[:, 0])) % 360.0,
            "temperature_c": rng.uniform(8, 33) + rng.normal(0, 1.3, len(when)),
            "cars_aboard": float(rng.integers(2, 88)) + rng.integers(-2, 3, len(when)),
            "channel": 5,
            "prf_mhz": 64.0,
            "left_m": left,
            "brakes_s": brakes,
        }
    )
    named = {f"tx_{axis}_m": here[:, k] for k, axis in enumerate("xyz")}
    return table.assign(**named, **{f"rx_{a}_m": PILLARS_M[pillar, k] for k, a in enumerate("xyz")})


def _place(rng: np.random.Generator) -> float:
    return float(rng.uniform(16.0, DECK_M[0] - 16.0))


def _brakes(rng: np.random.Generator, when: Floats, stands: bool) -> tuple[Floats, Floats]:
    """Return what cars still have to go, from either ramp, in m and how fast it goes, in s [n]."""
    to_go = 0.0 if stands else rng.choice([-1.0, 1.0]) * rng.uniform(4.0, 13.0)
    brakes = rng.uniform(3.0, 6.5)
    return to_go * np.exp(-when / brakes), np.full(len(when), brakes)


def _blocks(rng: np.random.Generator, links: pd.Series, vans: float) -> pd.Series:
    """Return what stands in the straight path: a van of steel, windows, crates, or nothing."""
    met: dict[str, list[str]] = {}
    for link in links.unique():
        if rng.random() < vans:
            met[link] = ["metal"]
        else:
            met[link] = [kind for kind in BETWEEN if rng.random() < 0.13]
    return links.map(met)


def between_decks(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: steel holds it together, each lane of cars takes some of it [n]."""
    far = rows["true_range_m"].to_numpy(np.float64)
    lanes = (rows["tx_y_m"] - rows["rx_y_m"]).abs().to_numpy(np.float64) / LANE_M
    return np.asarray(-63.0 - 16.5 * np.log10(far) - 0.55 * lanes)


def _called(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the ferry's own radio."""
    size, codes = len(rows), rows.groupby("link", sort=False).ngroup().to_numpy()
    level = between_decks(rows) + rng.triangular(-2.0, 0.0, 2.0, codes.max() + 1)[codes]
    level += 20 * np.log10(1 + 0.08 * rng.standard_normal(size).clip(-3, 3))
    error = 0.0062 * scatter * (rng.gamma(12.0, 1.0, size) - 11.67)  # a little later than sooner
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error, rx_power_dbm=level)
    out["first_path_power_dbm"] = level - 1.2 - 0.9 * rng.chisquare(2.0, size)
    out["noise_std"] = 96.0 + 3.1 * rng.standard_normal(size)
    return out.assign(preamble_count=np.rint(493 - 3 * rng.chisquare(2.0, size)))


def _at_sea(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([773, side, seed])
    shifts = np.zeros((len(drawn.hidden), len(table)))
    for name in (*_except(drawn.hidden, WRITTEN), *WRITTEN):
        if name in drawn.hidden:
            swell = EFFECTS[name](Lading(table, seed, rng, bool(drawn.rare)), drawn.strength)
            shifts[drawn.hidden.index(name)] = swell.metres
            table = _swollen(table, swell)
    return table, shifts


def _except(names: tuple[str, ...], others: tuple[str, ...]) -> list[str]:
    return [name for name in names if name not in others]


def _swollen(table: pd.DataFrame, swell: Swell) -> pd.DataFrame:
    """Return the table with what comes over its rows."""
    error = table["error_m"].to_numpy() + swell.metres
    edge = swell.whole + np.asarray(swell.edge)
    whole = swell.whole + 0.65 * np.asarray(swell.edge)
    changed = {
        "error_m": error,
        "range_m": table["true_range_m"] + error,
        "first_path_power_dbm": table["first_path_power_dbm"] + edge,
        "rx_power_dbm": table["rx_power_dbm"] + whole,
        "noise_std": table["noise_std"] * np.exp(np.log(10) / 20 * np.asarray(swell.hiss)),
        "preamble_count": table["preamble_count"]
        * np.exp(np.log(10) / 20 * np.asarray(swell.count)),
    }
    return table.assign(**changed)
