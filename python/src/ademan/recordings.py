"""Recordings (MCAP) as data frames."""

from __future__ import annotations

import json
import os
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd
from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import DecodeError, Message
from mcap.exceptions import EndOfFile, McapError
from mcap.records import Channel, Metadata, Schema
from mcap.records import Message as Record
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

from .program import call

_SAMPLES = ("channels", "angles_rad", "joints_m", "body", "bones", "displacement")
_UNMEASURED_COUNT = 65535
_TOPICS = ("readings", "angles", "touches", "presses", "events", "commands")


@dataclass(frozen=True)
class Recording:
    """The content of a recording.

    Every data frame has the columns `time_us`, on the clock of the source, and `time_s`, from the first reading.
    """

    path: Path
    #: The setup and its files: kind, name and text of each.
    setup: list[dict[str, str]]
    #: One row for each reading of the sensor; `sample` names what it measures, the other columns are its values.
    readings: pd.DataFrame
    #: Joint angles in radians, one row for each reading that was accepted.
    angles: pd.DataFrame
    #: Changes of the contact between a fingertip and a target.
    touches: pd.DataFrame
    #: Presses with their evidence; `neighbors` lists the targets nearby and their distances in metres.
    presses: pd.DataFrame
    #: Events sent to the output.
    events: pd.DataFrame
    #: Commands of the layout and from outside.
    commands: pd.DataFrame
    #: Whether the file ends as it should. All that was written before a cut is there.
    is_complete: bool = field(default=True)

    @property
    def layout(self) -> str | None:
        """The text of the recorded layout (RON)."""
        return next((entry["text"] for entry in self.setup if entry["kind"] == "layout"), None)

    def poses(self) -> pd.DataFrame:
        """Return the positions of the joints in metres, one row for each reading, with columns such as `wrist_x`.

        Poses are not recorded: the program computes them again from the readings and the recorded setup.

        Raises:
            ProgramError: the program is missing or refuses the recording.
        """
        lines = call(["trace", "pose", "--source", f"recording:{self.path}"]).splitlines()
        rows = []
        for line in lines:
            pose = json.loads(line)
            row: dict[str, Any] = {"time_us": pose["time_us"], "side": pose.get("side")}
            for joint, position in pose["positions"].items():
                row |= {f"{joint}_{axis}": value for axis, value in zip("xyz", position, strict=True)}
            rows.append(row)
        return _frame(rows, _first_time(self.readings))

    def typed_text(self) -> str:
        """Return the characters of the keys that went down, with Backspace applied; other keys are left out.

        Letters are in lower case: which of them a modifier changes depends on the keyboard layout of the desktop.
        """
        text: list[str] = []
        for event in self.events.to_dict("records"):
            if event["kind"] == "character":
                text.append(event["character"])
            elif event["kind"] == "key-down":
                key = event["key"]
                if key == "Backspace":
                    del text[-1:]
                elif key in ("Space", "Enter"):
                    text.append(" " if key == "Space" else "\n")
                elif len(key) == 1:
                    text.append(key.lower())
        return "".join(text)


def read(path: str | os.PathLike[str]) -> Recording:
    """Read a recording.

    A file that is cut keeps everything up to the cut; `is_complete` is `False` then.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is not a recording of Ademán.
    """
    path = Path(path)
    rows: dict[str, list[dict[str, Any]]] = defaultdict(list)
    setup: list[dict[str, str]] = []
    is_recording = False
    is_complete = True
    with path.open("rb") as stream:
        records = _records(stream)
        while True:
            try:
                entry = next(records)
            except StopIteration:
                break
            except (EndOfFile, McapError, DecodeError) as error:
                if not is_recording:
                    raise ValueError(f"{path} is not a recording: {error}") from error
                is_complete = False
                break
            if isinstance(entry, Metadata):
                if entry.name == "ademan":
                    is_recording = True
                    _check_format(path, entry.metadata.get("format"))
                if entry.name == "ademan.setup":
                    setup.append({key: entry.metadata.get(key, "") for key in ("kind", "name", "text")})
            elif is_recording:
                topic, message = entry
                rows[topic].append(_row(topic, message))
            else:
                break
    if not is_recording:
        raise ValueError(f"{path} is not a recording of Ademán: it has no metadata `ademan`")
    first = min((row["time_us"] for row in rows["/readings"]), default=0)
    frames = {topic: _frame(rows[f"/{topic}"], first) for topic in _TOPICS}
    return Recording(path=path, setup=setup, is_complete=is_complete, **frames)


def _check_format(path: Path, version: str | None) -> None:
    if version == "1":
        raise ValueError(
            f"{path} is a recording of format 1; convert it with: ademan record new.mcap --source recording:{path}"
        )
    if version != "2":
        raise ValueError(f"{path} has the recording format {version}; this package reads format 2, so update it")


