"""Blind cases: what a family made, as tables and a simulator that `bench.diagnose` takes."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import (
    CONCEALS,
    Draw,
    Law,
    Tables,
    Turn,
    decoyed,
    draw,
    mapped,
    turn_of,
    world_of,
)
from bench.discrepancy.compare.radio import base_of
from bench.discrepancy.data.columns import known_columns, with_motion
from bench.discrepancy.data.observables import COUNT, observe
from bench.physics.base import LEAD_SAMPLES, Base
from bench.physics.batch import Batch
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.plugins import load
from bench.recordings.table import Recordings

Floats = NDArray[np.float64]
PLAIN = Simulator(Base(), name="plain")  # the settings of radios that the rows do not state
REPLICAS = 8  # of the true table where the simulator is run again
SEARCHED_SHARE = {True: 0.4, False: 0.75}  # of the links, with and without waveforms
MOST_Z = 999.0  # what does not scatter at all moves by any number of standard errors
# A test that knows the shape of the effect but pays for a search needs about 4 + 1.3 standard
# deviations for 90 % power; the search's cells are not the shape, which costs about a third.
LIMIT_Z = 8.0
SCATTERING = ("timestamp-jitter",)  # adds a draw of its own to every row
UNKNOWABLE = (*SCATTERING, "range-rounding")  # noise to a test for anything else
ALONE_GIVEN_AWAY = ("clock_offset_ppm",)  # columns that would tell the answer


@dataclass(frozen=True)
class Case:
    """One case: which, what is drawn, both sides of the comparison, and the truth.

    `truth` is the simulated side as a table with the hidden physics in it; `clean` the recorded
    rows without. `outside` are hidden names that no library effect can be given for: not in the
    library, or these tables lack the columns that it needs. `seed`: of the family's own draws.
    """

    turn: Turn
    drawn: Draw
    recorded: Recordings
    simulated: Simulator | Recordings
    truth: Recordings
    clean: pd.DataFrame
    shifts_m: Floats | None
    outside: tuple[str, ...]
    law: Law
    seed: int

    @property
    def strength_z(self) -> float:
        """How loud what is hidden is, in standard deviations; 0 where nothing is.

        Ranges: the matched-filter signal-to-noise ratio of the weakest hidden effect on the
        searched links, of a test that knows the exact shape of each, the others projected out. Of
        scatter no test knows the draws: there it is the deflection of the variance (Kay 1998,
        section 5.3, a signal of known variance in white noise). To a test for anything else scatter
        is noise, and so is what rounding cuts off.
        Waveforms, and effects on levels alone: how far the mean of the most changed observable
        moved, in standard errors over the links that the search sees; of several, of the one that
        moves least beside the others.
        """
        if not self.drawn.hidden:
            return 0.0
        shifts = _on_ranges_alone(self) if self.shifts_m is None else self.shifts_m
        if shifts is not None and np.abs(shifts).max(axis=1).min() > 0:
            return _matched(self.recorded.frame, shifts, self.drawn.hidden)
        return min([_moved(self.clean, self.recorded.frame), *_beside_others(self)])

    @property
    def above_limit(self) -> bool:
        """True where the weakest hidden effect is above the detection limit."""
        return self.strength_z >= LIMIT_Z


def drawn_of(number: int, seed: int, families: tuple[str, ...] = ()) -> tuple[Turn, Draw]:
    """Return what case `number` of a challenge is to be; deterministic from all three."""
    turn = turn_of(number, families)
    world: Any = world_of(turn.family, turn.mode)
    return turn, draw(turn, seed, world.KNOWN, tuple(world.LAWS), world.RARELY)


def make_case(number: int, seed: int, families: tuple[str, ...] = ()) -> Case:
    """Return case `number` of a challenge; deterministic from all three."""
    turn, drawn = drawn_of(number, seed, families)
    own = int(np.random.default_rng([seed, number, 13]).integers(2**31))
    world: Any = world_of(turn.family, turn.mode)
    made, simulated = _made(world, turn.mode, drawn, own)
    assert drawn.concealed in CONCEALS
    if drawn.concealed == "aggregate":
        made = mapped(made)
    if drawn.concealed == "decoy":
        made = decoyed(made, drawn.hidden, world.CAUSES, own)
    away = ALONE_GIVEN_AWAY if drawn.counted else (*ALONE_GIVEN_AWAY, COUNT)
    recorded, truth, clean = (
        frame.drop(columns=[c for c in away if c in frame]).reset_index(drop=True)
        for frame in (made.recorded, made.truth, made.clean)
    )
    if isinstance(simulated, Recordings) and COUNT in away:
        simulated = replace(simulated, frame=simulated.frame.drop(columns=[COUNT], errors="ignore"))
    outside = tuple(n for n in drawn.hidden if _unnamable(n, world.LAWS, recorded, turn.mode))
    law = world.LAWS.get(drawn.hidden[0], Law()) if drawn.hidden else Law()
    table = Recordings(recorded, f"case {number}")
    true = Recordings(truth, "truth", simulator=turn.family)
    return Case(turn, drawn, table, simulated, true, clean, made.shifts_m, outside, law, own)


def recorded_with(case: Case, hidden: tuple[str, ...]) -> pd.DataFrame:
    """Return what would be recorded were these effects hidden, of the same draws and scatter."""
    world: Any = world_of(case.turn.family, case.turn.mode)
    made, _ = _made(world, case.turn.mode, replace(case.drawn, hidden=hidden), case.seed)
    return made.recorded.reset_index(drop=True)


def _unnamable(name: str, laws: dict[str, Law], recorded: pd.DataFrame, mode: str) -> bool:
    """Return whether no library effect can be given for something hidden."""
    if name in laws:
        return True
    kind = load("effects", name)
    torn = not mode.endswith("again") and not kind.on_tables
    return bool(torn or kind.lacking(known_columns(with_motion(recorded))))


def _made(world: Any, mode: str, drawn: Draw, own: int) -> tuple[Tables, Simulator | Recordings]:
    """Return a case's tables and the simulated side."""
    if not mode.endswith("again"):
        made = world.tables(drawn, own)
        assert made.simulated is not None
        other = made.simulated.reset_index(drop=True)
        return made, Recordings(other, "simulated", simulator=world.__name__.split(".")[-1])
    return _again(world, drawn, own) if mode == "ranges again" else _waves(world, drawn, own)


