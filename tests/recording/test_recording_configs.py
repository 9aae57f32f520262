"""The configurations that come with the tool."""

import pytest
import yaml

from nxt_twin.errors import PlantError
from nxt_twin.recording.case import CaseFile
from nxt_twin.recording.configs import configs_dir, load_plant_config
from nxt_twin.recording.mapping import read_mapping
from nxt_twin.recording.realdata import DATA_SETS


def test_the_nxt_motor_is_the_papers_with_its_friction_recomputed():
    plant = load_plant_config("nxt_motor")
    assert plant["kind"] == "dc_motor"
    dead_zone_v = 0.2519 / 1.9248
    friction_nm = plant["torque_constant_nm_per_a"] * dead_zone_v / plant["resistance_ohm"]
    assert plant["coulomb_friction_nm"] == pytest.approx(friction_nm, rel=1e-3)


def test_a_plant_file_may_hold_its_keys_at_the_top_or_under_plant(put):
    top = put("top.yaml", "kind: rigid_body\ninertia: 2\n")
    under = put("under.yaml", "plant:\n  kind: rigid_body\n  inertia: 2\n")
    assert load_plant_config(top) == load_plant_config(str(under)) == {"kind": "rigid_body", "inertia": 2}


def test_refuses_an_unknown_plant(tmp_path, refusal):
    assert "nearest known: nxt_motor" in refusal(PlantError, load_plant_config, "nxt-motor")
    assert "no such file" in refusal(PlantError, load_plant_config, tmp_path / "none.yaml")


def test_every_mapping_and_case_that_comes_along_is_valid():
    for path in (configs_dir() / "mappings").glob("*.yaml"):
        read_mapping(path)
    names = {path.parent.name for path in (configs_dir() / "cases").glob("*/case.yaml")}
    assert names == set(DATA_SETS)
    for name in names:
        text = (configs_dir() / "cases" / name / "case.yaml").read_text(encoding="utf-8")
        CaseFile.model_validate(yaml.safe_load(text))
