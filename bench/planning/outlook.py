"""What each explanation predicts for each measurement, and how far the predictions are apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bench.physics.scene import scene
from bench.planning.alternatives import Alternative
from bench.planning.measurements import Measurement
from bench.planning.scatter import Floats, Scatter, divergence, log_density
from bench.planning.settings import FIT_MEMBERS, SCATTER_MEMBERS
from bench.planning.world import World

Counts = np.ndarray
Normal = tuple[Floats, Floats]


@dataclass(frozen=True)
class Prediction:
    """What one explanation predicts for c measurements.

    `means` [s, c, p] under each of s parameter draws; `scatter` [c, p, p] is the covariance of a
    link's mean around it.
    """

    means: Floats
    scatter: Floats

    def normal(self, links: Counts) -> Normal:
        """Return mean and covariance of the means over so many links [c] of each measurement.

        Measurements without links are left out. What parameters leave open is shared by all.
        """
        used = np.flatnonzero(links)
        draws = self.means[:, used].reshape(len(self.means), -1)
        size = self.means.shape[2]
        total = np.zeros((draws.shape[1],) * 2)
        for place, at in enumerate(used):
            part = slice(place * size, (place + 1) * size)
            total[part, part] = self.scatter[at] / links[at]
        if len(draws) > 1:
            total = total + np.atleast_2d(np.cov(draws.T))
        return draws.mean(axis=0), total


@dataclass(frozen=True)
class Outlook:
    """The predictions of all explanations, `names` [k], for the same measurements [c]."""

    names: tuple[str, ...]
    predictions: tuple[Prediction, ...]

    def nats(self, links: Counts) -> Floats:
        """Return expected nats [k, k] for row over column if row is true, with so many links [c].

        Zero without any link.
        """
        size = len(self.names)
        if not links.any():
            return np.zeros((size, size))
        normals = [one.normal(links) for one in self.predictions]
        return np.array([[divergence(a, b) if a is not b else 0.0 for b in normals]
                         for a in normals])  # fmt: skip

    def reached(self, links: Counts, values: Floats, right: int, wrong: int) -> float:
        """Return the nats for one explanation over another that were measured.

        `values` [used, p] are the means over the links of each measurement that has some.
        """
        one, other = (self.predictions[i].normal(links) for i in (right, wrong))
        return log_density(values.ravel(), *one) - log_density(values.ravel(), *other)


def outlook(
    world: World,
    alternatives: Sequence[Alternative],
    offered: Sequence[Measurement],
    reference: pd.Series,
    rows: int,
    noise: Scatter,
) -> Outlook:
    """Return what the explanations predict for measurements of `rows` rows a link."""
    frames = [one.rows(reference, rows, f"plan {i}") for i, one in enumerate(offered)]
    frame = pd.concat(frames, ignore_index=True)
    made = [
        _prediction(world, one, scene(frame, "plan"), rows, noise.of_means(rows))
        for one in alternatives
    ]
    return Outlook(tuple(one.name for one in alternatives), tuple(made))


def _prediction(
    world: World, one: Alternative, planned: object, rows: int, noise: Floats
) -> Prediction:
    """Return what one explanation predicts."""
    members = FIT_MEMBERS if len(one.draws) > 1 else SCATTER_MEMBERS
    means, scatters = [], []
    for added in one.draws:
        made = world.values(planned, added, members)  # type: ignore[arg-type]
        links = made.reshape(members, -1, rows, made.shape[-1]).mean(axis=2)
        apart = links - links.mean(axis=0)
        means.append(links.mean(axis=0))
        scatters.append(np.einsum("mcp,mcq->cpq", apart, apart) / (members - 1))
    return Prediction(np.stack(means), np.mean(scatters, axis=0) + noise)
