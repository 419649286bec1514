"""What a run leaves behind: arrays with names and units, their files, their verdicts. No engine."""
