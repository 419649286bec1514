"""``sandbox check``: problems with their places, --expand, --schema, the cost estimate."""

from __future__ import annotations

import json

from sandbox.values.messages import ELEMENTS

from .conftest import BALL

ROPE = {"type": "rope", "name": "rope", "a": "floor", "b": "ball", "longest": 0.001}
CABLE = {"name": "cord", "guides": [{"body": "floor"}, {"body": "floor"}, {"body": "ball"}]}


def test_good_scenes_and_what_a_run_costs(sandbox, scene):
    path = scene()
    output = sandbox("check", path, path)
    assert (output.code, output.err) == (0, "")
    assert output.out.count(": ok") == 2
    assert f"{path}: would take about 0.01 s and " in output.out
    assert output.out.endswith("(100 steps, 50 samples)\n")
    (report,) = json.loads(sandbox("check", path, "--json").out)["scenes"]
    assert (report["estimate"]["steps"], report["estimate"]["contacts"]) == (100, 1)
    long = ["--set", "run.duration=800 s", "--set", "run.sample_rate=10", "--limit", "seconds=1"]
    looked, ran = sandbox("check", path, *long), sandbox("run", path, *long)
    assert looked.code == ran.code == 2
    assert "(the limit 'seconds', raised by --limit seconds=N)" in looked.err
    assert looked.err == ran.err
    assert sandbox("check", path, *long[:-1], "seconds=1e6").code == 0


def test_a_warning_has_its_place_and_fails_with_strict(sandbox, scene):
    path = scene(joints=[ROPE], expect=[])
    looked, ran = sandbox("check", path), sandbox("run", path, "--no-render")
    assert (looked.code, ran.code) == (0, 0)
    message = f"{path}:1:352: warning: $.joints[0]: rope: not assembled at t = 0"
    assert looked.err.startswith(message)
    assert ran.err.startswith(message)
    assert looked.pages == "see 'sandbox explain not-assembled'\n"
    assert sandbox("check", path, "--strict").code == 2
    output = sandbox("check", path, "nothere.json", "--json")
    good, bad = json.loads(output.out)["scenes"]
    (found,) = good["findings"]
    assert (output.code, good["ok"], found["severity"], found["path"], found["line"]) == (
        2, True, "warning", "$.joints[0]", 1)
    assert (bad["ok"], len(bad["errors"])) == (False, 1)


def test_an_error_has_its_place_in_text_and_json(sandbox, scene):
    text = json.dumps(BALL | {"tendons": [CABLE]}, indent=1)
    path = scene(text)
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "tendons" in row) + 1
    message = ("its guides 0 and 1 coincide; move one of them: the tendon between them has no "
            "direction")
    assert sandbox("check", path).err == f"{path}:{line}:3: $.tendons[0]: cord: {message}\n"
    (problem,) = json.loads(sandbox("check", path, "--json").out)["scenes"][0]["errors"]
    assert problem == {"message": message, "file": str(path), "path": "$.tendons[0]", "line": line,
                       "column": 3, "element": "cord",
                       "code": "coincident-points",
                       "fields": f"{ELEMENTS}#tendon"}
    assert sandbox("check", scene(tendons=[CABLE], gravty=[0, 1])).pages == (
        "see 'sandbox explain unknown-key scene'\n")


def test_warnings_of_copies_and_of_included_scenes_have_places(sandbox, scene, tmp_path):
    """Copies share the place of the first one; included files have their own name and line."""
    disc = {"name": "disc", "mass": 0.01, "at": [0, 0.3], "inertia": 1e-6}
    inner = {"bodies": [disc], "joints": [
        {**ROPE, "name": "short", "a": "floor", "b": "disc", "on_a": [0, 0]}]}
    (tmp_path / "inner.json").write_text(json.dumps(inner, indent=1))
    outer = json.dumps(BALL | {
        "joints": [{**ROPE, "name": "rope{i}", "repeat": 3}],
        "parts": [{"name": "in", "include": "inner"}]}, indent=1)
    path = scene(outer)
    output = sandbox("check", path).err
    copies = next(line for line in output.splitlines() if "rope0" in line)
    line = next(i for i, row in enumerate(outer.splitlines(), 1) if '"joints"' in row) + 1
    assert copies.startswith(f"{path}:{line}:3: warning: $.joints[0]: rope0: ")
    assert "(for i = 0)" in copies
    assert copies.endswith("(and so for 2 more)")
    included = next(line for line in output.splitlines() if "in.short" in line)
    assert "inner.json:" in included.split(" ")[0]


def test_expand_prints_a_scene_that_expands_to_itself(sandbox, tmp_path):
    output = sandbox("check", "single_finger", "--expand")
    assert output.code == 0, output.err
    path = tmp_path / "plain.json"
    path.write_text(output.out)
    assert "finger.proximal" in output.out
    assert "parts" not in json.loads(output.out)
    assert sandbox("check", "--expand", path).out == output.out
    assert sandbox("check", "--expand", path, path).code == 2
    assert "bodies" in json.loads(sandbox("check", "--schema").out)["properties"]
    assert "vary" in json.loads(sandbox("check", "--schema", "study").out)["properties"]
