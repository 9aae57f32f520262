from types import MappingProxyType

import fsspec
import pytest

from nxt_twin.fleet.errors import FleetError
from nxt_twin.fleet.finding.labels import Labels, labels_of
from nxt_twin.fleet.finding.sessions import session_count, sessions


def laid_out(root, *names):
    for name in names:
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("time_s\n0\n", encoding="utf-8")
    return str(root)


def found(*places):
    return {
        (each.labels.batch, each.labels.unit, each.labels.session): (each.recordings, sorted(each.files))
        for each in sessions(places)
    }


def test_the_tables_of_a_session_folder_are_one_case(tmp_path):
    root = laid_out(tmp_path, "U1/monday/a.csv", "U1/monday/b.csv", "U1/monday/a.yaml")
    assert found(root) == {("", "U1", "monday"): (("a.csv", "b.csv"), ["a.csv", "a.yaml", "b.csv"])}


def test_a_table_in_a_units_folder_is_a_session_with_its_sidecar_and_no_other(tmp_path):
    root = laid_out(tmp_path, "U1/a.csv", "U1/a.yaml", "U1/b.csv", "U1/b.yaml", "U1/motor.yaml")
    assert found(root) == {
        ("", "U1", "a"): (("a.csv",), ["a.csv", "a.yaml", "motor.yaml"]),
        ("", "U1", "b"): (("b.csv",), ["b.csv", "b.yaml", "motor.yaml"]),
    }


def test_a_table_without_folders_is_a_unit(tmp_path):
    assert list(found(laid_out(tmp_path, "U1.csv", "U2.parquet", "notes.txt"))) == [
        ("", "U1", ""),
        ("", "U2", ""),
    ]


def test_a_data_set_partitioned_by_unit_names_its_units(tmp_path):
    root = laid_out(tmp_path, "batch=B/unit=7/part-0.parquet", "batch=B/unit=7/_metadata.parquet")
    assert list(found(root)) == [("B", "7", "part-0")]


def test_a_case_folder_is_one_session_with_all_below_it(tmp_path):
    root = laid_out(tmp_path, "U1/s/case.yaml", "U1/s/runs/a.csv")
    assert found(root) == {("", "U1", "s"): ((), ["case.yaml", "runs/a.csv"])}
    assert list(found(f"{root}/U1/s")) == [("", "s", "")]


def test_a_glob_takes_names_from_before_its_wildcard(tmp_path):
    root = laid_out(tmp_path, "U1/s/a.csv", "U2/s/a.csv", "other/s/a.csv")
    assert list(found(f"{root}/U*")) == [("", "U1", "s"), ("", "U2", "s")]


def test_a_fleet_file_says_what_folders_mean_and_which_plant(tmp_path):
    root = laid_out(tmp_path, "B9/lab/U1/s/a.csv")
    (tmp_path / "fleet.yaml").write_text("folders: [batch, '-', unit, session]\nplant: {kind: dc_motor}\n")
    (session,) = sessions([root])
    assert session.labels == Labels("U1", "s", "B9")
    assert session.keys == {"plant": {"kind": "dc_motor"}}


def test_a_fleet_file_with_an_unknown_key_is_refused(tmp_path):
    root = laid_out(tmp_path, "U1/s/a.csv")
    (tmp_path / "fleet.yaml").write_text("levels: [unit]\n")
    with pytest.raises(FleetError, match=r"fleet\.yaml, key levels: unknown key"):
        list(sessions([root]))


def test_a_url_is_searched_like_a_folder():
    memory = fsspec.filesystem("memory")
    memory.pipe({"/trial/U1/s/a.csv": b"time_s\n0\n", "/trial/U2/s/a.csv": b"time_s\n1\n"})
    here = list(sessions(["memory://trial"]))
    assert [each.labels.unit for each in here] == ["U1", "U2"]
    assert here[1].store.read(here[1].files["a.csv"]) == b"time_s\n1\n"
    assert [each.labels.unit for each in sessions(["memory://trial/U2*"])] == ["U2"]


def test_local_urls_and_paths_find_alike(tmp_path):
    root = laid_out(tmp_path, "U1/s/a.csv")
    assert list(found(f"file://{root}")) == list(found(root))


def test_two_sessions_of_one_name_are_refused(tmp_path):
    one, other = laid_out(tmp_path / "x", "U1/s/a.csv"), laid_out(tmp_path / "y", "U1/s/a.csv")
    with pytest.raises(FleetError, match="not the only session 's' of unit 'U1'"):
        session_count([one, other])


@pytest.mark.parametrize("place", ["nowhere", "nowhere/*", "memory://nowhere"])
def test_a_place_without_anything_is_refused(place):
    with pytest.raises(FleetError, match="nowhere"):
        session_count([place])


WHEN = MappingProxyType(
    {"2026-03-01": (1, 0), "run 20260302T0930": (2, 9), "third": None, "2026-99-01": None}
)


@pytest.mark.parametrize("session", WHEN)
def test_a_session_is_dated_by_its_name(session):
    when = labels_of(["U", session], ("unit", "session")).when
    assert WHEN[session] == (None if when is None else (when.day, when.hour))
