"""A plan: for every open question the measurements, ranked, and how many links of each."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.report.evidence import Evidence
from bench.physics.simulator import Simulator
from bench.planning.alternatives import Alternative, Past, alternative
from bench.planning.choose import Scale, Worth, chosen, probability, ranked
from bench.planning.measurements import REPEAT, Measurement, measurements, reference_row
from bench.planning.outlook import Counts, Outlook, outlook
from bench.planning.questions import Question
from bench.planning.scatter import Scatter
from bench.planning.settings import (
    BEHIND_NATS,
    CHANCE_STD,
    LEAST_NATS,
    LINK_NATS,
    MOST_ALTERNATIVES,
    ROWS_PER_LINK,
    SURE_NATS,
    WAVE_ROWS,
)
from bench.planning.strays import of_one_device, stray_links
from bench.planning.trends import trends
from bench.planning.words import expected
from bench.planning.world import World


@dataclass(frozen=True)
class Answer:
    """The plan for one question.

    `offered` [c] are the measurements, `worth` what each brings alone (best first), `links` [c]
    how many of each are planned, with `rows` rows each, measured as in `reference` but for what
    is planned; `progress` are the nats that this brings towards an answer. `note` says why there
    is no plan. `observables` [p] are what predictions are about.
    """

    question: str
    names: tuple[str, ...]
    offered: tuple[Measurement, ...] = ()
    worth: tuple[Worth, ...] = ()
    links: tuple[int, ...] = ()
    rows: int = 0
    note: str = ""
    outlook: Outlook | None = None
    reference: pd.Series | None = None
    progress: float = 0.0
    observables: tuple[str, ...] = ()

    @property
    def nats(self) -> dict[str, float]:
        """Expected nats of the planned links for each pair, whichever of the two is true."""
        if self.outlook is None:
            return {}
        found = self.outlook.nats(np.array(self.links))
        every = combinations(range(len(self.names)), 2)
        return {f"{self.names[a]} | {self.names[b]}": float(min(found[a, b], found[b, a]))
                for a, b in every}  # fmt: skip

    @property
    def probability(self) -> float:
        """How likely the right explanation ends ahead of every other beyond doubt."""
        return probability(self.progress)

    @property
    def sure(self) -> bool:
        """Whether that is expected in 95 % of cases."""
        return self.progress >= SURE_NATS

    def planned(self) -> list[tuple[Measurement, int]]:
        """Return the measurements to make, with how many links of each."""
        return [(m, n) for m, n in zip(self.offered, self.links, strict=True) if n]

    def why(self, measurement: Measurement) -> str:
        """Return what each explanation predicts for a measurement, in words."""
        assert self.outlook is not None
        return expected(self.outlook, self.observables, self.offered.index(measurement))

    def geometry(self, prefix: str = "plan") -> pd.DataFrame:
        """Return one row for every range to record, with all that is known before measuring."""
        assert self.reference is not None
        frames = [
            measurement.rows(self.reference, self.rows, f"{prefix} {place}.{number}")
            for place, (measurement, count) in enumerate(self.planned())
            for number in range(count)
        ]
        return pd.concat(frames, ignore_index=True)

    def summary(self) -> dict[str, Any]:
        """Return the answer as plain data; keys carry units."""
        return {
            "question": self.question,
            "explanations": list(self.names),
            "note": self.note,
            "expected_nats": self.nats,
            "probability_of_95_percent": self.probability if self.offered else None,
            "rows_per_link": self.rows,
            "plan": [
                _described(m) | {"links": n, "expected": self.why(m)} for m, n in self.planned()
            ],
            "measurements": [_described(self.offered[w.place]) | _worth(w) for w in self.worth],
        }


@dataclass(frozen=True)
class MeasurementPlan:
    """What to measure next: one answer for every question that a diagnosis leaves open."""

    diagnosis: str
    headline: str
    answers: tuple[Answer, ...]

    def frame(self) -> pd.DataFrame:
        """Return one row for every planned link: what to set, and how many rows to record."""
        made: list[dict[str, Any]] = []
        for answer in self.answers:
            for measurement, count in answer.planned():
                row: dict[str, Any] = {"question": answer.question, "rows": answer.rows}
                row |= _described(measurement) | {"expected": answer.why(measurement)}
                made += [row] * count
        table = pd.DataFrame(made)
        table.insert(0, "planned_link", [f"plan {n + 1}" for n in range(len(made))])
        return table[[*(name for name in table if name != "expected"), "expected"]]

    def summary(self) -> dict[str, Any]:
        """Return the plan as plain data."""
        answers = [answer.summary() for answer in self.answers]
        return {"diagnosis": self.diagnosis, "headline": self.headline, "questions": answers}


def _described(measurement: Measurement) -> dict[str, Any]:
    return {"knob": measurement.knob, "measurement": measurement.words, **measurement.settings}


def _worth(worth: Worth) -> dict[str, Any]:
    known = asdict(worth)
    return {
        "nats_per_link": known["nats"],
        "nats_per_link_least": known["least_nats"],
        "nats_per_link_most": known["most_nats"],
        "tells_best": list(worth.best),
        "links_for_95_percent": worth.links,
    }


def answer(
    question: Question, evidence: Evidence, simulator: Simulator, links: int | None, seed: int
) -> Answer:
    """Return the plan for one question; deterministic from the seed."""
    waveform = "first_path_power_dbm" in evidence.names
    evidence = evidence.thinned(WAVE_ROWS) if waveform else evidence
    past = Past(World(simulator, evidence.names, waveform), evidence)
    if question.fault:
        note = f"{question.fault}: put that right, record a few links again, and diagnose again"
        return Answer(question.words, (), note=note)
    if first := _before(past, question):
        return Answer(question.words, (), note=first)
    every, noise = _alternatives(past, question, seed)
    names = tuple(one.name for one in every)
    if len(every) < 2:
        return Answer(question.words, names, note=_alone(names))
    offered = measurements(evidence.frame, simulator.base)
    reference, rows = reference_row(evidence.frame), _rows_per_link(evidence)
    seen = outlook(past.world, every, offered, reference, rows, noise, question.rest)
    scale = Scale.of(seen, len(offered))
    every_worth = ranked(scale)
    repeats = [w.nats for w in every_worth if offered[w.place].knob == REPEAT]
    if question.options and min(repeats) > LINK_NATS / 2 and len(evidence.names) > 1:
        # Levels would tell, but the diagnosis had such rows and was not settled by them.
        return answer(question, evidence.only(RANGE), simulator, links, seed)
    least = float(np.mean(repeats)) + CHANCE_STD * float(np.std(repeats)) + LEAST_NATS
    worth = [w for w in every_worth if w.nats > least and offered[w.place].knob != REPEAT]
    if not worth:
        return Answer(question.words, names, note=_same(question))
    counts = chosen(scale, links, [one.place for one in worth])
    progress = float(scale.progress(counts).min())
    return Answer(question.words, names, offered, tuple(worth), _plain(counts), rows,
                  outlook=seen, reference=reference, progress=progress,
                  observables=evidence.names)  # fmt: skip


def _same(question: Question) -> str:
    """Return what is said where no setting tells explanations apart, with what else may."""
    note = "no setting that this plan can vary tells them apart: they predict the same"
    return note + (f"; what may: {question.separate}" if question.separate else "")


def _plain(counts: Counts) -> tuple[int, ...]:
    return tuple(int(n) for n in counts)


def _alternatives(
    past: Past, question: Question, seed: int
) -> tuple[tuple[Alternative, ...], Scatter]:
    """Return the explanations in question and the noise beside them."""
    if not question.options:
        found = (*_law(question), *trends(past, question.rest, seed))
        best = found[0].draws[0] if found else question.rest
        return found, past.noise(best)
    noise = past.noise((*question.rest, question.options[0]))
    every = (*question.options, *question.near)[:MOST_ALTERNATIVES]
    made = [alternative(past, question.rest, one, noise, seed) for one in every]
    return _likely(past, made, len(question.options), noise), noise


def _law(question: Question) -> tuple[Alternative, ...]:
    """Return the law that a diagnosis found, if it found one."""
    draws = tuple((*question.rest, law) for law in question.law)
    return (Alternative(f"law: {question.law[0].expression}", draws),) if draws else ()


def _likely(
    past: Past, made: list[Alternative], asked: int, noise: Scatter
) -> tuple[Alternative, ...]:
    """Return the explanations in question, and of the others those not far behind the best."""
    scores = [max(past.log_likelihood(added, noise) for added in one.draws) for one in made]
    least = max(scores) - BEHIND_NATS
    return tuple(
        one
        for place, (one, score) in enumerate(zip(made, scores, strict=True))
        if place < asked or score > least
    )


def _before(past: Past, question: Question) -> str:
    """Return what to do about something without a name before a plan helps, "" where one does."""
    if question.options or question.law:
        return ""
    return (
        of_one_device(question.seen)
        or _elsewhere(question, past.evidence)
        or stray_links(past, question.rest)
    )


def _elsewhere(question: Question, evidence: Evidence) -> str:
    """Return that what has no name shows in nothing that is predicted here, "" where it does."""
    if not question.seen or any(one.observable in evidence.names for one in question.seen):
        return ""
    first = question.seen[0]
    return (
        f"it shows in {first.what} {first.where}, not in ranges or levels, and nothing predicts "
        "that without a name, so no measurement can be ranked. Record the same links "
        "again with one thing changed at a time (the place or height of one antenna, its heading, "
        "what stands near it), and diagnose again"
    )


def _alone(names: tuple[str, ...]) -> str:
    if names:
        return f"only one explanation is left to try: {names[0]}; vary that, all else as it is"
    return "nothing was recorded that varies and could be changed: vary distance or settings"


def _rows_per_link(evidence: Evidence) -> int:
    """Return how many rows a planned link has: as many as a recorded one, within reason."""
    typical = float(np.median(np.bincount(evidence.links)))
    return int(np.clip(typical, *ROWS_PER_LINK))
