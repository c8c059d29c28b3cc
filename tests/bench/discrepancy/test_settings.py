"""No number that decides stands outside `settings.py`, and no two uses share random numbers."""

from __future__ import annotations

import ast
from itertools import pairwise
from pathlib import Path

import pytest

from bench.discrepancy import settings

PACKAGE = Path(settings.__file__).parent
MODULES = sorted(path for path in PACKAGE.rglob("*.py") if path.name != "settings.py")
PLAIN = {0, 1, 2, 3, -1, 0.5}  # counts of things, halves and units decide nothing


def _numbers(node: ast.AST) -> list[float]:
    """Return the numbers written out in a piece of code."""
    return [
        part.value
        for part in ast.walk(node)
        if isinstance(part, ast.Constant)
        and isinstance(part.value, int | float)
        and not isinstance(part.value, bool)
        and part.value not in PLAIN
    ]


def _deciding(tree: ast.Module) -> list[tuple[int, list[float]]]:
    """Return line and numbers of module constants, defaults and comparisons."""
    found: list[tuple[int, list[float]]] = []
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            found.append((node.lineno, _numbers(node.value)))
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            found.append((node.lineno, _numbers(node)))
        if isinstance(node, ast.FunctionDef):
            given = [*node.args.defaults, *(d for d in node.args.kw_defaults if d)]
            found += [(node.lineno, _numbers(default)) for default in given]
    return [(line, numbers) for line, numbers in found if numbers]


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_threshold_outside_settings(path):
    assert _deciding(ast.parse(path.read_text())) == []


def test_the_guard_sees_a_threshold():
    code = "LEVEL = 0.9\ndef f(x, y=7):\n    return x > 0.25 and x != 0\n"
    assert [numbers for _, numbers in _deciding(ast.parse(code))] == [[0.9], [7], [0.25]]


def test_replicates_of_different_uses_are_different():
    last = settings.SEARCH_FIRST + (settings.MOST_ROUNDS + 1) * settings.SEARCH_MEMBERS
    spans = [
        (0, settings.FIT_MEMBERS * settings.STRIKING_RICHER),
        (settings.SCORE_FIRST, settings.SCORE_FIRST + 3 * settings.SCORE_MEMBERS),
        (settings.SEARCH_FIRST, last),
        (settings.CONFIRM_FIRST - settings.CONFIRM_MEMBERS, settings.CONFIRM_FIRST),
        (settings.CONFIRM_FIRST, settings.CONFIRM_FIRST + settings.CONFIRM_MEMBERS),
        (settings.OFFSET_FIRST, settings.OFFSET_FIRST + settings.OFFSET_MEMBERS),
    ]
    assert all(a[1] <= b[0] for a, b in pairwise(spans))


def test_every_setting_is_used():
    code = "\n".join(path.read_text() for path in MODULES)
    unused = [name for name in vars(settings) if name.isupper() and name not in code]
    assert unused == []
