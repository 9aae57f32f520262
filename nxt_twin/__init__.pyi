from nxt_twin.api.analysis import find_changes as find_changes
from nxt_twin.api.analysis import find_missing_physics as find_missing_physics
from nxt_twin.api.analysis import fit as fit
from nxt_twin.api.bricks import open_brick as open_brick
from nxt_twin.api.bricks import record as record
from nxt_twin.api.bricks import start_mock as start_mock
from nxt_twin.api.files import load_plant as load_plant
from nxt_twin.api.files import read_case as read_case
from nxt_twin.api.files import read_recording as read_recording
from nxt_twin.api.prediction import simulate as simulate
from nxt_twin.api.replaying import replay as replay
from nxt_twin.diagnose.changed.answer import Changes as Changes
from nxt_twin.diagnose.diagnosis import Diagnosis as Diagnosis
from nxt_twin.errors import NxtTwinError as NxtTwinError
from nxt_twin.physics.effect import Effect as Effect
from nxt_twin.physics.parameter import Parameter as Parameter
from nxt_twin.physics.plant import Plant as Plant
from nxt_twin.recording.case import Case as Case
from nxt_twin.recording.recording import Recording as Recording

__version__: str
