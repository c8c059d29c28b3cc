"""The breadworks's balances with their impulse responses: rows of `breadworks`, and what echoes.

numpy and pandas alone; what can be hidden is in `breadworks_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import breadworks
from bench.challenge.families.breadworks_balance import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Balance,
    first_paths,
    kneading,
    levels_db,
    loaves,
)
from bench.challenge.families.breadworks_hall import Bake
from bench.challenge.families.breadworks_night import baked
from bench.challenge.families.breadworks_wave_effects import LAWS, OF_RANGES, WAVES, put_in
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 19, 158
OF_ROWS = np.repeat(np.arange(1, 9), [30, 28, 21, 15, 10, 7, 4, 2])
"""How many rows links have."""
FULL_DB = 116.4  # of levels: a count for each symbol
ECHOES, NEAREST, LASTS = 24, 6.6, 66.0  # how many a link has; samples: the first, and all of these
LATER_DB = 2.0  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in breadworks.CAUSES.items() if name in (*OF_RANGES, *LAWS)}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the breadworks's own."""
    rng = np.random.default_rng([seed, 3710])
    night = breadworks.sorted_out(baked(rng, "", OF_ROWS), drawn, near=True)
    clean = received(night, rng)
    other = night if drawn.paired else breadworks.another_night(baked(rng, "", OF_ROWS), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    four = (_weighed(clean, drawn, seed, 1), clean, simulated, _weighed(anew, drawn, seed, 2))
    found, bare, made, truth = (_kept(one, drawn.listed) for one in four)
    return Tables(found, bare, made, truth)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _weighed(table, drawn, seed, 30 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _weighed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    balance = Balance(table, seed, np.random.default_rng([seed, 3711, side]))
    put_in(balance, drawn.hidden, drawn.strength)
    return balance.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES).astype(np.int64)
    sizes = np.hypot(np.stack([*table["cir_i"]]), np.stack([*table["cir_q"]]))
    kept = [one[k : k + SAMPLES].astype(np.float32) for one, k in zip(sizes, begin, strict=True)]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(cir=kept, first_path_index=index - begin)
    return breadworks.shown(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return baked(np.random.default_rng([seed, 3710]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that corbels' own balances make of rows, with waveforms of whole counts."""
    bake = Bake(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(bake.rows)
    symbols, noise = breadworks.added_up(bake)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_air(bake, top) + sigma[:, None] * kneading(rng, bake.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    at = first_paths(wave, sigma)
    own = bake.by_link(lambda n: rng.triangular(-0.011, 0.0, 0.011, n))
    error = METRES * (at + AHEAD - top) + own + 0.0115 * breadworks.strays(rng, bake.rows)
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, bake.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(breadworks.MEASURED, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_air(bake: Bake, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Each echo comes within a time of its own, ever longer ones; it is as large as chance has it,
    ever less by e. Of what is behind steel some comes straight.
    """
    link, rng = bake.by_link, bake.rng
    steel = bake.behind("metal") * link(lambda n: rng.uniform(0.5, 0.71, n))
    wave = _loaf_of(bake, top, 1 - steel)
    busy = link(lambda n: rng.triangular(0.3, 0.5, 0.8, n))
    for k in range(ECHOES):
        after = NEAREST + LASTS * ((k + link(lambda n: rng.random(n))) / ECHOES) ** 1.4
        size = 0.7 * busy * np.exp(-after / 23.0) * rng.rayleigh(0.8, bake.rows)
        wave = wave + _loaf_of(bake, top + after, size)
    level = breadworks.in_the_hall(bake) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _loaf_of(bake: Bake, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = np.exp(1j * bake.rng.uniform(0.0, 2 * np.pi, bake.rows))
    return np.asarray((high * turn)[:, None] * loaves(top))
