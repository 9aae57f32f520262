"""A matplotlib figure as SVG text that can stand inside a page: no network, no date, no clashing ids."""

from __future__ import annotations

import io
import re
from html import escape

import matplotlib as mpl
from matplotlib.figure import Figure

from nxt_twin.view import palette
from nxt_twin.view.stacking import stack

_FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif"
_NO_DATE = {"Date": None}
_CURVED = re.compile(r"[CQ]")
_HEX = re.compile(r"#[0-9a-fA-F]{6}\b")
_VARIABLES = {"#ffffff": "var(--page)"} | {
    getattr(palette, name): f"var(--c-{name.lower().replace('_', '-')})" for name in palette.THEMED
}


def drawn_svg(figure: Figure) -> str:
    """The figure as a whole SVG document; the same figure gives the same text."""
    text = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "nxt-twin"}):
        figure.savefig(text, format="svg", metadata=_NO_DATE)
    return _with_system_font(text.getvalue())


def inline_svg(figure: Figure, key: str, label: str) -> str:
    """The figure as two `<svg>` elements for a page, of which its style shows one: wide, or stacked for a phone.

    Their colours are the style's variables, so that they follow its dark mode.

    Args:
        figure: what to draw; it is left stacked.
        key: a prefix that makes the ids of this picture its own within the page.
        label: what the picture shows, for those who cannot see it.
    """
    wide = _element(drawn_svg(figure), key, label)
    stack(figure)
    narrow = _element(drawn_svg(figure), f"{key}n", label)
    return f'<div class="wide">{wide}</div><div class="narrow">{narrow}</div>'


def _element(document: str, key: str, label: str) -> str:
    body = document[document.index("<svg") :].strip()
    body = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", body, flags=re.DOTALL)
    body = body.replace("xlink:href=", "href=")
    body = re.sub(r' d="[^"]*"', _rounded, body, flags=re.DOTALL)
    body = re.sub(r">\s+<", "><", _own_ids(body, key))
    view_box = re.search(r'viewBox="[^"]*"', body)
    opening = f'<svg role="img" aria-label="{escape(label)}" {view_box.group() if view_box else ""}>'
    return opening + _themed(body[body.index(">") + 1 :])


def _themed(svg: str) -> str:
    """The house's colours as variables of the page's style."""
    return _HEX.sub(lambda found: _VARIABLES.get(found.group().lower(), found.group()), svg)


def _with_system_font(svg: str) -> str:
    return re.sub(r"'DejaVu Sans'[^;\"]*", _FONT, svg)


def _rounded(path: re.Match[str]) -> str:
    """A path in steps of a tenth of a point; it says each point once, and leaves out letters that a reader adds."""
    numbers = re.sub(r"-?\d+\.\d{2,}", lambda found: f"{float(found.group()):.1f}", path.group())
    dots = re.sub(r"M (\S+) (\S+) L \1 \2 ", r"M\1 \2h0", re.sub(r"\s+", " ", numbers))
    if _CURVED.search(dots):
        return dots
    return re.sub(r"(?<=\d) L (?=[-\d])", " ", re.sub(r"(?: L (\S+ \S+))(?: L \1(?= ))+", r" L \1", dots))


def _own_ids(svg: str, key: str) -> str:
    used = set(re.findall(r'(?:url\(|href=")#([^)"]+)', svg))
    svg = re.sub(r' id="([^"]+)"', lambda found: found.group() if found.group(1) in used else "", svg)
    svg = re.sub(r' id="', f' id="{key}-', svg)
    return re.sub(r'(url\(|href=")#', rf"\g<1>#{key}-", svg)
