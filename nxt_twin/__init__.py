"""A digital twin for the LEGO Mindstorms NXT that finds the physics its model leaves out.

The names in `__all__` are the library's public face (docs/api.md); each is imported when it is first used.

>>> import nxt_twin as nt
>>> nt.load_plant("nxt_motor")
<Plant dc_motor: coulomb_friction, viscous_friction, inductance>
"""

from importlib import import_module as _import_module

__version__ = "0.2.0"

_HOMES = {
    "Case": "nxt_twin.recording.case",
    "Changes": "nxt_twin.diagnose.changed.answer",
    "Diagnosis": "nxt_twin.diagnose.diagnosis",
    "Effect": "nxt_twin.physics.effect",
    "NxtTwinError": "nxt_twin.errors",
    "Parameter": "nxt_twin.physics.parameter",
    "Plant": "nxt_twin.physics.plant",
    "Recording": "nxt_twin.recording.recording",
    "find_changes": "nxt_twin.api.analysis",
    "find_missing_physics": "nxt_twin.api.analysis",
    "fit": "nxt_twin.api.analysis",
    "load_plant": "nxt_twin.api.files",
    "open_brick": "nxt_twin.api.bricks",
    "read_case": "nxt_twin.api.files",
    "read_recording": "nxt_twin.api.files",
    "record": "nxt_twin.api.bricks",
    "replay": "nxt_twin.api.replaying",
    "simulate": "nxt_twin.api.prediction",
    "start_mock": "nxt_twin.api.bricks",
}

__all__ = [*_HOMES, "__version__"]


def __getattr__(name: str) -> object:
    """Import a public name from where it lives; modules of the package that were not imported are no attributes."""
    if name not in _HOMES:
        raise AttributeError(f"module 'nxt_twin' has no attribute '{name}'")
    value = getattr(_import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """What there is, for completion."""
    return sorted({*globals(), *_HOMES})