def _records(stream: Any) -> Iterator[Metadata | tuple[str, Message]]:
    """Yield metadata and the decoded messages of the topics of a recording, in the order of the file."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    factory = DecoderFactory()
    for record in StreamReader(stream).records:
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, Metadata):
            yield record
        elif isinstance(record, Record):
            channel = channels.get(record.channel_id)
            if channel is None or channel.topic.removeprefix("/") not in _TOPICS:
                continue
            decode = factory.decoder_for(channel.message_encoding, schemas.get(channel.schema_id))
            if decode is not None:
                yield channel.topic, decode(record.data)


def _row(topic: str, message: Message) -> dict[str, Any]:
    row: dict[str, Any] = {"time_us": message.time_us}  # type: ignore[attr-defined]
    if topic == "/readings":
        sample = message.WhichOneof("sample")
        row["sample"] = sample
        _flatten(message, row, "", skip=("time_us", *_SAMPLES))
        if sample == "channels":
            _channels(message.channels, row)  # type: ignore[attr-defined]
        elif sample is not None:
            _flatten(getattr(message, sample), row, "")
    elif topic == "/angles":
        _flatten(message, row, "", skip=("time_us", "angles_rad"))
        _flatten(message.angles_rad, row, "")  # type: ignore[attr-defined]
    else:
        _flatten(message, row, "", skip=("time_us",))
    return row


def _channels(channels: Any, row: dict[str, Any]) -> None:
    """Add the counts of a glove as columns `channel_0`…; channels that were not measured or sent have none."""
    row["full_scale"] = channels.full_scale
    for index, count in enumerate(channels.counts):
        is_sent = not channels.unsent >> index & 1
        row[f"channel_{index}"] = count if is_sent and count != _UNMEASURED_COUNT else None


def _flatten(message: Message, row: dict[str, Any], prefix: str, skip: tuple[str, ...] = ()) -> None:
    """Add the fields of a message as columns; fields of messages in it get its name as a prefix."""
    for descriptor in message.DESCRIPTOR.fields:
        name = descriptor.name
        if name in skip:
            continue
        value = getattr(message, name)
        column = prefix + name
        if _is_repeated(descriptor):
            _add_list(descriptor, value, row, column)
        elif descriptor.type == FieldDescriptor.TYPE_MESSAGE:
            if message.HasField(name):
                _flatten(value, row, f"{column}_")
        elif descriptor.containing_oneof is not None:
            if message.HasField(name):
                row[_oneof_column(descriptor, column)] = value
        elif descriptor.type == FieldDescriptor.TYPE_ENUM:
            row[column] = _enum_word(descriptor, value)
        else:
            # Every event has every field; a text that is empty does not belong to its kind.
            row[column] = None if value == "" else value


def _oneof_column(descriptor: Any, column: str) -> str:
    """Return the column of a field that excludes others: a target has one column, be it a name or an index."""
    return "target" if descriptor.containing_oneof.name == "target" else column


def _add_list(descriptor: Any, values: Any, row: dict[str, Any], column: str) -> None:
    if descriptor.type != FieldDescriptor.TYPE_MESSAGE:
        row[column] = list(values)
    elif column == "points":
        for index, point in enumerate(values):
            _flatten(point, row, f"point_{index}_")
    else:
        entries: list[dict[str, Any]] = []
        for value in values:
            entry: dict[str, Any] = {}
            _flatten(value, entry, "")
            entries.append(entry)
        row[column] = entries


def _is_repeated(descriptor: Any) -> bool:
    # `label` goes away in later versions of protobuf, `is_repeated` is not in earlier ones.
    repeated = getattr(descriptor, "is_repeated", None)
    return bool(descriptor.label == FieldDescriptor.LABEL_REPEATED if repeated is None else repeated)


def _enum_word(descriptor: Any, value: int) -> str | None:
    """Return the word of a value, such as `key-down` for `EVENT_KEY_DOWN`; `None` for the unspecified one."""
    enum = descriptor.enum_type
    name = enum.values_by_number[value].name if value in enum.values_by_number else str(value)
    unspecified = enum.values_by_number[0].name
    prefix = unspecified.removesuffix("UNSPECIFIED")
    return None if name == unspecified else name.removeprefix(prefix).lower().replace("_", "-")


def _first_time(readings: pd.DataFrame) -> int:
    return int(readings["time_us"].min()) if len(readings) else 0


def _frame(rows: list[dict[str, Any]], first_us: int) -> pd.DataFrame:
    frame = pd.DataFrame(rows) if rows else pd.DataFrame({"time_us": pd.Series(dtype="int64")})
    frame.insert(1, "time_s", (frame["time_us"] - first_us) / 1e6)
    return frame
