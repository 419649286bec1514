"""Controllers: they read quantities during a run and set drives."""
