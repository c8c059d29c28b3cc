"""The cowshed's radio with its impulse responses: rows of `cowshed`, rails that scatter.

numpy and pandas alone; what can be hidden is in `cowshed_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import cowshed
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.cowshed_scope import (
    METRES,
    OF_NOISE,
    PLACE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Scope,
    bumps,
    murmur,
    onsets,
    readings,
)
from bench.challenge.families.cowshed_wave_effects import LAWS, OF_RANGES, WAVES, suffer

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 17, 140
ROUNDS = (1, 1, 1, 1, 2, 2, 3, 3, 3, 4, 4, 5, 5, 5)
FULL_DB = 114.0  # of levels
SOONER = 1.187  # samples by which a part of a clean pulse's energy comes before its top, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in cowshed.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the cowshed's own."""
    rng = np.random.default_rng([965, seed])
    here = cowshed.part_of(cowshed.walks(rng, "", ROUNDS), drawn, nearer=True)
    clean = received(here, rng)
    if not drawn.paired:
        here = cowshed.part_of(cowshed.walks(rng, "", ROUNDS), drawn, nearer=False)
        here["link"] = "next door " + here["link"]
    again = pd.concat([here] * drawn.ratio, ignore_index=True)
    simulated, anew = received(again, rng), received(again, rng)
    four = (_suffered(clean, drawn, seed), clean, simulated, _suffered(anew, drawn, seed))
    found, plain, other, truth = (_published(table, drawn.listed) for table in four)
    return Tables(found, plain, other, truth)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return cowshed.walks(np.random.default_rng([965, seed]), "", ROUNDS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    out = _suffered(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _suffered(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    scope = Scope(table, seed, np.random.default_rng([966, len(table), seed]))
    suffer(scope, drawn.hidden, drawn.strength)
    return scope.read()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is published: SAMPLES sizes from LEAD before the first path."""
    return _published(table, listed=True)


def _published(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index).astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.stack(table["cir_i"].to_list()), np.stack(table["cir_q"].to_list()))
    shown = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    bare = cowshed.shown(table.drop(columns=["cir_i", "cir_q"]), listed)
    return bare.assign(cir=list(shown.astype(np.float32)), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the cowshed's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + 1.0 + rng.random(size)
    symbols = 508.0 - rng.binomial(22, 0.3, size)
    sigma = rng.triangular(66.0, 71.0, 80.0, size)
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _in_the_shed(rows, top, rng) + sigma[:, None] * murmur(rng, size)
    index = onsets(cir, sigma)
    error = METRES * (index + SOONER - top) + rng.triangular(-0.028, 0.0, 0.028, size)
    level, first = readings(cir, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        cir_i=list(cir.real),
        cir_q=list(cir.imag),
    )


def _in_the_shed(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, off rails of steel, and what is left.

    Delays off rails are sums of exponential ones; the rest falls by a power of the delay.
    """
    size, link = len(rows), rows.groupby("link", sort=False).ngroup().to_numpy(np.intp)
    links = int(link.max()) + 1
    steel = rows["obstacles"].map(lambda some: "metal" in some).to_numpy(np.float64)
    straight = 1 - steel * rng.beta(2.0, 6.0, links)[link]
    cir = (straight * _turned(rng, size))[:, None] * bumps(top)
    late = np.full(links, 4.0)
    for _ in range(10):
        late = late + np.minimum(rng.exponential(4.5, links), 14.0)
        share = 0.2 * (1 + late / 14.0) ** -1.1 * rng.gamma(2.0, 0.5, links)
        cir = cir + (share[link] * _turned(rng, size))[:, None] * bumps(top + late[link])
    past = PLACE - top[:, None] - 2.5
    left = rng.uniform(0.02, 0.045, links)[link, None] * (1 + np.maximum(past, 0) / 12.0) ** -1.4
    level = cowshed.below_the_roof(rows) + rng.logistic(0.0, 0.7, links)[link] - 4.6
    heard = cir + np.where(past > 0, left, 0.0) * murmur(rng, size)
    return np.asarray(10 ** (level / 20)[:, None] * heard)


def _turned(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(-np.pi, np.pi, size)))
