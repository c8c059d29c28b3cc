"""Comparing with a simulator that is run again at every recorded row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from bench.discrepancy.compare.ensemble import Ensemble, stack
from bench.discrepancy.compare.staged_simulation import Stages
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import Observables, Window
from bench.discrepancy.settings import UNLIMITED_MEMBERS
from bench.errors import BenchError
from bench.physics.outcome import Outcome
from bench.physics.simulator import Simulator


@dataclass(frozen=True)
class Resimulation:
    """A `bench.physics` simulator run again at every row's own geometry and settings."""

    simulator: Simulator
    window: Window

    @cached_property
    def stages(self) -> Stages:
        """Remembers everything before the ranging stage."""
        return Stages(self.window)

    def with_effects(self, added: Added) -> Simulator:
        """Return the simulator with these effects added or, by name, replaced."""
        out = self.simulator
        for effect in added:
            out = out.with_effect(effect)
        return out

    def ensemble(self, view: View, added: Added, members: int, first: int = 0) -> Ensemble:
        """Return recorded rows beside `members` x `view.rich` simulated versions."""
        simulator = self._cropped(self.with_effects(added), view)
        numbers = range(view.rich * first, view.rich * (first + members))
        replicas = self.stages.ensemble(simulator, view.scene, numbers, self._samples(view))
        return stack(view.recorded, replicas, view.links)

    def single(self, view: View, many: Sequence[Added]) -> list[Ensemble | None]:
        """Return recorded rows beside one simulated version, with each of many sets of effects.

        Sets that differ in one effect alone take less time than one by one. None where one cannot
        be simulated.
        """
        simulators = [self._cropped(self.with_effects(added), view) for added in many]
        made = self.stages.variants(simulators, view.scene, 0, self._samples(view))
        return [None if one is None else _beside(view, one) for one in made]

    def outcome(self, view: View, added: Added, number: int) -> Outcome:
        """Return one simulated version of recorded rows with its samples, in the window alone."""
        simulator = self._cropped(self.with_effects(added), view)
        return simulator.observe(view.scene, replicate=number)

    def distinct(self, view: View) -> int:
        """Return how many members repeat nothing of each other: any number."""
        return UNLIMITED_MEMBERS

    def alike(self, view: View) -> int:
        """Return the same: every member is of the row itself."""
        return UNLIMITED_MEMBERS

    def paired(self, view: View) -> bool:
        """Return that every row has simulated rows of its own."""
        return True

    def crowding(self, view: View) -> float:
        """Return that no simulated row stands for two recorded ones."""
        return 1.0

    def _samples(self, view: View) -> bool:
        """Return whether samples are simulated: where they are compared, or levels hang on them."""
        return view.waveform or self.simulator.of_samples

    def _cropped(self, simulator: Simulator, view: View) -> Simulator:
        """Return the simulator giving just the window that is compared."""
        if not view.waveform:
            return simulator
        crop = {
            "cir_lead": self.window.before,
            "cir_samples": self.window.before + self.window.after,
        }
        return replace(simulator, base=replace(simulator.base, **crop))


def _beside(view: View, made: Observables) -> Ensemble | None:
    """Return recorded rows beside one simulated version, None where they share nothing."""
    try:
        return stack(view.recorded, [made], view.links)
    except BenchError:
        return None
