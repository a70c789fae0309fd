"""Make a bag fit to be shared: images and what was said are taken out, all else stays as it was recorded."""

import shutil
import tempfile
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

from mcap.records import Attachment, Channel, Chunk, Header, Message, Metadata, Schema

from bags.bag_metadata import BagMetadata, CustomEntry, joined
from bags.decoding import MessageDecoder
from bags.earlier_files import CLOSED_ENTRY, counted, file_name
from bags.file_writer import LARGEST_MANIFEST_RECORD, MANIFEST_ATTACHMENT, MANIFEST_RECORD
from bags.image_redaction import blur_message, is_colored_cloud, is_image, may_hold_images, redact_parts
from bags.mcap_rewriter import McapRewriter, new_chunk, record_bytes
from bags.mcap_scan import (
    MAGIC,
    MESSAGE_HEADER,
    RECORD_HEADER,
    ChunkContents,
    WholeRecord,
    chunk_contents,
    open_file,
    summary_at_end,
    whole_records,
)
from bags.reader import Bag, open_bag
from bags.recorded_values import CONVERSIONS
from bags.redaction_choices import Chat, Images
from bags.repair_bag import bag_files
from bags.text_redaction import SpokenTexts, carries_chat, change_texts, chat_texts, redact_chat
from robustnav_msgs_py.errors import BadFileError, BadMessageError, BadParameterError

REDACTED_ENTRY = "robustnav_redacted"  # in metadata.yaml, also of bags that have no manifest
LABELS = ("detections/labels", "truth/labels")


@dataclass(slots=True)
class Redaction:
    """What was done, by topic, in messages."""

    removed: Counter[str] = field(default_factory=Counter)
    blurred: Counter[str] = field(default_factory=Counter)
    parts: Counter[str] = field(default_factory=Counter)
    replaced: Counter[str] = field(default_factory=Counter)
    left_out: int = 0

    @property
    def sentences(self) -> tuple[str, ...]:
        """The report as a person reads it, and as the manifest holds it."""
        told = {
            "removed": self.removed,
            "images blurred": self.blurred,
            "images in messages emptied or blurred": self.parts,
            "what was said replaced": self.replaced,
        }
        found = [
            f"{what}: " + ", ".join(f"{topic} ({count} messages)" for topic, count in sorted(counts.items()))
            for what, counts in told.items()
            if counts
        ]
        if self.left_out:
            found.append(
                f"left out: {self.left_out} attachments and metadata records that are not robustnav's"
            )
        return tuple(found) or ("there was nothing to redact",)


def redact_bag(path: Path, out: Path, *, images: Images, chat: Chat) -> Redaction:
    """Write the bag at `path` without images and without what was said into the new folder `out`.

    With `images` blur, images that cannot be blurred are removed. Messages that hold neither are copied byte
    by byte, with their times, order and QoS; the manifest is kept and says what was redacted. Attachments and
    metadata that others added are left out: nobody knows what they show.

    Raises BadFileError where there is no bag, `out` exists, or a message that may hold what was said cannot
    be read; BadParameterError where everything is to be kept; OSError where the disk fails.
    """
    if images is Images.KEEP and chat is Chat.KEEP:
        raise BadParameterError("images and chat are both to be kept, so there is nothing to redact")
    if out.exists():
        raise BadFileError(
            f"{out} exists already and is not overwritten; choose another name or move it away"
        )
    with open_bag(path) as bag:
        worker = _Worker(images, chat, _spoken(bag) if chat is Chat.REMOVE else None)
        try:
            staged = Path(tempfile.mkdtemp(prefix=f".{out.name}.", dir=out.parent))
        except OSError as error:
            raise BadFileError(f"a bag cannot be written to {out}: {error.strerror or error}") from error
        try:
            _write(bag, path, staged, out, worker)
            staged.chmod(0o755)  # a temporary folder is its owner's alone
            staged.rename(out)
        except BaseException:
            shutil.rmtree(staged, ignore_errors=True)
            raise
    return worker.done


