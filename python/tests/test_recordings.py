"""Recordings, compared with what the program prints about the same files."""

import json
import subprocess

import pytest

import ademan

SOURCES = {
    "hc11": "channels",
    "text-line": "angles_rad",
    "openxr": "joints_m",
    "body-landmarks": "body",
    "vmc": "bones",
    "opentrack": "displacement",
}


def trace(program, stage, path):
    command = [program, "trace", stage, "--source", f"recording:{path}"]
    printed = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    return [json.loads(line) for line in printed.stdout.splitlines()]


@pytest.mark.parametrize(("name", "sample"), SOURCES.items())
def test_every_kind_of_sample_is_read(recorded, program, name, sample):
    path = recorded(name)
    recording = ademan.read(path)
    assert set(recording.readings["sample"]) == {sample}
    assert len(recording.readings) == len(trace(program, "readings", path))
    assert recording.typed_text() == "hi"
    assert recording.is_complete
    assert "boards" in recording.layout


def test_counts_of_a_glove_are_as_the_program_prints_them(recorded, program):
    path = recorded("hc11")
    recording = ademan.read(path)
    printed = trace(program, "readings", path)
    for row, line in zip(recording.readings.to_dict("records"), printed, strict=True):
        assert row["time_us"] == line["time_us"]
        counts = line["channels"]
        assert len(counts) == 64
        assert [row[f"channel_{index}"] for index in range(64)] == counts


def test_angles_are_as_the_program_prints_them(recorded, program):
    path = recorded("hc11")
    angles = ademan.read(path).angles
    printed = trace(program, "angles", path)
    assert len(angles) == len(printed) > 0
    for row, line in zip(angles.to_dict("records"), printed, strict=True):
        assert len(line["angles"]) > 20
        for joint, angle in line["angles"].items():
            assert row[joint.replace("-", "_")] == pytest.approx(angle, abs=1e-6), joint


def test_presses_and_events_are_as_the_program_prints_them(recorded, program):
    path = recorded("openxr")
    recording = ademan.read(path)
    presses = trace(program, "presses", path)
    assert [press["target"] for press in presses] == list(recording.presses["target"]) == ["H", "I"]
    for row, line in zip(recording.presses.to_dict("records"), presses, strict=True):
        assert row["depth_m"] * 1000 == pytest.approx(line["depth_mm"], abs=1e-3)
        assert [row["x_m"] * 1000, row["y_m"] * 1000] == pytest.approx(line["point_mm"][:2], abs=1e-3)
        assert [near["target"] for near in row["neighbors"]] == [near["target"] for near in line["neighbors"]]
    events = trace(program, "events", path)
    assert [event["event"] for event in events] == list(recording.events["kind"])
    assert recording.events["time_s"].is_monotonic_increasing


def test_poses_come_from_the_program(recorded):
    recording = ademan.read(recorded("hc11"))
    poses = recording.poses()
    assert len(poses) > 0
    assert poses["index-finger-tip_y"].between(-1, 1).all()
    ends = ("index-finger-phalanx-intermediate", "index-finger-phalanx-distal")
    near, far = (poses[[f"{joint}_{axis}" for axis in "xyz"]].to_numpy() for joint in ends)
    lengths = ((far - near) ** 2).sum(axis=1) ** 0.5
    assert lengths.max() - lengths.min() < 1e-6, "a bone does not stretch"
    assert 0.01 < lengths.mean() < 0.06


def test_a_cut_recording_keeps_what_was_written(recorded, tmp_path):
    whole = recorded("hc11")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: int(whole.stat().st_size * 0.99)])
    recording = ademan.read(cut)
    assert not recording.is_complete
    assert 0 < len(recording.readings) <= len(ademan.read(whole).readings)


def test_other_files_are_refused_with_the_reason(recorded, tmp_path):
    text = tmp_path / "text.mcap"
    text.write_text("no recording")
    with pytest.raises(ValueError, match="is not a recording"):
        ademan.read(text)
    with pytest.raises(OSError):
        ademan.read(tmp_path / "missing.mcap")


def test_recordings_of_other_programs_are_refused_with_the_reason(tmp_path):
    from google.protobuf.timestamp_pb2 import Timestamp
    from mcap_protobuf.writer import Writer

    for topic in ("/readings", "/camera"):
        path = tmp_path / "other.mcap"
        with path.open("wb") as stream, Writer(stream) as writer:
            writer.write_message(topic=topic, message=Timestamp(seconds=1), log_time=1, publish_time=1)
        with pytest.raises(ValueError, match="not a recording of Ademán"):
            ademan.read(path)


def test_a_recording_of_format_1_names_the_command_that_converts_it():
    from conftest import ROOT

    with pytest.raises(ValueError, match="ademan record new.mcap"):
        ademan.read(ROOT / "tests" / "recordings" / "hc11.mcap")
