"""A run of a brick in memory and on disk, and recordings from elsewhere."""
