"""Reading a pandas table out of a pickle without running anything that the pickle names.

Loading a pickle normally calls whatever it names. Here every name must be on a short list, and
even those stand for inert records: nothing of pandas, numpy or the system is called while loading.
The table is then put together from the records, whose layout differs between pandas versions:

- to 1.2: `BlockManager` with a state that holds axes and blocks under "0.14.1";
- from 1.3: `BlockManager(blocks, axes)` with blocks from `_unpickle_block(values, places, ndim)`
  (called `new_block` in 1.3);
- from 3.0: text as Arrow arrays.
"""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError

_DATA_FRAME = "DataFrame"
_MANAGER = "BlockManager"
_ALLOWED = {
    "pandas": {_DATA_FRAME, "Index", "RangeIndex", "StringDtype"},
    "pandas.arrays": {"ArrowStringArray"},
    "pandas.core.frame": {_DATA_FRAME},
    "pandas.core.indexes.base": {"_new_Index", "Index"},
    "pandas.core.indexes.range": {"RangeIndex"},
    "pandas.core.indexes.numeric": {"Int64Index", "UInt64Index", "Float64Index"},
    "pandas.indexes.base": {"_new_Index", "Index"},
    "pandas.indexes.range": {"RangeIndex"},
    "pandas.indexes.numeric": {"Int64Index"},
    "pandas.core.internals": {_MANAGER},
    "pandas.core.internals.managers": {_MANAGER},
    "pandas.core.internals.blocks": {"new_block"},
    "pandas._libs.internals": {"_unpickle_block"},
    "pandas.core.arrays.string_": {"StringDtype"},
    "pandas.core.arrays.string_arrow": {"ArrowStringArray"},
    "pyarrow.lib": {"_restore_array", "py_buffer", "type_for_alias", "chunked_array"},
    "numpy": {"ndarray", "dtype"},
    "numpy.core.multiarray": {"_reconstruct", "scalar"},
    "numpy._core.multiarray": {"_reconstruct", "scalar"},
    "numpy.core.numeric": {"_frombuffer"},
    "numpy._core.numeric": {"_frombuffer"},
    "_codecs": {"encode"},
    "builtins": {"slice", "object", "bytearray"},
    "__builtin__": {"slice", "object", "bytearray"},
    "copyreg": {"_reconstructor"},
    "copy_reg": {"_reconstructor"},
}
_TYPES = re.compile(r"[fiub](?:1|2|4|8)|bool|O[48]?")


class _Record:
    """What the pickle asked for, as data: the arguments of a call and the state set after it."""

    name: ClassVar[str]
    args: tuple[Any, ...]
    state: Any

    def __new__(cls, *args: Any) -> Self:
        record = super().__new__(cls)
        record.args, record.state = args, None
        return record

    def __setstate__(self, state: Any) -> None:
        self.state = state


class _Unpickler(pickle.Unpickler):
    """Gives an inert record for every name on the list and refuses all others."""

    def __init__(self, file: Any, path: Path) -> None:
        super().__init__(file)
        self._path = path
        self._known: dict[tuple[str, str], type[_Record]] = {}

    def find_class(self, module_name: str, global_name: str, /) -> type[_Record]:
        """Return the record type of a name. Raises BenchError for any that is not on the list."""
        if global_name not in _ALLOWED.get(module_name, ()):
            raise BenchError(
                f"{self._path}: refused: the pickle names {_shown(f'{module_name}.{global_name}')},"
                " which no table of recordings needs; nothing in it was run"
            )
        key = (module_name, global_name)
        if key not in self._known:
            self._known[key] = type(global_name, (_Record,), {"name": global_name})
        return self._known[key]


