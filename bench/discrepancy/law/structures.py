"""A structure: one form over one covariate, times one factor, with or without an offset."""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from bench.discrepancy.law.forms import Form, Named, over_what
from bench.discrepancy.law.likelihood import Fit, linear
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.settings import LAW_DESCENT, LAW_STEPS
from bench.physics.formula.units import over

Floats = NDArray[np.float64]


PER_UNIT = "{a} per {x}"


@dataclass(frozen=True)
class Fitted:
    """A fitted structure: its constants (name, value, unit) and how well they do."""

    constants: tuple[Named, ...]
    fit: Fit


class Structure(Protocol):
    """One law whose constants are open.

    `form`, `columns`, `where` are as in `FoundLaw`.
    """

    @property
    def form(self) -> str:
        """Return the form's name."""

    @property
    def free(self) -> int:
        """Return how many constants are paid for."""

    @property
    def choices(self) -> int:
        """Return how many structures it was one of."""

    @property
    def fault(self) -> str:
        """Return the kind of fault of the set-up that it is."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Return what it is over."""

    @property
    def where(self) -> str:
        """Return the device, category or column that it is multiplied with."""

    @property
    def expression(self) -> str:
        """Return its expression for the effect `law`."""

    def fitted(self, given: Material) -> Fitted:
        """Return it fitted to rows."""

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what it says of other rows [n], in metres."""

    def words(self, shown: dict[str, str]) -> str:
        """Return it as a sentence for people, its constants as `shown` by name."""


def cost(structure: Structure, rows: float) -> float:
    """Return what a structure pays in nats: half a logarithm per constant (BIC), and its choice."""
    return structure.free / 2 * log(max(rows, 2.0)) + log(max(structure.choices, 1))


@dataclass(frozen=True)
class GridLaw:
    """A form over column `at` (-1: none), times factor `by` (0: all rows)."""

    shape: Form
    at: int
    by: int
    offset: bool
    value: float
    bounds: tuple[float, float]
    choices: int
    names: tuple[str, str, str, str, str]  # text, words of the column; text, words, unit of factor
    fault: str = ""

    @property
    def form(self) -> str:
        """The form's name."""
        return self.shape.name

    @property
    def free(self) -> int:
        """How many constants it fits."""
        waves = 1 if self.shape.name == "periodic" else 0
        return 1 + waves + bool(self.shape.free) + self.offset

    @property
    def columns(self) -> tuple[str, ...]:
        """What it is over."""
        return () if self.at < 0 else (self.names[0],)

    @property
    def where(self) -> str:
        """What it is multiplied with."""
        return self.names[3]

    @property
    def expression(self) -> str:
        """Its expression."""
        x = self.names[0] if self.names[0].isidentifier() else f"({self.names[0]})"
        body = self.shape.text.replace("{x}", x)
        body = f"{body} + b" if self.offset else body
        return f"{self.names[2]} * ({body})" if self.by else body

    def fitted(self, given: Material) -> Fitted:
        """Return it fitted: the free constant by a search, the rest by reweighted least squares."""
        low, high = self.bounds
        value = self.value
        if self.shape.free and self.shape.smooth and high > low:
            found = minimize_scalar(
                lambda v: self._misfit(given, float(v)),
                bounds=self.bounds,
                method="bounded",
                options={"maxiter": LAW_DESCENT},
            )
            value = float(found.x)
        elif self.shape.name == "step":
            value = self._best_place(given)
        fit = linear(self.design(given, value), given.residual_m)
        return Fitted(self._named(given, value, fit.values), fit)

    def _misfit(self, given: Material, value: float) -> float:
        """Return minus the log-likelihood at a value of the free constant."""
        return -linear(self.design(given, value), given.residual_m).likelihood

    def _best_place(self, given: Material) -> float:
        """Return the place of the step: all between two values near the screened one are tried."""
        x = over_what(given, self.at).values
        inside = np.unique(x[(x >= self.bounds[0]) & (x <= self.bounds[1])])
        places = (inside[1:] + inside[:-1]) / 2
        places = places[:: max(len(places) // LAW_STEPS, 1)]
        tried = [self._misfit(given, float(v)) for v in places]
        return float(places[int(np.argmin(tried))]) if tried else self.value

    def design(self, given: Material, value: float) -> Floats:
        """Return the design matrix [n, q] at a value of the free constant."""
        column = over_what(given, self.at)
        parts = [part[0] for part in self.shape.basis(column, np.array([value]))]
        parts += [np.ones(len(column.values))] if self.offset else []
        return np.stack(parts, axis=1) * given.factors[self.by].weights[:, None]

    def free_value(self, found: Fitted) -> float:
        """Return the free constant of a fit."""
        return {name: value for name, value, _ in found.constants}.get(self.shape.free, self.value)

    def _named(self, given: Material, value: float, found: Floats) -> tuple[Named, ...]:
        """Return the constants with units; a factor's unit goes into the amplitude's."""
        top = over("m", self.names[4])
        column = over_what(given, self.at)
        constants = self.shape.named(column, top, value, found)
        if self.offset:
            constants.append(("b", float(found[-1]), top))
        return tuple(constants)

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what it says of other rows."""
        values = {name: value for name, value, _ in constants}
        free = values.get(self.shape.free, 0.0)
        found = [values["a"]]
        if "phase" in values:
            found = [values["a"] * np.cos(values["phase"]), values["a"] * np.sin(values["phase"])]
        found += [values["b"]] if self.offset else []
        return np.asarray(self.design(given, free) @ np.array(found))

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        plain = self.form == "linear" and " per " not in shown["a"]  # nobody knows its unit
        of = f"unit of {self.names[1]}" if plain else self.names[1]
        said = (PER_UNIT if plain else self.shape.words).format(x=of, **shown)
        said += f" plus {shown['b']}" if self.offset else ""
        if not self.by:
            return f"error = {said}"
        group = self.names[2].startswith("(")
        return f"error = {said}, where {self.names[3]}" if group else self._times(said)

    def _times(self, said: str) -> str:
        """Return a product with a covariate for people."""
        return f"error = ({said}) x {self.names[3]}"
