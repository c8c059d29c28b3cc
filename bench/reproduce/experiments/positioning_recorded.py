"""Positions from real ranges: the apartment's tags in the plane, the industrial hall's in space."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from bench.recordings.sources.base import open_source
from bench.reproduce.context import Context
from bench.reproduce.outcome import Figure, Row, Series, Table
from bench.reproduce.tags import SOLVERS, Floats, Tag, tags_of
from bench.results import Interval

DATA_SETS = ("apartment", "ghent")
EPOCHS = 100
QUICK_EPOCHS = 10
POOR_DOP = 3.0


@dataclass(frozen=True)
class Found:
    """A table of one data set and its picture, or a note that says why there is none."""

    table: Table | None = None
    figure: Figure | None = None
    note: str = ""


def recorded_tables(context: Context) -> Iterator[Found]:
    """Yield a table per real data set that is at hand, or the reason why there is none."""
    for name in DATA_SETS:
        if not _here(name):
            yield Found(
                note=f"{name} is not on this machine (`bench data fetch {name}`): no real ranges."
            )
        else:
            other = replace(context, data=name, split=None)
            yield from (_apartment(other) if name == "apartment" else _hall(other))


def _here(name: str) -> bool:
    return open_source(name).available() is None


def _apartment(context: Context) -> Iterator[Found]:
    """Yield the tags in 2-D, mitigated out of fold: no link's own rows trained its model."""
    (record,) = context.runs("remnet", "qat")
    table = context.predictions(record)
    frame = context.material.recordings.frame.iloc[table["row"]].reset_index(drop=True)
    frame["mitigated_m"] = frame["range_m"] - table["predicted_m"].to_numpy(np.float64)
    ranges = {"raw": "range_m", "mitigated (qat)": "mitigated_m"}
    tags = list(tags_of(frame, ranges, 2, _epochs(context)))
    note = f"Mitigated by REMnet (qat), {record.key.split}: each link by a model that never saw it."
    title = "Apartment, real ranges, 2-D"
    yield Found(_table(title, tags, [note]), _map("apartment", title, tags))


def _hall(context: Context) -> Iterator[Found]:
    """Yield the tags of 2019 in 3-D; the campaign of 2020 has no positions."""
    frame = context.recordings.frame
    hall = frame[frame["environment"] == "IIoT_19"]
    note = "No CIR is published, so nothing can be mitigated."
    for name, rows in (("all", hall), ("LoS", hall[hall["los"].fillna(False)])):
        tags = list(tags_of(rows, {"raw": "range_m"}, 3, _epochs(context)))
        title = f"Ghent IIoT_19, real ranges, 3-D, {name} ranges"
        yield Found(_table(title, tags, [note]), _map(f"ghent-{name.lower()}", title, tags))
    yield Found(note=_hall_2020(frame[frame["environment"] == "IIoT_20"]))


def _hall_2020(rows: pd.DataFrame) -> str:
    """Return why no position comes from the campaign of 2020, as counted in its rows."""
    ends = pd.concat([rows[["tx", "rx"]], rows[["rx", "tx"]].set_axis(["tx", "rx"], axis=1)])
    partners = ends.groupby("tx")["rx"].nunique()
    return (
        f"Ghent IIoT_20 gives no position: no antenna position is published, and none of its "
        f"{len(partners)} nodes (tag and anchor in turn) ranges with more than {partners.max()} "
        "others, so that even their layout does not follow from the true distances."
    )


def _epochs(context: Context) -> int:
    return QUICK_EPOCHS if context.quick else EPOCHS


