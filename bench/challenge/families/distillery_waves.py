"""The distillery's spirit safe with its impulse responses: rows of `distillery`, and what echoes.

numpy and pandas alone; what can be hidden is in `distillery_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import distillery
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.distillery_house import Run
from bench.challenge.families.distillery_safe import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Safe,
    drops,
    seething,
    strengths_db,
    tellings,
)
from bench.challenge.families.distillery_shift import worked
from bench.challenge.families.distillery_wave_effects import LAWS, OF_RANGES, WAVES, hide

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 146
OF_ROWS = np.repeat(np.arange(1, 9), [38, 35, 23, 15, 9, 6, 3, 2])
"""How many rows links have."""
FULL_DB = 112.0  # of levels: a count for each symbol
CLUSTERS, RAYS = 4, 8  # of echoes
FIRST, BETWEEN, WITHIN = 5.6, 17.0, 3.4  # samples to the first; between clusters; between rays
FADES, DIES = 26.0, 11.0  # samples to 1 / e of powers of clusters; of rays in one
SHAPE = 1.8  # of powers of rays (Nakagami)
LATER_DB = 1.9  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {n: c for n, c in distillery.CAUSES.items() if n in OF_RANGES or n in LAWS}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the distillery's own."""
    rng = np.random.default_rng([6210, seed])
    day = distillery.some_of(worked(rng, "", OF_ROWS), drawn, far=False)
    clean = received(day, rng)
    if not drawn.paired:
        day = distillery.next_day(worked(rng, "", OF_ROWS), drawn)
    often = pd.concat([day] * drawn.ratio, ignore_index=True)
    once, anew = (received(often, rng) for _ in range(2))
    found, truth = _hiding(clean, drawn, seed, 1), _hiding(anew, drawn, seed, 2)
    four = [_booked(one, drawn.listed) for one in (found, clean, once, truth)]
    return Tables(four[0], four[1], four[2], four[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 80 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    safe = Safe(table, seed, np.random.default_rng([6211, side, seed]))
    hide(safe, drawn.hidden, drawn.strength)
    return safe.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _booked(table, "obstacles" in table)


def _booked(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    told = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(told) - LEAD, 0, WIDE_SAMPLES - SAMPLES).astype(np.int64)
    sizes = np.hypot(np.stack(table["cir_i"].tolist()), np.stack(table["cir_q"].tolist()))
    kept = [row[at : at + SAMPLES] for row, at in zip(sizes, begin, strict=True)]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(
        cir=[one.astype(np.float32) for one in kept], first_path_index=told - begin
    )
    if "obstacles" not in made:
        return distillery.booked(made.assign(obstacles=None), False)
    return distillery.booked(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([6210, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that safes themselves make of rows, with waveforms of whole counts."""
    run = Run(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(run.rows)
    symbols, noise = distillery.summed(run)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(run, top) + sigma[:, None] * seething(rng, run.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    told = tellings(wave)
    strays = run.by_link(lambda n: distillery.OWN_M * rng.uniform(-1.73, 1.73, n))
    strays = strays + 0.011 * distillery.odds(rng, run.rows)
    error = METRES * (told - top + AHEAD) + strays
    every, first = strengths_db(wave, told, sigma) - 20 * np.log10(full)
    made = (error, run.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(distillery.READ, made, strict=True)),
        sample_period_ns=SAMPLE_NS, first_path_index=told,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip


def _by_air(run: Run, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Rays come in clusters, and both die off evenly (Saleh and Valenzuela 1987); powers are gammas.
    Of what is behind copper some comes straight.
    """
    by_link, rng = run.by_link, run.rng
    copper = run.through("metal") * by_link(lambda n: rng.uniform(0.4, 0.68, n))
    wave = _of_chance(run, top, 1 - copper)
    loud = by_link(lambda n: rng.uniform(0.22, 0.46, n))
    begins = np.zeros(run.rows)
    for _ in range(CLUSTERS):
        since = np.zeros(run.rows)
        for _ in range(RAYS):
            power = np.exp(-begins / FADES - since / DIES) * rng.gamma(SHAPE, 1 / SHAPE, run.rows)
            wave = wave + _of_chance(run, top + FIRST + begins + since, loud * np.sqrt(power))
            since = since + by_link(lambda n: rng.exponential(WITHIN, n))
        begins = begins + by_link(lambda n: rng.exponential(BETWEEN, n).clip(3.0))
    level = distillery.under_the_roof(run) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _of_chance(run: Run, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    phase = np.exp(2j * np.pi * run.rng.random(run.rows))
    return np.asarray((phase * high)[:, None] * drops(top))
