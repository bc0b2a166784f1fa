"""Replicates on other machines: a Dask cluster in place of this machine's threads, for the whole of a `with` block."""

import asyncio
import logging
import socket
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from joblib import parallel_config
from joblib.parallel import ParallelBackendBase

from glossspace.errors import GlossError

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["BACKENDS", "Backend", "check_backend", "workers"]

Backend: TypeAlias = Literal["threads", "dask"]
BACKENDS: tuple[Backend, ...] = ("threads", "dask")

# Seconds that a scheduler has to answer, and its workers to be there.
_PATIENCE = 5
# What a worker must have to run our functions, which are sent by name.
_PACKAGE = "glossspace"


@contextmanager
def workers(backend: Backend = "threads", scheduler: str | None = None) -> Iterator[None]:
    """Where `gloss_analysis.replicates.in_parallel` runs its cases inside the block.

    Every analysis that repeats itself, such as a bootstrap, permutations or simulated studies, takes its cases from
    `in_parallel`, so that it goes to the cluster unchanged. Results do not depend on the place: all seeds are drawn
    here. They are the same bit for bit where the workers have the same packages and kind of processor.

    Parameters
    ----------
    backend : {"threads", "dask"}
        Threads of this machine, as many as each analysis is told; or all threads of a Dask cluster.
    scheduler : str, optional
        Address of the cluster's scheduler, such as tcp://host:8786. For Dask only, which needs it.

    Raises
    ------
    GlossError
        An unknown backend, a scheduler without Dask or Dask without a scheduler; Dask is not installed; no scheduler
        answers at the address within some seconds, it has no workers, or they lack this version of glossspace; or the
        cluster is lost on the way.

    Notes
    -----
    Workers need the same version of glossspace, installed with the extra "cluster". What is sent is pickled by
    cloudpickle: closures over arrays and frozen dataclasses.

    Examples
    --------
    >>> from gloss_analysis.replicates import in_parallel, no_step
    >>> with workers("threads"):
    ...     list(in_parallel(abs, [-1, 2], 2, no_step))
    [1, 2]
    >>> with workers("dask"):
    ...     pass
    Traceback (most recent call last):
    ...
    glossspace.errors.GlossError: The backend 'dask' needs the address of a scheduler, such as tcp://host:8786.
    """
    check_backend(backend, scheduler)
    if scheduler is None:
        yield
        return
    client, lost = _connected(scheduler)
    from distributed.utils import silence_logging_cmgr

    # Of a cluster that is lost we tell in our own words.
    with silence_logging_cmgr(logging.CRITICAL):
        try:
            with parallel_config(backend=_backend(client), n_jobs=-1):
                yield
        except lost as error:
            raise GlossError(
                f"The cluster at '{scheduler}' was lost: {_said(error)}. Look at the scheduler's and workers' output, "
                "and run the same command again."
            ) from error
        finally:
            client.close(timeout=_PATIENCE)


def check_backend(backend: str, scheduler: str | None) -> None:
    """Refuse a backend and a scheduler that do not go together, before long work.

    Raises
    ------
    GlossError
        An unknown backend, a scheduler without Dask or Dask without a scheduler.
    """
    if backend not in BACKENDS:
        raise GlossError(f"Invalid backend = {backend!r}. Allowed: {', '.join(map(repr, BACKENDS))}.")
    if backend == "dask" and scheduler is None:
        raise GlossError("The backend 'dask' needs the address of a scheduler, such as tcp://host:8786.")
    if backend != "dask" and scheduler is not None:
        raise GlossError(f"The scheduler '{scheduler}' is for the backend 'dask'. Choose that, or leave it out.")


