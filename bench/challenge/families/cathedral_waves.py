"""The cathedral's lecterns with their impulse responses: rows of `cathedral`, and what echoes.

numpy and pandas alone; what can be hidden is in `cathedral_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import cathedral
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.cathedral_lectern import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Lectern,
    chimes,
    levels_db,
    readings,
    sough,
)
from bench.challenge.families.cathedral_nave import Vigil
from bench.challenge.families.cathedral_office import held
from bench.challenge.families.cathedral_wave_effects import LAWS, OF_RANGES, WAVES, hide

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 130
OF_ROWS = np.repeat(np.arange(1, 9), [36, 33, 22, 15, 10, 6, 3, 2])
"""How many rows links have."""
FULL_DB = 105.0  # of levels: a count for each symbol
RAYS, FIRST, SPAN = 26, 5.8, 88.0  # of echoes; samples to the first; to the last
DENSER, HALVES, STEEP = 1.25, 12.0, 0.9  # by a power of time; samples; of how sizes fall
DIES = 60.0  # samples to 1 / e, besides
LATER_DB = 1.4  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in cathedral.CAUSES.items() if name in {*OF_RANGES, *LAWS}}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the cathedral's own."""
    rng = np.random.default_rng([5410, seed])
    feast = cathedral.of_a_mix(held(rng, "", OF_ROWS), drawn, nearer=True)
    clean = received(feast, rng)
    if not drawn.paired:
        feast = cathedral.octave(held(rng, "", OF_ROWS), drawn)
    often = pd.concat([feast] * drawn.ratio, ignore_index=True)
    simulated, other = received(often, rng), received(often, rng)
    found, truth = _hiding(clean, drawn, seed, 1), _hiding(other, drawn, seed, 2)
    four = [_written(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(four[0], four[1], four[2], four[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 60 + len(table))
    return made if drawn.listed else made.drop(columns=["obstacles"])


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    lectern = Lectern(table, seed, np.random.default_rng([5411, seed, side]))
    hide(lectern, drawn.hidden, drawn.strength)
    return lectern.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _written(table, "obstacles" in table)


def _written(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    at = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(at).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.abs(np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]]))
    kept = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    made = table.drop(columns=["cir_i", "cir_q"])
    made = made.assign(first_path_index=at - begin, cir=[*kept.astype(np.float32)])
    if "obstacles" not in made:
        made["obstacles"] = None
        listed = False
    return cathedral.written(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return held(np.random.default_rng([5410, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that lecterns themselves make of rows, with waveforms of whole counts."""
    vigil = Vigil(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(vigil.rows)
    symbols, noise = cathedral.added_up(vigil)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    heard = full[:, None] * _by_air(vigil, top) + sigma[:, None] * sough(rng, vigil.rows)
    wave = np.rint(heard.real) + 1j * np.rint(heard.imag)
    at = readings(wave)
    strays = vigil.each(lambda n: cathedral.OWN_M * rng.standard_normal(n))
    strays = strays + 0.0115 * cathedral.chances(rng, vigil.rows)
    error = METRES * (at + AHEAD - top) + strays
    level, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, vigil.far + error, level, first, noise, symbols)
    return rows.assign(
        **dict(zip(cathedral.READ, made, strict=True)),
        first_path_index=at,
        sample_period_ns=SAMPLE_NS,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _by_air(vigil: Vigil, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Echoes are denser the later, as of images of a room (Polack 1992), and fall by a power of time.
    Of what is behind the gate some comes straight.
    """
    each, rng = vigil.each, vigil.rng
    gate = vigil.behind("metal") * each(lambda n: rng.uniform(0.42, 0.72, n))
    wave = _at_any_phase(vigil, top, 1 - gate)
    loud = each(lambda n: 0.38 + 0.4 * rng.beta(2.2, 2.0, n))
    for _ in range(RAYS):
        since = each(lambda n: SPAN * rng.random(n) ** (1 / DENSER))
        size = loud * (1 + since / HALVES) ** -STEEP
        size = size * np.sqrt(rng.exponential(1.0, vigil.rows)) * np.exp(-since / DIES)
        wave = wave + _at_any_phase(vigil, top + FIRST + since, size)
    level = cathedral.under_the_vault(vigil) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _at_any_phase(vigil: Vigil, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    turn = vigil.rng.uniform(-np.pi, np.pi, vigil.rows)
    return np.asarray((high * np.exp(1j * turn))[:, None] * chimes(top))
