"""Hides on the hoists of a tannery, ranged from purlins of its roof: ranges and levels.

numpy and pandas alone; what it can hide is in `tannery_effects`, its waveforms in
`tannery_waves`. The shed and the channel are known. A haul has from one to seven rounds.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.tannery_effects import EFFECTS
from bench.challenge.families.tannery_floor import (
    HAUL,
    HOISTS,
    LAWS,
    PURLINS_M,
    ROPE_RAD_PER_S,
    SHED_M,
    SHIFT_S,
    SOAKED,
    Dye,
    Lot,
)

Floats = NDArray[np.float64]
ROUNDS = (1, 2, 2, 3, 3, 4, 4, 5, 6, 7, 7, 7)  # of hauls, in any order
ROUND_S, ASKED_S = 0.36, 0.023
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
    "hides-soaked": "moisture_percent",
    "drums-reverse": "time_s",
    "drying-loft-opened": "flap_deg",
    "lime-cakes": "lime_g",
    "tallow-on-domes": "tallow_ml",
    "liquor-rises": "liquor_cm",
    "span-wires-slack": "tension_kn",
    "ropes-stretch": "load_kg",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
FINISH = ("weak-edges-corrected", "feet-from-one-purlin", "range-rounding")
DOORS, FEW_DOORS = 0.19, 0.05  # of links


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the tannery's own."""
    rng = np.random.default_rng([seed, 891])
    rows = hauls(rng, drawn.rare)
    rows = rows if drawn.same_mix else of_one_end(rows, nearer=True)
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = hauls(rng, drawn.rare)
        rows = rows if drawn.same_mix else of_one_end(rows, nearer=False)
        rows = rows.assign(link="of another week, " + rows["link"])
    model = _ranged(over_again(rows, drawn.ratio), rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, model)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return hauls(np.random.default_rng([seed, 891]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, metres = _dyed(clean, drawn, seed, np.random.default_rng([seed, 0, 893]))
    truth, _ = _dyed(simulated, drawn, seed, np.random.default_rng([seed, 1, 893]))
    listed = drawn.listed
    return Tables(
        told(found, listed), told(clean, listed), told(simulated, listed), told(truth, listed),
        metres,
    )  # fmt: skip


def told(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how hides are hauled, and what stands between unless listed."""
    return table.drop(columns=[*HAUL] if listed else [*HAUL, "obstacles"])


def over_again(rows: pd.DataFrame, times: int) -> pd.DataFrame:
    """Return the rows one after the other, so many times."""
    return rows.iloc[np.tile(np.arange(len(rows)), times)].reset_index(drop=True)


def of_one_end(rows: pd.DataFrame, nearer: bool) -> pd.DataFrame:
    """Return rows of the nearer half of the links and a third of the others, or of the farther."""
    mean_m = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=nearer)
    half = len(mean_m) // 2
    kept = [*mean_m.index[:half], *mean_m.index[half::3]]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def hauls(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a day: hauls, in some of which a hoist stands still."""
    many = rng.permutation(rounds)
    halts = set(rng.choice(len(many), 4, replace=False).tolist())
    if rare == "exchange-motion":  # all halt but two short ones
        halts = set(range(len(many))) - set(np.flatnonzero((many > 1) & (many < 4))[:2].tolist())
    starts_s = np.sort(SHIFT_S * rng.random(len(many)))
    table = pd.concat(
        [_haul(rng, k, int(many[k]), starts_s[k], k in halts) for k in range(len(many))],
        ignore_index=True,
    )
    size = len(table)
    return table.assign(
        reply_time_s=rng.triangular(0.003, 0.018, 0.082, size),
        moisture_percent=70.0 * rng.beta(1.1, 1.3, size),
        flap_deg=rng.uniform(0.0, 80.0, size),
        lime_g=rng.weibull(1.1, size) * 75.0,
        tallow_ml=rng.exponential(22.0, size),
        liquor_cm=rng.uniform(0.0, 110.0, size),
        tension_kn=rng.uniform(0.7, 4.5, size),
        load_kg=300.0 * rng.beta(1.0, 1.0, size),
        obstacles=pd.Series(
            _in_the_way(rng, table["link"], FEW_DOORS if rare == "diffraction" else DOORS)
        ),
    )


def _haul(
    rng: np.random.Generator, number: int, rounds: int, start_s: float, halts: bool
) -> pd.DataFrame:
    """Return one haul: round after round, all purlins ask the tag on a bundle of hides."""
    step, purlin = np.divmod(np.arange(rounds * len(PURLINS_M)), len(PURLINS_M))
    since_s = ROUND_S * step + ASKED_S * purlin
    carried = _carried(rng, since_s, halts)
    hides = np.stack([carried[f"tx_{axis}_m"] for axis in "xyz"], axis=1)
    toward = PURLINS_M[purlin] - hides
    bearing = np.arctan2(toward[:, 1], toward[:, 0]) - carried["course_rad"]
    warm = rng.triangular(5.0, 19.0, 44.0)
    side = "beamhouse" if hides[0, 1] < 0.45 * SHED_M[1] else "tanyard"
    sizes = dict(zip(("room_x_m", "room_y_m", "room_z_m"), SHED_M, strict=True))
    ends = {f"rx_{axis}_m": PURLINS_M[purlin, k] for k, axis in enumerate("xyz")}
    return pd.DataFrame({**carried, **ends}).assign(
        true_range_m=np.linalg.norm(toward, axis=1),
        azimuth_deg=np.rad2deg(bearing) % 360.0,
        link=[f"haul {number} asked by purlin {one}" for one in purlin],
        tx=f"hoist{rng.integers(HOISTS)}",
        rx=[f"purlin{one}" for one in purlin],
        environment=side,
        time_s=start_s + since_s,
        temperature_c=warm + rng.normal(0, 0.8, len(step)),
        channel=1,
        prf_mhz=64.0,
        **sizes,
    )


def _carried(rng: np.random.Generator, since_s: Floats, halts: bool) -> dict[str, Floats]:
    """Return how hides are carried along a rail, swinging to and fro, and where their tag is."""
    pace = 0.0 if halts else rng.uniform(0.55, 1.5)
    swing = 0.0 if halts else rng.uniform(0.02, 0.09)
    phase = rng.uniform(0, 2 * np.pi) + ROPE_RAD_PER_S * since_s
    course = rng.choice([0.5, -0.5, 0.5, -0.5, 0.0, 1.0]) * np.pi + 0.03 * rng.normal()
    gone = pace * since_s + swing * (np.sin(phase) - np.sin(phase[0]))
    x, y = rng.uniform(4.0, SHED_M[0] - 4.0), rng.uniform(4.2, SHED_M[1] - 4.2)
    same = np.ones(len(since_s))
    return {
        "course_rad": course * same,
        "pace_m_per_s": pace * same,
        "swing_m": swing * same,
        "swing_rad": phase,
        "tx_x_m": x + np.cos(course) * gone,
        "tx_y_m": y + np.sin(course) * gone,
        "tx_z_m": rng.uniform(0.9, 2.5) * same,
    }


def _in_the_way(rng: np.random.Generator, links: pd.Series, doors: float) -> list[list[str]]:
    """Return what stands in straight paths: a door of steel, something soaked, or nothing."""
    found: dict[str, list[str]] = {}
    for link in links:
        if link not in found:
            door, chance = rng.random() < doors, rng.random(len(SOAKED))
            soaked = [kind for kind, one in zip(SOAKED, chance, strict=True) if one < 0.17]
            found[link] = ["metal"] if door else soaked
    return [found[link] for link in links]


def below_the_roof(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: a little more than in the open far along the shed [n]."""
    far = rows["true_range_m"].to_numpy(np.float64)
    return np.asarray(-59.1 - 19.2 * np.log10(far) - 0.9 * np.cos(far / 3.1))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the tannery's own radio."""
    size, codes = len(rows), rows["link"].astype("category").cat.codes.to_numpy()
    level = below_the_roof(rows) + rng.logistic(0, 0.7, int(codes.max()) + 1)[codes]
    level = level + rng.normal(0, 0.4, size)
    error = scatter * (0.012 * rng.standard_normal(size) + 0.022 * rng.triangular(-1, 0, 1, size))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.5 - rng.weibull(1.4, size),
        noise_std=74.0 * (1 + 0.03 * rng.standard_normal(size)),
        preamble_count=510.0 - rng.binomial(20, 0.3, size),
    )


def _dyed(
    table: pd.DataFrame, drawn: Draw, seed: int, rng: np.random.Generator
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    metres = np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: FINISH.index(one) if one in FINISH else -1):
        dye = EFFECTS[name](Lot(table, seed, rng, bool(drawn.rare)), drawn.strength)
        metres[drawn.hidden.index(name)] = dye.metres
        table = _with(table, dye)
    return table, metres


def _with(table: pd.DataFrame, dye: Dye) -> pd.DataFrame:
    """Return the table with what its rows are dyed with."""
    error = table["error_m"] + dye.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + (dye.whole + 0.6 * np.asarray(dye.edge)),
        first_path_power_dbm=table["first_path_power_dbm"] + (dye.whole + np.asarray(dye.edge)),
        noise_std=table["noise_std"] * np.power(10.0, np.asarray(dye.hiss) / 20),
        preamble_count=table["preamble_count"] * np.power(10.0, np.asarray(dye.count) / 20),
    )
