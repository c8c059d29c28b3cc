"""Sets without what they do not need, and names beside what has no form; SIMULATED rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.likelihood import evidence
from bench.discrepancy.joint.plainer import plainer
from bench.discrepancy.joint.polish import Fit, fitted, polished
from bench.discrepancy.joint.screen import Screen
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.unformed import beside_unformed
from bench.physics.base import Base
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.late_detection import LateDetection
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 60


def made(hidden: Added) -> pd.DataFrame:
    """Return one row of each of 60 links with CIRs; SIMULATED."""
    rng = np.random.default_rng(3)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(2, 15, LINKS),
            "tx": [f"t{i % 3}" for i in range(LINKS)],
            "rx": [f"r{i % 4}" for i in range(LINKS)],
        }
    )
    return Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77).table(frame)


def given(frame: pd.DataFrame) -> Statistics:
    """Return the statistics of rows beside a simulator that hides nothing."""
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    return Statistics(Resimulation(Simulator(Base(), (), 11, "test"), window), rows)


def fit_of(of: Statistics, *effects: PathLoss) -> Fit:
    """Return a set as fitted from where it is."""
    fit = polished(of, effects)
    assert fit is not None
    return fit


def worth(of: Statistics, fit: Fit) -> float:
    """Return the evidence of a set in nats."""
    return evidence(of, fit.moments, fit.responses, fit.parameters)


def plain_of(of: Statistics, fit: Fit) -> Fit:
    """Return a set without what it does not need."""
    return plainer(of, fit, lambda one: worth(of, one))


def test_another_form_of_a_loss_is_no_shadowing() -> None:
    """A fit of one slope takes what bends for scatter; evidence lets forms differ."""
    lossy = [made((PathLoss(2.0, 0.3 * far_m - 0.6),)) for far_m in range(16)]  # dB a metre: rain
    rows = [lossy[round(far)].iloc[[i]] for i, far in enumerate(lossy[0]["true_range_m"])]
    of = given(pd.concat(rows))
    fit = fit_of(of, PathLoss(2.2, 0.0, 0.8))
    plain = plain_of(of, fit)
    assert fit.effects[0].shadowing_db > 0.1
    assert plain.effects[0].shadowing_db == 0
    assert worth(of, plain) > worth(of, fit) + NAME_NATS


def test_what_scatters_by_link_stays() -> None:
    of = given(made((PathLoss(2.4, 0.0, 3.0),)))
    plain = plain_of(of, fit_of(of, PathLoss(2.2, 0.0, 1.0)))
    assert plain.effects[0].shadowing_db > 1.5


def test_what_stays_is_fitted_again_and_pays_for_itself_alone() -> None:
    of = given(made((PathLoss(2.5),)))
    begun = fitted(of, (PathLoss(2.4, 0.8),))
    assert begun is not None
    plain = plain_of(of, begun)
    assert (plain.effects[0].offset_db, plain.parameters) == (0, 1)
    assert abs(plain.effects[0].exponent - 2.5) < 0.05
    assert plain.nats > begun.nats


def test_a_name_does_not_pay_alone_for_that_forms_may_be_wrong() -> None:
    of = given(made((PathLoss(2.2, 1.7),)))
    fit, none = (fit_of(of, *effects) for effects in ((PathLoss(2.2, 1.5),), ()))
    plain = plain_of(of, fit)
    alone = beside_unformed(of, plain) - beside_unformed(of, none)
    alike = beside_unformed(of, plain) - beside_unformed(of, none, plain)
    assert alike > max(alone, NAME_NATS)


def test_a_threshold_that_acts_from_half_the_peak_on_is_found() -> None:
    hidden = LateDetection(peak_fraction=0.57)
    of = given(made((hidden,)))
    (best,) = Screen(of, (LateDetection,)).singly()
    assert abs(replace(best.effect).peak_fraction - hidden.peak_fraction) < 0.08
