"""The bakery's radio with its impulse responses: rows of `bakery`, in a room that rings on.

numpy and pandas alone; what can be hidden is in `bakery_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import bakery
from bench.challenge.families.bakery_tuner import (
    AHEAD,
    METRES,
    OF_NOISE,
    TICK,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Tuned,
    crests,
    fronts,
    gauges,
    hum,
)
from bench.challenge.families.bakery_wave_effects import LAWS, OF_RANGES, WAVES, happen
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 15, 158
ROUNDS = (1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 5, 5, 5)
FULL_DB = 116.0  # of levels
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in bakery.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the bakery's own."""
    rng = np.random.default_rng([921, 2, seed])
    rows = _batches(rng)
    rows = rows if drawn.same_mix else bakery.parted(rows, 1.0)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = _batches(rng)
        rows = rows if drawn.same_mix else bakery.parted(rows, -1.0)
        rows["link"] = "on paper " + rows["link"]
    rows = rows.loc[list(rows.index) * drawn.ratio].reset_index(drop=True)
    simulated, again = (received(rows, rng) for _ in range(2))
    found, truth = (_tuned(one, drawn, seed) for one in (clean, again))
    shown = [_sold(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(shown[0], shown[1], shown[2], shown[3])


def _batches(rng: np.random.Generator) -> pd.DataFrame:
    return bakery.batches(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _batches(np.random.default_rng([921, 2, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    out = _tuned(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _tuned(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    tuned = Tuned(table, seed, np.random.default_rng([925, seed, len(table)]))
    happen(tuned, drawn.hidden, drawn.strength)
    return tuned.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _sold(table, listed=True)


def _sold(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = np.asarray(table["first_path_index"], np.float64)
    begin = np.clip(index.astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = [
        np.hypot(i[at : at + SAMPLES], q[at : at + SAMPLES]).astype(np.float32)
        for i, q, at in zip(table["cir_i"], table["cir_q"], begin.tolist(), strict=True)
    ]
    out = bakery.sold(table.drop(columns=["cir_i", "cir_q"]), listed)
    return out.assign(cir=sizes, first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the bakery's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + AHEAD + rng.random(size)
    symbols = 253.0 - rng.poisson(2.5, size)
    sigma = 72.0 * np.exp(rng.uniform(-0.05, 0.05, size))
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _in_the_house(rows, top, rng) + sigma[:, None] * hum(rng, size)
    index = fronts(cir, sigma)
    error = METRES * (index + AHEAD - top) + 0.011 * rng.standard_normal(size)
    level, first = gauges(cir, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        cir_i=list(cir.real),
        cir_q=list(cir.imag),
    )


def _in_the_house(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, in clusters of rays, and what rings on.

    Clusters and rays in them fade exponentially (Saleh and Valenzuela 1987).
    """
    size, (number, names) = len(rows), pd.factorize(rows["link"])
    links = len(names)
    steel = np.array([float("metal" in some) for some in rows["obstacles"]])
    straight = 1 - steel * rng.uniform(0.1, 0.4, links)[number]
    cir = (straight * _phases(rng, size))[:, None] * crests(top)
    begin = np.full(links, 4.5)
    for _ in range(3):
        begin = begin + rng.exponential(9.0, links).clip(0.0, 30.0)
        ray = begin + rng.exponential(2.0, links)
        for _ in range(3):
            share = 0.25 * np.exp(-begin / 26.0 - (ray - begin) / 7.0) * rng.rayleigh(0.8, links)
            cir = cir + (share[number] * _phases(rng, size))[:, None] * crests(top + ray[number])
            ray = ray + rng.exponential(3.5, links).clip(0.0, 14.0)
    past = TICK - top[:, None] - 3
    rings = rng.uniform(0.012, 0.035, links)[number, None] * np.exp(-np.maximum(past, 0) / 38.0)
    level = bakery.in_the_house(rows) + rng.uniform(-1.9, 1.9, links)[number] - 3.8
    heard = cir + np.where(past > 0, rings, 0.0) * hum(rng, size)
    return np.asarray(10 ** (0.05 * level)[:, None] * heard)


def _phases(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
