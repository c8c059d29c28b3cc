"""Effects on waveforms whose ranges stay as they are without them.

What a changed waveform does to a range hangs on the receiver's detector, which no library knows: a
reflection moves the centre of a pulse and leaves its edge. Where waveforms are nearer with an
effect and ranges are not, the one is kept without the other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Changed, Comparison, View
from bench.discrepancy.data.observables import RANGE


@dataclass(frozen=True)
class Untimed(Changed):
    """A comparison in which effects of some `names` (of their physics) leave ranges alone."""

    names: tuple[str, ...]

    def ensemble(self, view: View, added: Added, members: int, first: int = 0) -> Ensemble:
        """Return rows beside simulated versions, their ranges as without those effects."""
        whole = self.comparison.ensemble(view, added, members, first)
        rest = tuple(effect for effect in added if effect.physics not in self.names)
        if len(rest) == len(added) or RANGE not in whole.names:
            return whole
        versions = whole.versions.copy()
        timed = self.comparison.ensemble(view, rest, members, first)
        versions[..., whole.place(RANGE)] = timed.versions_of(RANGE)
        return replace(whole, versions=versions)


def untimed(comparison: Comparison, names: tuple[str, ...]) -> Comparison:
    """Return the comparison in which effects of these names leave ranges alone."""
    return Untimed(comparison, names) if names else comparison
