"""The fairground's radio with its impulse responses: rows of `fairground`, a wheel that returns.

numpy and pandas alone; what can be hidden is in `fairground_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import fairground
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.fairground_effects import by_the_rim, rim_m
from bench.challenge.families.fairground_rides import BOOTHS_M, Ticket
from bench.challenge.families.fairground_till import (
    METRES,
    OF_NOISE,
    STEP,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Till,
    chatter,
    peals,
    prints,
    strikes,
)
from bench.challenge.families.fairground_wave_effects import LAWS, OF_RANGES, WAVES, go_through

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 168
ROUNDS = (1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 4, 4, 5, 5, 6)
FULL_DB = 110.0  # of levels
BEFORE = 2.09  # samples by which tangents to clean edges meet zero before tops, by trial
KNOWN = (*OF_RANGES, *(name for name in WAVES if name not in LAWS))
CAUSES = {name: fairground.CAUSES[name] for name in OF_RANGES if name in fairground.CAUSES}
RARELY = ()


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the fairground's own."""
    rng = np.random.default_rng([seed, 5, 985])
    rows = fairground.mixed(fairground.rides(rng, "", ROUNDS), drawn, 1)
    clean = received(rows, rng)
    if not drawn.paired:
        rows = fairground.mixed(fairground.rides(rng, "", ROUNDS), drawn, -1)
        rows["link"] = [f"at another fair {link}" for link in rows["link"]]
    rows = rows.iloc[np.tile(np.arange(len(rows)), drawn.ratio)].reset_index(drop=True)
    model = received(rows, rng)
    every = [_through(clean, drawn, seed), clean, model, _through(received(rows, rng), drawn, seed)]
    a, b, c, d = (_shown(one, drawn.listed) for one in every)
    return Tables(a, b, c, d)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return fairground.rides(np.random.default_rng([seed, 5, 985]), "", ROUNDS)


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    out = _through(table, drawn, seed)
    return out if drawn.listed else out.drop(columns=["obstacles"])


def _through(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    till = Till(table, seed, np.random.default_rng([seed, 986, len(table)]))
    go_through(till, drawn.hidden, drawn.strength)
    return till.printed()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is shown: SAMPLES sizes from LEAD before the first path."""
    return _shown(table, listed=True)


def _shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody knows."""
    index, sizes, left = table["first_path_index"].to_numpy(np.float64), [], []
    for at, i, q in zip(index.tolist(), table["cir_i"], table["cir_q"], strict=True):
        begin = min(max(int(at) - LEAD, 0), WIDE_SAMPLES - SAMPLES)
        part = slice(begin, begin + SAMPLES)
        sizes.append(np.abs(i[part] + 1j * q[part]).astype(np.float32))
        left.append(at - begin)
    bare = fairground.open_to_all(table.drop(columns=["cir_i", "cir_q"]), listed)
    return bare.assign(cir=sizes, first_path_index=left)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that the fairground's own radio makes of rows, with complex waveforms."""
    size = len(rows)
    top = WIDE_LEAD + 1.8 + rng.random(size)
    symbols = 1012.0 - rng.negative_binomial(6, 0.5, size)
    sigma = 83.0 / np.sqrt(rng.chisquare(500.0, size) / 500.0)
    full = symbols * 10 ** (FULL_DB / 20)
    cir = full[:, None] * _about(rows, top, rng) + sigma[:, None] * chatter(rng, size)
    index = strikes(cir, sigma)
    error = METRES * (index - top + BEFORE) + rng.logistic(0.0, 0.006, size)
    level, first = prints(cir, index, sigma) - 20 * np.log10(full)
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


def _about(rows: pd.DataFrame, top: Floats, rng: np.random.Generator) -> Complexes:
    """Return what is heard in root mW [n, k]: straight, by the rim, by fronts, by people."""
    size, (number, links) = len(rows), pd.factorize(rows["link"])
    steel = np.array(["metal" in some for some in rows["obstacles"]], np.float64)
    straight = 1 - steel * rng.uniform(0.1, 0.4, len(links))[number]
    cir = (straight * _phase(rng, size))[:, None] * peals(top)
    for late, share in _off_the_rim(rows):
        glint = share * rng.rayleigh(0.8, len(links))[number]
        cir = cir + (glint * _phase(rng, size))[:, None] * peals(top + late)
    for _ in range(5):  # fronts of booths, here and there
        late = rng.triangular(5.0, 12.0, 70.0, len(links))
        share = 0.2 * np.exp(-late / 45.0) * rng.gamma(1.5, 0.6, len(links))
        cir = cir + (share[number] * _phase(rng, size))[:, None] * peals(top + late[number])
    past = np.maximum(STEP - top[:, None] - 3.0, 0.0)
    people = rng.uniform(0.006, 0.018, len(links))[number, None] / np.cosh(past / 30.0)
    whole = cir + np.where(past > 0, people, 0.0) * chatter(rng, size)
    level = fairground.on_the_meadow(rows) + rng.triangular(-2.6, 0.0, 2.6, len(links))[number]
    return np.asarray(np.power(10.0, (level - 4.9) / 20)[:, None] * whole)


def _off_the_rim(rows: pd.DataFrame) -> list[tuple[Floats, Floats]]:
    """Return how many samples later ways by the wheel's rim come, and their shares, [n] each.

    As both legs spread: by their product beside the straight way.
    """
    ways = by_the_rim(Ticket(rows, 0, np.random.default_rng(0)))[::2]
    out = []
    for place, way in zip(rim_m()[::2], ways, strict=True):
        far = rows["true_range_m"].to_numpy(np.float64)
        booth = rows["rx"].str.removeprefix("booth").astype(int).to_numpy()
        leg = np.linalg.norm(BOOTHS_M - place, axis=1)[booth]
        share = np.minimum(0.9 * far / (leg * np.maximum(way - leg, 2.0)), 0.22)
        out.append((np.clip((way - far) / METRES, 4.5, 150.0), share))
    return out


def _phase(rng: np.random.Generator, size: int) -> Complexes:
    return np.asarray(np.exp(2j * np.pi * rng.random(size)))
