"""Comparing with a simulator that is run again at every recorded row."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from bench.discrepancy.compare.ensemble import Ensemble, stack
from bench.discrepancy.compare.staged_simulation import Stages
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import Window
from bench.discrepancy.settings import UNLIMITED_MEMBERS
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
        replicas = self.stages.ensemble(simulator, view.scene, numbers, view.waveform)
        return stack(view.recorded, replicas, view.links)

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

    def _cropped(self, simulator: Simulator, view: View) -> Simulator:
        """Return the simulator giving just the window that is compared."""
        if not view.waveform:
            return simulator
        crop = {
            "cir_lead": self.window.before,
            "cir_samples": self.window.before + self.window.after,
        }
        return replace(simulator, base=replace(simulator.base, **crop))
