"""The vineyard's radio with its impulse responses: rows of `vineyard`, leaves and stakes scatter.

numpy and pandas alone; what can be hidden is in `vineyard_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import vineyard
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.vineyard_box import (
    EDGE,
    METRES,
    OF_SIZES,
    SAMPLE_NS,
    TICK,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Box,
    arrivals,
    meters,
    pulses,
    rustle,
)
from bench.challenge.families.vineyard_effects import stake_ways
from bench.challenge.families.vineyard_slope import Harvest
from bench.challenge.families.vineyard_wave_effects import LAWS, OF_RANGES, WAVES, befall

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 18, 146
CALLS = (1, 1, 2, 2, 3, 3, 4, 4, 5, 6, 8)
FULL_DB = 113.8  # of levels, at this rate of pulses
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: column for name, column in vineyard.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the vineyard's own."""
    rng = np.random.default_rng([1134, seed])
    here = vineyard.mixed(vineyard.passes(rng, "", CALLS), drawn, "lower")
    clean = received(here, rng)
    if not drawn.paired:
        here = vineyard.mixed(vineyard.passes(rng, "", CALLS), drawn, "upper")
        here["link"] = "next slope: " + here["link"]
    again = pd.concat(drawn.ratio * [here], ignore_index=True)
    simulated, true = (received(again, rng) for _ in range(2))
    four = (_befallen(clean, drawn, seed), clean, simulated, _befallen(true, drawn, seed))
    found, plain, other, truth = (_written(one, drawn.listed) for one in four)
    return Tables(found, plain, other, truth)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return vineyard.passes(np.random.default_rng([1134, seed]), "", CALLS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is written.
    """
    out = _befallen(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is written: SAMPLES sizes from LEAD before the first path."""
    return _written(table, True)


def _befallen(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    box = Box(table, seed, np.random.default_rng([1135, len(table), seed]))
    befall(box, drawn.hidden, drawn.strength)
    return box.read()


def _written(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES).astype(np.intp)
    size = np.hypot(*(np.stack(list(table[name])) for name in ("cir_i", "cir_q")))
    kept = np.take_along_axis(size, begin[:, None] + np.arange(SAMPLES), axis=1)
    out = table.drop(columns=["cir_i", "cir_q"])
    out = out.assign(cir=list(kept.astype(np.float32)), first_path_index=index - begin)
    return vineyard.shown(out, listed)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the vineyard's own radio makes of rows, with complex waveforms."""
    top = WIDE_LEAD + EDGE + rng.random(len(rows))
    symbols, noise = vineyard.counted_by(rows, rng)
    sigma = noise / OF_SIZES
    full = symbols * 10 ** (FULL_DB / 20)
    waves = full[:, None] * _among_vines(rows, top, rng)
    waves = waves + sigma[:, None] * rustle(rng, len(rows))
    index = arrivals(waves, sigma)
    error = METRES * (index + EDGE - top) + 0.009 * rng.standard_t(6.0, len(rows))
    whole, first = meters(waves, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=whole,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=SAMPLE_NS,
        noise_std=noise,
        preamble_count=symbols,
        cir_i=list(waves.real),
        cir_q=list(waves.imag),
    )


def _among_vines(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by trailers, stakes, leaves, the rest."""
    harvest, size = Harvest(rows, 0, rng), len(rows)
    late, share = _ways(harvest)
    waves = np.zeros((size, len(TICK)), np.complex128)
    for k in range(late.shape[1]):
        waves += (share[:, k] * _turned(rng, size))[:, None] * pulses(top + late[:, k])
    past = np.maximum(TICK - top[:, None] - 3.0, 0.0)
    rest = (0.012 + 0.03 * _thick(harvest))[:, None] * (past > 0) * (1 + past / 16.0) ** -1.4
    waves = waves + rest * rustle(rng, size)
    canes = harvest.by_link(lambda n: 1.1 * (1.5 - rng.gamma(1.5, 1.0, n)))
    level = vineyard.through_leaves(rows) + canes - 3.2  # a pulse has more than its top
    return np.asarray(10 ** (level[:, None] / 20) * waves)


def _ways(harvest: Harvest) -> tuple[Floats, Floats]:
    """Return how late ways come in samples, and how large they are, [n, 13] each."""
    rng, steel = harvest.rng, harvest.stands("metal")
    gone = steel * harvest.by_link(lambda n: rng.uniform(0.42, 0.7, n))
    late = [0 * steel, harvest.by_link(lambda n: rng.uniform(4.8, 8.5, n))]
    share = [(1 - gone) * np.exp(-harvest.leaves.clip(max=8.0) / 16.0),
             steel * harvest.by_link(lambda n: rng.uniform(0.2, 0.5, n))]  # fmt: skip
    for way in np.sort(stake_ways(harvest), axis=1).T[:4]:  # by stakes near the straight path
        shine = harvest.by_link(lambda n: rng.rayleigh(0.17, n).clip(max=0.45))
        late.append((way / METRES).clip(5.0, 120.0))
        share.append(shine / (1 + way / 14.0))
    for _ in range(7):  # by canes and leaves, in any order
        one = harvest.by_link(lambda n: 4.8 + (12.0 * rng.weibull(0.9, n)).clip(max=75.0))
        glint = harvest.by_link(lambda n: rng.rayleigh(0.16, n).clip(max=0.4))
        late.append(one)
        share.append(glint * (0.35 + _thick(harvest)) * np.exp(-one / 45.0))
    return np.stack(late, axis=1), np.stack(share, axis=1)


def _thick(harvest: Harvest) -> Floats:
    """Return how much there is of leaves on straight paths, from 0 to 1 [n]."""
    return np.asarray(-np.expm1(-harvest.leaves / 3.0))


def _turned(rng: np.random.Generator, size: int) -> Complexes:
    """Return phases [n]."""
    return np.asarray(np.exp(1j * rng.uniform(-np.pi, np.pi, size)))
