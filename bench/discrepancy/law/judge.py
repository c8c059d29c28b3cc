"""Sealed links judge a proposed law: it is said only where it beats their noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.law.delay import ends
from bench.discrepancy.law.faults import UNDETERMINED, of_a_rate
from bench.discrepancy.law.found import FoundLaw, LawConstant, Rival, SetupFault
from bench.discrepancy.law.likelihood import log_density
from bench.discrepancy.law.material import Floats, Material
from bench.discrepancy.law.meaning import looks_like
from bench.discrepancy.law.search import Candidate, Proposal
from bench.discrepancy.law.settings import LAW_RATIO_DOUBT, UNDETERMINED_M
from bench.discrepancy.settings import ONE_SIDED_95
from bench.physics.effects.ranging.antenna_delay import AntennaDelay

SHIFTS = ("dx", "dy", "dz")


def judged(proposal: Proposal, sealed: Material, seed: int) -> FoundLaw | None:
    """Return the law with what it gains on sealed links, None where they do not bear it out."""
    best = proposal.best
    shift = best.structure.shift_m(sealed, best.fitted.constants)
    gain = _gain(proposal, sealed, shift, np.zeros(len(shift)), seed)
    if not gain.likely_above_zero:
        return None
    left, before = np.abs(sealed.residual_m - shift), np.abs(sealed.residual_m)
    said = best.structure.words(shown(proposal.constants))
    return FoundLaw(
        best.structure.form,
        best.structure.columns,
        best.structure.where,
        said,
        looks_like(best.structure),
        best.structure.expression,
        proposal.constants,
        best.nats,
        gain,
        cluster_bootstrap(before - left, sealed.links, seed, "m"),
        _rivals(proposal, sealed, shift, seed),
        best.structure.fault,
    )


def gains_among(proposal: Proposal, rows: Material, seed: int) -> bool:
    """Return whether a proposed law predicts some rows better than nothing does."""
    shift = proposal.best.structure.shift_m(rows, proposal.best.fitted.constants)
    return _gain(proposal, rows, shift, np.zeros(len(shift)), seed).likely_above_zero


def _gain(proposal: Proposal, rows: Material, shift: Floats, other: Floats, seed: int) -> Estimate:
    """Return the log-likelihood per row that one shift gains over another, over links."""
    ours, theirs = (log_density(rows.residual_m - one, proposal.scale_m) for one in (shift, other))
    return cluster_bootstrap(ours - theirs, rows.links, seed, "nats per row")


def _rivals(proposal: Proposal, sealed: Material, shift: Floats, seed: int) -> tuple[Rival, ...]:
    """Return the laws that neither working nor sealed links exclude."""
    out = []
    for one in proposal.tied:
        other = one.structure.shift_m(sealed, one.fitted.constants)
        if not _gain(proposal, sealed, shift, other, seed).above_zero:
            out.append(_rival(one, proposal.best.nats - one.nats))
    return tuple(out)


def tied_names(law: FoundLaw, names: Sequence[str]) -> tuple[Rival, ...]:
    """Return the library's names that do as well as a device that stands elsewhere.

    From where an anchor sees its rows, standing further off reads nearly the same as being late: by
    how much is what a constant there would be, which does as well; one of that device is a delay.
    So it may be where no axis is known to be off at all.
    """
    of = f" of {law.where}" if law.where else ""
    given = names if law.fault == "position" else ()
    same = [one for one in law.rivals if one.form == "constant" and not one.columns]
    late = [
        one for one in same if any(one.words.endswith(f", where {at}") for at in ends(law.where))
    ]
    same = late if law.where else same
    if law.fault == "position" and (late or _nowhere(law.constants)):
        given = tuple(dict.fromkeys((*given, AntennaDelay.name)))
    size = next((f" ({one.words.partition(',')[0]})" for one in same), "")
    return tuple(Rival(f"{name}{of} instead{size}", "constant", (), 0.0, True) for name in given)


def _nowhere(constants: Sequence[LawConstant]) -> bool:
    """Return whether a device that is shifted may be where it should along every axis."""
    shifts = [one for one in constants if one.name in SHIFTS]
    return bool(shifts) and all(one.low <= 0 <= one.high for one in shifts)


def _rival(one: Candidate, behind: float) -> Rival:
    """Return a candidate that is not excluded, in words."""
    given = [LawConstant(n, v, v, v, unit) for n, v, unit in one.fitted.constants]
    words = one.structure.words(shown(given))
    return Rival(words, one.structure.form, one.structure.columns, behind)


def shown(constants: Sequence[LawConstant]) -> dict[str, str]:
    """Return constants as texts by name; a shift that no row determines is said to be one."""
    return {c.name: UNDETERMINED if _undetermined(c) else str(c) for c in constants}


def _undetermined(constant: LawConstant) -> bool:
    """Return whether a shift along an axis may be anything."""
    return constant.name in SHIFTS and constant.high - constant.low > UNDETERMINED_M


def setup_fault(proposal: Proposal) -> SetupFault | None:
    """Return the fault of the set-up that a law is, None where it is none."""
    structure = proposal.best.structure
    speed_alone = structure.columns == ("radial_speed_m_per_s",) and not structure.where
    if structure.form == "linear" and speed_alone:
        words = _late(proposal.constants[0])
        return SetupFault("time shift", (), words, proposal.constants[:1])
    if not structure.fault:
        return _other_unit(proposal)
    devices = getattr(structure, "pair", (structure.where,) if structure.where else ())
    fitted = structure.fault in ("position", "plan", "unit", "ceiling")
    size = proposal.constants if fitted else ()
    return SetupFault(structure.fault, devices, structure.words(shown(proposal.constants)), size)


def _late(lag: LawConstant) -> str:
    """Return in words by how much ranges are later than their truth, or earlier."""
    if lag.value >= 0:
        return f"ranges are later than their truth by {lag}"
    sooner = replace(lag, value=-lag.value, low=-lag.high, high=-lag.low)
    return f"ranges are earlier than their truth by {sooner}"


def _other_unit(proposal: Proposal) -> SetupFault | None:
    """Return the unit that nobody listed in which a law says ranges are, None where it says none.

    Known as well as a listed unit must be (see `of_a_rate`).
    """
    structure, rate = proposal.best.structure, proposal.constants[0]
    if not of_a_rate(structure, [one.value for one in proposal.constants]):
        return None
    if (rate.high - rate.low) / 2 > ONE_SIDED_95 * LAW_RATIO_DOUBT * abs(rate.value):
        return None
    ratio = LawConstant("ratio", 1 + rate.value, 1 + rate.low, 1 + rate.high, "1")
    who = f", where {structure.where}" if structure.where else ""
    words = f"a unit or counter of another rate (measured = {ratio} x true range){who}"
    return SetupFault("unit", (structure.where,) if structure.where else (), words, (ratio,))
