"""The report of a diagnosis: Markdown, JSON, and the new simulator as TOML."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from bench.discrepancy.compare.calibration import auc_doubt
from bench.discrepancy.compare.radio import SETTINGS
from bench.discrepancy.data.own_columns import RULE
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.law.found import fault_dict, law_dict
from bench.discrepancy.report.evidence import write_evidence
from bench.discrepancy.report.figures import draw
from bench.discrepancy.report.folder import REPORT
from bench.discrepancy.report.found_lines import (
    finding_lines,
    found_lines,
    left_lines,
    nameless_lines,
)
from bench.discrepancy.report.parameters import (
    skipped_lines,
    value_table,
)
from bench.discrepancy.select.state import Round
from bench.discrepancy.select.verdict import (
    as_dict,
)
from bench.files import write_atomically
from bench.physics.effect import Effect
from bench.physics.toml_file import to_toml
from bench.text import named, plain, unlinked

PLACES = (
    "Antennas move under one link name: {} links were cut into {} places of 1 m, the unit that is "
    "held out. Places of one drive are neighbours: intervals may be too narrow."
)


def write_report(diagnosis: Diagnosis, folder: Path) -> Path:
    """Write report.md, diagnosis.json, simulator.toml (where there is one) and the figures.

    Returns the report's path. Raises BenchError where the folder cannot be written.
    """
    figures = draw(diagnosis, folder)
    if diagnosis.simulator is not None:
        write_atomically(folder / "simulator.toml", to_toml(diagnosis.simulator))
    if diagnosis.evidence is not None:
        write_evidence(diagnosis.evidence, folder)
    write_atomically(folder / REPORT, json.dumps(summary(diagnosis), indent=1) + "\n")
    path = folder / "report.md"
    write_atomically(path, plain(markdown(diagnosis, figures)))
    return path


def summary(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the diagnosis as plain data; keys carry units."""
    seen = diagnosis.confirmed
    return {
        "recorded": diagnosis.source,
        "simulated": diagnosis.simulated,
        "headline": diagnosis.headline,
        "recommended": diagnosis.recommended,
        "base": {name: getattr(diagnosis.base, name) for name in SETTINGS},
        "rows": list(diagnosis.counted),
        "rows_without_counterpart": diagnosis.uncovered,
        "seed": diagnosis.options.seed,
        "hidden": list(diagnosis.options.hide),
        "measured_columns": list(diagnosis.measured),
        "verdicts": [as_dict(verdict) for verdict in diagnosis.selection.verdicts],
        "law": law_dict(diagnosis.law),
        "setup_fault": fault_dict(diagnosis.setup_fault),
        "tried": [_tried(turn) for turn in diagnosis.selection.rounds],
        "skipped_effects": dict(diagnosis.selection.skipped),
        "covariate_mix": {k: {"shift_std": s, "p": p} for k, (s, p) in diagnosis.mix.items()},
        "confirm": {
            "links": seen.links,
            "rows": seen.rows,
            "gain_nats": vars(seen.gain),
            "range_mae_before_m": vars(seen.mae_before_m),
            "range_mae_after_m": vars(seen.mae_after_m),
            "range_median_before_m": vars(seen.median_before_m),
            "range_median_after_m": vars(seen.median_after_m),
            "range_p90_before_m": vars(seen.high_before_m),
            "range_p90_after_m": vars(seen.high_after_m),
            "auc_before": seen.auc_before,
            "auc_after": seen.auc_after,
            "rank_distance_before": seen.ranks_before,
            "rank_distance_after": seen.ranks_after,
        },
        "simulator_toml": None if diagnosis.simulator is None else to_toml(diagnosis.simulator),
    }


def _tried(turn: Round) -> list[dict[str, Any]]:
    """Return what competed in a round as plain data, best first."""
    every = turn.explanation.contenders if turn.explanation else ()
    return [
        {"effect": c.effect.name, "values": dict(vars(c.effect)), "gain_nats": c.gain.value}
        for c in every
    ]


def markdown(diagnosis: Diagnosis, figures: list[tuple[str, str]]) -> str:
    """Return the report as Markdown."""
    lines = [f"# Diagnosis: {diagnosis.simulated} against {diagnosis.source}", ""]
    lines += [f"**{diagnosis.headline}**", "", _base_line(diagnosis), ""]
    told = (*diagnosis.counted, *measured_lines(diagnosis))
    lines += [part for line in told for part in (line, "")]
    lines += ["## What was found", ""]
    lines += [part for told in found_lines(diagnosis) for part in (*told, "")]
    lines += [part for line in nameless_lines(diagnosis) for part in (line, "")]
    lines += [*left, ""] if (left := left_lines(diagnosis)) else []
    lines += _confirm_lines(diagnosis) + _mix_lines(diagnosis) + _search_lines(diagnosis)
    pictures = [f"![{caption}]({name})\n*{caption}.*\n" for name, caption in figures]
    more = value_table(diagnosis.selection.verdicts, diagnosis.simulator is not None)
    more += _method_lines(diagnosis)
    return "\n".join([*_safe(lines), "## Pictures", "", *pictures, *_safe(more)]) + "\n"


def _safe(lines: Iterable[str]) -> list[str]:
    """Return lines in which names of devices, which may hold anything, begin nothing of their own.

    Neither a line, nor a tag, nor a link.
    """
    return [unlinked(named(line)) for line in lines]


