"""What can go wrong in an experiment.

NxtTwinError
├── ExperimentError      a run folder or its recordings that do not belong to the experiment, or cannot be fitted
└── PositionerError      what moves the target or sensor cannot go there, or does not answer
    └── StoppedError         the person who was asked to move something ended the experiment
"""

from __future__ import annotations

from nxt_twin.errors import NxtTwinError


class ExperimentError(NxtTwinError):
    """A run folder, or recordings in it, from which the experiment cannot go on or conclude anything."""


class PositionerError(NxtTwinError):
    """What moves the target or sensor cannot go there, or does not answer."""


class StoppedError(PositionerError):
    """The person who was asked to move something ended the experiment; it can be resumed."""
