"""One request and its reply at a time; what is late, broken or missing is told apart and survived.

A brick answers requests in their order. If a reply does not come in time, it could later be taken for the reply to
the next request. A marker therefore goes before the next request: a read of as many bytes of an IO map as markers
were sent. Its reply is unique, and everything before it is dropped.
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
    HalfTelegramError,
    LinkError,
    LinkTimeoutError,
    RequestError,
)
from nxt_twin.brick.link import Link
from nxt_twin.brick.policy import Policy
from nxt_twin.brick.question import Question, question
from nxt_twin.brick.stamped import Stamped, stamped

T = TypeVar("T")
ReplyT = TypeVar("ReplyT", bound=ReplyData)

_KEEP_ALIVE: Final = replace(question(KeepAlive()), mends=True)
_MARKERS: Final = tuple(
    replace(question(IoMapRead(ModuleId.COMMAND, 0, length)), mends=True) for length in range(1, 17)
)
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
        # Looked up once: a control loop puts hundreds of questions a second.
        self._send, self._receive, self._now_s = link.send, link.receive, clock.now_s
        self._telegram_size, self._reply_timeout_s = policy.telegram_size, policy.reply_timeout_s
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
        if len(asked.telegram) > self._telegram_size:
            raise self._too_long(asked.telegram)
        sent_s = self._now_s()
        if (self._out_of_step or sent_s >= self._keep_alive_at_s) and not asked.mends:
            sent_s = self._prepare(sent_s)
        if timeout_s is None:
            timeout_s = self._reply_timeout_s
        # Whatever interrupts this, Ctrl-C included, leaves a reply on its way: out of step until it is here.
        self._out_of_step = True
        if asked.engages:
            self._engaged = True
        self._send(asked.telegram)
        try:
            telegram = self._receive(timeout_s)
        except HalfTelegramError:
            self._count("timeouts")
            raise
        except LinkTimeoutError as error:
            raise self._in_vain(asked, timeout_s) from error
        received_s = self._now_s()
        if not telegram.startswith(asked.head):
            telegram, received_s = self._wait_on(asked, telegram, sent_s, timeout_s, received_s)
        try:
            value = asked.read(telegram)
        except TelegramError as error:
            raise GarbageError(f"the reply is broken: {error}", where=self.describe()) from error
        except BrickStatusError as error:
            self._out_of_step = False
            raise CommandRefusedError(error, sent_s=sent_s, received_s=received_s) from error
        self._out_of_step = False
        return stamped((value, sent_s, received_s))

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
        self._keep_alive_at_s = self._now_s() + self._keep_alive_period_s
        reply = self.put(_KEEP_ALIVE)
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
        """The link's name for a person."""
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

    def _wait_on(
        self, asked: Question[Any], telegram: bytes, sent_s: float, timeout_s: float, received_s: float
    ) -> tuple[bytes, float]:
        """Drop what came instead of the reply until it comes, or a refusal does."""
        foreign_before = self._health.foreign
        while not (telegram.startswith(asked.head) or self._is_refusal(asked, telegram)):
            foreign = self._health.foreign > foreign_before
            left_s = sent_s + timeout_s - received_s
            if left_s <= 0:
                raise self._in_vain(asked, timeout_s, foreign=foreign)
            try:
                telegram = self._receive(left_s)
            except HalfTelegramError:
                self._count("timeouts")
                raise
            except LinkTimeoutError as error:
                raise self._in_vain(asked, timeout_s, foreign=foreign) from error
            received_s = self._now_s()
        return telegram, received_s

    def _in_vain(self, asked: Question[Any], timeout_s: float, *, foreign: bool = False) -> LinkError:
        """Count a reply that did not come, and tell what to raise."""
        self._count("timeouts")
        if foreign:
            return GarbageError(
                f"instead of the reply to {asked.request.NAME} came what no brick sends",
                where=self.describe(),
            )
        return LinkTimeoutError(
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
                self.put(next(self._markers), timeout_s=timeout_s)
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
