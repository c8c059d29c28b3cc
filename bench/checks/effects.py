"""What every effect must keep to: units, bounds, nothing at zero strength, a negative control."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pandas as pd

from bench.checks.expect import expect
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.effect import STAGES, Effect
from bench.physics.outcome import Outcome
from bench.physics.pipeline import Pipeline
from bench.physics.randomness import Draws
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

RANGE_M = 1e-6  # ranges closer than this are the same
OBSERVED = ("range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std")


def check_effect(effect: Effect, rows: pd.DataFrame | None = None) -> None:
    """Check an effect on rows, by default some with positions, devices, walls, heat and times.

    It says what it is in units and within bounds; does nothing at its parameters' null values;
    does nothing to the range on the rows it calls inert; gives numbers over all its bounds, with
    a waveform and without.
    """
    known = sample_rows() if rows is None else rows
    check_words(effect)
    check_bounds(effect)
    check_null(effect, known)
    check_control(effect, known)
    check_numbers(effect, known)


def sample_rows(count: int = 96) -> pd.DataFrame:
    """Return `count` rows of made-up geometry with all that built-in effects look at."""
    rng = np.random.default_rng(5)
    row = np.arange(count)
    places = {f"{e}_{a}_m": rng.uniform(0.3, 5, count) for e in ("tx", "rx") for a in "xy"}
    frame = pd.DataFrame({**places, "tx_z_m": 1.5, "rx_z_m": 1.0})
    frame["rx_x_m"] += 6.0
    ends = [frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy() for end in ("tx", "rx")]
    frame["true_range_m"] = np.linalg.norm(ends[0] - ends[1], axis=1)
    return frame.assign(
        **{f"room_{axis}_m": size for axis, size in zip("xyz", (12.0, 6.0, 2.8), strict=True)},
        link=[f"link-{one // 4}" for one in row],
        tx=[f"a{one % 3}" for one in row],
        rx="b",
        obstacles=pd.Series([["wall"] if one % 2 else [] for one in row]),
        los=row % 2 == 0,
        time_s=row * 0.1,
        temperature_c=np.where(row % 3 == 0, 25.0, 40.0),
        reply_time_s=np.where(row % 4 == 0, 0.0, 3e-4),
        azimuth_deg=row * 360.0 / count,
    )


def check_words(effect: Effect) -> None:
    """Check that an effect says its stage, source, signature, and a unit for every parameter."""
    kind = type(effect)
    expect(effect.stage in STAGES, f"stage {effect.stage!r}: expected one of {', '.join(STAGES)}")
    for what in ("source", "signature"):
        expect(len(getattr(effect, what)) > 10, f"{effect.name}: {what} says too little")
    expect(bool(kind.__doc__), f"{effect.name}: no docstring")
    for item in effect.parameters():
        where = f"{effect.name}: parameter {item.name}"
        expect(bool(item.unit and item.meaning), f"{where} has no unit or no meaning")
        expect(item.low <= item.default <= item.high, f"{where}: its default is out of its bounds")
        inside = item.null is None or item.low <= item.null <= item.high
        expect(inside, f"{where}: the value at which it does nothing is out of its bounds")


def check_bounds(effect: Effect) -> None:
    """Check that a value beyond the physical bounds is refused, naming the parameter."""
    for item in effect.parameters():
        beyond = type(item.default)(item.high + 1)
        try:
            replace(effect, **{item.name: beyond})
        except BenchError as problem:
            expect(item.name in str(problem), f"{effect.name}: refused without {item.name!r}")
        else:
            raise AssertionError(f"{effect.name}: {item.name} = {beyond} was not refused")


def check_null(effect: Effect, rows: pd.DataFrame) -> None:
    """Check that at its parameters' null values an effect changes nothing."""
    null = {item.name: item.null for item in effect.parameters() if item.null is not None}
    if not null:
        return
    made, base = _seen(rows, replace(effect, **null)), _seen(rows)
    for name in ("range_m", "rx_power_dbm", "noise_std"):
        same = np.allclose(getattr(made, name), getattr(base, name), rtol=1e-4, atol=RANGE_M)
        expect(same, f"{effect.name}: changes {name} with {_said(null)}, which should do nothing")
    assert made.cir is not None
    assert base.cir is not None
    close = np.allclose(made.cir, base.cir, rtol=1e-4, atol=1.0)
    expect(close, f"{effect.name}: changes the CIR with {_said(null)}, which should do nothing")


def check_control(effect: Effect, rows: pd.DataFrame) -> None:
    """Check the negative control: rows that an effect calls inert keep their range."""
    batch = _before(effect, rows)
    inert = effect.inert(batch)
    expect(inert.shape == (len(batch),), f"{effect.name}: inert gave {inert.shape}, one per row")
    if not inert.any():
        return
    expect(bool(effect.control), f"{effect.name}: has inert rows, but no words in `control`")
    moved = np.abs(_seen(rows, effect).range_m - _seen(rows).range_m)[inert]
    expect(moved.max() <= RANGE_M, f"{effect.name}: moves rows it calls inert by {moved.max():g} m")


def check_numbers(effect: Effect, rows: pd.DataFrame) -> None:
    """Check that it gives numbers at both bounds of every parameter, and changes no input."""
    kept = rows.copy(deep=True)
    for changed in _extremes(effect):
        made = _seen(rows, changed)
        for name in OBSERVED:
            finite = np.isfinite(getattr(made, name)).all()
            expect(bool(finite), f"{effect.name}: {name} is no number for {changed}")
        _seen(rows, changed, cir=False)
    pd.testing.assert_frame_equal(rows, kept)


def _extremes(effect: Effect) -> Iterator[Effect]:
    """Yield the effect as it is, and with each parameter at each bound."""
    yield effect
    for item in effect.parameters():
        for value in (item.low, item.high):
            yield replace(effect, **{item.name: int(value) if item.whole else value})


def _seen(rows: pd.DataFrame, *effects: Effect, cir: bool = True) -> Outcome:
    """Return what a simulator with these effects gives, on common random numbers."""
    return Simulator(Base(cir_samples=64), effects, seed=1).observe(scene(rows), cir=cir)


def _before(effect: Effect, rows: pd.DataFrame) -> Batch:
    """Return the rows as an effect's own stage gets them."""
    base, draws = Base(cir_samples=64), Draws(1, 0, "base", 0)
    start = base.paths(scene(rows))
    if effect.stage == "propagation":
        return start
    if effect.stage == "receiver":
        return base.received(start, draws)

    def receive(batch: Batch) -> Batch:
        return base.received(batch, draws)

    return Pipeline((), receive, base.detected).detected(lambda: start, draws)


def _said(values: dict[str, float]) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in values.items())
