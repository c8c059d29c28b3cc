"""The first line of a diagnosis: what was found, and what it does on sealed links."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from bench.discrepancy.confirm import Confirmed, is_farther
from bench.discrepancy.law.found import FAULT, LAW
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.select.one_device import all_at_device, left_at_device
from bench.discrepancy.select.verdict import Unknown, Verdict
from bench.discrepancy.settings import NEARER_SHARE
from bench.physics.effects.ranging.antenna_delay import AntennaDelay

NOT_ADDED: Final = "Nothing was added to the simulator"
WITHHELD: Final = "was not added"
NEW_SIMULATOR, NEW_TABLE = "The new simulator", "The simulated table with it"
Findings = tuple[Finding, ...]
NOTHING: Final[Mapping[str, str]] = MappingProxyType({})
TOLD = (FAULT, LAW)
OWN_FORM: Final = ", in a form of its own beside the library's"


def headline(
    verdicts: tuple[Verdict, ...],
    added: bool,
    seen: Confirmed,
    more: str = "",
    withheld: Mapping[str, str] = NOTHING,
    changed: str = NEW_SIMULATOR,
) -> str:
    """Return one line: what was found, and whether it serves on the sealed links.

    `more` is said of what has no name; `withheld` says what was not added, or not whole, and
    why; `changed` is what has it now.
    """
    said = _found_and_change(verdicts, added, seen, more, _with(changed, verdicts, withheld))
    kept = "".join(f" {name} {words}." for name, words in withheld.items())
    return said.partition(f" {NOT_ADDED}")[0] + kept if kept else said


def or_elsewhere(names: tuple[tuple[str, ...], ...], devices: tuple[str, ...]) -> str:
    """Return that a device may stand elsewhere instead of being late, "" where none may."""
    if not devices or not any(AntennaDelay.name in one for one in names):
        return ""
    who = " or ".join(devices)
    return f" Instead of the delay {who} may stand elsewhere: these recordings cannot tell."


def _with(changed: str, verdicts: tuple[Verdict, ...], withheld: Mapping[str, str]) -> str:
    """Return what has changed, with what it has where something that was named is not in it."""
    if not withheld:
        return changed
    first = [verdict.names[0] for verdict in verdicts if verdict.names]
    lacks = [name for name, words in withheld.items() if words.startswith(WITHHELD)]
    has = ", ".join(name for name in first if name not in lacks) or "what has no name"
    told = f", but not {', '.join(lacks)}," if lacks else ""
    return f"{changed.removesuffix(' with it')} with {has}{told}"


def _found_and_change(
    verdicts: tuple[Verdict, ...], added: bool, seen: Confirmed, more: str, changed: str
) -> str:
    said = _found(verdicts, more)
    if not said:
        return "Nothing found that the simulator leaves out."
    if not added:
        named = any(verdict.names for verdict in verdicts)
        return f"{said}. {NOT_ADDED}{': held-out links fit no better with it' if named else ''}."
    change = _change(seen)
    if not seen.serves:
        why = "its score is not better" if seen.gain.value <= 0 else "ranges are worse"
        why += f", in the median {_medians(seen)}" if _only_median(seen) else ""
        return f"NOT RECOMMENDED: {said}, but with it added {why} ({change})."
    sure = "" if seen.gain.above_zero else ", though not beyond doubt"
    alike = "" if seen.nearer_m.low > 0 else f" in {seen.better} (by its score), {_alike(seen)}"
    return f"{said}. {changed} fits better{sure}{alike}{seen.easier}: {change}."


def _found(verdicts: tuple[Verdict, ...], more: str) -> str:
    """Return in words what was found, "" where nothing was; `more` is of what has no name.

    A law or a fault of the set-up stands for itself; beside names alone it says more of one.
    """
    names = _listed([v.names for v in verdicts if v.names])
    unknown = [verdict for verdict in verdicts if isinstance(verdict, Unknown)]
    told = f" ({more})" if more else ""
    if not unknown:
        own = OWN_FORM if more and not more.startswith(TOLD) else ""
        return f"Left out: {names}{own}{told}" if names else ""
    if more.startswith(TOLD):
        return f"Left out: {names} - and {more}" if names else more[0].upper() + more[1:]
    cause = "".join(f": {one.cause}" for one in unknown if one.cause)
    if not names:
        return f"Something is there, without a name{cause}{told or _weak(verdicts)}"
    found = f"Left out: {names}{cause} - and something without a name"
    return found + (told or _device(verdicts))


def _listed(groups: list[tuple[str, ...]]) -> str:
    """Return names in words, those of a class among others in brackets: one of them is there."""
    words = [" or ".join(group) for group in groups]
    if len(groups) > 1:
        words = [f"({w})" if len(g) > 1 else w for w, g in zip(words, groups, strict=True)]
    return ", ".join(words)


def _alike(seen: Confirmed) -> str:
    """Return in words how ranges are where chance may be all that brought them nearer."""
    nearer = seen.mae_after_m.value < NEARER_SHARE * seen.mae_before_m.value
    return (
        "ranges nearer, though not beyond chance"
        if nearer
        else "ranges as far off as before, within chance"
    )


def _device(verdicts: tuple[Verdict, ...]) -> str:
    """Return at which device something without a name shows beside names, "" where at none."""
    seen = _first(verdicts, left_at_device)
    return f" ({seen.what} {seen.cell.place.where()})" if seen else ""


def _weak(verdicts: tuple[Verdict, ...]) -> str:
    """Return at which device, and how much, all that has no name shows, "" where at none."""
    seen = _first(verdicts, all_at_device)
    return f" ({seen.what} {seen.effect} {seen.cell.place.where()})" if seen else ""


def _first(verdicts: tuple[Verdict, ...], at: Callable[[Findings], Findings]) -> Finding | None:
    """Return the first finding without a name or a cause that is `at` a device, None where none."""
    unknown = (one for one in verdicts if isinstance(one, Unknown) and not one.cause)
    return next((found for one in unknown for found in at(one.findings)), None)


def _only_median(seen: Confirmed) -> bool:
    """Return whether the median of the range error alone speaks against it."""
    means = seen.mae_before_m.value, seen.mae_after_m.value
    return seen.gain.value > 0 and not is_farther(seen.nearer_m, means, (0.0, 0.0))


def _medians(seen: Confirmed) -> str:
    return f"{seen.median_before_m.value:.3g} -> {seen.median_after_m.value:.3g} m"


def _change(seen: Confirmed) -> str:
    """Return in words how far ranges were off before and after."""
    before, after = f"{seen.mae_before_m.value:.3g}", f"{seen.mae_after_m.value:.3g}"
    means = f"{before} m before and after" if before == after else f"{before} -> {after} m"
    worse = seen.median_after_m.value > seen.median_before_m.value
    more = f", in the median {_medians(seen)}" if worse and seen.serves else ""
    return f"mean |recorded - simulated| {means}{more} on sealed links"
