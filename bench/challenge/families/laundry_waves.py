"""The laundry's meters with their impulse responses: rows of `laundry`, and what echoes.

numpy and pandas alone; what can be hidden is in `laundry_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import laundry
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.laundry_day import worked
from bench.challenge.families.laundry_meter import (
    METRES,
    OF_SIZES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Meter,
    levels_db,
    lobes,
    onsets,
    sizzle,
)
from bench.challenge.families.laundry_plan import Errand
from bench.challenge.families.laundry_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 20, 176
OF_ROWS = np.repeat(np.arange(1, 10), [26, 22, 18, 14, 10, 7, 4, 3, 1])
"""How many rows links have."""
FULL_DB = 113.0  # of levels: a count for each symbol
WAYS, SOON, APART, FADES = 30, 4.4, 2.3, 34.0  # of echoes; samples: the first, next, all by e
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in laundry.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the laundry's own."""
    rng = np.random.default_rng([seed, 2307])
    rows = laundry.shortened(worked(rng, "", OF_ROWS), drawn, True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = laundry.next_day(worked(rng, "", OF_ROWS), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, anew = received(more, rng), received(more, rng)
    every = (_with(clean, drawn, seed, 1), clean, simulated, _with(anew, drawn, seed, 2))
    found, plain, other, true = (_cut(one, drawn.listed) for one in every)
    return Tables(found, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([seed, 2307]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _with(table, drawn, seed, 10 + len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _with(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    meter = Meter(table, seed, np.random.default_rng([seed, 2309, side]))
    put_in(meter, drawn.hidden, drawn.strength)
    return meter.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut(table, "obstacles" in table)


def _cut(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    first = table["first_path_index"].to_numpy(np.float64)
    begins = (np.floor(first).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(*(np.stack([*table[name]]) for name in ("cir_i", "cir_q")))
    kept = np.take_along_axis(sizes, begins[:, None] + np.arange(SAMPLES), axis=1)
    rows = table.drop(columns=["cir_i", "cir_q"])
    told = {"cir": list(kept.astype(np.float32)), "first_path_index": first - begins}
    return laundry.as_kept(rows.assign(**told), listed)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that tags' own meters make of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    symbols, noise = laundry.counted(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_hall(rows, top, rng) + sigma[:, None] * sizzle(rng, len(rows))
    at = onsets(wave, sigma)
    kept = Errand(rows, 0, rng).of_links(lambda n: 0.014 * (rng.beta(2.0, 2.0, n) - 0.5))
    error = METRES * (at + RISE - top) + kept + rng.normal(0.0, 0.012, len(rows))
    level, first = (db - 20 * np.log10(full) for db in levels_db(wave, at, sigma))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=list(wave.real),
        cir_q=list(wave.imag),
    )


def _in_the_hall(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, and by ways that links have.

    Of what is behind steel some comes straight. Ways come as late at all rows of a link, and as
    loud as each row finds them.
    """
    errand = Errand(rows, 0, rng)
    steel = errand.goes_through("metal") * errand.of_links(lambda n: rng.uniform(0.35, 0.82, n))
    wave = (1 - steel)[:, None] * _pulse(rng, top)
    busy = errand.of_links(lambda n: 0.18 + 0.3 * rng.beta(1.5, 2.5, n))
    late = np.full(len(rows), SOON)
    for _ in range(WAYS):
        late = late + errand.of_links(lambda n: rng.gamma(1.5, APART / 1.5, n))
        size = busy * np.exp(-late / FADES) * rng.beta(1.2, 1.8, len(rows)) * 2.0
        wave = wave + size[:, None] * _pulse(rng, top + late)
    level = laundry.in_the_hall(rows, rng) - 1.7  # what comes later adds to what comes straight
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _pulse(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row, at a phase by chance [n, k]."""
    return np.asarray(lobes(top) * np.exp(2j * np.pi * rng.random(len(top)))[:, None])
