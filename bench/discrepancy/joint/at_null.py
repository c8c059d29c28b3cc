"""Whether a set needs a parameter of an effect: how likely it is with that where it does nothing.

Intervals are as wide as slopes and valleys leave them; where another parameter does nearly the same
(an offset of levels beside their slope), the evidence tells more.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.view import Added, swapped, without
from bench.discrepancy.fit.starts import free_parameters
from bench.discrepancy.joint.likelihood import link_nats
from bench.discrepancy.joint.polish import Fit, fitted, in_rounds
from bench.discrepancy.joint.rows import compared_rows
from bench.discrepancy.joint.settings import NAME_NATS, STEPS
from bench.discrepancy.joint.sizes import on_waveforms
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import ONE_SIDED_95
from bench.physics.effect import Effect


def needed(search: Search, added: Added, effect: Effect, name: str) -> bool:
    """Return whether the waveforms of a search need a parameter of an effect (see `needs`)."""
    return needs(*_compared(search, added), effect, name)


def needs(given: Statistics, waves: Added, effect: Effect, name: str) -> bool:
    """Return whether effects are less likely by a name with one parameter of one at its null."""
    item = next(one for one in free_parameters(type(effect)) if one.name == name)
    off = replace(effect, **{name: float(item.null or 0.0)})
    whole, begun = (fitted(given, one) for one in (waves, swapped(waves, off)))
    if whole is None or begun is None:
        return False
    rest = in_rounds(given, begun, STEPS, [_place(begun, effect.name, name)])
    return whole.nats - rest.nats >= NAME_NATS


def surely_there(search: Search, added: Added, effect: Effect) -> bool:
    """Return whether links one by one, not a few, are likelier with an effect (see `likelier`)."""
    return likelier(*_compared(search, added), effect)


def likelier(given: Statistics, waves: Added, effect: Effect) -> bool:
    """Return whether links scatter too little about their mean gain by an effect to be chance.

    Where its parameters trade for each other no interval of one tells it from none. How its links
    differ in what it gains does (Vuong 1989), with 95 % on one side; parameters cost (BIC).
    """
    whole, rest = (fitted(given, one) for one in (waves, without(waves, effect)))
    if whole is None or rest is None:
        return False
    gains = link_nats(given, whole.moments, whole.responses)
    gains = gains - link_nats(given, rest.moments, rest.responses)
    cost = (whole.parameters - rest.parameters) / 2 * float(np.log(given.links))
    unsure = ONE_SIDED_95 * float(gains.std(ddof=1)) * np.sqrt(given.links / given.crowding)
    return bool(float(gains.sum()) / given.crowding - cost > unsure)


def _compared(search: Search, added: Added) -> tuple[Statistics, Added]:
    """Return the waveforms that sets of a search are judged by, and the effects on these."""
    waves = tuple(one for one in added if on_waveforms(one))
    return Statistics(search.comparison, compared_rows(search)), waves


def _place(fit: Fit, effect: str, name: str) -> int:
    """Return where among the free parameters of a set one of an effect is."""
    every = [(one.name, p.name) for one in fit.effects for p in free_parameters(type(one))]
    return int(np.flatnonzero([one == (effect, name) for one in every])[0])
