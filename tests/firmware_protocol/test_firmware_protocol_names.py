from __future__ import annotations

import pytest

from firmware_protocol import (
    IllegalFileNameError,
    LoaderError,
    Status,
    check_file_name,
    fold_case,
    is_linear_name,
    pattern_matches,
)


def test_nineteen_characters_are_a_file_name_and_twenty_are_not():
    assert check_file_name("fifteen_chars_x.rxe") == "fifteen_chars_x.rxe"
    with pytest.raises(IllegalFileNameError, match="20 characters"):
        check_file_name("sixteen_chars_xy.rxe")


@pytest.mark.parametrize("name", ["", "a\0b.rxe", "\u20ac.rxe"])
def test_a_name_that_cannot_be_sent_is_illegal(name):
    with pytest.raises(IllegalFileNameError):
        check_file_name(name)


def test_a_refusal_here_is_caught_like_the_bricks_own():
    with pytest.raises(LoaderError) as caught:
        check_file_name("x" * 20)
    assert caught.value.status is Status.ILLEGAL_FILE_NAME


@pytest.mark.parametrize(
    ("name", "linear"),
    [
        ("a.rxe", True),
        ("A.RXE", True),
        ("a.Sys", True),
        ("a.rtm.old", True),
        (".rxe", False),
        ("a.rso", False),
    ],
)
def test_programs_and_system_files_are_linear(name, linear):
    assert is_linear_name(name) is linear


def test_case_does_not_tell_names_apart_except_beyond_ascii():
    assert fold_case("Demo.RXE") == fold_case("dEMO.rxe")
    assert fold_case("\xc4") != fold_case("\xe4")


@pytest.mark.parametrize(
    ("pattern", "name", "found"),
    [
        ("*.*", "anything", True),
        ("x*.*", "anything", True),
        ("demo.*", "Demo.rxe", True),
        ("demo.*", "demo", False),
        ("demo.*", "my demo.rxe", False),
        ("*.rxe", "DEMO.RXE", True),
        ("*.rxe", "demo.rxe.old", True),
        ("*.rxe", "demo.rx", False),
        ("*.rxelonger", "demo.rxe", True),
        ("demo.rxe", "DEMO.rxe", True),
        ("demo.rxe", "demo.rxe2", False),
        ("de*.rxe", "demo.rxe", False),
        ("d*.*e", "other", True),
        ("*d.*", "d.rxe", False),
        ("*", "demo.rxe", False),
        ("*.r*", "demo.rxe", False),
    ],
)
def test_patterns_find_what_the_firmware_finds(pattern, name, found):
    assert pattern_matches(pattern, name) is found
