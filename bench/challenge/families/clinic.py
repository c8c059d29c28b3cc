"""Beds of a clinic ranged from nodes below the ceiling, as channel impulse responses.

numpy and pandas alone; what it can hide is in `clinic_effects`. Its own simulator: a windowed sine
cardinal, mirrored walls that scatter, dense taps that rise before they fall, a centroid detector.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.clinic_effects import EFFECTS, LAST, LAWS, NODES, PARTITIONS
from bench.challenge.families.clinic_scan import (
    QUIET,
    SAMPLE_M,
    WIDE_LEAD,
    WIDE_SAMPLES,
    Scan,
    read,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
ROOMS_M = ((5.2, 4.1, 2.8), (9.5, 6.2, 3.0), (19.0, 2.7, 2.6))  # treatment, ward, corridor
SMALLER, LARGER = (0.6, 0.3, 0.1), (0.15, 0.35, 0.5)  # shares of rooms where mixes differ
LINKS, MOST_ROWS = 110, 2
LEAD, SAMPLES = 10, 150  # of the impulse responses that are shown
GAIN, NOISE, SCATTER_M = 26000.0, 38.0, 0.018
SYMBOLS, FULL_DB = 992.0, 154.0  # accumulated; of counts squared at 0 dBm
CAUSES: dict[str, str] = {}
RARELY = ()
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the clinic's own."""
    rng = np.random.default_rng([seed, 71])
    rows = _placed(rng, (0.35, 0.4, 0.25) if drawn.same_mix else SMALLER)
    clean = _received(rows, [seed, 72])
    found = conceal(clean, drawn, seed)
    if not drawn.paired:
        rows = _placed(rng, (0.35, 0.4, 0.25) if drawn.same_mix else LARGER)
        rows = rows.assign(link="sim " + rows["link"])
    more, again = (
        pd.concat([_received(rows, [seed, part, n]) for n in range(drawn.ratio)], ignore_index=True)
        for part in (73, 74)
    )
    truth = conceal(again, drawn, seed + 1, seed)
    gone = [] if drawn.listed else ["obstacles"]
    found, clean, more, truth = (
        recorded(one).drop(columns=gone, errors="ignore") for one in (found, clean, more, truth)
    )
    return Tables(found, clean, more, truth)


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _placed(np.random.default_rng([seed, 71]), (0.35, 0.4, 0.25))


def conceal(table: pd.DataFrame, drawn: Draw, seed: int, own: int | None = None) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown. `own`:
    the seed of what devices keep, `seed` itself unless given.
    """
    rng = np.random.default_rng([seed, 75, len(table)])
    scan = Scan.of(table, seed if own is None else own, rng)
    for name in sorted(drawn.hidden, key=lambda one: one in LAST and 1 + LAST.index(one)):
        EFFECTS[name](scan, drawn.strength)
    return scan.written().drop(columns=[] if drawn.listed else ["obstacles"])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as a radio would log it: SAMPLES magnitudes from LEAD before the path."""
    begin = np.floor(table["first_path_index"].to_numpy(np.float64)).astype(int) - LEAD
    begin = np.clip(begin, 0, WIDE_SAMPLES - SAMPLES)
    size = [
        np.hypot(real, imaginary)[at : at + SAMPLES].astype(np.float32)
        for real, imaginary, at in zip(table["cir_i"], table["cir_q"], begin, strict=True)
    ]
    shown = table.drop(columns=["cir_i", "cir_q"])
    return shown.assign(cir=size, first_path_index=table["first_path_index"] - begin)


def _placed(rng: np.random.Generator, shares: tuple[float, ...]) -> pd.DataFrame:
    """Return what is known of the rows: beds anywhere in rooms of three kinds by `shares`."""
    kind = rng.choice(len(ROOMS_M), LINKS, p=shares)
    room, node = np.array(ROOMS_M)[kind], rng.integers(0, len(NODES), LINKS)
    low, high = np.full((LINKS, 3), 0.4), np.column_stack([room[:, :2] - 0.4, np.full(LINKS, 1.1)])
    ends = {"tx": rng.uniform(low, high), "rx": room * np.array(NODES)[node], "room": room}
    rows = np.repeat(np.arange(LINKS), rng.integers(1, MOST_ROWS + 1, LINKS))
    places = {
        f"{end}_{axis}_m": at[rows, place]
        for end, at in ends.items()
        for place, axis in enumerate("xyz")
    }
    frame = pd.DataFrame({"link": [f"c{row}" for row in rows], **places})
    frame = frame.assign(
        tx=[f"bed{row % 4}" for row in rows],
        rx=[f"node{node[row]}" for row in rows],
        time_s=np.arange(len(rows)) * 2.5,
        true_range_m=np.linalg.norm(ends["tx"] - ends["rx"], axis=1)[rows],
        people=rng.poisson(3.0, LINKS)[rows].astype(np.float64),
        door_deg=rng.uniform(0, 95, LINKS)[rows],
        charge_pct=rng.uniform(5, 100, len(rows)),
    )
    kinds = rng.choice(["", *PARTITIONS, "metal"], LINKS, p=[0.5, 0.13, 0.12, 0.1, 0.15])
    walls = [[str(kinds[row])] if kinds[row] else [] for row in rows]
    return frame.assign(obstacles=pd.Series(walls, dtype=object))


