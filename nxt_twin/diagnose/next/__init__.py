"""The experiment that would tell most, and the next step for the person who runs it."""
