"""What a simulated table's observables do over headings: a matched row rarely heads as ours does.

A table whose simulator has an antenna pattern, or a body that wears the tag, is off by it wherever
the matched row heads elsewhere. What headings plainly do there is taken off, as what a distance
does is (see `over_distance`): on the simulated side, so that what only recordings have stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import f as variance_ratio

from bench.discrepancy.compare.over_distance import of_links
from bench.discrepancy.compare.settings import (
    HEADING_LINKS,
    HEADING_P,
    HEADING_SECTORS,
    HEADING_WAVES,
    LEAST_VARIANCE,
    WALK_CLIP,
)
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.split import Rows
from bench.physics.effects.propagation.antenna_pattern import heading_rad
from bench.physics.scene import scene
from bench.physics.units import Floats

AZIMUTH = "azimuth_deg"
PLACES = tuple(f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz")


@dataclass(frozen=True)
class OverHeading:
    """Waves of the headings of recorded rows `ours` [n, w] and simulated ones `theirs` [k, w].

    `size` [w] of each by observable, none where headings do nothing plain. `told`: the part of
    them that is not taken for chance.
    """

    ours: Floats
    theirs: Floats
    size: Mapping[str, Floats]
    told: Mapping[str, float]

    def change(self, names: tuple[str, ...], pick: Rows) -> Floats:
        """Return by how much observables [n, p] change from simulated rows `pick` [n] to ours."""
        made = np.zeros((len(pick), len(names)))
        for at, name in enumerate(names):
            if name in self.size:
                made[:, at] = (self.ours - self.theirs[pick]) @ self.size[name]
        return made


def no_headings(recorded: int, simulated: int) -> OverHeading:
    """Return that headings of so many rows do nothing."""
    return OverHeading(np.zeros((recorded, 0)), np.zeros((simulated, 0)), {}, {})


def over_heading(
    recorded: pd.DataFrame, simulated: pd.DataFrame, left: Mapping[str, Floats], links: Rows
) -> OverHeading:
    """Return what headings do to what is `left` [k] of every simulated observable; `links` [k].

    Nothing where headings are not known of all rows of both tables, in the same way.
    """
    headings = [_headings(frame) for frame in (recorded, simulated)]
    alike = (AZIMUTH in recorded) == (AZIMUTH in simulated)
    if not alike or not all(np.isfinite(one).all() for one in headings):
        return no_headings(len(recorded), len(simulated))
    ours, theirs = map(waves, headings)
    sector = np.floor(np.degrees(headings[1]) % 360 / (360 / HEADING_SECTORS)).astype(np.intp)
    found = {name: _waved(one, theirs, links, sector) for name, one in left.items()}
    plain = {name: one for name, one in found.items() if one is not None}
    size, told = ({name: one[at] for name, one in plain.items()} for at in (0, 1))
    return OverHeading(ours, theirs, size, told)  # type: ignore[arg-type]


def waves(heading: Floats) -> Floats:
    """Return cosines and sines [n, w] of headings [n] in radians and of their multiples."""
    turns = [k * heading for k in range(1, HEADING_WAVES + 1)]
    return np.stack([wave(turn) for turn in turns for wave in (np.cos, np.sin)], axis=1)


def _headings(frame: pd.DataFrame) -> Floats:
    """Return the headings of a table's rows, or bearings where it has none, NaN where unknown."""
    known = frame[[name for name in (AZIMUTH, *PLACES) if name in frame]]
    if AZIMUTH in known and not np.isfinite(numeric(known, AZIMUTH)).all():
        return np.full(len(frame), np.nan)  # a heading is no bearing
    return heading_rad(scene(known.assign(true_range_m=1.0), "table"))


def _waved(values: Floats, basis: Floats, links: Rows, sector: Rows) -> tuple[Floats, float] | None:
    """Return the sizes of waves [w] in values [k], and which part is told; None for nothing plain.

    Over means of the rows of a link that head one way. Those far off count as far as is usual.
    """
    known = np.isfinite(values)
    code = of_links(links[known] * HEADING_SECTORS + sector[known], links[known])[0]
    many, several = len(np.unique(links[known])), basis.shape[1]
    if many < HEADING_LINKS:
        return None
    count = np.bincount(code)
    means = [np.bincount(code, one) / count for one in (values[known], *basis[known].T)]
    high, plain = means[0], np.stack([np.ones(len(count)), *means[1:]], axis=1)
    fit = plain @ np.linalg.lstsq(plain, high)[0]
    usual = WALK_CLIP * float(np.median(np.abs(high - fit)))
    high = fit + np.clip(high - fit, -usual, usual)
    size = np.linalg.lstsq(plain, high)[0]
    noise = float(((high - plain @ size) ** 2).sum()) / (len(high) - several - 1)
    swing = plain[:, 1:] @ size[1:]
    ratio = float(((swing - swing.mean()) ** 2).sum()) / several / max(noise, LEAST_VARIANCE)
    if variance_ratio.sf(ratio, several, many - several - 1) > HEADING_P:
        return None
    told = 1 - 1 / ratio
    return np.asarray(told * size[1:]), told
