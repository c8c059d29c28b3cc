"""The signal box's radio with its impulse responses: rows of `signalbox`, wagons that return.

numpy and pandas alone; what can be hidden is in `signalbox_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import signalbox
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.signalbox_frame import (
    METRES,
    OF_NOISE,
    SAMPLE,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Strip,
    book,
    onsets,
    splines,
    static,
)
from bench.challenge.families.signalbox_wave_effects import LAWS, OF_RANGES, WAVES, signal

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 148
ROUNDS = (1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 5, 5, 6)
FULL_DB = 112.0  # of levels
EARLY = 2.3  # samples by which clean pulses are timed before their tops, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: cause for name, cause in signalbox.CAUSES.items() if name in OF_RANGES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the signal box's own."""
    rng = np.random.default_rng([905, seed])
    side = 0 if drawn.same_mix else 1
    rows = signalbox.sorted_out(_runs(rng), side)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = signalbox.sorted_out(_runs(rng), -side)
        rows["link"] = "by the timetable, " + rows["link"]
    many = pd.concat(drawn.ratio * [rows], ignore_index=True)
    model, once_more = received(many, rng), received(many, rng)
    found, truth = (_signalled(one, drawn, seed) for one in (clean, once_more))
    out = [_printed(one, drawn.listed) for one in (found, clean, model, truth)]
    return Tables(out[0], out[1], out[2], out[3])


def _runs(rng: np.random.Generator) -> pd.DataFrame:
    return signalbox.runs(rng, "", ROUNDS)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _runs(np.random.default_rng([905, seed]))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    out = _signalled(table, drawn, seed)
    return out if drawn.listed else out.drop(columns="obstacles")


def _signalled(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    strip = Strip(table, seed, np.random.default_rng([906, len(table), seed]))
    signal(strip, drawn.hidden, drawn.strength)
    return strip.entered()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is printed: SAMPLES sizes from LEAD before the first path."""
    return _printed(table, listed=True)


def _printed(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    index = table["first_path_index"].to_numpy(np.float64)
    begin = np.clip(np.floor(index) - LEAD, 0, WIDE_SAMPLES - SAMPLES)
    sizes = np.hypot(*(np.stack(list(table[name])) for name in ("cir_i", "cir_q")))
    taken = begin[:, None].astype(np.intp) + np.arange(SAMPLES)
    out = signalbox.put_out(table.drop(columns=["cir_i", "cir_q"]), listed)
    part = np.take_along_axis(sizes, taken, axis=1).astype(np.float32)
    return out.assign(cir=[*part], first_path_index=index - begin)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the signal box's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + 2.0 + rng.random(size)
    symbols = 1001.0 - rng.geometric(0.09, size)
    sigma = 88.0 * rng.lognormal(0, 0.03, size)
    full = symbols * 10 ** (0.05 * FULL_DB)
    cir = full[:, None] * _in_the_yard(rows, top, rng) + sigma[:, None] * static(rng, size)
    index = onsets(cir, sigma)
    error = METRES * (index - top + EARLY) + 0.03 * (rng.beta(2.0, 2.0, size) - 0.5)
    level, first = book(cir, index, sigma) - 20 * np.log10(full)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=first,
        first_path_index=index,
        sample_period_ns=1.0016,
        noise_std=OF_NOISE * sigma,
        preamble_count=symbols,
        cir_i=[*cir.real],
        cir_q=[*cir.imag],
    )


def _in_the_yard(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by wagons here and there, by the rest."""
    size, (number, names) = len(rows), pd.factorize(rows["link"])
    tank = rows["obstacles"].map(lambda some: "metal" in some).to_numpy(np.float64)
    straight = 1 - tank * rng.beta(2, 6, len(names))[number]
    cir = (straight * _turns(rng, size))[:, None] * splines(top)
    for share in (0.26, 0.2, 0.17, 0.13, 0.1, 0.08):  # from wagons that stand about
        late = 4.0 + 40.0 * rng.power(0.8, len(names))
        some = share * rng.rayleigh(0.8, len(names))[number] * _turns(rng, size)
        cir = cir + some[:, None] * splines(top + late[number])
    since = np.maximum(SAMPLE - top[:, None] - 2, 0)
    rest = rng.uniform(0.01, 0.03, len(names))[number, None] * np.exp(-since / 30.0) * (since > 0)
    level = signalbox.in_the_yard(rows) + 1.1 * rng.standard_normal(len(names))[number] - 4.1
    return np.asarray(10 ** (0.05 * level)[:, None] * (cir + rest * static(rng, size)))


def _turns(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
