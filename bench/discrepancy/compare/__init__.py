"""Recordings beside a simulator: ensembles, and proper scores of them."""
