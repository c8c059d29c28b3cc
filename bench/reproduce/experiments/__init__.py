"""One module per table or figure of the paper, each with `run(context) -> Outcome`."""
