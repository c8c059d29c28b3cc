"""The ice rink's timers with their impulse responses: rows of `icerink`, and what echoes.

numpy and pandas alone; what can be hidden is in `icerink_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import icerink
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.icerink_rink import Period
from bench.challenge.families.icerink_session import skated
from bench.challenge.families.icerink_timer import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Timer,
    first_paths,
    levels_db,
    scraping,
    shouts,
)
from bench.challenge.families.icerink_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 17, 124
OF_ROWS = np.repeat(np.arange(1, 9), [30, 28, 22, 15, 10, 7, 4, 2])
"""How many rows links have."""
FULL_DB = 112.6  # of levels: a count for each symbol
ECHOES, NEAREST, LASTS = 22, 6.4, 62.0  # how many a link has; samples: the first, and all of these
LATER_DB = 1.9  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in icerink.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the ice rink's own."""
    rng = np.random.default_rng([seed, 3610])
    day = icerink.mixed(skated(rng, "", OF_ROWS), drawn, near=True)
    clean = received(day, rng)
    other = day if drawn.paired else icerink.another_day(skated(rng, "", OF_ROWS), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    four = (_timed(clean, drawn, seed, 1), clean, simulated, _timed(anew, drawn, seed, 2))
    found, clean, simulated, truth = (_kept(one, drawn.listed) for one in four)
    return Tables(found, clean, simulated, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _timed(table, drawn, seed, 30 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _timed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    timer = Timer(table, seed, np.random.default_rng([seed, 3611, side]))
    put_in(timer, drawn.hidden, drawn.strength)
    return timer.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    parts = (np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q"))
    sizes = np.hypot(*parts)
    kept = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    made = table.drop(columns=["cir_i", "cir_q"])
    made = made.assign(cir=list(kept.astype(np.float32)), first_path_index=index - begin)
    return icerink.as_shown(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return skated(np.random.default_rng([seed, 3610]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that mullions' own timers make of rows, with waveforms of whole counts."""
    period = Period(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(period.rows)
    symbols, noise = icerink.added_up(period)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(period, top) + sigma[:, None] * scraping(rng, period.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    at = first_paths(wave, sigma)
    own = period.each_link(lambda n: rng.uniform(-0.009, 0.009, n))
    error = METRES * (at + AHEAD - top) + own + 0.0115 * icerink.chances(rng, period.rows)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, period.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(icerink.MEASURED, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=list(wave.real),
        cir_q=list(wave.imag),
    )


def _by_air(period: Period, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Echoes come anywhere within some time, early ones the more often; each is as large as chance
    has it, ever less by e. Of what is behind steel some comes straight.
    """
    link, rng = period.each_link, period.rng
    steel = period.through("metal") * link(lambda n: rng.triangular(0.5, 0.68, 0.8, n))
    wave = _shout_of(period, top, 1 - steel)
    busy = link(lambda n: 0.3 + 0.5 * rng.beta(1.6, 2.0, n))
    for _ in range(ECHOES):
        after = NEAREST + link(lambda n: LASTS * rng.beta(0.8, 1.4, n))
        loud = busy * np.exp(-after / 22.0) * rng.weibull(1.7, period.rows)
        wave = wave + _shout_of(period, top + after, 0.77 * loud)
    level = icerink.in_the_hall(period) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _shout_of(period: Period, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = np.exp(2j * np.pi * period.rng.random(period.rows))
    return np.asarray((high * turn)[:, None] * shouts(top))
