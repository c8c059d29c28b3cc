"""The supermarket's radio with its impulse responses: rows of `market`, shelves that scatter.

numpy and pandas alone; what can be hidden is in `market_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import market
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.market_desk import (
    METRES,
    OF_NOISE,
    PLACES,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Desk,
    begins,
    bumps,
    grain,
    totals,
)
from bench.challenge.families.market_plan import SHELVES_M
from bench.challenge.families.market_wave_effects import LAWS, OF_RANGES, WAVES, go_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 10, 122
POLLS = 2
FULL_DB = 119.3  # of levels
EARLY = 1.111  # samples by which clean pulses are timed after their begin, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in market.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the supermarket's own."""
    rng = np.random.default_rng([761, seed])
    rows = market.chosen(_tours(rng), "" if drawn.same_mix else "short")
    clean = received(rows, rng)
    if not drawn.paired:
        rows = market.chosen(_tours(rng), "" if drawn.same_mix else "long")
        rows["link"] = "planned " + rows["link"]
    times = pd.concat([rows] * drawn.ratio, ignore_index=True)
    model = received(times, rng)
    truth = conceal(received(times, rng), drawn, seed)
    found = conceal(clean, drawn, seed)
    four = (found, clean, model, truth)
    shown, plain, other, true = (market.to_hand_out(recorded(t), drawn.listed) for t in four)
    return Tables(shown, plain, other, true)


def _tours(rng: np.random.Generator) -> pd.DataFrame:
    return market.tours(rng, "", POLLS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _tours(np.random.default_rng([761, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    desk = Desk(table, seed, np.random.default_rng([seed, 762, len(table)]))
    go_through(desk, drawn.hidden, drawn.strength)
    out = desk.logged()
    return out if drawn.listed else out.drop(columns="obstacles")


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is logged: SAMPLES sizes from LEAD before the first path."""
    place = np.asarray(table["first_path_index"], np.float64)
    begin = np.clip(place.astype(np.intp) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(*(np.array([*table[name]], np.float32) for name in ("cir_i", "cir_q")))
    out = market.to_hand_out(table, listed=True).drop(columns=["cir_i", "cir_q"])
    windows = np.lib.stride_tricks.sliding_window_view(sizes, SAMPLES, axis=1)
    out["cir"] = list(windows[np.arange(len(out)), begin].copy())
    return out.assign(first_path_index=place - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the supermarket's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    begin, symbols = WIDE_LEAD + rng.random(size), 124.0 - rng.binomial(8, 0.3, size)
    sigma = 19.0 * rng.gamma(300.0, 1 / 300.0, size)
    gain = symbols * 10 ** (FULL_DB / 20)
    cir = gain[:, None] * _comes(rows, begin, rng) + sigma[:, None] * grain(rng, size)
    index = begins(cir, sigma)
    out = rows.assign(first_path_index=index, sample_period_ns=1.0016)
    out["error_m"] = METRES * (index - begin - EARLY) + 0.013 * rng.standard_t(7, size)
    out["range_m"] = out["true_range_m"] + out["error_m"]
    level, first = totals(cir, index) - 20 * np.log10(gain)
    out["rx_power_dbm"], out["first_path_power_dbm"] = level, first
    out["noise_std"], out["preamble_count"] = OF_NOISE * sigma, symbols
    return out.assign(cir_i=list(cir.real), cir_q=list(cir.imag))


def _comes(rows: pd.DataFrame, begin: Floats, rng: np.random.Generator) -> Complexes:
    """Return what comes in root mW: straight, by the backs of shelves, and from all the tins."""
    size, (which, links) = len(rows), pd.factorize(rows["link"])
    behind = np.array(["metal" in one for one in rows["obstacles"]])
    straight = np.where(behind, rng.uniform(0.5, 0.8, len(links))[which], 1.0)
    cir = (straight * _any_phase(rng, size))[:, None] * bumps(begin)
    for longer, echo in _shelves(rows):
        tins = echo * rng.uniform(0.4, 1.0, len(links))[which] * _any_phase(rng, size)
        cir = cir + tins[:, None] * bumps(begin + longer / METRES)
    after = PLACES - begin[:, None]
    full = rng.lognormal(-3.9, 0.25, len(links))[which, None]
    tins = full * np.exp(-np.maximum(after, 0) / 24) * (1 - np.exp(-np.maximum(after - 1, 0) / 6))
    level = market.under_lamps(rows) - 3.2 + rng.normal(0, 0.8, len(links))[which]
    return np.asarray(10 ** (level / 20)[:, None] * (cir + tins * grain(rng, size)))


def _shelves(rows: pd.DataFrame) -> list[tuple[Floats, Floats]]:
    """Return by how many metres ways by shelves are longer, and what comes by them, [n] each."""
    tx, rx = (rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx"))
    far, ways = rows["true_range_m"].to_numpy(np.float64), []
    for at in SHELVES_M[::2]:
        way = np.linalg.norm((tx - [2 * at, 0, 0]) * [-1, 1, 1] - rx, axis=1)
        same = (tx[:, 0] - at) * (rx[:, 0] - at) > 0  # both on one side of it
        ways.append((np.maximum(way - far, 1.2), np.where(same, 0.3 * far / way, 0.0)))
    return ways


def _any_phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(1j * rng.uniform(0, 2 * np.pi, size)))
