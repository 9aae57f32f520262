"""The sentences of a motor's diagnosis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from nxt_twin.diagnose.diagnosis import Excitation, Fit, FoundEffect, NextExperiment, Verdict
from nxt_twin.diagnose.judging.confusion import Alike
from nxt_twin.diagnose.search.rivals import Rival
from nxt_twin.physics.effect import Effect
from nxt_twin.physics.library import library

FAULTS = frozenset(effect.id for effect in library().values() if effect.fault)

_MOST_NAMED = 4  # effects that a sentence names as unseen; it counts further ones
_HELPS = 0.95  # of the baseline's error: from there on a sentence claims no smaller error
_ALIKE = 0.6  # cosine of two traces from which their likeness is told
_LITTLE_NATS = 5.0  # expected evidence below which a proposed recording is said to tell little


def sentence(
    verdict: Verdict,
    effects: Sequence[FoundEffect],
    fit: Fit,
    excitation: Excitation | None = None,
    names: Mapping[str, str] | None = None,
    *,
    patchwork: bool = False,
    instead: str = "",
    loose: bool = False,
) -> str:
    """The verdict with its figures, for a person; at most two sentences.

    `names` gives the names of the effects that `excitation` could not have shown, by id. `patchwork` says that more
    effects were needed than are likely to be missing at once. `instead` is what given numbers would have to be far off
    in, were nothing missing. `loose` says that an adequate model errs by much, as its parameters are open.
    """
    figures = f"from {fit.baseline:.3g} to {fit.improved:.3g} {fit.unit} on held-out data"
    named = listed([effect.name for effect in effects])
    helps = "help" if len(effects) > 1 else "helps"
    reduces, stands = ("reduce", "stand") if len(effects) > 1 else ("reduces", "stands")
    if verdict == "adequate":
        return _adequate(fit, excitation, names or {}, loose=loose)
    if verdict == "explained":
        return _explained(effects, fit, instead)
    if effects and not fit.improved < _HELPS * fit.baseline:
        return (
            f"Something is missing, and no known effect accounts for it. With {named}, one-step prediction improves; "
            f"simulation of held-out data stays {fit.improved:.3g} {fit.unit} off."
        )
    if effects and patchwork:
        return (
            f"Something is missing, and no known effect accounts for it. {_opening(named)} {reduces} the error "
            f"{figures}, but more likely {stands} for one unknown effect."
        )
    if effects:
        return (
            f"Something is missing, and no known effect accounts for all of it. {_opening(named)} {helps} ({figures}); "
            f"the rest is more than noise."
        )
    return (
        "Something is missing, and it is no effect that nxt-twin knows; "
        f"the free-run error on held-out data stays at {fit.improved:.3g} {fit.unit}."
    )


def _adequate(fit: Fit, excitation: Excitation | None, names: Mapping[str, str], *, loose: bool) -> str:
    poor = excitation is not None and not excitation.enough
    unseen = f" They could not have shown {_unseen(excitation, names)}." if excitation and poor else ""
    figure = f"{fit.improved:.3g} {fit.unit}"
    if loose:
        return (
            f"No missing physics shows, but the fitted recordings leave the parameters open: the model is {figure} "
            f"off on held-out data.{unseen}"
        )
    if poor:
        told = "Nothing is missing as far as these recordings can tell"
        return f"{told}: the model predicts held-out data to {figure}.{unseen}"
    return (
        f"Nothing is missing: with its parameters fitted again, the model predicts held-out data to {figure}."
    )


def _explained(effects: Sequence[FoundEffect], fit: Fit, instead: str) -> str:
    named = listed([effect.name for effect in effects])
    those = "these" if len(effects) > 1 else "it"
    if all(effect.id in FAULTS for effect in effects):
        return f"No physics is missing: the recording itself has a fault, {named}."
    if fit.improved < _HELPS * fit.baseline:
        figures = f"from {fit.baseline:.3g} to {fit.improved:.3g} {fit.unit} on held-out data"
        return f"The model leaves out {named}; with {those} in, the free-run error falls {figures}."
    if instead:
        return (
            f"The model leaves out {named}, or numbers in it are far off: {instead}. Both predict held-out data alike, "
            f"to {fit.improved:.3g} {fit.unit}; the given numbers speak for {named}."
        )
    return (
        f"The model leaves out {named}. With {those}, one-step prediction improves; simulation of held-out data "
        f"does not ({fit.baseline:.3g} {fit.unit} off, now {fit.improved:.3g})."
    )


def loose(effects: Sequence[FoundEffect]) -> tuple[str, ...]:
    """A sentence on found effects whose size has a 95 % interval wider than itself, if there are any.

    The size is an effect's first parameter. A ratio stands for it where the recordings fix that alone.
    """
    sizes = [(effect.name, next(iter(effect.params.values()), None)) for effect in effects]
    names = [name for name, size in sizes if size and size.is_loose]
    if not names:
        return ()
    if len(names) > 1:
        return (
            f"The sizes of {listed(names)} are loose: each has a 95 % interval that is wider than the size.",
        )
    return (f"The size of {names[0]} is loose: its 95 % interval is wider than the size.",)


def too_small(names: Sequence[str]) -> tuple[str, ...]:
    """A sentence on effects that are significant and that no simulation needs, if there are any."""
    if not names:
        return ()
    verb, fate = ("improve", "they are") if len(names) > 1 else ("improves", "it is")
    return (
        f"{_opening(listed(names))} {verb} one-step prediction, but hardly a simulation of unseen readings, "
        f"so {fate} left out.",
    )


def too_weak(names: Sequence[str]) -> tuple[str, ...]:
    """A sentence on effects that readings speak for without calling them missing, if there are any."""
    if not names:
        return ()
    them = "them" if len(names) > 1 else "it"
    return (
        f"Readings speak for {listed(names)}, but too weakly, or in too few moments, to call {them} missing.",
    )


def unnamed(names: Sequence[str]) -> tuple[str, ...]:
    """A sentence on effects that are too small for a name and improve the model, if there are any."""
    if not names:
        return ()
    verb, fate = ("improve", "they are") if len(names) > 1 else ("improves", "it is")
    return (f"{_opening(listed(names))} {verb} the model, but {fate} too small to be missing physics.",)


def below_tolerance(tolerance: float, unit: str) -> str:
    """A sentence on an error that is more than noise and does not matter."""
    return f"More than noise is left, but less than the tolerance of {tolerance:.3g} {unit}."


def stood_still(share: float) -> str:
    """A sentence on a host or link that stood still for that share of a recording."""
    return f"The host or the link stood still for {100.0 * share:.0f} % of a recording, so no name is sure."


def beaten(horizons_s: Sequence[float]) -> tuple[str, ...]:
    """A remark on the horizons at which the plant that is handed on is not the best; none where there are none."""
    if not horizons_s:
        return ()
    told = ["over whole runs" if math.isinf(own) else f"after {own:g} s" for own in horizons_s]
    return (
        f"No plant is the best at every horizon: {listed(told)} another one predicts unseen readings better.",
    )


def _opening(named: str) -> str:
    """The names as the beginning of a sentence."""
    return named[:1].upper() + named[1:]


def _unseen(excitation: Excitation, names: Mapping[str, str]) -> str:
    named = [names.get(effect_id, effect_id) for effect_id in excitation.unseen]
    if len(named) > _MOST_NAMED:
        further = len(named) - _MOST_NAMED
        named = [*named[:_MOST_NAMED], "one other effect" if further == 1 else f"{further} other effects"]
    why = f". In these recordings, {listed(excitation.lacks)}" if excitation.lacks else ""
    return f"{listed(named, 'or')}{why}"


def why_confusable(effect: Effect, rival: Rival, trace: Alike | None = None) -> str:
    """Why these recordings leave it open which of two effects it is; `trace` says how alike what they do is here."""
    other = rival.effect
    told = effect.confusable_with.get(other.id) or other.confusable_with.get(effect.id)
    likeness = (
        f"in its place, the log-likelihood is {-rival.behind:.1f} nats higher"
        if rival.behind < 0.0
        else f"in its place, the log-likelihood is only {rival.behind:.1f} nats lower"
    )
    if rival.simulates_worse:
        likeness += ", but it simulates unseen readings worse"
    if trace is not None and trace.cosine >= _ALIKE:
        likeness += f", and after a re-fit the two change these readings {100.0 * trace.cosine:.0f} % alike"
    return f"{likeness}; {told}" if told else f"{likeness} on these recordings"


def experiment_between(effect: Effect, other: Effect) -> NextExperiment:
    """What would tell two effects apart."""
    told = effect.confusable_with.get(other.id) or other.confusable_with.get(effect.id)
    fallback = "slow ramps through zero both ways, steps of several sizes, and coast-downs without current"
    return NextExperiment(
        why=f"these recordings do not tell {effect.name} from {other.name}", input=told or fallback
    )


def experiment_for_unknown() -> NextExperiment:
    """What to record when nothing known accounts for the mismatch."""
    return NextExperiment(
        why="the rest follows the plant's state, and no known effect has its shape",
        input="one input twice, then at half the size, then from another angle. A repeated error is physics; "
        "its dependence on size and angle says which",
    )


def experiment_for_stalled() -> NextExperiment:
    """What to record when the host or the link stood still for too long."""
    return NextExperiment(
        why="the host or the link stood still for too long to trust the stamps",
        input="the same program again on a host with nothing else to do",
    )


def experiment_for_run_outs(recordings: Sequence[str]) -> NextExperiment:
    """What to record where only held-out recordings show the motor without current."""
    runs = "runs" if len(recordings) == 1 else "run"
    return NextExperiment(
        why=f"only {listed(recordings)} {runs} without current; driven motion hardly tells friction from self-braking",
        input="spin up both ways at two powers, and coast down without current each time",
    )


def experiment_for_unseen(excitation: Excitation) -> NextExperiment:
    """What to record when too little happened to tell anything."""
    why = listed(excitation.lacks) or "the effects would be small beside the noise"
    return NextExperiment(
        why=f"these recordings could not have shown every missing effect: {why}",
        input="steps of several sizes both ways with rests between, slow ramps through zero, "
        "reversals, and coast-downs without current",
    )


def proposed(pattern: str, seconds: float, nats: float) -> str:
    """An input with how long it takes and what to expect of it."""
    length = f"about {seconds:.0f} s" if seconds >= 10.0 else f"{max(seconds, 1.0):.0f} s"
    weak = " (this is little: a recording may not tell the two apart)" if nats < _LITTLE_NATS else ""
    return f"{pattern}; {length} of it should give {nats:.0f} nats of evidence between the two{weak}"


def listed(items: Sequence[str], last: str = "and") -> str:
    """`items` in one phrase, `last` before the last."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"
