"""Schema models of scenes, to write a scene in Python.

``Body(name="link", mass="10 g", shapes=[Circle(radius="5 mm")])`` holds the values in SI and raises
:class:`sandbox.SceneError` if one is wrong. A number may be a text with a unit.
"""

from sandbox.elements.controllers.controller import (
    FeedbackController,
    ScheduleController,
    SwitchController,
)
from sandbox.elements.controllers.equilibrium import EquilibriumController, FingerGeometry
from sandbox.elements.controllers.pid import PidController, RelayController
from sandbox.elements.controllers.state_feedback import StateFeedbackController
from sandbox.elements.drives import (
    ForceDrive,
    HoldDrive,
    PullDrive,
    RadiusDrive,
    StiffnessDrive,
    SurfaceDrive,
)
from sandbox.elements.fluids import (
    Cylinder,
    FlowDrive,
    Line,
    OpeningDrive,
    PressureDrive,
    Valve,
    Vane,
)
from sandbox.elements.joints import Actuator, Gear, Pin, Rack, Rod, Roll, Rope, Slot, Weld
from sandbox.elements.loads import BuoyancyLoad, DragLoad, LawLoad
from sandbox.elements.motors import (
    BrakeDrive,
    ExtendDrive,
    LengthDrive,
    MotorDrive,
    PushDrive,
    ServoDrive,
    TorqueDrive,
)
from sandbox.elements.springs import LinearSpring, RotarySpring
from sandbox.elements.tendons import Guide, Tendon
from sandbox.scene.bodies import Body, Box, Capsule, Circle, Material, Polygon, Polyline, Skin
from sandbox.scene.document import Assembly, Scene
from sandbox.scene.outlines.cams import DiscCam
from sandbox.scene.outlines.curves import SmoothCurve
from sandbox.scene.outlines.drawings import Drawing
from sandbox.scene.parts.expansion import Leaf
from sandbox.scene.parts.finger import Finger, FingerSprings, FingerTendon
from sandbox.scene.parts.section import Section
from sandbox.scene.parts.trees import PulleyTree, RockerTree
from sandbox.scene.settings import (
    ContactRule,
    Event,
    Expect,
    Group,
    Meter,
    PymunkRun,
    Run,
    ShownMeter,
    Trace,
    View,
)
from sandbox.values.signals import Constant, Formula, Path, Ramp, Table
from sandbox.values.tables import NamedTable

__all__ = [
    "Actuator", "Assembly", "Body", "Box", "BrakeDrive", "BuoyancyLoad", "Capsule", "Circle",
    "Constant", "ContactRule", "Cylinder", "DiscCam", "DragLoad", "Drawing",
    "EquilibriumController", "Event", "Expect", "ExtendDrive", "FeedbackController", "Finger",
    "FingerGeometry", "FingerSprings", "FingerTendon", "FlowDrive", "ForceDrive", "Formula", "Gear",
    "Group", "Guide", "HoldDrive", "LawLoad", "Leaf", "LengthDrive", "Line", "LinearSpring",
    "Material", "Meter", "MotorDrive", "NamedTable", "OpeningDrive", "Path", "PidController", "Pin",
    "Polygon", "Polyline", "PressureDrive", "PullDrive", "PulleyTree", "PushDrive", "PymunkRun",
    "Rack", "RadiusDrive", "Ramp", "RelayController", "RockerTree", "Rod", "Roll", "Rope",
    "RotarySpring", "Run", "Scene", "ScheduleController", "Section", "ServoDrive", "ShownMeter",
    "Skin", "Slot", "SmoothCurve", "StateFeedbackController", "StiffnessDrive", "SurfaceDrive",
    "SwitchController", "Table", "Tendon", "TorqueDrive", "Trace", "Valve", "Vane", "View", "Weld",
]
