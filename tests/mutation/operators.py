"""The faults: small changes of a module's syntax tree, one at a time.

Left alone are docstrings and all other text (messages), annotations, decorators and what stands
under TYPE_CHECKING. No fault replaces a whole result by None: any test would notice.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass

_SWAPPED: dict[type[ast.AST], type[ast.AST]] = {
    **{ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt},
    **{ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is},
    **{ast.In: ast.NotIn, ast.NotIn: ast.In, ast.And: ast.Or, ast.Or: ast.And},
    **{ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult},
    **{ast.FloorDiv: ast.Div, ast.Mod: ast.Div, ast.Pow: ast.Mult},
    **{ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd},
}
_RENAMED = {"min": "max", "maximum": "minimum", "any": "all", "amin": "amax", "argmin": "argmax"}
_RENAMED |= {new: old for old, new in _RENAMED.items()}
_SKIPPED = ast.JoinedStr | ast.arg | ast.Import | ast.ImportFrom


@dataclass(frozen=True)
class Mutant:
    """One fault: where, what stood there, what stands there now, and the whole changed tree."""

    line: int
    text: str
    before: str
    after: str
    tree: ast.Module

    def __str__(self) -> str:
        return f"line {self.line}: {self.before} -> {self.after}"


def mutants(source: str) -> Iterator[Mutant]:
    """Yield every mutant of a module's source, in the order of the text."""
    tree = ast.parse(source)
    lines = source.splitlines()
    for holder, field, index, node in list(_places(tree)):
        for new in _faults(node):
            _put(holder, field, index, ast.copy_location(new, node))
            whole = ast.fix_missing_locations(deepcopy(tree))
            _put(holder, field, index, node)
            line = node.iter.lineno if isinstance(node, ast.comprehension) else node.lineno
            yield Mutant(line, lines[line - 1].strip(), _short(node), _short(new), whole)


def _places(tree: ast.AST) -> Iterator[tuple[ast.AST, str, int | None, ast.AST]]:
    """Yield (holder, field, index, node) of every statement and expression that may change."""
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for index, node in enumerate(value if isinstance(value, list) else [value]):
            if isinstance(node, ast.AST) and not _left_alone(node):
                yield tree, field, index if isinstance(value, list) else None, node
                yield from _places(node)


def _left_alone(node: ast.AST) -> bool:
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        return True
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return True
    return isinstance(node, _SKIPPED)


def _put(holder: ast.AST, field: str, index: int | None, node: ast.AST) -> None:
    if index is None:
        setattr(holder, field, node)
    else:
        getattr(holder, field)[index] = node


def _faults(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what may stand in place of a node."""
    match node:
        case ast.Compare() | ast.BinOp() | ast.BoolOp() | ast.AugAssign():
            yield from _swapped(node)
        case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.Invert()):
            yield node.operand
        case ast.Constant(value=bool() | int() | float()):
            yield ast.Constant(_other(node.value))
        case ast.If() | ast.IfExp() | ast.While():
            yield _with(node, test=ast.UnaryOp(ast.Not(), node.test))
        case ast.comprehension(ifs=[_, *_]):
            yield _with(node, ifs=[])
        case ast.Call():
            yield from _calls(node)
        case ast.Slice():
            yield from (_with(node, **{end: None}) for end in ("lower", "upper") if _has(node, end))
        case ast.Raise() | ast.Expr():
            yield ast.Pass()
        case ast.Break() | ast.Continue():
            yield ast.Continue() if isinstance(node, ast.Break) else ast.Break()


def _has(node: ast.AST, field: str) -> bool:
    return getattr(node, field) is not None


def _swapped(node: ast.Compare | ast.BinOp | ast.BoolOp | ast.AugAssign) -> Iterator[ast.AST]:
    operator = node.ops[0] if isinstance(node, ast.Compare) else node.op
    other = _SWAPPED.get(type(operator))
    if other is not None:
        new = (
            {"ops": [other(), *node.ops[1:]]} if isinstance(node, ast.Compare) else {"op": other()}
        )
        yield _with(node, **new)


def _other(value: float) -> float:
    if isinstance(value, bool):
        return not value
    return value + 1 if isinstance(value, int) or value == 0 else value * 2


def _calls(node: ast.Call) -> Iterator[ast.AST]:
    """Yield the call of the opposite function, and the call without each named argument."""
    name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    if name in _RENAMED:
        field = "attr" if isinstance(node.func, ast.Attribute) else "id"
        yield _with(node, func=_with(node.func, **{field: _RENAMED[name]}))
    for index, keyword in enumerate(node.keywords):
        if keyword.arg is not None:
            yield _with(node, keywords=node.keywords[:index] + node.keywords[index + 1 :])


def _with(node: ast.AST, **changes: object) -> ast.AST:
    """Return a copy of a node with some fields changed."""
    fields = {name: getattr(node, name) for name in node._fields if hasattr(node, name)}
    return ast.copy_location(type(node)(**(fields | changes)), node)


def _short(node: ast.AST) -> str:
    if isinstance(node, ast.If | ast.While):
        return f"if {ast.unparse(node.test)}"
    if isinstance(node, ast.comprehension):
        return "".join(f" if {ast.unparse(one)}" for one in node.ifs) or "no condition"
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= 80 else text[:77] + "..."
