"""Give an MCAP file that was cut a proper end, so that every reader takes it again."""

import contextlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.opcode import Opcode

from bags.mcap_rewriter import McapRewriter
from bags.mcap_scan import MAGIC, open_file, summary_at_end, whole_records
from robustnav_msgs_py.errors import BadFileError

UNFINISHED_SUFFIX = ".part"


@dataclass(frozen=True, slots=True, kw_only=True)
class RepairReport:
    """What a repair kept and left out.

    The last `lost_bytes` of the old file were not whole; `lost_messages` were, but what defines their topic
    stood in a chunk that is damaged.
    """

    path: Path
    topics: int
    messages: int
    lost_bytes: int
    damaged_chunks: int
    lost_messages: int

    @property
    def sentence(self) -> str:
        """The report as a person reads it."""
        lost = [f"its last {self.lost_bytes} bytes were not whole"]
        if self.damaged_chunks:
            lost.append(f"{self.damaged_chunks} chunks were damaged")
        if self.lost_messages:
            lost.append(f"{self.lost_messages} messages of topics that nothing defines were left out")
        return (
            f"{self.path} was repaired and holds {self.messages} messages of {self.topics} topics: "
            + ", ".join(lost)
        )


def repair_file(path: Path) -> RepairReport:
    """Rewrite the MCAP file at `path` with what of it is whole, and with an index and an end.

    Chunks are copied as they are, with all definitions, metadata and attachments; one record at a time is in
    memory. The old file stands until the new one is whole on the disk, which needs room for both. A file that
    was cut before its first record becomes an empty one.

    Raises BadFileError where `path` cannot be opened or is no MCAP file, OSError where the disk fails; the
    file is then as it was.
    """
    with open_file(path) as stream:
        start = stream.read(len(MAGIC))
        if not MAGIC.startswith(start):
            raise BadFileError(f"{path} is not an MCAP file: it starts with {start!r}")
        unfinished = path.with_name(path.name + UNFINISHED_SUFFIX)
        try:
            with unfinished.open("wb") as output:
                report = _rewrite(path, stream, output)
                output.flush()
                os.fsync(output.fileno())  # the only copy is about to be given up
            unfinished.replace(path)
        except BaseException:
            with contextlib.suppress(OSError):
                unfinished.unlink(missing_ok=True)
            raise
    return report


def _rewrite(path: Path, stream: BinaryIO, output: BinaryIO) -> RepairReport:
    rewriter = McapRewriter(output)
    summary = summary_at_end(stream)
    if summary is not None:  # finished, and damaged later: what defines a topic stands here, too
        rewriter.define(summary.schemas.values(), summary.channels.values())
    size_bytes = path.stat().st_size
    kept_bytes = min(size_bytes, len(MAGIC))
    for whole in whole_records(stream):
        if whole.kind == Opcode.DATA_END:  # what follows only indexes what came before
            kept_bytes = size_bytes
            break
        rewriter.take(whole)
        kept_bytes = whole.end
    rewriter.finish()
    return RepairReport(
        path=path,
        topics=rewriter.channel_count,
        messages=rewriter.message_count,
        lost_bytes=size_bytes - kept_bytes,
        damaged_chunks=rewriter.damaged_chunks,
        lost_messages=rewriter.lost_messages,
    )
