"""What a scene may contain: one spec a kind of element, as its author writes it."""
