"""Templates of a backend plug-in."""
