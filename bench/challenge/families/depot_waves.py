"""The depot's radio with its impulse responses: rows of `depot`, and waveforms of its own.

numpy and pandas alone; what can be hidden is in `depot_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import depot
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.depot_effects import UNSEEN
from bench.challenge.families.depot_scope import (
    METRES,
    TOLD,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Scope,
    energies,
    first_edge,
    pulse_at,
)
from bench.challenge.families.depot_wave_effects import LAWS, OF_RANGES, WAVES, happen

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 9, 130
DRIVES, POLLS = 11, 2
SCALE_DB = 121.74  # of levels, at a pulse repetition of 64 MHz
SCATTERERS = 22
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: depot.CAUSES[name] for name in KNOWN if name in depot.CAUSES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the depot's own."""
    rng = np.random.default_rng([321, seed])
    span = depot.ALL_M if drawn.same_mix else depot.NEAR_M
    clean = received(depot.within(_driven(rng), span), rng)
    rows = clean
    if not drawn.paired:
        span = depot.ALL_M if drawn.same_mix else depot.FAR_M
        rows = depot.within(_driven(rng), span)
        rows["link"] = "other " + rows["link"]
    more, again = (
        pd.concat([received(rows, rng) for _ in range(drawn.ratio)], ignore_index=True)
        for _ in range(2)
    )
    found, clean, more, truth = (
        _unlisted(recorded(one), drawn.listed)
        for one in (conceal(clean, drawn, seed), clean, more, conceal(again, drawn, seed))
    )
    return Tables(found, clean, more, truth)


def _unlisted(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    return table if listed else table.drop(columns="obstacles", errors="ignore")


def _driven(rng: np.random.Generator) -> pd.DataFrame:
    return depot.driven(rng, "", POLLS, DRIVES)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _driven(np.random.default_rng([321, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    scope = Scope(table, seed, [322, seed, len(table)])
    happen(scope, drawn.hidden, drawn.strength)
    return _unlisted(scope.log(), drawn.listed)


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES magnitudes from LEAD before the first path."""
    first, shown = table["first_path_index"].to_numpy(np.float64), []
    begin = np.clip(first.astype(int) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    for real, imaginary, at in zip(table["cir_i"], table["cir_q"], begin, strict=True):
        size = np.sqrt(np.square(real) + np.square(imaginary))
        shown.append(np.asarray(size[at : at + SAMPLES], np.float32))
    out = table.drop(columns=["cir_i", "cir_q", *UNSEEN])
    return out.assign(cir=pd.Series(shown, index=table.index), first_path_index=first - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the depot's own radio makes of the rows, with complex waveforms."""
    size = len(rows)
    begin = WIDE_LEAD + rng.random(size)
    symbols = 256.0 - rng.binomial(9, 0.3, size)
    sigma = rng.normal(88.0, 4.5, size)
    waves = _paths(rows, begin, rng) * (symbols * 10 ** (SCALE_DB / 20))[:, None]
    drawn = rng.normal(size=(2, *waves.shape)) * sigma[:, None]
    waves = waves + drawn[0] + 1j * drawn[1]
    index = first_edge(waves, sigma)
    index = np.rint(index * 64) / 64
    out = rows.assign(noise_std=sigma / TOLD, preamble_count=symbols, sample_period_ns=1.0016)
    out["first_path_index"] = index
    out["error_m"] = (index - begin + 1.12) * METRES + rng.laplace(0, 0.009, size)
    out["range_m"] = out["true_range_m"] + out["error_m"]
    for name, energy in zip(("rx", "first_path"), energies(waves, index), strict=True):
        out[f"{name}_power_dbm"] = 10 * np.log10(energy / symbols**2) - SCALE_DB
    return out.assign(cir_i=list(waves.real), cir_q=list(waves.imag))


def _paths(rows: pd.DataFrame, begin: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is received in root mW: straight, and by things that stand about."""
    far, size = rows["true_range_m"].to_numpy(np.float64), len(rows)
    number, links = pd.factorize(rows["link"])
    level = -51.5 - 20.5 * np.log10(far) - rng.gumbel(0, 0.8, len(links))[number]
    height = 10 ** (level / 20) / 1.25
    iron = np.array(["metal" in row for row in rows["obstacles"]])
    straight = np.where(iron, rng.uniform(0.13, 0.4, size), 1.0)
    waves = (straight * np.exp(2j * np.pi * rng.random(size)))[:, None] * pulse_at(begin)
    for _ in range(SCATTERERS):
        late = rng.weibull(0.8, size) * 17 + 2.4
        weak = 0.19 * rng.rayleigh(1, size) / (1 + late / 14) ** 1.3
        turned = weak * np.exp(2j * np.pi * rng.random(size))
        waves = waves + turned[:, None] * pulse_at(begin + late)
    return np.asarray(height[:, None] * waves)
