"""Audit the locked packages, those of all extras among them, for known vulnerabilities, by pip-audit.

It says so where no network lets it.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Final

_LOCK: Final = Path(__file__).parents[1] / "requirements" / "dev.lock"
_NO_NETWORK: Final = re.compile(
    r"ConnectionError|ConnectTimeout|ReadTimeout|ProxyError|SSLError|Max retries|name resolution|unreachable"
    r"|Failed to resolve"
)


def main() -> int:
    """Print each vulnerability that is known; 1 if there is one, 0 also where no index was reached."""
    command = [sys.executable, "-m", "pip_audit", "--format", "json", "--progress-spinner", "off"]
    command += ["--requirement", str(_LOCK), "--require-hashes", "--disable-pip"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    status, lines = judged(done.stdout, done.stderr)
    print(*lines, sep="\n")
    return status


def judged(out: str, err: str) -> tuple[int, list[str]]:
    """The exit status and the lines to print for what pip-audit said on standard output and standard error."""
    try:
        packages = json.loads(out)["dependencies"]
    except (ValueError, KeyError):
        last = (err.strip().splitlines() or ["pip-audit said nothing"])[-1]
        if _NO_NETWORK.search(err):
            return 0, ["NOT audited: the package index was not reached. Run make audit again with a network."]
        return 1, [f"pip-audit failed: {last}"]
    found = [
        f"{one['name']} {one['version']}: {known['id']}, mended in {', '.join(known['fix_versions']) or 'no version'}"
        for one in packages
        for known in one.get("vulns", ())
    ]
    return (1, found) if found else (0, [f"{len(packages)} locked packages, no known vulnerability"])


if __name__ == "__main__":
    sys.exit(main())