def read_pickled_frame(path: Path) -> dict[str, NDArray[Any]]:
    """Return the columns of a pickled pandas DataFrame, each as an array [n].

    Cells that are arrays stay arrays. Raises BenchError where the file is missing, cut short, no
    pickled DataFrame, or names anything else than what a DataFrame is made of.
    """
    try:
        with path.open("rb") as file:
            record = _Unpickler(file, path).load()
        return _columns(record)
    except BenchError:
        raise
    except OSError as problem:
        raise BenchError(f"{path}: cannot be read: {problem.strerror or problem}") from problem
    except (EOFError, pickle.UnpicklingError) as problem:
        reason = "cut short" if _cut_short(problem) else f"damaged ({_shown(problem)})"
        raise BenchError(f"{path}: the pickle is {reason}; download it again") from problem
    except Exception as problem:  # whatever malformed records lead to is one clear line
        reason = f"{type(problem).__name__}: {_shown(problem)}"
        raise BenchError(f"{path}: not a pickled pandas DataFrame ({reason})") from problem


def _shown(thing: object) -> str:
    """Return text from a file as one short line that cannot steer a terminal."""
    return "".join(c if c.isprintable() else "?" for c in str(thing))[:120]


def _cut_short(problem: Exception) -> bool:
    return isinstance(problem, EOFError) or "truncated" in str(problem)


def _columns(frame: Any) -> dict[str, NDArray[Any]]:
    """Return the columns of a DataFrame's record by name."""
    if not _is(frame, _DATA_FRAME):
        raise TypeError(f"it holds {type(frame).__name__}")
    manager = frame.state.get("_mgr", frame.state.get("_data"))
    axes, blocks = _parts(manager)
    names = [str(name) for name in _index(axes[0])]
    columns: dict[str, NDArray[Any]] = {}
    for values, places in blocks:
        rows = _values(values)
        rows = rows[None, :] if rows.ndim == 1 else rows
        for row, place in zip(rows, _places(places, len(names)), strict=True):
            columns[names[place]] = row
    if len({len(column) for column in columns.values()}) > 1:
        raise ValueError("columns of different lengths")
    return {name: columns[name] for name in names}


def _is(thing: Any, *names: str) -> bool:
    """Return whether a thing is the record of one of these names."""
    return isinstance(thing, _Record) and _name(thing) in names


def _name(record: _Record) -> str:
    """Return what a record stands for; protocols 0 and 1 make objects by `_reconstructor`."""
    if record.name == "_reconstructor" and record.args:
        return str(getattr(record.args[0], "name", ""))
    return record.name


def _parts(manager: Any) -> tuple[Any, Iterator[tuple[Any, Any]]]:
    """Return a manager's axes and its (values, places) in either layout."""
    if not _is(manager, _MANAGER):
        raise TypeError("no BlockManager")
    if isinstance(manager.state, tuple) and len(manager.state) >= 4:
        state: Mapping[str, Any] = manager.state[3]["0.14.1"]
        return state["axes"], ((b["values"], b["mgr_locs"]) for b in state["blocks"])
    blocks, axes = manager.args[:2]
    if not all(_is(block, "_unpickle_block", "new_block") for block in blocks):
        raise TypeError("unknown kind of block")
    return axes, ((block.args[0], block.args[1]) for block in blocks)


def _index(record: Any) -> list[Any]:
    """Return the labels of an index."""
    if not _is(record, "_new_Index"):
        raise TypeError("unknown kind of index")
    made_of = record.args[1]
    if "data" in made_of:
        return list(_values(made_of["data"]))
    return list(range(made_of["start"], made_of["stop"], made_of["step"]))


def _places(record: Any, count: int) -> list[int]:
    """Return the column numbers that a block's rows go to."""
    if _is(record, "slice"):
        return list(range(*slice(*record.args).indices(count)))
    return [int(place) for place in _values(record)]


def _values(record: Any) -> NDArray[Any]:
    """Return the array that a record describes."""
    if isinstance(record, _Record) and _name(record) in _MAKERS:
        return _MAKERS[_name(record)](record)
    raise TypeError(f"unknown kind of array: {getattr(record, 'name', type(record).__name__)}")


