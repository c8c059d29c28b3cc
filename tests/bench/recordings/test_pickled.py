from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.errors import BenchError
from bench.recordings.readers.pickled import read_pickled_frame

ROWS = 7


def _frame(text: Any = None, cir: str = "float64") -> pd.DataFrame:
    cells = [np.arange(157, dtype=cir) + row for row in range(ROWS)]
    return pd.DataFrame(
        {
            "CIR": [cell.tolist() for cell in cells] if cir == "int64" else cells,
            "Error": np.linspace(-0.1, 0.5, ROWS),
            "Room": np.arange(ROWS) % 5,
            "Obstacles": pd.Series(["0000000001", *["0000000000"] * (ROWS - 1)], dtype=text),
        }
    )


def _check(columns: dict[str, Any], cir: str = "float64") -> None:
    assert list(columns) == ["CIR", "Error", "Room", "Obstacles"]
    np.testing.assert_array_equal(
        np.stack([np.asarray(c) for c in columns["CIR"]]),
        np.arange(157)[None, :] + np.arange(ROWS)[:, None],
    )
    np.testing.assert_array_equal(columns["Error"], np.linspace(-0.1, 0.5, ROWS))
    assert list(columns["Room"]) == [0, 1, 2, 3, 4, 0, 1]
    assert list(columns["Obstacles"])[:2] == ["0000000001", "0000000000"]


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
@pytest.mark.parametrize("text", [None, object])
@pytest.mark.parametrize("cir", ["float64", "float32", "int64"])
def test_this_pandas_own_pickles_are_read(tmp_path: Path, protocol: int, text, cir: str) -> None:
    path = tmp_path / "dataset.pkl"
    _frame(text, cir).to_pickle(path, protocol=protocol)
    _check(read_pickled_frame(path), cir)


def test_a_shuffled_index_and_a_column_of_numpy_scalars_are_read(tmp_path: Path) -> None:
    frame = _frame(object)
    frame["Error"] = pd.Series(list(frame["Error"].to_numpy()), dtype=object)
    frame.index = [3, 1, 2, 0, 6, 5, 4]
    frame.to_pickle(tmp_path / "dataset.pkl")
    _check(read_pickled_frame(tmp_path / "dataset.pkl"))


class _Global:
    """A class or function of another pandas version, by its name there."""

    def __init__(self, module: str, name: str) -> None:
        self.module, self.name = module, name


class _Call:
    """What another version's `__reduce__` gives: a call, then a state."""

    def __init__(self, function: _Global, *args: Any, state: Any = None) -> None:
        self.parts = (function, args) if state is None else (function, args, state)


class _OldPickler(pickle._Pickler):  # the one in Python, whose steps can be replaced
    def save(self, obj: Any, save_persistent_id: bool = True) -> None:
        if isinstance(obj, _Global):
            self.save(obj.module)
            self.save(obj.name)
            self.write(pickle.STACK_GLOBAL)
        elif isinstance(obj, _Call):
            self.save(obj.parts[0])
            self.save(obj.parts[1])
            self.write(pickle.REDUCE)
            if len(obj.parts) > 2:
                self.save(obj.parts[2])
                self.write(pickle.BUILD)
        else:
            super().save(obj, save_persistent_id)


def _old_array(array: np.ndarray) -> _Call:
    """Return an array as numpy 1 pickled it."""
    kind = _Call(
        _Global("numpy", "dtype"),
        array.dtype.str[1:],
        False,
        True,
        state=(3, "|" if array.dtype == object else "<", None, None, None, -1, -1, 0),
    )
    inside = [_old_array(c) if isinstance(c, np.ndarray) else c for c in array.ravel()]
    content = inside if array.dtype == object else array.tobytes()
    state = (1, array.shape, kind, False, content)
    make = _Global("numpy.core.multiarray", "_reconstruct")
    return _Call(make, _Global("numpy", "ndarray"), (0,), b"b", state=state)


def _slice(start: int, stop: int) -> _Call:
    return _Call(_Global("builtins", "slice"), start, stop, 1)


