"""Where bricks may be, one way a file; looking moves nothing."""
