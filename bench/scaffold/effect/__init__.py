"""Templates of a effect plug-in."""
