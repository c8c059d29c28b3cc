"""Crawlers under a steep roof, ranged from tags on beams: ranges and levels, no CIR.

numpy and pandas alone; what it can hide is in `attic_effects`, its waveforms in `attic_waves`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.attic_effects import (
    BEAMS_M,
    CRAWLERS,
    EFFECTS,
    HOUSE_M,
    LAWS,
    LAYERS,
    STEERING,
    Slate,
    Toll,
)
from bench.challenge.families.case import Draw, Tables

Floats = NDArray[np.float64]
CRAWLS, ROUNDS, ROUND_S = 16, 4, 0.9
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
    "swollen-timber": "damp_pct",
    "rain-on-slates": "rain_mm_h",
    "fan-shakes": "fan_rpm",
    "wool-spread": "wool_cm",
}
RARELY = ("diffraction", "blocked-path", "time-lag")
AFTER_ALL = ("decimetres-from-one-beam", "no-less-than", "rows-exchanged", "range-rounding")


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the attic's own."""
    rng = np.random.default_rng([511, seed])
    rows = part_of(crawled(rng, drawn.rare), "" if drawn.same_mix else "near")
    clean = _heard(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = part_of(crawled(rng, drawn.rare), "" if drawn.same_mix else "far")
        rows["link"] = "sketch of " + rows["link"]
    made = (_heard(rows, rng, drawn.scatter) for _ in range(drawn.ratio))
    return hidden_in(drawn, seed, clean, pd.concat(list(made), ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return crawled(np.random.default_rng([511, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, tolls = _paid(clean, drawn, seed, "recorded")
    truth, _ = _paid(simulated, drawn, seed, "truth")
    shifts = np.array([toll.m + np.zeros(len(clean)) for toll in tolls])
    found, clean, simulated, truth = (
        public(one, drawn.listed) for one in (found, clean, simulated, truth)
    )
    return Tables(found, clean, simulated, truth, shifts.reshape(len(tolls), len(clean)))


def public(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how crawlers are steered, and without what is not listed."""
    hidden = (*STEERING, "obstacles")[: len(STEERING) + (not listed)]
    return table.drop(columns=[name for name in hidden if name in table])


def crawled(
    rng: np.random.Generator, rare: str, rounds: int = ROUNDS, crawls: int = CRAWLS
) -> pd.DataFrame:
    """Return what is known of the rows: crawls in arcs, or at rest, that all beams range."""
    begun_s, parts = 0.0, []
    for number in range(crawls):
        begun_s += rng.uniform(120, 900)
        rests = number % 8 != 3 if rare == "time-lag" else rng.random() < 0.25
        parts.append(_crawl(rng, number, rounds, begun_s, rests))
    table = pd.concat(parts, ignore_index=True)
    size = len(table)
    table["reply_time_s"] = 0.002 + rng.gamma(1.8, 0.021, size)
    table["fan_rpm"] = 1900 * rng.power(1.6, size)
    table["wool_cm"] = rng.uniform(2, 38, size)
    table["cable_out_m"] = rng.uniform(0.4, 31.0, size)
    table["obstacles"] = _within(rng, table["link"], 0.05 if rare == "diffraction" else 0.19)
    return table


def part_of(rows: pd.DataFrame, which: str) -> pd.DataFrame:
    """Return all rows, or the near or far links: two thirds of them each."""
    if not which:
        return rows
    far = rows.groupby("link")["true_range_m"].transform("max")
    limit = float(far.quantile(0.66 if which == "near" else 0.34))
    return rows[(far < limit) == (which == "near")].reset_index(drop=True)


def _crawl(
    rng: np.random.Generator, number: int, rounds: int, begun_s: float, rests: bool
) -> pd.DataFrame:
    """Return one crawl: an arc at a steady pace below the roof, in rounds of polls."""
    step, beam = (a.ravel() for a in np.mgrid[:rounds, : len(BEAMS_M)])
    when = ROUND_S * step + 0.017 * beam
    pace, turn = (0.0 if rests else rng.uniform(0.35, 1.05)), rng.uniform(-0.55, 0.55)
    heading = rng.uniform(0, 2 * np.pi) + turn * when
    here = np.zeros((len(when), 3))
    here[:, 0] = rng.uniform(4.0, 14.5) + pace / turn * (np.sin(heading) - np.sin(heading[0]))
    here[:, 1] = rng.uniform(3.2, 5.8) - pace / turn * (np.cos(heading) - np.cos(heading[0]))
    here[:, 2] = rng.uniform(0.12, 0.6)
    way = BEAMS_M[beam] - here
    side = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - heading)
    made: dict[str, Any] = {
        "link": [f"crawl {number}, beam {one}" for one in beam],
        "tx": f"crawler{rng.integers(CRAWLERS)}",
        "rx": [f"beam{one}" for one in beam],
        "time_s": begun_s + when,
        "true_range_m": np.linalg.norm(way, axis=1),
        "azimuth_deg": (side + 180) % 360 - 180,
    }
    for axis, place in enumerate("xyz"):
        made[f"tx_{place}_m"], made[f"rx_{place}_m"] = here[:, axis], BEAMS_M[beam, axis]
        made[f"room_{place}_m"] = HOUSE_M[axis]
    made |= dict(zip(STEERING, (pace, turn, heading), strict=True))
    return pd.DataFrame(made | _under_slates(rng, when))


def _under_slates(rng: np.random.Generator, when: Floats) -> dict[str, Floats]:
    """Return how hot, damp and wet it is on a crawl."""
    sun = rng.beta(0.7, 1.1)
    warm = -4 + 49 * sun + rng.normal(0, 1.5) + 0.08 * when
    damp = 9 + 15 * rng.beta(2, 2.2) + rng.uniform(-1.0, 3.0, len(when))
    rain = rng.choice([0.0, 1.0], p=[0.3, 0.7]) * rng.weibull(0.9) * 4.5
    rain = rain * rng.lognormal(0, 0.3, len(when))
    return {"temperature_c": warm, "damp_pct": damp, "rain_mm_h": rain}


def _within(rng: np.random.Generator, links: pd.Series, iron: float) -> pd.Series:
    """Return what stands in the straight path of each link: layers, a tank, or nothing."""
    names, chances = list(LAYERS), rng.random(links.nunique())
    kinds: dict[str, list[str]] = {}
    for link, chance in zip(links.unique(), chances, strict=True):
        if chance < iron:
            kinds[link] = ["metal"]
        else:
            count = int(rng.integers(1, 3)) if chance > 0.72 else 0
            kinds[link] = [names[one] for one in rng.integers(0, len(names), count)]
    return links.map(kinds)


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the attic's own radio."""
    far, size = rows["true_range_m"].to_numpy(np.float64), len(rows)
    which, links = pd.factorize(rows["link"])
    level = -66.4 - 16.4 * np.log10(far) - rng.gamma(2.2, 0.7, len(links))[which]
    level = level + rng.laplace(0, 0.25, size)
    error = scatter * 0.011 * (rng.gamma(4.0, 1.0, size) - 4.0)
    table = rows.assign(error_m=error, range_m=far + error, rx_power_dbm=level)
    table["first_path_power_dbm"] = level - 1.2 - 1.6 * rng.beta(1.5, 2.5, size)
    table["noise_std"] = rng.uniform(78.0, 91.0, size)
    table["preamble_count"] = 1016.0 + rng.integers(-6, 7, size)
    return table


def _paid(
    table: pd.DataFrame, drawn: Draw, seed: int, part: str
) -> tuple[pd.DataFrame, list[Toll]]:
    """Return the table with the hidden effects in it, and the toll of each as listed."""
    rng, tolls = np.random.default_rng([512, seed, *part.encode()]), {}
    early = sorted(name for name in drawn.hidden if name not in AFTER_ALL)
    for name in (*early, *(name for name in AFTER_ALL if name in drawn.hidden)):
        tolls[name] = EFFECTS[name](Slate(table, seed, rng, drawn.rare == name), drawn.strength)
        table = _with_toll(table, tolls[name])
    return table, [tolls[name] for name in drawn.hidden]


def _with_toll(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table with what an effect takes or gives."""
    out = table.copy()
    out["error_m"] += toll.m
    out["range_m"] = out["true_range_m"] + out["error_m"]
    out["first_path_power_dbm"] += toll.all_db + toll.first_db
    out["rx_power_dbm"] += toll.all_db + 0.65 * toll.first_db
    out["noise_std"] *= toll.hiss
    out["preamble_count"] *= toll.symbols
    return out
