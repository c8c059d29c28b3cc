"""The tram shed's bells with their impulse responses: rows of `tramshed`, and its echoes.

numpy and pandas alone; what can be hidden is in `tramshed_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import tramshed
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.tramshed_bell import (
    AHEAD,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Bell,
    arcing,
    levels_db,
    peals,
    rung,
)
from bench.challenge.families.tramshed_depot import Fares
from bench.challenge.families.tramshed_roster import worked
from bench.challenge.families.tramshed_wave_effects import LAWS, OF_RANGES, WAVES, hide

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 19, 186
OF_ROWS = np.repeat(np.arange(1, 9), [49, 35, 24, 14, 9, 5, 2, 1])
"""How many rows links have."""
FULL_DB = 113.0  # of levels: a count for each symbol
CLUSTERS, RAYS, SOONEST = 5, 8, 6.5  # groups of echoes; of each; samples to the first
CLUSTER_EACH, RAY_EACH = 19.0, 2.9  # samples between, in the mean
CLUSTER_FALLS, RAY_FALLS = 42.0, 9.0  # samples in which groups and their echoes fall to 1 / e
UNLIKE, STEADY = 0.5, 0.62  # parts by which links' echoes differ; of echoes that do not fade
LATER_DB = 2.6  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {n: c for n, c in tramshed.CAUSES.items() if n in OF_RANGES or n in LAWS}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the tram shed's own."""
    rng = np.random.default_rng([9510, seed])
    day = tramshed.mixed_rows(worked(rng, "", OF_ROWS), drawn, far=False)
    clean = received(day, rng)
    if not drawn.paired:
        day = tramshed.day_after(worked(rng, "", OF_ROWS), drawn)
    copies = pd.concat([day] * drawn.ratio, ignore_index=True)
    simulated, anew = received(copies, rng), received(copies, rng)
    found, truth = _hiding(clean, drawn, seed, 1), _hiding(anew, drawn, seed, 2)
    told, plain, other, true = (
        _kept(one, drawn.listed) for one in (found, clean, simulated, truth)
    )
    return Tables(told, plain, other, true)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 60 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    bell = Bell(table, seed, np.random.default_rng([9511, side, seed]))
    hide(bell, drawn.hidden, drawn.strength)
    return bell.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, "obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = np.asarray(table["first_path_index"], np.float64)
    begin = np.clip(index.astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    inphase, other = (np.vstack(table[part].tolist()) for part in ("cir_i", "cir_q"))
    sizes = np.hypot(inphase, other).astype(np.float32)
    cirs = [one[k : k + SAMPLES] for one, k in zip(sizes, begin.tolist(), strict=True)]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(cir=cirs, first_path_index=index - begin)
    return tramshed.written(made if "obstacles" in made else made.assign(obstacles=""), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([9510, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that bells themselves make of rows, with waveforms of whole counts."""
    fares = Fares(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(fares.rows)
    symbols, noise = tramshed.gathered(fares)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _echoing(fares, top) + sigma[:, None] * arcing(rng, fares.rows)
    wave = np.round(wave)
    index = rung(wave)
    own = fares.each_link(lambda n: tramshed.OWN_M * rng.standard_normal(n).clip(-2.2, 2.2))
    own = own + 0.0145 * tramshed.jolts(rng, fares.rows)
    error = LIGHT_M_NS * SAMPLE_NS * (index + AHEAD - top) + own
    every, first = levels_db(wave, index, sigma) - 20 * np.log10(full)
    made = (error, fares.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(tramshed.TOLD, made, strict=True)),
        sample_period_ns=SAMPLE_NS, first_path_index=index,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip


def echoes(fares: Fares) -> tuple[Floats, Floats]:
    """Return how many samples after straight ways echoes come, and how high [echoes, n].

    In groups, each of which falls soon, and later groups are lower (Saleh and Valenzuela 1987);
    alike within links.
    """
    rng, each_link = fares.rng, fares.each_link
    late, high = [], []
    begun = SOONEST + 0.0 * fares.far
    for _ in range(CLUSTERS):
        since = 0.0 * begun
        for _ in range(RAYS):
            late.append(begun + since)
            high.append(np.exp(-(begun - SOONEST) / CLUSTER_FALLS - since / RAY_FALLS))
            since = since + RAY_EACH * each_link(lambda n: 0.25 + rng.exponential(0.75, n))
        begun = begun + CLUSTER_EACH * each_link(lambda n: rng.uniform(0.5, 1.5, n))
    return np.stack(late), np.stack(high)


def _echoing(fares: Fares, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Each is larger or less on a link, and of each a part fades from row to row. Of what is behind
    trams some comes straight.
    """
    rng, each_link, rows = fares.rng, fares.each_link, fares.rows
    kept = 1 - fares.through("metal") * each_link(lambda n: rng.uniform(0.36, 0.64, n))
    wave = (kept * np.exp(2j * np.pi * rng.random(rows)))[:, None] * peals(top)
    loud = each_link(lambda n: rng.uniform(0.22, 0.5, n))
    for late, high in zip(*echoes(fares), strict=True):
        unlike = each_link(lambda n: 1 + UNLIKE * rng.uniform(-1.0, 1.0, n))
        fades = STEADY + np.sqrt(1 - STEADY**2) * (rng.normal(0.0, np.sqrt(0.5), (rows, 2))
                                                   @ np.array([1.0, 1.0j]))  # fmt: skip
        size = loud * unlike * high * fades * np.exp(2j * np.pi * rng.random(rows))
        wave += size[:, None] * peals(top + late)
    level = 10 ** ((tramshed.in_the_shed(fares) - LATER_DB) / 20)
    return np.asarray(level[:, None] * wave)
