"""Effect 20: integer accumulator values and their offset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.base import there
from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.loops import compiled, parts, quantise_rows
from bench.physics.randomness import Draws
from bench.physics.units import Complexes, Floats

EQUAL_ROWS = 100  # looked at
MOST_COUNTS = 1024.0  # of a step: several times the noise of the loudest accumulators recorded
EQUAL_MANY = 0.5  # of the samples: rounding is plain to see
EQUAL_SURE = 0.25  # of the samples, which nothing but rounding makes equal on a coarse grid
COARSE = 0.1  # of the noise, that the step of such a grid has: long records have more levels, of
# which fewer are equal, and are rounded no less [convention]
QUARTER = np.sqrt(-np.log(0.75))  # of noise of size 1, the lower quartile of magnitudes [derived]
GRID_APART = 1e-3  # of the largest: nearer samples of a grid are one [derived]
GRID_SURE, GRID_NEAR = 0.9, 0.1  # of the samples, within so much of a whole number: one in five
# of others would be [convention]
EQUAL_LEAST = 0.003  # of the samples: of 24 random bits, 150 samples have 2e-5 [derived]
AHEAD, BEHIND = 3, 8  # samples before and after a first path, beyond which none is of its pulse
EQUAL_AHEAD = 0.5  # as often as behind a path, two samples before it are equal at least: noise is
# weaker, so has no more levels; half, as steps may widen with what they stand for [derived]
EQUAL_ERRORS = 5.0  # standard errors, by which they surely are not [convention]
_QUANTILES = (np.arange(256) + 0.5) / 256  # of a noise whose rounding is worked out


@dataclass(frozen=True)
class Quantisation(Effect):
    """Adds a constant offset to real and imaginary part, rounds both and clips.

    The offset has a random direction per receiving device and a length of `offset_counts`
    (30 to 150 recorded). A step of zero neither rounds nor clips; as delivered only what 24 bits
    do not hold is clipped: a simulator whose counts have another scale is not to be cut. Low bits
    that are dropped round towards zero (`dropped` 1); dropped where samples are read out
    (`read_out` 1), they leave the noise as the receiver reports it.
    """

    name = "quantisation"
    number = 20
    stage = "receiver"
    stackable = True
    source = "DW1000 User Manual 2.11, 7.2.38 (ACC_MEM); offsets measured on zenodo.4742391"
    signature = "whole numbers; a constant added to every complex sample"
    needs = (("cir",),)
    without_cir = False
    essential = ("step_counts",)

    step_counts: float = parameter(1, "counts", 0, MOST_COUNTS, "rounding step", null=0)
    offset_counts: float = parameter(0, "counts", 0, 1000, "length of the offset", null=0)
    limit_counts: float = parameter(
        8388607, "counts", 127, 8388607, "largest value: 32767 of 16 bits", fitted=False
    )
    dropped: float = parameter(0, "1", 0, 1, "0 rounds to the nearest step, 1 towards zero")
    read_out: float = parameter(0, "1", 0, 1, "0 in the accumulator, 1 where it is read out")
    beside_zero: float = parameter(
        0, "1", 0, 1, "1 where no level is zero: middles of steps", fitted=False
    )

    @classmethod
    def unmarked(cls, frame: pd.DataFrame) -> str:
        """Return that no two recorded samples are equal: rounded ones are, others never.

        Or late ones alone are, which were made so later.
        """
        if "cir" not in frame:
            return ""
        if equal_share(frame["cir"]) <= EQUAL_LEAST:
            return "samples of which some are equal, as rounded ones are"
        return "samples that are equal before first paths, too" if late_alone(frame) else ""

    @classmethod
    def by_mark(cls, frame: pd.DataFrame) -> tuple[Effect, ...]:
        """Return the roundings whose grid recorded samples lie on, where many are equal."""
        if "cir" not in frame or not coarse(frame["cir"]) or late_alone(frame):
            return ()
        step, beside = min(grid_step(frame["cir"]), MOST_COUNTS), beside_zero(frame["cir"])
        levels = [(0.0, 1.0)] if beside else [(0.0, 0.0), (1.0, 0.0)]  # no zero: nothing to drop
        ways = [(*each, read_out) for each in levels for read_out in (0.0, 1.0)]
        kind = OnGrid if on_grid(frame["cir"], step) else cls
        made = (kind(step, dropped=d, read_out=r, beside_zero=b) for d, b, r in ways)
        return tuple(made) if step > 0 else ()

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Round the noise, and its sum with the signal: both stay whole numbers."""
        if batch.waveform is None or batch.noise is None:
            return batch
        if self.step_counts == 0 and self.offset_counts == 0:
            return batch
        waveform, added = batch.waveform, batch.noise + self._offset(batch, draws)[:, None]
        if batch.as_given:  # else the samples tell
            batch = self._as_reported(batch)
        if self.step_counts == 0:
            return altered(batch, noise=added)
        signal, noise = np.empty_like(waveform), np.empty_like(added)
        levels = self.step_counts, self.limit_counts, self.dropped, self.beside_zero
        settings = (np.float32(value) for value in levels)
        arrays = (parts(each) for each in (signal, noise, waveform, added))
        compiled(quantise_rows)(*arrays, *settings)
        if self.read_out == 0:
            return altered(batch, waveform=signal, noise=noise)
        unseen = np.complex64(self.read_out) * (added - noise)
        return altered(batch, waveform=signal - unseen, noise=noise + unseen)

    def _offset(self, batch: Batch, draws: Draws) -> Complexes:
        angle = 2 * np.pi * draws.group_uniform(batch.rows.group("rx"))
        return np.asarray(self.offset_counts * np.exp(1j * angle), np.complex64)

    def _as_reported(self, batch: Batch) -> Batch:
        """Return a batch of given samples with the noise that is reported of them rounded."""
        ratio = 1 + (1 - self.read_out) * (self._rounded_noise(there(batch.noise_power)) - 1)
        batch = altered(batch, noise_power=there(batch.noise_power) * ratio**2)
        return batch.steadier(np.full(len(batch), float(self.offset_counts) ** 2))

    def _rounded_noise(self, power: Floats) -> Floats:
        """Return by what factor [n] rounding changes the scatter of noise magnitudes."""
        if self.step_counts == 0:
            return np.ones(len(power))
        size = np.sqrt(np.maximum(power, 1e-12))[:, None] * np.sqrt(-np.log(1 - _QUANTILES))
        if self.beside_zero:  # in the part that has the size, and half a step in the other
            steps = np.hypot(np.floor(size / self.step_counts) + 0.5, 0.5)
        else:
            steps = np.floor(size / self.step_counts + 0.5 - 0.5 * self.dropped)
        return np.asarray(steps.std(axis=1) * self.step_counts / size.std(axis=1))


