"""The pottery's cones with their impulse responses: rows of `pottery`, and its echoes.

numpy and pandas alone; what can be hidden is in `pottery_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import pottery
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.pottery_cone import (
    AHEAD,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Cone,
    blunging,
    levels_db,
    slumped,
    thuds,
)
from bench.challenge.families.pottery_day import fired
from bench.challenge.families.pottery_floor import Firing
from bench.challenge.families.pottery_wave_effects import LAWS, OF_RANGES, WAVES, hide

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 19, 136
OF_ROWS = np.repeat(np.arange(1, 8), [44, 34, 25, 14, 8, 4, 1])
"""How many rows links have."""
FULL_DB = 116.0  # of levels: a count for each symbol
ECHOES, SOONEST, GAP, GAP_LAW = 30, 6.0, 2.7, 1.5  # of these; samples to the first; between; gamma
FALLS, POWER = 13.0, 1.5  # samples, and a power, by which echoes fall
UNLIKE, STEADY = 0.34, 0.66  # e-folds by which links' echoes differ; part that does not fade
LATER_DB = 2.4  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {name: cause for name, cause in pottery.CAUSES.items() if name in {*OF_RANGES, *LAWS}}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the pottery's own."""
    rng = np.random.default_rng([9610, seed])
    day = pottery.mixed_rows(fired(rng, "", OF_ROWS), drawn, far=False)
    clean = received(day, rng)
    if not drawn.paired:
        day = pottery.day_after(fired(rng, "", OF_ROWS), drawn)
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
    made = _hiding(table, drawn, seed, 70 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    cone = Cone(table, seed, np.random.default_rng([9611, side, seed]))
    hide(cone, drawn.hidden, drawn.strength)
    return cone.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, "obstacles" in table)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.stack([*table["cir_i"]]), np.stack([*table["cir_q"]]))
    cirs = [one[k : k + SAMPLES].astype(np.float32) for one, k in zip(sizes, begin, strict=True)]
    made = table.drop(columns=["cir_i", "cir_q"]).assign(cir=cirs, first_path_index=index - begin)
    return pottery.written(made if "obstacles" in made else made.assign(obstacles=""), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return fired(np.random.default_rng([9610, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that cones themselves make of rows, with waveforms of whole counts."""
    firing = Firing(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(firing.rows)
    symbols, noise = pottery.gathered(firing)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = np.rint(full[:, None] * _echoing(firing, top)
                   + sigma[:, None] * blunging(rng, firing.rows))  # fmt: skip
    index = slumped(wave)
    own = firing.each_link(lambda n: pottery.OWN_M * rng.triangular(-2.45, 0.0, 2.45, n))
    own = own + 0.0145 * pottery.shakes(rng, firing.rows)
    error = LIGHT_M_NS * SAMPLE_NS * (index + AHEAD - top) + own
    every, first = levels_db(wave, index, sigma) - 20 * np.log10(full)
    made = (error, firing.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(pottery.TOLD, made, strict=True)),
        sample_period_ns=SAMPLE_NS, first_path_index=index,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip


def echoes(firing: Firing) -> tuple[Floats, Floats]:
    """Return how many samples after straight ways echoes come, and how high [echoes, n].

    One after another (Turin 1972), ever lower by a power of how late; alike within links.
    """
    rng, late, high = firing.rng, [], []
    since = SOONEST + 0.0 * firing.far
    for _ in range(ECHOES):
        unlike = firing.each_link(lambda n: np.exp(UNLIKE * rng.standard_normal(n).clip(-2.2, 2.2)))
        late.append(since)
        high.append((1 + (since - SOONEST) / FALLS) ** -POWER * unlike)
        since = since + firing.each_link(lambda n: 0.4 + rng.gamma(GAP_LAW, GAP / GAP_LAW, n))
    return np.stack(late), np.stack(high)


def _echoing(firing: Firing, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Of each a part fades from row to row. Of what is behind racks some comes straight.
    """
    rng, rows = firing.rng, firing.rows

    def phases() -> Complexes:
        return np.asarray(np.exp(2j * np.pi * rng.random(rows)))

    kept = 1 - firing.through("metal") * firing.each_link(lambda n: rng.uniform(0.4, 0.68, n))
    wave = (kept * phases())[:, None] * thuds(top)
    loud = firing.each_link(lambda n: rng.uniform(0.21, 0.48, n))
    fading = np.sqrt(0.5 * (1 - STEADY**2))
    for late, high in zip(*echoes(firing), strict=True):
        fades = STEADY + fading * (rng.standard_normal(rows) + 1j * rng.standard_normal(rows))
        wave += (loud * high.clip(max=1.8) * fades * phases())[:, None] * thuds(top + late)
    level = 10 ** ((pottery.in_the_works(firing) - LATER_DB) / 20)
    return np.asarray(level[:, None] * wave)
