"""What sets of effects are worth: their evidence, and that of what they need; each asked once.

Many are weighed beside one another, as each takes as long as a fit.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from bench.discrepancy.joint.likelihood import evidence
from bench.discrepancy.joint.plainer import plainer
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.quiet import Quiet
from bench.discrepancy.joint.settings import KEPT, WEIGHED
from bench.discrepancy.joint.statistics import Statistics
from bench.forked import in_forks
from bench.physics.memory import Memory


class Weighing:
    """The evidence of sets in nats, with what `quiet` says of samples of noise alone."""

    def __init__(self, given: Statistics, quiet: Quiet) -> None:
        self.given, self.quiet = given, quiet
        self._evidences: Memory[float] = Memory(KEPT)
        self._plains: Memory[Fit] = Memory(KEPT)

    def evidence(self, fit: Fit) -> float:
        """Return the evidence of a set, whatever forms its effects have, in nats.

        By this sets are compared: how likely a fit is says nothing of what devices have of their
        own, so one cause that differs from device to device would lose to another that scatters.
        With what samples of noise alone say of a tone, which the statistics of rows do not show.
        """
        return self._evidences.get(fit.key, lambda: self._evidence(fit))

    def worth(self, fit: Fit) -> float:
        """Return the evidence of a set without what it does not need, in nats."""
        return self.evidence(self.plain(fit))

    def plain(self, fit: Fit) -> Fit:
        """Return a set without the amplitudes that it does not need."""
        return self._plains.get(fit.key, lambda: self._plainer(fit))

    def weigh(self, fits: Iterable[Fit]) -> None:
        """Weigh sets beside one another, where many were not."""
        new = _by_key(fits, self._evidences)
        if len(new) >= WEIGHED:
            for fit, nats in zip(new, in_forks(self._evidence, new), strict=True):
                self._evidences.keep(fit.key, nats)

    def weigh_plain(self, fits: Iterable[Fit]) -> None:
        """Find beside one another what sets need, with what that is worth."""
        new = _by_key(fits, self._plains)
        for fit, (plain, nats) in zip(new, in_forks(self._plain_worth, new), strict=True):
            self._plains.keep(fit.key, plain)
            self._evidences.keep(plain.key, nats)

    def _plain_worth(self, fit: Fit) -> tuple[Fit, float]:
        plain = self._plainer(fit)
        return plain, self.evidence(plain)

    def _plainer(self, fit: Fit) -> Fit:
        return plainer(self.given, fit, self.evidence)

    def _evidence(self, fit: Fit) -> float:
        quiet = self.quiet.nats(fit.effects)
        return quiet + evidence(self.given, fit.moments, fit.responses, fit.parameters)


def _by_key(fits: Iterable[Fit], known: Memory[float] | Memory[Fit]) -> Sequence[Fit]:
    """Return one set of each kind that is not `known` yet."""
    each = {fit.key: fit for fit in fits}
    return [fit for fit in each.values() if known.find(fit.key) is None]
