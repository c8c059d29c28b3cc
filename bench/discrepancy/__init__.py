"""Simulation against recordings: locate, explain, model, show."""
