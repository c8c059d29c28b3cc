"""The brewery's radio with its impulse responses: rows of `brewery`, tanks that return.

numpy and pandas alone; what can be hidden is in `brewery_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import brewery
from bench.challenge.families.brewery_receiver import (
    METRES,
    OF_NOISE,
    TICKS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Tap,
    bells,
    budgets,
    rustle,
    slopes,
)
from bench.challenge.families.brewery_wave_effects import LAWS, OF_RANGES, WAVES, pour
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 15, 116
ROUNDS = (1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5, 5, 6)
FULL_DB = 117.0  # of levels
EARLY = 1.45  # samples by which clean pulses are timed before their tops, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in brewery.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the brewery's own."""
    rng = np.random.default_rng([879, seed])
    rows = brewery.part_of(_errands(rng), 0 if drawn.same_mix else -1)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = brewery.part_of(_errands(rng), 0 if drawn.same_mix else 1)
        rows["link"] = rows["link"].radd("rehearsed ")
    often = pd.concat([rows for _ in range(drawn.ratio)]).reset_index(drop=True)
    model, true = received(often, rng), received(often, rng)
    four = (conceal(clean, drawn, seed), clean, model, conceal(true, drawn, seed))
    found, plain, drafted, truth = (brewery.public(_record(one), drawn.listed) for one in four)
    return Tables(found, plain, drafted, truth)


def _errands(rng: np.random.Generator) -> pd.DataFrame:
    return brewery.errands(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _errands(np.random.default_rng([879, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    tap = Tap(table, seed, np.random.default_rng([len(table), seed, 876]))
    pour(tap, drawn.hidden, drawn.strength)
    out = tap.put_down()
    return out if drawn.listed else out.drop(columns=["obstacles"])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is put down: SAMPLES sizes from LEAD before the first path."""
    return brewery.public(_record(table), listed=True)


def _record(table: pd.DataFrame) -> pd.DataFrame:
    index = np.array(table["first_path_index"], np.float64)
    begin = np.clip(index.astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    i, q = (np.vstack(table[name].to_list()).astype(float) for name in ("cir_i", "cir_q"))
    sizes = np.take_along_axis(np.sqrt(i * i + q * q), begin[:, None] + np.arange(SAMPLES), axis=1)
    out = table.drop(columns=["cir_i", "cir_q"])
    out["cir"] = list(sizes.astype(np.float32))
    out["first_path_index"] = index - begin
    return out


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the brewery's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + 1.5 + rng.uniform(0, 1, size)
    symbols = 248.0 - rng.binomial(14, 0.3, size)
    sigma = 54.0 + rng.normal(0, 1.5, size)
    full = symbols * np.power(10.0, FULL_DB / 20)
    cir = full[:, None] * _in_the_cellar(rows, top, rng) + sigma[:, None] * rustle(rng, size)
    index = slopes(cir, sigma)
    error = METRES * (index - top + EARLY) + 0.012 * (rng.beta(2.5, 2.5, size) - 0.5) * 4
    level, first = budgets(cir, index, sigma) - 20 * np.log10(full)
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error)
    out["rx_power_dbm"], out["first_path_power_dbm"] = level, first
    out["first_path_index"], out["sample_period_ns"] = index, 1.0016
    out["noise_std"], out["preamble_count"] = OF_NOISE * sigma, symbols
    return out.assign(cir_i=list(cir.real), cir_q=list(cir.imag))


def _in_the_cellar(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by tanks about, and from pipes."""
    size = len(rows)
    names, back = np.unique(rows["link"].to_numpy(str), return_inverse=True)
    tank = rows["obstacles"].apply(lambda row: float("metal" in row)).to_numpy(np.float64)
    straight = 1 - tank * rng.uniform(0.1, 0.42, names.size)[back]
    cir = (straight * _phases(rng, size))[:, None] * bells(top)
    late = np.full(names.size, 3.9)
    for _ in range(7):  # tanks return what they do one behind the other
        late = late + rng.exponential(4.5, names.size)
        share = rng.rayleigh(0.2, names.size) * np.exp(-late / 26.0)
        cir = cir + (share[back] * _phases(rng, size))[:, None] * bells(top + late[back])
    since = TICKS - top[:, None] - 2
    pipes = rng.uniform(0.02, 0.05, names.size)[back, None] * np.exp(-np.maximum(since, 0) / 22.0)
    level = brewery.over_tiles(rows) + rng.triangular(-2.6, 0, 2.6, names.size)[back] - 4.4
    rough = pipes * (since > 0) * rustle(rng, size)
    return np.asarray(np.power(10.0, level / 20)[:, None] * (cir + rough))


def _phases(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
