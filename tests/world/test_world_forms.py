"""The engine against closed forms: the table that `python -m benchmarks world_forms` prints."""

from __future__ import annotations

import pytest

from benchmarks.world_forms import FORMS


@pytest.mark.parametrize("motion", FORMS, ids=lambda motion: motion.__name__)
def test_a_motion_is_as_its_closed_form_says(motion):
    forms = list(motion())
    assert forms
    for form in forms:
        assert form.is_ == pytest.approx(form.should, abs=form.within), form.what
