"""The shipyard's lookouts with their impulse responses: rows of `shipyard`, and what echoes.

numpy and pandas alone; what can be hidden is in `shipyard_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import shipyard
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.shipyard_lookout import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Lookout,
    combers,
    first_paths,
    levels_db,
    surf,
)
from bench.challenge.families.shipyard_slip import Berth
from bench.challenge.families.shipyard_tide import manned
from bench.challenge.families.shipyard_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 20, 140
OF_ROWS = np.repeat(np.arange(1, 9), [33, 30, 22, 15, 10, 6, 4, 1])
"""How many rows links have."""
FULL_DB = 111.6  # of levels: a count for each symbol
ECHOES, NEAREST, EACH = 20, 6.7, 3.1  # how many a link has; samples: to the first, and to each next
LATER_DB = 2.2  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in shipyard.CAUSES.items() if name in {*OF_RANGES, *LAWS}}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the shipyard's own."""
    rng = np.random.default_rng([3910, seed])
    day = shipyard.thinned(manned(rng, "", OF_ROWS), drawn, near=True)
    clean = received(day, rng)
    if not drawn.paired:
        day = shipyard.next_tide(manned(rng, "", OF_ROWS), drawn)
    again = pd.concat(drawn.ratio * [day], ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    recorded, truth = _kept_watch(clean, drawn, seed, 1), _kept_watch(anew, drawn, seed, 2)
    made = [_logged(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(made[0], made[1], made[2], made[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _kept_watch(table, drawn, seed, 30 + len(table))
    return made.drop(columns=[] if drawn.listed else ["obstacles"])


def _kept_watch(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    lookout = Lookout(table, seed, np.random.default_rng([3911, side, seed]))
    put_in(lookout, drawn.hidden, drawn.strength)
    return lookout.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _logged(table, True)


def _logged(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = np.asarray(table["first_path_index"], np.float64)
    begin = np.minimum(np.maximum(index.astype(np.int64) - LEAD, 0), WIDE_SAMPLES - SAMPLES)
    sizes = np.abs(np.vstack([*table["cir_i"]]) + 1j * np.vstack([*table["cir_q"]]))
    windows = np.lib.stride_tricks.sliding_window_view(sizes.astype(np.float32), SAMPLES, axis=1)
    made = table.drop(columns=["cir_i", "cir_q"]).assign(first_path_index=index - begin)
    made["cir"] = [one.copy() for one in windows[np.arange(len(begin)), begin]]
    return shipyard.posted(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return manned(np.random.default_rng([3910, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that derricks' own lookouts make of rows, with waveforms of whole counts."""
    berth = Berth(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(berth.rows)
    symbols, noise = shipyard.summed_up(berth)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _on_air(berth, top) + sigma[:, None] * surf(rng, berth.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    at = first_paths(wave, sigma)
    strays = berth.each(lambda n: rng.normal(0.0, shipyard.OWN_M, n))
    strays = strays + 0.0112 * shipyard.whims(rng, berth.rows)
    error = METRES * (at + AHEAD - top) + strays
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, berth.far + error, every, first, noise, symbols)
    measured = rows.assign(**dict(zip(shipyard.MEASURED, made, strict=True)))
    measured = measured.assign(first_path_index=at, sample_period_ns=SAMPLE_NS)
    return measured.assign(cir_i=[*wave.real], cir_q=[*wave.imag])


def _on_air(berth: Berth, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    These come one some time after the other, each as large as chance has it, ever less by e. Of
    what is behind steel some comes straight.
    """
    each, rng = berth.each, berth.rng
    steel = berth.behind("metal") * each(lambda n: rng.beta(9.0, 6.0, n).clip(0.4, 0.73))
    wave = _comber_of(berth, top, 1 - steel)
    loud = each(lambda n: 0.4 + 0.4 * rng.beta(1.5, 2.0, n))
    after = np.full(berth.rows, NEAREST)
    for _ in range(ECHOES):
        after = after + each(lambda n: rng.gamma(1.6, EACH / 1.6, n))
        size = np.sqrt(rng.gamma(1.3, 1 / 1.3, berth.rows))
        wave = wave + _comber_of(berth, top + after, loud * np.exp(-after / 22.0) * size)
    level = shipyard.in_the_dock(berth) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _comber_of(berth: Berth, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    phase = 2 * np.pi * berth.rng.random(berth.rows)
    return np.asarray((high * (np.cos(phase) + 1j * np.sin(phase)))[:, None] * combers(top))
