"""Training on some data sets and testing on another: what is asked, checked and made ready."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bench.errors import BenchError
from bench.recordings.combine import combine, shared_rows
from bench.recordings.draws import Roles
from bench.recordings.open import Table
from bench.recordings.splits import Split
from bench.recordings.table import Recordings
from bench.runner.fits import new_model
from bench.runner.further import not_further
from bench.runner.inputs import missing
from bench.runner.material import Material, load_material
from bench.runner.observer import Observer
from bench.runner.plan import Plan
from bench.runner.tables import open_any

if TYPE_CHECKING:
    from zoo.base import MitigationModel

DEFAULT_DRAWS = 5
MOST_SHARED = 0.2  # of the tested rows found again among those trained on


@dataclass(frozen=True)
class Across:
    """What is to be trained on, pretrained on and tested on.

    `links`: how many links of `test` are trained on too, one run each; empty: none are.
    """

    test: Table
    train: tuple[Table, ...] = ()
    pretrain: tuple[Table, ...] = ()
    links: tuple[int, ...] = ()
    draws: int = DEFAULT_DRAWS


def asked(
    data: Table,
    train: Table | Sequence[Table] | None,
    test: Table | None,
    pretrain: Table | Sequence[Table] | None,
    finetune: str | None,
    links: int | str | Sequence[int] | None,
    draws: int,
) -> Across | None:
    """Return what the arguments of `bench.run` ask for; None where it is a plain run.

    Raises BenchError for arguments that do not go together or are no numbers.
    """
    if all(one is None for one in (train, test, pretrain, finetune, links)):
        return None
    if draws < 1:
        raise BenchError(f"--draws {draws}: expected a whole number of at least 1")
    if (pretrain is None) != (finetune is None):
        raise BenchError(
            "--pretrain and --finetune go together: --pretrain SIM.toml --finetune C:4"
        )
    if finetune is not None:
        if train is not None or test is not None or links is not None:
            raise BenchError(
                "--finetune C:k names data and links; leave out --train, --test, --links"
            )
        target, count = _target(finetune)
        return Across(target, (), _specs(pretrain), count, draws)
    if (train is None) != (test is None):
        raise BenchError("--train and --test go together: --train A,B --test C")
    return Across(data if test is None else test, _specs(train), (), _counts(links), draws)


def _specs(text: Table | Sequence[Table] | None) -> tuple[Table, ...]:
    """Return the data sets of a text with commas, or of a sequence."""
    if isinstance(text, Recordings | Path | pd.DataFrame):
        return (text,)
    if not isinstance(text, str):
        return tuple(text or ())
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _target(text: str) -> tuple[str, tuple[int, ...]]:
    """Return data set and links of `C:k` or `C:k1,k2`. Raises BenchError where it is neither."""
    name, colon, count = text.rpartition(":")
    if not colon or not name or not count.strip():
        raise BenchError(f"--finetune {text}: expected DATA:LINKS, such as apartment:4")
    return name, _counts(count)


def _counts(links: int | str | Sequence[int] | None) -> tuple[int, ...]:
    """Return the numbers of links. Raises BenchError where one is none."""
    if links is None:
        return ()
    words = links.split(",") if isinstance(links, str) else links
    words = [words] if isinstance(words, int) else words
    found = []
    for word in words:
        if not str(word).strip().isdecimal():
            raise BenchError(f"--links {word}: expected whole numbers, such as 1,2,4")
        found.append(int(word))
    return tuple(dict.fromkeys(found))


def ready(
    across: Across, split: str | None, plan: Plan, watch: Observer
) -> tuple[Plan, list[Material]]:
    """Return the models that can be used, and what each number of links gives to train and test.

    A model that a table has no inputs for, or that cannot be trained further after pretraining,
    is left out with a note. Raises BenchError where none is left, a data set is trained and tested
    on as a whole, there are too few links, or a split is named too.
    """
    if split is not None:
        raise BenchError(f"--split {split}: training across data splits by itself; leave it out")
    parts, roles = _parts(across)
    plan = _usable(plan, parts, roles, watch)
    counts: Sequence[int | None] = across.links or [None]
    needed = {*roles.train, *roles.pretrain, roles.test}
    table = combine({name: parts[name] for name in parts if name in needed}, roles.test)
    chosen = [replace(roles, links=k, draws=1 if k is None else across.draws) for k in counts]
    return plan, [load_material(table, one.split) for one in chosen]


def _parts(across: Across) -> tuple[dict[str, Recordings], Roles]:
    """Return every table by name, simulated ones marked, and what each is for."""
    parts: dict[str, Recordings] = {}

    def opened(spec: Table) -> str:
        name, recordings = open_any(spec)
        shown = f"{name} (SIMULATED)" if recordings.simulated and spec is not across.test else name
        parts[shown] = recordings
        return shown

    test = opened(across.test)
    train, before = tuple(map(opened, across.train)), tuple(map(opened, across.pretrain))
    for name in (*train, *before):
        if name == test or shared_rows(parts[name], parts[test]) > MOST_SHARED:
            raise BenchError(
                f"{name} is trained on, and {test} tested on, but they hold the same measurements; "
                "expected another data set, or --links for some of its links"
            )
    return parts, Roles(test, train, before)


def _usable(plan: Plan, parts: dict[str, Recordings], roles: Roles, watch: Observer) -> Plan:
    """Return the plan without the models that cannot do this. Raises BenchError where none can."""
    problems = {model.name: _problem(new_model(model, 0), parts, roles) for model in plan.models}
    left = tuple(model for model in plan.models if not problems[model.name])
    if not left:
        raise BenchError("; ".join(f"{name}: {why}" for name, why in problems.items()))
    for name, problem in problems.items():
        if problem:
            watch.note(f"{name} skipped: {problem}")
    return replace(plan, models=left)


def _problem(model: MitigationModel, parts: dict[str, Recordings], roles: Roles) -> str | None:
    """Return why a model cannot be trained and tested on these tables, None where it can."""
    if roles.pretrain and (problem := not_further(model)):
        return problem
    for name, part in parts.items():
        if problem := missing(_without_rows(name, part), type(model)):
            role = "tested on" if name == roles.test else "trained on"
            return f"{problem} ({'pretrained on' if name in roles.pretrain else role})"
    return None


def _without_rows(name: str, part: Recordings) -> Material:
    """Return a table as material to ask what it has; nothing is cut or split."""
    cirs = np.empty((0, int("cir" in part.frame)), np.float32)
    nothing = np.empty(0, np.float32)
    return Material(name, part, "", cirs, nothing, nothing.astype("U"), Split("", ()), {})
