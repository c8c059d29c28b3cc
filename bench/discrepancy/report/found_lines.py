"""What was found, in words and figures: names, laws and faults, and what has no name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.fit.estimate import PURE
from bench.discrepancy.headline import NOTHING
from bench.discrepancy.law.found import FoundLaw
from bench.discrepancy.law.settings import SHOWN_RIVALS
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.report.beside_values import beside_values
from bench.discrepancy.report.doing import doings
from bench.discrepancy.report.parameters import detectable_line, parameter_lines
from bench.discrepancy.select.remainder import beyond_names
from bench.discrepancy.select.verdict import (
    Ambiguous,
    Control,
    LeftOut,
    NoMismatch,
    Unknown,
    Verdict,
)
from bench.discrepancy.settings import SURE_P
from bench.physics.effect import Effect

SHOWN_LEFT = 3
RESEMBLES = "looks most like"  # how notes on refused names begin
THEIRS = "Beside that differs what is theirs: their mean, or another form (which is simulated, too)"
_LISTED = "It is seen in differences that are listed above, too."


def found_lines(diagnosis: Diagnosis) -> list[list[str]]:
    """Return what was found, in lines of each: names, a law or fault, what else differs."""
    does, every = doings(diagnosis), diagnosis.selection.verdicts
    names = [describe(verdict, does) for verdict in every if not isinstance(verdict, Unknown)]
    rest = [verdict for verdict in every if isinstance(verdict, Unknown)]
    if diagnosis.law is None:
        return [*names, *_once(list(map(describe, rest)))]
    return [*names, law_lines(diagnosis.law), *([_explained(rest)] if rest else [])]


def _once(told: list[list[str]]) -> list[list[str]]:
    """Return lines of each; differences that an earlier one lists too are not listed again."""
    out: list[list[str]] = []
    for lines in told:
        known = {line for earlier in out for line in earlier if line.startswith("- ")}
        new = [line for line in lines if line not in known]
        out.append(new if len(new) == len(lines) else [*new, _LISTED])
    return out


def _explained(verdicts: Sequence[Unknown]) -> list[str]:
    """Return what differed where a law or a fault of the set-up explains it: once, in one list.

    Without names that were refused, which it most resembled until then.
    """
    told = [one.told for one in verdicts if one.told and not one.told.startswith(RESEMBLES)]
    notes = f" ({'; '.join(dict.fromkeys(told))})" if told else ""
    first: dict[Cell, Finding] = {}
    for finding in (one for verdict in verdicts for one in verdict.findings):
        first.setdefault(finding.cell, finding)
    return [
        f"What differed without it, and no known effect explains{notes}:",
        *finding_lines(list(first.values()), 5),
    ]


def describe(verdict: Verdict, does: Mapping[str, str] = NOTHING) -> list[str]:
    """Return one verdict in words and figures; `does` says what names do to ranges."""
    if isinstance(verdict, NoMismatch):
        return [f"**{verdict}.**", detectable_line(verdict)]
    if isinstance(verdict, Unknown):
        asked = verdict.removable.high > verdict.removable.low  # else none was tried
        worth = "nothing" if verdict.removable.value < 0 else verdict.removable
        how = f"A flexible regression over all that is known removes {worth} of held-out score."
        return [
            f"**Something is there that no known effect explains** ({verdict.told}).",
            *([how] if asked else []),
            *finding_lines(verdict.findings, 5),
        ]
    if isinstance(verdict, Ambiguous):
        out = [f"**{' or '.join(verdict.names)}**: these recordings cannot tell them apart."]
        out += [f"To progress: {verdict.separate}."]
        return out + [line for option in verdict.options for line in _option_lines(option, does)]
    return [f"**Left out: {verdict.names[0]}.**", *_option_lines(verdict, does)]


def finding_lines(findings: Sequence[Finding], most: int) -> list[str]:
    """Return the first findings, each once: of some of the rows what holds in others is no news."""
    told: list[Finding] = []
    for one in (finding.told for finding in findings):
        if not any(_alike(one, other) for other in told):
            told.append(one)
    return [f"- {finding}" for finding in told[:most]]


def _alike(one: Finding, other: Finding) -> bool:
    """Return whether two findings are of one observable, and as large as far as is known."""
    same = one.cell.observable == other.cell.observable and one.cell.moment == other.cell.moment
    trends = one.cell.place.trend or other.cell.place.trend
    apart = one.effect.low > other.effect.high or other.effect.low > one.effect.high
    return one.cell == other.cell if trends else same and not apart


def nameless_lines(diagnosis: Diagnosis) -> list[str]:
    """Return which library effects the new simulator has although they are not stated as causes."""
    selection = diagnosis.selection
    every = beyond_names(selection.added, selection.verdicts)
    if not every:
        return []
    where = "new simulator" if diagnosis.simulator else "simulated table with what was found"
    return [
        f"**In the {where}, but not stated as causes** (held-out links fit better with them, "
        "but they do not reproduce enough of what they act on, or remove too little):",
        *(f"- {effect.name}: {_short(effect)}" for effect in every),
    ]


def left_lines(diagnosis: Diagnosis) -> list[str]:
    """Return what still differs, beyond doubt, beside names after which nothing is called unknown.

    Levels, say, of a device that is named for its delay: too little for a cause of its own. Of
    ranges and levels; with waveforms, of which hundreds of figures always differ, of ranges and of
    receive levels in all rows.
    """
    selection = diagnosis.selection
    last = selection.rounds[-1]
    unknown = any(isinstance(verdict, Unknown) for verdict in selection.verdicts)
    if unknown or last.added or last.strike or diagnosis.law or not selection.names:
        return []
    sure = [one for one in last.located.findings if one.p <= SURE_P]
    if diagnosis.options.waveform:
        sure = [one for one in sure if one.cell.observable == RANGE or _all_levels(one.cell)]
    lines = finding_lines(sorted(sure, key=lambda one: one.cell.observable != RANGE), SHOWN_LEFT)
    lines += [f"- {selection.left_note}"] if lines and selection.left_note else []
    head = THEIRS if selection.mean else "Beside that still differs, without a name"
    return [f"**{head}:**", *lines] if lines else []


def _all_levels(cell: Cell) -> bool:
    """Return whether receive levels are compared in all rows."""
    return cell.observable == LEVEL and cell.place == Place()


def _behind(nats: float) -> str:
    """Return how far something is behind, in words: what fits better and costs more is ahead."""
    return f"{abs(nats):.1f} nats {'ahead' if round(nats, 1) < 0 else 'behind'}"


def law_lines(law: FoundLaw) -> list[str]:
    """Return a law without a name: figures, evidence, what else it could be, likeliest first."""
    rivals = sorted(law.rivals, key=lambda rival: (not rival.listed, rival.behind))
    more = len(rivals) - SHOWN_RIVALS
    return [
        f"**{law}**{' (intervals: 90 %)' if '..' in law.words else ''}.",
        f"As an effect of the simulator: error = {law.effect.formula.shown}",
        f"On sealed links it gains {law.gain_nats} and brings ranges {law.nearer_m} nearer.",
        *(
            f"- not excluded: {rival.words} ({_behind(rival.behind)})"
            for rival in rivals[:SHOWN_RIVALS]
        ),
        *([f"- and {more} more laws: not_excluded in diagnosis.json"] if more > 0 else []),
        *(law_lines(law.beside) if law.beside else []),
    ]


def _option_lines(option: LeftOut, does: Mapping[str, str]) -> list[str]:
    """Return one named effect: what it does, its parameters, its evidence."""
    effect = option.effect
    out = [f"- {option.names[0]}: {type(effect).signature} (source: {type(effect).source})"]
    if (words := does.get(option.names[0])) is not None:
        out += [f"  - does to these recordings: {words}"]
    if not option.tried:
        return [*out, f"  - {option.note}: it has no values and no evidence of its own"]
    out += [f"  - {option.note}"] if option.note else []
    out += parameter_lines(option.parameters, type(effect)) + beside_values(effect)
    if not option.parameters:
        out += [f"  - {_short(effect)}"]
    out += [f"  - {option.judged}: {option.gain}"]
    if option.control.left is not None:
        out += [f"  - negative control ({option.control.words}): {_control(option.control)}"]
    return out


def _control(control: Control) -> str:
    """Return what is left where an effect must vanish, in words that the interval bears out."""
    left = control.left
    if control.passed is None:
        return f"not decided (one in twenty such intervals excludes zero by chance), left {left}"
    if not control.passed:
        return f"FAILED, left {left}"
    if left is not None and left.high < 0:
        return f"passed, nothing is longer there (shorter, which the name leaves open: {left})"
    if left is not None and left.low > 0:
        return f"little is left there beside what is elsewhere, but not nothing: {left}"
    return f"passed, left {left}"


def _short(effect: Effect) -> str:
    """Return the fields of an effect with their units, long lists rounded."""
    items = type(effect).parameters()
    units = {one.name: f" {one.unit}" for one in items if one.unit not in PURE}

    def shown(value: Any) -> str:
        if isinstance(value, tuple):
            return "[" + ", ".join(shown(item) for item in value) + "]"
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    return "; ".join(
        f"{name} = {shown(value)}{units.get(name, '')}" for name, value in vars(effect).items()
    )
