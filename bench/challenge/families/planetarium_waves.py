"""The planetarium's almanacs with their impulse responses: rows of `planetarium`, and what echoes.

numpy and pandas alone; what can be hidden is in `planetarium_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import planetarium
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.planetarium_almanac import (
    AHEAD,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Almanac,
    glows,
    levels_db,
    risings,
    starlight,
)
from bench.challenge.families.planetarium_dome import Seating
from bench.challenge.families.planetarium_show import shown
from bench.challenge.families.planetarium_wave_effects import LAWS, OF_RANGES, WAVES, put_in

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 17, 120
OF_ROWS = np.repeat(np.arange(1, 9), [34, 31, 22, 14, 10, 6, 4, 2])
"""How many rows links have."""
FULL_DB = 109.6  # of levels: a count for each symbol
GROUPS, EACH = 5, 4  # of echoes; echoes of a group
FIRST, APART, WITHIN = 6.0, 9.5, 2.4  # samples: to the first group, to each next, to each in these
DIES, GROUP_DIES = 24.0, 6.5  # samples to 1 / e, of groups and of those in these
LATER_DB = 2.0  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in planetarium.CAUSES.items() if name in {*OF_RANGES, *LAWS}}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the planetarium's own."""
    rng = np.random.default_rng([5210, seed])
    evening = planetarium.mixed(shown(rng, "", OF_ROWS), drawn, near=True)
    clean = received(evening, rng)
    if not drawn.paired:
        evening = planetarium.matinee(shown(rng, "", OF_ROWS), drawn)
    evening = pd.concat([evening] * drawn.ratio, ignore_index=True)
    simulated, anew = received(evening, rng), received(evening, rng)
    found, truth = _kept_in(clean, drawn, seed, 1), _kept_in(anew, drawn, seed, 2)
    made = [_printed(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(made[0], made[1], made[2], made[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _kept_in(table, drawn, seed, 50 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _kept_in(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    almanac = Almanac(table, seed, np.random.default_rng([5211, side, seed]))
    put_in(almanac, drawn.hidden, drawn.strength)
    return almanac.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _printed(table, "obstacles" in table)


def _printed(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (index.astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.stack([*table["cir_i"]]), np.stack([*table["cir_q"]]))
    rows = [
        size[one : one + SAMPLES].astype(np.float32) for size, one in zip(sizes, begin, strict=True)
    ]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(first_path_index=index - begin, cir=rows)
    if "obstacles" not in made:
        return planetarium.printed(made.assign(obstacles=None), False)
    return planetarium.printed(made, listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return shown(np.random.default_rng([5210, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that coves' own almanacs make of rows, with waveforms of whole counts."""
    seating = Seating(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(seating.rows)
    symbols, noise = planetarium.summed(seating)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _by_air(seating, top) + sigma[:, None] * starlight(rng, seating.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    at = risings(wave, sigma)
    strays = seating.each(lambda n: rng.normal(0.0, planetarium.OWN_M, n))
    strays = strays + 0.0105 * planetarium.twinkles(rng, seating.rows)
    error = METRES * (at + AHEAD - top) + strays
    every, first = levels_db(wave, at, sigma) - 20 * np.log10(full)
    made = (error, seating.far + error, every, first, noise, symbols)
    measured = rows.assign(**dict(zip(planetarium.MEASURED, made, strict=True)))
    measured = measured.assign(first_path_index=at, sample_period_ns=SAMPLE_NS)
    return measured.assign(cir_i=list(wave.real), cir_q=list(wave.imag))


def _by_air(seating: Seating, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have, in groups.

    Groups die off, and echoes within these (Saleh and Valenzuela 1987). Of what is behind the
    drum some comes straight.
    """
    each, rng = seating.each, seating.rng
    drum = seating.behind("metal") * each(lambda n: 0.4 + 0.34 * rng.beta(2.0, 2.0, n))
    wave = _glow_of(seating, top, 1 - drum)
    loud = each(lambda n: rng.triangular(0.42, 0.6, 0.85, n))
    after = np.full(seating.rows, FIRST)
    for _ in range(GROUPS):
        since = np.zeros(seating.rows)
        for _ in range(EACH):
            size = loud * np.exp(-after / DIES - since / GROUP_DIES)
            size = size * np.sqrt(rng.gamma(1.4, 1 / 1.4, seating.rows))
            wave = wave + _glow_of(seating, top + after + since, size)
            since = since + each(lambda n: rng.exponential(WITHIN, n))
        after = after + each(lambda n: rng.gamma(2.5, APART / 2.5, n))
    level = planetarium.under_the_dome(seating) - LATER_DB
    return np.asarray(10 ** (level / 20)[:, None] * wave)


def _glow_of(seating: Seating, top: Floats, high: Floats) -> Complexes:
    """Return a pulse for each row, so high, at a phase by chance [n, k]."""
    phase = np.exp(2j * np.pi * seating.rng.random(seating.rows))
    return np.asarray((high * phase)[:, None] * glows(top))
