"""The CIRs in three principal components, coloured by room and by material."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.reproduce.build import make_outcome
from bench.reproduce.context import Context
from bench.reproduce.outcome import Figure, Outcome, Row, Series, Table

COMPONENTS = 3
POINTS_PER_CLASS = 300
MATERIALS = ("metal plate", "plastic", "wood door", "glass plate")
_PROTOCOL = (
    "Principal components (scikit-learn, full SVD) of the 157 CIR magnitudes as they come, mean "
    "removed. Rooms: every row. Materials: rows with one obstacle of the paper's four classes. "
    "Share between classes: of a component's variance over the rows shown, the part that the "
    "class means make (η²; 0 = the classes lie on each other). Pictures show up to "
    f"{POINTS_PER_CLASS} rows of a class, drawn with seed 0. The paper gives pictures, no numbers."
)
Floats = NDArray[np.float64]


def run(context: Context) -> Outcome:
    """Return the explained variance, how far the classes part, and both pictures."""
    material = context.material
    points, shares = _project(material.cirs)
    frame = material.recordings.frame
    tables = [_variance(shares)]
    figures = []
    for name, title, labels in _colourings(frame):
        shown = labels.notna().to_numpy()
        if labels.nunique() < 2:  # nothing parts one class
            continue
        tables.append(_between(title, points[shown], labels[shown]))
        figures.append(_figure(name, title, points[shown], labels[shown]))
    title = "PCA: the CIRs in three principal components"
    return make_outcome(context, "pca", title, _PROTOCOL, tables, figures)


def _project(cirs: NDArray[np.float32]) -> tuple[Floats, Floats]:
    """Return the components [n, 3] and the variance they explain [3]."""
    from sklearn.decomposition import PCA

    analysis = PCA(COMPONENTS, svd_solver="full")
    points = analysis.fit_transform(cirs.astype(np.float64))
    return points, analysis.explained_variance_ratio_


def _colourings(frame: pd.DataFrame) -> list[tuple[str, str, pd.Series]]:
    """Return (file name, title, class of each row or None) of each picture."""
    made = []
    if "environment" in frame:
        made.append(("rooms", "room", frame["environment"].astype(object)))
    if "obstacles" in frame:
        made.append(("materials", "material", frame["obstacles"].map(_material)))
    return made


def _material(obstacles: object) -> str | None:
    """Return the one obstacle of a row where it is of the paper's four classes."""
    if isinstance(obstacles, list | tuple | np.ndarray) and len(obstacles) == 1:
        kind = str(obstacles[0])
        return kind if kind in MATERIALS else None
    return None


def _variance(shares: Floats) -> Table:
    rows = [
        Row((f"component {number + 1}",), "variance explained", "", float(share))
        for number, share in enumerate(shares)
    ]
    rows.append(Row(("all three",), "variance explained", "", float(shares.sum())))
    return Table("Variance explained", ("",), rows, digits=3)


def _between(title: str, points: Floats, labels: pd.Series) -> Table:
    """Return the share of each component's variance that lies between the classes."""
    table = pd.DataFrame(points).assign(label=labels.to_numpy())
    centres = table.groupby("label").transform("mean").to_numpy()
    shares = centres.var(axis=0) / np.maximum(points.var(axis=0), 1e-12)
    rows = [
        Row((f"component {number + 1}",), "share between classes", "", float(share))
        for number, share in enumerate(shares)
    ]
    count = labels.nunique()
    return Table(f"How far the CIRs part by {title} ({count} classes)", ("",), rows, digits=3)


def _figure(name: str, title: str, points: Floats, labels: pd.Series) -> Figure:
    rng = np.random.default_rng(0)
    series = []
    for label in sorted(map(str, labels.unique())):
        rows = np.flatnonzero(labels.to_numpy() == label)
        rows = rng.permutation(rows)[:POINTS_PER_CLASS]
        x, y, z = (np.round(points[rows, axis] / 1000, 3).tolist() for axis in range(COMPONENTS))
        series.append(Series(label, x, y, z))
    return Figure(
        name, f"CIRs by {title}", "scatter3d", "component 1 (10³ counts)",
        "component 2 (10³ counts)",
        series, z_label="component 3 (10³ counts)",
    )  # fmt: skip
