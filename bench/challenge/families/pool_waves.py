"""The swimming hall's radio with its impulse responses: rows of `pool`, tiles that scatter.

numpy and pandas alone; what can be hidden is in `pool_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import pool
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.pool_tap import (
    BOW,
    METRES,
    OF_NOISE,
    RISE,
    SURE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Tap,
    energies,
    half_of_the_crest,
    hum,
    pulses,
)
from bench.challenge.families.pool_wave_effects import LAWS, OF_RANGES, WAVES, immerse

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 12, 152
SWEEPS = 2
FULL_DB = 114.6  # of levels
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in pool.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the swimming hall's own."""
    rng = np.random.default_rng([741, seed])
    rows = pool.among(pool.heats(rng, "", SWEEPS), 0 if drawn.same_mix else -1)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = pool.among(pool.heats(rng, "", SWEEPS), 0 if drawn.same_mix else 1)
        rows = rows.assign(link="model of " + rows["link"])
    repeated = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, truth = received(repeated, rng), received(repeated, rng)
    sides = conceal(clean, drawn, seed), clean, simulated, conceal(truth, drawn, seed)
    found, plain, model, true = (pool.published(recorded(t), drawn.listed) for t in sides)
    return Tables(found, plain, model, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return pool.heats(np.random.default_rng([741, seed]), "", SWEEPS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    tap = Tap(table, seed, np.random.default_rng([742, len(table), seed]))
    immerse(tap, drawn.hidden, drawn.strength)
    out = tap.written()
    return out if drawn.listed else out.drop(columns="obstacles")


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is written down: SAMPLES sizes from LEAD before the first path."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index).astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.stack([*table["cir_i"]]), np.stack([*table["cir_q"]]))
    shown = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    out = pool.published(table, listed=True).drop(columns=["cir_i", "cir_q"])
    return out.assign(cir=[*shown.astype(np.float32)], first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the hall's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    start = WIDE_LEAD + rng.uniform(-0.5, 0.5, size)
    symbols = 250.0 - rng.poisson(3.0, size)
    sigma = 34.0 * np.exp(rng.normal(0, 0.04, size))
    air = _heard(rows, start, rng)
    cir = (symbols * 10 ** (FULL_DB / 20))[:, None] * air + sigma[:, None] * hum(rng, size)
    index = np.rint(half_of_the_crest(cir, SURE * sigma) * 128) / 128
    error = METRES * (index - start + BOW) + 0.014 * rng.logistic(0, 0.5513, size)
    levels = energies(cir, index) - 20 * np.log10(symbols) - FULL_DB
    return rows.assign(
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        first_path_index=index,
        sample_period_ns=1.0016,
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=levels[0],
        first_path_power_dbm=levels[1],
        cir_i=[*cir.real],
        cir_q=[*cir.imag],
    )


def _heard(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW: straight, a few lumps of a link's own, and tiles."""
    size, (which, links) = len(rows), pd.factorize(rows["link"])
    shaded = np.array([1.0 if one == ["metal"] else 0.0 for one in rows["obstacles"]])
    straight = 1 - shaded * rng.uniform(0.2, 0.5, len(links))[which]
    cir = (straight * _phase(rng, size))[:, None] * pulses(start + RISE)
    for _ in range(4):
        late = (4.5 + rng.gamma(2.0, 9.0, len(links)))[which]
        echo = 0.26 * np.exp(-late / 45) * rng.rayleigh(1.0, len(links))[which]
        cir = cir + (echo * _phase(rng, size))[:, None] * pulses(start + RISE + late)
    ago = np.arange(WIDE_SAMPLES) - start[:, None]
    wet = rng.uniform(0.018, 0.03, len(links))[which, None]
    tiles = wet * np.exp(-np.maximum(ago, 0) / 55) / (1 + np.exp(-(ago - 5) / 1.2))
    level = pool.over_water(rows) + rng.uniform(-1.6, 1.6, len(links))[which]
    return np.asarray(10 ** (level / 20)[:, None] / 1.45 * (cir + tiles * hum(rng, size)))


def _phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