def _old_frame(layout: str) -> _Call:
    """Return the table as pandas 1.1 (state under "0.14.1") or 1.3 (`new_block`) pickled it."""
    frame = _frame(object)
    make_index = _Global("pandas.core.indexes.base", "_new_Index")
    names = np.array(["CIR", "Error", "Room", "Obstacles"], dtype=object)
    columns = _Call(
        make_index,
        _Global("pandas.core.indexes.base", "Index"),
        {"data": _old_array(names), "name": None},
    )
    rows = _Call(
        make_index,
        _Global("pandas.core.indexes.numeric", "Int64Index"),
        {"data": _old_array(np.arange(ROWS)), "name": None},
    )
    objects = frame[["CIR", "Obstacles"]].to_numpy().T
    blocks = [
        (_old_array(np.ascontiguousarray(objects)), _old_array(np.array([0, 3]))),
        (_old_array(frame["Error"].to_numpy()[None, :]), _slice(1, 2)),
        (_old_array(frame["Room"].to_numpy()[None, :]), _slice(2, 3)),
    ]
    manager = _Global("pandas.core.internals.managers", "BlockManager")
    if layout == "1.1":
        parts = [{"values": values, "mgr_locs": places} for values, places in blocks]
        state = ([columns, rows], [], [], {"0.14.1": {"axes": [columns, rows], "blocks": parts}})
        made, key = _Call(manager, state=state), "_data"
    else:
        make_block = _Global("pandas.core.internals.blocks", "new_block")
        calls = tuple(_Call(make_block, values, places, 2) for values, places in blocks)
        made, key = _Call(manager, calls, [columns, rows]), "_mgr"
    state = {key: made, "_typ": "dataframe", "_metadata": [], "attrs": {}}
    return _Call(_Global("pandas.core.frame", "DataFrame"), state=state)


@pytest.mark.parametrize("layout", ["1.1", "1.3"])
def test_the_layouts_of_older_pandas_are_read(tmp_path: Path, layout: str) -> None:
    path = tmp_path / "dataset.pkl"
    with path.open("wb") as file:
        _OldPickler(file, protocol=4).dump(_old_frame(layout))
    _check(read_pickled_frame(path))


class _Hostile:
    """A pickle of this would run a command when loaded."""

    def __init__(self, function: Any, *args: Any) -> None:
        self.parts = (function, args)

    def __reduce__(self) -> tuple[Any, Any]:
        return self.parts


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
@pytest.mark.parametrize("hidden", [False, True])
def test_a_pickle_that_would_run_a_command_is_refused(
    tmp_path: Path, protocol: int, hidden: bool
) -> None:
    evidence, path = tmp_path / "evidence", tmp_path / "dataset.pkl"
    bomb = _Hostile(os.system, f"touch {evidence}")
    content: Any = bomb
    if hidden:
        content = _frame(object)
        content.at[3, "CIR"] = bomb
    path.write_bytes(pickle.dumps(content, protocol))
    with pytest.raises(BenchError, match=r"refused: .*system.* nothing in it was run"):
        read_pickled_frame(path)
    assert not evidence.exists()


@pytest.mark.parametrize(
    "function", [eval, exec, getattr, __import__, open, print, np.load, pd.read_pickle, sys.exit]
)
def test_no_other_function_is_called(tmp_path: Path, function: Any) -> None:
    path = tmp_path / "dataset.pkl"
    path.write_bytes(pickle.dumps(_Hostile(function, "1")))
    with pytest.raises(BenchError, match="refused"):
        read_pickled_frame(path)


def test_a_dotted_name_does_not_reach_further(tmp_path: Path) -> None:
    path = tmp_path / "dataset.pkl"
    path.write_bytes(b"\x80\x04\x8c\x05numpy\x8c\x10ndarray.__init__\x93)R.")
    with pytest.raises(BenchError, match=r"refused: the pickle names numpy\.ndarray\.__init__"):
        read_pickled_frame(path)


def test_a_pickle_cut_short_anywhere_gives_a_clear_line(tmp_path: Path) -> None:
    path = tmp_path / "dataset.pkl"
    content = pickle.dumps(_frame(object), 4)
    for size in range(0, len(content) - 1, 53):
        path.write_bytes(content[:size])
        with pytest.raises(BenchError, match=r"cut short|damaged") as caught:
            read_pickled_frame(path)
        assert "\n" not in str(caught.value)


def test_damage_never_gives_anything_but_a_table_or_a_clear_line(tmp_path: Path) -> None:
    path, rng = tmp_path / "dataset.pkl", np.random.default_rng(0)
    content = pickle.dumps(_frame(object).iloc[:2], 4)
    lines = []
    for _ in range(300):
        damaged = bytearray(content)
        damaged[rng.integers(len(content))] = rng.integers(256)
        path.write_bytes(damaged)
        try:
            read_pickled_frame(path)
        except BenchError as error:
            lines.append(str(error))
    assert len(lines) > 50
    assert all(line.isprintable() for line in lines)


@pytest.mark.parametrize("thing", [[1, 2], {"CIR": 1}, "text", pd.Series([1.0]), np.zeros(3)])
def test_a_pickle_of_something_else_is_refused(tmp_path: Path, thing: Any) -> None:
    path = tmp_path / "dataset.pkl"
    path.write_bytes(pickle.dumps(thing))
    with pytest.raises(BenchError, match=r"not a pickled pandas DataFrame|refused"):
        read_pickled_frame(path)


def test_text_is_no_pickle(tmp_path: Path) -> None:
    (tmp_path / "dataset.pkl").write_text("<html>404 Not Found</html>")
    with pytest.raises(BenchError, match=r"damaged|cut short"):
        read_pickled_frame(tmp_path / "dataset.pkl")
