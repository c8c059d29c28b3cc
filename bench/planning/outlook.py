"""What each explanation predicts for each measurement, and how far the predictions are apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.special import logsumexp

from bench.physics.scene import Scene, scene
from bench.planning.alternatives import Alternative
from bench.planning.measurements import Measurement
from bench.planning.scatter import Floats, Scatter
from bench.planning.settings import FIT_MEMBERS, SCATTER_MEMBERS
from bench.planning.world import Added, World

Counts = np.ndarray


@dataclass(frozen=True)
class Prediction:
    """What one explanation predicts for c measurements.

    `means` [s, c, p] under each of s parameter draws; `scatter` [c, p, p] is the covariance of a
    link's mean around it.
    """

    means: Floats
    scatter: Floats

    def misfit(self, values: Floats) -> Floats:
        """Return the nats [c, v, s] by which one link's means [v, c, p] miss those of each draw."""
        gap = values[:, None] - self.means[None]
        inverse = np.linalg.inv(self.scatter)
        return np.asarray(np.einsum("vscp,cpq,vscq->cvs", gap, inverse, gap) / 2)


@dataclass(frozen=True)
class Outlook:
    """The predictions of all explanations, `names` [k], for the same measurements [c].

    `bare` [c, p] is what is simulated without any of them.
    """

    names: tuple[str, ...]
    predictions: tuple[Prediction, ...]
    bare: Floats = field(default_factory=lambda: np.zeros((0, 0)))

    @cached_property
    def apart(self) -> list[list[Floats]]:
        """The misfit [c, s, t] of the draws of one explanation to those of another, [k][k]."""
        return [[other.misfit(one.means) for other in self.predictions] for one in self.predictions]

    def nats(self, links: Counts) -> Floats:
        """Return expected nats [k, k] for row over column if row is true, with so many links [c].

        Each explanation's density is the mean over its draws, so it may choose, among the
        parameters left open, those that suit what will be measured.
        """
        likely = [[_density(links, misfit) for misfit in row] for row in self.apart]
        return np.array([[np.mean(row[at] - other) for other in row]
                         for at, row in enumerate(likely)])  # fmt: skip

    def reached(self, links: Counts, values: Floats, right: int, wrong: int) -> float:
        """Return the nats for one explanation over another that were measured.

        `values` [c, p] are the means over the links of each measurement; where there are no
        links, anything finite.
        """
        one, other = (
            _density(links, self.predictions[i].misfit(values[None]))[0] for i in (right, wrong)
        )
        return float(one - other)


def _density(links: Counts, misfit: Floats) -> Floats:
    """Return the log density [v] of values under draws that miss them by `misfit` [c, v, s]."""
    used = np.flatnonzero(links)
    total = -np.tensordot(np.asarray(links[used], np.float64), misfit[used], 1)
    return np.asarray(logsumexp(total, axis=1) - np.log(total.shape[1]))


def outlook(
    world: World,
    alternatives: Sequence[Alternative],
    offered: Sequence[Measurement],
    reference: pd.Series,
    rows: int,
    noise: Scatter,
    rest: Added = (),
) -> Outlook:
    """Return what explanations predict for measurements of `rows` rows a link, beside `rest`."""
    frames = [one.rows(reference, rows, f"plan {i}") for i, one in enumerate(offered)]
    frame = pd.concat(frames, ignore_index=True)
    planned = scene(frame, "plan")
    made = [_prediction(world, one, planned, rows, noise.of_means(rows)) for one in alternatives]
    bare = world.values(planned, rest, FIT_MEMBERS).mean(axis=0)
    means = bare.reshape(-1, rows, bare.shape[-1]).mean(axis=1)
    return Outlook(tuple(one.name for one in alternatives), tuple(made), means)


def _prediction(
    world: World, one: Alternative, planned: Scene, rows: int, noise: Floats
) -> Prediction:
    """Return what one explanation predicts."""
    rows_two = world.values(planned, one.draws[0], 2)
    members = SCATTER_MEMBERS if len(one.draws) == 1 else FIT_MEMBERS
    members = members if np.ptp(rows_two, axis=0).any() else 2
    means, scatters = [], []
    for added in one.draws:
        made = world.values(planned, added, members)
        links = made.reshape(members, -1, rows, made.shape[-1]).mean(axis=2)
        apart = links - links.mean(axis=0)
        means.append(links.mean(axis=0))
        scatters.append(np.einsum("mcp,mcq->cpq", apart, apart) / (members - 1))
    return Prediction(np.stack(means), np.mean(scatters, axis=0) + noise)
