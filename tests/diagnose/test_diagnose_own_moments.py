"""What each recording has for itself: when a payload is put on in it, and where a clock that wanders stands."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnose_cases import concealed

from nxt_twin.blind.bench import draw_commands, draw_motor
from nxt_twin.blind.case import NOMINAL
from nxt_twin.blind.record import take
from nxt_twin.blind.truth.sensing import Sensing
from nxt_twin.diagnose.engine import diagnose
from nxt_twin.physics.layout import Slot
from nxt_twin.recording.case import Case
from nxt_twin.recording.recording import Recording

SECONDS = 14.0
ADDED_KG_M2 = 8e-4
NEVER = 1e6


def put_on(moments_s, *, held_out=0):
    """As many recordings as there are moments, s, at which a payload is put on; the last ones are held out."""
    rng = np.random.default_rng(67)
    light = draw_motor(rng)
    taken = []
    for number, moment_s in enumerate(moments_s):
        motor = replace(light, added_inertia_kg_m2=ADDED_KG_M2, added_from_s=moment_s)
        run = draw_commands(rng, ("steps", "reversals")[number % 2], "usb", SECONDS, 0.5, 0.0)
        taken.append(take(rng, f"r{number}.csv", motor, Sensing(), run).recording)
    fitted = len(taken) - held_out
    plant = {"kind": "dc_motor", **NOMINAL}
    return Case("made", Path(), plant, tuple(taken[:fitted]), tuple(taken[fitted:]), "a")


def told_s(diagnosis):
    """The moments that the notes tell, s by recording."""
    (note,) = [one for one in diagnosis.notes if "anew in each recording" in one]
    return {name: float(at_s) for at_s, name in re.findall(r"at ([\d.]+) s of (r\d\.csv)", note)}, note


@pytest.mark.slow
@pytest.mark.parametrize("held_out", [0, 1])
def test_a_payload_put_on_in_each_recording_anew_is_named_with_its_moments(held_out):
    moments_s = (4.0, 9.0, 6.5)[: 2 + held_out]
    answer = diagnose(put_on(moments_s, held_out=held_out))
    said = answer.diagnosis
    assert said.verdict == "explained"
    (found,) = said.effects
    assert found.id == "payload_inertia"
    assert found.params["added_inertia_kg_m2"].value == pytest.approx(ADDED_KG_M2, rel=0.25)
    told, _ = told_s(said)
    assert told == pytest.approx({f"r{n}.csv": at_s for n, at_s in enumerate(moments_s)}, abs=1.5)
    assert answer.plant.values[Slot("payload_inertia", "onset")] == pytest.approx(
        sorted(moments_s)[len(moments_s) // 2], abs=1.5
    )
    two_s = next(one for one in said.fit.horizons if one.seconds == 2.0)
    assert two_s.improved < 0.3 * two_s.baseline


@pytest.mark.slow
def test_a_payload_in_every_other_recording_is_named():
    said = diagnose(put_on((0.0, NEVER, 0.0, NEVER, 0.0), held_out=1)).diagnosis
    assert said.verdict == "explained"
    assert [one.id for one in said.effects] == ["payload_inertia"]
    _, note = told_s(said)
    assert "from the start of r0.csv" in note
    assert "never in r1.csv" in note


@pytest.mark.slow
def test_a_clock_that_stands_elsewhere_as_each_recording_begins_is_named():
    case = concealed((), seed=2203, seconds=14.0)

    def stamped(recording, phase):
        elapsed_s = recording.columns["time_s"] - recording.columns["time_s"][0]
        late_s = 0.045 * (1.0 + np.sin(2.0 * np.pi * (elapsed_s / 3.7 + phase)))
        return Recording(
            recording.name, {**recording.columns, "time_s": recording.columns["time_s"] + late_s}
        )

    phases = (0.1, 0.62, 0.33, 0.85, 0.5)
    made = [
        stamped(one, phase) for one, phase in zip((*case.recordings, *case.holdout), phases, strict=False)
    ]
    fitted = len(case.recordings)
    said = diagnose(replace(case, recordings=tuple(made[:fitted]), holdout=tuple(made[fitted:]))).diagnosis
    assert said.verdict == "explained"
    assert [one.id for one in said.effects] == ["clock_skew"]
    assert said.effects[0].params["lag_span_s"].value == pytest.approx(0.09, rel=0.3)
    assert any("stood elsewhere as each recording began" in note for note in said.notes)
