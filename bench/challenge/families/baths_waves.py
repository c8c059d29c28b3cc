"""The baths' probes with their impulse responses: rows of `baths`, and what echoes.

numpy and pandas alone; what can be hidden is in `baths_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import baths
from bench.challenge.families.baths_day import bathed
from bench.challenge.families.baths_hall import Heat
from bench.challenge.families.baths_probe import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Probe,
    first_paths,
    gurgle,
    levels_db,
    ripples,
)
from bench.challenge.families.baths_wave_effects import LAWS, OF_RANGES, WAVES, put_in
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 144
OF_ROWS = np.repeat(np.arange(1, 10), [32, 26, 20, 14, 10, 7, 4, 2, 1])
"""How many rows links have."""
FULL_DB = 119.0  # of levels: a count for each symbol
BUNCHES, BUNCH_EVERY, RAYS, RAY_EVERY = 7, 13.0, 5, 3.0  # echoes come in bunches; samples
NEAREST, UNTIL = 5.3, 95.0  # samples: the first echo, the last
FALLS, FADES = 30.0, 8.0  # samples until bunches, and rays within these, are e times less
LATER_DB = 1.6  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in baths.CAUSES.items() if name in OF_RANGES}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the baths' own."""
    rng = np.random.default_rng([seed, 2807])
    day = baths.rarer(bathed(rng, "", OF_ROWS), drawn, near=True)
    clean = received(day, rng)
    other = day if drawn.paired else baths.day_after(bathed(rng, "", OF_ROWS), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    found, truth = _soaked(clean, drawn, seed, 1), _soaked(anew, drawn, seed, 2)
    four = (found, clean, simulated, truth)
    found, clean, simulated, truth = (_cut_out(one, drawn.listed) for one in four)
    return Tables(found, clean, simulated, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _soaked(table, drawn, seed, 20 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _soaked(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    probe = Probe(table, seed, np.random.default_rng([seed, 2809, side]))
    put_in(probe, drawn.hidden, drawn.strength)
    return probe.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut_out(table, "obstacles" in table)


def _cut_out(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(at) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES).astype(np.int64)
    sizes = np.hypot(np.stack([*table["cir_i"]]), np.stack([*table["cir_q"]]))
    kept = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    made = table.drop(columns=["cir_i", "cir_q"]).assign(
        cir=[*kept.astype(np.float32)], first_path_index=at - begin
    )
    return baths.without_courses(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return bathed(np.random.default_rng([seed, 2807]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that tags' own probes make of rows, with complex waveforms."""
    heat = Heat(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(heat.rows)
    symbols, noise = baths.counted(heat)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_air(heat, top) + sigma[:, None] * gurgle(rng, heat.rows)
    at = first_paths(wave, sigma)
    own = heat.each_link(lambda n: rng.uniform(-0.007, 0.007, n))
    error = METRES * (at + AHEAD - top) + own + 0.0112 * baths.cut_bell(rng, heat.rows)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, heat.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(baths.UNTOLD, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_air(heat: Heat, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes in bunches that links have.

    Bunches and rays within them come after waits of chance (Saleh, Valenzuela 1987). Of what is
    behind lockers some comes straight.
    """
    link, rng = heat.each_link, heat.rng
    steel = heat.through("metal") * link(lambda n: 0.5 + 0.33 * rng.beta(2.0, 2.0, n))
    wave = _pulse(heat, top, 1 - steel)
    busy = link(lambda n: 0.23 + 0.4 * rng.beta(1.5, 2.6, n))
    bunch = link(lambda n: NEAREST + rng.uniform(0.0, 3.0, n))
    for _ in range(BUNCHES):
        ray = np.zeros(heat.rows)
        for _ in range(RAYS):
            late = bunch + ray
            loud = (
                busy
                * np.exp(-bunch / FALLS - ray / FADES)
                * np.sqrt(rng.gamma(1.2, 0.83, heat.rows))
            )
            wave = wave + _pulse(heat, top + late, loud * (late < UNTIL))
            ray = ray + link(lambda n: 0.6 + rng.exponential(RAY_EVERY - 0.6, n))
        bunch = bunch + link(lambda n: rng.exponential(BUNCH_EVERY, n))
    level = baths.in_the_baths(heat) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _pulse(heat: Heat, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = heat.rng.uniform(-np.pi, np.pi, heat.rows)
    return np.asarray((high * np.exp(1j * turn))[:, None] * ripples(top))
