"""The garage's radio with its impulse responses: rows of `garage`, cars and pillars that scatter.

numpy and pandas alone; what can be hidden is in `garage_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import garage
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.garage_cars import Visit
from bench.challenge.families.garage_key import (
    AT,
    METRES,
    OF_NOISE,
    TOP,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Key,
    meters,
    onsets,
    secants,
    simmer,
)
from bench.challenge.families.garage_wave_effects import LAWS, OF_RANGES, WAVES, meet_all

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 12, 98
BLOCKS = (1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 10)
FULL_DB = 115.0  # of levels
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in garage.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the garage's own."""
    rng = np.random.default_rng([1045, seed])
    rows = garage.apart(garage.visits(rng, "", BLOCKS), drawn, 1.0)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = garage.apart(garage.visits(rng, "", BLOCKS), drawn, -1.0)
        rows["link"] = "next day " + rows["link"]
    rows = rows.loc[[*rows.index] * drawn.ratio].reset_index(drop=True)
    simulated = received(rows, rng)
    truth = _met(received(rows, rng), drawn, seed)
    return Tables(
        recorded=_cut(_met(clean, drawn, seed), drawn.listed),
        clean=_cut(clean, drawn.listed),
        simulated=_cut(simulated, drawn.listed),
        truth=_cut(truth, drawn.listed),
    )


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return garage.visits(np.random.default_rng([1045, seed]), "", BLOCKS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    out = _met(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _met(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    key = Key(table, seed, np.random.default_rng([1046, seed, len(table)]))
    meet_all(key, drawn.hidden, drawn.strength)
    return key.read()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut(table, listed=True)


def _cut(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    first = np.minimum(np.maximum(np.floor(index) - LEAD, 0), WIDE_SAMPLES - SAMPLES)
    sizes = [
        np.hypot(i[k : k + SAMPLES], q[k : k + SAMPLES]).astype(np.float32)
        for i, q, k in zip(table["cir_i"], table["cir_q"], first.astype(int), strict=True)
    ]
    bare = garage.seen(table.drop(columns=["cir_i", "cir_q"]), listed)
    return bare.assign(cir=sizes, first_path_index=index - first)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the garage's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + TOP + rng.random(size)
    symbols = 254.0 - np.floor(6.0 * rng.random(size) ** 2)
    sigma = 66.0 * (1 + 0.13 * (rng.beta(2.0, 4.0, size) - 1 / 3))
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _between_walls(rows, top, rng) + sigma[:, None] * simmer(rng, size)
    index = onsets(cir, sigma)
    error = METRES * (index + TOP - top) + rng.laplace(0.0, 0.0055, size)
    level, first = meters(cir, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        cir_i=[*cir.real],
        cir_q=[*cir.imag],
    )


def _between_walls(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off cars and pillars, and what is left.

    Each echo is half as likely to be there as not.
    """
    visit, size = Visit(rows, 0, rng), len(rows)
    body = visit.past("metal") * visit.each_link(rng.uniform, 0.58, 0.86)
    cir = ((1 - body) * _whirled(rng, size))[:, None] * secants(top)
    for _ in range(11):
        late = 4.4 + visit.each_link(rng.weibull, 0.95) * 15.0
        there = visit.each_link(rng.uniform, 0.0, 1.0) < 0.5
        share = there * 0.52 * (1 + late / 10.0) ** -0.9 * visit.each_link(rng.uniform, 0.3, 1.0)
        cir = cir + (share * _whirled(rng, size))[:, None] * secants(top + np.minimum(late, 90.0))
    past = AT - top[:, None] - 2.0
    left = visit.each_link(rng.uniform, 0.025, 0.06)[:, None] / (1 + np.exp((past - 12.0) / 11.0))
    whole = cir + np.where(past > 0, left, 0.0) * simmer(rng, size)
    level = garage.between_cars(rows) + visit.each_link(rng.triangular, -2.4, 0.0, 2.4)
    return np.asarray(np.power(10.0, (level - 3.9) / 20)[:, None] * whole)


def _whirled(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(0.0, 2 * np.pi, size)))
