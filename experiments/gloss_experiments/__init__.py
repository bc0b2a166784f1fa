"""Observer sessions: protocols, trial order, the state machine of a session, journal, screen, simulated observers.

The public functions are `run_session`, `read_protocol` and `simulated_observers`, and for a whole dataset
`check_dataset` and `rebuild_dataset`. PsychoPy is imported by the screen alone, when a session is shown.
"""

from gloss_experiments.datasets.dataset_check import DatasetCheck, check_dataset
from gloss_experiments.datasets.rebuild import RebuiltSession, rebuild_dataset
from gloss_experiments.observers.observer import SimulatedObserver
from gloss_experiments.observers.observer_kinds import simulated_observers
from gloss_experiments.protocol import Protocol, read_protocol
from gloss_experiments.session.run import SessionResult, run_session

__all__ = [
    "DatasetCheck",
    "Protocol",
    "RebuiltSession",
    "SessionResult",
    "SimulatedObserver",
    "check_dataset",
    "read_protocol",
    "rebuild_dataset",
    "run_session",
    "simulated_observers",
]
