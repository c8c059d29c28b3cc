"""The archive's radio with its impulse responses: rows of `stacks`, shelves that scatter.

numpy and pandas alone; what can be hidden is in `stacks_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import stacks
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.stacks_rack import (
    GRID,
    METRES,
    OF_NOISE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Rack,
    first_knocks,
    knocks,
    loudness,
    rustle,
)
from bench.challenge.families.stacks_wave_effects import LAWS, OF_RANGES, WAVES, put_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 11, 110
ANSWERED = 0.17  # of the polls after the first, in the mean
FULL_DB = 118.0  # of levels
LATE = 0.72  # samples by which clean pulses are timed after their middles, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in stacks.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the archive's own."""
    rng = np.random.default_rng([797, seed])
    rows = stacks.fetched(_visits(rng), "all" if drawn.same_mix else "near")
    clean = received(rows, rng)
    if not drawn.paired:
        rows = stacks.fetched(_visits(rng), "all" if drawn.same_mix else "far")
        rows = rows.assign(link="as planned, " + rows["link"])
    runs = pd.concat(drawn.ratio * [rows], ignore_index=True)
    simulated = received(runs, rng)
    truth = conceal(received(runs, rng), drawn, seed)
    found = conceal(clean, drawn, seed)
    four = (found, clean, simulated, truth)
    shown, plain, model, true = (stacks.lent(recorded(one), drawn.listed) for one in four)
    return Tables(shown, plain, model, true)


def _visits(rng: np.random.Generator) -> pd.DataFrame:
    return stacks.visits(rng, "", ANSWERED)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _visits(np.random.default_rng([797, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    rack = Rack(table, seed, np.random.default_rng([798, seed, len(table)]))
    put_through(rack, drawn.hidden, drawn.strength)
    out = rack.on_record()
    return out if drawn.listed else out.drop(columns=["obstacles"])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is put on record: SAMPLES sizes from LEAD before the first path."""
    index = np.asarray(table["first_path_index"], np.float64)
    begin = np.clip(np.trunc(index).astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    parts = (np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q"))
    sizes = np.hypot(*parts).astype(np.float32)
    shown = sizes[np.arange(len(sizes))[:, None], begin[:, None] + np.arange(SAMPLES)]
    out = stacks.lent(table.drop(columns=["cir_i", "cir_q"]), listed=True)
    return out.assign(first_path_index=index - begin, cir=[*shown])


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the archive's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    middle = WIDE_LEAD + rng.uniform(0, 1, size)
    symbols = 254.0 - rng.binomial(6, 0.35, size)
    sigma = 46.0 * rng.lognormal(0, 0.03, size)
    air = _arrives(rows, middle, rng) * (symbols * 10 ** (FULL_DB / 20))[:, None]
    cir = air + sigma[:, None] * rustle(rng, size)
    index = first_knocks(cir, sigma)
    error = METRES * (index - middle - LATE) + 0.012 * rng.normal(size=size)
    level, first = loudness(cir, index) - FULL_DB - 20 * np.log10(symbols)
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error)
    out = out.assign(rx_power_dbm=level, first_path_power_dbm=first, first_path_index=index)
    out = out.assign(sample_period_ns=1.0016, noise_std=OF_NOISE * sigma, preamble_count=symbols)
    return out.assign(cir_i=[*cir.real], cir_q=[*cir.imag])


def _arrives(rows: pd.DataFrame, middle: Floats, rng: np.random.Generator) -> Complexes:
    """Return what arrives in root mW: straight, by fronts of shelves, and from between books."""
    size, links = len(rows), pd.Categorical(rows["link"])
    count, codes = len(links.categories), links.codes
    behind = np.array(["metal" in one for one in rows["obstacles"]], np.float64)
    straight = 1 - behind * rng.uniform(0.1, 0.35, count)[codes]
    cir = (straight * _spun(rng, size))[:, None] * knocks(middle)
    for begin, mean in ((4.0, 0.22), (7.5, 0.17), (14.0, 0.13), (24.0, 0.09), (38.0, 0.06)):
        late = (begin * rng.uniform(0.9, 1.5, count))[codes]
        front = mean * rng.gamma(4.0, 0.25, count)[codes] * _spun(rng, size)
        cir = cir + front[:, None] * knocks(middle + late)
    since = np.maximum(GRID - middle[:, None] - 2.0, 0)
    books = rng.uniform(0.02, 0.045, count)[codes, None] * np.sqrt(since / 6) * np.exp(-since / 21)
    level = stacks.through_books(rows) + rng.laplace(0, 0.6, count)[codes] - 4.0
    return np.asarray(10 ** (level / 20)[:, None] * (cir + books * rustle(rng, size)))


def _spun(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.uniform(size=size)))
