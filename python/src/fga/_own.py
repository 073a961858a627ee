"""Policies of one's own in Python, as the compiled part asks for them."""

from __future__ import annotations

import copy
import ctypes
import hashlib
import inspect
import traceback
from typing import Any, Callable

from ._fga import versions


class OutOfTime(BaseException):
    """Raised inside a policy that has used up its time limit; no `except Exception` stops it."""


def name(policy: Any) -> str:
    """The name of a policy: of its class or function."""
    named = policy if hasattr(policy, "__qualname__") else type(policy)
    return named.__qualname__


def fingerprint(policy: Any) -> str:
    """A fingerprint of the code and the values of a policy, so that a campaign does not go on with another one."""
    digest = hashlib.sha256(repr(versions).encode())
    named = policy if hasattr(policy, "__qualname__") else type(policy)
    digest.update(_source(named))
    if named is not policy:
        digest.update(repr(sorted(vars(policy).items())).encode() if hasattr(policy, "__dict__") else b"")
    for cell in getattr(policy, "__closure__", None) or ():
        digest.update(repr(cell.cell_contents).encode())
    return digest.hexdigest()


def _source(named: Any) -> bytes:
    try:
        # The whole module: a policy calls functions beside it.
        with open(inspect.getsourcefile(named) or "", "rb") as file:
            return file.read()
    except (OSError, TypeError):
        pass
    try:
        return inspect.getsource(named).encode()
    except (OSError, TypeError):
        code = getattr(named, "__code__", None)
        return named.__qualname__.encode() if code is None else code.co_code + repr(code.co_consts).encode()


def made(policy: Any, method: str, settings: Any, vehicle: Any) -> tuple[Callable, Callable | None]:
    """What is called at every step of a flight, and what is called when limits change."""
    if isinstance(policy, type):
        policy = policy(settings, vehicle)
    elif hasattr(policy, method):
        # Each flight has its own, so that none depends on the one before it.
        policy = copy.deepcopy(policy)
    elif callable(policy):
        return policy, None
    return getattr(policy, method), getattr(policy, "retune", None)


def said(error: BaseException) -> str:
    """An exception as one line, with its place in the policy."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    text = " ".join(str(error).split())
    return f"raised {type(error).__name__}{': ' if text else ''}{text}{place}"


def interrupt(thread: int) -> None:
    """Raises OutOfTime in a thread of Python code; a call that waits outside of Python goes on until it returns."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(OutOfTime))
