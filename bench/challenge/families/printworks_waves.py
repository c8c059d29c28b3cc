"""The printworks' consoles with their impulse responses: rows of `printworks`, and what echoes.

numpy and pandas alone; what can be hidden is in `printworks_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import printworks
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.printworks_console import (
    METRES,
    OF_SIZES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Console,
    decibels,
    edges,
    pulses,
    rush,
)
from bench.challenge.families.printworks_hall import TOWERS_M, Sheet
from bench.challenge.families.printworks_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 19, 166
OF_ROWS = np.repeat(np.arange(1, 9), [25, 21, 17, 13, 11, 8, 5, 3])
"""How many rows links have."""
FULL_DB = 110.0  # of levels: a count for each symbol
ROLLERS, LAST = 26, 88.0  # of steel, anywhere; samples until the last of these
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: printworks.CAUSES[name] for name in printworks.CAUSES if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the printworks' own."""
    rng = np.random.default_rng([seed, 1806])
    rows = printworks.mixed(printworks.runs(rng, "", OF_ROWS), drawn, True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = printworks.mixed(printworks.runs(rng, "", OF_ROWS), drawn, False)
        rows = rows.assign(link="reprint, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, anew = (received(more, rng) for _ in range(2))
    found = _through(clean, drawn, seed, 1)
    truth = _through(anew, drawn, seed, 2)
    kept, plain, other, true = (
        _stored(one, drawn.listed) for one in (found, clean, simulated, truth)
    )
    return Tables(kept, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return printworks.runs(np.random.default_rng([seed, 1806]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _through(table, drawn, seed, 3 + len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _through(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    console = Console(table, seed, np.random.default_rng([seed, 1807, side]))
    put_in(console, drawn.hidden, drawn.strength)
    return console.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is stored: SAMPLES sizes from LEAD before the first path."""
    return _stored(table, listed=True)


def _stored(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    in_phase, aside = (np.stack([*table[name]]) for name in ("cir_i", "cir_q"))
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index).astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(in_phase, aside).astype(np.float32)
    kept = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    rows = table.drop(columns=["cir_i", "cir_q"]).assign(
        cir=[*kept], first_path_index=index - begin
    )
    return printworks.written(rows, listed or "obstacles" not in rows)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the printworks' own console makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    symbols, noise = printworks.counted(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_hall(rows, top, rng) + sigma[:, None] * rush(rng, len(rows))
    edge = edges(wave, sigma)
    error = METRES * (edge + RISE - top) + rng.normal(0.0, 0.0135, len(rows))
    level, first = (db - 20 * np.log10(full) for db in decibels(wave, edge, sigma))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=edge,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_hall(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off both flanks of towers, off rollers.

    Towers return what meets them as upright cylinders do; how much is by chance of links. Of what
    is behind steel some comes straight.
    """
    sheet = Sheet(rows, 0, rng)
    steel = sheet.through("metal") * sheet.by_link(lambda n: 0.34 + 0.5 * rng.beta(2.2, 1.4, n))
    wave = (1 - steel)[:, None] * _arrival(rng, top)
    for place in np.array([(x_m, y_m) for x_m in TOWERS_M for y_m in (12.3, 15.9)]):
        one, other = (np.hypot(*(end[:, :2] - place).T) for end in (sheet.there, sheet.hung))
        rise = sheet.there[:, 2] - sheet.hung[:, 2]
        way = np.hypot(one + other, rise)
        late = ((way - sheet.far) / METRES).clip(4.6, 185.0)
        size = np.sqrt(0.9 * sheet.far**2 / (way * one.clip(0.8) * other.clip(0.8))).clip(max=0.5)
        size = 0.85 * size * sheet.by_link(lambda n: rng.weibull(1.7, n).clip(max=2.2))
        wave += size[:, None] * _arrival(rng, top + late)
    for late in rng.uniform(3.8, LAST, (ROLLERS, len(rows))):
        size = 0.072 * np.exp(-late / 29.0) * np.sqrt(rng.exponential(2.0, len(rows)))
        wave += size[:, None] * _arrival(rng, top + late)
    level = printworks.in_the_hall(rows, rng) - 2.2  # what comes later adds to what comes straight
    return np.asarray(10 ** (level[:, None] / 20) * wave)


def _arrival(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row at some phase [n, k]."""
    return np.asarray(np.exp(2j * np.pi * rng.random(len(top)))[:, None] * pulses(top))
