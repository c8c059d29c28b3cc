"""The foundry's radio with its impulse responses: rows of `foundry`, steel that scatters.

numpy and pandas alone; what can be hidden is in `foundry_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import foundry
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.foundry_bay import Pour
from bench.challenge.families.foundry_effects import girder_way
from bench.challenge.families.foundry_gauge import (
    EDGE,
    METRES,
    OF_NOISE,
    TICK,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Gauge,
    arrivals,
    dials,
    grate,
    raised,
)
from bench.challenge.families.foundry_wave_effects import LAWS, OF_RANGES, WAVES, put_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 21, 156
POLLS = (1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5, 5, 6, 7, 8, 9)
FULL_DB = 113.5  # of levels
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: foundry.CAUSES[name] for name in foundry.CAUSES if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the foundry's own."""
    rng = np.random.default_rng([1024, seed])
    rows = foundry.weighed(foundry.hauls(rng, "", POLLS), drawn, True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = foundry.weighed(foundry.hauls(rng, "", POLLS), drawn, False)
        rows = rows.assign(link="second bay, " + rows["link"])
    more = pd.concat([rows for _ in range(drawn.ratio)], ignore_index=True)
    simulated, true = received(more, rng), received(more, rng)
    every = (_through(clean, drawn, seed), clean, simulated, _through(true, drawn, seed))
    found, plain, other, truth = (_written(one, drawn.listed) for one in every)
    return Tables(found, plain, other, truth)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return foundry.hauls(np.random.default_rng([1024, seed]), "", POLLS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is written.
    """
    out = _through(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _through(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    gauge = Gauge(table, seed, np.random.default_rng([1025, seed, len(table)]))
    put_through(gauge, drawn.hidden, drawn.strength)
    return gauge.read()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is written: SAMPLES sizes from LEAD before the first path."""
    return _written(table, listed=True)


def _written(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(index.astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    parts = (np.vstack(table[name].to_list()) for name in ("cir_i", "cir_q"))
    windows = np.lib.stride_tricks.sliding_window_view(np.hypot(*parts), SAMPLES, axis=1)
    sizes = windows[np.arange(len(begin)), begin].astype(np.float32)
    bare = foundry.bared(table.drop(columns=["cir_i", "cir_q"]), listed)
    return bare.assign(cir=list(sizes), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the foundry's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + EDGE + rng.random(size)
    symbols, noise = foundry.heard_by(rows, rng)
    sigma = 0.8 * noise / OF_NOISE
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _among_steel(rows, top, rng) + sigma[:, None] * grate(rng, size)
    index = arrivals(cir, sigma)
    error = METRES * (index + EDGE - top) + rng.normal(0.0, 0.011, size)
    level, first = dials(cir, index, sigma) - 20 * np.log10(full)
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


def _among_steel(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by a bridge, by columns, and the rest."""
    pour = Pour(rows, 0, rng)
    steel = pour.has("metal") * pour.for_links(lambda n: rng.uniform(0.56, 0.86, n))
    cir = ((1 - steel) * _any_phase(rng, len(rows)))[:, None] * raised(top)
    bridge = girder_way(pour)
    share = 0.4 * pour.way / bridge * pour.for_links(lambda n: rng.uniform(0.3, 1.0, n))
    late = np.maximum((bridge - pour.way) / METRES, 5.0)
    cir = cir + (share * _any_phase(rng, len(rows)))[:, None] * raised(top + late)
    late = np.full(len(rows), 5.0)
    for _ in range(8):  # columns and stacks, ever farther
        late = late + pour.for_links(lambda n: rng.exponential(6.0, n))
        glint = pour.for_links(lambda n: rng.rayleigh(0.8, n).clip(max=2.0))
        share = 0.36 * np.exp(-late / 60.0) * glint
        cir = cir + (share * _any_phase(rng, len(rows)))[:, None] * raised(top + late)
    past = TICK - top[:, None] - 3.0
    rest = pour.for_links(lambda n: rng.uniform(0.02, 0.05, n))[:, None] * np.exp(-past / 50.0)
    whole = cir + np.where(past > 0, rest, 0.0) * grate(rng, len(rows))
    level = foundry.under_the_bridges(rows) + pour.for_links(lambda n: rng.normal(0, 1.3, n))
    return np.asarray(10 ** ((level - 4.7)[:, None] / 20) * whole)


def _any_phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
