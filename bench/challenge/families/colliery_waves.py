"""The colliery's geophones with their impulse responses: rows of `colliery`, and what echoes.

numpy and pandas alone; what can be hidden is in `colliery_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import colliery
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.colliery_geophone import (
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    TO_TOP,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Geophone,
    booms,
    first_paths,
    levels_db,
    trickling,
)
from bench.challenge.families.colliery_pit import Tally
from bench.challenge.families.colliery_shift import worked
from bench.challenge.families.colliery_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 122
OF_ROWS = np.repeat(np.arange(1, 9), [27, 26, 21, 15, 10, 7, 5, 2])
"""How many rows links have."""
FULL_DB = 117.8  # of levels: a count for each symbol
ECHOES, NEAREST, UNTIL = 30, 6.0, 88.0  # how many a link has; samples: the first, the last
LATER_DB = 1.8  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in colliery.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the colliery's own."""
    rng = np.random.default_rng([seed, 3409])
    shift = colliery.thinned(worked(rng, "", OF_ROWS), drawn, near=True)
    clean = received(shift, rng)
    other = shift
    if not drawn.paired:
        other = colliery.next_shift(worked(rng, "", OF_ROWS), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    four = (_heard(clean, drawn, seed, 1), clean, simulated, _heard(anew, drawn, seed, 2))
    found, clean, simulated, truth = (_cut_out(one, drawn.listed) for one in four)
    return Tables(found, clean, simulated, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _heard(table, drawn, seed, 10 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _heard(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    phone = Geophone(table, seed, np.random.default_rng([seed, 3410, side]))
    put_in(phone, drawn.hidden, drawn.strength)
    return phone.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut_out(table, True)


def _cut_out(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = np.floor(at).astype(np.int64).clip(LEAD, WIDE_SAMPLES - SAMPLES + LEAD) - LEAD
    whole = zip(table["cir_i"], table["cir_q"], begin, strict=True)
    kept = [np.hypot(i, q)[k : k + SAMPLES].astype(np.float32) for i, q, k in whole]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(cir=kept, first_path_index=at - begin)
    return colliery.as_shown(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([seed, 3409]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that props' own geophones make of rows, with complex waveforms."""
    tally = Tally(rows, 0, rng)
    top = WIDE_LEAD + TO_TOP + rng.random(tally.rows)
    symbols, noise = colliery.counted(tally)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_air(tally, top) + sigma[:, None] * trickling(rng, tally.rows)
    at = first_paths(wave, sigma)
    own = tally.by_link(lambda n: 0.008 * (rng.random((3, n)).sum(axis=0) - 1.5))
    error = METRES * (at + TO_TOP - top) + own + 0.0105 * colliery.chances(rng, tally.rows)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, tally.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(colliery.MEASURED, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_air(tally: Tally, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Echoes come the seldomer the later, as a square root of chance has it; each is as large as
    chance has it, ever less by an exponential. Of what is behind tubs some comes straight.
    """
    link, rng = tally.by_link, tally.rng
    steel = tally.behind("metal") * link(lambda n: rng.uniform(0.4, 0.72, n))
    wave = _pulse(tally, top, 1 - steel)
    busy = link(lambda n: 0.17 + 0.4 * rng.beta(1.4, 2.6, n))
    for _ in range(ECHOES):
        after = NEAREST + (UNTIL - NEAREST) * link(lambda n: rng.random(n) ** 1.7)
        loud = busy * np.exp(-after / 58.0) * rng.gamma(2.2, 0.45, tally.rows)
        wave = wave + _pulse(tally, top + after, 0.7 * loud)
    level = colliery.in_the_hall(tally) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _pulse(tally: Tally, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = np.exp(2j * np.pi * tally.rng.random(tally.rows))
    return np.asarray((high * turn)[:, None] * booms(top))
