"""Many tiny perceptrons as one: their weights side by side, their answers averaged."""

from __future__ import annotations

import torch
from torch import Tensor, nn


class BaggedNetwork(nn.Module):
    """Standardised figures [n, columns] -> errors [n] in metres.

    `members` perceptrons of `hidden` units lie side by side in two dense layers; the weights of
    the second hold each member's share of the answer.
    """

    def __init__(self, columns: int, members: int, hidden: int) -> None:
        super().__init__()
        self.members, self.units = members, hidden
        self.first = nn.Linear(columns, members * hidden)
        self.head = nn.Linear(members * hidden, 1)

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [n] in metres."""
        error: Tensor = self.head(torch.relu(self.first(x)))
        return error.squeeze(-1)

    def take(self, members: Members, shares: Tensor) -> None:
        """Become the members' average, weighted with shares [members] that sum to 1."""
        with torch.no_grad():
            inner = members.inner * members.read
            self.first.weight.copy_(inner.transpose(1, 2).reshape(-1, inner.shape[1]))
            self.first.bias.copy_(members.inner_bias.flatten())
            self.head.weight.copy_((members.outer[..., 0] * shares[:, None]).reshape(1, -1))
            self.head.bias.copy_((members.outer_bias[:, 0, 0] * shares).sum()[None])


class Members(nn.Module):
    """The same perceptrons apart, to be trained at once: [members, n, columns] -> [members, n].

    Weights start Glorot uniform, drawn from `seed`; each output starts at `starts` [members], in
    metres. `reads` [members, columns] is 0 where a member does not see a column, else 1.
    """

    read: Tensor

    def __init__(self, reads: Tensor, hidden: int, starts: Tensor, seed: int) -> None:
        super().__init__()
        members, columns = reads.shape
        generator = torch.Generator().manual_seed(seed)
        self.register_buffer("read", reads[:, :, None])
        inner, outer = torch.empty(members, columns, hidden), torch.zeros(members, hidden, 1)
        bound = (6 / (columns + hidden)) ** 0.5
        self.inner = nn.Parameter(inner.uniform_(-bound, bound, generator=generator))
        self.inner_bias = nn.Parameter(torch.zeros(members, 1, hidden))
        self.outer = nn.Parameter(outer)
        self.outer_bias = nn.Parameter(starts.clone()[:, None, None])

    def forward(self, x: Tensor) -> Tensor:
        """Return errors [members, n] in metres."""
        hidden = torch.relu(torch.baddbmm(self.inner_bias, x, self.inner * self.read))
        return torch.baddbmm(self.outer_bias, hidden, self.outer).squeeze(-1)
