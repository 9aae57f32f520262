"""The host's latency: every log has some, and it is no missing physics."""

from __future__ import annotations

from collections.abc import Sequence

from nxt_twin.diagnose.fitting.fits import Fits
from nxt_twin.diagnose.fitting.structure import Structure
from nxt_twin.diagnose.search.limits import LIMITS
from nxt_twin.diagnose.search.notable import is_too_small
from nxt_twin.diagnose.search.settled import Settled
from nxt_twin.diagnose.search.weight import weigh
from nxt_twin.physics.effect import Effect

_TYPICAL_S = 1e-3
"""What a link and a host need from a row's stamp until its command acts, s; a fit begins here."""


def after_latency(
    fits: Fits, settled: Settled, baseline: Structure, candidates: Sequence[Effect]
) -> Structure:
    """`baseline` with the time that commands take, where the readings tell of one that is too short for a name.

    Without it a search finds laws that lag where a motor turns back, since these do nearly alike.
    """
    effect = next((one for one in candidates if "delay" in one.terms), None)
    if effect is None:
        return baseline
    start = baseline.plant.with_effect(effect.id, {effect.parameters[0].symbol: _TYPICAL_S})
    promised = fits.promised(baseline, [start])
    if not promised or promised[0][1] < LIMITS.gain_nats:
        return baseline
    trial = settled.settle(start, baseline.noise)
    weight = weigh(baseline, trial)
    told = weight.gain > LIMITS.gain_nats and weight.borne_out(LIMITS.check_nats)
    return trial if told and is_too_small(trial.plant, effect, fits.problem.scale) else baseline
