"""The hidden effects: per row the shift of the range, up to a factor. numpy only."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.generator.geometry import DEVICES, THICK_M

Floats = NDArray[np.float64]
Shape = Callable[[pd.DataFrame, np.random.Generator, bool], Floats]
LIGHT_M_PER_NS = 0.299792458


def clock(table: pd.DataFrame, rng: np.random.Generator, rare: bool) -> Floats:
    """Crystals that walk at random around an offset of their own; where rare, only the last."""
    names = [f"device {i}" for i in range(DEVICES)]
    hours = table["time_s"].to_numpy(np.float64) / 3600
    grid = np.linspace(0, max(float(hours.max()), 1e-3), 60)
    start = rng.normal(size=DEVICES)
    if rare:
        start = np.append(np.zeros(DEVICES - 1), 1.0)
    size = np.abs(start) if rare else np.ones(DEVICES)
    walk = {
        n: s + a * np.cumsum(rng.normal(0, 0.02, 60))
        for n, s, a in zip(names, start, size, strict=True)
    }
    ends = [
        np.array([np.interp(h, grid, walk[n]) for n, h in zip(table[end], hours, strict=True)])
        for end in ("tx", "rx")
    ]
    return np.asarray((ends[0] - ends[1]) * table["reply_time_s"].to_numpy(np.float64))


def antenna(table: pd.DataFrame, rng: np.random.Generator, rare: bool) -> Floats:
    """Give every device a delay; where rare, only the last."""
    delays = np.append(np.zeros(DEVICES - 1), 1.0) if rare else rng.normal(0.7, 1.0, DEVICES)
    delay = {f"device {i}": d for i, d in enumerate(delays)}
    return np.asarray(table["tx"].map(delay) + table["rx"].map(delay), np.float64)


def level_dbm(table: pd.DataFrame) -> Floats:
    """Free space at 4 GHz with -14.3 dBm radiated."""
    distance = table["true_range_m"].to_numpy(np.float64)
    return np.asarray(-14.3 - 20 * np.log10(4 * np.pi * distance * 3.9936 / LIGHT_M_PER_NS))


def power(table: pd.DataFrame, _: np.random.Generator, _rare: bool) -> Floats:
    """Bend a tabulated, skewed S-curve over the true level."""
    knots = np.array([-95, -90, -86, -82, -79, -76, -73, -70, -66, -60])
    bias = np.array([8.3, 7.3, 5.6, 3.9, 1.8, -1.2, -5.0, -7.6, -9.6, -11.0])
    out = np.interp(level_dbm(table), knots, bias)
    return np.asarray(out)


def slab(table: pd.DataFrame, _: np.random.Generator, _rare: bool) -> Floats:
    """Walls with their inner reflections: the energy-weighted delay of the echo train."""
    eps = {"concrete": 5.24, "brick": 3.91, "plasterboard": 2.73, "wood": 1.99}
    out = np.zeros(len(table))
    for row, walls in enumerate(table["obstacles"]):
        for wall in walls:
            index = np.sqrt(eps[wall])
            echo = ((index - 1) / (index + 1)) ** 4
            inner = 2 * THICK_M[wall] * index * echo / (1 - echo)
            out[row] += THICK_M[wall] * (index - 1) + inner
    return out


def temperature(table: pd.DataFrame, _: np.random.Generator, _rare: bool) -> Floats:
    """Slightly curved drift with temperature."""
    warm = table["temperature_c"].to_numpy(np.float64) - 25
    return np.asarray(warm + 0.004 * warm * np.abs(warm))


def pattern(table: pd.DataFrame, rng: np.random.Generator, rare: bool) -> Floats:
    """Put a lobe of group delay around one heading; a narrow one where rare."""
    centre, width = (0.0, 8.0) if rare else (rng.uniform(-180, 180), 1.2)
    heading = np.deg2rad(table["azimuth_deg"].to_numpy(np.float64) - centre)
    mean = 0.0 if rare else float(np.i0(width) * np.exp(-width))  # calibration took the mean out
    return np.asarray(np.exp(width * (np.cos(heading) - 1)) - mean)


def blocked(table: pd.DataFrame, rng: np.random.Generator, rare: bool) -> Floats:
    """On half of the links without sight (where rare on 6 % of all) a path by way of a wall."""
    first = table.drop_duplicates("link")
    dark = first["link"][~first["los"].astype(bool)].to_numpy()
    count = round(0.06 * len(first)) if rare else round(0.5 * len(dark))
    struck = dict.fromkeys(rng.choice(dark, count, replace=False))
    aside = {link: rng.uniform(1, 3) for link in struck}
    shift = table["link"].map(aside).fillna(0.0).to_numpy(np.float64)
    distance = table["true_range_m"].to_numpy(np.float64)
    return np.asarray(np.hypot(distance, 2 * shift) - distance)


def fringes(table: pd.DataFrame, _: np.random.Generator, _rare: bool) -> Floats:
    """Outside the library: a ripple over distance with a period of 6 m."""
    return np.asarray(np.sin(2 * np.pi * table["true_range_m"].to_numpy(np.float64) / 6.0 + 0.7))


def supply(table: pd.DataFrame, _: np.random.Generator, _rare: bool) -> Floats:
    """Outside the library: a regulator that gives way below 3.1 V."""
    sag = np.maximum(3.15 - table["supply_v"].to_numpy(np.float64), 0)
    return np.asarray(sag - sag.mean())  # calibration took the mean out


def queue(table: pd.DataFrame, _: np.random.Generator, _rare: bool) -> Floats:
    """Outside the library: one long and one short reading in alternate quarters of an hour."""
    quarter = (table["time_s"].to_numpy(np.float64) // 900).astype(int)
    return np.where(quarter % 2 == 0, 1.0, -1.0)


def rounding(table: pd.DataFrame, _: np.random.Generator, _rare: bool) -> Floats:
    """Outside the library: a firmware that rounds ranges up to a coarse grid of 0.75 m."""
    distance = table["true_range_m"].to_numpy(np.float64)
    return np.asarray(0.5 - np.mod(distance, 0.75) / 0.75)


SHAPES: dict[str, Shape] = {
    "clock-offset": clock,
    "antenna-delay": antenna,
    "power-bias": power,
    "material-delay": slab,
    "temperature-drift": temperature,
    "antenna-pattern": pattern,
    "blocked-path": blocked,
    "fringes": fringes,
    "supply": supply,
    "queue": queue,
    "rounding": rounding,
}
OUTSIDE = ("fringes", "supply", "queue", "rounding")
LIBRARY = tuple(name for name in SHAPES if name not in OUTSIDE)
# The covariate through which each acts: what a decoy is correlated with.
RESPONSIBLE = {
    "clock-offset": "reply_time_s",
    "antenna-delay": "time_s",
    "power-bias": "true_range_m",
    "material-delay": "los",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "blocked-path": "los",
    "fringes": "true_range_m",
    "supply": "supply_v",
    "queue": "time_s",
    "rounding": "true_range_m",
}
