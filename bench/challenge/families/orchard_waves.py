"""The orchard's radio with its impulse responses: rows of `orchard`, trunks that scatter.

numpy and pandas alone; what can be hidden is in `orchard_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import orchard
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.orchard_gate import (
    HALF_WIDTH,
    METRES,
    OF_NOISE,
    SURE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Gate,
    bells,
    constant_fraction,
    sums_of,
)
from bench.challenge.families.orchard_plot import GROUND_M
from bench.challenge.families.orchard_wave_effects import LAWS, OF_RANGES, WAVES, undergo

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 9, 106
ROUNDS = 2
FULL_DB = 121.74  # of levels, at a pulse repetition of 64 MHz
TRUNKS_M = np.random.default_rng(720).uniform((0, 0), GROUND_M, (11, 2))  # that reach higher
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in orchard.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the orchard's own."""
    rng = np.random.default_rng([721, seed])
    rows = orchard.picked(_courses(rng), "" if drawn.same_mix else "close")
    clean = received(rows, rng)
    if not drawn.paired:
        rows = orchard.picked(_courses(rng), "" if drawn.same_mix else "wide")
        rows = rows.assign(link="virtual " + rows["link"])
    many = pd.concat([rows] * drawn.ratio, ignore_index=True)
    simulated, again = received(many, rng), received(many, rng)
    out = (conceal(clean, drawn, seed), clean, simulated, conceal(again, drawn, seed))
    found, plain, model, truth = (orchard.open_to_all(recorded(one), drawn.listed) for one in out)
    return Tables(found, plain, model, truth)


def _courses(rng: np.random.Generator) -> pd.DataFrame:
    return orchard.grown(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _courses(np.random.default_rng([721, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    gate = Gate(table, seed, np.random.default_rng([722, seed, len(table)]))
    undergo(gate, drawn.hidden, drawn.strength)
    logged = gate.logged()
    return logged if drawn.listed else logged.drop(columns="obstacles")


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES magnitudes from LEAD before the first path."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(index.astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = np.abs(np.array([*table["cir_i"]]) + 1j * np.array([*table["cir_q"]]))
    window = begin[:, None] + np.arange(SAMPLES)
    out = orchard.open_to_all(table, listed=True).drop(columns=["cir_i", "cir_q"])
    out["cir"] = [*np.take_along_axis(sizes, window, axis=1).astype(np.float32)]
    return out.assign(first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the orchard's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    start, symbols = WIDE_LEAD + 1 + rng.random(size), 65.0 - rng.geometric(0.55, size)
    scatter = rng.normal(24.0, 0.9, size)
    cir = _in_the_air(rows, start, rng) * (symbols * 10 ** (FULL_DB / 20))[:, None]
    cir = cir + scatter[:, None] * (rng.normal(size=(*cir.shape, 2)) @ [1, 1j])
    index = np.floor(constant_fraction(cir, SURE * scatter) * 64) / 64
    out = rows.assign(noise_std=OF_NOISE * scatter, preamble_count=symbols, first_path_index=index)
    out["sample_period_ns"] = 1.0016
    out["error_m"] = METRES * (index - start) + 0.012 * rng.standard_normal(size)
    out["range_m"] = out["true_range_m"] + out["error_m"]
    levels = sums_of(cir, index) - 20 * np.log10(symbols) - FULL_DB
    out["rx_power_dbm"], out["first_path_power_dbm"] = levels
    return out.assign(cir_i=list(cir.real), cir_q=list(cir.imag))


def _in_the_air(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return what comes in root mW: straight, by soil and trunks, and through leaves."""
    far, size = rows["true_range_m"].to_numpy(np.float64), len(rows)
    which, links = pd.factorize(rows["link"])
    trailer = np.array([row == ["metal"] for row in rows["obstacles"]])
    straight = np.where(trailer, 1 / rng.uniform(1.6, 4.5, len(links))[which], 1.0)
    middle = start + HALF_WIDTH / 2
    cir = (straight * _turn(rng, size))[:, None] * bells(middle)
    for longer, echo in _ways(rows, far):
        cir = cir + (echo * _turn(rng, size))[:, None] * bells(middle + longer / METRES)
    ago = np.arange(WIDE_SAMPLES) - start[:, None]
    leaves = rng.uniform(0.02, 0.06, len(links))[which, None]
    rough = (leaves * np.exp(-ago / 6) + 0.011 * np.exp(-ago / 48)) * np.clip((ago - 1) / 3, 0, 1)
    level = orchard.in_leaves(rows) - 0.5 + rng.normal(0, 1.0, len(links))[which]
    cir = cir + rough * (rng.normal(size=(*ago.shape, 2)) @ [1, 1j])
    return np.asarray(10 ** (level / 20)[:, None] / 1.4 * cir)


def _ways(rows: pd.DataFrame, far: Floats) -> list[tuple[Floats, Floats]]:
    """Return by how many metres ways are longer, and what comes by them, [n] each."""
    tx, rx = (rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx"))
    soil = np.linalg.norm(tx - rx * [1, 1, -1], axis=1) - far
    ways = [(soil, np.full(len(far), 0.14))]
    for trunk in TRUNKS_M:
        legs = [np.hypot(*(end[:, :2] - trunk).T) + 1.0 for end in (tx, rx)]
        echo = np.minimum(0.8 * far / (legs[0] * legs[1]), 0.45)
        ways.append((np.maximum(legs[0] + legs[1] - far, 0.3), echo))
    return ways


def _turn(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(0, 2 * np.pi, size)))
