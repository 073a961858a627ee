"""Stores of a campaign's blocks: a folder that all machines share, or a URL that fsspec knows."""

from __future__ import annotations

import json
import os
import posixpath
import tempfile
import uuid
from typing import Sequence

from ._fga import Campaign

_BLOCKS = "blocks"
_MANIFEST = "campaign.json"
RESULTS = "results.parquet"


def finished_blocks(campaign: Campaign, names: Sequence[str], place: str) -> dict[int, str]:
    """The finished blocks by their numbers."""
    finished: dict[int, str] = {}
    for name in names:
        block = campaign.block_of(name)
        if block is None:
            continue
        other = finished.setdefault(block, name)
        if other != name or block >= campaign.blocks:
            raise ValueError(
                f"{place}: holds {name}, which is no block of this campaign beside {other}; take it away"
            )
    return finished


def store_of(out: str | os.PathLike[str]) -> "FolderStore | UrlStore":
    """The store of a folder's path or of a URL such as `s3://bucket/campaign`."""
    place = os.fspath(out)
    if "://" in place and not place.startswith("file://"):
        return UrlStore(place)
    return FolderStore(os.path.abspath(place.removeprefix("file://")))


class FolderStore:
    """A folder that all machines share."""

    def __init__(self, folder: str) -> None:
        self.place = folder

    def open(self, campaign: Campaign) -> None:
        """Makes the folder ready, or checks that it is this campaign's; raises before anything is flown."""
        campaign.open(self.place)
        probe = os.path.join(self.place, _BLOCKS, f".{uuid.uuid4().hex}.part")
        with open(probe, "wb") as file:
            file.write(b"fga")
        os.remove(probe)

    def names(self) -> list[str]:
        """Names of the files of finished blocks."""
        try:
            return os.listdir(os.path.join(self.place, _BLOCKS))
        except FileNotFoundError:
            return []

    def put(self, name: str, data: bytes) -> None:
        """Writes a finished block: under a temporary name, on the disk, then under its own."""
        folder = os.path.join(self.place, _BLOCKS)
        part = os.path.join(folder, f".{name}.{uuid.uuid4().hex}.part")
        try:
            with open(part, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            os.replace(part, os.path.join(folder, name))
        except OSError:
            try:
                os.remove(part)
            except OSError:
                pass
            raise

    def results(self) -> bool:
        """Whether the blocks were put together already."""
        return os.path.exists(os.path.join(self.place, RESULTS))

    def merge(self, campaign: Campaign, csv: bool) -> str:
        """Puts the blocks together; the SHA-256 of results.parquet."""
        return campaign.merge(self.place, csv=csv)


class UrlStore:
    """A URL that fsspec knows, as in `s3://bucket/campaign`."""

    def __init__(self, url: str) -> None:
        self.place = url.rstrip("/")
        self._fs = None

    def __reduce__(self):
        return UrlStore, (self.place,)

    def _connect(self):
        if self._fs is None:
            try:
                import fsspec
            except ImportError as error:
                raise ValueError(
                    f"{self.place}: is a URL, which needs the package fsspec, expected it installed"
                ) from error
            self._fs, self._root = fsspec.core.url_to_fs(self.place)
        return self._fs, self._root

    def _path(self, *parts: str) -> str:
        return posixpath.join(self._connect()[1], *parts)

    def open(self, campaign: Campaign) -> None:
        """Makes the place ready, or checks that it is this campaign's; raises before anything is flown."""
        fs, _ = self._connect()
        fs.invalidate_cache()
        fs.makedirs(self._path(_BLOCKS), exist_ok=True)
        manifest = self._path(_MANIFEST)
        if fs.exists(manifest):
            try:
                found = json.loads(fs.cat_file(manifest))["configuration_hash"]
            except (ValueError, KeyError, TypeError) as error:
                raise ValueError(f"{self.place}: holds no manifest of a campaign: {error}") from error
            if found != campaign.hash:
                raise ValueError(
                    f"{self.place}: holds results of another configuration, expected an empty place or the same campaign"
                )
        else:
            self._put(manifest, campaign.manifest_json().encode())

    def _put(self, path: str, data: bytes) -> None:
        fs, _ = self._connect()
        head, tail = posixpath.split(path)
        part = posixpath.join(head, f".{tail}.{uuid.uuid4().hex}.part")
        fs.pipe_file(part, data)
        fs.mv(part, path)

    def names(self) -> list[str]:
        """Names of the files of finished blocks."""
        fs, _ = self._connect()
        fs.invalidate_cache()
        try:
            return [posixpath.basename(path) for path in fs.ls(self._path(_BLOCKS), detail=False)]
        except FileNotFoundError:
            return []

    def put(self, name: str, data: bytes) -> None:
        """Writes a finished block: under a temporary name, then under its own."""
        self._put(self._path(_BLOCKS, name), data)

    def results(self) -> bool:
        """Whether the blocks were put together already."""
        fs, _ = self._connect()
        fs.invalidate_cache()
        return fs.exists(self._path(RESULTS))

    def merge(self, campaign: Campaign, csv: bool) -> str:
        """Puts the blocks together on this machine's disk and writes the results; their SHA-256.

        results.parquet comes last: a place that has it has everything.
        """
        fs, _ = self._connect()
        with tempfile.TemporaryDirectory(prefix="fga-") as folder:
            campaign.open(folder)
            for name in self.names():
                if campaign.block_of(name) is not None:
                    fs.get_file(self._path(_BLOCKS, name), os.path.join(folder, _BLOCKS, name))
            sha256 = campaign.merge(folder, csv=csv)
            files = [
                os.path.relpath(os.path.join(at, name), folder)
                for at, _, names in os.walk(folder)
                for name in names
            ]
            for name in sorted(files, key=lambda name: name == RESULTS):
                with open(os.path.join(folder, name), "rb") as file:
                    self._put(self._path(*name.split(os.sep)), file.read())
        fs.rm(self._path(_BLOCKS), recursive=True)
        return sha256
