"""The observer dataset: a Psych-DS folder of one CSV file a session and task, which analyses read and sessions write.

Layout of a dataset folder::

    dataset_description.json                                        schema.org JSON-LD: what each column means
    data/subject-01/subject-01_session-1_task-pairwise_data.csv     one file a participant, session and task
    stimuli.csv                                                     what the stimuli shown were
    simulated_observers.json                                        the true parameters of simulated participants
    journals/                                                       raw, append-only records of the sessions
    pilots/                                                         a dataset of its own, of trial runs: no data

The readers check the whole dataset before they return a row of it, so an analysis never runs on a broken one.
"""

from glossspace.dataset.bids import export_bids
from glossspace.dataset.description import update_description
from glossspace.dataset.lock import locked
from glossspace.dataset.observers import read_simulated_observers, record_simulated_observer
from glossspace.dataset.read import (
    read_dissimilarities,
    read_magnitudes,
    read_rankings,
    simulated_participants,
    tasks_of,
)
from glossspace.dataset.schema import data_path
from glossspace.dataset.stimuli import read_stimuli, read_stimulus_table, record_stimuli
from glossspace.dataset.validate import dataset_problems, validate_dataset
from glossspace.dataset.write import write_session_data

__all__ = [
    "data_path",
    "dataset_problems",
    "export_bids",
    "locked",
    "read_dissimilarities",
    "read_magnitudes",
    "read_rankings",
    "read_simulated_observers",
    "read_stimuli",
    "read_stimulus_table",
    "record_simulated_observer",
    "record_stimuli",
    "simulated_participants",
    "tasks_of",
    "update_description",
    "validate_dataset",
    "write_session_data",
]
