"""The gasworks' meters with their impulse responses: rows of `gasworks`, and what echoes there.

numpy and pandas alone; what can be hidden is in `gasworks_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import gasworks
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.gasworks_meter import (
    AHEAD,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Meter,
    hissing,
    levels_db,
    metered,
    puffs,
)
from bench.challenge.families.gasworks_shift import worked
from bench.challenge.families.gasworks_wave_effects import LAWS, OF_RANGES, WAVES, hide
from bench.challenge.families.gasworks_yard import Charge

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 15, 184
OF_ROWS = np.repeat(np.arange(1, 9), [46, 33, 23, 14, 9, 6, 3, 1])
"""How many rows links have."""
FULL_DB = 111.0  # of levels: a count for each symbol
GROUPS, EACH, SOONEST = 5, 7, 6.4  # groups of echoes; echoes of each; samples to the first
APART, WITHIN = 15.0, 2.3  # samples between groups, and between echoes of one
GROUPS_FADE, FADE = 30.0, 9.0  # samples in which groups and echoes of one fade to 1 / e
UNLIKE, FADING = 0.36, 2.2  # e-folds by which links' echoes scatter; of rows' (Weibull's shape)
LATER_DB = 1.9  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {n: c for n, c in gasworks.CAUSES.items() if n in OF_RANGES or n in LAWS}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the gasworks' own."""
    rng = np.random.default_rng([9210, seed])
    shift = gasworks.some_of(worked(rng, "", OF_ROWS), drawn, far=False)
    clean = received(shift, rng)
    if not drawn.paired:
        shift = gasworks.next_shift(worked(rng, "", OF_ROWS), drawn)
    whole = pd.concat([shift] * drawn.ratio, ignore_index=True)
    simulated, anew = received(whole, rng), received(whole, rng)
    found, truth = _hiding(clean, drawn, seed, 1), _hiding(anew, drawn, seed, 2)
    kept = [_kept(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(kept[0], kept[1], kept[2], kept[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 70 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    meter = Meter(table, seed, np.random.default_rng([9211, side, seed]))
    hide(meter, drawn.hidden, drawn.strength)
    return meter.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, "obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    parts = [np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q")]
    sizes = np.hypot(*parts).astype(np.float32)
    cut = [one[at : at + SAMPLES] for one, at in zip(sizes, begin.tolist(), strict=True)]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(cir=cut, first_path_index=index - begin)
    return gasworks.booked(made if "obstacles" in made else made.assign(obstacles=""), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([9210, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that meters themselves make of rows, with waveforms of whole counts."""
    charge = Charge(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(charge.rows)
    symbols, noise = gasworks.counted(charge)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _echoing(charge, top) + sigma[:, None] * hissing(rng, charge.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    index = metered(wave)
    own = gasworks.OWN_M * charge.per_link(lambda n: 2 * rng.beta(1.5, 1.5, n) - 1)
    own = own + 0.0112 * gasworks.sparks(rng, charge.rows)
    error = LIGHT_M_NS * SAMPLE_NS * (index - top + AHEAD) + own
    every, first = levels_db(wave, index, sigma) - 20 * np.log10(full)
    made = (error, charge.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(gasworks.TOLD, made, strict=True)),
        sample_period_ns=SAMPLE_NS, first_path_index=index,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip


def arrivals(charge: Charge) -> tuple[Floats, Floats]:
    """Return how many samples after straight ways echoes come, and how high [GROUPS * EACH, n].

    In groups, as from one tank after another, that fade as wholes and within (Saleh and
    Valenzuela 1987); alike within links.
    """
    late, high = [], []
    begins = SOONEST + 0.0 * charge.far
    for _ in range(GROUPS):
        within = 0.0 * begins
        for _ in range(EACH):
            late.append(begins + within)
            high.append(np.exp(-(begins - SOONEST) / GROUPS_FADE - within / FADE))
            within = within + charge.per_link(lambda n: WITHIN * charge.rng.gamma(2.0, 0.5, n))
        begins = begins + charge.per_link(lambda n: APART * charge.rng.gamma(1.5, 1 / 1.5, n))
    return np.stack(late), np.stack(high)


def _echoing(charge: Charge, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Each is larger or less on a link (a lognormal law), and by Weibull's from row to row. Of what
    is behind iron some comes straight.
    """
    rng, per_link = charge.rng, charge.per_link
    iron = charge.met("metal") * per_link(lambda n: rng.triangular(0.4, 0.55, 0.67, n))
    wave = ((1 - iron) * _turned(rng, charge.rows))[:, None] * puffs(top)
    loud = per_link(lambda n: rng.uniform(0.3, 0.75, n))
    for late, high in zip(*arrivals(charge), strict=True):
        unlike = per_link(lambda n: np.exp(UNLIKE * rng.standard_normal(n).clip(-2.0, 2.0)))
        size = loud * unlike * high * rng.weibull(FADING, charge.rows)
        heard = np.flatnonzero(top + late < WIDE_SAMPLES + 6.0)
        turned = (size * _turned(rng, charge.rows))[heard, None]
        wave[heard] += turned * puffs((top + late)[heard])
    level = 10 ** ((gasworks.about_the_yard(charge) - LATER_DB) / 20)
    return np.asarray(level[:, None] * wave)


def _turned(rng: np.random.Generator, rows: int) -> Complexes:
    """Return phases by chance [rows]."""
    return np.asarray(np.exp(1j * rng.uniform(-np.pi, np.pi, rows)))
