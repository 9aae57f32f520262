"""The check of words finds what docs/writing.md forbids, and nothing else."""

import importlib.util
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).parents[2] / "tools"


@pytest.fixture(scope="module")
def house_words():
    sys.path.insert(0, str(TOOLS))  # its own neighbours are imported by their bare names
    spec = importlib.util.spec_from_file_location("house_words", TOOLS / "house_words.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.path.remove(str(TOOLS))
    return module


def findings(house_words, tmp_path, text):
    code = sys.modules["house_code"]
    for name in (*house_words.PAGES, *code.ROOMS, *code.SPEAKERS):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix:
            path.write_text("", encoding="utf-8")
        else:
            path.mkdir(exist_ok=True)
    (tmp_path / "README.md").write_text(text, encoding="utf-8")
    return list(house_words.words(tmp_path))


LONG = " ".join(["word"] * 26)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (f"{LONG}.\n", "README.md:1: a sentence of 26 words"),
        (f"Short.\n\n- item\n- {LONG}\n", "README.md:4: a sentence of 26 words"),
        ("It foretells a reading.\n", "write predict"),
        ("What is left is noise.\n", "as the subject"),
        ("The other is the same.\n", "write the noun"),
    ],
)
def test_a_page_that_breaks_a_rule_is_named(house_words, tmp_path, text, complaint):
    assert any(complaint in found for found in findings(house_words, tmp_path, text))


@pytest.mark.parametrize(
    "text",
    [
        f"    {LONG}\n",
        f"| {LONG} | cell |\n",
        "One. Two. `What is left`.\n",
        f"{' '.join(['word'] * 25)}. Next.\n",
    ],
)
def test_code_tables_and_short_sentences_are_left_alone(house_words, tmp_path, text):
    assert findings(house_words, tmp_path, text) == []


def in_code(house_words, tmp_path, text):
    findings(house_words, tmp_path, "")
    (tmp_path / "nxt_twin/room").mkdir()
    (tmp_path / "nxt_twin/room/file.py").write_text(text, encoding="utf-8")
    return list(house_words.words(tmp_path))


@pytest.mark.parametrize("text", [f'"""{LONG}."""\n', f'def told():\n    """Say."""\n    return "{LONG}"\n'])
def test_any_room_s_docstring_or_sentence_that_breaks_a_rule_is_named(house_words, tmp_path, text):
    assert any("nxt_twin/room/file.py" in found for found in in_code(house_words, tmp_path, text))


@pytest.mark.parametrize("text", [f'def _inner():\n    """{LONG}."""\n', f'TABLE = "a {LONG}\\nb"\n'])
def test_private_docstrings_and_tables_are_left_alone(house_words, tmp_path, text):
    assert in_code(house_words, tmp_path, text) == []


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (f"<p>\n{LONG} {{{{ value }}}}</p>", ":2: a sentence of 27 words"),
        (f"<p>{{% if a > 1 %}}{LONG}{{% else %}}short{{% endif %}}</p>", ":1: a sentence of 26 words"),
        ("<p>Short.</p>\n<li>It foretells.</li>", ":2: 'foretells': write predict"),
    ],
)
def test_a_template_that_breaks_a_rule_is_named(house_words, tmp_path, text, complaint):
    (found,) = in_template(house_words, tmp_path, text)
    assert found.startswith(f"nxt_twin/page.html.j2{complaint}")


@pytest.mark.parametrize(
    "text",
    [
        f"<style>{LONG}</style><p>{{# {LONG} #}}</p>",
        f"<p>{'word ' * 13}</p><p>{'word ' * 13}</p>",
        f"<p>{{% if a %}}{'word ' * 15}{{% else %}}{'term ' * 14}{{% endif %}}</p>",
    ],
)
def test_styles_remarks_and_branches_are_no_long_sentence(house_words, tmp_path, text):
    assert in_template(house_words, tmp_path, text) == []


def in_template(house_words, tmp_path, text):
    findings(house_words, tmp_path, "")
    (tmp_path / "nxt_twin/page.html.j2").write_text(text, encoding="utf-8")
    return list(house_words.words(tmp_path))
