"""One motor's twin: its model held to the readings, and the same with what it may lack."""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import MappingProxyType
from typing import NamedTuple, final

from nxt_twin.physics.plant import Plant
from nxt_twin.recording.columns import PORTS, DriveMode, Port, tacho_column
from nxt_twin.twin.batch import ANGLE, CURRENT, SPEED, Batch
from nxt_twin.twin.bridge import Hold
from nxt_twin.twin.candidates import NOTHING, UNKNOWN, Candidate, candidates
from nxt_twin.twin.estimator import ComparedReading, Weigher
from nxt_twin.twin.jerk import Drive, Jerks
from nxt_twin.twin.records import Innovation, MotorBelief
from nxt_twin.twin.settings import MotorNoise, Watch
from nxt_twin.twin.strand import Strand

_SHARED = 3
_MEMORY_S = 60.0
_SPEED_DOUBT = 3.0
_AT_REST = 0.3
_WEIGH_EVERY_S = 0.03
"""The weighed models take readings no more often: what tells them apart takes longer, and each costs time."""


class ReadingEvidence(NamedTuple):
    """What one reading says.

    Attributes:
        innovation: the reading beside the tracking filter's prediction.
        nats: by how much a torque of unknown origin explains it better than the model alone.
        believed: the reading beside the prediction of the model alone.
        speed: estimate, rad/s.
        torque: the unknown torque's estimate, N·m.
        tacho_deg: the encoder's count.
    """

    innovation: Innovation
    nats: float
    believed: ComparedReading
    speed: float
    torque: float
    tacho_deg: int


