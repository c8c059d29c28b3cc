"""Joining operators: a ReLU into its layer, and loops into the loop that alone uses them."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from backends.c.elementwise import body_result
from backends.c.operators import (
    Argument,
    Convolution,
    Copy,
    Input,
    Loop,
    Operator,
    Program,
    Quantise,
    Ref,
    Result,
    Step,
    Table,
    reads,
)
from backends.c.views import is_contiguous

MOST_STEPS = 24  # longer bodies spill registers


def fused(program: Program) -> Program:
    """Return the program with fewer operators, the same arithmetic in the same order."""
    operators = list(program.operators)
    for join in (_relu_into_layer, _into_user, _quantised_part):
        operators = _joined(operators, program.result.buffer, join)
    return replace(program, operators=tuple(operators))


def _joined(operators: list[Operator], result: int, join: object) -> list[Operator]:
    """Let each operator swallow the makers of what it alone reads."""
    assert callable(join)
    users = Counter(
        ref.buffer for op in operators for ref in {r.buffer: r for r in reads(op)}.values()
    )
    users[result] += 1
    writers = Counter(op.y.buffer for op in operators)
    kept: list[Operator] = []
    for operator in operators:
        joined = operator
        for index in range(len(kept) - 1, -1, -1):
            maker = kept[index]
            only = users[maker.y.buffer] == 1 and writers[maker.y.buffer] == 1
            if only and any(ref.buffer == maker.y.buffer for ref in reads(joined)):
                found = join(maker, joined)
                if found is not None:
                    joined = found
                    del kept[index]
        kept.append(joined)
    return kept


def _relu_into_layer(maker: Operator, user: Operator) -> Operator | None:
    if not isinstance(maker, Convolution) or not isinstance(user, Loop) or maker.relu:
        return None
    simple = user.steps == (Step("relu", (Input(0),)),) and user.reduction is None
    if not simple or not _same_places(user, 0, maker.y.size):
        return None
    y = replace(maker.y, buffer=user.y.buffer)
    return replace(maker, y=y, relu=True)


def _same_places(user: Loop, place: int, size: int) -> bool:
    """Tell whether a loop reads all of a buffer in the order that it writes."""
    item = user.inputs[place]
    return (
        isinstance(item, Ref)
        and item.offset == 0
        and user.y.offset == 0
        and item.strides == user.strides
        and item.size == size
        and user.y.size == size
    )


def _into_user(maker: Operator, user: Operator) -> Operator | None:
    """Put the body of a loop in front of the body of its only user."""
    if not isinstance(maker, Loop) or not isinstance(user, Loop) or maker.reduction is not None:
        return None
    places = [i for i, item in enumerate(user.inputs) if _reads_back(item, maker)]
    refs = [i for i, item in enumerate(user.inputs) if _of(item, maker)]
    fits = places == refs and maker.shape == user.shape
    if not fits or len(maker.steps) + len(user.steps) > MOST_STEPS:
        return None
    return _combined(maker, user, set(places))


def _of(item: Ref | Table, maker: Loop) -> bool:
    return isinstance(item, Ref) and item.buffer == maker.y.buffer


def _reads_back(item: Ref | Table, maker: Loop) -> bool:
    """Tell whether an input is exactly what the maker wrote, element for element."""
    same = isinstance(item, Ref) and item.buffer == maker.y.buffer
    return same and item.strides == maker.strides and item.offset == maker.y.offset  # type: ignore[union-attr]


def _combined(maker: Loop, user: Loop, places: set[int]) -> Loop:
    first = len(maker.inputs)
    kept = [i for i in range(len(user.inputs)) if i not in places]
    moved = {old: Input(first + new) for new, old in enumerate(kept)}
    made = body_result(maker)
    shift = len(maker.steps)

    def renamed(argument: Argument) -> Argument:
        if isinstance(argument, Input):
            return made if argument.index in places else moved[argument.index]
        return Result(argument.index + shift) if isinstance(argument, Result) else argument

    later = tuple(Step(s.function, tuple(map(renamed, s.arguments))) for s in user.steps)
    if not later and body_result(user) == Input(0) and 0 not in places:
        return user
    inputs = (*maker.inputs, *(user.inputs[i] for i in kept))
    kind = maker.kind if user.kind == "copy" else user.kind
    return replace(user, inputs=inputs, steps=(*maker.steps, *later), kind=kind)


def _quantised_part(maker: Operator, user: Operator) -> Operator | None:
    """Quantise only what is copied, straight to where it goes."""
    if not isinstance(maker, Quantise) or not isinstance(user, Copy):
        return None
    if not is_contiguous(maker.x) or not is_contiguous(maker.y):
        return None
    x = replace(user.x, buffer=maker.x.buffer, offset=maker.x.offset + user.x.offset)
    return replace(maker, x=x, y=user.y)
