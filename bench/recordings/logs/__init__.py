"""Somebody's own logs as recordings: files or folders, units, registers, links, warnings."""
