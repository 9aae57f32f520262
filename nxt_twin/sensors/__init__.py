"""The NXT's sensors as stochastic models: what they would read, how likely a reading is, and fits of both."""
