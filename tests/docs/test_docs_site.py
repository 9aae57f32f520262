"""The site's own parts: pages that no file holds, links that leave docs/, and nothing asked of another machine."""

import pytest


@pytest.mark.parametrize(
    ("source", "target", "kept"),
    [
        ("README.md", "docs/api.md", "api.md"),
        ("docs/api.md", "../examples/user_effect", "examples/user_effect.md"),
        ("docs/stability.md", "../CHANGELOG.md", "changelog.md"),
        ("docs/testing.md", "../examples/ci/README.md", "examples/ci.md"),
        ("examples/ci/README.md", "../../docs/testing.md", "testing.md"),
        ("docs/decisions/README.md", "template.md", "decisions/template.md"),
        ("docs/api.md", "../nxt_twin/api/files.py", None),
    ],
)
def test_a_link_leads_where_the_site_keeps_the_page(source, target, kept):
    import site_pages

    assert site_pages.placed(source, target) == kept


@pytest.mark.parametrize(
    ("html", "loaded"),
    [
        ('<script src="https://cdn.example/x.js"></script>', "https://cdn.example/x.js"),
        ('<link rel="stylesheet" href="//fonts.example/f.css">', "//fonts.example/f.css"),
        ('<p style="background: url(https://a.example/p.png)">', "https://a.example/p.png"),
        ("<style>@import 'https://a.example/s.css'</style>", "https://a.example/s.css"),
    ],
)
def test_a_page_that_loads_from_elsewhere_is_named(tmp_path, html, loaded):
    import site_assets

    (tmp_path / "page.html").write_text(html)
    assert list(site_assets.asked_elsewhere(tmp_path)) == [f"page.html: loads {loaded}"]


def test_links_for_readers_and_files_of_the_site_are_left_alone(tmp_path):
    import site_assets

    (tmp_path / "page.html").write_text('<a href="https://semver.org">s</a><img src="images/demo.png">')
    assert list(site_assets.asked_elsewhere(tmp_path)) == []


def test_the_page_of_commands_has_every_command_and_every_option():
    import cli_page

    text = cli_page.page()
    told = dict(cli_page.commands())
    assert {"diagnose", "blind make", "mock"} <= set(told)
    for names, command in told.items():
        assert f" {names}\n" in text
        options = [one for one in cli_page.parameters(command) if one.param_type_name == "option"]
        assert all(name in text for one in options for name in one.opts)


def test_a_long_name_in_a_table_breaks_between_its_words():
    import site_pages

    page = "<p><code>row_lags</code></p><td><code>row_lags</code> or <a><code>nxt_twin/cli</code></a></td>"
    told = "<td><code>row_<wbr>lags</code> or <a><code>nxt_<wbr>twin/<wbr>cli</code></a></td>"
    assert site_pages.on_post_page(page) == "<p><code>row_lags</code></p>" + told
