"""Policies of one's own in Python, as the compiled part asks for them."""

from __future__ import annotations

import copy
import ctypes
import hashlib
import inspect
import os
import re
import traceback
import types
from typing import Any, Callable, Iterator


class OutOfTime(BaseException):
    """Raised inside a policy that has used up its time limit; no `except Exception` stops it."""


def name(policy: Any) -> str:
    """The name of a policy: of its class or function."""
    named = policy if hasattr(policy, "__qualname__") else type(policy)
    return named.__qualname__


def fingerprint(policy: Any, carried: str | None = None) -> str:
    """A fingerprint of the code and the values of a policy, so that a campaign does not go on with another one.

    `carried` came with a pickled policy. It stands for one whose file is not here, as for a class of a notebook; any other
    policy is looked at here too, so that another version of its module is noticed.
    """
    named = policy if hasattr(policy, "__qualname__") else type(policy)
    file = _file(named)
    if carried is not None and (file is None or named.__module__ in ("__main__", "__mp_main__")):
        return carried
    digest = hashlib.sha256()
    if file is None:
        for part in _code(named, set()):
            digest.update(part.encode())
    else:
        # The whole module: a policy calls functions beside it.
        with open(file, "rb") as source:
            digest.update(source.read())
    if named is not policy:
        digest.update(_shown(sorted(getattr(policy, "__dict__", {}).items())).encode())
    for cell in getattr(policy, "__closure__", None) or ():
        digest.update(_shown(cell.cell_contents).encode())
    return digest.hexdigest()


def _file(named: Any) -> str | None:
    """The file of a class or function; none for those of a notebook."""
    try:
        path = inspect.getsourcefile(named)
    except (OSError, TypeError):
        return None
    return path if path and os.path.exists(path) else None


def _code(thing: Any, seen: set[int]) -> Iterator[str]:
    """The code of a class or function of a notebook, and of what it names there, without lines and addresses."""
    thing = getattr(thing, "__func__", None) or getattr(thing, "fget", None) or thing
    if not isinstance(thing, (types.FunctionType, type)):
        yield _shown(thing)
    elif id(thing) not in seen:
        seen.add(id(thing))
        yield from _members(thing, seen) if isinstance(thing, type) else _body(thing, seen)


def _members(thing: type, seen: set[int]) -> Iterator[str]:
    for name, value in sorted(vars(thing).items()):
        if name not in ("__firstlineno__", "__static_attributes__"):
            yield name
            yield from _code(value, seen)
    for base in thing.__bases__:
        yield from _beside(base, seen)


def _body(thing: types.FunctionType, seen: set[int]) -> Iterator[str]:
    yield _shown((thing.__defaults__, thing.__kwdefaults__))
    codes = [thing.__code__]
    for code in codes:
        codes += (const for const in code.co_consts if isinstance(const, types.CodeType))
        yield code.co_code.hex()
        for value in (*code.co_names, *code.co_consts):
            yield "" if isinstance(value, types.CodeType) else _shown(value)
        for name in code.co_names:
            yield from _beside(thing.__globals__.get(name), seen)


def _beside(thing: Any, seen: set[int]) -> Iterator[str]:
    """What a notebook made, or the name of what others made."""
    if isinstance(thing, (types.FunctionType, type)) and thing.__module__ == "__main__":
        yield from _code(thing, seen)
    else:
        name = getattr(thing, "__name__", None)
        yield name if isinstance(name, str) else _shown(thing)


def _shown(value: Any) -> str:
    """A value as text that is the same in another process."""
    if isinstance(value, (set, frozenset)):
        value = sorted(map(repr, value))
    return re.sub(r" at 0x[0-9a-f]+", "", repr(value))


def made(policy: Any, method: str, settings: Any, vehicle: Any) -> tuple[Callable, Callable | None]:
    """What is called at every step of a flight, and what is called when limits change."""
    if isinstance(policy, type):
        takes_nothing = policy.__init__ is object.__init__ and policy.__new__ is object.__new__
        policy = policy() if takes_nothing else policy(settings, vehicle)
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
