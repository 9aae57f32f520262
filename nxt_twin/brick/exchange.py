"""One request and its reply at a time; what is late, broken or missing is told apart and survived.

A brick answers in the order in which it was asked. After a request whose reply did not come, its late reply
could be taken for that of the next: so the next is preceded by a marker whose reply is like no other (a read
of as many bytes of an IO map as markers were sent), and whatever comes before the marker's reply is dropped.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any, Final, TypeVar, final

from firmware_protocol import (
    BrickStatusError,
    Command,
    IoMapRead,
    KeepAlive,
    ModuleId,
    MotorMode,
    OutputPort,
    RegulationMode,
    ReplyData,
    RunState,
    SetOutputState,
    Status,
    TelegramError,
    TelegramType,
    encode_request,
)
from nxt_twin.brick.clock import Clock
from nxt_twin.brick.errors import (
    CommandRefusedError,
    GarbageError,
    LinkError,
    LinkTimeoutError,
    RequestError,
)
from nxt_twin.brick.link import Link
from nxt_twin.brick.policy import Policy
from nxt_twin.brick.question import Question, question
from nxt_twin.brick.stamped import Stamped

T = TypeVar("T")
ReplyT = TypeVar("ReplyT", bound=ReplyData)

_KEEP_ALIVE: Final = question(KeepAlive())
_MARKERS: Final = tuple(question(IoMapRead(ModuleId.COMMAND, 0, length)) for length in range(1, 17))
_ATTEMPTS: Final = 2
"""Markers, or commands to coast, before giving up: the first may fall victim to a stream out of step."""
_COAST_ALL: Final = SetOutputState(
    port=OutputPort.ALL,
    power=0,
    mode=MotorMode.COAST,
    regulation=RegulationMode.IDLE,
    turn_ratio=0,
    run_state=RunState.IDLE,
    tacho_limit=0,
)


@final
@dataclass(frozen=True)
class Health:
    """What went wrong so far, and was survived.

    Attributes:
        timeouts: requests without a reply in time.
        late: replies to earlier requests, dropped.
        foreign: telegrams that are no reply to anything, dropped (a program's messages, for one).
        resynchronised: how often a marker brought requests and replies together again.
    """

    timeouts: int = 0
    late: int = 0
    foreign: int = 0
    resynchronised: int = 0


@final
class Exchange:
    """Puts requests to a brick, over a link that it shares with nobody. Not for several threads at once.

    Args:
        link: the open link.
        clock: stamps requests and replies.
        policy: how long to wait, and how much fits.
    """

    def __init__(self, link: Link, clock: Clock, policy: Policy) -> None:
        self._link = link
        self._clock = clock
        self._policy = policy
        self._markers = itertools.cycle(_MARKERS)
        self._out_of_step = False
        self._engaged = False
        self._health = Health()
        period_s = policy.keep_alive_period_s
        self._keep_alive_period_s = math.inf if period_s is None else period_s
        self._keep_alive_at_s = clock.now_s() + self._keep_alive_period_s

    @property
    def clock(self) -> Clock:
        """The clock of the stamps."""
        return self._clock

    @property
    def policy(self) -> Policy:
        """How long to wait, and how much fits."""
        return self._policy

    @property
    def health(self) -> Health:
        """What went wrong so far, and was survived."""
        return self._health

    def ask(self, request: Command[ReplyT], *, timeout_s: float | None = None) -> Stamped[ReplyT]:
        """Send a request and wait for its reply; errors as with `put`."""
        return self.put(question(request), timeout_s=timeout_s)

    def put(self, asked: Question[T], *, timeout_s: float | None = None) -> Stamped[T]:
        """Put a question and wait for the reply.

        Args:
            asked: the question.
            timeout_s: how long the reply may take; None for what the policy says.

        Raises:
            CommandRefusedError: the brick answered with a status other than OK.
            RequestError: the telegram is too long for the link.
            LinkTimeoutError: the reply did not come in time, or only half of it (HalfTelegramError).
            GarbageError: what came instead of the reply, or as the reply, is broken.
            LinkLostError: the link is gone.
        """
        if len(asked.telegram) > self._policy.telegram_size:
            raise self._too_long(asked.telegram)
        now_s = self._clock.now_s()
        if self._out_of_step or now_s >= self._keep_alive_at_s:
            now_s = self._prepare(now_s)
        return self._converse(asked, now_s, self._policy.reply_timeout_s if timeout_s is None else timeout_s)

    def tell(self, request: Command[Any]) -> Stamped[None]:
        """Send a request that wants no reply, not even on errors.

        Raises:
            RequestError: a value does not fit its field, or the telegram is too long for the link.
            LinkLostError: the link is gone.
            LinkTimeoutError: the link takes nothing any more.
        """
        ready = question(request)
        if len(ready.telegram) > self._policy.telegram_size:
            raise self._too_long(ready.telegram)
        self._engaged |= ready.engages
        sent_s = self._clock.now_s()
        self._link.send(encode_request(request, reply_required=False))
        return Stamped(None, sent_s, self._clock.now_s())

    def keep_awake(self) -> Stamped[float]:
        """Put off the brick's falling asleep; done by `put` itself when it is due.

        Returns:
            The brick's sleep timeout, s; 0 for never.
        """
        if self._out_of_step:
            self._resynchronise(self._policy.reply_timeout_s)
        now_s = self._clock.now_s()
        self._keep_alive_at_s = now_s + self._keep_alive_period_s
        reply = self._converse(_KEEP_ALIVE, now_s, self._policy.reply_timeout_s)
        return reply.having(reply.value.sleep_timeout_ms / 1000)

    def release(self) -> bool:
        """Let the motors coast, if this exchange may have engaged one; never raises a `LinkError`.

        Returns:
            Whether none is engaged any more, as far as can be known.
        """
        for _ in range(_ATTEMPTS):
            if not self._engaged:
                break
            try:
                self.tell(_COAST_ALL)
                self._resynchronise(self._policy.release_timeout_s)
            except LinkError:
                continue
            self._engaged = False
        return not self._engaged

    def close(self) -> None:
        """Let the motors coast and the link go."""
        try:
            self.release()
        finally:
            self._link.close()

    def describe(self) -> str:
        """What a person would call the link."""
        return self._link.describe()

    def _too_long(self, telegram: bytes) -> RequestError:
        return RequestError(
            f"the telegram has {len(telegram)} bytes, the link carries {self._policy.telegram_size}",
            where=self.describe(),
        )

    def _prepare(self, now_s: float) -> float:
        """Do what is due before a question, and tell the time after it."""
        if now_s >= self._keep_alive_at_s:
            self.keep_awake()
        elif self._out_of_step:
            self._resynchronise(self._policy.reply_timeout_s)
        return self._clock.now_s()

    def _converse(self, asked: Question[T], sent_s: float, timeout_s: float) -> Stamped[T]:
        # Whatever interrupts this, Ctrl-C included, leaves a reply on its way: out of step until it is here.
        self._out_of_step = True
        if asked.engages:
            self._engaged = True
        self._link.send(asked.telegram)
        telegram, received_s = self._wait_for(asked, sent_s, timeout_s)
        try:
            value = asked.read(telegram)
        except TelegramError as error:
            raise GarbageError(f"the reply is broken: {error}", where=self.describe()) from error
        except BrickStatusError as error:
            self._out_of_step = False
            raise CommandRefusedError(error, sent_s=sent_s, received_s=received_s) from error
        self._out_of_step = False
        return Stamped(value, sent_s, received_s)

    def _wait_for(self, asked: Question[Any], sent_s: float, timeout_s: float) -> tuple[bytes, float]:
        left_s = timeout_s
        foreign_before = self._health.foreign
        while left_s > 0:
            try:
                telegram = self._link.receive(left_s)
            except LinkTimeoutError as error:
                self._count("timeouts")
                if type(error) is not LinkTimeoutError:
                    raise
                break
            received_s = self._clock.now_s()
            if telegram.startswith(asked.head) or self._is_refusal(asked, telegram):
                return telegram, received_s
            left_s = sent_s + timeout_s - received_s
        else:
            self._count("timeouts")
        if self._health.foreign > foreign_before:
            raise GarbageError(
                f"instead of the reply to {asked.request.NAME} came what no brick sends",
                where=self.describe(),
            )
        raise LinkTimeoutError(
            f"no reply to {asked.request.NAME} within {timeout_s:g} s",
            where=self.describe(),
            mend="is the brick switched on and near?",
        )

    def _is_refusal(self, asked: Question[Any], telegram: bytes) -> bool:
        """Whether it is this question's reply after all: short, or with another status than OK."""
        if len(telegram) < 2 or telegram[0] != TelegramType.REPLY:
            self._count("foreign")
            return False
        of_this = telegram[1] == asked.request.OPCODE
        if of_this and (len(telegram) < len(asked.head) or telegram[2] != Status.OK):
            return True
        self._count("late")
        return False

    def _resynchronise(self, timeout_s: float) -> None:
        for attempt in range(_ATTEMPTS):
            try:
                self._converse(next(self._markers), self._clock.now_s(), timeout_s)
            except CommandRefusedError:
                continue  # it may be the late refusal of a read that the caller had asked for
            except (LinkTimeoutError, GarbageError):
                if attempt == _ATTEMPTS - 1:
                    raise
            else:
                break
        self._count("resynchronised")

    def _count(self, what: str) -> None:
        self._health = replace(self._health, **{what: getattr(self._health, what) + 1})
