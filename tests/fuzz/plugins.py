"""Plug-ins that misbehave: packages with entry points, made in the case's own folder."""

from __future__ import annotations

import random
from pathlib import Path

GROUPS = ("models", "backends", "datasets", "effects", "simulators", "devices")

MODEL = """
import sys
import numpy as np
from zoo.none import NoMitigation

class Evil(NoMitigation):
    "A model that misbehaves."
    def __init__(self, random_state=0):
        {init}
        self.random_state = random_state
    def fit(self, X, y, progress=None):
        {fit}
        return super().fit(X, y, progress=progress)
    def to_module(self):
        {module}
        return super().to_module()
"""
BACKEND = """
import sys
from backends.fp32 import Fp32Backend

class Evil(Fp32Backend):
    "A backend that misbehaves."
    def __init__(self):
        {init}
    def supports(self, model):
        {fit}
        return None
    def build(self, model, data, path, progress=None):
        {module}
        return super().build(model, data, path, progress)
"""
OTHER = """
import sys
class Evil:
    "Something that misbehaves."
    def __init__(self, *words, **named):
        {init}
    def __getattr__(self, name):
        {fit}
        raise AttributeError(name)
    def __call__(self, *words, **named):
        {module}
class Worse(Exception):
    def __str__(self):
        raise RuntimeError("no text")
    __repr__ = __str__
"""
DEEDS = (
    "pass",
    "sys.exit(0)",
    "sys.exit('[bold]bye[/x]')",
    "print('noise', flush=True)",
    "raise ValueError('[/] \\x1b[31mred\\nsecond line')",
    "raise KeyboardInterrupt",
    "raise ValueError()",
    "raise Exception(sys)",
    "raise type('Worse', (Exception,), {'__str__': lambda self: 1 / 0})()",
    "raise RecursionError('deep')",
    "raise MemoryError()",
    "raise BaseException('not an Exception')",
    "return 3",
    "return None",
    "return [1, 2]",
)
AT_IMPORT = (
    "",
    "",
    "",
    "raise RuntimeError('import')",
    "import sys; sys.exit(0)",
    "print('hello')",
)
AT_IMPORT += ("import no_such_module", "def broken(:", "1 / 0", "\x00")
MALFORMED = ("[bench.models", "no section", "[bench.models]\nevil", "[bench.models]\nevil = ", "")
MALFORMED += (
    "[bench.models]\n = x:y",
    "[bench.models]\nevil = a b c",
    "\x00\x01",
    "[bench.models]",
)
MALFORMED += ("[bench.models]\n\x1b[31mevil = evil_plugin:Evil",)


def plugin_package(rng: random.Random, folder: Path) -> tuple[Path, str, str]:
    """Write an installed package; return where it is, its group and what it does."""
    site, group = folder / "site", rng.choice((*GROUPS, "models", "backends"))
    info = site / "evil_plugin-1.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: evil-plugin\nVersion: 1\n")
    target = rng.choice(("evil_plugin:Evil", "evil_plugin:Evil", "evil_plugin:Evil", "gone:Evil"))
    if rng.random() < 0.15:
        target = rng.choice(("evil_plugin", "evil_plugin:Absent", "evil_plugin:Evil.deep", "evil:"))
    points = f"[bench.{group}]\nevil = {target}\n"
    malformed = rng.random() < 0.15
    (info / "entry_points.txt").write_text(rng.choice(MALFORMED) if malformed else points)
    if rng.random() < 0.1:
        (site / "evil_plugin").mkdir()  # a namespace package: no source at all
        return site, group, f"{group}: {target} in a namespace package"
    return site, group, f"{group}: {target}, {_module(rng, site, group)}"


def _module(rng: random.Random, site: Path, group: str) -> str:
    code = {"models": MODEL, "backends": BACKEND}.get(group, OTHER)
    deeds = dict.fromkeys(("init", "fit", "module"), "pass")
    where = rng.choice(sorted(deeds))
    deeds[where], begin = rng.choice(DEEDS), rng.choice(AT_IMPORT)
    source = code
    for name, deed in deeds.items():
        source = source.replace("{" + name + "}", deed)
    (site / "evil_plugin.py").write_text(f"{begin}\n{source}")
    return f"{where}: {deeds[where]!r}, at import: {begin!r}"
