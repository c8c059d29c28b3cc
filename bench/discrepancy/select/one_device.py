"""What names leave at one device: a second fault that no regression of a few links foretells."""

from __future__ import annotations

from bench.discrepancy.data.covariates import DEVICES
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.select.settings import DEVICE_LEADS, LEADING
from bench.discrepancy.settings import SURE_P

WIDER = ("spread", "link")  # moments that grow where a device stands elsewhere


def left_at_device(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Return those that say that ranges of one device differ, beyond doubt; most telling first.

    A spread or offsets of links count where recorded ones are wider: a moved anchor is nearer to
    some tags and farther from others. Not what is as large in other places: a cause of another form
    leaves that.
    """
    here = [one for one in findings if _at_device(one)]
    off_m = [_size(one) for one in findings if one.cell.observable == RANGE and one not in here]
    least_m = DEVICE_LEADS * max(off_m, default=0.0)
    return tuple(one for one in here if one.p <= SURE_P and _size(one) >= least_m)


def all_at_device(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Return the most telling findings where these are all of rows of one device, else none.

    Of levels and waveforms, too: one device that is weak (its antenna, its cable, its power).
    """
    first = findings[:LEADING]
    places = {one.cell.place.where() for one in first}
    of_device = [(one.cell.place.covariate or "").startswith(DEVICES) for one in first]
    told = len(first) == LEADING and len(places) == 1 and all(of_device)
    return first if told and all(one.p <= SURE_P for one in first) else ()


def _size(found: Finding) -> float:
    """Return how large a finding is, in the unit of what it is of."""
    return abs(found.effect.value)


def _at_device(found: Finding) -> bool:
    """Return whether a finding is of ranges where one device takes part."""
    cell = found.cell
    if cell.observable != RANGE or not (cell.place.covariate or "").startswith(DEVICES):
        return False
    return cell.moment == "mean" or (cell.moment in WIDER and found.effect.value > 0)
