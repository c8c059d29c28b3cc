"""Starts plug-in packages from templates: names checked, all files written or none."""

from bench.scaffold.names import PluginName
from bench.scaffold.package import LAYOUTS, Kind, write_package

__all__ = ["LAYOUTS", "Kind", "PluginName", "write_package"]
