"""The mint's assay with its impulse responses: rows of `mint`, and what echoes about the court.

numpy and pandas alone; what can be hidden is in `mint_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import mint
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.mint_assay import (
    AHEAD,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Assay,
    assayed,
    coins,
    jingling,
    levels_db,
)
from bench.challenge.families.mint_court import Tally
from bench.challenge.families.mint_turns import passed
from bench.challenge.families.mint_wave_effects import LAWS, OF_RANGES, WAVES, hide

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 17, 168
OF_ROWS = np.repeat(np.arange(1, 9), [39, 33, 22, 15, 9, 6, 3, 2])
"""How many rows links have."""
FULL_DB = 113.0  # of levels: a count for each symbol
BINS, WIDE, FIRST = 64, 1.7, 5.2  # of time; samples of each; to the first
THICK, SWELLS, LASTS = 0.3, 2.3, 9.0  # of bins that have an echo; after one; samples to 1 / e
STRETCH, UNLIKE_DB = 0.72, 3.6  # of how echoes fade; by which these scatter
LATER_DB = 1.8  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {n: c for n, c in mint.CAUSES.items() if n in OF_RANGES or n in LAWS}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the mint's own."""
    rng = np.random.default_rng([7310, seed])
    day = mint.picked(passed(rng, "", OF_ROWS), drawn, far=False)
    clean = received(day, rng)
    if not drawn.paired:
        day = mint.other_day(passed(rng, "", OF_ROWS), drawn)
    whole = pd.concat([day] * drawn.ratio, ignore_index=True)
    simulated, anew = received(whole, rng), received(whole, rng)
    wide = (_hiding(clean, drawn, seed, 1), clean, simulated, _hiding(anew, drawn, seed, 2))
    made = [_entered(one, drawn.listed) for one in wide]
    return Tables(made[0], made[1], made[2], made[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 90 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    assay = Assay(table, seed, np.random.default_rng([7311, side, seed]))
    hide(assay, drawn.hidden, drawn.strength)
    return assay.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _entered(table, "obstacles" in table)


def _entered(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    parts = (np.array([*table[name]], np.float64) for name in ("cir_i", "cir_q"))
    sizes = np.hypot(*parts).astype(np.float32)
    kept = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    made = table.drop(columns=["cir_i", "cir_q"]).assign(
        cir=[*kept], first_path_index=index - begin
    )
    if "obstacles" in made:
        return mint.entered(made, listed)
    return mint.entered(made.assign(obstacles=None), False)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return passed(np.random.default_rng([7310, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that assays themselves make of rows, with waveforms of whole counts."""
    tally = Tally(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(tally.rows)
    symbols, noise = mint.counted(tally)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(tally, top) + sigma[:, None] * jingling(rng, tally.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    index = assayed(wave)
    own = tally.links(lambda n: mint.OWN_M * rng.triangular(-2.4, 0.0, 2.4, n))
    own = own + 0.0115 * mint.flips(rng, tally.rows)
    error = LIGHT_M_NS * SAMPLE_NS * (index - top + AHEAD) + own
    every, first = levels_db(wave, index, sigma) - 20 * np.log10(full)
    made = (error, tally.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(mint.TOLD, made, strict=True)),
        sample_period_ns=SAMPLE_NS, first_path_index=index,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip


def thronged(tally: Tally) -> Floats:
    """Return which bins have an echo, 1 or 0 [BINS, n], alike within links.

    One is the likelier right after another (Turin 1972, Suzuki 1977).
    """
    made = np.zeros((BINS, tally.rows))
    before = np.zeros(tally.rows)
    for number in range(BINS):
        odds = THICK * np.where(before > 0, SWELLS, 1.0) * (1 - 0.4 * number / BINS)
        before = (tally.links(lambda n: tally.rng.random(n)) < odds).astype(np.float64)
        made[number] = before
    return made


def _by_air(tally: Tally, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Echoes come in throngs, and fade by a stretched exponential (Kohlrausch 1854); each is larger or
    less by dB. Of what is behind racks some comes straight.
    """
    rng, links = tally.rng, tally.links
    racks = tally.meets("metal") * links(lambda n: rng.triangular(0.36, 0.5, 0.64, n))
    wave = np.zeros((tally.rows, WIDE_SAMPLES), np.complex128)
    _coin(tally, wave, top, 1 - racks)
    loud = links(lambda n: 0.36 + 0.4 * rng.beta(2.0, 3.0, n))
    for number, there in enumerate(thronged(tally)):
        late = FIRST + WIDE * (number + links(lambda n: rng.random(n)))
        unlike = 10 ** (UNLIKE_DB / 20 * rng.standard_normal(tally.rows).clip(-2.2, 2.2))
        high = loud * np.exp(-0.5 * (late / LASTS) ** STRETCH) * unlike
        _coin(tally, wave, top + late, there * high)
    return np.asarray(10 ** ((mint.about_the_court(tally) - LATER_DB) / 20)[:, None] * wave)


def _coin(tally: Tally, wave: Complexes, top: Floats, high: Floats) -> None:
    """Put a pulse on each row, so high, at a phase by chance, where it is any."""
    turn = np.exp(1j * tally.rng.uniform(0.0, 2 * np.pi, tally.rows))
    own = np.flatnonzero(high)
    wave[own] += (turn * high)[own, None] * coins(top[own])
