"""Small studies, analysed once for all tests of the report."""

import pytest

from gloss_analysis.report import write_report
from gloss_analysis.study.analysis import analyse_study
from gloss_analysis.study.folder import read_study, report_file
from tests.analysis.study_folders import make_study


@pytest.fixture(scope="session")
def simulated(tmp_path_factory):
    """A study of four simulated observers, analysed."""
    folder = make_study(tmp_path_factory.mktemp("simulated"), [1.5, 1.8, 2.0, 1.7])
    return analyse_study(read_study(folder), n_jobs=2)


@pytest.fixture(scope="session")
def written(simulated):
    """The report of it."""
    return write_report(simulated, report_file(simulated.study.folder))


@pytest.fixture(scope="session")
def alone(tmp_path_factory):
    """A study of one person, without measurements in the images and without errors in the manifests, analysed."""
    folder = make_study(tmp_path_factory.mktemp("alone"), [1.8], observer="human", measured=False, errors=False)
    return analyse_study(read_study(folder))
