"""Blind cases whose hidden effect is in the waveform: impulse responses, powers, noise, counts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from bench.challenge.cases import simulator_of
from bench.challenge.generator.conceal import Hidden
from bench.challenge.generator.geometry import geometry
from bench.challenge.generator.waveforms import (
    WIDE_LEAD,
    WIDE_SAMPLES,
    conceal_wave,
    draw_wave,
    recorded,
)
from bench.challenge.scoring import Outcome, outcome
from bench.discrepancy.data.observables import observe
from bench.discrepancy.method import Options, diagnose
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

ROWS = 4  # per link
DISCOVER_SHARE = 0.4  # of the links, those that are searched where waveforms are compared
MOST_Z = 999.0  # what does not scatter at all moves by any number of standard errors
FIRST = 1000  # numbers of waveform cases start here, apart from those on ranges


@dataclass(frozen=True)
class WaveCase:
    """One waveform case: what is hidden, the table before and after, the simulator."""

    hidden: Hidden
    clean: pd.DataFrame
    recorded: Recordings
    simulated: Simulator

    @property
    def strength_z(self) -> float:
        """How far the mean of the most changed observable moved, in standard errors over links.

        Known from the same rows without the effect; on as many links as the search sees.
        """
        if not self.hidden.names:
            return 0.0
        before, after = observe(self.clean), observe(self.recorded.frame)
        shared = tuple(name for name in before.names if name in after.names)
        values = before.keep(shared).values
        links = self.clean["link"].nunique() * DISCOVER_SHARE
        moved = np.nanmean(after.keep(shared).values - values, axis=0)
        error = np.maximum(np.nanstd(values, axis=0), 1e-12) / np.sqrt(links)
        return float(min(np.nanmax(np.abs(moved) / error), MOST_Z))


def make_wave(number: int, seed: int) -> WaveCase:
    """Return waveform case `number`; deterministic from both."""
    drawn = draw_wave(number, seed)
    names, sizes = ((drawn.name,), (drawn.strength,)) if drawn.name else ((), ())
    wide, simulated = wide_table(number, seed)
    shown = recorded(conceal_wave(wide, drawn, seed * 10_000 + number))
    table = Recordings(shown, f"waveform case {number}")
    return WaveCase(Hidden(names, sizes, "waveform"), recorded(wide), table, simulated)


def wide_table(number: int, seed: int) -> tuple[pd.DataFrame, Simulator]:
    """Return a case's rows with complex impulse responses, wider than shown; and the simulator."""
    frame = geometry(seed * 10_000 + number).drop(columns="_rare")
    frame = frame[frame.groupby("link").cumcount() < ROWS].reset_index(drop=True)
    simulated = _uncounted(simulator_of(Hidden((), (), "plain"), 7))
    crop = {"cir_lead": WIDE_LEAD, "cir_samples": WIDE_SAMPLES}
    wide = replace(simulated, base=replace(simulated.base, **crop))
    made = wide.observe(scene(frame), 1000 + number, complex_cir=True).table(frame)
    return made.drop(columns="clock_offset_ppm", errors="ignore"), simulated


def _uncounted(simulator: Simulator) -> Simulator:
    """Return the simulator that does not read from the rows how many symbols were accumulated.

    The count is something to be explained here, not a setting.
    """
    return replace(simulator, base=replace(simulator.base, keep_count=0))


def run_wave(number: int, seed: int) -> Outcome:
    """Diagnose one waveform case and score it; `removed` is the held-out gain in nats."""
    case = make_wave(number, seed)
    options = Options(seed)
    found = diagnose(case.recorded, case.simulated, options)
    made = outcome(case.hidden, found, FIRST + number, "resimulated", case.strength_z)
    return replace(made, removed=found.confirmed.gain.value)
