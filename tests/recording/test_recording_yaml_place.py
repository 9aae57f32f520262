"""An error message names the line of a key, where a file has one."""

from nxt_twin.recording.yaml_place import Place


def test_a_nested_key_has_its_line(tmp_path):
    file = tmp_path / "plain.yaml"
    file.write_text("a:\n  b: 1\n", encoding="utf-8")
    assert Place(file).of(("a", "b")) == f"{file}, line 2, key a.b"


def test_a_file_that_is_no_yaml_any_more_has_a_place_without_a_line(tmp_path):
    file = tmp_path / "gone.yaml"
    file.write_text("a: {b_? c: 1}\nd: [", encoding="utf-8")
    assert Place(file).of(("a",)) == f"{file}, key a"
