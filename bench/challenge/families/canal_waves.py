"""The ship lock's staffs with their impulse responses: rows of `canal`, and what echoes.

numpy and pandas alone; what can be hidden is in `canal_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import canal
from bench.challenge.families.canal_chamber import Passage
from bench.challenge.families.canal_staff import (
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    TOLD,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Staff,
    first_paths,
    levels_db,
    splines,
    swash,
)
from bench.challenge.families.canal_traffic import passed
from bench.challenge.families.canal_wave_effects import LAWS, OF_RANGES, WAVES, put_in
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 134
OF_ROWS = np.repeat(np.arange(1, 10), [30, 25, 20, 15, 11, 7, 4, 2, 1])
"""How many rows links have."""
FULL_DB = 117.0  # of levels: a count for each symbol
ECHOES, NEAREST, HALVES = 24, 4.4, 20.0  # of a link; samples: the first, and until half is left
SPREAD = 88.0  # samples that later ones come within
LATER_DB = 1.7  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in [*OF_RANGES, *WAVES] if name not in LAWS)
CAUSES = {name: canal.CAUSES[name] for name in OF_RANGES if name in canal.CAUSES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the lock's own."""
    rng = np.random.default_rng([seed, 2507])
    day = canal.winnowed(passed(rng, "", OF_ROWS), drawn, 1.0)
    made = {"clean": received(day, rng)}
    found = _hidden(made["clean"], drawn, seed, 1)
    other = day if drawn.paired else canal.next_tide(passed(rng, "", OF_ROWS), drawn)
    often = other.loc[np.tile(other.index, drawn.ratio)].reset_index(drop=True)
    made |= {"recorded": found, "simulated": received(often, rng)}
    made["truth"] = _hidden(received(often, rng), drawn, seed, 2)
    kept = {side: _kept(one, drawn.listed) for side, one in made.items()}
    return Tables(kept["recorded"], kept["clean"], kept["simulated"], kept["truth"])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    gone = [] if drawn.listed else ["obstacles"]
    return _hidden(table, drawn, seed, 10 + len(table)).drop(columns=gone)


def _hidden(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    staff = Staff(table, seed, np.random.default_rng([seed, 2509, side]))
    put_in(staff, drawn.hidden, drawn.strength)
    return staff.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, "obstacles" in table.columns)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    first = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(first.astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    whole = zip(begin, table["cir_i"], table["cir_q"], strict=True)
    sizes = [
        np.hypot(real[at : at + SAMPLES], other[at : at + SAMPLES]).astype(np.float32)
        for at, real, other in whole
    ]
    rows = table.drop(columns=["cir_i", "cir_q"]).assign(first_path_index=first - begin)
    return canal.logged(rows.assign(cir=sizes), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return passed(np.random.default_rng([seed, 2507]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that davits' own staffs make of rows, with complex waveforms."""
    passage, top = Passage(rows, 0, rng), WIDE_LEAD + TOLD + rng.random(len(rows))
    symbols, noise = canal.counted(passage)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(passage, top) + sigma[:, None] * swash(rng, len(rows))
    at = first_paths(wave, sigma)
    kept = passage.each(lambda n: 0.005 * np.sin(rng.uniform(0, 2 * np.pi, n)))
    error = METRES * (at + TOLD - top) + kept + 0.011 * rng.standard_t(8.0, len(rows)).clip(-4, 4)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, passage.far + error, every, first, noise, symbols)
    told = dict(zip(canal.UNTOLD, made, strict=True))
    told |= {"first_path_index": at, "cir_i": list(wave.real), "cir_q": list(wave.imag)}
    return rows.assign(**told, sample_period_ns=SAMPLE_NS)


def _by_air(passage: Passage, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Of what is behind steel some comes straight. Echoes are as late at all rows of a link, and as
    loud as each row finds them; they come thick at first, and ever thinner.
    """
    each, rng = passage.each, passage.rng
    steel = passage.cross("metal") * each(lambda n: rng.triangular(0.4, 0.6, 0.84, n))
    level = canal.at_the_lock(passage) - LATER_DB
    wave = (1 - steel)[:, None] * _spun(passage, top)
    busy = each(lambda n: 0.19 + 0.2 * rng.beta(1.5, 3.0, n))
    for _ in range(ECHOES):
        late = NEAREST + SPREAD * each(lambda n: rng.beta(0.9, 1.6, n))
        loud = busy * 0.5 ** (late / HALVES) * np.sqrt(rng.gamma(1.7, 1 / 1.7, len(top)))
        wave = wave + loud[:, None] * _spun(passage, top + late)
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _spun(passage: Passage, top: Floats) -> Complexes:
    """Return a pulse for each row, at a phase by chance [n, k]."""
    turns = np.exp(2j * np.pi * passage.rng.random((len(top), 1)))
    return np.asarray(splines(top) * turns)
