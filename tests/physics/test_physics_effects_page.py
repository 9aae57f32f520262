"""docs/effects.md is what the declarations give."""

import importlib.util
import sys
from pathlib import Path

import pytest

from nxt_twin.physics.effects import BUILT_IN

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def effects_page():
    spec = importlib.util.spec_from_file_location("effects_page", ROOT / "tools" / "effects_page.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_the_committed_page_is_what_the_declarations_give(effects_page):
    committed = (ROOT / "docs" / "effects.md").read_text(encoding="utf-8")
    assert committed == effects_page.page(), "run tools/effects_page.py"


def test_every_effect_has_a_section_and_a_picture_and_no_picture_is_left_over(effects_page):
    text = effects_page.page()
    for effect in BUILT_IN:
        assert f"### `{effect.id}`: {effect.name}\n" in text
        assert f"](effects/{effect.id}.png)" in text
    pictures = {path.stem for path in (ROOT / "docs" / "effects").iterdir()}
    assert pictures == {effect.id for effect in BUILT_IN}


def test_every_link_within_the_page_leads_to_a_heading(effects_page):
    text = effects_page.page()
    for effect in BUILT_IN:
        for other in effect.confusable_with:
            heading = next(e for e in BUILT_IN if e.id == other)
            assert f"(#{effects_page._anchor(heading)})" in text


def test_every_scene_shows_its_effect(effects_page):
    for effect_id, scene in effects_page.SCENES.items():
        drawn = effects_page._played(effect_id, scene)
        apart = abs(drawn.having - drawn.without).max()
        assert apart > 0.03 * max(abs(drawn.without).max(), 1.0), effect_id
