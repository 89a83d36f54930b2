"""Layouts, compared with measures that their files state."""

import os
import subprocess
import sys

import matplotlib
import pytest

import ademan
from ademan import plots
from ademan.program import call

matplotlib.use("Agg")


def test_keys_have_the_pitch_of_the_file(program):
    layout = ademan.read_layout("qwerty-flat")
    f, g = layout["F"], layout["G"]
    assert g.center_m[0] - f.center_m[0] == pytest.approx(0.019, abs=1e-6)
    assert g.center_m[1] == f.center_m[1]
    assert f.key == "F"
    assert 0 < f.press_depth_m <= f.travel_m
    assert layout.frame().loc["F", "width_m"] == f.size_m[0]
    with pytest.raises(KeyError):
        layout["no such key"]


def test_a_disc_has_its_diameter_twice(program, tmp_path):
    file = tmp_path / "disc.ron"
    file.write_text(
        'Layout(name: "Disc", boards: [(pose: (anchor: elbow, forward_mm: 300, height_mm: -45),'
        ' keys: [(code: "A", at_mm: (0, 0), size_mm: Disc(24))])])'
    )
    layout = ademan.read_layout(file)
    assert [target.name for target in layout.targets] == ["A"]
    assert layout["A"].is_disc
    assert layout["A"].size_m == pytest.approx((0.024, 0.024))


def test_a_layout_with_a_fault_shows_the_message_of_the_program(program, tmp_path):
    file = tmp_path / "broken.ron"
    file.write_text("(name: ")
    with pytest.raises(ademan.ProgramError, match=r"broken\.ron:1:7: expected a text in quotes"):
        ademan.read_layout(file)


def test_a_program_that_is_missing_is_named(monkeypatch, tmp_path):
    monkeypatch.setenv("ADEMAN", str(tmp_path / "none"))
    with pytest.raises(ademan.ProgramError, match="does not exist"):
        ademan.read_layout("qwerty-flat")


def test_a_program_that_does_not_end_is_ended_and_named(monkeypatch, tmp_path):
    if os.name != "posix":
        pytest.skip("SKIPPED a script is no program here")
    file = tmp_path / "ademan"
    file.write_text("#!/bin/sh\nexec sleep 600\n")
    file.chmod(0o755)
    monkeypatch.setenv("ADEMAN", str(file))
    with pytest.raises(ademan.ProgramError, match="did not end within 0.1 s"):
        call(["layout", "show", "qwerty-flat"], limit_s=0.1)


def test_the_output_of_the_program_is_utf_8_in_every_locale(tmp_path):
    if os.name != "posix":
        pytest.skip("SKIPPED the locale of the process is not set by a variable")
    file = tmp_path / "ademan"
    file.write_text("#!/bin/sh\nprintf '\\303\\241'\n")
    file.chmod(0o755)
    code = "from ademan.program import call; print(ascii(call([])))"
    ascii_only = {"ADEMAN": str(file), "LC_ALL": "C", "PYTHONCOERCECLOCALE": "0"}
    called = [sys.executable, "-X", "utf8=0", "-c", code]
    ended = subprocess.run(called, env=os.environ | ascii_only, capture_output=True, check=False, timeout=60)
    assert ended.stdout == b"'\\xe1'\n", ended.stderr


def test_a_board_is_drawn_with_each_target(program, recorded):
    layout = ademan.read_layout("qwerty-flat")
    axes = plots.presses(ademan.read(recorded("openxr")), layout)
    assert len(axes.patches) == len(layout.targets)
    assert len(axes.collections[0].get_offsets()) == 2
    heat = plots.board(layout, {"F": 1.0, "G": 0.5})
    colors = {patch.get_facecolor() for patch in heat.patches}
    assert len(colors) == 3
