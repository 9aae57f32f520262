"""The site's search works in a page opened from the disk, where browsers start no worker."""

import os
import shutil

import pytest

CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
WORKER = "addEventListener('message', ({data}) => importScripts(data.file).then(() => postMessage(added + data.ask)))"
PAGE = """<script src="iframe-worker.js"></script><script>
const worker = new Worker("worker.js?v=1&w=2");
worker.addEventListener("message", ({data}) => document.title = data);
worker.postMessage({file: "added.js", ask: 2});
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_a_page_from_the_disk_gets_answers_as_from_a_worker(root, tmp_path):
    playwright = pytest.importorskip("playwright.sync_api")
    shutil.copy(root / "docs" / "iframe-worker.js", tmp_path)
    for name, text in (("page.html", PAGE), ("worker.js", WORKER), ("added.js", "var added = 40")):
        (tmp_path / name).write_text(text, encoding="utf-8")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page()
        page.goto((tmp_path / "page.html").as_uri())
        page.wait_for_function("document.title === '42'", timeout=60_000)
        assert page.title() == "42"
        browser.close()
