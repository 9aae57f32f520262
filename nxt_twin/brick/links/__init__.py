"""The ways to a brick, one a file; all of them are a `Link`."""
