"""The saltworks' gauges with their impulse responses: rows of `saltworks`, and what echoes.

numpy and pandas alone; what can be hidden is in `saltworks_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import saltworks
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.saltworks_day import worked
from bench.challenge.families.saltworks_gauge import (
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    TOLD,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Gauge,
    first_paths,
    humps,
    lapping,
    levels_db,
)
from bench.challenge.families.saltworks_pans import Haul
from bench.challenge.families.saltworks_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 152
OF_ROWS = np.repeat(np.arange(1, 10), [30, 24, 19, 15, 10, 6, 4, 2, 1])
"""How many rows links have."""
FULL_DB = 115.5  # of levels: a count for each symbol
ECHOES, NEAREST, PITCH = 20, 5.5, 4.1  # of a link; samples: the first; from one to the next
FALLS = 26.0  # samples until echoes are e times less
LATER_DB = 1.6  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in saltworks.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the saltworks' own."""
    rng = np.random.default_rng([seed, 2607])
    day = saltworks.thinned(worked(rng, "", OF_ROWS), drawn, 1.0)
    clean = received(day, rng)
    other = day if drawn.paired else saltworks.next_day(worked(rng, "", OF_ROWS), drawn)
    often = pd.concat([other] * drawn.ratio, ignore_index=True)
    made = [_hidden(clean, drawn, seed, 1), clean, received(often, rng)]
    made.append(_hidden(received(often, rng), drawn, seed, 2))
    found, plain, simulated, truth = (_kept(one, drawn.listed) for one in made)
    return Tables(found, plain, simulated, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hidden(table, drawn, seed, 10 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hidden(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    gauge = Gauge(table, seed, np.random.default_rng([seed, 2609, side]))
    put_in(gauge, drawn.hidden, drawn.strength)
    return gauge.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, "obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(at).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(*(np.stack([*table[name]]) for name in ("cir_i", "cir_q")))
    some = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    made = table.drop(columns=["cir_i", "cir_q"]).assign(first_path_index=at - begin)
    return saltworks.entered(made.assign(cir=[*some.astype(np.float32)]), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([seed, 2607]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that vanes' own gauges make of rows, with complex waveforms."""
    haul, top = Haul(rows, 0, rng), WIDE_LEAD + TOLD + rng.random(len(rows))
    symbols, noise = saltworks.counted(haul)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(haul, top) + sigma[:, None] * lapping(rng, len(rows))
    at = first_paths(wave, sigma)
    kept = haul.each(lambda n: rng.uniform(-0.007, 0.007, n))
    own = 0.0115 * saltworks.logistic(rng, len(rows))
    error = METRES * (at + TOLD - top) + kept + own
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, haul.far + error, every, first, noise, symbols)
    told = dict(zip(saltworks.UNTOLD, made, strict=True))
    return rows.assign(
        **told,
        first_path_index=at,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
        sample_period_ns=SAMPLE_NS,
    )


def _by_air(haul: Haul, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Of what is behind steel some comes straight. Echoes of a link come one after the other, by waits
    of chance, and are as loud as each row finds them.
    """
    each, rng = haul.each, haul.rng
    steel = haul.cross("metal") * each(lambda n: rng.uniform(0.45, 0.77, n))
    wave = (1 - steel)[:, None] * _turned(haul, top)
    busy = each(lambda n: rng.triangular(0.22, 0.3, 0.55, n))
    late = np.full(len(top), NEAREST)
    for _ in range(ECHOES):
        loud = busy * np.exp(-late / FALLS) * np.sqrt(rng.exponential(1.0, len(top)))
        wave = wave + loud[:, None] * _turned(haul, top + late)
        late = late + each(lambda n: rng.exponential(PITCH, n))
    level = saltworks.at_the_works(haul) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _turned(haul: Haul, top: Floats) -> Complexes:
    """Return a pulse for each row, at a phase by chance [n, k]."""
    return np.asarray(humps(top) * np.exp(2j * np.pi * haul.rng.random(len(top)))[:, None])
