"""The ropewalk's telltales with their impulse responses: rows of `ropewalk`, and what echoes.

numpy and pandas alone; what can be hidden is in `ropewalk_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import ropewalk
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.ropewalk_shift import worked
from bench.challenge.families.ropewalk_telltale import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Telltale,
    creaking,
    first_paths,
    levels_db,
    tufts,
)
from bench.challenge.families.ropewalk_walk import Hank
from bench.challenge.families.ropewalk_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 19, 116
OF_ROWS = np.repeat(np.arange(1, 9), [36, 32, 22, 14, 10, 6, 3, 2])
"""How many rows links have."""
FULL_DB = 108.4  # of levels: a count for each symbol
ECHOES, NEAREST, EACH = 18, 6.2, 3.3  # how many a link has; samples: to the first, to each next
LATER_DB = 2.2  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in ropewalk.CAUSES.items() if name in {*OF_RANGES, *LAWS}}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the ropewalk's own."""
    rng = np.random.default_rng([4110, seed])
    shift = ropewalk.thinned(worked(rng, "", OF_ROWS), drawn, near=True)
    clean = received(shift, rng)
    if not drawn.paired:
        shift = ropewalk.next_shift(worked(rng, "", OF_ROWS), drawn)
    shift = pd.concat([shift] * drawn.ratio, ignore_index=True)
    simulated, anew = received(shift, rng), received(shift, rng)
    found, truth = _minded(clean, drawn, seed, 1), _minded(anew, drawn, seed, 2)
    made = [_kept(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(made[0], made[1], made[2], made[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _minded(table, drawn, seed, 40 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _minded(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    telltale = Telltale(table, seed, np.random.default_rng([4111, side, seed]))
    put_in(telltale, drawn.hidden, drawn.strength)
    return telltale.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.array([*table["cir_i"]]), np.array([*table["cir_q"]])).astype(np.float32)
    own = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    made = table.drop(columns=["cir_i", "cir_q"])
    made = made.assign(first_path_index=index - begin, cir=list(own))
    return ropewalk.hung_up(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([4110, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that struts' own telltales make of rows, with waveforms of whole counts."""
    hank = Hank(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(hank.rows)
    symbols, noise = ropewalk.added_up(hank)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(hank, top) + sigma[:, None] * creaking(rng, hank.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    at = first_paths(wave, sigma)
    strays = hank.by_link(lambda n: rng.normal(0.0, ropewalk.OWN_M, n))
    strays = strays + 0.0108 * ropewalk.freaks(rng, hank.rows)
    error = METRES * (at + AHEAD - top) + strays
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, hank.far + error, every, first, noise, symbols)
    measured = rows.assign(**dict(zip(ropewalk.MEASURED, made, strict=True)))
    measured = measured.assign(first_path_index=at, sample_period_ns=SAMPLE_NS)
    return measured.assign(cir_i=list(wave.real), cir_q=list(wave.imag))


def _by_air(hank: Hank, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    These come one some time after the other, ever less by e. Of what is behind iron some comes
    straight.
    """
    by_link, rng = hank.by_link, hank.rng
    iron = hank.behind("metal") * by_link(lambda n: rng.triangular(0.42, 0.6, 0.74, n))
    wave = _tuft_of(hank, top, 1 - iron)
    loud = by_link(lambda n: rng.uniform(0.4, 0.82, n))
    dies = by_link(lambda n: rng.uniform(16.0, 28.0, n))
    after = np.full(hank.rows, NEAREST)
    for _ in range(ECHOES):
        after = after + by_link(lambda n: EACH * rng.weibull(1.4, n))
        size = np.sqrt(rng.chisquare(2.6, hank.rows) / 2.6)
        wave = wave + _tuft_of(hank, top + after, loud * np.exp(-after / dies) * size)
    level = ropewalk.in_the_hall(hank) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _tuft_of(hank: Hank, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    phase = np.exp(1j * hank.rng.uniform(-np.pi, np.pi, hank.rows))
    return np.asarray((high * phase)[:, None] * tufts(top))
