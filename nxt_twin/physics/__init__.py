"""Plants: a base model and the effects in it, compiled."""
