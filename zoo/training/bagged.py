"""Training perceptrons on half of the links each, all at once, and weighing them on the others."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from zoo.modules.bagged import BaggedNetwork, Members
from zoo.training.eager import FloatArray, Progress, as_tensors, one_thread, report
from zoo.training.further import train_further
from zoo.training.recipe import TrainingLog, TrainingRecipe, check_recipe, falling
from zoo.training.stopping import link_numbers

_BLOCK_ROWS = 4096
_WEIGHING_STEPS, _WEIGHING_RATE = 150, 0.05
_EVERY = 50  # steps between reports


@dataclass(frozen=True)
class Bagging:
    """What the members differ in: how strongly their inputs are blurred, and which links they see.

    Each of `noises` (in standard deviations of a figure) has equally many members; members come
    in pairs, one seeing the half of the links that the other does not. The last `apart` columns are
    seen by every other pair alone. `steps` of Adam each.
    """

    noises: tuple[float, ...]
    steps: int
    apart: int = 0

    def reads(self, columns: int, per_noise: int) -> Tensor:
        """Return 1 where a member sees a column, else 0 [members, columns]."""
        seen = torch.ones(len(self.noises), per_noise, columns)
        for noise in range(len(self.noises)):
            for member in range(per_noise):
                if (noise + member // 2) % 2 == 0:
                    seen[noise, member, columns - self.apart :] = 0
        return seen.flatten(0, 1)


def train_bagged(
    network: BaggedNetwork,
    X: FloatArray,
    y: FloatArray,
    recipe: TrainingRecipe,
    bagging: Bagging,
    *,
    groups: ArrayLike | None = None,
    progress: Progress | None = None,
) -> TrainingLog:
    """Train a network's members in place with AdamW on the mean |residual| of their own links.

    The rate falls to 0 along a half cosine. A noise's share in the answer is the mean of an equal
    one and of the one that suits links best which the members have not seen, each link counting
    alike. Then `train_further`. Without `groups` every row is a link. Raises ValueError as
    `zoo.training.eager.train`.
    """
    inputs, targets = as_tensors(X, y)
    check_recipe(recipe, len(inputs))
    started, links = time.perf_counter(), link_numbers(groups, len(inputs))
    per_noise = network.members // len(bagging.noises)
    bags = link_bags(int(links.max()) + 1, per_noise, recipe.seed)[:, links]
    with one_thread():
        members, losses = _trained(network, inputs, targets, bags, recipe, bagging, progress)
        shares = _shares(members, inputs, targets, bags, links)
    network.take(members, shares)
    network.eval()
    seen = bagging.steps * recipe.batch_size * network.members
    further = train_further(network, inputs, targets, recipe, links)
    return TrainingLog(
        (float(losses), *further.epoch_losses),
        len(inputs),
        time.perf_counter() - started,
        "stacked",
        bagging.steps + further.steps,
        further.held_out_losses,
        seen + (further.rows_seen or 0),
    )


def link_bags(links: int, count: int, seed: int) -> NDArray[np.bool_]:
    """Return which links each of `count` members sees [count, links]: half, the next the rest.

    One link is seen by all.
    """
    rng = np.random.default_rng([seed, 2])
    bags = np.zeros((count, links), np.bool_)
    for member in range(0, count, 2):
        bags[member, rng.permutation(links)[: max(1, links // 2)]] = True
        if member + 1 < count:
            bags[member + 1] = ~bags[member]
    return bags if links > 1 else np.ones_like(bags)


def _trained(
    network: BaggedNetwork,
    inputs: Tensor,
    targets: Tensor,
    bags: NDArray[np.bool_],
    recipe: TrainingRecipe,
    bagging: Bagging,
    progress: Progress | None,
) -> tuple[Members, Tensor]:
    """Return the members, and their mean loss over all steps, blur included."""
    noises = torch.tensor(bagging.noises).repeat_interleave(len(bags))[:, None, None]
    rows = [np.flatnonzero(bag) for bag in bags] * len(bagging.noises)
    starts = torch.stack([targets[torch.from_numpy(own)].median() for own in rows])
    reads = bagging.reads(inputs.shape[1], len(bags))
    members = Members(reads, network.units, starts, recipe.seed)
    adam = torch.optim.AdamW(members.parameters(), weight_decay=recipe.weight_decay, fused=True)
    rng, blur = np.random.default_rng(recipe.seed), torch.Generator().manual_seed(recipe.seed)
    total = torch.zeros(())
    for step in range(bagging.steps):
        adam.param_groups[0]["lr"] = falling(recipe.learning_rate, step / bagging.steps)
        chosen = _batches(rows, recipe.batch_size, rng)
        x = inputs[chosen]
        x = x + noises * torch.randn(x.shape, generator=blur)
        loss = (members(x) - targets[chosen]).abs().mean(1).sum()
        adam.zero_grad()
        loss.backward()
        adam.step()
        total += loss.detach() / len(rows)
        if step % _EVERY == 0:
            report(progress, step / bagging.steps)
    report(progress, 1.0)
    return members, total / max(bagging.steps, 1)


def _batches(rows: Sequence[NDArray[np.intp]], size: int, rng: np.random.Generator) -> Tensor:
    """Return rows drawn with replacement for each member [members, size]."""
    return torch.from_numpy(np.stack([own[rng.integers(0, len(own), size)] for own in rows]))


def _shares(
    members: Members,
    inputs: Tensor,
    targets: Tensor,
    bags: NDArray[np.bool_],
    links: NDArray[np.int64],
) -> Tensor:
    """Return each member's share [members]; they sum to 1."""
    count, noises = len(bags), len(members.inner) // len(bags)
    unseen = torch.from_numpy(~bags).float()
    judged = unseen.sum(0) > 0
    even = torch.full((noises,), 1 / noises)
    if noises == 1 or not judged.any():
        return even.repeat_interleave(count) / count
    with torch.no_grad():
        blocks = [
            members(rows.expand(len(members.inner), -1, -1))
            for rows in torch.split(inputs, _BLOCK_ROWS)
        ]
        said = torch.cat(blocks, 1).view(noises, count, -1)
    said = (said * unseen).sum(1)[:, judged] / unseen.sum(0)[judged]
    number = torch.from_numpy(links)[judged]
    weight = 1 / torch.bincount(number)[number].float()
    best = _weighed(said, targets[judged], weight / weight.sum())
    return (0.5 * (even + best)).repeat_interleave(count) / count


def _weighed(said: Tensor, targets: Tensor, weight: Tensor) -> Tensor:
    """Return shares [noises] of answers [noises, n] with a small weighted mean |residual|."""
    scores = torch.zeros(len(said), requires_grad=True)
    adam = torch.optim.Adam([scores], _WEIGHING_RATE)
    for _ in range(_WEIGHING_STEPS):
        loss: Any = ((torch.softmax(scores, 0) @ said - targets).abs() * weight).sum()
        adam.zero_grad()
        loss.backward()
        adam.step()
    return torch.softmax(scores, 0).detach()
