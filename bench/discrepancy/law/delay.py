"""A delay of one device as a law: a constant in its rows, one of as many as there are devices.

Such a delay is known physics, as is that a device stands elsewhere: neither was picked among all
forms over all columns, which a law without a name was. Where both do about as well, one number
stands against three (`bench.discrepancy.law.search`), and both are said.
"""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.law.forms import CONSTANT
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.structures import GridLaw, Structure

ENDS = ("tx", "rx")


def as_delay(given: Material, law: GridLaw) -> GridLaw:
    """Return a law that pays for its choice among devices alone, where it is a delay of one."""
    if law.shape is not CONSTANT or not _of_device(law.names[2]):
        return law
    devices = sum(_of_device(one.text) for one in given.factors)
    return replace(law, choices=min(law.choices, devices + 1))


def is_delay_of(law: Structure, device: str) -> bool:
    """Return whether a law is a constant where this device is at one end."""
    return law.form == CONSTANT.name and law.where in ends(device)


def ends(device: str) -> tuple[str, ...]:
    """Return in words where a device is at either end; () for none."""
    return tuple(f"{end} is {device}" for end in ENDS if device)


def _of_device(text: str) -> bool:
    return text.startswith(tuple(f"({end} == " for end in ENDS))
