"""The cannery's radio with its impulse responses: rows of `cannery`, sheet steel that echoes.

numpy and pandas alone; what can be hidden is in `cannery_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import cannery
from bench.challenge.families.cannery_hall import Lot
from bench.challenge.families.cannery_scanner import (
    METRES,
    OF_SIZES,
    RISE,
    SAMPLE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Scan,
    fizz,
    found,
    gauged,
    lobes,
)
from bench.challenge.families.cannery_wave_effects import LAWS, OF_RANGES, WAVES, suffer_all
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 13, 112
POLLS = (19, 22, 20, 15, 10, 5, 3, 2)  # of how many links each number of polls is
FULL_DB = 114.0  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cannery.CAUSES[name] for name in OF_RANGES if name in cannery.CAUSES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the cannery's own."""
    rng = np.random.default_rng([1065, seed])
    rows = cannery.mixed(cannery.lots(rng, "", POLLS), drawn, near=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = cannery.mixed(cannery.lots(rng, "", POLLS), drawn, near=False)
        rows["link"] = "next day " + rows["link"]
    rows = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, again = received(rows, rng), received(rows, rng)
    return Tables(
        recorded=_kept(_suffered(clean, drawn, seed), drawn.listed),
        clean=_kept(clean, drawn.listed),
        simulated=_kept(simulated, drawn.listed),
        truth=_kept(_suffered(again, drawn, seed), drawn.listed),
    )


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return cannery.lots(np.random.default_rng([1065, seed]), "", POLLS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    out = _suffered(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _suffered(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    scan = Scan(table, seed, np.random.default_rng([1066, len(table), seed]))
    suffer_all(scan, drawn.hidden, drawn.strength)
    return scan.written()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, listed="obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(at).astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    waves = np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]])
    window = begin[:, None] + np.arange(SAMPLES)
    sizes = np.abs(np.take_along_axis(waves, window, axis=1)).astype(np.float32)
    bare = table.drop(columns=["cir_i", "cir_q"]).assign(cir=[*sizes], first_path_index=at - begin)
    return cannery.shown(bare, listed or "obstacles" not in bare)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the cannery's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    middle = WIDE_LEAD + RISE + rng.random(size)
    symbols = 128.0 - rng.binomial(9, 0.3, size)
    sigma = cannery.OF_CHIP / OF_SIZES * (1 + 0.16 * (rng.random(size) ** 1.5 - 0.4))
    full = symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _among_steel(rows, middle, rng) + sigma[:, None] * fizz(rng, size)
    index = found(wave, sigma)
    error = METRES * (index + RISE - middle) + rng.logistic(0.0, 0.0042, size)
    level, first = gauged(wave, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_SIZES * sigma,
        preamble_count=symbols,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _among_steel(rows: pd.DataFrame, middle: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off one thing after another, and a rest.

    Echoes come one after the other, each a chance time after the last; all rows of a link hear the
    same ones, whose phases differ.
    """
    lot, size = Lot(rows, 0, rng), len(rows)
    straight = 1 - lot.with_a("metal") * lot.by_link(rng.uniform, 0.5, 0.82)
    wave = (straight * _any_phase(rng, size))[:, None] * lobes(middle)
    late = np.full(size, 4.0)
    for _ in range(10):
        late = late + lot.by_link(rng.gamma, 1.6, 2.9)
        share = 0.6 * np.exp(-late / 19.0) * lot.by_link(rng.beta, 1.6, 1.9)
        wave = wave + (share * _any_phase(rng, size))[:, None] * lobes(middle + late)
    past = SAMPLE - middle[:, None] - 2.5
    rest = lot.by_link(rng.uniform, 0.02, 0.05)[:, None] * np.exp(-np.maximum(past, 0.0) / 25.0)
    wave = wave + np.where(past > 0, rest, 0.0) * fizz(rng, size)
    level = cannery.under_the_roof(rows, rng) - 5.2
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _any_phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
