"""The roundhouse's recorders with their impulse responses: rows of `roundhouse`, and what echoes.

numpy and pandas alone; what can be hidden is in `roundhouse_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import roundhouse
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.roundhouse_recorder import (
    METRES,
    OF_SIZES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Recorder,
    crackle,
    decibels,
    edges,
    pulses,
)
from bench.challenge.families.roundhouse_stalls import FRONTS_M, STALLS, Shunt
from bench.challenge.families.roundhouse_wave_effects import LAWS, OF_RANGES, WAVES, go_by

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 160
OF_ROWS = np.repeat(np.arange(1, 9), [25, 22, 18, 14, 11, 8, 5, 3])
"""How many rows links have."""
FULL_DB = 117.0  # of levels: a count for each symbol
RAYS, LAST = 30, 95.0  # that come from anywhere; samples until the last of these
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: roundhouse.CAUSES[name] for name in roundhouse.CAUSES if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the roundhouse's own."""
    rng = np.random.default_rng([seed, 1706])
    rows = roundhouse.some(roundhouse.shunts(rng, "", OF_ROWS), drawn, "near")
    clean = received(rows, rng)
    if not drawn.paired:
        rows = roundhouse.some(roundhouse.shunts(rng, "", OF_ROWS), drawn, "far")
        rows = rows.assign(link="by night, " + rows["link"])
    more = rows.loc[np.tile(rows.index, drawn.ratio)].reset_index(drop=True)
    simulated, anew = received(more, rng), received(more, rng)
    found, truth = (_gone_by(table, drawn, seed, k) for k, table in enumerate((clean, anew), 1))
    kept, plain, other, true = (
        _kept(one, drawn.listed) for one in (found, clean, simulated, truth)
    )
    return Tables(kept, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return roundhouse.shunts(np.random.default_rng([seed, 1706]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _gone_by(table, drawn, seed, len(table))
    return found.drop(columns=[] if drawn.listed else ["obstacles"])


def _gone_by(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    recorder = Recorder(table, seed, np.random.default_rng([seed, 1707, side]))
    go_by(recorder, drawn.hidden, drawn.strength)
    return recorder.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is stored: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, listed=True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    both = np.array([[*table["cir_i"]], [*table["cir_q"]]], np.float64)
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (index.astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    whole = np.sqrt((both**2).sum(axis=0)).astype(np.float32)
    sizes = [one[at : at + SAMPLES] for one, at in zip(whole, begin, strict=True)]
    rows = roundhouse.as_told(table.drop(columns=["cir_i", "cir_q"]), listed)
    return rows.assign(cir=sizes, first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the roundhouse's own recorder makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    symbols, noise = roundhouse.summed(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_house(rows, top, rng) + sigma[:, None] * crackle(rng, len(rows))
    edge = edges(wave, sigma)
    error = METRES * (edge + RISE - top) + rng.normal(0.0, 0.009, len(rows))
    level, first = (db - 20 * np.log10(full) for db in decibels(wave, edge, sigma))
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=edge,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=[*wave.real],
        cir_q=[*wave.imag],
    )


def _in_the_house(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off smokeboxes, and from anywhere.

    Smokeboxes return the less the farther both ways are, as targets of radars do; how much they do
    is by chance of links. Of what is behind steel some comes straight.
    """
    shunt = Shunt(rows, 0, rng)
    steel = shunt.through("metal") * shunt.per_link(lambda n: rng.triangular(0.25, 0.58, 0.78, n))
    wave = (1 - steel)[:, None] * _phased(rng, top)
    legs = [np.linalg.norm(end[:, None] - FRONTS_M, axis=2) for end in (shunt.there, shunt.hung)]
    for front in range(STALLS):
        both = [leg[:, front].clip(1.2) for leg in legs]
        late = ((both[0] + both[1] - shunt.far) / METRES).clip(4.8, 180.0)
        size = (2.6 * shunt.far / (both[0] * both[1])).clip(max=0.62)
        size = size * shunt.per_link(lambda n: rng.gamma(2.0, 0.38, n).clip(max=2.1))
        wave += size[:, None] * _phased(rng, top + late)
    for late in rng.uniform(4.0, LAST, (RAYS, len(rows))):
        size = 0.055 * np.exp(-late / 30.0) * rng.rayleigh(1.0, len(rows))
        wave += size[:, None] * _phased(rng, top + late)
    level = roundhouse.in_the_house(rows, rng) - 2.0  # what comes later adds to what comes straight
    return np.asarray(10 ** (level[:, None] / 20) * wave)


def _phased(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row at some phase [n, k]."""
    return np.asarray(np.exp(1j * rng.uniform(-np.pi, np.pi, len(top)))[:, None] * pulses(top))
