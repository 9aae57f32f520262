"""The web viewer's page on this machine alone, with a rule that keeps the browser from talking to anybody else.

rerun's own page asks for fonts and sends usage reports; a content security policy, which browsers enforce, lets it
reach this machine only.
"""

from __future__ import annotations

import threading
import urllib.error
import urllib.request
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Final, final
from urllib.parse import quote

from nxt_twin.view.dashboard.viewer import LOOPBACK

_TIMEOUT_S: Final = 5.0
_LOOK_S: Final = 0.05
_LONGEST_PATH: Final = 80


def page_url(page_port: int, data_port: int) -> str:
    """The address to open in a browser. The page is dark on every machine, as its colours were chosen."""
    data = quote(f"rerun+http://{LOOPBACK}:{data_port}/proxy", safe="")
    return f"http://{LOOPBACK}:{page_port}/?url={data}&renderer=webgl&theme=dark&hide_welcome_screen=1"


def policy(data_port: int) -> str:
    """The rule, as a header's value."""
    own = f"'self' blob: data: http://{LOOPBACK}:{data_port}"
    return (
        f"default-src 'self' blob: data:; connect-src {own}; style-src 'self' 'unsafe-inline'; "
        "script-src 'self' 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval' blob:; font-src 'self' data:"
    )


@final
class Page:
    """Serves the page's parts, which it takes from rerun's own server.

    Args:
        page_port: where browsers come to.
        parts_port: where rerun serves the parts.
        data_port: where the page gets its data.

    Raises:
        OSError: the port is taken.
    """

    def __init__(self, page_port: int, parts_port: int, data_port: int) -> None:
        handler = type("Handler", (_Handler,), {"parts_port": parts_port, "policy": policy(data_port)})
        self._server = ThreadingHTTPServer((LOOPBACK, page_port), handler)
        self._server.daemon_threads = True
        serve = threading.Thread(
            target=self._server.serve_forever, args=(_LOOK_S,), name="dashboard page", daemon=True
        )
        serve.start()

    def close(self) -> None:
        """Serve no longer."""
        self._server.shutdown()
        self._server.server_close()


class _Handler(BaseHTTPRequestHandler):
    parts_port: int
    policy: str

    def do_GET(self) -> None:
        place = self.path.partition("?")[0]
        if len(place) > _LONGEST_PATH or ".." in place:
            self.send_error(404)
            return
        try:
            with urllib.request.urlopen(
                f"http://{LOOPBACK}:{self.parts_port}{place}", timeout=_TIMEOUT_S
            ) as part:
                body, kind = part.read(), part.headers.get("Content-Type", "application/octet-stream")
        except urllib.error.HTTPError as error:
            self.send_error(error.code)
            return
        except OSError:
            self.send_error(502)
            return
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Content-Security-Policy", self.policy)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the name is the base class'
        """Say nothing."""