def _connected(scheduler: str) -> "tuple[Client, tuple[type[BaseException], ...]]":
    """Client of a cluster that can do the work, and the exceptions that tell of its loss."""
    try:
        from distributed import Client, KilledWorker
        from distributed.client import CancelledError
        from distributed.comm import CommClosedError
    except ModuleNotFoundError as error:
        raise GlossError(
            f"The backend 'dask' needs the package {error.name!r}: pip install \"glossspace[cluster]\"."
        ) from None
    _check_scheduler(scheduler)
    try:
        client = Client(scheduler, timeout=_PATIENCE, set_as_default=False)
    except OSError as error:
        raise _no_scheduler(scheduler, _said(error)) from error
    try:
        _check_workers(client, scheduler)
    except BaseException:
        client.close(timeout=_PATIENCE)
        raise
    return client, (CommClosedError, KilledWorker, CancelledError)


def _backend(client: "Client") -> ParallelBackendBase:
    """Joblib's backend for Dask, but that a task that the cluster cannot finish ends the work.

    Joblib (to 1.6) hears only of tasks that return, and waits for ever for one whose workers died or whose scheduler is
    gone.
    """
    from joblib._dask import DaskDistributedBackend

    class Backend(DaskDistributedBackend):
        def submit(self, func: Any, callback: Any = None) -> Any:
            result = super().submit(func, callback)
            result.add_done_callback(lambda done: callback(done) if done.exception() else None)
            return result

        def retrieve_result_callback(self, out: Any) -> Any:
            if isinstance(out, Future):
                return out.result()  # which raises
            if isinstance(out, BaseException):
                raise out
            return super().retrieve_result_callback(out)

    return Backend(client=client)


def _check_scheduler(scheduler: str) -> None:
    """Refuse an address at which no scheduler answers: a client would wait there for ever."""
    from distributed.comm import parse_address, parse_host_port

    try:
        scheme, place = parse_address(scheduler)
        if scheme == "inproc":  # of a cluster inside this process
            return
        # First by a plain connection, whose failure says at once what is wrong.
        host, port = parse_host_port(place)
        socket.create_connection((host, port), timeout=_PATIENCE).close()
        kind = asyncio.run(asyncio.wait_for(_kind_of_server(scheduler), _PATIENCE))
    except TimeoutError:
        raise _no_scheduler(scheduler, f"no answer in {_PATIENCE} seconds") from None
    except Exception as error:  # whatever listens there and is no scheduler answers in its own way
        raise _no_scheduler(scheduler, _said(error)) from None
    if kind != "Scheduler":
        raise _no_scheduler(scheduler, f"it is the address of a {str(kind).lower()}")


async def _kind_of_server(address: str) -> Any:
    from distributed.comm import connect
    from distributed.security import Security

    comm = await connect(address, timeout=_PATIENCE, **Security().get_connection_args("client"))
    try:
        await comm.write({"op": "identity", "reply": True})
        return (await comm.read())["type"]
    finally:
        comm.abort()


def _check_workers(client: "Client", scheduler: str) -> None:
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
    except TimeoutError:
        raise GlossError(
            f"The scheduler at '{scheduler}' has no workers. Start some: dask worker {scheduler}"
        ) from None
    own = _own_version()
    # By a function of the standard library, which every worker has.
    found: dict[str, Any] = client.run(version, _PACKAGE, on_error="return")
    for worker, there in found.items():
        if there != own:
            what = f"lacks {_PACKAGE}" if isinstance(there, Exception) else f"has {_PACKAGE} {there}"
            raise GlossError(
                f"The worker at '{worker}' {what}, and this machine has {own}. Install the same version on all: "
                'pip install "glossspace[analysis,cluster]".'
            )


def _own_version() -> str:
    return version(_PACKAGE)


def _no_scheduler(scheduler: str, why: str) -> GlossError:
    return GlossError(
        f"No Dask scheduler answers at '{scheduler}': {why}. Check the address, such as tcp://host:8786, and that "
        "'dask scheduler' runs there."
    )


def _said(error: BaseException) -> str:
    """First line of what an exception says."""
    return str(error).strip().partition("\n")[0].rstrip(".") or type(error).__name__
