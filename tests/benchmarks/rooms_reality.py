"""How unlike recordings `rooms` and `rooms-ideal` are, by the scores of the diagnosis.

    BENCH_DATA=FOLDER python tests/benchmarks/rooms_reality.py apartment miluv

Every recorded row is simulated again at its own geometry by both, as `bench diagnose` does before
it adds anything, with the radio settings of the recordings: the apartment's preamble has 1024
symbols, of which strong signals need few. docs/rooms.md quotes the output. About a minute of
processor time each.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.calibration import rank_distance, separability
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.radio import base_of
from bench.discrepancy.compare.skill import gain_interval, gains, tally
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.columns import with_motion
from bench.discrepancy.data.observables import RANGE, window_of
from bench.discrepancy.data.split import link_codes, thinned
from bench.discrepancy.prepared import compared_with
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.simulator import Simulator
from bench.physics.simulators import read_simulator
from bench.recordings.open import read

ROWS, MEMBERS = 400, 16
BEFORE, AFTER = "rooms-ideal", "rooms"
LONG_PREAMBLE = {"apartment": 1024}


def set_up(recorded: str, simulator: Simulator) -> Simulator:
    """Return the simulator with the preamble of a data set, where it is known."""
    if recorded not in LONG_PREAMBLE:
        return simulator
    base = replace(simulator.base, preamble_symbols=LONG_PREAMBLE[recorded])
    return replace(simulator, base=base).with_effect(LevelControl())


def ensemble(recorded: str, simulator: str) -> Ensemble:
    """Return recorded rows beside MEMBERS simulated versions of each."""
    frame, made = with_motion(read(recorded).frame), set_up(recorded, read_simulator(simulator))
    window, codes = window_of(frame), link_codes(frame)
    kept = thinned(np.arange(len(frame)), codes, ROWS)
    rows = view(frame, codes, kept, window, None, True)
    return compared_with(made, window, 0, base_of(frame, made)).ensemble(rows, (), MEMBERS)


def main(names: list[str]) -> None:
    """Print the figures of each recorded data set."""
    for name in names:
        before, after = (ensemble(name, simulator) for simulator in (BEFORE, AFTER))
        gained = gains(tally(before), tally(after))
        print(f"{name}: {len(before.links)} rows on {len(np.unique(before.links))} links")
        for label, one in ((BEFORE, before), (AFTER, after)):
            miss = np.abs(one.residual_of(RANGE)).mean()
            print(
                f"  {label}: mean |recorded - simulated| range error {miss:.3f} m, "
                f"AUC {separability(one, 0):.3f}, ranks {rank_distance(one):.3f}"
            )
        print(f"  gain {gain_interval(tally(before), tally(after), 0)} nats")
        print("  by observable:", {key: round(value, 2) for key, value in gained.items()})


if __name__ == "__main__":
    main(sys.argv[1:])
