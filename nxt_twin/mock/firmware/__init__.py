"""The NXT's firmware as a pure state machine: bytes in, one millisecond a tick, bytes out."""
