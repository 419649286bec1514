"""Many runs of one scene: what is varied, what is kept, where it runs, what came of it."""
