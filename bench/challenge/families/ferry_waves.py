"""The ferry's radio with its impulse responses: rows of `ferry`, steel that reverberates.

numpy and pandas alone; what can be hidden is in `ferry_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import ferry
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.ferry_deck import DECK_M
from bench.challenge.families.ferry_set import (
    METRES,
    OF_NOISE,
    TIMES,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Chain,
    powers_db,
    static,
    tangents,
    tones,
)
from bench.challenge.families.ferry_wave_effects import LAWS, OF_RANGES, WAVES, overcome

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 14, 164
ROUNDS = (1, 2, 1, 3, 2, 2, 1, 4, 2, 1, 8, 2, 1, 3)
FULL_DB = 112.0  # of levels
RISE = 2.285  # samples from where clean pulses' tangents are zero to their middles, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in ferry.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the ferry's own."""
    rng = np.random.default_rng([777, seed])
    rows = ferry.berthed(ferry.sailings(rng, "", ROUNDS), 0 if drawn.same_mix else -1)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = ferry.berthed(ferry.sailings(rng, "", ROUNDS), 0 if drawn.same_mix else 1)
        rows["link"] = "drawn up: " + rows["link"]
    many = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, truth = (received(many, rng) for _ in range(2))
    sides = (conceal(clean, drawn, seed), clean, simulated, conceal(truth, drawn, seed))
    found, plain, model, true = (ferry.ashore(recorded(one), drawn.listed) for one in sides)
    return Tables(found, plain, model, true)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return ferry.sailings(np.random.default_rng([777, seed]), "", ROUNDS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    chain = Chain(table, seed, np.random.default_rng([len(table), 778, seed]))
    overcome(chain, drawn.hidden, drawn.strength)
    out = chain.logged()
    return out if drawn.listed else out.drop(columns="obstacles")


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES sizes from LEAD before the first path."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.minimum(np.maximum(index.astype(np.intp) - LEAD, 0), WIDE_SAMPLES - SAMPLES)
    cirs = zip(table["cir_i"], table["cir_q"], begin, strict=True)
    shown = [
        np.hypot(i[b : b + SAMPLES], q[b : b + SAMPLES]).astype(np.float32) for i, q, b in cirs
    ]
    out = ferry.ashore(table.drop(columns=["cir_i", "cir_q"]), listed=True)
    return out.assign(cir=shown, first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the ferry's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    middle = WIDE_LEAD + 2 + rng.random(size)
    symbols = 498.0 - 2 * rng.poisson(2.0, size)
    sigma = 52.0 * (1 + 0.035 * rng.standard_normal(size))
    gain = symbols * 10 ** (FULL_DB / 20)
    cir = gain[:, None] * _in_steel(rows, middle, rng) + sigma[:, None] * static(rng, size)
    index = np.round(64 * tangents(cir, sigma)) / 64
    error = METRES * (index - middle + RISE) + 0.013 * rng.normal(size=size)
    level, first = powers_db(cir, index, sigma) - 20 * np.log10(gain)
    return rows.assign(
        range_m=rows["true_range_m"] + error,
        error_m=error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        cir_i=list(cir.real),
        cir_q=list(cir.imag),
    )


def _in_steel(rows: pd.DataFrame, middle: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW: straight, by the deck above, from webs, from all sides."""
    size, codes = len(rows), rows.groupby("link", sort=False).ngroup().to_numpy()
    links = int(codes.max()) + 1
    van = np.array([float("metal" in one) for one in rows["obstacles"]])
    direct = 1 - van * rng.uniform(0.15, 0.4, links)[codes]
    cir = (direct * _phases(rng, size))[:, None] * tones(middle)
    for late, share in _webs(rows, rng.uniform(size=(3, links))[:, codes]):
        cir = cir + (share * _phases(rng, size))[:, None] * tones(middle + late)
    past = np.maximum(TIMES - middle[:, None] - 2.5, 0)
    dense = (
        rng.uniform(0.04, 0.07, links)[codes, None] * (-np.expm1(-past / 5)) * np.exp(-past / 46)
    )
    level = ferry.between_decks(rows) + rng.triangular(-2.0, 0.0, 2.0, links)[codes]
    return np.asarray(10 ** ((level - 5.6) / 20)[:, None] * (cir + dense * static(rng, size)))


def _webs(rows: pd.DataFrame, chance: Floats) -> list[tuple[Floats, Floats]]:
    """Return how many samples later ways by the deck above come, and their shares, [n] each."""
    far, down = rows["true_range_m"].to_numpy(), (rows["rx_z_m"] - rows["tx_z_m"]).to_numpy()
    rise = (2 * DECK_M[2] - rows["tx_z_m"] - rows["rx_z_m"]).to_numpy()
    above = np.sqrt(far**2 - down**2 + rise**2) - far
    ways = [(np.maximum(above / METRES, 3.6), 0.35 * far / (far + above))]
    return ways + [(4.5 + 40 * one, 0.24 * np.exp(-1.5 * one)) for one in chance]


def _phases(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
