"""The bowls green's dials with their impulse responses: rows of `bowls`, and what echoes.

numpy and pandas alone; what can be hidden is in `bowls_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import bowls
from bench.challenge.families.bowls_dial import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Dial,
    first_paths,
    levels_db,
    pulses,
    rush,
)
from bench.challenge.families.bowls_match import played
from bench.challenge.families.bowls_rinks import End
from bench.challenge.families.bowls_wave_effects import LAWS, OF_RANGES, WAVES, hide
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 17, 164
OF_ROWS = np.repeat(np.arange(1, 11), [26, 22, 18, 14, 11, 7, 4, 2, 2, 1])
"""How many rows links have."""
FULL_DB = 112.0  # of levels: a count for each symbol
WAYS, SOON, APART, FADES = 26, 4.6, 2.7, 31.0  # of echoes; samples: the first, next, all by e
LATER_DB = 1.9  # what comes later adds to what comes straight
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in bowls.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the green's own."""
    rng = np.random.default_rng([seed, 2407])
    rows = bowls.thinned(played(rng, "", OF_ROWS), drawn, 1)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = bowls.next_match(played(rng, "", OF_ROWS), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, anew = received(more, rng), received(more, rng)
    every = (_with(clean, drawn, seed, 1), clean, simulated, _with(anew, drawn, seed, 2))
    found, plain, other, true = (_cut(one, drawn.listed) for one in every)
    return Tables(found, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return played(np.random.default_rng([seed, 2407]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _with(table, drawn, seed, 10 + len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _with(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    dial = Dial(table, seed, np.random.default_rng([seed, 2409, side]))
    hide(dial, drawn.hidden, drawn.strength)
    return dial.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut(table, "obstacles" in table)


def _cut(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    first = table["first_path_index"].to_numpy(np.float64)
    begins = (np.floor(first).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.stack([*table["cir_i"]]), np.stack([*table["cir_q"]]))
    kept = np.take_along_axis(sizes, begins[:, None] + np.arange(SAMPLES), axis=1)
    rows = table.drop(columns=["cir_i", "cir_q"])
    told = {"cir": list(kept.astype(np.float32)), "first_path_index": first - begins}
    return bowls.as_told(rows.assign(**told), listed)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that knots' own dials make of rows, with complex waveforms."""
    top = WIDE_LEAD + AHEAD + rng.random(len(rows))
    symbols, noise = bowls.counted(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _below_the_skin(rows, top, rng) + sigma[:, None] * rush(rng, len(rows))
    at = first_paths(wave, sigma)
    kept = End(rows, 0, rng).by_link(lambda n: rng.uniform(-0.005, 0.005, n))
    error = METRES * (at + AHEAD - top) + kept + rng.normal(0.0, 0.012, len(rows))
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


def _below_the_skin(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, and by ways that links have.

    Of what is behind steel some comes straight. Ways come as late at all rows of a link, and as
    loud as each row finds them.
    """
    end = End(rows, 0, rng)
    steel = end.meets("metal") * end.by_link(lambda n: rng.uniform(0.4, 0.86, n))
    wave = (1 - steel)[:, None] * _heard(rng, top)
    busy = end.by_link(lambda n: rng.triangular(0.18, 0.27, 0.48, n))
    late = np.full(len(rows), SOON)
    for _ in range(WAYS):
        late = late + end.by_link(lambda n: rng.exponential(0.7 * APART, n) + 0.3 * APART)
        size = busy * np.exp(-late / FADES) * rng.weibull(1.8, len(rows)).clip(max=2.2)
        wave = wave + size[:, None] * _heard(rng, top + late)
    level = bowls.on_the_green(rows, rng) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _heard(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row, at a phase by chance [n, k]."""
    return np.asarray(pulses(top) * np.exp(2j * np.pi * rng.random(len(top)))[:, None])