def _write(bag: Bag, path: Path, staged: Path, out: Path, worker: "_Worker") -> None:
    files = bag_files(path) if path.is_dir() else [path]
    written = [staged / file_name(out, number) for number in range(len(files))]
    for place, (source, target) in enumerate(zip(files, written, strict=True)):
        with open_file(source) as stream, target.open("wb") as output:
            rewriter = McapRewriter(output)
            summary = summary_at_end(stream)
            if summary is not None:
                worker.learn(summary.schemas.values(), summary.channels.values())
                rewriter.define(summary.schemas.values(), summary.channels.values())
            stream.seek(len(MAGIC))
            for whole in whole_records(stream):
                kept = worker.rewritten(whole)
                if kept is not None:
                    rewriter.take(kept)
            if place == len(files) - 1:
                for record in _manifest_records(bag, worker.done):
                    rewriter.take(_whole(record))
            rewriter.finish()
    holds = [counted(file) for file in written]
    before = bag.metadata
    BagMetadata(
        files=tuple(row for row, _ in holds),
        topics=joined(topic for _, topics in holds for topic in topics),
        custom=(
            # this bag is closed, whatever became of the recorder of the other
            *(entry for entry in (before.custom if before else ()) if entry.name != CLOSED_ENTRY),
            CustomEntry(name=REDACTED_ENTRY, text="; ".join(worker.done.sentences)),
        ),
        ros_distro=before.ros_distro if before else "jazzy",
    ).write(staged)


def _manifest_records(bag: Bag, done: Redaction) -> list[Metadata | Attachment]:
    manifest = bag.manifest
    if manifest is None:
        return []
    text = replace(manifest, redacted=(*manifest.redacted, *done.sentences)).as_json()
    if len(text.encode()) <= LARGEST_MANIFEST_RECORD:
        return [Metadata(name=MANIFEST_RECORD, metadata={"json": text})]
    begun_ns = manifest.wall_start_ns
    return [
        Attachment(
            create_time=begun_ns,
            log_time=begun_ns,
            name=MANIFEST_ATTACHMENT,
            media_type="application/json",
            data=text.encode(),
        ),
        Metadata(name=MANIFEST_RECORD, metadata={"attachment": MANIFEST_ATTACHMENT}),
    ]


def _spoken(bag: Bag) -> SpokenTexts:
    """What was said in `bag`; raises BadFileError where a message of the dialogue cannot be read."""
    names = [row.name for row in bag.topics]
    labels = [name for name in names if name.endswith(LABELS)]
    known = {label for told in bag.messages(labels) for label in CONVERSIONS[LABELS[0]](told.message)}
    spoken = SpokenTexts(known)
    for recorded in bag.messages([row.name for row in bag.topics if carries_chat(row.name, row.type)]):
        spoken.add(chat_texts(recorded.type, recorded.message))
    for recorded in bag.messages([name for name in names if name.endswith("/search/target")]):
        try:
            spoken.add_target(CONVERSIONS["search/target"](recorded.message))
        except (AttributeError, BadMessageError):  # somebody else's topic of that name
            spoken.add([str(recorded.message)])
    return spoken


