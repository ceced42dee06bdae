"""The same pokes on a dask cluster, one poke one task: `--cluster ADDRESS` or `--cluster local`."""

from __future__ import annotations

import os
from collections.abc import Generator, Sequence
from typing import Any

from factory._record import Outcome
from factory._worker import THREAD_VARIABLES, run_poke
from factory.errors import InputError
from factory.plan import PlannedPoke

_CONNECT_SECONDS = 20


def run_cluster(
    pokes: Sequence[PlannedPoke], *, address: str, workers: int, simulator: str
) -> Generator[Outcome]:
    """Outcomes in the order they come; the arrays travel back, so that only this process writes files.

    dask runs a poke again where its worker was lost, three times at most.
    """
    try:
        import distributed
    except ImportError:
        raise InputError("--cluster needs dask: pip install 'tisim[cluster]'") from None
    cluster: Any = None
    client: Any = None
    # before the workers start: numpy and MKL read these once
    os.environ.update(THREAD_VARIABLES)
    try:
        if address == "local":
            cluster = distributed.LocalCluster(
                n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None
            )
        try:
            client = distributed.Client(cluster or address, timeout=_CONNECT_SECONDS)
        except (OSError, ValueError) as error:
            text = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise InputError(f"--cluster {address}: no dask scheduler answers there ({text})") from None
        run = os.urandom(4).hex()  # a scheduler may still remember the keys of an earlier build
        numbers = {
            client.submit(run_poke, poke, simulator, key=f"poke-{poke.index}-{run}"): poke.index
            for poke in pokes
        }
        for future in distributed.as_completed(list(numbers)):
            lost = future.exception()
            if lost is None:
                yield future.result()
            else:
                text = f"{type(lost).__name__}: {' '.join(str(lost).split())}"
                yield Outcome(index=numbers[future], payload=None, error=text[:400])
            del numbers[future]
            future.release()  # the cluster need not keep what we have
    except OSError as error:
        raise InputError(
            f"--cluster {address}: the connection was lost ({error}); every finished poke is kept"
        ) from None
    finally:
        if client is not None:
            client.close()
        if cluster is not None:
            cluster.close()
