"""What a diagnosis leaves open, read back from its folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.discrepancy.report.folder import INPUTS, REPORT, read_part
from bench.discrepancy.settings import ONE_SIDED_95
from bench.errors import BenchError
from bench.physics.effect import Effect
from bench.physics.effects.ranging.law import Law, with_constants
from bench.physics.simulator import Simulator
from bench.physics.toml_file import from_toml
from bench.planning.settings import NEAR_SHARE, WALKERS
from bench.planning.world import Added
from bench.plugins import load


@dataclass(frozen=True)
class Seen:
    """A difference without a name: `what` differs, and `where`, in words, and what these are of.

    `covariate` names the rows: a number's interval or trend, or a group; None where it is all.
    """

    what: str
    where: str
    observable: str
    covariate: str | None = None


@dataclass(frozen=True)
class Question:
    """Explanations that the recordings cannot tell apart, none where nothing known explains it.

    `rest` are the effects that are named beside it; `near` those that did nearly as well.
    `law` is the law that was found for it, drawn within its constants' intervals, and `fault` what
    was said of the set-up; `seen` are the findings that stay without a name; `separate` is what the
    diagnosis says that tells the options apart.
    """

    words: str
    options: Added
    rest: Added
    near: Added = ()
    law: tuple[Law, ...] = ()
    fault: str = ""
    seen: tuple[Seen, ...] = ()
    separate: str = ""


@dataclass(frozen=True)
class Asked:
    """What a diagnosis leaves open, and the simulator that it was about."""

    headline: str
    questions: tuple[Question, ...]
    simulator: Simulator


def read_questions(folder: Path) -> Asked:
    """Read what a diagnosis leaves open. Raises BenchError where there is none, or damaged."""
    report, inputs = read_part(folder, REPORT), read_part(folder, INPUTS)
    try:
        verdicts = list(report["verdicts"])
        made = [_options(verdict) for verdict in verdicts]
        law, fault = _law(report.get("law")), (report.get("setup_fault") or {}).get("words", "")
        asked = tuple(
            one if one.options else replace(one, law=law, fault=str(fault))
            for one in _questions(verdicts, made, report["tried"])
        )
        simulator = from_toml(inputs["simulator_toml"], str(folder / INPUTS))
        return Asked(str(report["headline"]), asked, simulator)
    except (KeyError, TypeError, AttributeError, ValueError) as problem:
        raise BenchError(
            f"{folder / REPORT}: not a diagnosis that can be planned from "
            f"({type(problem).__name__}: "
            f"{problem}); run `bench diagnose -o {folder}` again"
        ) from problem


def _questions(
    verdicts: Sequence[Mapping[str, Any]], made: Sequence[Added], tried: Sequence[Any]
) -> list[Question]:
    """Return a question for each verdict that leaves one open."""
    out = []
    for number, (verdict, options) in enumerate(zip(verdicts, made, strict=True)):
        others = [one for at, one in enumerate(made) if at != number and one]
        names = {effect.name for effect in options}
        rest = tuple(one[0] for one in others if one[0].name not in names)
        if verdict["verdict"] == "ambiguous" and len(options) > 1:
            words = " or ".join(effect.physics for effect in options)
            near, apart = _near(options, (*rest, *options), tried), str(verdict.get("separate", ""))
            out.append(Question(words, options, rest, near, separate=apart))
        elif verdict["verdict"] == "unknown":
            seen = tuple(map(_seen, verdict.get("located", ())))
            out.append(Question("what no known effect explains", options, rest, seen=seen))
    return out


def _seen(found: Mapping[str, Any]) -> Seen:
    """Return a difference as a diagnosis keeps it."""
    where, covariate = str(found["where"]), found["covariate"]
    of = None if covariate is None else str(covariate)
    return Seen(str(found["what"]), where, str(found["observable"]), of)


def _near(options: Added, have: Added, tried: Sequence[Any]) -> Added:
    """Return what else gained nearly as much in the round that named these options.

    A diagnosis of more rows may prefer one of them.
    """
    names = {effect.name for effect in options}
    turn = next((turn for turn in tried if turn and turn[0]["effect"] in names), ())
    least = NEAR_SHARE * max((one["gain_nats"] for one in turn), default=0.0)
    near = [_effect(one) for one in turn if one["gain_nats"] > max(least, 0.0)]
    known = {effect.physics for effect in have}
    return tuple(effect for effect in near if effect.physics not in known)


def _law(found: Mapping[str, Any] | None) -> tuple[Law, ...]:
    """Return a law with its constants as they were found and, again and again, as they may be."""
    if not found:
        return ()
    rng, constants = np.random.default_rng(0), found["constants"]
    values = [np.array([float(c["value"]) for c in constants])]
    stds = [(float(c["high"]) - float(c["low"])) / (2 * ONE_SIDED_95) for c in constants]
    values += [rng.normal(values[0], stds) for _ in range(WALKERS - 1)]
    return tuple(
        with_constants(
            found["expression"],
            ((c["name"], float(v), c["unit"]) for c, v in zip(constants, one, strict=True)),
        )
        for one in values
    )


def _options(verdict: Mapping[str, Any]) -> Added:
    """Return the effects that a verdict names, as they were fitted."""
    return tuple(_effect(option) for option in verdict.get("options", ()))


def _effect(option: Mapping[str, Any]) -> Effect:
    made = load("effects", option["effect"]).from_values(dict(option["values"]))
    if not isinstance(made, Effect):
        raise BenchError(f"effect {option['effect']!r}: the plug-in is no Effect")
    return made
