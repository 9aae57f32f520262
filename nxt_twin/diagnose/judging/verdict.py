"""The verdict as a pure function of a small record."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

from nxt_twin.diagnose.diagnosis import Verdict


@final
@dataclass(frozen=True)
class VerdictLimits:
    """Where the verdict changes. Set on the development sets that docs/results.md names.

    Decision 32 set `most_left`, `rested`, `sober`, `large_by_windows` and `surprising_by_windows` anew, on 1291 cases.
    These are of ranges 5004 to 5006, spent by then, and of seeds 700 and 720 to 722. With the 1316 cases of range
    `release`, spent as well, `excused`, `shaped` and `surprising` followed.

    Attributes:
        structured_torque: least unknown torque, as a fraction of an ordinary one, that counts as structured.
        most_left: share of all that there was to explain that may be left structured beside found effects.
        hardly: share of the error left below which `surprising` is not asked.
        most_named: effects, beside those that plant files state, that are likely to be missing at once.
        most_stalled: share of a recording in which the host or the link stood still, from which no effect is sure.
        worse: error over that of the re-fitted baseline from which found effects are worse than nothing.
        confirmed: error of windows that check or are held out, over that of the baseline, below which they confirm
            found effects.
        surprising: error on held-out readings, over what noise, scatter and the doubt in parameters let expect, that
            shows physics which no fitted reading shows.
        idle: error over that of the re-fitted baseline above which several effects hardly bring a simulation nearer.
        large_by_windows: unknown torque, as such a fraction, that counts where windows alone tell of it.
        no_nearer: error over that of the re-fitted baseline from which effects that a simulation does not need make
            no difference to it.
        silent: error of a plant over the tolerance below which nothing that matters can be missing beside its effects.
            No law is asked for under less unknown torque beside effects that leave less.
        faint: error of the re-fitted baseline over the tolerance below which little that matters can be missing. Set
            on 5300 answers to spent ranges and to two foreign simulators. Below it, and with less than `sure`, four
            clean motors and one of unknown physics had got a name. Two right names had.
        sure: gain in nats that names such an effect nevertheless.
        unheard: error of the re-fitted baseline over the tolerance below which no ordinary gain in nats names an effect
            that hardly brings a simulation nearer.
        unmistakable: gain in nats from which it does. Set on seeds 720 and 721 of the four families: readings held for
            18 and 22 ms gained 1200 and 5900. Late stamps of clean motors had gained up to 500.
        heard: gain in nats that names an effect which hardly brings a simulation nearer. Set on ranges 5004 to 5006,
            spent by then, and on seeds 700 and 720 to 722. Ten right names gained 179 and more, four of seven wrong
            ones 22 to 55.
        loud: gain in nats that keeps one of several effects which together predict unseen readings worse than none, and
            that no stall of the host explains.
        surprising_by_windows: as `surprising`, where windows alone tell of it: these were fitted, so that they err as
            little on fitted readings as the plant lets them.
        chance: `surprise` up to which chance explains the error that lost counts leave. Set on two foreign sets. Right
            names left up to 1.9, and a clock whose stamps scatter 2.3.
        nearly: remaining error over the tolerance below which `forgiven` and `coloured` are asked of no effect, nor
            `excused` of a plant without one.
        forgiven: unknown torque, as such a fraction, that excuses no error of effects which leave over `cleared` of it.
            Of 1932 answers on the four families and two foreign simulators, right names left at most 0.013 beside such
            an error. Clocks left more, and dry friction of a real drive 0.017. Three names of unknown physics left 0.04
            to 0.07, a quarter to a half of the baseline's.
        shaped: nats that a torque may gain beside a drag or a spring which sets in at the speed or the angle where that
            torque does. More speaks of a law with two sizes.
        half_shaped: as `shaped`, where effects leave more than `hardly` of the error, and more than the tolerance. Set
            on 447 answers to the four families and to a foreign simulator. Beside right names the torque gained less
            than 4 there, beside two drags that set in at a speed 10 and 16.
        rested: nats that a free function of the time at rest may gain beside found effects, none of which goes with
            it. Set on seeds 640 to 647 of the four families. Beside right names it gained up to 27, beside wrong ones
            60 to 465 in four of six cases.
        excused: unknown torque, as such a fraction, above which it excuses no error over `nearly` where nothing was
            found. Set on the answers of `faint`. Clean motors with such an error left up to 0.0057, but for one with
            0.022. Unknown effects that nothing else tells of left 0.0063 and more.
        coloured: colour of single steps from which windows alone may tell of an effect that leaves more of the unseen
            error than `confirmed`. Below it steps are evidence, and had refused the effect. Set on seeds 640 to 647 of
            the four families and on a real servo. It was 1.0 to 1.2 beside three wrong names, 1.6 and 2.9 on the servo.
        sober: nats that a law may gain beside found effects under a soberer unknown torque, where it adds more than
            `most_left` of all gains. Set on seed 700 of the four families. Beside right names it gained up to 40, or
            less than a twentieth of all gains. Beside four of five wrong names it gained 60 to 234.
        cleared: share of the unknown torque of the baseline up to which effects may leave it. Beside right names of
            wandering stamps up to 0.16 was left, beside dry friction of a real drive 0.07. Of two supply dips that
            passed for such stamps 0.20 and 0.26 was left, and beside one right clock 0.23.
        hardly_any: share of the error, on checking and on held-out readings, that a found effect may leave with no near
            relative asked for. The error must lie below `nearly`, too. In 2497 answers, five right names
            left up to 0.052, one wrong pair 0.02, names of unknown physics 0.067 and more.
        moved: factor by which a positive number of the given model may surely change beside found effects. A motor of
            one make differs by a fifth, and a careless guess is off by two. More speaks of another law.
    """

    structured_torque: float = 8.5e-3
    most_left: float = 0.14
    hardly: float = 0.15
    most_named: int = 3
    most_stalled: float = 0.15
    worse: float = 1.05
    confirmed: float = 0.5
    surprising: float = 5.0
    idle: float = 0.85
    large_by_windows: float = 2.8e-2
    no_nearer: float = 0.98
    silent: float = 0.5
    faint: float = 1.6
    sure: float = 40.0
    unheard: float = 1.0
    unmistakable: float = 1000.0
    heard: float = 100.0
    loud: float = 200.0
    surprising_by_windows: float = 1.0
    chance: float = 2.1
    nearly: float = 3.0
    forgiven: float = 1.5e-2
    unforgiven: float = 2e-2
    shaped: float = 18.0
    half_shaped: float = 9.0
    rested: float = 60.0
    excused: float = 6e-3
    coloured: float = 1.4
    sober: float = 60.0
    cleared: float = 0.2
    hardly_any: float = 0.06
    moved: float = 3.0


LIMITS = VerdictLimits()


@final
@dataclass(frozen=True)
class Record:
    """The numbers that a verdict rests on.

    Attributes:
        named: effects found, those left out that plant files mostly state.
        found: whether any effect was found.
        left_nats: how much of the innovations a flexible function of the state predicts.
        left_limit_nats: what it predicts of clean recordings at most.
        gained_nats: what the found effects gained.
        torque_before, torque_after: the unknown torque left by the baseline and by the improved plant, as a fraction
            of an ordinary one.
        run_ratio: error in free runs of the improved plant over that of the baseline, on readings that check.
        matters: whether the remaining error matters: windows of at most two seconds err by more than the
            tolerance. Where effects were found, they must also exceed the floor or hardly improve on the
            baseline.
        worst_ratio: largest error of the improved plant over that of the baseline, of windows of two seconds or shorter
            where it matters.
        stalled_share: largest share of a recording's time in which the host or the link stood still.
        surprise: error of the improved plant on held-out readings over what noise, scatter and the doubt in its
            parameters let expect there.
        by_windows: whether windows of simulation alone chose the effects, as single steps are coloured.
        nearer: error of the improved plant on held-out readings over that of the baseline.
        longer: largest error of the improved plant over that of the baseline, of simulations longer than two seconds
            that err by more than the tolerance.
        least_nats: what speaks for the weakest of the found effects.
        of_readings: whether all found effects are faults of the readings.
        doubts: whether that effect doubts readings. Errors leave these out, so that none gets less by it.
        restores: whether that effect brings given numbers back which a re-fit had to move far without it.
        remaining: largest error of the improved plant over the tolerance, of windows of two seconds or shorter.
        at_first: largest error of the baseline over the tolerance, of windows of two seconds or shorter.
        at_check: error of the baseline over the tolerance, in free runs over readings that check.
        rested_nats: the most that a free function of the time at rest gains beside found effects that are torques
            without states of their own. One of them must show at low speed, at any angle. A bristle, a second body,
            or an error of the readings goes with rests too.
        kin_nats: the most that a torque which sets in at a speed or an angle gains beside found effects that go with
            this alone.
        colour: how many readings of the improved plant count as one, over how many of clean recordings do.
        sober_nats: the most that a law of speed, angle, time or command gains beside the found effects, under less
            unknown torque than was estimated.
        strained: whether a parameter of a found effect rests on its upper bound, or two effects together are one law
            that acts one way only.
        moved: the largest factor by which a positive number of the given model surely changed, at 95 %.
        by_chance: whether counts are lost by chance, so that no simulation follows the readings.
        helps: whether the search refused what was found, which helps without explaining.
        leaves_most: whether more than half of the baseline's error on held-out readings is left at some horizon, and
            more than the tolerance. Errors count above those that `surprise` is held against.
        loose: whether the 95 % interval of a found effect's size is wider than the size.
        given_is_a_fit: whether no re-fit of the given numbers comes as near to fitted readings as they do, so that they
            were fitted to such readings.
    """

    named: int
    found: bool
    left_nats: float
    left_limit_nats: float
    gained_nats: float
    torque_before: float
    torque_after: float
    run_ratio: float
    matters: bool
    worst_ratio: float
    stalled_share: float
    surprise: float
    by_windows: bool
    nearer: float
    least_nats: float
    remaining: float
    longer: float = 0.0
    at_first: float = math.inf
    at_check: float = 0.0
    restores: bool = False
    doubts: bool = False
    of_readings: bool = False
    rested_nats: float = 0.0
    kin_nats: float = 0.0
    colour: float = math.inf
    sober_nats: float = 0.0
    strained: bool = False
    moved: float = 1.0
    by_chance: bool = False
    helps: bool = False
    leaves_most: bool = False
    loose: bool = False
    given_is_a_fit: bool = False


def verdict_of(record: Record, limits: VerdictLimits = LIMITS) -> Verdict:
    """Adequate, explained or unexplained."""
    missing = record.matters and _lacks_more(record, limits)
    if not record.found:
        return "unexplained" if missing else "adequate"
    if record.helps:
        return "unexplained"
    doubtful = is_patchwork(record, limits) or is_stalled(record, limits) or is_loose(record)
    forgiven = is_forgiven(record, limits) or is_contradicted(record, limits) or is_in_vain(record, limits)
    other = is_another_law(record, limits) or is_moved(record, limits)
    return "unexplained" if missing or doubtful or forgiven or other else "explained"


def is_patchwork(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether it took more effects than are likely to be missing at once, so that they stand for something else."""
    return record.named > limits.most_named


