"""The circus' lamps with their impulse responses: rows of `circus`, and what echoes.

numpy and pandas alone; what can be hidden is in `circus_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import circus
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.circus_lamp import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Lamp,
    applause,
    first_paths,
    flashes,
    levels_db,
)
from bench.challenge.families.circus_show import staged
from bench.challenge.families.circus_tent import Act
from bench.challenge.families.circus_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 128
OF_ROWS = np.repeat(np.arange(1, 9), [30, 26, 21, 15, 10, 6, 4, 2])
"""How many rows links have."""
FULL_DB = 119.0  # of levels: a count for each symbol
ECHOES, NEAREST, UNTIL = 34, 6.0, 92.0  # how many a link has; samples: the first, the last
FALLS = 27.0  # samples until echoes are e times less
LATER_DB = 1.7  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in circus.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the circus' own."""
    rng = np.random.default_rng([seed, 2907])
    day = circus.thinned(staged(rng, "", OF_ROWS), drawn, near=True)
    clean = received(day, rng)
    other = day if drawn.paired else circus.next_town(staged(rng, "", OF_ROWS), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    four = (_hiding(clean, drawn, seed, 1), clean, simulated, _hiding(anew, drawn, seed, 2))
    found, clean, simulated, truth = (_cut_out(one, drawn.listed) for one in four)
    return Tables(found, clean, simulated, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 10 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    lamp = Lamp(table, seed, np.random.default_rng([seed, 2909, side]))
    put_in(lamp, drawn.hidden, drawn.strength)
    return lamp.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut_out(table, "obstacles" in table)


def _cut_out(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(at.astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.stack([*table["cir_i"]]), np.stack([*table["cir_q"]]))
    kept = [row[k : k + SAMPLES].astype(np.float32) for row, k in zip(sizes, begin, strict=True)]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(cir=kept, first_path_index=at - begin)
    return circus.as_handed_on(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return staged(np.random.default_rng([seed, 2907]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that poles' own lamps make of rows, with complex waveforms."""
    act = Act(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(act.rows)
    symbols, noise = circus.counted(act)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_air(act, top) + sigma[:, None] * applause(rng, act.rows)
    at = first_paths(wave, sigma)
    own = act.by_link(lambda n: rng.triangular(-0.009, 0.0, 0.009, n))
    error = METRES * (at + AHEAD - top) + own + 0.011 * circus.chances(rng, act.rows)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, act.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(circus.MEASURED, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_air(act: Act, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Waits between echoes are exponential and grow ever shorter, as a room's get denser with the
    square of time (Polack 1992). Of what is behind wagons some comes straight.
    """
    link, rng = act.by_link, act.rng
    steel = act.meets("metal") * link(lambda n: rng.uniform(0.48, 0.76, n))
    wave = _pulse(act, top, 1 - steel)
    busy = link(lambda n: rng.triangular(0.16, 0.26, 0.5, n))
    late = link(lambda n: NEAREST + 2.0 * rng.random(n))
    for _ in range(ECHOES):
        loud = busy * np.exp(-late / FALLS) * rng.rayleigh(0.66, act.rows)
        wave = wave + _pulse(act, top + late, loud * (late < UNTIL))
        wait = link(lambda n: rng.exponential(1.0, n))
        late = late + (0.5 + 5.0 * wait) / (1 + late / 30.0)
    level = circus.in_the_tent(act) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _pulse(act: Act, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = np.exp(2j * np.pi * act.rng.random(act.rows))
    return np.asarray((high * turn)[:, None] * flashes(top))
