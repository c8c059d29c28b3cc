"""The velodrome's cameras with their impulse responses: rows of `velodrome`, and what echoes.

numpy and pandas alone; what can be hidden is in `velodrome_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import velodrome
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.velodrome_camera import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Camera,
    bulges,
    first_paths,
    humming,
    levels_db,
)
from bench.challenge.families.velodrome_evening import raced
from bench.challenge.families.velodrome_track import Race
from bench.challenge.families.velodrome_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 136
OF_ROWS = np.repeat(np.arange(1, 9), [28, 25, 20, 14, 10, 7, 4, 2])
"""How many rows links have."""
FULL_DB = 118.5  # of levels: a count for each symbol
ECHOES, NEAREST, UNTIL = 36, 6.0, 96.0  # how many a link has; samples: the first, the last
LATER_DB = 1.7  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in velodrome.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the velodrome's own."""
    rng = np.random.default_rng([seed, 3308])
    evening = velodrome.weeded(raced(rng, "", OF_ROWS), drawn, near=True)
    clean = received(evening, rng)
    other = evening
    if not drawn.paired:
        other = velodrome.next_meeting(raced(rng, "", OF_ROWS), drawn)
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
    camera = Camera(table, seed, np.random.default_rng([seed, 3309, side]))
    put_in(camera, drawn.hidden, drawn.strength)
    return camera.told()


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
    return velodrome.as_published(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return raced(np.random.default_rng([seed, 3308]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that posts' own cameras make of rows, with complex waveforms."""
    race = Race(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(race.rows)
    symbols, noise = velodrome.counted(race)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_air(race, top) + sigma[:, None] * humming(rng, race.rows)
    at = first_paths(wave, sigma)
    own = race.per_link(lambda n: 0.018 * (rng.beta(3.0, 3.0, n) - 0.5))
    error = METRES * (at + AHEAD - top) + own + 0.0105 * velodrome.chances(rng, race.rows)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, race.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(velodrome.MEASURED, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_air(race: Race, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Echoes are where chances are that get fewer by a line until the last one; each is as large as
    chance has it, about a bell's flank. Of what is behind vans some comes straight.
    """
    link, rng = race.per_link, race.rng
    steel = race.through("metal") * link(lambda n: rng.uniform(0.45, 0.75, n))
    wave = _pulse(race, top, 1 - steel)
    busy = link(lambda n: 0.15 + 0.3 * rng.beta(1.6, 2.6, n))
    for _ in range(ECHOES):
        late = NEAREST + (UNTIL - NEAREST) * link(lambda n: 1 - np.sqrt(rng.random(n)))
        loud = busy * np.exp(-0.5 * (late / 42.0) ** 2) * rng.weibull(1.7, race.rows)
        wave = wave + _pulse(race, top + late, 0.72 * loud)
    level = velodrome.in_the_hall(race) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _pulse(race: Race, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = np.exp(2j * np.pi * race.rng.random(race.rows))
    return np.asarray((high * turn)[:, None] * bulges(top))
