"""Replicates on a Dask cluster: a local one, whose one worker is another process, so that all is sent by pickling."""

import json
import os
import socket
import subprocess
import sys

import numpy as np
import pytest
from distributed import LocalCluster

from gloss_analysis.cluster import workers
from gloss_analysis.confirmatory.indscal import confirm_indscal
from gloss_analysis.confirmatory.orthogonality import check_orthogonality
from gloss_analysis.design.population import Population
from gloss_analysis.design.precision import simulate_designs
from gloss_analysis.dimensionality.held_out import cross_validated_stress
from gloss_analysis.dimensionality.null_stress import permuted_stress, random_stress
from gloss_analysis.mds import scale
from gloss_analysis.replicates import in_parallel, no_step
from gloss_analysis.uncertainty.bootstrap import bootstrap
from gloss_analysis.uncertainty.jackknife import jackknife
from glossspace.errors import GlossError
from tests.analysis.studies import axis_values, judged_by, named


@pytest.fixture(scope="module")
def cluster():
    with LocalCluster(n_workers=1, threads_per_worker=2, processes=True, dashboard_address=":0") as local:
        yield local.scheduler_address


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr("gloss_analysis.cluster._PATIENCE", 0.5)


@pytest.fixture
def few():
    """Three simulated participants and the pairs of the first ten stimuli."""
    data = judged_by([1.4, 1.8, 2.2], exponent=0.8, noise_sd=2.0)
    first, second = data.pairs
    return named(data.values[:, (first < 10) & (second < 10)], 10)


def analyses(data):
    """Everything that takes its cases from `in_parallel`, in small, as plain arrays."""
    solution = scale(data, n_dims=2, n_starts=5)
    place, axes = axis_values()[:10], ("c", "d")
    tested = check_orthogonality(data, place, axes=axes, n_permutations=4)
    held = cross_validated_stress(data, dims=(1, 2), n_folds=2, n_starts=2)
    simulated = simulate_designs(
        place, Population(), observers=[3], pair_sets=[np.ones(45, dtype=bool)], n_studies=10
    )  # fmt: skip
    return {
        "bootstrap": bootstrap(data, solution, n_replicates=4).coordinates,
        "jackknife": jackknife(data, solution).coordinates,
        "random": random_stress(data, dims=(2,), n_replicates=2),
        "permuted": permuted_stress(data, dims=(2,), n_replicates=2),
        "held out": held.stress1,
        "rotated": tested.null_rotated,
        "correlated": tested.null_correlated,
        "own weights": confirm_indscal(data, place, axes=axes, n_permutations=4).null,
        "design": np.array([simulated[0].width_p90, simulated[0].bias, simulated[0].observer_error]),
    }


def test_all_analyses_are_the_same_on_a_cluster(cluster, few):
    here = analyses(few)
    with workers("dask", cluster):
        there = analyses(few)
    for name, expected in here.items():
        # Bit for bit: the same packages on the same processor, and seeds that are drawn before anything is sent.
        np.testing.assert_array_equal(there[name], expected, err_msg=name)


def test_the_work_is_done_elsewhere(cluster):
    with workers("dask", cluster):
        elsewhere = set(in_parallel(lambda _: os.getpid(), range(4), 1, no_step))
    assert len(elsewhere) == 1
    assert elsewhere != {os.getpid()}
    assert set(in_parallel(lambda _: os.getpid(), range(4), 1, no_step)) == {os.getpid()}


def test_results_come_in_the_order_of_the_cases_and_with_progress(cluster):
    steps = []
    with workers("dask", cluster):
        found = list(in_parallel(lambda x: x * x, range(7), 1, lambda done, total: steps.append((done, total))))
    assert found == [0, 1, 4, 9, 16, 25, 36]
    assert steps == [(k, 7) for k in range(1, 8)]


def test_an_error_on_a_worker_is_told(cluster):
    def refuses(_):
        raise GlossError("no structure to scale")

    with pytest.raises(GlossError, match="no structure to scale"), workers("dask", cluster):
        list(in_parallel(refuses, range(3), 1, no_step))


def test_workers_that_die(cluster):
    def dies(_):
        os._exit(1)

    import dask

    with (
        # The scheduler, which is in this process, gives up after the first death: a worker starts again in seconds.
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(n_workers=1, threads_per_worker=2, processes=True, dashboard_address=":0") as frail,
        pytest.raises(GlossError, match="was lost: Attempted to run task"),
        workers("dask", frail.scheduler_address),
    ):
        list(in_parallel(dies, range(2), 1, no_step))


