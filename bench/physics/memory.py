"""What was computed lately and may be asked for again: a bounded memory that threads may share."""

from __future__ import annotations

import ctypes
from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import cache
from threading import Lock
from typing import Generic, TypeVar

T = TypeVar("T")
_TRIM, _FROM_SYSTEM = -1, -3  # M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of malloc.h
_LARGEST = 32 << 20  # bytes: larger arrays come from the system, as glibc allows no more
_TRIMMED = 512 << 20  # bytes of free memory at the end of the heap, that go back


class Memory(Generic[T]):
    """Values by key, the `most` lately used of them; threads may share it.

    A value that stands for several counts as so many.
    """

    def __init__(self, most: int) -> None:
        self.most = most
        self._kept: OrderedDict[Hashable, tuple[T, int]] = OrderedDict()
        self._many = 0
        self._lock = Lock()

    def __getstate__(self) -> int:
        """Return what another process needs: it remembers nothing yet."""
        return self.most

    def __setstate__(self, most: int) -> None:
        self.__init__(most)  # type: ignore[misc]

    def find(self, key: Hashable) -> T | None:
        """Return what is remembered, None where nothing is."""
        with self._lock:
            found = self._kept.get(key)
            if found is None:
                return None
            self._kept.move_to_end(key)
            return found[0]

    def keep(self, key: Hashable, value: T, many: int = 1) -> T:
        """Remember a value and return it; it stands for `many`."""
        with self._lock:
            _, before = self._kept.pop(key, (None, 0))
            self._kept[key] = value, many
            self._many += many - before
            while self._many > self.most:
                _, (_, gone) = self._kept.popitem(last=False)
                self._many -= gone
        return value

    def get(self, key: Hashable, make: Callable[[], T], many: int = 1) -> T:
        """Return what is remembered, else what `make` gives, remembered from now on."""
        found = self.find(key)
        return self.keep(key, make(), many) if found is None else found


@cache
def keep_freed() -> bool:
    """Have the C library keep memory that arrays gave back; return whether it could be told.

    A simulation makes and drops arrays of some hundred kilobytes all the time. By default glibc
    returns such memory to the system, whose fresh pages cost more than the arithmetic. The peak
    stays as it is. Elsewhere than on glibc nothing is changed.
    """
    try:
        tell = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError):
        return False
    return bool(tell(_FROM_SYSTEM, _LARGEST) and tell(_TRIM, _TRIMMED))