def _received(rows: pd.DataFrame, seed: list[int]) -> pd.DataFrame:
    """Return the table with the complex samples, ranges and levels of the clinic's own radio."""
    rng, count = np.random.default_rng(seed), len(rows)
    start = WIDE_LEAD + rng.random(count)
    cir = _pulses(start, *_ways(rows, rng)) + _furniture(rows, start, rng)
    noise = rng.normal(0, NOISE, (2, *cir.shape))
    cir = cir + noise[0] + 1j * noise[1]
    first, energy, early = read(cir, np.full(count, 2 * NOISE**2))
    error = SAMPLE_M * (first - start) + rng.normal(0, SCATTER_M, count)
    return rows.assign(
        range_m=rows["true_range_m"] + error,
        error_m=error,
        rx_power_dbm=10 * np.log10(energy) - FULL_DB,
        first_path_power_dbm=10 * np.log10(early) - FULL_DB,
        noise_std=np.abs(cir[:, :QUIET]).std(axis=1),
        preamble_count=SYMBOLS,
        first_path_index=first,
        sample_period_ns=1.0016,
        cir_i=list(cir.real),
        cir_q=list(cir.imag),
    )


def _ways(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Complexes]:
    """Return excess in samples and gain [n, 8]: straight, four walls, floor, two of twice two."""
    tx, rx, room = (
        rows[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)
        for end in ("tx", "rx", "room")
    )
    zero = np.zeros(len(rows))
    planes = [[(axis, wall)] for axis in (0, 1) for wall in (zero, room[:, axis])]
    planes += [[(2, zero)], [(0, zero), (1, zero)], [(0, room[:, 0]), (1, room[:, 1])]]
    images = [tx]
    for turns in planes:
        image = tx.copy()
        for axis, wall in turns:
            image[:, axis] = 2 * wall - image[:, axis]
        images.append(image)
    far = np.stack([np.linalg.norm(image - rx, axis=1) for image in images], axis=1)
    kept = 0.33 ** np.array([0, *map(len, planes)])  # of the amplitude
    codes, links = pd.factorize(rows["link"])
    shade = 10 ** (rng.normal(0, 1.0, len(links))[codes] / 20)
    turn = np.exp(2j * np.pi * rng.random(far.shape)) * rng.rayleigh(0.8, far.shape)
    turn[:, 0] *= _behind_steel(rows, rng) / np.abs(turn[:, 0])
    gain = GAIN * shade[:, None] * kept * turn / far
    return (far - far[:, :1]) / SAMPLE_M, np.asarray(gain, np.complex128)


def _behind_steel(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return what a steel cabinet leaves of the straight line's amplitude, 1 without one [n]."""
    codes, links = pd.factorize(rows["link"])
    loss_db = rng.uniform(7, 13, len(links))[codes]
    return np.array(["metal" in row for row in rows["obstacles"]]) * (10 ** (-loss_db / 20) - 1) + 1


def _pulses(start: Floats, longer: Floats, gain: Complexes) -> Complexes:
    """Return the sum of pulses [n, WIDE_SAMPLES]: sines cardinal under a bell."""
    total = np.zeros((len(start), WIDE_SAMPLES), complex)
    for late, size in zip(longer.T, gain.T, strict=True):
        lag = np.arange(WIDE_SAMPLES) - (start + late)[:, None] - 1.2
        total += size[:, None] * np.sinc(lag / 2.2) * np.exp(-np.square(lag / 2.8))
    return total


def _furniture(rows: pd.DataFrame, start: Floats, rng: np.random.Generator) -> Complexes:
    """Return dense taps whose power rises and falls, slower in larger rooms [n, WIDE_SAMPLES]."""
    room = rows[["room_x_m", "room_y_m"]].to_numpy(np.float64)
    fall = 6 + 1.2 * np.sqrt(room.prod(axis=1))[:, None]
    after = np.maximum(np.arange(WIDE_SAMPLES) - start[:, None] - 1.5, 0)
    shape = (1 - np.exp(-after / 2)) * np.exp(-after / (2 * fall))
    loud = 0.035 * GAIN / rows["true_range_m"].to_numpy(np.float64) ** 0.7
    taps = rng.laplace(size=(2, *shape.shape)) * shape * loud[:, None]
    pad = np.pad(taps[0] + 1j * taps[1], ((0, 0), (2, 2)))
    weights = zip((0.1, 0.5, 0.7, 0.5, 0.1), range(5), strict=True)
    return np.asarray(sum(w * pad[:, at : at + WIDE_SAMPLES] for w, at in weights))
