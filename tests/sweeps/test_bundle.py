"""What goes along with a scene to those who run it."""

import json

from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import read_scene
from sandbox.sweeps.bundle import bundled


def test_scenes_that_a_varied_include_names_go_along(tmp_path):
    def scene(name, **more):
        (tmp_path / f"{name}.json").write_text(json.dumps({"name": name, **more}))

    body = [{"name": "body", "motion": "fixed", "shapes": [{"type": "circle", "radius": "5 mm"}]}]
    scene("hand", parts=[{"include": "disc", "name": "object"}])
    scene("disc", bodies=body)
    scene("square", parts=[{"include": "corner", "name": "one"}])
    scene("corner", bodies=body)
    scene("other", bodies=body)
    bundle, _ = bundled(tmp_path / "hand.json", {}, Limits(), also=[["disc", "square"]])
    assert set(bundle.files) == {"hand.json", "disc.json", "square.json", "corner.json"}
    with bundle.unpacked() as main:
        found = read_scene(main, overrides={"parts[object].include": "square"})
    assert [each.name for each in found.mechanism.bodies] == ["object.one.body"]
    alone, _ = bundled(tmp_path / "hand.json", {}, Limits())
    assert set(alone.files) == {"hand.json", "disc.json"}
