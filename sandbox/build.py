"""Schema models of scenes, to write a scene in Python.

``Body(name="link", mass="10 g", shapes=[Circle(radius="5 mm")])`` holds the values in SI and raises
:class:`sandbox.SceneError` if one is wrong. A number may be a text with a unit.
"""

from sandbox.scene.document import Assembly, Scene
from sandbox.scene.elements.bodies import Body, Box, Capsule, Circle, Material, Polygon, Polyline
from sandbox.scene.elements.controllers import (
    EquilibriumController,
    FeedbackController,
    FingerGeometry,
    PidController,
    RelayController,
    ScheduleController,
    StateFeedbackController,
    SwitchController,
)
from sandbox.scene.elements.drives import (
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
from sandbox.scene.elements.events import Event
from sandbox.scene.elements.fluids import Cylinder, Line, Valve, Vane
from sandbox.scene.elements.joints import Actuator, Gear, Pin, Rack, Rod, Roll, Rope, Slot, Weld
from sandbox.scene.elements.loads import BuoyancyLoad, DragLoad, LawLoad
from sandbox.scene.elements.outlines import DiscCam, Drawing, SmoothCurve
from sandbox.scene.elements.settings import (
    ContactRule,
    Expect,
    Group,
    Meter,
    Run,
    ShownMeter,
    Trace,
    View,
)
from sandbox.scene.elements.springs import LinearSpring, RotarySpring
from sandbox.scene.elements.tendons import Guide, Tendon
from sandbox.scene.parts.finger import Finger, FingerSprings, FingerTendon
from sandbox.scene.parts.section import Section
from sandbox.scene.parts.trees import Leaf, PulleyTree, RockerTree
from sandbox.scene.values.signals import Constant, Formula, Path, Ramp, Table
from sandbox.scene.values.tables import NamedTable

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
