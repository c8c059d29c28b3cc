"""The observatory's plates with their impulse responses: rows of `observatory`, and what echoes.

numpy and pandas alone; what can be hidden is in `observatory_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import observatory
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.observatory_hall import Exposure
from bench.challenge.families.observatory_night import watched
from bench.challenge.families.observatory_plate import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Plate,
    first_paths,
    levels_db,
    sky,
    stars,
)
from bench.challenge.families.observatory_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 19, 174
OF_ROWS = np.repeat(np.arange(1, 10), [29, 24, 19, 14, 10, 6, 4, 2, 1])
"""How many rows links have."""
FULL_DB = 114.5  # of levels: a count for each symbol
NEAREST, EVERY, UNTIL = 5.4, 3.9, 96.0  # samples: the first echo; between two; the last
FALLS = 26.0  # samples until echoes are e times less
LATER_DB = 1.6  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in observatory.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the observatory's own."""
    rng = np.random.default_rng([seed, 2707])
    night = observatory.fewer(watched(rng, "", OF_ROWS), drawn, near=True)
    clean = received(night, rng)
    other = night
    if not drawn.paired:
        other = observatory.next_night(watched(rng, "", OF_ROWS), drawn)
    again = pd.concat(drawn.ratio * [other], ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    four = (_hidden(clean, drawn, seed, 1), clean, simulated, _hidden(anew, drawn, seed, 2))
    found, plain, made, truth = (_kept(one, drawn.listed) for one in four)
    return Tables(found, plain, made, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hidden(table, drawn, seed, 10 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hidden(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    plate = Plate(table, seed, np.random.default_rng([seed, 2709, side]))
    put_in(plate, drawn.hidden, drawn.strength)
    return plate.shown()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, "obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(at).astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    wave = np.array([*table["cir_i"]]) + 1j * np.array([*table["cir_q"]])
    windows = np.lib.stride_tricks.sliding_window_view(np.abs(wave), SAMPLES, axis=1)
    sizes = windows[np.arange(len(table)), begin].astype(np.float32)
    made = table.assign(cir=[*sizes], first_path_index=at - begin)
    return observatory.filed(made.drop(columns=["cir_i", "cir_q"]), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return watched(np.random.default_rng([seed, 2707]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that sconces' own plates make of rows, with complex waveforms."""
    shot = Exposure(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(shot.rows)
    symbols, noise = observatory.counted(shot)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_air(shot, top) + sigma[:, None] * sky(rng, shot.rows)
    at = first_paths(wave, sigma)
    kept = shot.per_link(lambda n: rng.normal(0.0, 0.004, n).clip(-0.009, 0.009))
    own = 0.0115 * observatory.four_even(rng, shot.rows)
    error = METRES * (at + AHEAD - top) + kept + own
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, shot.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(observatory.UNTOLD, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_air(shot: Exposure, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Of what is behind iron some comes straight. Echoes of a link come one after the other until
    none is heard, after waits of chance, and are as loud as each row finds them.
    """
    link, rng = shot.per_link, shot.rng
    iron = shot.behind("metal") * link(lambda n: 0.52 + 0.31 * rng.beta(2.0, 2.0, n))
    wave = _star(shot, top, 1 - iron)
    busy = link(lambda n: 0.27 + 0.42 * rng.beta(1.5, 2.6, n))
    late = link(lambda n: NEAREST + rng.uniform(0.0, 3.0, n))
    while late.min() < UNTIL:
        loud = busy * np.exp(-late / FALLS) * np.sqrt(rng.exponential(1.0, shot.rows))
        wave = wave + _star(shot, top + late, loud * (late < UNTIL))
        late = late + link(lambda n: 0.8 + rng.exponential(EVERY - 0.8, n))
    level = observatory.in_the_hall(shot) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _star(shot: Exposure, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    phase = np.exp(2j * np.pi * shot.rng.random(shot.rows))
    return np.asarray((high * phase)[:, None] * stars(top))
