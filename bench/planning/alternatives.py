"""Explanations that recordings cannot tell apart, each with every set of parameters left open.

The sets are draws of the posterior under flat priors within physical bounds, by moves of many
walkers together (Goodman and Weare 2010), which need no tuning where parameters trade off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from bench.discrepancy.fit.starts import free_parameters
from bench.discrepancy.report.evidence import Evidence
from bench.errors import BenchError
from bench.physics.effect import Effect, Parameter
from bench.physics.scene import Scene, scene
from bench.planning.scatter import Floats, Scatter, beyond, components, log_likelihood
from bench.planning.settings import (
    FIT_MEMBERS,
    KEPT_DRAWS,
    KEPT_EVERY,
    LEAST_SCATTER,
    START_SHARE,
    STRETCH,
    SWEEPS,
    WALKERS,
    WAVE_SWEEPS,
)
from bench.planning.world import Added, World
from bench.plugins import load


@dataclass(frozen=True)
class Alternative:
    """An explanation: its name, and the effects added under each set of parameters left open."""

    name: str
    draws: tuple[Added, ...]


@dataclass(frozen=True)
class Past:
    """What was recorded, and how well effects explain it."""

    world: World
    evidence: Evidence
    counts: dict[tuple[type[Effect], ...], int] = field(default_factory=dict)

    @cached_property
    def rows(self) -> Scene:
        """What is known of the recorded rows."""
        return scene(self.evidence.frame, "evidence")

    @cached_property
    def bare(self) -> Floats:
        """What is simulated without anything added [members, n, p]."""
        return self.world.values(self.rows, (), self._members(()))

    def residual(self, added: Added) -> tuple[Floats, Scatter]:
        """Return recorded - simulated [n, p] with effects, and the scatter that they simulate."""
        made = self.world.values(self.rows, added, self._members(added))
        mean = made.mean(axis=0)
        found = self.evidence
        left = found.recorded - found.simulated - (mean - self.bare.mean(axis=0))
        return left, self._simulated(made - mean)

    def _members(self, added: Added) -> int:
        """Return how many versions are needed: one where nothing is drawn at random."""
        kinds = tuple(type(effect) for effect in added)
        if kinds not in self.counts:
            two = self.world.values(self.rows, added, 2)
            self.counts[kinds] = FIT_MEMBERS if np.ptp(two, axis=0).any() else 1
        return self.counts[kinds]

    def _simulated(self, apart: Floats) -> Scatter:
        """Return the scatter of simulated versions [m, n, p] around their mean."""
        members, links = len(apart), self.evidence.links
        step = (links.max() + 1) * np.arange(members)[:, None]
        flat = apart.reshape(-1, apart.shape[-1]) * np.sqrt(members / max(members - 1, 1))
        return components(flat, (links + step).ravel())

    def noise(self, added: Added) -> Scatter:
        """Return the recorded scatter that these effects do not simulate."""
        left, simulated = self.residual(added)
        least = np.array([LEAST_SCATTER.get(unit, 0.0) for unit in self.evidence.units])
        return beyond(components(left, self.evidence.links), simulated, least)

    def log_likelihood(self, added: Added, noise: Scatter) -> float:
        """Return how well effects explain what was recorded; -inf where they cannot be run."""
        try:
            left, simulated = self.residual(added)
        except BenchError:
            return -np.inf
        return log_likelihood(left, self.evidence.links, noise.plus(simulated))


def alternative(past: Past, rest: Added, effect: Effect, noise: Scatter, seed: int) -> Alternative:
    """Return an effect, beside the `rest`, with the parameters that the recordings leave open."""
    effect, known = _parametric(effect)
    free = [p for p in free_parameters(type(effect)) if not p.whole]
    if not effect.fitted or not free:
        return Alternative(effect.physics, ((*rest, effect),))

    def at(point: Floats) -> Added:
        return (*rest, replace(effect, **_values(free, point)))

    def score(point: Floats) -> float:
        inside = bool((point >= 0).all() and (point <= 1).all())
        return past.log_likelihood(at(point), noise) if inside else -np.inf

    rng = np.random.default_rng(seed)
    start = np.array([(getattr(effect, p.name) - p.low) / (p.high - p.low) for p in free])
    apart = rng.uniform(-START_SHARE, START_SHARE, (WALKERS, len(start)))
    first = np.clip(start + apart, 0, 1) if known else rng.random(apart.shape)
    sweeps = WAVE_SWEEPS if past.world.waveform else SWEEPS
    found = posterior(score, first, sweeps, rng)
    return Alternative(effect.physics, tuple(at(point) for point in found))


def _values(free: Sequence[Parameter], point: Floats) -> dict[str, float]:
    """Return parameter values of a point in the unit cube."""
    return {
        p.name: float(np.clip(p.low + u * (p.high - p.low), p.low, p.high))
        for p, u in zip(free, point, strict=True)
    }


def _parametric(effect: Effect) -> tuple[Effect, bool]:
    """Return the library's form of a fitted curve, and whether its parameters are known.

    A curve says nothing of levels or headings that were not recorded; the form it stands for does.
    """
    if effect.fitted or not type(effect).contains:
        return effect, True
    kind = load("effects", effect.physics)
    return (kind(), False) if kind.fitted else (effect, True)


def posterior(
    score: Callable[[Floats], float], first: Floats, sweeps: int, rng: np.random.Generator
) -> Floats:
    """Return draws [n, d] in the unit cube by the stretch move of two halves in turn.

    `first` [walkers, d] are where the walkers start.
    """
    now, kept = first.copy(), [first]
    scores = np.array([score(point) for point in now])
    half = len(now) // 2
    for sweep in range(2 * sweeps):
        mine = np.arange(half) + half * (sweep % 2)
        others = (mine[rng.permutation(half)] + half) % len(now)
        size = ((STRETCH - 1) * rng.random(half) + 1) ** 2 / STRETCH
        tried = now[others] + size[:, None] * (now[mine] - now[others])
        made = np.array([score(point) for point in tried])
        with np.errstate(invalid="ignore"):
            gain = (now.shape[1] - 1) * np.log(size) + made - scores[mine]
        taken = np.log(rng.random(half)) < np.nan_to_num(gain, nan=-np.inf)
        now[mine[taken]], scores[mine[taken]] = tried[taken], made[taken]
        if sweep % KEPT_EVERY == 0 and sweep >= sweeps:  # the first half is the way there
            kept.append(now.copy())
    return np.concatenate(kept[-KEPT_DRAWS // len(now) :])
