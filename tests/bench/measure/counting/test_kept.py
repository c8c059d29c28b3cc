"""Counts in the cache: read back whole, only for the same question, and never after an edit."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
import toy

from bench.files import cache_dir
from bench.measure.counting import build_image, count_kept, kept


def _same(a, b):
    for name, value in asdict(a).items():
        np.testing.assert_equal(asdict(b)[name], value, err_msg=name)


@pytest.fixture
def emulated(monkeypatch):
    """Rows that were counted anew, by how many there were."""
    seen, count = [], kept.count_image

    def note(image, core, rows):
        seen.append(len(rows))
        return count(image, core, rows)

    monkeypatch.setattr(kept, "count_image", note)
    return seen


def test_a_count_is_kept_for_the_same_question_alone(tools, emulated):
    image, rows = build_image(toy.FILES, tools), toy.cirs(2)
    first = count_kept(image, tools, rows)
    _same(first, count_kept(image, tools, rows))
    assert emulated == [2]
    count_kept(image, tools, rows[:1])
    dearer = replace(tools.prices["integer"], typical=3.0, high=3.0)
    other = count_kept(image, replace(tools, prices={**tools.prices, "integer": dearer}), rows)
    assert emulated == [2, 1, 2]
    assert other.cycles.typical > first.cycles.typical
    assert other.instructions == first.instructions


def test_an_edited_count_is_made_again(tools, emulated):
    image, rows = build_image(toy.FILES, tools), toy.cirs(1)
    first = count_kept(image, tools, rows)
    [path] = (cache_dir() / "answers").glob("count-*.json")
    content = json.loads(path.read_text())
    content["answer"]["instructions"] = 1.0
    path.write_text(json.dumps(content))
    _same(first, count_kept(image, tools, rows))
    assert emulated == [1, 1]
