"""Whether waveforms of links that nothing was tuned on speak for an effect, by their likelihood.

A score of one simulated row beside each recorded one is as wide as both scatter: in a few sealed
links it hardly falls by what is there. Their statistics are then asked, all at once, as those of
the working links were when the effect was chosen (the logarithmic score is a proper one, too).
"""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.fit.search import valued
from bench.discrepancy.joint.likelihood import link_nats
from bench.discrepancy.joint.mixture import SHARES, Mixture
from bench.discrepancy.joint.polish import Fit, fitted
from bench.discrepancy.joint.settings import CLASS_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.select.link_mixture import Strike
from bench.physics.effect import Effect


def likelier_with(comparison: Comparison, held: View, added: Added, effect: Effect) -> bool:
    """Return whether held-out links are likelier with an effect beside the others of `added`.

    20 to 1; that links agree was asked of the others, which are more. Nothing was fitted to them,
    so parameters cost nothing. Raises BenchError where waveforms show nothing.
    """
    given, among = Statistics(comparison, held), _of_waveforms(added)
    whole, rest = fitted(given, among), fitted(given, without(among, effect))
    if whole is None or rest is None:
        return False
    return _nats(given, whole) - _nats(given, rest) >= CLASS_NATS


def likelier_struck(comparison: Comparison, held: View, added: Added, strike: Strike) -> bool:
    """Return whether held-out links are likelier if some are struck, beside effects `added`.

    As the working links were when that was found: each is spared or struck, and nobody knows which
    (see `Mixture`). The share is anywhere that these leave it (the mean likelihood over its
    interval); 20 to 1. Raises BenchError where waveforms show nothing.
    """
    kind, told = type(strike.effect), {one.name: one for one in strike.parameters}
    assert kind.strikes is not None
    share = told.pop(kind.strikes[0])
    sizes = {name: one.value for name, one in told.items()}
    struck = valued(kind, {**sizes, share.name: 1.0})
    given = Statistics(comparison, held).knowing((struck,))
    mixture = Mixture(given, _of_waveforms(added), kind)
    made = mixture.at(sizes)
    near = (share.low <= SHARES) & (share.high >= SHARES)
    if made is None or not near.any():
        return False
    mean = float(np.logaddexp.reduce(made.nats[near]) - np.log(near.sum()))
    return (mean - float(mixture.spared.sum())) / given.crowding >= CLASS_NATS


def _of_waveforms(added: Added) -> Added:
    """Return the effects that change more than ranges."""
    return tuple(one for one in added if type(one).stage != "ranging")


def _nats(given: Statistics, fit: Fit) -> float:
    """Return the log likelihood of all links beside a set of effects, of shared rows once."""
    return float(link_nats(given, fit.moments, fit.responses).sum()) / given.crowding
