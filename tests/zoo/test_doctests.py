"""Every example in a docstring of zoo runs and gives what it says."""

from __future__ import annotations

import doctest
import pkgutil
from importlib import import_module

import pytest

import zoo

MODULES = sorted(module.name for module in pkgutil.walk_packages(zoo.__path__, "zoo."))


NAMES = ["modules.features", "none", "remnet", "cnn1d", "svm", "mlp", "modules.scaling"]
NAMES += ["inputs", "constant", "constant_by_level"]


@pytest.mark.parametrize("name", NAMES)
def test_modules_show_an_example(name: str) -> None:
    assert doctest.testmod(import_module(f"zoo.{name}")).attempted > 0