class _Worker:
    """Goes through the records of a bag's files, one after the other, and counts in `done` what it did."""

    def __init__(self, images: Images, chat: Chat, spoken: SpokenTexts | None) -> None:
        self.done = Redaction()
        self._images = images
        self._spoken = spoken
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._decoder = MessageDecoder()

    def learn(self, schemas: Iterable[Schema], channels: Iterable[Channel]) -> None:
        """Know these types and topics from here on."""
        for schema in schemas:
            self._schemas[schema.id] = schema
            self._decoder.add(schema.name, schema.data.decode(errors="replace"), schema.encoding)
        self._channels.update({channel.id: channel for channel in channels})

    def rewritten(self, whole: WholeRecord) -> WholeRecord | None:
        """The record as it may be shared, None where nothing of it may."""
        record = whole.record
        if isinstance(record, Chunk) and whole.contents is not None:
            self.learn(whole.contents.schemas, whole.contents.channels)
            return self._rewritten_chunk(whole, whole.contents)
        if isinstance(record, Schema):
            self.learn([record], [])
        elif isinstance(record, Channel):
            self.learn([], [record])
        elif isinstance(record, Message):
            data = self._changed(record.channel_id, record.data)
            if data is None or data is record.data:
                return None if data is None else whole
            return _whole(replace(record, data=data))
        elif isinstance(record, (Metadata, Attachment)):
            ours = ("rosbag2", MANIFEST_RECORD, MANIFEST_ATTACHMENT)
            self.done.left_out += record.name not in ours
            return None
        elif not isinstance(record, Header):
            return None
        return whole

    def _rewritten_chunk(self, whole: WholeRecord, contents: ChunkContents) -> WholeRecord:
        data, kept, at = contents.data, bytearray(), 0
        times_ns: list[int] = []
        is_changed = False
        places = [(start, channel) for channel, told in contents.messages.items() for _, start in told]
        for start, channel in sorted(places):
            kind, length = RECORD_HEADER.unpack_from(data, start)
            begin, end = start + RECORD_HEADER.size, start + RECORD_HEADER.size + length
            fixed = data[begin : begin + MESSAGE_HEADER.size]
            payload = data[begin + MESSAGE_HEADER.size : end]
            changed = self._changed(channel, payload)
            kept += data[at:start]
            at = end
            is_changed = is_changed or changed is not payload
            if changed is not None:
                kept += RECORD_HEADER.pack(kind, len(fixed) + len(changed)) + fixed + changed
                times_ns.append(MESSAGE_HEADER.unpack(fixed)[2])
        if not is_changed:
            return whole
        kept += data[at:]
        return _whole(new_chunk(bytes(kept), min(times_ns, default=0), max(times_ns, default=0)))

    def _changed(self, channel_id: int, data: bytes) -> bytes | None:
        """A message's bytes as they may be shared: the same object where nothing changes, None: none."""
        channel = self._channels.get(channel_id)
        if channel is None:  # nobody can tell what it is
            return None
        schema = self._schemas.get(channel.schema_id)
        kind, definition = (schema.name, schema.data.decode(errors="replace")) if schema else ("", "")
        if self._images is not Images.KEEP:
            if is_image(kind):
                return self._changed_image(channel.topic, kind, data)
            if may_hold_images(definition):
                held = self._changed_parts(channel.topic, kind, data)
                if held is None or held is not data:
                    return held
            if is_colored_cloud(kind, data):
                self.done.removed[channel.topic] += 1
                return None
        if self._spoken is None:
            return data
        said_here = carries_chat(channel.topic, kind)
        if not said_here and not self._spoken.stand_in(data):
            return data
        message = self._decoder.decode(kind, data)
        if said_here:
            redact_chat(kind, message)
        change_texts(message, self._spoken.replaced)
        self.done.replaced[channel.topic] += 1
        return self._decoder.encode(kind, message)

    def _changed_parts(self, topic: str, kind: str, data: bytes) -> bytes | None:
        """The message with its parts that are images emptied or blurred."""
        try:
            message = self._decoder.decode(kind, data)
        except BadFileError:  # what cannot be read may still show something
            self.done.removed[topic] += 1
            return None
        if not redact_parts(message, blur=self._images is Images.BLUR):
            return data
        self.done.parts[topic] += 1
        return self._decoder.encode(kind, message)

    def _changed_image(self, topic: str, kind: str, data: bytes) -> bytes | None:
        if self._images is Images.BLUR:
            try:
                message = self._decoder.decode(kind, data)
            except BadFileError:  # what cannot be read may still show something
                message = None
            if message is not None and blur_message(kind, message):
                self.done.blurred[topic] += 1
                return self._decoder.encode(kind, message)
        self.done.removed[topic] += 1
        return None


def _whole(record: Chunk | Message | Metadata | Attachment) -> WholeRecord:
    raw = record_bytes(record)
    contents = chunk_contents(record) if isinstance(record, Chunk) else None
    return WholeRecord(kind=raw[0], start=0, raw=raw, record=record, contents=contents)
