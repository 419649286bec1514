"""The JSON Schema of study files (draft 2020-12), made from the models."""

from __future__ import annotations

from sandbox.scene.schema import DRAFT, Schema, described
from sandbox.sweeps.spec import SweepSpec


def study_schema() -> Schema:
    """The JSON Schema of a study file; short forms are allowed besides what the models hold."""
    schema = described(SweepSpec)
    own = schema["properties"]
    over = schema["$defs"]["Varying"]["properties"]["over"]
    over["additionalProperties"] = {"anyOf": [
        {key: value for key, value in over["additionalProperties"].items() if key != "default"},
        {"type": "string", "description": "\"2 N:8 N:7\", \"normal(3 N, 0.2 N)\" or \"1, 2, 5\", "
                                          "as on the command line."}]}
    own["vary"] = {"description": own["vary"]["description"], "anyOf": [
        {key: value for key, value in over.items() if key != "description"},
        {key: value for key, value in own["vary"].items() if key != "description"}]}
    own["keep"]["additionalProperties"] = {"anyOf": [
        {"$ref": "#/$defs/Looked"},
        {"type": "string", "description": "\"mean disc.x over last 0.2 s\", or an expression such "
                                          "as \"=tip / pull\"."}]}
    own["keep"].pop("patternProperties", None)
    return {"$schema": DRAFT, **schema, "title": "A study of sandbox"}