@dataclass(frozen=True)
class OnGrid(Quantisation):
    """Rounding to the step of the grid that recorded samples lie on: read off, it is not fitted."""

    stackable = True

    step_counts: float = parameter(
        1, "counts", 0, MOST_COUNTS, "rounding step, that of the grid of samples", fitted=False
    )


def on_grid(cirs: pd.Series, step: float) -> bool:
    """Return whether nearly all samples lie on a grid of so large a step, or half a step beside it.

    Not where steps grow with what they stand for.
    """
    if step <= 0:
        return False
    return bool(np.median([_lies_on(row, step) for row in _some(cirs)] or [0.0]) >= GRID_SURE)


def _lies_on(row: NDArray[Any], step: float) -> float:
    """Return the share of a row's samples, or of their squares, in whole halves of the grid."""
    whole = np.iscomplexobj(row)
    units = 2 * row.real / step if whole else 4 * (row.astype(np.float64) / step) ** 2
    return float(np.mean(np.abs(units - np.round(units)) < GRID_NEAR))


def coarse(cirs: pd.Series) -> bool:
    """Return whether samples are rounded coarsely: many are equal, or the step is a part of noise.

    The weakest quarter of a row holds noise, or more than that.
    """
    share = equal_share(cirs)
    if share >= EQUAL_MANY or share < EQUAL_SURE:
        return share >= EQUAL_MANY
    quiet = [float(np.percentile(np.abs(row), 25)) for row in _some(cirs)]
    return bool(grid_step(cirs) >= COARSE * float(np.median(quiet)) / QUARTER)