def _base_line(diagnosis: Diagnosis) -> str:
    """Return the radio settings that levels were computed with."""
    base = diagnosis.base
    return (
        f"Levels are those of channel {base.channel}, {base.prf_mhz} MHz pulse repetition and "
        f"{base.tx_power_dbm:g} dBm radiated (from the recordings where they have the columns "
        "channel, prf_mhz and tx_power_dbm, else the simulator's, or the defaults beside a table)."
    )


def measured_lines(diagnosis: Diagnosis) -> list[str]:
    """Return what was decided for the user: links cut, columns that were taken as measured."""
    before, after = diagnosis.links
    out = [PLACES.format(before, after)] if after > before else []
    said = [name for name in diagnosis.measured if name in diagnosis.options.measured]
    guessed = [name for name in diagnosis.measured if name not in said]
    for names, why in ((said, "you said so"), (guessed, RULE)):
        out += [f"Measured, so not searched over: {', '.join(names)} ({why})."] if names else []
    if diagnosis.options.known:
        why = "you said so, or it explains what was missing and nothing of the scatter"
        out += [f"Known before ranges are measured: {', '.join(diagnosis.options.known)} ({why})."]
    return out


def _untouched(told: tuple[str, ...]) -> str:
    """Return what sealed links were used for before this table: to tell some names, or nothing."""
    if not told:
        return "Nothing was searched, fitted or chosen on these links."
    which = f"which of {' or '.join(told)} is added: other links do not tell them apart"
    return f"Nothing was searched or fitted on these links. They told {which}."


def _confirm_lines(diagnosis: Diagnosis) -> list[str]:
    """Return the before and after table of the confirm links."""
    seen = diagnosis.confirmed
    return [
        f"## Before and after, on {seen.links} confirm links ({seen.rows} rows)",
        "",
        _untouched(diagnosis.selection.sealed_choice),
        "",
        "| | before | after |",
        "| --- | --- | --- |",
        f"| mean abs. (recorded - simulated) range error | {seen.mae_before_m} "
        f"| {seen.mae_after_m} |",
        f"| its median | {seen.median_before_m} | {seen.median_after_m} |",
        f"| its 90th percentile | {seen.high_before_m} | {seen.high_after_m} |",
        f"| recorded told from simulated, AUC (0.5 = cannot){auc_doubt(seen.links)} "
        f"| {seen.auc_before:.3f} "
        f"| {seen.auc_after:.3f} |",
        f"| ensemble ranks, distance from uniform | {seen.ranks_before:.3f} "
        f"| {seen.ranks_after:.3f} |",
        "",
        f"Gain of the proper score: {seen.gain}.",
        "",
    ]


def _mix_lines(diagnosis: Diagnosis) -> list[str]:
    """Return what differs in the mix of covariates, where tables were compared."""
    if not diagnosis.mix:
        return []
    out = ["## The mix of covariates (not physics)", ""]
    if diagnosis.uncovered:
        out += [
            f"{diagnosis.uncovered:.0%} of the recorded rows have no simulated counterpart: they "
            "took no part, and nothing is said about them.",
            "",
        ]
    for name, (shift, p) in diagnosis.mix.items():
        out += [
            f"- {name}: recorded - simulated = {shift:+.2f} standard deviations of the recorded "
            f"links' means, p = {p:.3g}"
        ]
    return [*out, ""]


def _search_lines(diagnosis: Diagnosis) -> list[str]:
    """Return the search, round by round."""
    out = ["## The search", ""]
    for number, turn in enumerate(diagnosis.selection.rounds, 1):
        state = "nothing significant" if not turn.located.significant else "differs:"
        out += [f"Round {number} ({turn.located.cells} places searched): {state}", ""]
        out += finding_lines(turn.located.findings, 4)
        if turn.explanation:
            for one in turn.explanation.contenders:
                out += [f"- tried {one.name}: gain {one.gain}"]
        out += [f"- {_what_was_added(diagnosis, turn.added)}", ""]
    for line in skipped_lines(diagnosis.selection.skipped):
        out += [line[0].upper() + line[1:], ""]
    return out


def _what_was_added(diagnosis: Diagnosis, effect: Effect | None) -> str:
    """Return what a round added, and whether that stayed."""
    if effect is None:
        return "nothing added"
    stayed = any(known.physics == effect.physics for known in diagnosis.added)
    return f"**added: {effect.name}**" if stayed else f"added: {effect.name}, removed again later"


def _method_lines(diagnosis: Diagnosis) -> list[str]:
    """Return how to read the figures."""
    shared = (
        " Links are few: search and fit used alternate stretches of the same links."
        if diagnosis.split.shared
        else ""
    )
    return [
        "## How to read this",
        "",
        f"{diagnosis.split.links} links were split once (seed {diagnosis.options.seed}) into "
        "discover, fit and confirm; the confirm links were opened once, for the table above."
        f"{shared} p values hold for the whole search (permutation over links, maximum "
        "statistic). Gain: weighted sum over observables of log(CRPS before / CRPS after); 0.1 in "
        "one observable is a tenth off its score. Intervals come from resampling links.",
        "Every simulated figure is SIMULATED.",
    ]
