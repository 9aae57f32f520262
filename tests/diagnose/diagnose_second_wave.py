"""A search's second look at a lag that wanders, with fits that say what they are told to."""

from types import SimpleNamespace

from nxt_twin.diagnose.search.second_wave import with_second_wave


def has_second_wave(promised: float, gained: float) -> bool:
    """Whether a second wave that promises and gains so many nats is taken."""
    draft = SimpleNamespace(cost=-gained, fitted=SimpleNamespace(plant="two waves"))
    fits = SimpleNamespace(
        second_waves=lambda *_: [(promised, "two waves")],
        draft=lambda *_, **__: draft,
        drafted_cost=lambda *_: 0.0,
        second_wave_alone=lambda *_: None,
    )
    trial = SimpleNamespace(noise=None, plant="one wave")
    settled = SimpleNamespace(settle=lambda plant, _: SimpleNamespace(noise=None, plant=plant))
    return with_second_wave(fits, settled, trial, None).plant == "two waves"
