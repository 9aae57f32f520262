"""An error message names the line of a key, where a file has one."""

import pytest

from nxt_twin.errors import NxtTwinError
from nxt_twin.recording.yaml_file import read_yaml
from nxt_twin.recording.yaml_place import YamlPlace


def test_a_nested_key_has_its_line(tmp_path):
    file = tmp_path / "plain.yaml"
    file.write_text("a:\n  b: 1\n", encoding="utf-8")
    assert YamlPlace(file).of(("a", "b")) == f"{file}, line 2, key a.b"


def test_a_file_that_is_no_yaml_any_more_has_a_place_without_a_line(tmp_path):
    file = tmp_path / "gone.yaml"
    file.write_text("a: {b_? c: 1}\nd: [", encoding="utf-8")
    assert YamlPlace(file).of(("a",)) == f"{file}, key a"


@pytest.mark.parametrize(
    ("text", "line", "key"), [("a: 1\nb: 2\na: 3\n", 3, "a"), ("things:\n  - x: {y: 1,\n    y: 2}\n", 3, "y")]
)
def test_a_key_that_is_there_twice_is_refused_by_its_line(tmp_path, text, line, key):
    file = tmp_path / "twice.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(NxtTwinError, match=rf"line {line}: .*key '{key}' is there twice.*keep one"):
        read_yaml(file, NxtTwinError)


def test_a_part_that_is_meant_twice_has_no_key_twice(tmp_path):
    file = tmp_path / "alias.yaml"
    file.write_text("a: &part {x: 1}\nb: *part\n", encoding="utf-8")
    assert read_yaml(file, NxtTwinError) == {"a": {"x": 1}, "b": {"x": 1}}
