"""Observer sessions: protocols, trial order, the session's state machine, its journal, its screen, simulated observers.

The public functions are `run_session`, `read_protocol` and `simulated_observers`. PsychoPy is imported by the screen
alone, when a session is shown.
"""

from gloss_experiments.observer import SimulatedObserver, simulated_observers
from gloss_experiments.protocol import Protocol, read_protocol
from gloss_experiments.run import SessionResult, run_session

__all__ = [
    "Protocol",
    "SessionResult",
    "SimulatedObserver",
    "read_protocol",
    "run_session",
    "simulated_observers",
]
