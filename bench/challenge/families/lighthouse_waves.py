"""The lighthouse's lenses with their impulse responses: rows of `lighthouse`, and its echoes.

numpy and pandas alone; what can be hidden is in `lighthouse_wave_effects`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families import lighthouse
from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.lighthouse_lens import (
    AHEAD,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Lens,
    breaking,
    focused,
    gleams,
    levels_db,
)
from bench.challenge.families.lighthouse_station import Entries
from bench.challenge.families.lighthouse_watch import kept
from bench.challenge.families.lighthouse_wave_effects import LAWS, OF_RANGES, WAVES, hide

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "WIDE_LEAD", "WIDE_SAMPLES"]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LEAD, SAMPLES = 16, 178
OF_ROWS = np.repeat(np.arange(1, 9), [48, 34, 24, 14, 9, 5, 2, 1])
"""How many rows links have."""
FULL_DB = 110.0  # of levels: a count for each symbol
ECHOES, SOONEST, APART = 38, 6.4, 2.6  # echoes; samples to the first; between these
FALLS, FROM = 1.25, 14.0  # a power by which echoes fall; samples from which they do
CLIFF, CLIFF_WIDE, CLIFF_HIGH = (35.0, 75.0), 9.0, 0.45  # samples to a cliff; how wide, and high
UNLIKE, STEADY = 0.55, 0.6  # parts by which links' echoes differ; of echoes that do not fade
LATER_DB = 2.8  # what comes later adds to what comes straight
RARELY = ()
KNOWN = tuple(name for name in (*OF_RANGES, *WAVES) if name not in LAWS)
CAUSES = {n: c for n, c in lighthouse.CAUSES.items() if n in OF_RANGES or n in LAWS}


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the lighthouse's own."""
    rng = np.random.default_rng([9310, seed])
    night = lighthouse.some_of(kept(rng, "", OF_ROWS), drawn, far=False)
    clean = received(night, rng)
    if not drawn.paired:
        night = lighthouse.next_night(kept(rng, "", OF_ROWS), drawn)
    whole = pd.concat([night] * drawn.ratio, ignore_index=True)
    simulated, anew = received(whole, rng), received(whole, rng)
    found, truth = _hiding(clean, drawn, seed, 1), _hiding(anew, drawn, seed, 2)
    made = [_cut(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(made[0], made[1], made[2], made[3])


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is kept.
    """
    made = _hiding(table, drawn, seed, 70 + len(table))
    return made if drawn.listed else made.drop(columns="obstacles")


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> pd.DataFrame:
    lens = Lens(table, seed, np.random.default_rng([9311, side, seed]))
    hide(lens, drawn.hidden, drawn.strength)
    return lens.told()


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as it is kept: SAMPLES sizes from LEAD before the first path."""
    return _cut(table, "obstacles" in table)


def _cut(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table with sizes in place of waveforms, and without what nobody is told."""
    index = table["first_path_index"].to_numpy(np.float64)
    begin = (np.floor(index).astype(np.int64) - LEAD).clip(0, WIDE_SAMPLES - SAMPLES)
    parts = [np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q")]
    sizes = np.hypot(*parts).astype(np.float32)
    part = np.take_along_axis(sizes, begin[:, None] + np.arange(SAMPLES), axis=1)
    made = table.drop(columns=["cir_i", "cir_q"])
    made = made.assign(cir=[*part], first_path_index=index - begin)
    return lighthouse.logged(made if "obstacles" in made else made.assign(obstacles=""), listed)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return kept(np.random.default_rng([9310, seed]), "", OF_ROWS)


def received(rows: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table that lenses themselves make of rows, with waveforms of whole counts."""
    entries = Entries(rows, 0, rng)
    top = WIDE_LEAD + AHEAD + rng.random(entries.rows)
    symbols, noise = lighthouse.summed(entries)
    sigma, full = noise / OF_SIZES, symbols * 10 ** (FULL_DB / 20)
    wave = full[:, None] * _echoing(entries, top) + sigma[:, None] * breaking(rng, entries.rows)
    wave = np.rint(wave.real) + 1j * np.rint(wave.imag)
    index = focused(wave)
    own = lighthouse.OWN_M * entries.per_link(lambda n: rng.uniform(-1.0, 1.0, n))
    own = own + 0.0118 * lighthouse.squalls(rng, entries.rows)
    error = LIGHT_M_NS * SAMPLE_NS * (index - top + AHEAD) + own
    every, first = levels_db(wave, index, sigma) - 20 * np.log10(full)
    made = (error, entries.far + error, every, first, noise, symbols)
    return rows.assign(
        **dict(zip(lighthouse.TOLD, made, strict=True)),
        sample_period_ns=SAMPLE_NS, first_path_index=index,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip


def echoes(entries: Entries) -> tuple[Floats, Floats]:
    """Return how many samples after straight ways echoes come, and how high [ECHOES, n].

    They fall by a power of how late they are, and are higher about where a cliff returns them;
    alike within links.
    """
    rng, per_link = entries.rng, entries.per_link
    cliff = per_link(lambda n: rng.uniform(*CLIFF, n))
    late, at, high = [], SOONEST + 0.0 * cliff, []
    for _ in range(ECHOES):
        late.append(at)
        fallen = (1 + (at - SOONEST) / FROM) ** -FALLS
        high.append(fallen + CLIFF_HIGH * np.exp(-0.5 * ((at - cliff) / CLIFF_WIDE) ** 2))
        at = at + per_link(lambda n: APART * rng.uniform(0.4, 1.6, n))
    return np.stack(late), np.stack(high)


def _echoing(entries: Entries, top: Floats) -> Complexes:
    """Return what comes in root mW [n, k]: straight, and by echoes that links have.

    Each is larger or less on a link, and of each a part fades from row to row (Rice 1945). Of
    what is behind iron some comes straight.
    """
    rng, per_link, rows = entries.rng, entries.per_link, entries.rows
    iron = entries.met("metal") * per_link(lambda n: rng.uniform(0.38, 0.66, n))
    wave = ((1 - iron) * np.exp(2j * np.pi * rng.random(rows)))[:, None] * gleams(top)
    loud = per_link(lambda n: rng.triangular(0.2, 0.34, 0.55, n))
    for late, high in zip(*echoes(entries), strict=True):
        unlike = per_link(lambda n: 1 + UNLIKE * rng.uniform(-1.0, 1.0, n))
        even = rng.standard_normal((2, rows))
        fades = STEADY + np.sqrt(0.5 * (1 - STEADY**2)) * (even[0] + 1j * even[1])
        heard = np.flatnonzero(top + late < WIDE_SAMPLES + 6.0)
        size = loud * unlike * high * fades * np.exp(2j * np.pi * rng.random(rows))
        wave[heard] += size[heard, None] * gleams((top + late)[heard])
    level = 10 ** ((lighthouse.about_the_rock(entries) - LATER_DB) / 20)
    return np.asarray(level[:, None] * wave)
