"""The saw mill's decoders with their impulse responses: rows of `sawmill`, and what echoes.

numpy and pandas alone; what can be hidden is in `sawmill_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import sawmill
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.sawmill_decoder import (
    METRES,
    OF_SIZES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Decoder,
    humps,
    levels_db,
    onsets,
    rasp,
)
from bench.challenge.families.sawmill_shift import shift
from bench.challenge.families.sawmill_wave_effects import LAWS, OF_RANGES, WAVES, put_in
from bench.challenge.families.sawmill_yard import Stint

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 170
OF_ROWS = np.repeat(np.arange(1, 9), [24, 21, 18, 14, 11, 8, 5, 3])
"""How many rows links have."""
FULL_DB = 115.4  # of levels: a count for each symbol
STACKS, BOARDS = 4, 9  # heaps that return waves, and how many ways each of them does
SOON, APART, FADES = 4.3, 2.6, 38.0  # in samples: first heap, ways of one, what all fade by e in
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in sawmill.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the saw mill's own."""
    rng = np.random.default_rng([seed, 2206])
    rows = sawmill.mixed(shift(rng, "", OF_ROWS), drawn, True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = sawmill.next_shift(shift(rng, "", OF_ROWS), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, anew = received(more, rng), received(more, rng)
    found, truth = (_with(one, drawn, seed, side) for side, one in enumerate((clean, anew), 1))
    kept, plain, other, true = (_cut(one, drawn.listed) for one in (found, clean, simulated, truth))
    return Tables(kept, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return shift(np.random.default_rng([seed, 2206]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _with(table, drawn, seed, 10 + len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _with(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    decoder = Decoder(table, seed, np.random.default_rng([seed, 2207, side]))
    put_in(decoder, drawn.hidden, drawn.strength)
    return decoder.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut(table, "obstacles" in table)


def _cut(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    first = table["first_path_index"].to_numpy(np.float64)
    begins = (np.floor(first) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES).astype(np.int64)
    real, imaginary = (np.vstack(table[name].to_list()) for name in ("cir_i", "cir_q"))
    place = begins[:, None] + np.arange(SAMPLES)
    sizes = np.take_along_axis(np.hypot(real, imaginary), place, axis=1).astype(np.float32)
    rows = table.drop(columns=["cir_i", "cir_q"])
    return sawmill.as_logged(rows.assign(cir=list(sizes), first_path_index=first - begins), listed)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that braces' own decoders make of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    symbols, noise = sawmill.counted(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_mill(rows, top, rng)
    wave = wave + sigma[:, None] * rasp(rng, len(rows))
    at = onsets(wave, sigma)
    kept = Stint(rows, 0, rng).by_link(lambda n: rng.uniform(-0.0065, 0.0065, n))
    error = METRES * (at + RISE - top) + kept + rng.logistic(0.0, 0.0072, len(rows))
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


def _in_the_mill(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, and off heaps, by some ways each.

    Of what is behind steel some comes straight. Heaps stand where they do for a link; ways off
    their boards are others at each row.
    """
    stint = Stint(rows, 0, rng)
    steel = stint.has("metal") * stint.by_link(lambda n: rng.triangular(0.3, 0.66, 0.84, n))
    wave = (1 - steel)[:, None] * _pulse(rng, top)
    heap = np.full(len(rows), SOON)
    for _ in range(STACKS):
        heap = heap + stint.by_link(lambda n: rng.exponential(10.0, n).clip(max=36.0))
        large = stint.by_link(lambda n: 0.3 * rng.gamma(2.5, 0.4, n).clip(max=2.4))
        late = heap
        for _ in range(BOARDS):
            size = large * np.exp(-late / FADES) * rng.weibull(1.6, len(rows))
            wave = wave + size[:, None] * _pulse(rng, top + late)
            late = late + rng.exponential(APART, len(rows))
    level = sawmill.in_the_mill(rows, rng) - 1.4  # what comes later adds to what comes straight
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _pulse(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row, at a phase by chance [n, k]."""
    return np.asarray(humps(top) * np.exp(2j * np.pi * rng.random(len(top)))[:, None])
