"""URLs that nobody would write: each is refused in one line."""

import pytest

from nxt_twin.api.openers import OPENERS
from nxt_twin.brick.errors import LinkError
from nxt_twin.brick.open import open_link
from nxt_twin.errors import LONGEST_LINE, NxtTwinError
from nxt_twin.mock.run import parse_address
from nxt_twin.mock.serve.clock import VirtualClock


@pytest.mark.parametrize(
    "url",
    [
        "tcp:a..b:7000",
        "tcp:" + "a" * 300 + ":7000",
        "tcp:localhost:" + "7" * 5000,
        "mock:?seed=" + "7" * 5000,
        "mock:?seed=٣",
        "mock:?conceal=" + "7" * 5000,
        "mock:?world=" + "w" * 5000,
        "mock:?world=a%00b",
        "serial:a\0b",
        "bt:ﬀ:16:53:01:02:03",
        "x" * 5000,
    ],
)
def test_a_url_that_leads_nowhere_is_refused_in_one_line(url):
    with pytest.raises(NxtTwinError) as caught:
        open_link(url, VirtualClock(), OPENERS)
    assert len(str(caught.value)) <= LONGEST_LINE
    assert "\n" not in str(caught.value)


def test_a_port_of_many_digits_is_no_place_to_listen_at():
    with pytest.raises(NxtTwinError, match="is not HOST:PORT"):
        parse_address("localhost:" + "7" * 5000)


def test_a_name_with_two_dots_in_a_row_is_told_as_such():
    with pytest.raises(LinkError, match="is no host's name"):
        open_link("tcp:a..b:7000", VirtualClock(), OPENERS)
