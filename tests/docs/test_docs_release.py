"""The release's tools: an audit that says when it did not happen, and the page of licences."""

import json

import pytest


def dependencies(*vulns):
    return json.dumps({"dependencies": [{"name": "numpy", "version": "2.0", "vulns": list(vulns)}]})


@pytest.mark.parametrize(
    ("out", "err", "status", "said"),
    [
        (dependencies(), "", 0, "1 locked packages, no known vulnerability"),
        (dependencies({"id": "CVE-1", "fix_versions": ["2.1"]}), "", 1, "numpy 2.0: CVE-1, mended in 2.1"),
        ("", "ConnectionError: Max retries exceeded", 0, "NOT audited"),
        ("", "ERROR: no such option", 1, "pip-audit failed: ERROR: no such option"),
    ],
)
def test_an_audit_fails_on_a_vulnerability_and_not_on_a_missing_network(out, err, status, said):
    import audit

    judged, lines = audit.judged(out, err)
    assert judged == status
    assert lines[0].startswith(said)


def test_the_page_of_licences_names_every_package_that_the_core_brings(root):
    import closures

    page = (root / "docs" / "licences.md").read_text(encoding="utf-8")
    core = closures.brought()
    assert {"numpy", "numba", "llvmlite"} <= set(core)
    assert [name for name in core if f"| {name} |" not in page] == []