def _table(title: str, tags: Sequence[Tag], notes: Sequence[str]) -> Table:
    rows = [row for tag in tags for row in _rows(tag)]
    refused = _refusals(tags)
    poor = [tag.name for tag in tags if not tag.refusal() and tag.dop > POOR_DOP]
    rows += _summary([tag for tag in tags if not tag.refusal() and tag.dop <= POOR_DOP])
    if poor:
        notes = [*notes, f"Poor geometry (dilution above {POOR_DOP:.0f}): {', '.join(poor)}."]
    if refused:
        notes = [*notes, "No position: " + "; ".join(refused)]
    return Table(title, ("tag", "ranges"), rows, digits=3, notes=notes)


def _refusals(tags: Sequence[Tag]) -> list[str]:
    """Return every reason why there is no position, with the tags it holds for."""
    found: dict[str, list[str]] = {}
    for tag in tags:
        if reason := tag.refusal():
            found.setdefault(reason, []).append(tag.name)
    return [f"{reason} ({', '.join(names)})" for reason, names in found.items()]


def _map(name: str, title: str, tags: Sequence[Tag]) -> Figure | None:
    """Return where every tag is and where its fixes are at the median, seen from above."""
    fixed = [tag for tag in tags if tag.refusal() is None]
    if not fixed:
        return None
    found = {"where the tags are": np.array([tag.truth_m for tag in fixed])}
    for kind in fixed[0].ranges_m:
        fixes = [np.median(tag.fixes(kind, "robust")[0], axis=0) for tag in fixed]
        found[f"median fix, {kind}"] = np.array(fixes)
    found["anchors"] = np.unique(np.concatenate([tag.anchors_m for tag in fixed]), axis=0)
    series = [_seen(label, points) for label, points in found.items()]
    series.append(_ties(list(found.values())[:-1]))
    return Figure(
        name, f"{title.replace(', real ranges', '')}: robust fixes from above", "scatter",
        "x (m)", "y (m)", series,
        equal_axes=True, data="real ranges",
    )  # fmt: skip


def _ties(places: Sequence[Floats]) -> Series:
    """Return a line from every tag to each of its fixes, with gaps between them."""
    truth, *fixes = places
    gap = np.full_like(truth, np.nan)
    path = np.concatenate([np.stack([truth, one, gap], axis=1).reshape(-1, truth.shape[1])
                           for one in fixes])  # fmt: skip
    x, y = (np.round(path[:, axis], 3).tolist() for axis in (0, 1))
    return Series("a tag and its fixes", x, y, style="line")


def _seen(label: str, points: Floats) -> Series:
    x, y = (np.round(points[:, axis], 3).tolist() for axis in (0, 1))
    return Series(label, x, y, style="marker" if label == "anchors" else "")


def _rows(tag: Tag) -> Iterator[Row]:
    """Yield the figures of one tag; where its anchors fix no position, only the geometry."""
    for kind in tag.ranges_m:
        label = (tag.name, kind)
        yield Row(label, "anchors", "", len(tag.anchors_m))
        yield Row(label, "dilution of precision", "", tag.dop)
        yield Row(label, "range MAE", "m", float(np.abs(tag.range_errors_m(kind)).mean()))
        for solver in SOLVERS if tag.refusal() is None else ():
            yield Row(label, f"position MAE, {solver}", "m", _position(tag, kind, solver))


def _position(tag: Tag, kind: str, solver: str) -> float:
    return float(tag.fixes(kind, solver)[1].mean())


def _summary(tags: Sequence[Tag]) -> Iterator[Row]:
    """Yield the median over the tags whose geometry fixes a position well."""
    for kind in tags[0].ranges_m if tags else ():
        label = (f"median of {len(tags)} tags with dilution up to {POOR_DOP:.0f}", kind)
        off = [float(np.abs(tag.range_errors_m(kind)).mean()) for tag in tags]
        yield Row(label, "range MAE", "m", _median(off))
        for solver in SOLVERS:
            away = [_position(tag, kind, solver) for tag in tags]
            yield Row(label, f"position MAE, {solver}", "m", _median(away))


def _median(values: Sequence[float]) -> Interval:
    """Return the median over tags."""
    return Interval(float(np.median(values)))
