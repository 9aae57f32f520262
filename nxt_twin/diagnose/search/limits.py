"""The numbers that a search decides by, and those that bound its work."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class SearchLimits:
    """Limits that an effect must pass. Set on development seeds of the truth families that docs/proof.md names.

    Attributes:
        most_effects: effects that a plant may lack at once.
        gain_nats: least gain of an effect on fitted readings, of which about three pay for the choice.
        silent_nats: that gain where a simulation of two seconds errs by less than the tolerance already.
        windows_nats: that gain where windows of simulation alone decide, as single steps are coloured: so are windows.
        check_nats: least gain on readings that were not fitted.
        half: share of the gain that will do where readings that were not fitted make up for the rest.
        altogether: how many times the least gain both kinds of readings then have to gain together.
        form_share: share of what is explained that a further effect has to gain: an equation whose size is off by a
            fifth leaves as much.
        idle_share: such a share where a silent simulation gets no nearer with a further effect.
        nearer: ratio of errors in free runs up to which `form_share` will do there; in between, the share goes with the
            ratio.
        much_nearer: ratio of errors in free runs that no better equation of the effects found could reach.
        much_nearer_share: share of what is explained that an effect with such a ratio has to gain on all readings.
        keep_nats: least gain of an effect that is in, with readings that were not fitted.
        many_nats: gain from which it does not matter how few moments it comes from.
        loud_nats: gain on readings that were not fitted, from which a small effect has a name. It also has to gain
            `many_nats` and to halve the error in free runs. A presliding of 0.4 deg gained 527 and 223 nats.
        few_moments: least number of moments that a smaller gain of a further effect comes from.
        recurring_nats: gain on readings that were not fitted, from which the moments of a further effect do not matter.
        odd_tolerances: error of a simulation, in tolerances, below which `gain_nats` have to come from other seconds
            than the one in which an effect gains most.
        rival_nats: distance below which two effects cannot be told apart, and what a free curve needs beyond others.
        swap_nats: by how much a rival has to be likelier to take an effect's place.
        rival_ratio: ratio of errors in free runs from which they speak against a likelier rival.
        sure_rival_ratio: that ratio for a rival with states of its own that is likelier by `sure_nats`.
        sure_nats: see `sure_rival_ratio`.
        coincidence_nats: what speaks against an effect whose size happens to hide what would set it apart. Friction hid
            8 of 31 constant loads of the sets 693, 700 and 720 and of two foreign simulators. It hid 16 of 33 of the
            spent range `sixteenth`. The logarithm of the whole share is -0.98. The limit is a little more than
            `swap_nats`, so that friction takes the place of a load where likelihood tells nothing.
        twin_nats: distance up to which likelihood does not tell apart two effects that move a motor alike, but for
            `told_nats`. In the ranges `eighth` and `ninth`, likelihood took the wrong one of such twins in 6 of 8 cases
            at 31 to 78 nats. It took the right one at 258.
        told_nats: distance up to which it does: how a simulation lets a motor stick costs more. In `sixteenth` it was
            for 12 of 14 hidden loads below 10 nats, and for 4 of 15 frictions by direction.
        left_out_nats: what speaks beforehand for a term that plant files mostly state.
        late_polls: mean age, in polls, that doubted readings must exceed. A repeated reading is one poll old, and one
            that is stamped late half a poll or more. A host's jitter is less.
        own_moment_nats: what recordings have to gain each by moments of their own over one session end to end. About
            four of these nats pay for the choice of a moment.
        second_nats: what a second wave of a lag has to gain beside the first, with readings that were not fitted.
    """

    most_effects: int = 4
    gain_nats: float = 8.0
    silent_nats: float = 12.0
    windows_nats: float = 12.0
    check_nats: float = 2.0
    half: float = 0.5
    altogether: float = 1.5
    form_share: float = 0.04
    idle_share: float = 0.25
    nearer: float = 0.65
    much_nearer: float = 0.5
    much_nearer_share: float = 0.02
    keep_nats: float = 3.0
    many_nats: float = 100.0
    loud_nats: float = 40.0
    few_moments: float = 3.5
    recurring_nats: float = 30.0
    odd_tolerances: float = 2.0
    rival_nats: float = 8.0
    swap_nats: float = 1.0
    rival_ratio: float = 1.03
    sure_rival_ratio: float = 1.3
    sure_nats: float = 100.0
    coincidence_nats: float = 1.02
    twin_nats: float = 150.0
    told_nats: float = 10.0
    left_out_nats: float = 3.0
    late_polls: float = 0.25
    own_moment_nats: float = 12.0
    second_nats: float = 15.0


@final
@dataclass(frozen=True)
class SearchEffort:
    """How much is tried.

    Attributes:
        drafted: effects that are fitted roughly beside a structure.
        promised: share of the gain that is needed below which no linear look at an effect has been wrong.
        rivals_drafted: rivals of an effect that are fitted roughly.
        short_list: effects or rivals that are settled at most.
        leading: drafts that are settled where they are not far behind.
        slack_nats: how far behind a draft may be to come out ahead under other noise.
        lifted: how many times a draft's gain other noise makes of it.
        settled_share: share of the best draft's gain below which a draft is not settled.
        in_reach: that share for effects with states, which settle slowly.
        rival_reach_nats: how far behind a rival's draft may be.
        far_reach_nats: that distance for the only rival, to show how far behind it is.
        exchanges: effects exchanged for likelier ones at most.
        better_nats: gain below which a structure has not become another.
        rugged: effects at most that are settled under a first guess of the noise, since their drafts broke a promise.
        losses: shares of lost counts that are settled beside an effect that lies in the angle, of those drafted.
        shares: rounds at most in which an effect is settled from other shares of the friction that a load bears.
        shared_nats: how far behind the likeliest an effect may be to be settled so. On 24 cases of seed 5029 that
            gained up to 123.
        sober: share of the unknown torque under which other starts are followed.
        quiet: share of the unknown torque from which a way is settled once more, where a search begins anew.
        fine: how many times an encoder's step readings have to scatter before held readings are looked for.
        restoring: further effects that are settled from the given numbers where a re-fit has moved these far.
        restoring_nats: what the priors of given numbers cost from which these are far. One number that is off by two of
            its standard deviations costs 2. Coulomb friction that grew fivefold cost 6, and hid a voltage drop.
        second_promised: share of `second_nats` that a second wave has to promise to be fitted.
        comb: starts of a period from which its likelihood has separate peaks.
        anew: ways that a search did not go from which it begins anew, where it ends without an answer.
        beside: found effects at most beside which moments are looked for that each recording has for itself.
    """

    drafted: int = 10
    promised: float = 0.1
    rivals_drafted: int = 4
    short_list: int = 5
    leading: int = 2
    slack_nats: float = 10.0
    lifted: float = 2.5
    settled_share: float = 0.1
    in_reach: float = 0.25
    rival_reach_nats: float = 40.0
    far_reach_nats: float = 400.0
    exchanges: int = 4
    better_nats: float = 1.0
    rugged: int = 2
    losses: int = 3
    shares: int = 3
    shared_nats: float = 150.0
    sober: float = 0.3
    quiet: float = 0.02
    fine: float = 1.5
    restoring: int = 3
    restoring_nats: float = 1.5
    second_promised: float = 0.5
    comb: int = 5
    anew: int = 2
    beside: int = 2


LIMITS = SearchLimits()
EFFORT = SearchEffort()
