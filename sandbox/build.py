"""Schema models of scenes, to write a scene in Python.

``Body(name="link", mass="10 g", shapes=[Circle(radius="5 mm")])`` holds the values in SI and raises
:class:`sandbox.SceneError` if one is wrong. A number may be a text with a unit.
"""

from sandbox.elements.controllers import (
    EquilibriumController,
    FeedbackController,
    FingerGeometry,
    PidController,
    RelayController,
    ScheduleController,
    StateFeedbackController,
    SwitchController,
)
from sandbox.elements.drives import (
    BrakeDrive,
    ExtendDrive,
    FlowDrive,
    ForceDrive,
    HoldDrive,
    LengthDrive,
    MotorDrive,
    OpeningDrive,
    PressureDrive,
    PullDrive,
    PushDrive,
    RadiusDrive,
    ServoDrive,
    StiffnessDrive,
    SurfaceDrive,
    TorqueDrive,
)
from sandbox.elements.fluids import Cylinder, Line, Valve, Vane
from sandbox.elements.joints import Actuator, Gear, Pin, Rack, Rod, Roll, Rope, Slot, Weld
from sandbox.elements.loads import BuoyancyLoad, DragLoad, LawLoad
from sandbox.elements.springs import LinearSpring, RotarySpring
from sandbox.elements.tendons import Guide, Tendon
from sandbox.scene.bodies import Body, Box, Capsule, Circle, Material, Polygon, Polyline
from sandbox.scene.derived_shapes import DiscCam, Drawing, SmoothCurve
from sandbox.scene.document import Assembly, Scene
from sandbox.scene.events import Event
from sandbox.scene.parts.finger import Finger, FingerSprings, FingerTendon
from sandbox.scene.parts.section import Section
from sandbox.scene.parts.trees import Leaf, PulleyTree, RockerTree
from sandbox.scene.settings import (
    ContactRule,
    Expect,
    Group,
    Meter,
    Run,
    ShownMeter,
    Trace,
    View,
)
from sandbox.values.signals import Constant, Formula, Path, Ramp, Table
from sandbox.values.tables import NamedTable

__all__ = [
    "Actuator",
    "Assembly",
    "Body",
    "Box",
    "BrakeDrive",
    "BuoyancyLoad",
    "Capsule",
    "Circle",
    "Constant",
    "ContactRule",
    "Cylinder",
    "DiscCam",
    "DragLoad",
    "Drawing",
    "EquilibriumController",
    "Event",
    "Expect",
    "ExtendDrive",
    "FeedbackController",
    "Finger",
    "FingerGeometry",
    "FingerSprings",
    "FingerTendon",
    "FlowDrive",
    "ForceDrive",
    "Formula",
    "Gear",
    "Group",
    "Guide",
    "HoldDrive",
    "LawLoad",
    "Leaf",
    "LengthDrive",
    "Line",
    "LinearSpring",
    "Material",
    "Meter",
    "MotorDrive",
    "NamedTable",
    "OpeningDrive",
    "Path",
    "PidController",
    "Pin",
    "Polygon",
    "Polyline",
    "PressureDrive",
    "PullDrive",
    "PulleyTree",
    "PushDrive",
    "Rack",
    "RadiusDrive",
    "Ramp",
    "RelayController",
    "RockerTree",
    "Rod",
    "Roll",
    "Rope",
    "RotarySpring",
    "Run",
    "Scene",
    "ScheduleController",
    "Section",
    "ServoDrive",
    "ShownMeter",
    "Slot",
    "SmoothCurve",
    "StateFeedbackController",
    "StiffnessDrive",
    "SurfaceDrive",
    "SwitchController",
    "Table",
    "Tendon",
    "TorqueDrive",
    "Trace",
    "Valve",
    "Vane",
    "View",
    "Weld",
]
