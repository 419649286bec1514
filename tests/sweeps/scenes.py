"""A scene of which everything is known: a puck that is pushed for a while."""

PUCK = {
    "name": "puck", "gravity": [0, 0], "parameters": {"push": "2 N", "m": "1 kg"},
    "run": {"duration": "0.1 s", "step": "1 ms"},
    "bodies": [{"name": "puck", "mass": "=m", "shapes": [
        {"type": "circle", "radius": "10 mm"}]}],
    "drives": [{"name": "push", "type": "force", "body": "puck", "direction": [1, 0],
                "value": "=push"}],
    "expect": [{"final": "puck.vx", "above": 0.25}],
}
