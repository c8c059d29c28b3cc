"""The brickworks' readers with their impulse responses: rows of `brickworks`, and what echoes.

numpy and pandas alone; what can be hidden is in `brickworks_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import brickworks
from bench.challenge.families.brickworks_reader import (
    METRES,
    OF_SIZES,
    PLACES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Reader,
    decibels,
    edges,
    pulses,
    rustle,
)
from bench.challenge.families.brickworks_wave_effects import LAWS, OF_RANGES, WAVES, pass_all
from bench.challenge.families.brickworks_yard import Push
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 154
OF_ROWS = np.repeat(np.arange(1, 10), [27, 20, 17, 13, 10, 7, 4, 3, 1])
"""How many rows links have."""
FULL_DB = 116.0  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in brickworks.CAUSES.items() if name in OF_RANGES}
RARELY = ()
STACKS_M: Floats = np.array(
    [(x, y, z) for x in (9.0, 18.5, 28.0, 36.5) for y in (2.6, 11.7, 20.6) for z in (1.4, 4.8)]
)
"""Where hoppers and shells of steel stand."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the brickworks' own."""
    rng = np.random.default_rng([seed, 1606])
    rows = brickworks.chosen(brickworks.pushes(rng, "", OF_ROWS), drawn, near=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = brickworks.chosen(brickworks.pushes(rng, "", OF_ROWS), drawn, near=False)
        rows = rows.assign(link="on the late shift, " + rows["link"])
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, anew = received(more, rng), received(more, rng)
    recorded, truth = _passed(clean, drawn, seed, 1), _passed(anew, drawn, seed, 2)
    found, plain, other, true = (
        _kept(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return brickworks.pushes(np.random.default_rng([seed, 1606]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _passed(table, drawn, seed, len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _passed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    reader = Reader(table, seed, np.random.default_rng([seed, 1607, side]))
    pass_all(reader, drawn.hidden, drawn.strength)
    return reader.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is stored: SAMPLES sizes from LEAD before the first path."""
    return _kept(table, listed=True)


def _kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index).astype(np.int64) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    parts = (np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q"))
    sizes = np.take_along_axis(np.hypot(*parts), begin[:, None] + np.arange(SAMPLES), axis=1)
    rows = brickworks.as_told(table.drop(columns=["cir_i", "cir_q"]), listed)
    return rows.assign(cir=[*sizes.astype(np.float32)], first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the brickworks' own reader makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    symbols, noise = brickworks.summed(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_hall(rows, top, rng) + sigma[:, None] * rustle(rng, len(rows))
    edge = edges(wave, sigma)
    error = METRES * (edge + RISE - top) + rng.normal(0.0, 0.01, len(rows))
    level, first = decibels(wave, edge, sigma) - 20 * np.log10(full)
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


def _in_the_hall(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off hoppers, and out of dust.

    Hoppers are where they are; how much each returns is by chance of links.
    """
    push = Push(rows, 0, rng)
    door = push.meets("metal") * push.each_link(lambda n: rng.uniform(0.25, 0.62, n))
    wave = (1 - door)[:, None] * _turned(rng, top)
    legs = [np.linalg.norm(end[:, None] - STACKS_M, axis=2) for end in (push.there, push.hung)]
    late = (legs[0] + legs[1] - push.far[:, None]) / METRES
    for hopper in range(len(STACKS_M)):
        samples = late[:, hopper].clip(4.6, 155.0)
        size = 0.4 / (1 + (samples / 20.0) ** 2)
        size = size * push.each_link(lambda n: rng.weibull(1.4, n).clip(max=2.4))
        wave += size[:, None] * _turned(rng, top + samples)
    since = np.clip(PLACES - top[:, None] - 3.2, 0.0, None)
    dust = 0.024 * push.each_link(lambda n: rng.gamma(9.0, 1 / 9.0, n))[:, None]
    wave += dust * np.exp(-since / 24.0) * (since > 0) * rustle(rng, len(rows))
    level = brickworks.in_the_hall(rows, rng) - 1.7  # hoppers and dust add to what comes straight
    return np.asarray(10 ** (level[:, None] / 20) * wave)


def _turned(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row at some phase [n, k]."""
    return np.asarray(np.exp(2j * np.pi * rng.random(len(top)))[:, None] * pulses(top))
