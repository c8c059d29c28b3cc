"""Which obstacle kinds the library knows by their name."""

from __future__ import annotations

from bench.physics.materials import is_listed, obstacle


def test_a_kind_is_listed_by_its_name_and_not_by_a_word_in_it() -> None:
    assert is_listed("LCD TV")
    assert is_listed("concrete")
    assert not is_listed("metal rack")
    assert obstacle("metal rack").material == "metal"