def _again(world: Any, drawn: Draw, own: int) -> tuple[Tables, Simulator]:
    """Return ranges of the library's simulator with something hidden in them, and the simulator."""
    jitter = TimestampJitter(jitter_samples=0.08 * drawn.scatter)
    frame = world.known(drawn, own)
    simulator = Simulator(base_of(frame, PLAIN), (jitter,), own, "challenge")
    rows = scene(frame)
    clean, *more = (
        simulator.observe(rows, own, number, cir=False).table(frame)
        for number in range(1000, 1001 + REPLICAS)
    )
    made = world.hidden_in(drawn, own, clean, pd.concat(more, ignore_index=True))
    return replace(made, simulated=None), simulator


def _waves(world: Any, drawn: Draw, own: int) -> tuple[Tables, Simulator]:
    """Return waveforms of the library's simulator with something hidden, and the simulator.

    It does not read from the rows how many symbols were accumulated: the count is something to
    be explained here, not a setting.
    """
    frame = world.known(drawn, own)
    base = replace(base_of(frame, PLAIN), keep_count=0)
    simulator = Simulator(base, (TimestampJitter(),), own, "challenge")
    wide = replace(simulator, base=_longer(base, world.WIDE_LEAD, world.WIDE_SAMPLES))
    rows = scene(frame)
    clean, *more = (
        wide.observe(rows, own, number, complex_cir=True).table(frame)
        for number in range(1000, 1001 + REPLICAS // 2)
    )
    whole = pd.concat(more, ignore_index=True)
    three = (world.conceal(clean, drawn, own), clean, world.conceal(whole, drawn, own))
    recorded, plain, truth = map(world.recorded, three)
    return Tables(recorded, plain, None, truth), simulator


class _Longer(Base):
    """A base with longer records, whose noise is measured as far as ordinary ones reach.

    What a chip reports of noise scatters the less the more samples it is of: a longer window alone
    would be a difference between both sides of a case that hides nothing.
    """

    def detected(self, batch: Batch) -> Batch:
        """Return the batch with first path, range and what the chip reports."""
        found = super().detected(batch)
        if batch.noise is None:
            return found
        begin = max(LEAD_SAMPLES, self.cir_lead + 8) - LEAD_SAMPLES
        near = np.abs(batch.noise[:, begin : begin + Base().samples])
        return replace(found, noise_std=near.std(axis=1, dtype=np.float64))


def _longer(base: Base, lead: int, samples: int) -> Base:
    """Return the base with records of `samples`, `lead` of them before the first path."""
    known = {one.name: getattr(base, one.name) for one in fields(base)}
    return _Longer(**{**known, "cir_lead": lead, "cir_samples": samples})


def _beside_others(case: Case) -> list[float]:
    """Return how loud each of several hidden effects is beside the others (see `strength_z`).

    One that leaves waveforms as they are is as loud as its own shape in the ranges.
    """
    hidden = case.drawn.hidden
    if len(hidden) < 2:
        return []
    whole, out = recorded_with(case, hidden), []
    for name in hidden:
        rest = recorded_with(case, tuple(one for one in hidden if one != name))
        shift_m = _shift_alone(rest, whole)
        out.append(
            _moved(rest, whole) if shift_m is None else _matched(whole, shift_m[None], (name,))
        )
    return out


def _shift_alone(rest: pd.DataFrame, whole: pd.DataFrame) -> Floats | None:
    """Return what the ranges [n] change by where nothing else does, else None."""
    kept = [name for name in ("rx_power_dbm", "noise_std", "cir") if name in rest and name in whole]
    shift_m = (whole["error_m"] - rest["error_m"]).to_numpy(np.float64)
    same = all(all(map(np.array_equal, whole[name], rest[name])) for name in kept)
    return shift_m if same and np.abs(shift_m).max() > 0 else None


def _on_ranges_alone(case: Case) -> Floats | None:
    """Return what one hidden effect adds to ranges [1, n] of rows with waveforms.

    None where it changes waveforms, and is not a fault of the set-up.
    """
    recorded, plain = case.recorded.frame, case.clean
    if len(case.drawn.hidden) != 1 or not {"cir"} <= {*recorded} & {*plain}:
        return None
    if not (case.law.devices or all(map(np.array_equal, recorded["cir"], plain["cir"]))):
        return None
    return (recorded["error_m"] - plain["error_m"]).to_numpy(np.float64)[None]


def _matched(recorded: pd.DataFrame, shifts_m: Floats, names: tuple[str, ...]) -> float:
    """Return the signal-to-noise ratio of the weakest of some shapes [effects, n]."""
    error = recorded["error_m"].to_numpy(np.float64)
    every = [_loudness(error, shifts_m, names, i) for i in range(len(shifts_m))]
    return float(min(min(every) * np.sqrt(SEARCHED_SHARE["cir" in recorded]), MOST_Z))


def _loudness(error: Floats, shifts_m: Floats, names: tuple[str, ...], which: int) -> float:
    """Return the signal-to-noise ratio of one shape in errors [n], beside the others."""
    beside = [
        shift_m
        for number, (name, shift_m) in enumerate(zip(names, shifts_m, strict=True))
        if number != which and name not in UNKNOWABLE
    ]
    design = np.stack([shifts_m[which], *beside, np.ones(len(error))], axis=1)
    found = np.linalg.lstsq(design, error, rcond=None)[0]
    noise = max(float(np.std(error - design @ found)), 1e-12)
    if names[which] in SCATTERING:
        share = np.var(found[0] * shifts_m[which]) / noise**2
        return float(share * np.sqrt(len(error) / 2))
    alone = np.linalg.pinv(design.T @ design + 1e-12 * np.eye(design.shape[1]))
    return float(abs(found[0]) / (noise * np.sqrt(max(alone[0, 0], 1e-18))))


def _moved(clean: pd.DataFrame, recorded: pd.DataFrame) -> float:
    """Return how far the most moved observable moved, in standard errors over links."""
    before, after = observe(clean), observe(recorded)
    shared = tuple(name for name in before.names if name in after.names)
    values = before.keep(shared).values
    links = clean["link"].nunique() * SEARCHED_SHARE["cir" in clean]
    with catch_warnings():  # of observables that no row has
        simplefilter("ignore", RuntimeWarning)
        moved = np.nanmean(after.keep(shared).values - values, axis=0)
        error = np.maximum(np.nanstd(values, axis=0), 1e-12) / np.sqrt(links)
        return float(min(np.nanmax(np.abs(moved) / error), MOST_Z))
