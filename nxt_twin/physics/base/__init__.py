"""Base models: what drives a plant, before any effect."""
