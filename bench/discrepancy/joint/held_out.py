"""Whether waveforms of links that nothing was tuned on speak for an effect, by their likelihood.

A score of one simulated row beside each recorded one is as wide as both scatter: in a few sealed
links it hardly falls by what is there. Their statistics are then asked, all at once, as those of
the working links were when the effect was chosen (the logarithmic score is a proper one, too).
"""

from __future__ import annotations

from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.joint.likelihood import link_nats
from bench.discrepancy.joint.polish import Fit, fitted
from bench.discrepancy.joint.settings import CLASS_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.effect import Effect


def likelier_with(comparison: Comparison, held: View, added: Added, effect: Effect) -> bool:
    """Return whether held-out links are likelier with an effect beside the others of `added`.

    20 to 1; that links agree was asked of the others, which are more. Nothing was fitted to them,
    so parameters cost nothing. Raises BenchError where waveforms show nothing.
    """
    given = Statistics(comparison, held)
    among = tuple(one for one in added if type(one).stage != "ranging")
    whole, rest = fitted(given, among), fitted(given, without(among, effect))
    if whole is None or rest is None:
        return False
    return _nats(given, whole) - _nats(given, rest) >= CLASS_NATS


def _nats(given: Statistics, fit: Fit) -> float:
    """Return the log likelihood of all links beside a set of effects, of shared rows once."""
    return float(link_nats(given, fit.moments, fit.responses).sum()) / given.crowding
