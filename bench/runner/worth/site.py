"""The rows of one split: sealed links to test on, others to survey, and simulated ones."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.data.split import link_codes, split_links, thinned
from bench.discrepancy.report.folder import REPORT, read_part
from bench.errors import BenchError
from bench.physics.simulator import Simulator
from bench.physics.toml_file import read_toml
from bench.recordings.open import Table
from bench.recordings.splits import Split
from bench.recordings.table import Recordings
from bench.recordings.window import CirWindow, cir_window
from bench.runner.diagnosis_inputs import read_inputs
from bench.runner.inputs import rows_for
from bench.runner.material import Material
from bench.runner.worth.settings import (
    FEWEST_LINKS,
    ROWS_PER_LINK,
    SIMULATED_LINKS,
    SIMULATED_ROWS,
    STRETCH,
)
from zoo.inputs import layout
from zoo.modules.blocks import Columns
from zoo.modules.preparation import apply_in_blocks

Floats = NDArray[np.float32]
READS = ("cir", "levels", "features", "range")
REGISTERS = 10  # columns of figures in front that need no CIR


@dataclass(frozen=True)
class Examples:
    """Figures of rows float32 [n, columns], errors [n] in metres, links [n].

    Figures: nine of the levels and the range (`REGISTERS`), then the six of the CIR where there
    is one; NaN where not known.
    """

    rows: Floats
    errors_m: Floats
    links: NDArray[np.str_]

    def of(self, links: NDArray[np.str_]) -> Examples:
        """Return the rows of some links."""
        keep = np.isin(self.links, links)
        return Examples(self.rows[keep], self.errors_m[keep], self.links[keep])

    @property
    def names(self) -> NDArray[np.str_]:
        """Every link once, in order."""
        return np.unique(self.links)


@dataclass(frozen=True)
class Site:
    """One split: `survey` and `sealed` RECORDED rows, `before` and `after` SIMULATED ones.

    `seed` is the diagnosis's.
    """

    survey: Examples
    sealed: Examples
    before: Examples
    after: Examples
    seed: int
    fingerprint: str


def site(folder: Path, recorded: Table | None = None) -> Site:
    """Return the split of a diagnosis. Raises BenchError where it cannot serve here."""
    inputs, path = read_inputs(folder, recorded), folder / "simulator.toml"
    if inputs.table is not None or not path.is_file():
        raise BenchError(f"{folder}: a table was compared; expected a simulator to train on")
    seed = seed_of(folder)
    table = inputs.recorded
    sealed = split_links(table.frame, seed).confirm.open()
    survey = np.setdiff1d(np.arange(len(table)), sealed)
    if len(table.frame["link"].iloc[survey].unique()) < FEWEST_LINKS:
        raise BenchError(f"{folder}: fewer than {FEWEST_LINKS} links beside the sealed ones")
    made = geometry(table.frame.iloc[survey], seed)
    mark = json.dumps([table.fingerprint, path.read_text()])
    return Site(
        _examples(table.select(_fewer(table.frame, survey))),
        _examples(table.select(_fewer(table.frame, sealed))),
        _simulated(inputs.simulator, made, table, seed),
        _simulated(read_toml(path), made, table, seed),
        seed,
        mark,
    )


def seed_of(folder: Path) -> int:
    """Return the seed of a diagnosis. Raises BenchError where there is none."""
    seed = read_part(folder, REPORT).get("seed")
    if not isinstance(seed, int) or seed < 0:
        raise BenchError(f"{folder / REPORT}: no seed; not what `bench diagnose` writes")
    return seed


def _fewer(frame: pd.DataFrame, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return rows, evenly at most so many of each link."""
    codes = link_codes(frame)
    return thinned(rows, codes, ROWS_PER_LINK * len(np.unique(codes[rows])))


def geometry(known: pd.DataFrame, seed: int) -> pd.DataFrame:
    """Return rows to simulate at the places of known ones, each a new link.

    Distances are stretched; nothing measured is taken over.
    """
    rng = np.random.default_rng(seed)
    first = known.groupby("link", sort=True).head(1)
    columns = [c for c in first if c in PLACE]
    picked = first.iloc[rng.integers(0, len(first), SIMULATED_LINKS)][columns]
    stretch = rng.uniform(1 - STRETCH, 1 + STRETCH, SIMULATED_LINKS)
    picked = picked.assign(true_range_m=picked["true_range_m"].to_numpy() * stretch)
    picked["link"] = [f"simulated {number}" for number in range(SIMULATED_LINKS)]
    return picked.iloc[np.repeat(np.arange(SIMULATED_LINKS), SIMULATED_ROWS)].reset_index(drop=True)


PLACE = ("true_range_m", "tx", "rx", "environment", "reply_time_s", "temperature_c", "azimuth_deg",
         "obstacles", "obstacle_thickness_m", "obstacle_at", "room_x_m", "room_y_m", "room_z_m",
         "tx_z_m", "rx_z_m", "channel", "prf_mhz", "tx_power_dbm", "los")  # fmt: skip
"""What is known before measuring and is kept; positions go, as ranges are stretched."""


def _simulated(simulator: Simulator, made: pd.DataFrame, like: Recordings, seed: int) -> Examples:
    """Return simulated rows with those columns only that the recordings have."""
    table = simulator.simulate(made, seed)
    unknown = [c for c in LEVELS if c not in like.frame]
    frame = table.frame.drop(columns=[c for c in unknown if c in table.frame])
    return _examples(Recordings(frame, "simulated", simulator=table.simulator))


LEVELS = ("rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count", "cir")


def _examples(table: Recordings) -> Examples:
    """Return rows as models read them."""
    window = cir_window(table) if "cir" in table.frame else _whole(table)
    kept = table.select(window.rows)
    errors = kept.errors_m().astype(np.float32)
    links = kept.frame["link"].astype(str).to_numpy(np.str_)
    material = Material(table.source, kept, "", window.cirs, errors, links, Split("", ()), {})
    rows = rows_for(material, READS)
    figures = apply_in_blocks(Columns(layout(READS, rows.shape[1])), rows).numpy()
    return Examples(figures, errors, links)


def _whole(table: Recordings) -> CirWindow:
    return CirWindow(np.empty((len(table), 0), np.float32), np.arange(len(table)), {})
