"""The glasshouse's radio with its impulse responses: rows of `glasshouse`, panes and bars.

numpy and pandas alone; what can be hidden is in `glasshouse_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import glasshouse
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.glasshouse_pane import (
    AXIS,
    METRES,
    OF_NOISE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Pane,
    murmur,
    rises,
    strengths,
    strikes,
)
from bench.challenge.families.glasshouse_wave_effects import LAWS, OF_RANGES, WAVES, grow

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 13, 128
ROUNDS = (1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 5, 6, 7)
FULL_DB = 102.0  # of levels
EARLY = 1.467  # samples by which clean pulses are timed before their middles, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in glasshouse.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the glasshouse's own."""
    rng = np.random.default_rng([815, seed])
    rows = glasshouse.picked(_runs(rng), 0.0 if drawn.same_mix else -1.0)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = glasshouse.picked(_runs(rng), 0.0 if drawn.same_mix else 1.0)
        rows["link"] = ["in the plan, " + link for link in rows["link"]]
    many = rows.loc[np.tile(rows.index, drawn.ratio)].reset_index(drop=True)
    simulated, again = received(many, rng), received(many, rng)
    found, truth = (conceal(one, drawn, seed) for one in (clean, again))
    shown = [recorded(one) for one in (found, clean, simulated, truth)]
    plain = shown if drawn.listed else [_unlisted(one) for one in shown]
    return Tables(plain[0], plain[1], plain[2], plain[3])


def _unlisted(table: pd.DataFrame) -> pd.DataFrame:
    return table.drop(columns="obstacles", errors="ignore")


def _runs(rng: np.random.Generator) -> pd.DataFrame:
    return glasshouse.runs(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _runs(np.random.default_rng([815, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    pane = Pane(table, seed, np.random.default_rng([seed, len(table), 816]))
    grow(pane, drawn.hidden, drawn.strength)
    out = pane.written()
    return out if drawn.listed else _unlisted(out)


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is written down: SAMPLES sizes from LEAD before the first path."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index).astype(np.intp) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(np.stack(table["cir_i"].to_list()), np.stack(table["cir_q"].to_list()))
    cut = np.lib.stride_tricks.sliding_window_view(sizes, SAMPLES, axis=1)
    shown = cut[np.arange(len(sizes)), begin].astype(np.float32)
    out = glasshouse.on_paper(table.drop(columns=["cir_i", "cir_q"]), listed=True)
    return out.assign(cir=list(shown), first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the glasshouse's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    middle = WIDE_LEAD + 1 + rng.uniform(0, 1, size)
    symbols = np.rint(1012 - rng.gamma(2.0, 3.0, size))
    sigma = 81.0 * np.exp(0.032 * rng.standard_normal(size))
    gain = symbols * 10 ** (FULL_DB / 20)
    cir = gain[:, None] * _below_panes(rows, middle, rng) + sigma[:, None] * murmur(rng, size)
    index = rises(cir, sigma)
    error = METRES * (index - middle + EARLY) + 0.013 * rng.standard_normal(size)
    level, first = strengths(cir, index) - 20 * np.log10(gain)
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


def _below_panes(rows: pd.DataFrame, middle: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW: straight, by bars between panes, and from leaves."""
    size = len(rows)
    codes, names = pd.factorize(rows["link"])
    steel = rows["obstacles"].map(lambda row: "metal" in row).to_numpy(np.float64)
    straight = 1 - steel * rng.uniform(0.12, 0.36, len(names))[codes]
    cir = (straight * _turned(rng, size))[:, None] * strikes(middle)
    for span in range(1, 7):  # bars stand in every span: what they return comes at steps
        late = (3.2 + 7.5 * (span - 1) + rng.uniform(0, 4.0, len(names)))[codes]
        share = (0.26 * 0.78**span * rng.rayleigh(0.9, len(names)))[codes]
        cir = cir + (share * _turned(rng, size))[:, None] * strikes(middle + late)
    since = np.maximum(AXIS[None, :] - middle[:, None] - 2, 0)
    leaves = rng.uniform(0.03, 0.055, len(names))[codes, None] * np.exp(-np.sqrt(since) / 1.6)
    level = glasshouse.through_plants(rows) + (1.5 * rng.logistic(0, 0.45, len(names)))[codes]
    rough = np.where(since > 0, leaves, 0.0) * murmur(rng, size)
    return np.asarray(10 ** ((level - 4.6) / 20)[:, None] * (cir + rough))


def _turned(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(-np.pi, np.pi, size)))
