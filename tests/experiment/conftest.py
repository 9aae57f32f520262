"""Nothing shared but the helper module's place on the path."""