def _numpy(record: _Record) -> NDArray[Any]:
    """Return numpy's own pickled form: (version, shape, type, Fortran order, content)."""
    _, shape, kind, fortran, content = record.state
    order: Any = "F" if fortran else "C"
    dtype = _dtype(kind)
    if dtype.kind == "O":
        array = np.empty(len(content), object)
        for place, cell in enumerate(content):
            array[place] = _plain(cell)
        return array.reshape(shape, order=order)
    return np.frombuffer(_bytes(content), dtype).reshape(shape, order=order)


def _numpy_buffer(record: _Record) -> NDArray[Any]:
    """Return the form of pickle protocol 5: (content, type, shape, order)."""
    content, kind, shape, order = record.args
    return np.frombuffer(_bytes(content), _dtype(kind)).reshape(shape, order=order)


def _arrow_text(record: _Record) -> NDArray[Any]:
    """Return the text of an Arrow string column (pandas 3), after Arrow has checked it in full."""
    found = [part for part in _walk(record.state) if _is(part, "_restore_array")]
    return np.array([text for part in found for text in _arrow_list(part.args[0])], dtype=object)


def _arrow_list(described: Any) -> list[str | None]:
    """Return one Arrow array of text: (type, length, nulls, offset, buffers, ..)."""
    import pyarrow as pa

    alias = described[0].args[0]
    if alias not in ("string", "large_string"):
        raise TypeError(f"unknown kind of text: {alias}")
    kind = pa.string() if alias == "string" else pa.large_string()
    parts = [None if part is None else pa.py_buffer(_bytes(part.args[0])) for part in described[4]]
    array = pa.Array.from_buffers(kind, described[1], parts, offset=described[3])
    array.validate(full=True)
    texts: list[str | None] = array.to_pylist()
    return texts


_MAKERS: Mapping[str, Callable[[_Record], NDArray[Any]]] = {
    "_reconstruct": _numpy,
    "_frombuffer": _numpy_buffer,
    "ArrowStringArray": _arrow_text,
}


def _walk(thing: Any, depth: int = 8) -> Iterator[Any]:
    """Yield the records inside nested tuples, lists, dicts and arguments."""
    if depth and isinstance(thing, _Record):
        yield thing
        yield from _walk(thing.args, depth - 1)
    elif depth and isinstance(thing, list | tuple):
        for part in thing:
            yield from _walk(part, depth - 1)
    elif depth and isinstance(thing, dict):
        yield from _walk(list(thing.values()), depth - 1)


def _dtype(record: Any) -> np.dtype[Any]:
    """Return a plain number or object type. Raises TypeError for any other."""
    if not _is(record, "dtype") or not _TYPES.fullmatch(str(record.args[0])):
        raise TypeError("unknown kind of number")
    dtype: np.dtype[Any] = np.dtype(record.args[0])
    big_endian = isinstance(record.state, tuple) and record.state[1] == ">"
    return dtype.newbyteorder(">") if big_endian else dtype


def _bytes(content: Any) -> bytes:
    """Return bytes, which old protocols hold as an encoded text or a copied bytearray."""
    if _is(content, "bytearray"):
        return _bytes(content.args[0]) if content.args else b""
    if _is(content, "encode"):
        return str(content.args[0]).encode("latin-1")
    return bytes(content)


def _plain(cell: Any) -> Any:
    """Return one cell of an object column: a number, a text, a list or an array."""
    if _is(cell, "_reconstruct", "_frombuffer"):
        return _values(cell)
    if _is(cell, "scalar"):
        return np.frombuffer(_bytes(cell.args[1]), _dtype(cell.args[0]), count=1)[0]
    if isinstance(cell, list | tuple):
        return [_plain(part) for part in cell]
    if isinstance(cell, _Record):
        raise TypeError(f"unknown kind of cell: {cell.name}")
    return cell
