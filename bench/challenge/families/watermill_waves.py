"""The watermill's hoppers with their impulse responses: rows of `watermill`, and what echoes there.

numpy and pandas alone; what can be hidden is in `watermill_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import watermill
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.watermill_day import ground
from bench.challenge.families.watermill_hopper import (
    AHEAD,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Hopper,
    grains,
    levels_db,
    trundling,
    weighed,
)
from bench.challenge.families.watermill_race import Grist
from bench.challenge.families.watermill_wave_effects import LAWS, OF_RANGES, WAVES, hide

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 14, 118
OF_ROWS = np.repeat(np.arange(1, 9), [41, 34, 23, 15, 9, 6, 3, 2])
"""How many rows links have."""
FULL_DB = 110.0  # of levels: a count for each symbol
PATHS, SOONEST, GAP, SHAPE = 34, 4.6, 2.1, 0.8  # echoes; samples to the first, between; of gaps
FADES, STEEP = 7.0, 1.35  # samples; of a power of time by which echoes fade
UNLIKE_DB, FADING = 3.0, 2.2  # by which links' echoes scatter; of rows' (Nakagami's m)
LATER_DB = 2.1  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {n: c for n, c in watermill.CAUSES.items() if n in OF_RANGES or n in LAWS}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the watermill's own."""
    rng = np.random.default_rng([8410, seed])
    day = watermill.sifted(ground(rng, "", OF_ROWS), drawn, far=False)
    clean = received(day, rng)
    if not drawn.paired:
        day = watermill.another(ground(rng, "", OF_ROWS), drawn)
    whole = pd.concat([day] * drawn.ratio, ignore_index=True)
    simulated, true = received(whole, rng), received(whole, rng)
    four = (_hiding(clean, drawn, seed, 1), clean, simulated, _hiding(true, drawn, seed, 2))
    kept = [_kept(one, drawn.listed) for one in four]
    return Tables(kept[0], kept[1], kept[2], kept[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 50 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    hopper = Hopper(table, seed, np.random.default_rng([8411, seed, side]))
    hide(hopper, drawn.hidden, drawn.strength)
    return hopper.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, "obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES).astype(np.int64)
    real, imag = (np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q"))
    sizes = np.hypot(real, imag)[np.arange(len(table))[:, None],
                                 begin[:, None] + np.arange(SAMPLES)]  # fmt: skip
    made = table.drop(columns=["cir_i", "cir_q"]).assign(
        cir=[*sizes.astype(np.float32)], first_path_index=index - begin
    )
    return watermill.bagged(made if "obstacles" in made else made.assign(obstacles=""), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return ground(np.random.default_rng([8410, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that hoppers themselves make of rows, with waveforms of whole counts."""
    grist = Grist(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(grist.rows)
    symbols, noise = watermill.counted(grist)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _echoing(grist, top) + sigma[:, None] * trundling(rng, grist.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    index = weighed(wave)
    own = watermill.OWN_M * grist.each(lambda n: rng.uniform(-1.6, 1.6, n))
    own = own + 0.011 * watermill.husks(rng, grist.rows)
    error = LIGHT_M_NS * SAMPLE_NS * (index - top + AHEAD) + own
    every, first = levels_db(wave, index, sigma) - 20 * np.log10(full)
    made = (error, grist.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(watermill.TOLD, made, strict=True)),
        sample_period_ns=SAMPLE_NS, first_path_index=index,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip


def arrivals(grist: Grist) -> Floats:
    """Return how many samples after straight ways echoes come [PATHS, n], alike within links.

    Gaps are of Weibull's law, many short and some long: echoes come bunched.
    """
    gaps = np.stack([grist.each(lambda n: grist.rng.weibull(SHAPE, n)) for _ in range(PATHS)])
    return np.asarray(SOONEST + GAP * np.cumsum(gaps, axis=0))


def _echoing(grist: Grist, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Echoes fade by a power of time, as in halls that are lit ever more thinly; each is larger or
    less by dB on a link and by Nakagami's law from row to row. Of what is behind iron some comes
    straight.
    """
    rng, each = grist.rng, grist.each
    iron = grist.behind("metal") * each(lambda n: 0.42 + 0.3 * rng.beta(2.0, 2.0, n))
    wave = ((1 - iron) * _turned(rng, grist.rows))[:, None] * grains(top)
    loud = each(lambda n: rng.uniform(0.4, 0.95, n))
    for late in arrivals(grist):
        unlike = each(lambda n: 10 ** (UNLIKE_DB / 20 * rng.standard_normal(n).clip(-2.0, 2.0)))
        row = np.sqrt(rng.gamma(FADING, 1 / FADING, grist.rows))
        high = loud * unlike * row * (1 + late / FADES) ** -STEEP
        heard = np.flatnonzero(top + late < WIDE_SAMPLES + 4.0)
        turned = (high * _turned(rng, grist.rows))[heard, None]
        wave[heard] += turned * grains((top + late)[heard])
    level = 10 ** ((watermill.about_the_mill(grist) - LATER_DB) / 20)
    return np.asarray(level[:, None] * wave)


def _turned(rng: np.random.Generator, rows: int) -> Complexes:
    """Return phases by chance [rows]."""
    return np.asarray(np.exp(2j * np.pi * rng.random(rows)))
