"""The manege's radio with its impulse responses: rows of `manege`, rafters and sides that echo.

numpy and pandas alone; what can be hidden is in `manege_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import manege
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.manege_hall import Lesson
from bench.challenge.families.manege_handset import (
    METRES,
    OF_SIZES,
    PLACES,
    RISE,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Handset,
    edges,
    hiss,
    in_db,
    pulses,
)
from bench.challenge.families.manege_wave_effects import LAWS, OF_RANGES, WAVES, pass_on

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 15, 142
OF_ROWS = np.repeat(np.arange(1, 8), [30, 24, 18, 14, 10, 8, 5])
"""How many rows links have."""
FULL_DB = 121.0  # of levels: a count for each symbol
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in manege.CAUSES.items() if name in OF_RANGES}
RARELY = ()
RAFTERS_M: Floats = np.array([(x, y, 6.1) for x in range(4, 64, 8) for y in (5.0, 18.0)])
"""Where rafters have plates of steel."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the manege's own."""
    rng = np.random.default_rng([1406, seed])
    rows = manege.chosen(manege.lessons(rng, "", OF_ROWS), drawn, near=True)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = manege.chosen(manege.lessons(rng, "", OF_ROWS), drawn, near=False)
        rows = rows.assign(link="in the afternoon, " + rows["link"])
    again = rows.loc[np.tile(rows.index, drawn.ratio)].reset_index(drop=True)
    simulated, anew = received(again, rng), received(again, rng)
    found, true = _passed(clean, drawn, seed, 3), _passed(anew, drawn, seed, 4)
    found, clean, simulated, true = (
        _stored(table, drawn.listed) for table in (found, clean, simulated, true)
    )
    return Tables(found, clean, simulated, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return manege.lessons(np.random.default_rng([1406, seed]), "", OF_ROWS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    found = _passed(table, drawn, seed, len(table))
    return found if drawn.listed else found.drop(columns="obstacles")


def _passed(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    handset = Handset(table, seed, np.random.default_rng([side, 1407, seed]))
    pass_on(handset, drawn.hidden, drawn.strength)
    return handset.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is stored: SAMPLES sizes from LEAD before the first path."""
    return _stored(table, True)


def _stored(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.floor(index - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    real, imaginary = (np.stack(table[name].to_list()) for name in ("cir_i", "cir_q"))
    at = begin.astype(np.int64)[:, None] + np.arange(SAMPLES)
    sizes = np.take_along_axis(np.hypot(real, imaginary), at, axis=1).astype(np.float32)
    rows = manege.said(table.drop(columns=["cir_i", "cir_q"]), listed or "obstacles" not in table)
    return rows.assign(cir=list(sizes), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the manege's own radio makes of rows, with complex waveforms."""
    top = WIDE_LEAD + RISE + rng.random(len(rows))
    symbols, noise = manege.counted(rows, rng)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _in_the_hall(rows, top, rng) + sigma[:, None] * hiss(rng, len(rows))
    edge = edges(wave, sigma)
    error = METRES * (edge + RISE - top) + rng.normal(0.0, 0.008, len(rows))
    level, first = in_db(wave, edge, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=edge,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=list(wave.real),
        cir_q=list(wave.imag),
    )


def _in_the_hall(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off plates of rafters, and the rest.

    Plates are where they are; how much each returns is a matter of its angle, by chance of links.
    """
    lesson = Lesson(rows, 0, rng)
    steel = lesson.crosses("metal") * lesson.per_link(
        lambda n: rng.beta(6.0, 4.0, n).clip(max=0.84)
    )
    wave = (1 - steel)[:, None] * _struck(rng, top)
    legs = [one[:, None] - RAFTERS_M for one in (lesson.at, lesson.post)]
    longer = np.sum([np.sqrt((leg**2).sum(axis=2)) for leg in legs], axis=0)
    longer = longer - lesson.reach[:, None]
    for plate in range(len(RAFTERS_M)):
        late = (longer[:, plate] / METRES).clip(4.6, 150.0)
        size = lesson.per_link(lambda n: rng.weibull(1.2, n).clip(max=2.4))
        size = 0.42 * size * np.exp(-late / 30.0)
        wave += size[:, None] * _struck(rng, top + late)
    since = np.maximum(PLACES - top[:, None] - 3.2, 0.0)
    rest = lesson.per_link(lambda n: rng.gamma(9.0, 0.022 / 9.0, n))[:, None]
    wave += rest * np.exp(-since / 29.0) * (since > 0) * hiss(rng, len(rows))
    level = manege.in_the_hall(rows, rng) - 4.0  # a pulse has more than its top
    return np.asarray(10 ** (level[:, None] / 20) * wave)


def _struck(rng: np.random.Generator, top: Floats) -> Complexes:
    """Return a pulse for each row at some phase [n, k]."""
    return np.asarray(np.exp(2j * np.pi * rng.random(len(top)))[:, None] * pulses(top))