def grid_step(cirs: pd.Series) -> float:
    """Return the step of the grid that samples lie on: the typical smallest distance in a row.

    Of real parts; of magnitudes, whose squares are whole multiples of the squared step.
    """
    return float(np.median([step for step, _ in _grids(cirs)] or [0.0]))


def beside_zero(cirs: pd.Series) -> bool:
    """Return whether in most rows both parts of samples lie half a step beside zero."""
    return bool(np.median([beside for _, beside in _grids(cirs)] or [False]) > 0.5)


def _grids(cirs: pd.Series) -> list[tuple[float, bool]]:
    """Return the step of the grid of rows, and whether that has no zero, where there is one."""
    every = (_grid(row) for row in _some(cirs))
    return [one for one in every if one]


def _grid(row: NDArray[Any]) -> tuple[float, bool] | None:
    """Return the step of the grid of a row, and whether that has no zero; None where none is."""
    whole = np.iscomplexobj(row)
    parts = np.unique(row.real if whole else row.astype(np.float64) ** 2)
    parts = parts[: len(parts) // 2 + 1]  # the rounding of 32 bits is coarse in the others
    apart = np.diff(parts)
    apart = apart[apart > GRID_APART * np.abs(np.median(parts))]
    if not len(apart):
        return None
    least = float(apart.min())
    if whole:
        return least, _at(parts / least, 0.5)
    beside = _at(parts / least, 0.25)  # squares are (odd + odd) / 4 squared steps, two apart
    return np.sqrt(least / (2 if beside else 1)), beside


def _at(parts: Floats, place: float) -> bool:
    """Return whether most values lie at such a part of 1 behind whole numbers.

    Where steps grow with what they stand for they lie anywhere, and their median may do so too.
    """
    return bool(np.mean(np.abs(parts % 1 - place) < 0.1) > 0.5)


def equal_share(cirs: pd.Series) -> float:
    """Return the share of the samples of a row that equal another of it, over some rows.

    Real parts, or magnitudes; zeros do not count: they are what is missing.
    """
    each = [np.real(row) for row in _some(cirs)]
    kept = [row[np.isfinite(row) & (row != 0)] for row in each]
    count = sum(map(len, kept))
    return 1 - sum(len(np.unique(row)) for row in kept) / count if count else 0.0


def late_alone(frame: pd.DataFrame) -> bool:
    """Return whether samples repeat each other behind first paths, and do not before them.

    Rounding takes every sample of a record, and noise alone, which is weaker, has no more levels
    than what lies behind a path: two of it are equal as often.
    """
    if "first_path_index" not in frame:
        return False
    few = _few(len(frame))
    rows = zip(frame["cir"].iloc[few], frame["first_path_index"].iloc[few], strict=True)
    able = [(np.real(row), int(at)) for row, at in rows if np.ndim(row) == 1 and np.isfinite(at)]
    ahead = np.sum([_pairs(row[: max(at - AHEAD, 0)]) for row, at in able] or [(0, 0)], axis=0)
    behind = np.sum([_pairs(row[max(at + BEHIND, 0) :]) for row, at in able] or [(0, 0)], axis=0)
    expected = EQUAL_AHEAD * behind[0] / max(behind[1], 1) * ahead[1]
    return bool(ahead[0] + EQUAL_ERRORS * np.sqrt(ahead[0] + 1) < expected)


def _pairs(samples: Floats) -> tuple[float, float]:
    """Return how many pairs of samples are equal, and how many pairs there are; zeros are none."""
    known = samples[np.isfinite(samples) & (samples != 0)]
    equal = np.unique(known, return_counts=True)[1]
    return float((equal * (equal - 1) / 2).sum()), len(known) * (len(known) - 1) / 2


def _few(rows: int) -> NDArray[np.intp]:
    """Return which of so many rows are looked at."""
    return np.unique(np.linspace(0, rows - 1, EQUAL_ROWS).astype(np.intp))


def _some(cirs: pd.Series) -> list[NDArray[Any]]:
    """Return some rows as arrays, those that are numbers."""
    few = cirs.iloc[_few(len(cirs))]
    each = [np.asarray(row) for row in few]
    return [row for row in each if row.ndim == 1 and row.size and row.dtype.kind in "fciu"]
