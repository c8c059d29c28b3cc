"""Counting, not guessing: C for a part's core, run in an emulator, instructions made cycles.

    image = build_image(files, core)            # cross-compiled, cached
    count = count_image(image, core, rows)      # emulated, in a process of its own
    figure = figure_of(count, profile)          # latency, energy, what fits on a part

A counted figure is exact in instructions and an interval in cycles: each core's table
(`cores/*.toml`) gives low, typical and high for every class of instruction, with its source.
"""

from bench.measure.counting.compile import Compiler, Image, build_image, find_compiler
from bench.measure.counting.core import Core, load_core
from bench.measure.counting.count import Count, count_image
from bench.measure.counting.kept import count_kept
from bench.measure.counting.part import Figure, figure_of

__all__ = [
    "Compiler",
    "Core",
    "Count",
    "Figure",
    "Image",
    "build_image",
    "count_image",
    "count_kept",
    "figure_of",
    "find_compiler",
    "load_core",
]
