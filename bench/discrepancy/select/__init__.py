"""Which effects are named: candidates, stepwise selection, verdicts."""
