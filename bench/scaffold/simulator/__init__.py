"""Templates of a simulator plug-in."""
