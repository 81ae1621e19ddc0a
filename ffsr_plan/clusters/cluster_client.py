"""Clients of Dask clusters that are there already."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ffsr_plan.core.errors import InvalidInput

if TYPE_CHECKING:
    from distributed import Client

_CONNECTING = "30s"


@contextmanager
def connected(scheduler: object) -> Iterator[Client]:
    """A client of a cluster.

    Args:
        scheduler: its address, such as `tcp://10.0.0.1:8786`, or a client, which stays open.

    Raises:
        InvalidInput: no scheduler answers there, or Dask is not installed.
    """
    client_class = _client_class()
    if isinstance(scheduler, client_class):
        yield scheduler
        return
    if not isinstance(scheduler, str) or "://" not in scheduler:
        raise InvalidInput("scheduler", scheduler, "an address such as tcp://10.0.0.1:8786")
    try:
        client = client_class(scheduler, timeout=_CONNECTING, set_as_default=False)
    except Exception as error:  # of many types, by what is wrong with the address
        allowed = f"the address of a Dask scheduler that answers ({error})"
        raise InvalidInput("scheduler", scheduler, allowed) from None
    with client:
        yield client


def _client_class() -> type[Client]:
    try:
        from distributed import Client
    except ImportError:
        allowed = "the extra 'cluster' installed: pip install 'ffsr-plan[cluster]'"
        raise InvalidInput("scheduler", "Dask, which is not installed", allowed) from None
    return Client