@final
class MotorTwin:
    """A motor's filters: one that believes its model, one that looks for a torque, and those that are weighed.

    Args:
        port: of the brick.
        plant: the model.
        noise: what is random.
        watch: when readings are believed.
        first_row: of its rows in the batch.
        ids: effects to weigh; none to weigh nothing.
        turn: which of three motors it is; they take turns in weighing, so that no poll has to wait for all.
    """

    def __init__(
        self,
        port: Port,
        plant: Plant,
        noise: MotorNoise,
        watch: Watch,
        first_row: int,
        ids: Sequence[str],
        turn: int = 0,
    ) -> None:
        self.port = port
        self.plant = plant
        self._noise = noise
        self._watch = watch
        weighed = candidates(plant, ids) if ids else ()
        models = (Candidate(NOTHING, plant), Candidate(UNKNOWN, plant), *weighed)
        wide = {1} | {2 + n for n, candidate in enumerate(weighed) if candidate.name == UNKNOWN}
        self._strands: list[Strand] = []
        for n, candidate in enumerate(models):
            std = noise.sought_torque_nm if n in wide else noise.torque_nm
            row = self._strands[-1].rows.stop if self._strands else first_row
            self._strands.append(Strand(candidate, row, std, noise.torque_time_s))
        self._believing, self._tracking = self._strands[:2]
        self._weighed = self._strands[2:]
        self._weigher = self._new_weigher()
        self._drive = Drive(plant)
        self._jerks, self._weighed_jerks = Jerks(), Jerks()
        self._reaped_s = 0.0
        self._weighed_s = 0.0
        self._wait_s = turn * _WEIGH_EVERY_S / len(PORTS)
        self._due_s = 0.0
        self._rejected = 0
        self._count: int | None = None
        self._placed = False
        self._probable: dict[str, float] | None = None

    def _new_weigher(self) -> Weigher | None:
        if not self._weighed:
            return None
        prior = [0.5, *([0.5 / (len(self._weighed) - 1)] * (len(self._weighed) - 1))]
        named = {strand.candidate.name: strand.estimator for strand in self._weighed}
        return Weigher(named, _SHARED, prior, _MEMORY_S)

    @property
    def rows(self) -> list[Plant]:
        """The plant of each row of the batch."""
        return [s.candidate.plant for s in self._strands for _ in range(s.rows.stop - s.rows.start)]

    @property
    def row(self) -> int:
        """The row of the tracking filter's estimate."""
        return self._tracking.rows.start

    @property
    def every_row(self) -> slice:
        """Its rows of the batch."""
        return slice(self._strands[0].rows.start, self._strands[-1].rows.stop)

    @property
    def placed(self) -> bool:
        """Whether it knows where the motor is."""
        return self._placed

    def place(self, batch: Batch, count: int, speed: float = 0.0) -> None:
        """Begin at a count, with a speed (rad/s) that nobody knows well: the motor may be turning already."""
        angle = math.radians((count + 0.5) * self._noise.quantum_deg)
        variances = (math.radians(self._noise.quantum_deg) ** 2 / 12.0, _SPEED_DOUBT**2)
        for strand in self._strands:
            strand.place(batch, angle, speed, variances)
        if shift := batch.shift(self.row):
            for strand in self._strands:
                strand.place(batch, angle - shift, speed, variances)
        self._reaped_s = self._weighed_s = batch.now_s
        self._due_s = batch.now_s + self._wait_s
        self._weigher = self._new_weigher()
        self._probable = None
        self._rejected = 0
        self._placed = True

    def follow(self, other: MotorTwin, was: Batch, batch: Batch) -> None:
        """Go on where another twin of the same motor has got to in the batch that there was."""
        shown, speed = float(was.state[other.row, ANGLE]) + was.shift(other.row), was.state[other.row, SPEED]
        batch.state[self.row] = 0.0
        batch.state[self.row, ANGLE] = shown
        angle = shown - batch.shift(self.row)
        covariance = other._tracking.estimator.covariance
        for strand in self._strands:
            batch.state[strand.rows] = 0.0
            strand.place(batch, angle, float(speed), (covariance[0, 0], covariance[1, 1]))
        self._probable = None
        self._reaped_s = self._weighed_s = batch.now_s
        self._due_s = batch.now_s + self._wait_s
        self._placed = other.placed

    def expect(self, at_s: float, std_s: float, before: Hold, after: Hold, supply_v: float) -> None:
        """A command takes the bridge from one state to another, at a moment known to `std_s`."""
        jerk = self._drive.jerk(at_s, std_s, before, after, float(self._tracking.mean[1]), supply_v)
        self._jerks.expect(jerk)
        self._weighed_jerks.expect(jerk)

    def read(self, batch: Batch, count: int, taken_std_s: float, stamp_s: float) -> ReadingEvidence:
        """Compare a count, read at the batch's moment, and learn from it.

        Args:
            batch: moved to when the count was read.
            count: of the encoder.
            taken_std_s: how well that moment is known.
            stamp_s: for the record.
        """
        if not self._placed:
            self.place(batch, count)
        weighing = bool(self._weighed) and batch.now_s >= self._due_s
        taking = self._strands if weighing else self._strands[:2]
        self._reap(batch, weighing=weighing)
        shift = batch.shift(self.row)
        reading = math.radians((count + 0.5) * self._noise.quantum_deg) - shift
        variance = self._variance(float(self._tracking.mean[1]), taken_std_s)
        compared = self._tracking.compare(reading, variance)
        believed = self._believing.compare(reading, variance)
        accepted = compared.normalised_square <= self._watch.gate or self._give_in(batch, reading)
        nats = 0.0
        if accepted:
            self._rejected = 0
            nats = compared.log_likelihood - believed.log_likelihood
            if count == self._count and abs(float(self._believing.mean[1])) < _AT_REST:
                nats = min(nats, 0.0)  # one count that is read again and again is evidence but once
            self._believing.update(reading, variance)
            self._tracking.update(reading, variance)
        if weighing:
            self._weigh(reading, variance, accepted=accepted)
        self._count = count
        for strand in taking:
            strand.sow(batch)
        innovation = self._innovation(
            count, compared.predicted + shift, compared.variance, stamp_s, accepted=accepted
        )
        speed, torque = float(self._tracking.mean[1]), float(self._tracking.mean[2])
        most = self._watch.most_nats
        nats = min(max(nats, -most), most)
        return ReadingEvidence(innovation, nats, believed, speed, torque, count)

    def _reap(self, batch: Batch, *, weighing: bool) -> None:
        """Take where the rows have got to since they were sown, by which all that take this reading predict it."""
        jerked = self._jerks.felt(batch.now_s)
        for strand in (self._believing, self._tracking):
            strand.reap(batch, batch.now_s - self._reaped_s, jerked)
        self._reaped_s = batch.now_s
        if weighing:
            jerked = self._weighed_jerks.felt(batch.now_s)
            for strand in self._weighed:
                strand.reap(batch, batch.now_s - self._weighed_s, jerked)

    def forget_evidence(self, batch: Batch) -> None:
        """Let the model that is believed begin anew where the motor is."""
        self._believing.follow(self._tracking, batch)

    def begin_anew(self, batch: Batch) -> None:
        """Forget all that was learnt, apart from where the motor is."""
        for strand in (self._believing, *self._weighed):
            strand.follow(self._tracking, batch)
        self._weighed_s = self._reaped_s
        self._weigher = self._new_weigher()
        self._probable = None

    def state(self, batch: Batch, power_pct: float, mode: DriveMode) -> MotorBelief:
        """The present estimate of the motor's state."""
        row = batch.state[self.row]
        covariance = self._tracking.estimator.covariance
        return MotorBelief(
            port=self.port,
            power_pct=power_pct,
            mode=mode,
            angle_deg=math.degrees(float(row[0])),
            speed_deg_per_s=math.degrees(float(row[1])),
            current_a=float(row[CURRENT]),
            unknown_torque_nm=float(batch.torque[self.row]),
            unknown_torque_std_nm=math.sqrt(max(float(covariance[2, 2]), 0.0)),
            effects=MappingProxyType(self.probabilities),
        )

    @property
    def probabilities(self) -> dict[str, float]:
        """How probable each weighed effect is right now, `nothing` for the model as it is.

        An effect whose number has come out as what the model has already is nothing.
        """
        if self._probable is None:
            self._probable = self._weighed_up()
        return self._probable

    def _weighed_up(self) -> dict[str, float]:
        if self._weigher is None:
            return {}
        found = self._weigher.probabilities
        for strand in self._weighed:
            name = strand.candidate.name
            if strand.candidate.slot is not None and not strand.differs:
                found[NOTHING] += found[name]
                found[name] = 0.0
        return found

    @property
    def sizes(self) -> dict[str, tuple[float, float]]:
        """The number of each weighed effect and its standard deviation, SI, by the effect's id."""
        return {
            strand.candidate.name: (float(strand.mean[_SHARED]), math.sqrt(strand.estimator.covariance[3, 3]))
            for strand in self._weighed
            if strand.candidate.slot is not None
        }

    def _variance(self, speed: float, taken_std_s: float) -> float:
        quantum, own = math.radians(self._noise.quantum_deg), math.radians(self._noise.reading_deg)
        return quantum**2 / 12.0 + own**2 + (speed * taken_std_s) ** 2

    def _give_in(self, batch: Batch, reading: float) -> bool:
        """After too many readings that cannot be, doubt the filter: begin anew at the reading."""
        self._rejected += 1
        if self._rejected < self._watch.rejected_most:
            return False
        variances = (math.radians(self._noise.quantum_deg) ** 2, _SPEED_DOUBT**2)
        for strand in self._strands:
            strand.place(batch, reading, float(self._tracking.mean[1]), variances)
        return True

    def _weigh(self, reading: float, variance: float, *, accepted: bool) -> None:
        since_s, self._weighed_s = self._reaped_s - self._weighed_s, self._reaped_s
        self._due_s = self._reaped_s + _WEIGH_EVERY_S
        if self._weigher is None or not accepted:
            return
        logs = [strand.update(reading, variance).log_likelihood for strand in self._weighed]
        self._weigher.update(logs, since_s)
        self._probable = None

    def _innovation(
        self, count: int, predicted: float, variance: float, stamp_s: float, *, accepted: bool
    ) -> Innovation:
        half = 0.5 * self._noise.quantum_deg
        return Innovation(
            time_s=stamp_s,
            channel=tacho_column(self.port),
            unit="deg",
            measured=float(count),
            predicted=math.degrees(predicted) - half,
            variance=math.degrees(1.0) ** 2 * variance,
            accepted=accepted,
        )
