"""Few links, or one device, far off all others: to be looked at before anything is measured."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.data.covariates import DEVICES
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.far_links import far_links
from bench.discrepancy.select.settings import LEADING
from bench.planning.alternatives import Past
from bench.planning.questions import Seen
from bench.planning.scatter import link_means
from bench.planning.world import Added


def stray_links(past: Past, rest: Added) -> str:
    """Return which few links are far off, in words; "" where none are, or many."""
    found = past.evidence
    if RANGE not in found.names:
        return ""
    left = past.residual(rest)[0][:, [found.names.index(RANGE)]]
    means = link_means(left, found.links)[1][:, 0]
    seen = far_links(means)
    if not len(seen.far):
        return ""
    return (
        f"first look at the {len(seen.far)} of {len(means)} links that are far off the others "
        f"({seen.calm_m:+.2f} m): {seen.worst(np.unique(found.frame['link'].astype(str)))}. If "
        "something stands in their way, list it (`obstacles`, `los`); if a device or a position is "
        "wrong, put it right; diagnose again, and plan what stays open"
    )


def of_one_device(seen: tuple[Seen, ...]) -> str:
    """Return what to do where all that is told first of a mismatch is of one device, else ""."""
    places = {one.covariate or "" for one in seen[:LEADING]}
    place = places.pop() if len(seen) >= LEADING and len(places) == 1 else ""
    if not place.startswith(DEVICES):
        return ""
    device = place.partition("=")[2]
    return (
        f"all of it shows where {place}: let another device take the place of {device}, and "
        f"{device} another's (then its antenna and its cable alone), record the same links again, "
        "and diagnose again: what goes along is its own, what stays is of its place"
    )
