"""The simulator: a base channel plus an ordered list of effects, each with units and a source."""
