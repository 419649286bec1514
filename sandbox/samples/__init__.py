"""What was sampled of a run: arrays, quantities read from them, verdicts on them."""
