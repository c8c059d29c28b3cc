"""Templates that packages of every kind share."""