def is_moved(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether the found effects surely need other numbers of the motor than the given ones, by more than a doubt.

    Numbers that were fitted without these effects say nothing of the motor. Nor do those of a careless guess, where the
    effects take nearly all of the error: no other law is left to speak of.
    """
    objected = record.found and record.moved > limits.moved
    return objected and not record.given_is_a_fit and not _takes_nearly_all(record, limits)


def is_loose(record: Record) -> bool:
    """Whether an error that matters is left, and readings fix the size of a found effect to no better than itself."""
    return record.found and record.loose and record.remaining > 1.0


def is_in_vain(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether found effects leave most of the error at some horizon, unless chance explains a good part of it."""
    return record.leaves_most and not (record.by_chance and record.surprise <= limits.chance)


def is_unseen(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether something is missing that held-out readings alone show: those that check are explained."""
    missing = verdict_of(record, limits) == "unexplained" and record.surprise > limits.surprising
    return missing and record.at_check * record.run_ratio <= limits.nearly


def is_stalled(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether the host or the link stood still for too long to trust what the stamps say.

    One effect that leaves no error above the tolerance, or hardly any of the error, is trusted nevertheless. No stall
    explains the rest of a recording. So are several that are all loud.
    """
    alone = record.named <= 1 and _takes_nearly_all(record, limits)
    in_doubt = (record.matters and not alone) or (record.named > 1 and record.least_nats < limits.loud)
    return record.stalled_share > limits.most_stalled and in_doubt


def leaves_little(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether more than noise is left, and less of it than the tolerance."""
    return record.remaining <= 1.0 and not record.matters and _lacks_more(record, limits)


def is_idle(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether several effects were found that hardly bring a simulation nearer, though it is not near.

    Not those of which each is unmistakable: readings that are held err as they do, however right the plant is.
    """
    quietly = record.least_nats < limits.unmistakable
    return record.named > 1 and record.matters and record.nearer > limits.idle and quietly


def is_spoiled(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether several effects were found that together predict unseen readings worse than none, one of them quietly."""
    quietly = record.least_nats < limits.loud
    return record.named > 1 and record.matters and record.nearer > limits.worse and quietly


def is_needless(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether single steps call for an effect, and not loudly, that no simulation needs.

    It makes no difference to one, or none that matters. What brings given numbers back need not make any: the numbers
    in their place simulate as well. Where no simulation gains much, only a clear call counts. It has to be unmistakable
    where the baseline errs by less than matters. No call counts where the effect needs other numbers of the motor as
    well: those may be all that the readings call for. Nor does one for a fault of the readings beside which the motor
    simulates worse. That readings of a servo are up to 8 ms old says nothing of its motor. A payload may hang in all
    that is held out, so that an inertia stands for it there: then simulations of what checks tell.
    """
    if not record.found or record.restores:
        return False
    if record.of_readings and not record.doubts and record.nearer > limits.worse:
        return True
    hardly = record.nearer > limits.idle and not 0.0 < record.longer < limits.idle
    hardly &= record.run_ratio > limits.confirmed or record.at_check < limits.unheard
    asked = limits.unmistakable if record.at_first < limits.unheard else limits.heard
    if hardly and not record.doubts and (record.moved > limits.moved or record.least_nats < asked):
        return True
    faint = limits.faint if record.named <= 1 else limits.silent
    unneeded = record.nearer >= limits.no_nearer or record.at_first < faint
    return unneeded and record.least_nats < limits.sure


def counted_once(record: Record) -> Record:
    """`record` whose weakest effect has as many nats as its readings are worth where several tell of one another.

    A found effect that holds readings, or stamps them late, colours single steps, and each counts for its neighbours.
    """
    alike = record.colour if math.isfinite(record.colour) else 1.0
    return replace(record, least_nats=record.least_nats / max(alike, 1.0))


def may_be_superfluous(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether so little speaks for the weakest of several effects that it is weighed beside the others alone."""
    return record.named > 1 and record.least_nats < limits.heard and not record.restores


def is_superfluous(beside: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether the weakest of several effects goes, as little speaks for it and the others do as well alone.

    `beside` compares the plant with the one that lacks this effect, and not with the baseline. The effect is needless
    there, or makes one window worse and none much better.
    """
    worse = beside.worst_ratio > limits.worse and beside.nearer > limits.idle
    return may_be_superfluous(beside, limits) and (is_needless(beside, limits) or worse)


def is_forgiven(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether found effects leave an error that only the unknown torque excuses, which they were to explain.

    The floor that a remaining error is compared with rests on that torque. So a large one may not excuse the error,
    unless the effects have taken four fifths of it. Nor is more excused for as many effects as can be missing than
    without an effect. More than `unforgiven` is excused only where they have taken nearly all of torque and error.
    By windows alone, how much there was before is not known, and how much is left counts.
    """
    if not record.found or record.remaining <= limits.nearly:
        return False
    if record.by_windows:
        return record.torque_after > limits.large_by_windows
    kept = record.torque_after / max(record.torque_before, 1e-15)
    large = record.torque_after > limits.forgiven
    if record.of_readings:  # which are torques to no filter
        return large and not _is_cleared(record, limits)
    many = record.named >= limits.most_named and record.torque_after > limits.excused
    taken = kept <= limits.hardly and _takes_nearly_all(record, limits)
    return (
        (large and kept > limits.cleared) or many or (record.torque_after > limits.unforgiven and not taken)
    )


def is_another_law(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether the found effects stand for a near relative, which goes otherwise with speed, angle or time.

    No effect goes with the time at rest. Readings that call for such a law speak against a found effect however small
    the error is. So does an effect that is strained to a law which it is not. Unless hardly an error is left, readings
    that call for a drag or a spring which sets in somewhere speak against it, too. Where a good part of the error is
    left, they need not do so as loudly. So do those that call for any law once less unknown torque stands for it.
    """
    if is_swallowed(record, limits) or (
        record.found and (record.strained or record.rested_nats > limits.rested)
    ):
        return True
    much = record.remaining > 1.0 and not _takes_nearly_all(record, limits)
    asked = limits.half_shaped if much else limits.shaped
    return record.found and record.kin_nats > asked and not _leaves_hardly_any(record, limits)


def is_swallowed(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether the unknown torque stands for a law that goes with speed, angle, time or command.

    Fitted readings call for that law beside all that the effects gained, once less of the torque is allowed. By windows
    alone it is asked where single steps are evidence. What brings given numbers back gains by those, and not by
    readings: so no share tells, and it is not asked. Nor is it where less than half of the tolerance is left: beside a
    right name, the equations of another simulator leave as much. Faults of the readings move no motor: beside them, all
    of the tolerance may be left.
    """
    told = (not record.by_windows or record.colour < limits.coloured) and not record.restores
    little = record.remaining <= (1.0 if record.of_readings else limits.silent)
    hardly = little or _leaves_hardly_any(record, limits)
    heard = record.found and not hardly and not _is_cleared(record, limits)
    share = record.sober_nats / max(record.sober_nats + max(record.gained_nats, 0.0), 1e-15)
    return heard and told and record.sober_nats > limits.sober and share > limits.most_left


def is_contradicted(record: Record, limits: VerdictLimits = LIMITS) -> bool:
    """Whether windows alone tell of effects that leave most of an error, though single steps are evidence too.

    Steps are asked first. They refused the effects, and no longer go on in one another once these are in.
    """
    if not record.found or not record.by_windows or record.remaining <= limits.nearly:
        return False
    return record.colour < limits.coloured and record.nearer > limits.confirmed


def _lacks_more(record: Record, limits: VerdictLimits) -> bool:
    """Whether what is left is more than noise."""
    structured = record.left_nats > record.left_limit_nats and record.torque_after > limits.structured_torque
    large = record.by_windows and record.torque_after > limits.large_by_windows
    surprising = record.surprise > (limits.surprising_by_windows if record.by_windows else limits.surprising)
    if not record.found:
        return structured or large or surprising or _is_pushed(record, limits)
    mostly_left = structured and record.left_nats > limits.most_left * (record.left_nats + record.gained_nats)
    return mostly_left or (surprising and record.nearer > limits.hardly)


def _takes_nearly_all(record: Record, limits: VerdictLimits) -> bool:
    """Whether found effects leave hardly any of the error, on readings that check and on those that are held out."""
    return max(record.nearer, record.run_ratio) <= limits.hardly


def _leaves_hardly_any(record: Record, limits: VerdictLimits) -> bool:
    """Whether a simulation errs little, and by hardly any of what it did without the found effects."""
    return record.remaining <= limits.nearly and max(record.nearer, record.run_ratio) <= limits.hardly_any


def _is_pushed(record: Record, limits: VerdictLimits) -> bool:
    """Whether a plant without a found effect errs by much that only its unknown torque excuses.

    Not asked where windows alone tell: clean motors and those of a real servo leave such a torque there.
    """
    pushed = record.remaining > limits.nearly and record.torque_after > limits.excused
    return pushed and not record.by_windows


def _is_cleared(record: Record, limits: VerdictLimits) -> bool:
    """Whether faults of the readings take most of the unknown torque away, and halve an error that is no surprise.

    A stamp that is off looks like a torque to a filter. What another course of its error leaves of it is no objection.
    """
    kept = record.torque_after / max(record.torque_before, 1e-15)
    halved = record.nearer < limits.confirmed and record.surprise < 1.0
    return record.of_readings and halved and kept <= limits.cleared