def test_a_cluster_without_workers(impatient):
    with (
        LocalCluster(n_workers=0, processes=False, dashboard_address=":0") as empty,
        pytest.raises(GlossError, match="has no workers. Start some"),
        workers("dask", empty.scheduler_address),
    ):
        pass


@pytest.mark.parametrize(
    ("address", "why"),
    [
        ("nonsense", "missing port"),
        ("tcp://host:door", "door"),
        ("tcp://no.such.host.invalid:8786", "No Dask scheduler answers"),
    ],
)
def test_addresses_that_cannot_be(address, why):
    with pytest.raises(GlossError, match=why), workers("dask", address):
        pass


def test_a_port_that_nobody_listens_to():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))  # bound and not listening: connections are refused
        address = f"tcp://127.0.0.1:{taken.getsockname()[1]}"
        with pytest.raises(GlossError, match="No Dask scheduler answers"), workers("dask", address):
            pass


def test_a_listener_that_is_no_scheduler(impatient):
    with (
        socket.create_server(("127.0.0.1", 0)) as silent,
        pytest.raises(GlossError, match="no answer in 0.5 seconds"),
        workers("dask", f"tcp://127.0.0.1:{silent.getsockname()[1]}"),
    ):
        pass


def test_a_worker_in_place_of_the_scheduler(cluster):
    from distributed import Client

    with Client(cluster, set_as_default=False) as client:
        worker = next(iter(client.scheduler_info()["workers"]))
    with pytest.raises(GlossError, match="it is the address of a worker"), workers("dask", worker):
        pass


def test_other_versions_on_the_workers(cluster, monkeypatch):
    monkeypatch.setattr("gloss_analysis.cluster._PACKAGE", "numpy-of-another-world")
    monkeypatch.setattr("gloss_analysis.cluster._own_version", lambda: "1.0")
    with (
        pytest.raises(GlossError, match="lacks numpy-of-another-world, and this machine has 1.0"),
        workers("dask", cluster),
    ):
        pass


@pytest.mark.parametrize(
    ("backend", "scheduler", "why"),
    [
        ("spark", None, "Invalid backend = 'spark'. Allowed: 'threads', 'dask'."),
        ("dask", None, "needs the address of a scheduler"),
        ("threads", "tcp://a:1", "The scheduler 'tcp://a:1' is for the backend 'dask'"),
    ],
)
def test_what_does_not_go_together(backend, scheduler, why):
    with pytest.raises(GlossError, match=why), workers(backend, scheduler):
        pass


def test_without_the_package(monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == "distributed"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(GlossError, match=r'needs the package .*: pip install "glossspace\[cluster\]"'),
        workers("dask", "tcp://a:1"),
    ):
        pass


def test_dask_is_imported_by_who_asks_for_it_alone():
    program = (
        "import sys, gloss_analysis.commands.mds, gloss_analysis.commands.design, gloss_analysis.cluster, "
        "gloss_analysis.replicates\n"
        "with gloss_analysis.cluster.workers('threads'): pass\n"
        "print(sorted({'dask', 'distributed'} & set(sys.modules)))"
    )
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"


@pytest.mark.parametrize(
    "words",
    [
        ("mds", "PAIRS", "--dims", "2", "--starts", "3", "--bootstrap", "4"),
        ("confirm", "PAIRS", "--coordinates", "AXES", "--orthogonality", "4", "--indscal", "3"),
        ("design", "--observers", "3", "--studies", "10"),
        ("design-pairs", "--keep", "300", "--studies", "10", "--observers", "3"),
    ],
)
def test_commands(gloss, pairs, tmp_path, cluster, words):
    axes = tmp_path / "axes.csv"
    rows = [f"s{k},{c!r},{d!r}" for k, (c, d) in enumerate(axis_values().tolist())]
    axes.write_text("\n".join(["stimulus,c,d", *rows]) + "\n")
    words = [{"PAIRS": pairs, "AXES": axes}.get(word, word) for word in words]
    code, here, err = gloss(*words, "--json")
    assert code == 0, err
    code, there, err = gloss(*words, "--json", "--backend", "dask", "--scheduler", cluster)
    assert code == 0, err
    assert json.loads(there) == json.loads(here)


@pytest.mark.parametrize("words", [("mds", "PAIRS"), ("confirm", "PAIRS", "--coordinates", "x.csv"), ("design",)])
def test_mistakes_of_commands(refused, pairs, words):
    words = [pairs if word == "PAIRS" else word for word in words]
    assert "needs the address of a scheduler" in refused(*words, "--backend", "dask")
    assert "is for the backend 'dask'" in refused(*words, "--scheduler", "tcp://a:1")
