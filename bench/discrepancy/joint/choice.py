"""What comparing sets of waveform effects says."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from bench.discrepancy.compare.view import Added


@dataclass(frozen=True)
class WaveChoice:
    """The effects of the likeliest set that each bring enough to be named, as fitted.

    `rivals` maps their names to effects that would do as well in their place; `nats` to what each
    brings. `explained`: the evidence of the set over none, `left`: that of something without a
    form beside it, both in nats. `unexplained`: so much is left that no name is sure.
    `marked`: names that bear a mark of their own; `scattering`: of those by which links scatter
    more than without them; `doubted`: of those that something without a form would do as well as.
    `shown`: of those that a log of theirs, or samples of noise alone, show and nothing else does.
    `dense`: those whose late samples come by more ways than walls reflect.
    `beyond` maps names to those of members that do not do what they do, whatever their forms.
    """

    added: Added = ()
    rivals: dict[str, Added] = field(default_factory=dict)
    nats: dict[str, float] = field(default_factory=dict)
    explained: float = 0.0
    left: float = 0.0
    unexplained: bool = False
    marked: tuple[str, ...] = ()
    scattering: tuple[str, ...] = ()
    doubted: tuple[str, ...] = ()
    beyond: dict[str, tuple[str, ...]] = field(default_factory=dict)
    shown: tuple[str, ...] = ()
    dense: tuple[str, ...] = ()

    @property
    def named(self) -> Added:
        """The effects that are named: those that bear a mark, or that are not doubted."""
        doubted = set(self.doubted) - set(self.marked)
        return tuple(effect for effect in self.added if effect.name not in doubted)

    @property
    def quiet(self) -> Added:
        """The effects of the set that are not named: something is there that they stand for."""
        return tuple(effect for effect in self.added if effect not in self.named)

    @property
    def unlisted(self) -> bool:
        """Whether waveforms hold what no effect explains, which may shift ranges too."""
        return self.unexplained or bool(self.quiet)

    def likeness(self, worse: Collection[str] = ()) -> str:
        """Return what the set looks most like, of effects that are not named, in words.

        None of those that make links `worse` that they were not fitted on.
        """
        quiet = [effect.physics for effect in self.quiet if effect.name not in worse]
        return f"looks most like {' and '.join(quiet)}, but " if quiet else ""
