"""The names of a plug-in package, derived from one word and checked."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from keyword import iskeyword, issoftkeyword

from bench.errors import BenchError
from bench.plugins import Group, plugins

# What pip accepts as a distribution name and Python, with _ for -, as a module name.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9]*(?:[-_][A-Za-z0-9]+)*")
LONGEST = 50


@dataclass(frozen=True)
class PluginName:
    """One plug-in's names: `ridge-cir` as distribution, `ridge_cir` as module.

    Classes are called `RidgeCir` with an ending that keeps them apart from what a module imports.
    """

    text: str

    @property
    def module(self) -> str:
        """The import name."""
        return self.text.replace("-", "_").lower()

    @property
    def words(self) -> str:
        """The name as a class's name begins."""
        return "".join(word[0].upper() + word[1:] for word in re.split("[-_]", self.text))

    def check(self, group: Group) -> None:
        """Raise BenchError where the name cannot be used for a new plug-in of the group."""
        if not _NAME.fullmatch(self.text) or len(self.text) > LONGEST:
            raise BenchError(
                f"plug-in name {self.text!r}: expected letters and digits, parts joined by single "
                f"- or _, a letter first, at most {LONGEST} characters (such as ridge-cir)"
            )
        if iskeyword(self.module) or issoftkeyword(self.module):
            raise BenchError(f"plug-in name {self.text!r}: {self.module!r} is a Python keyword")
        self._check_free(group)

    def _check_free(self, group: Group) -> None:
        taken = {plugin.name: plugin.distribution for plugin in plugins(group)}
        if self.text in taken:
            raise BenchError(
                f"plug-in name {self.text!r}: {taken[self.text]} already registers it; "
                "choose another name"
            )
        if find_spec(self.module) is not None or _is_distribution(self.text):
            raise BenchError(
                f"plug-in name {self.text!r}: a package of that name is already installed; "
                "choose another name"
            )


def _is_distribution(name: str) -> bool:
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True
