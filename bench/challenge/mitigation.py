"""What a diagnosis is for: REMnet trained on the simulator before and after, tested on recordings.

Both networks see the same number of SIMULATED CIRs at the same geometry with the same seeds and
the same preparation; neither sees a recording. They are tested on links the diagnosis never saw.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.data.split import Rows, link_codes
from bench.parallel import obey
from bench.physics.simulator import Simulator
from bench.plugins import load
from bench.recordings.table import Recordings
from bench.recordings.window import cir_window

Floats = NDArray[np.float64]
Progress = Callable[[str], None]
ROWS = 12  # simulated rows of each simulated link
STRETCH = 0.2  # simulated ranges are the known links' times 1 +- this


@dataclass(frozen=True)
class Effort:
    """How much is trained: seeds, simulated links, epochs (None: the model's own).

    A simulated link is a known link's geometry with a fresh draw of what geometry does not tell.
    """

    seeds: tuple[int, ...] = (0, 1, 2)
    links: int = 600
    epochs: int | None = None


@dataclass(frozen=True)
class Mitigated:
    """Mean abs. range errors on held-out recorded links in metres, with intervals over links.

    `raw` without mitigation; `before`, `after` with REMnet trained on the original and on the
    diagnosed simulator (mean over seeds). `over_before` and `over_raw` are paired differences,
    positive where the diagnosed simulator is better. `links` has one row per held-out link.
    """

    raw: Estimate
    before: Estimate
    after: Estimate
    over_before: Estimate
    over_raw: Estimate
    links: pd.DataFrame
    simulated_rows: int


def mitigated(
    recorded: Recordings,
    training: Rows,
    held: Rows,
    simulators: tuple[Simulator, Simulator],
    seed: int,
    effort: Effort,
    progress: Progress = lambda _: None,
) -> Mitigated:
    """Train on each simulator (before, after) and test on the `held` rows of `recorded`.

    `training` are the rows whose geometry, and nothing else, the simulated CIRs take.
    """
    obey()
    geometry = training_geometry(recorded.frame.iloc[training], seed, effort.links)
    test = recorded.select(held)
    window = cir_window(test)
    frame = test.frame.iloc[window.rows]
    error = (frame["range_m"] - frame["true_range_m"]).to_numpy(np.float64)
    left = []
    for simulator, word in zip(simulators, ("before", "after"), strict=True):
        progress(f"training REMnet on the simulator {word} the diagnosis")
        guesses = [_predicted(simulator, geometry, window.cirs, s, effort) for s in effort.seeds]
        left.append(np.mean([np.abs(error - guess) for guess in guesses], axis=0))
    return _compared(np.abs(error), left[0], left[1], frame, seed, len(geometry))


def training_geometry(frame: pd.DataFrame, seed: int, copies: int) -> pd.DataFrame:
    """Return `copies` x ROWS rows to simulate: known links' ranges, each a new link of its own.

    Nothing measured is taken over, so both simulators start from geometry alone.
    """
    rng = np.random.default_rng(seed)
    known = frame.groupby("link", sort=True)["true_range_m"].median().to_numpy(np.float64)
    ranges = rng.choice(known, copies) * rng.uniform(1 - STRETCH, 1 + STRETCH, copies)
    link = np.repeat(np.arange(copies), ROWS)
    ends = {end: str(frame[end].iloc[0]) for end in ("tx", "rx") if end in frame}
    names = [f"simulated {number}" for number in link]
    return pd.DataFrame({"link": names, "true_range_m": ranges[link], **ends})


def _predicted(
    simulator: Simulator,
    geometry: pd.DataFrame,
    cirs: NDArray[np.float32],
    seed: int,
    effort: Effort,
) -> Floats:
    """Return REMnet's errors [n] in metres for recorded CIRs, trained on simulated rows alone."""
    made = simulator.simulate(geometry, seed)
    window = cir_window(made)
    target = made.frame["error_m"].to_numpy(np.float32)[window.rows]
    known = {} if effort.epochs is None else {"epochs": effort.epochs}
    model = load("models", "remnet")(random_state=seed, **known)
    return np.asarray(model.fit(window.cirs, target).predict(cirs), np.float64)


def _compared(
    raw: Floats,
    before: Floats,
    after: Floats,
    frame: pd.DataFrame,
    seed: int,
    simulated_rows: int,
) -> Mitigated:
    """Return the figures with intervals from resampling whole links."""
    codes = link_codes(frame)

    def mean(values: Floats) -> Estimate:
        return cluster_bootstrap(values, codes, seed, "m")

    columns = {"raw_mae_m": raw, "before_mae_m": before, "after_mae_m": after}
    table = pd.DataFrame({"link": frame["link"].to_numpy(), **columns})
    links = table.groupby("link", as_index=False).mean()
    differences = mean(before - after), mean(raw - after)
    return Mitigated(mean(raw), mean(before), mean(after), *differences, links, simulated_rows)
