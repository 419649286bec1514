"""Scenes without dictionaries: builders whose words an editor completes.

Written by docs/make_reference.py from the models of scenes.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from sandbox.build.builders import EntryBuilder, Family

Number = float | str
"""In SI, or a text with a unit, or an expression: ``0.01``, ``"10 mm"``, ``"=length / 2"``."""
Entry = dict[str, Any]
"""What a builder returns, or a dictionary as a scene's file has it."""

BUILDERS: dict[str, EntryBuilder | Family]


def scene(
    name: str | None = None,
    *,
    format: int | None = None,
    title: str | None = None,
    about: str | None = None,
    run: Entry | None = None,
    gravity: Sequence[Number] | None = None,
    tables: Mapping[str, Any] | None = None,
    materials: Mapping[str, Any] | None = None,
    bodies: Sequence[Entry] | None = None,
    joints: Sequence[Entry] | None = None,
    springs: Sequence[Entry] | None = None,
    tendons: Sequence[Entry] | None = None,
    lines: Sequence[Entry] | None = None,
    valves: Sequence[Entry] | None = None,
    loads: Sequence[Entry] | None = None,
    drives: Sequence[Entry] | None = None,
    controllers: Sequence[Entry] | None = None,
    events: Sequence[Entry] | None = None,
    contacts: Sequence[Entry] | None = None,
    groups: Sequence[Entry] | None = None,
    meters: Sequence[Entry] | None = None,
    expect: Sequence[Entry] | None = None,
    view: Entry | None = None,
    schema: str | None = None,
    parameters: Mapping[str, Number] | None = None,
    templates: Mapping[str, Mapping[str, Any]] | None = None,
    parts: Sequence[Entry] | None = None,
) -> Entry:
    """The whole file: a mechanism, and the parameters, templates and parts it is written with.

    An element names its template with ``"like"``; templates are merged into the elements, and
    ``like`` removed, before a scene is validated.

    Args:
        format: Version of the format of scenes, always 1.
        name: What the run's folder and files are called; by default the file's name without its
            ending.
        title: One line for the picture and for ``sandbox list``; by default the name is shown.
        about: What the scene shows and why, in as many sentences as it takes; nothing reads it but
            people.
        run: How long the run lasts, with which time step, and how often it is sampled.
        gravity: Acceleration [x, y] of everything that falls, in the world [m/s^2]; none by
            default: the plane lies flat. ``[0, -9.81]`` is gravity in an upright plane.
        tables: Functions of one number by name, given by points, which expressions call:
            ``"=profile(hinge.angle)"``.
        materials: Contact surfaces by name, for the ``material`` of bodies.
        bodies: The rigid bodies, those that stay where they are included.
        joints: What ties two bodies together rigidly: pins, slots, welds, rods, ropes; gears, racks
            and circles that roll.
        springs: Springs with dampers, between two points or about a hinge.
        tendons: Elastic cords that run through guides and only pull.
        lines: Fluid under pressure, in chambers that move bodies.
        valves: What lets fluid from line to line.
        loads: Forces on bodies by laws of their own motion: drag, buoyancy, fields.
        drives: What is set from outside over time: forces, torques, pulls, speeds, stiffnesses,
            radii, flows and pressures of fluid, openings of valves, surfaces that run.
        controllers: What reads quantities while the run goes on, and sets drives by a law.
        events: What happens once, at a time or on a condition.
        contacts: Which bodies may touch, and with what friction; of two rules for a pair the later
            one counts.
        groups: Bodies that are counted together, by a name of their own.
        meters: Quantities made of others by expressions.
        expect: What has to hold of the recorded quantities; a run whose expectations do not hold
            fails.
        view: What the picture shows, how large and how fast.
        schema: Where an editor finds the JSON Schema of scenes.
        parameters: Named numbers, for expressions such as ``"=pull / 4"``: SI once read, whatever
            unit they were written in.
        templates: What elements have in common, by name: ``{"digit": {"type": "finger", ...}}``. An
            entry with ``"like": "digit"`` takes all keys of that template and puts its own over
            them, object by object; lists are replaced whole. A template may itself be ``like``
            another one.
        parts: Assemblies of several elements each, such as fingers and trees; ``sandbox check
            --expand`` shows what they stand for.
    """

def run(
    *,
    duration: Number | None = None,
    step: Number | None = None,
    sample_rate: Number | None = None,
) -> Entry:
    """How long a run lasts, and how finely it is stepped and recorded.

    Older scenes may hold ``iterations`` and ``slop``, too: how often a solver that is gone went
    over a step, and how far it let contacts overlap. They do nothing any more.

    Args:
        duration: How long the run lasts [s].
        step: Time step h [s]: shorter is more accurate and takes longer in proportion.
        sample_rate: Samples recorded per second [Hz]; the nearest whole number of steps is used.
    """

def view(
    *,
    centre: Sequence[Number] | None = None,
    width: Number | None = None,
    size: Sequence[int] | None = None,
    fps: Literal[20, 25, 50] | None = None,
    speed: Number | None = None,
    force_scale: Number | None = None,
    start: Number | None = None,
    traces: Sequence[Entry] | None = None,
    meters: Sequence[str | Entry] | None = None,
    show: Sequence[Literal['bodies', 'springs', 'tendons', 'joints', 'contacts', 'tensions',
        'drives', 'loads', 'names', 'traces', 'velocity', 'acceleration', 'reactions', 'bars',
        'pressure', 'axes', 'coordinates', 'body_names', 'all', '-bodies', '-springs', '-tendons',
        '-joints', '-contacts', '-tensions', '-drives', '-loads', '-names', '-traces', '-velocity',
        '-acceleration', '-reactions', '-bars', '-pressure', '-axes', '-coordinates', '-body_names',
        '-all']] | Mapping[str, Any] | None = None,
    bodies: Sequence[str | Entry] | None = None,
    follow: str | None = None,
) -> Entry:
    """The picture: what part of the world, how large, how fast. Fitted to the motion by default.

    Args:
        centre: Point of the world in the middle of the picture [m]; by default the middle of all
            that moves in sight.
        width: Width of the world that is shown [m]; by default as much as the motion needs. The
            height follows from ``size``.
        size: Width and height of the picture [pixels].
        fps: Frames per second of film.
        speed: Seconds of motion per second of film: 0.1 is ten times slower, 2 twice as fast.
        force_scale: Length in the world at which a contact force of 1 N is drawn [m]; 0, the
            default, fits it to the largest lasting force of the run. It changes pictures only, no
            number.
        start: Time of the run at which the film begins [s].
        traces: Points whose ways are drawn, such as that of a coupler's point or of a projectile.
        meters: Meters beside or below the motion, wherever that leaves it larger: quantities,
            patterns, expressions, or objects that say more.
        show: Layers shown besides the usual ones; one with a minus, such as ``"-contacts"``, is
            left out, and ``"all"`` means every one. Or an object that says of each layer ``true``,
            ``false`` or the bodies (names, patterns, roles) that it is shown of. The layers stand
            in the table of docs/scenes.md and in ``sandbox render --help``.
        bodies: Names and patterns of the bodies or groups that the picture is fitted to, or roles,
            as in ``"role:object"``; what else lies around is drawn as far as it is in sight. By
            default all, but such as fall or fly off for good only while they are near what stays.
            ``["*"]`` means all, always.
        follow: Body that the picture goes with: its centre of mass stays where it is on the picture
            at t = 0. The picture does not turn, and what is fixed passes by. It holds all of the
            machine that the body is a part of, what is near a body that goes far in its machine,
            and a body alone that is free of all that stays.
    """

def trace(
    *,
    body: str,
    at: Sequence[Number] | None = None,
) -> Entry:
    """The way of a point, drawn as far as it has gone.

    Args:
        body: Name of the body that the point belongs to.
        at: The point in the body's frame [m], on the body or beside it.
    """

def shown_meter(
    *,
    of: str | Sequence[str],
    title: str | None = None,
    unit: str | None = None,
    range: Sequence[Number] | None = None,
    style: Literal['plot', 'number'] | None = None,
) -> Entry:
    """A meter in the picture: the curve of a quantity with a cursor of time, or its value alone.

    A text stands for the meter ``of`` it alone.

    Args:
        of: Names or patterns of quantities, or expressions of them (SI) such as
            ``"=finger1.tendon.tension - 2"``, one or a list: curves of one meter, in one unit.
        title: What stands above it; by default the quantity's name.
        unit: Unit of expressions, which stands beside their values; a quantity has its own.
        range: [lowest, highest] value of the plot, SI; by default what the run needs.
        style: ``"plot"`` has the curve below the value, ``"number"`` is the value alone.
    """

def table(
    *,
    points: Sequence[Sequence[Number] | Entry],
    between: Literal['linear', 'cubic'] | None = None,
    beyond: Literal['hold', 'extend', 'repeat'] | None = None,
) -> Entry:
    """A function of one number, given by points; expressions call it by its name.

    Args:
        points: Points ``[x, y]``, 2 to 1000, x rising: numbers in SI, or with units, one kind of
            unit for all x and one for all y.
        between: How it goes from point to point: ``linear`` straight, ``cubic`` by the cubic
            spline, which has no kinks.
        beyond: What it is before the first and after the last point: ``hold`` the value there,
            ``extend`` straight on with the slope there, ``repeat`` from the start again; then it
            ends as it begins.
    """

def material(
    *,
    friction: Number | None = None,
    static: Number | None = None,
    restitution: Number | None = None,
    colour: Literal['white', 'grey', 'black', 'blue', 'teal', 'green', 'yellow', 'orange', 'red',
        'pink', 'purple', 'brown'] | str | None = None,
) -> Entry:
    """A contact surface: how it rubs and how it bounces.

    Friction, static and restitution of a pair are the geometric means of the two.

    Args:
        friction: Coulomb coefficient, 0 or more, of two surfaces of this material.
        static: How many times as much as it rubs with while it slides it holds with while it does
            not, 1 or more, as of a joint; by default just as much.
        restitution: Rebound speed over approach speed of two surfaces of this material: 0 does not
            bounce, 1 loses nothing.
        colour: Fill in pictures of the bodies of this material, as a body's ``colour``.
    """

def body(
    name: str,
    *,
    at: Sequence[Number] | None = None,
    angle: Number | None = None,
    motion: Literal['dynamic', 'fixed', 'scheduled'] | None = None,
    path: Entry | None = None,
    shapes: Sequence[Entry] | None = None,
    displaces: Sequence[Entry] | None = None,
    mass: Number | None = None,
    density: Number | None = None,
    thickness: Number | None = None,
    centre: Sequence[Number] | None = None,
    inertia: Number | None = None,
    velocity: Sequence[Number] | None = None,
    angular_velocity: Number | None = None,
    material: str | None = None,
    plane: int | str | Sequence[int | str] | Literal['all'] | None = None,
    role: Literal['link', 'ground', 'palm', 'phalanx', 'rocker', 'pulley', 'object'] | None = None,
    colour: Literal['white', 'grey', 'black', 'blue', 'teal', 'green', 'yellow', 'orange', 'red',
        'pink', 'purple', 'brown'] | str | None = None,
    fill: bool | None = None,
) -> Entry:
    """A rigid body: where it starts, how it moves, what it weighs, what it looks like.

    Mass comes from ``mass``, or from ``density`` times the shapes' area times ``thickness``. Centre
    and inertia follow from the shapes (an even spread of the mass over their area) unless given.

    Args:
        name: Its name; quantities are ``<name>.x``, ``<name>.angle`` and so on.
        at: Origin of the body's frame in the world at t = 0 [m].
        angle: Turn of the body's frame against the world at t = 0 [rad], counter-clockwise.
        motion: ``dynamic`` is moved by forces, ``fixed`` stays where it is, ``scheduled`` follows
            its ``path`` whatever the forces on it.
        path: Pose over time; for ``"motion": "scheduled"`` only, which needs it.
        shapes: What it consists of, in its frame: its outline for contacts and pictures and, unless
            given, its mass's spread. One without shapes touches nothing.
        displaces: What of it keeps a liquid away (a load ``buoyancy``), in its frame; by default
            its ``shapes``. A bin of three walls floats by the outline round it, one polygon. It
            touches and weighs nothing.
        mass: Of the whole body [kg]; a dynamic body has either this or ``density``.
        density: Mass per volume [kg/m^3]; with the shapes' areas and ``thickness`` it gives the
            mass.
        thickness: Depth across the plane [m], which counts with ``density`` and in a liquid only.
        centre: Centre of mass in the body's frame [m]; by default that of the shapes' area.
        inertia: Moment of inertia about the centre of mass [kg m^2]; by default the mass spread
            evenly over the shapes' area.
        velocity: Velocity [x, y] of the centre of mass at t = 0, in the world [m/s].
        angular_velocity: Angular velocity at t = 0 [rad/s], counter-clockwise.
        material: Name of one of the scene's ``materials``; without one, friction is 0.5 and
            restitution 0.
        plane: Layer that it lies in, a whole number, higher ones nearer to the eye: bodies of
            different planes pass each other, whatever contact rules say, and are drawn in this
            order. In a list of planes it meets the bodies of each and is drawn in the lowest;
            ``"all"`` meets everything and is drawn behind.
        role: What it is to a reader: how it is drawn, and in a grasp what holds what. An ``object``
            has quantities of how it is held, ``ground`` is no part of a hand. It changes no motion.
        colour: Its fill in pictures: white, grey, black, blue, teal, green, yellow, orange, red,
            pink, purple, brown, or ``"#f5c542"``; by default that of its material, else that of its
            role.
        fill: False draws its outline alone, so that what lies behind it is seen; a circle that a
            drive changes stays filled.
    """

def path(
    *,
    x: Number | Entry | Mapping[str, Any] | None = None,
    y: Number | Entry | Mapping[str, Any] | None = None,
    angle: Number | Entry | Mapping[str, Any] | None = None,
) -> Entry:
    """A scheduled body's pose over time [m, rad]; what is left out keeps its initial value.

    Args:
        x: World x of the body's origin [m].
        y: World y of the body's origin [m].
        angle: Turn of the body's frame against the world [rad], counter-clockwise.
    """

def tendon(
    name: str,
    *,
    guides: Sequence[Entry],
    closed: bool | None = None,
    stiffness: Number | None = None,
    damping: Number | None = None,
    rest_length: Number | None = None,
    slack: Number | None = None,
    pretension: Number | None = None,
    breaks_at: Number | None = None,
    released: bool | None = None,
    taken_up: Literal['natural', 'as_is'] | None = None,
) -> Entry:
    """A cord through ``guides``, which pulls and never pushes.

    T = stiffness * stretch + damping * rate, never below 0.

    It is elastic, with the default stiffness as well: one that snaps taut gives the speed back.
    From 100 kN/m on only exp(-pi h w / 2) of it, so that what comes of the jolt depends on the step
    h until that is small against the period 2 pi / w, w^2 = stiffness / mass. Where a jolt is to be
    inelastic, a joint of type ``rope`` does it between two points; a cord through guides needs a
    ``damping`` of some times sqrt(stiffness * mass).

    Args:
        name: Its name; quantities are ``<name>.tension``, ``<name>.length`` and so on.
        guides: Where the cord runs, from end to end; a pull drive acts at the last one.
        closed: True: a loop, such as a belt. From the last guide it runs on to the first, and it is
            tied nowhere.
        stiffness: Tension per stretch of the whole cord [N/m]; from 100 kN/m on, the default, the
            cord stands for one without stretch and is solved at the end of the step.
        damping: Tension per rate of stretch [N s/m]; from 100 kN/m on the step damps the cord as
            well, as step * stiffness would.
        rest_length: Length of the cord where it just does not pull [m]; by default that of its path
            at t = 0. ``slack`` comes on top.
        slack: Added to the rest length [m], 0 or more: by so much the path has to grow from what it
            is at t = 0, unless ``rest_length`` says otherwise, before the cord pulls. A cord that
            shall pull from the start has a ``rest_length`` shorter than its path, or a
            ``pretension``, and no slack.
        pretension: Tension along the whole cord at t = 0 [N], in place of ``rest_length`` and
            ``slack``.
        breaks_at: The tension above which it is let go [N], anywhere along it, for good unless an
            event takes it up again; by default it never breaks.
        released: Whether it is let go from the start, until an event takes it up.
        taken_up: With which length at rest an event takes it up again: ``natural`` is the one that
            it has had, so that it may pull at once; ``as_is`` that of its path then, so that it
            begins without tension.
    """

def guide(
    *,
    body: str,
    at: Sequence[Number] | None = None,
    radius: Number | None = None,
    side: Literal['left', 'right'] | None = None,
    turns: int | None = None,
    begins: Literal['on', 'off'] | None = None,
    friction: Number | None = None,
) -> Entry:
    """A point, or a wheel, of a body that a tendon passes.

    At either end the tendon is tied there. A guide between the ends lets it slide through, without
    friction unless it has some; a wheel (``radius``) at an end has it wound on: it pays out as the
    body turns, which is how equations (1)-(3) come in. A wheel between the ends without friction
    and whole turns holds nothing back: the cord lifts off it where it would have to, goes straight
    past, and is taken up again.

    Args:
        body: Name of the body that it is on, and that it presses.
        at: The eye, or the wheel's centre, in the body's frame [m].
        radius: Radius of the wheel [m]; 0, the default, is a plain eye.
        side: On which side of the cord, walked from its first guide to its last, the wheel's centre
            lies: round a wheel on its ``left`` the cord bends counter-clockwise, round one on its
            ``right`` clockwise. An end on the ``left`` is wound up by turning counter-clockwise at
            the last guide, clockwise at the first. Of no effect on an eye.
        turns: Whole turns that the cord goes round the wheel at t = 0, besides the arc that its
            ends make: of a capstan. Of no effect on an eye, or where the cord is tied.
        begins: Whether the cord lies on the wheel at t = 0 or goes straight past it: ``on`` though
            the straight way is clear of it, so that the cord goes round it and crosses itself, or
            ``off``, to meet it later. By default it is off where the straight way past the wheel is
            clear of it, with its centre on the ``side`` that it should be; a loop is on. Of no
            effect where a cord cannot lift off: an eye, a wheel with ``friction`` or ``turns``, the
            first guide of a loop, or where it is tied.
        friction: Coefficient of friction between cord and guide: by the angle φ that the cord bends
            there its tension may grow up to e^(friction φ) times before it slides (Euler,
            Eytelwein). On a wheel that turns this is its grip. Of no effect where the cord is tied.
    """

def line(
    name: str,
    *,
    chambers: Sequence[Entry] | None = None,
    volume: Number | None = None,
    modulus: Number | None = None,
    gas: Number | None = None,
    pressure: Number | None = None,
    least: Number | None = None,
    relief: Number | None = None,
) -> Entry:
    """Chambers and hoses that are filled with one fluid under one pressure.

    content - volume = volume / modulus * pressure; what is in it changes by what drives and valves
    let in and out. Every chamber pushes with its area times the pressure.

    Args:
        name: Its name; quantities are ``<name>.pressure``, ``<name>.volume`` and so on.
        chambers: What the fluid moves; none where the line only stores some, as an accumulator
            does.
        volume: Of all the fluid at t = 0, in chambers and hoses [m^3]; by default that of its
            cylinders that push, area times distance.
        modulus: Pressure per share by which the fluid is pressed together, walls of hoses included
            [Pa]; by default 1.4 GPa, that of oil. Not of a gas.
        gas: The line is filled with gas: (pressure + 101325 Pa) * volume^gas stays the same while
            nothing comes in, with 1 where it is slow and stays as warm as its surroundings, 1.4
            where air has no time for that. By default it is a liquid.
        pressure: At t = 0, above the surroundings [Pa].
        least: The least pressure [Pa]: where it would be less the line is no longer full, with a
            void, as a cord hangs slack. By default -101325 Pa, a vacuum.
        relief: The most pressure [Pa]: where it would be more fluid is let out into the tank. By
            default there is no such valve.
    """

def valve(
    name: str,
    *,
    a: str | None = None,
    b: str | None = None,
    resistance: Number | None = None,
    area: Number | None = None,
    discharge: Number | None = None,
    density: Number | None = None,
    one_way: bool | None = None,
) -> Entry:
    """Lets fluid from one line into another, or out of and into the tank.

    p_a - p_b = resistance * Q + density / 2 * (Q / (discharge * area))^2, of Q / opening where a
    drive has it partly open.

    Args:
        name: Its name; quantities are ``<name>.flow`` and ``<name>.loss``.
        a: The line at its one end; left out it is the tank, whose pressure is 0.
        b: The line at its other end; left out it is the tank.
        resistance: Pressure per flow of a long narrow passage [Pa s/m^3].
        area: Of the opening of an orifice [m^2]; by default it is no orifice.
        discharge: How much of the orifice's area the jet takes.
        density: Of the fluid, which counts in an orifice [kg/m^3]; by default that of oil.
        one_way: A check valve: it lets fluid from ``a`` to ``b`` and not back.
    """

def event(
    name: str,
    *,
    at: Number | None = None,
    when: str | None = None,
    after: Number | None = None,
    rate: Number | None = None,
    set: Mapping[str, Number] | None = None,
    release: str | Sequence[str] | None = None,
    take_up: str | Sequence[str] | None = None,
    lasts: Number | None = None,
    stop: Literal['pass', 'fail'] | None = None,
    because: str | None = None,
) -> Entry:
    """Sets drives, switches controllers, lets go or takes up, or stops the run; at most once.

    One that does nothing of the kind marks an instant: it is noted, and marked in plots and pages.
    A push is a force drive of value 0 that an event sets for a while; a joint is locked and freed
    by setting its brake.

    Args:
        name: Its name, by which the verdict tells when it happened.
        at: When it happens [s]: before the first step whose forces act at or after it.
        when: A condition of quantities, such as ``"=finger.mcp.angle > 0.5"``; instead of ``at``.
        after: Earliest time for ``when`` [s].
        rate: How often ``when`` is looked at [Hz]; by default 1 kHz as a controller's rate.
        set: Drive, ``<controller>.target`` or ``<controller>.active`` (0 or 1) to its new value, in
            the unit of each.
        release: Joints, springs and tendons that it lets go: they carry nothing any more and are
            not drawn. With a pin go its stops and damping and what acts on it.
        take_up: Joints, springs and tendons that it takes up again, after they were let go or
            broke.
        lasts: Time after which what was set is as before, what was let go is taken up, and what was
            taken up let go [s]; by default for good.
        stop: Ends the run with this verdict; by default the run goes on.
        because: Why it is there; stands in the verdict.
    """

def contact(
    *,
    between: Sequence[str],
    collide: bool | None = None,
    friction: Number | None = None,
    static: Number | None = None,
) -> Entry:
    """What two sets of bodies do when they meet; later rules win over earlier ones.

    Args:
        between: Two names or patterns: ``finger*`` stands for all bodies whose name begins so.
        collide: False lets the two pass through each other, true lets them touch again that an
            earlier rule did not; a joint's own ``collide`` comes after all rules.
        friction: Coulomb coefficient of this pair, 0 or more; by default the geometric mean of the
            two materials'.
        static: How many times as much as the pair rubs with while it slides it holds with while it
            does not, 1 or more; by default the geometric mean of the two materials'.
    """

def group(
    name: str,
    *,
    kind: Literal['finger', 'section', 'rocker_tree', 'pulley_tree', 'group'] | None = None,
    bodies: Sequence[str | Entry] | None = None,
) -> Entry:
    """Bodies that belong together: a finger, a section, a tree.

    Args:
        name: Its name; quantities are ``<name>.contact.count`` and ``<name>.contact.normal``.
        kind: What it is, for the audit and the pictures; ``"group"`` for bodies of one's own
            choice.
        bodies: Names of its bodies; a finger's are its phalanges, the proximal one first.
    """

def meter(
    name: str,
    *,
    value: str,
    unit: str | None = None,
) -> Entry:
    """A named quantity made of recorded ones, written into ``run.npz``.

    Args:
        name: Its name, by which it is recorded, expected and plotted like any other quantity.
        value: An expression of quantities, SI: ``"=finger1.mcp.angle + finger1.pip.angle"``.
        unit: Unit that stands beside its values in files and plots; nothing is converted by it.
    """

def expect(
    *,
    mean: str | None = None,
    min: str | None = None,
    max: str | None = None,
    std: str | None = None,
    final: str | None = None,
    over: str | Sequence[Number | Number | None] | None = None,
    quantity: str | None = None,
    at: Number | None = None,
    is_: Number | None = None,
    within: Number | None = None,
    between: Sequence[Number] | None = None,
    above: Number | None = None,
    below: Number | None = None,
    because: str | None = None,
) -> Entry:
    """A range that a recorded quantity must keep: the scene's own regression test.

    One of ``mean``, ``min``, ``max``, ``std`` or ``final`` names the quantity, or ``quantity`` with
    the instant ``at`` (patterns allowed: every match must hold); one of ``is``, ``between``,
    ``above`` or ``below`` says what it must be.

    Args:
        mean: Quantity, or pattern of quantities, whose mean over the window is looked at.
        min: Quantity, or pattern of quantities, whose least sample of the window is looked at.
        max: Quantity, or pattern of quantities, whose largest sample of the window is looked at.
        std: Quantity, or pattern of quantities, whose standard deviation over the window is looked
            at.
        final: Quantity, or pattern of quantities, whose last sample of the window is looked at.
        over: Window of time: ``"last 0.2 s"`` or ``[from, to]`` [s]; the whole run by default.
        quantity: Quantity, or pattern of quantities, whose value at the instant ``at`` is looked
            at.
        at: Instant at which ``quantity`` is looked at [s], on the straight line between the two
            samples about it.
        is_: What it must be, in the quantity's unit, up to ``within``.
        within: How far it may be from ``is``, to either side: a fraction of it as ``"0.1 %"``, the
            default, or an absolute quantity. By default 0 of what is 1 or 0, such as ``held``.
        between: [lowest, highest] that it may be, both included.
        above: The least that it may be, this value included; may stand together with ``below``.
        below: The most that it may be, this value included; may stand together with ``above``.
        because: Where the range comes from: a closed form, a paper, a measurement.
    """

def finger_geometry(
    *,
    lengths: Sequence[Number | Entry],
    guides: Sequence[Sequence[Number] | Entry],
    from_: Sequence[Sequence[Number] | Entry],
    to: Sequence[Sequence[Number] | Entry],
) -> Entry:
    """A finger's tendon and springs as the paper's section 4 gives them; slack at rotation 0.

    Args:
        lengths: Lengths of the phalanges, the proximal one first [m].
        guides: V_0 in the palm's frame from the first hinge, V_1 ... V_n in their phalanges' frames
            [m].
        from_: M'' of each spring, on the body before the hinge, from the hinge [m].
        to: M' of each spring, in the frame of the body after the hinge [m].
    """

def finger_springs(
    *,
    stiffness: Number | Sequence[Number],
    from_: Sequence[Number] | Sequence[Sequence[Number]],
    to: Sequence[Number] | Sequence[Sequence[Number]],
    damping: Number | Sequence[Number] | None = None,
    rest: Number | Sequence[Number] | None = None,
) -> Entry:
    """A linear spring over the back of each hinge; one value stands for all hinges.

    Args:
        stiffness: Stiffness of each spring [N/m], 0 or more.
        from_: M'', where it is tied on the body before the hinge, relative to the hinge at rotation
            0 [m].
        to: M', where it is tied on the phalanx, in the phalanx's frame [m].
        damping: Damping of each spring [N s/m].
        rest: Lengths at which they give no force [m]; by default the lengths at rotation 0.
    """

def finger_tendon(
    *,
    stiffness: Number | None = None,
    damping: Number | None = None,
    friction: Number | None = None,
) -> Entry:
    """The finger's cord.

    Args:
        stiffness: Tension per stretch [N/m]; the default stands for a cord without stretch.
        damping: Tension per rate of stretch [N s/m].
        friction: Coefficient of friction between the cord and the guides V_0 to V_(n-1), as that of
            a [Guide](elements.md#guide): by each of them less of the pull arrives. At V_n it is
            tied; further guides, ``tendon_to``, have their own. None by default.
    """

def leaf(
    name: str,
    *,
    at: Sequence[Number] | None = None,
) -> Entry:
    """What a tree pulls: a finger, a tendon (at its last guide), or a point of a body.

    Args:
        name: Name of a finger, a tendon, a tree or a body.
        at: Of a body: where the string is tied, in its frame [m].
    """

class _Shape:
    @staticmethod
    def circle(
        *,
        radius: Number,
        at: Sequence[Number] | None = None,
    ) -> Entry:
        """A disc.

        Args:
            radius: Its radius [m].
            at: Its centre in the body's frame [m].
        """
    @staticmethod
    def box(
        *,
        size: Sequence[Number],
        at: Sequence[Number] | None = None,
        angle: Number | None = None,
    ) -> Entry:
        """A rectangle about ``at``, turned by ``angle`` in the body's frame.

        Args:
            size: [width, height] along its own x and y [m].
            at: Its middle in the body's frame [m].
            angle: Its turn against the body's frame [rad], counter-clockwise.
        """
    @staticmethod
    def polygon(
        *,
        points: Sequence[Sequence[Number] | Entry],
        holes: Sequence[Sequence[Sequence[Number] | Entry] | Entry] | None = None,
        nodes: Sequence[Sequence[Sequence[Number | float] | Entry] | Entry] | None = None,
    ) -> Entry:
        """An outline of straight sides, convex or not, with holes if there are any.

        The program cuts it up into convex pieces, whose seams are no surface and are not drawn;
        mass, centre and inertia are those of the outline. It has at most 2000 corners, those of its
        holes among them.

        Args:
            points: Its corners in the body's frame [m], one after the other, clockwise or counter-
                clockwise; the outline may not touch or cross itself.
            holes: Outlines of holes in it, each by itself within the outline; corners as in
                ``points``.
            nodes: The true curves of the outline and of each hole, if it was worked out from a
                curve, a cam or a drawing: contacts follow them instead of the sides. A node is `[x,
                y, direction, curvature]`; two at the same place are a corner or a jump of the
                curvature.
        """
    @staticmethod
    def capsule(
        *,
        end: Sequence[Number],
        radius: Number,
        start: Sequence[Number] | None = None,
    ) -> Entry:
        """A segment from ``start`` to ``end`` with a radius: a phalanx.

        Args:
            start: Middle of its one round end, in the body's frame [m].
            end: Middle of its other round end, in the body's frame [m].
            radius: Half its thickness, and the radius of its ends [m].
        """
    @staticmethod
    def polyline(
        *,
        points: Sequence[Sequence[Number] | Entry],
        radius: Number | None = None,
        nodes: Sequence[Sequence[Sequence[Number | float] | Entry] | Entry] | None = None,
    ) -> Entry:
        """A line from point to point, such as uneven ground, of a body that does not move freely.

        What slides along it is not caught at its joints. Both of its sides can be touched.

        Args:
            points: Where it bends, and its ends; where the last point is the first it is closed.
            radius: How far its surface lies from the line through its points.
            nodes: The true curve, if the polyline was worked out from one; as of a polygon.
        """
    @staticmethod
    def curve(
        *,
        points: Sequence[Sequence[Number] | Entry],
        closed: bool | None = None,
        corners: Sequence[int | Entry] | None = None,
        radius: Number | None = None,
        tolerance: Number | None = None,
        at: Sequence[Number] | None = None,
        angle: Number | None = None,
    ) -> Entry:
        """A smooth curve through points: a closed outline, or an open line such as a track.

        Bodies touch the curve itself: its normal and curvature, not chords. A closed one is a
        solid. An open one belongs to a body that does not move freely, and both of its sides can be
        touched. Between the points lies a cubic spline.

        Args:
            points: Points that it passes through, in order [m]; the last of a closed one is not the
                first.
            closed: Whether it goes on from the last point to the first, and is the outline of a
                solid.
            corners: Numbers of the points at which it has a corner, counted from 0; elsewhere it is
                smooth.
            radius: Of an open one, how far its surface lies from the curve.
            tolerance: How far its chords may be from it in pictures and in its area; contacts do
                not depend on it.
            at: Where the points' origin lies, in the body's frame.
            angle: By which it is turned about that origin, in the body's frame.
        """
    @staticmethod
    def cam(
        *,
        base: Number,
        lift: Sequence[Sequence[Number] | Entry],
        follower: Literal['roller', 'flat'] | None = None,
        roller: Number | None = None,
        towards: Number | None = None,
        turns: Literal['counterclockwise', 'clockwise'] | None = None,
        at: Sequence[Number] | None = None,
        tolerance: Number | None = None,
    ) -> Entry:
        """A disc cam whose outline gives its follower the lift of a table.

        The lift between the table's angles is a smooth curve, a periodic cubic spline. The follower
        moves along a line through the cam's centre. Contacts follow the true outline. Once read, a
        cam is a polygon with nodes.

        Args:
            base: Radius of the outline where the lift is 0.
            lift: How far the follower is raised, by how far the cam has turned: `[angle, lift]`.
                Angles rise over less than a whole turn; the curve goes on from the last to the
                first.
            follower: What touches the cam: a roller, or a flat face across its way.
            roller: Radius of the roller; for a roller only.
            towards: Direction from the cam's centre to the follower, in the body's frame at its
                angle 0.
            turns: The way in which the table's angles count the cam's turn.
            at: Centre that the cam turns about, in the body's frame.
            tolerance: How far chords may be from the outline in pictures and in its area; contacts
                do not depend on it.
        """
    @staticmethod
    def drawing(
        *,
        file: str,
        unit: Number | None = None,
        layer: str | None = None,
        tolerance: Number | None = None,
        at: Sequence[Number] | None = None,
        angle: Number | None = None,
    ) -> Entry:
        """A shape from an SVG or DXF file: its largest outline, with the outlines in it as holes.

        Once read, it is a polygon: what is saved needs the file no more.

        Args:
            file: Name of a `.svg` or `.dxf` file in the scene's own folder or below it.
            unit: Length of one unit of the drawing (of an SVG file's view box); by default what the
                file says. An SVG file that says nothing counts in pixels of 1/96 inch.
            layer: Takes only what is on this layer of a DXF file, or has this id in an SVG file.
            tolerance: How far ends that meet may be from one another, and chords from curves in
                pictures and in the area.
            at: Where the drawing's origin lies, in the body's frame; the drawing's y is up.
            angle: By which the drawing is turned about its origin, in the body's frame.
        """

shape: _Shape

class _Joint:
    @staticmethod
    def pin(
        name: str,
        *,
        a: str,
        b: str,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        takes_up_in: Number | None = None,
        friction_coefficient: Number | None = None,
        static: Number | None = None,
        positive: Literal['counterclockwise', 'clockwise'] | None = None,
        zero: Number | None = None,
        limits: Sequence[Number] | None = None,
        damping: Number | None = None,
        friction: Number | None = None,
        pin_radius: Number | None = None,
    ) -> Entry:
        """A hinge: two bodies turn about one point.

        Its angle is that of ``b`` against ``a``, in its own sense.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: Anchor in the frame of ``a`` [m]; by default where ``on_b`` is at t = 0.
            on_b: Anchor in the frame of ``b`` [m]; by default where ``on_a`` is at t = 0.
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            takes_up_in: How gently a gap closes once the joint is taken up again [s]: over so long
                most of it goes, without a jolt, with a force of some m * gap / takes_up_in^2.
            friction_coefficient: Of dry friction that hangs on what the joint carries: it rubs with
                this times its reaction; none by default.
            static: How many times as much as it rubs with while it slides it holds with while it
                does not, 1 or more; by default just as much.
            positive: The turn of ``b`` against ``a``, as seen, that counts as positive: of angle,
                rate, limits, springs, torques and motors of this hinge.
            zero: Subtracted from the angle between the two frames [rad] once that is counted in the
                positive sense: where it is clockwise, the hinge's angle is minus the frames' angle,
                minus ``zero``.
            limits: Hard stops [lowest, highest] of the hinge's angle [rad]; none by default.
            damping: Viscous friction of the hinge [N m s/rad]: torque against the rate, per rate.
            friction: Dry friction of the hinge [N m]: it holds against torques up to this, and
                slips against this one; none by default.
            pin_radius: Radius at which a pin with a 'friction_coefficient' rubs [m]: its torque is
                the coefficient times this times the reaction.
        """
    @staticmethod
    def slot(
        name: str,
        *,
        a: str,
        b: str,
        start: Sequence[Number],
        end: Sequence[Number],
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        takes_up_in: Number | None = None,
        friction_coefficient: Number | None = None,
        static: Number | None = None,
        turns: bool | None = None,
        friction: Number | None = None,
    ) -> Entry:
        """A point of ``b`` slides along a groove of ``a`` that runs from ``start`` to ``end``.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: Not used: ``start`` and ``end`` say where the groove is.
            on_b: The point of ``b`` that stays on the groove, in its frame [m].
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            takes_up_in: How gently a gap closes once the joint is taken up again [s]: over so long
                most of it goes, without a jolt, with a force of some m * gap / takes_up_in^2.
            friction_coefficient: Of dry friction that hangs on what the joint carries: it rubs with
                this times its reaction; none by default.
            static: How many times as much as it rubs with while it slides it holds with while it
                does not, 1 or more; by default just as much.
            start: One end of the groove, in the frame of ``a`` [m].
            end: Other end of the groove, in the frame of ``a`` [m]; the point stops hard at either.
            turns: Whether ``b`` may turn on the groove: true leaves its angle free, false keeps the
                angle that the two bodies have to each other at t = 0, as a slider does.
            friction: Dry friction along the groove [N]: it holds against forces up to this, and
                slides against this one; none by default.
        """
    @staticmethod
    def weld(
        name: str,
        *,
        a: str,
        b: str,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        takes_up_in: Number | None = None,
    ) -> Entry:
        """Two bodies held rigidly together.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: Anchor in the frame of ``a`` [m]; by default where ``on_b`` is at t = 0.
            on_b: Anchor in the frame of ``b`` [m]; by default where ``on_a`` is at t = 0.
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            takes_up_in: How gently a gap closes once the joint is taken up again [s]: over so long
                most of it goes, without a jolt, with a force of some m * gap / takes_up_in^2.
        """
    @staticmethod
    def rod(
        name: str,
        *,
        a: str,
        b: str,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        takes_up_in: Number | None = None,
        length: Number | None = None,
    ) -> Entry:
        """A massless rigid rod between two points.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: One of the points, in the frame of ``a`` [m].
            on_b: The other point, in the frame of ``b`` [m].
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            takes_up_in: How gently a gap closes once the joint is taken up again [s]: over so long
                most of it goes, without a jolt, with a force of some m * gap / takes_up_in^2.
            length: Distance that the two points keep [m]; by default what it is at t = 0.
        """
    @staticmethod
    def rope(
        name: str,
        *,
        a: str,
        b: str,
        longest: Number,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        shortest: Number | None = None,
    ) -> Entry:
        """Keeps two points between a least and a largest distance.

        With ``shortest`` 0 it is a slack rope, otherwise a telescopic rod. It does not stretch, and
        its jolt is inelastic: where it becomes taut both ends go on at one speed along it, at any
        step. A tendon is elastic.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: One of the points, in the frame of ``a`` [m].
            on_b: The other point, in the frame of ``b`` [m].
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            longest: Largest distance of the two points [m].
            shortest: Least distance of the two points [m]; 0 leaves them free to come together.
        """
    @staticmethod
    def actuator(
        name: str,
        *,
        a: str,
        b: str,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        shortest: Number | None = None,
        longest: Number | None = None,
    ) -> Entry:
        """A cylinder, screw or solenoid between two points, as seen from outside.

        By itself it gives way freely between its ends of stroke. Drives make it work: ``push`` sets
        its force, ``extend`` the speed at which it grows longer, ``length`` its length.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: Where the cylinder is held, in the frame of ``a`` [m].
            on_b: Where the rod is held, in the frame of ``b`` [m].
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            shortest: Distance of the two points with the rod drawn in [m]: a hard stop; none by
                default.
            longest: Distance of the two points with the rod out [m]: a hard stop; none by default.
        """
    @staticmethod
    def gear(
        name: str,
        *,
        a: str,
        b: str,
        radius_a: Number,
        radius_b: Number,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        inside: bool | None = None,
        pressure_angle: Number | None = None,
        backlash: Number | None = None,
        stiffness: Number | None = None,
    ) -> Entry:
        """Two gears that mesh, with involute teeth, outside or one inside the other.

        What holds their centres is up to other joints: pins on the ground or on a carrier. Teeth
        mesh as they stand at t = 0. They push along the line of action, which makes the pressure
        angle with the common tangent of the pitch circles; so beside the tangential force there is
        a radial one, which the bearings carry.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: Centre of the first wheel in the frame of ``a`` [m].
            on_b: Centre of the second wheel in the frame of ``b`` [m].
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            radius_a: Of the pitch circle of ``a``, whose centre is ``on_a``.
            radius_b: Of the pitch circle of ``b``, whose centre is ``on_b``.
            inside: True: the smaller gear runs inside the larger one, a ring with teeth inside.
            pressure_angle: Between the line of action and the common tangent of the pitch circles,
                up to 45 deg.
            backlash: Play of the teeth along the pitch circles; at t = 0 they stand in its middle.
            stiffness: Of teeth without play, along the line of action [N/m]: by this several
                planets share a load. Of steel teeth about 1.4e10 N/m per metre of their width.
        """
    @staticmethod
    def rack(
        name: str,
        *,
        a: str,
        b: str,
        radius: Number,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        along: Sequence[Number] | None = None,
        pressure_angle: Number | None = None,
        backlash: Number | None = None,
        stiffness: Number | None = None,
    ) -> Entry:
        """A gear ``a`` and a straight rack ``b`` that mesh, as gears do.

        The pitch line has no ends: a rack that is drawn shorter goes on meshing beyond what is
        drawn.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: Centre of the gear in the frame of ``a`` [m].
            on_b: A point of the pitch line in the frame of ``b`` [m].
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            radius: Of the pitch circle of ``a``, whose centre is ``on_a``.
            along: Direction of the rack's pitch line in the frame of ``b``; its length does not
                count.
            pressure_angle: Between the line of action and the pitch line, up to 45 deg.
            backlash: Play of the teeth along the pitch line; at t = 0 they stand in its middle.
            stiffness: Of teeth without play, along the line of action [N/m].
        """
    @staticmethod
    def roll(
        name: str,
        *,
        a: str,
        b: str,
        radius_a: Number,
        radius_b: Number,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        collide: bool | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        inside: bool | None = None,
    ) -> Entry:
        """Two circles that roll on one another without slip and stay in touch (a Hillberry joint).

        Crossed bands hold such a joint together; here it can be pulled as well as pressed.

        Args:
            name: Its name; quantities are ``<name>.reaction`` and so on.
            a: The body that is counted from: a hinge's angle is that of ``b`` against it, a slot's
                groove moves with it.
            b: The other body; ``reaction_x`` and ``reaction_y`` are the force on it by ``a``.
            on_a: Centre of the first wheel in the frame of ``a`` [m].
            on_b: Centre of the second wheel in the frame of ``b`` [m].
            collide: Whether the two bodies may touch each other; by default they pass through each
                other, also while the joint is let go.
            breaks_at: The size of its ``reaction`` above which it is let go [N], for good unless an
                event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            radius_a: Of the circle of ``a``, whose centre is ``on_a``.
            radius_b: Of the circle of ``b``, whose centre is ``on_b``.
            inside: True: the smaller circle rolls inside the larger one.
        """

joint: _Joint

class _Spring:
    @staticmethod
    def linear(
        name: str,
        *,
        a: str,
        b: str,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        stiffness: Number | None = None,
        force: str | None = None,
        only: Literal['pull', 'push'] | None = None,
        damping: Number | None = None,
        rest_length: Number | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
        taken_up: Literal['natural', 'as_is'] | None = None,
    ) -> Entry:
        """A straight spring and damper from a point of ``a`` to a point of ``b``; pulls and pushes.

        Args:
            name: Its name; quantities are ``<name>.force`` and so on.
            a: The body at its one end.
            b: The body at its other end.
            on_a: Where it is tied, in the frame of ``a`` [m].
            on_b: Where it is tied, in the frame of ``b`` [m].
            stiffness: Force per change of length [N/m], 0 or more; the force is positive where it
                pulls.
            force: In place of ``stiffness`` the force [N] as an expression of its ``stretch`` [m],
                its length less that at rest, and of its ``rate`` [m/s], by which that grows:
                ``"=1e3 * stretch + 4e6 * stretch ** 3"``, ``"=bumper(stretch)"``. Positive pulls.
            only: One-sided: ``pull`` for what only pulls, and is slack below its length at rest, as
                a bungee cord; ``push`` for what only pushes, and stands apart above it, as a bump
                stop.
            damping: Force per rate of length [N s/m], against it; of a one-sided spring only while
                it acts.
            rest_length: Length at which it neither pulls nor pushes [m]; by default the length at t
                = 0. The ``stretch`` of its ``force`` counts from it.
            breaks_at: The size of its force, either way, above which it is let go [N], for good
                unless an event takes it up again; by default it never breaks.
            released: Whether it is let go from the start, until an event takes it up.
            taken_up: With which length at rest an event takes it up again: ``natural`` is the one
                that it has had, so that it may pull at once; ``as_is`` the distance of its points
                then, so that it begins without force.
        """
    @staticmethod
    def rotary(
        name: str,
        *,
        joint: str,
        stiffness: Number | None = None,
        torque: str | None = None,
        only: Literal['above', 'below'] | None = None,
        damping: Number | None = None,
        rest_angle: Number | None = None,
        breaks_at: Number | None = None,
        released: bool | None = None,
    ) -> Entry:
        """A torsion spring and damper on a hinge, in the hinge's own sense of turning.

        Args:
            name: Its name; quantities are ``<name>.torque`` and so on.
            joint: Name of the pin that it acts on; its angle is this hinge's, in the hinge's sense.
            stiffness: Torque per angle [N m/rad], 0 or more, towards ``rest_angle``.
            torque: In place of ``stiffness`` the torque [N m] as an expression of its ``twist``
                [rad], the hinge's angle less ``rest_angle``, and of its ``rate`` [rad/s]: ``"=0.2 *
                twist ** 3"``, ``"=pad(twist)"``. Positive turns a positive twist back.
            only: One-sided: it acts only where the hinge's angle is ``above`` the one at rest, or
                only where it is ``below``, and only towards it.
            damping: Torque per rate [N m s/rad], against it; of a one-sided spring only while it
                acts.
            rest_angle: The hinge's angle at which it gives no torque [rad], in the hinge's sense; 0
                by default, wherever the hinge starts.
            breaks_at: The size of its torque, either way and without its damping, above which it is
                let go [N m], for good unless an event takes it up again; by default it never
                breaks.
            released: Whether it is let go from the start, until an event takes it up. Its damping
                is part of the hinge's, and stays as long as that.
        """

spring: _Spring

class _Chamber:
    @staticmethod
    def cylinder(
        *,
        a: str,
        b: str,
        area: Number,
        on_a: Sequence[Number] | None = None,
        on_b: Sequence[Number] | None = None,
        pulls: bool | None = None,
    ) -> Entry:
        """A chamber between a point of ``a`` and a point of ``b``: area times distance.

        Args:
            a: The body that its tube is tied to.
            b: The body that its rod is tied to.
            on_a: Where it is tied, in the frame of ``a`` [m].
            on_b: Where it is tied, in the frame of ``b`` [m].
            area: Of the piston that the fluid presses [m^2]; the force along the line through the
                two points is this times the pressure.
            pulls: Whether the fluid is on the rod's side: its volume then grows as the points come
                nearer, and pressure pulls them together, as in an artificial muscle.
        """
    @staticmethod
    def vane(
        *,
        joint: str,
        displacement: Number,
    ) -> Entry:
        """A chamber on a hinge, such as a vane or a bellows: a volume for each angle.

        Args:
            joint: Name of the pin that it turns.
            displacement: Volume per angle of the hinge, in its own sense [m^3/rad]; the torque is
                this times the pressure, and against that sense where it is negative.
        """

chamber: _Chamber

class _Load:
    @staticmethod
    def law(
        name: str,
        *,
        bodies: str | Sequence[str] | None = None,
        force: Sequence[Number] | None = None,
        acceleration: Sequence[Number] | None = None,
        torque: Number | None = None,
        at: Sequence[Number] | None = None,
        frame: Literal['world', 'body'] | None = None,
    ) -> Entry:
        """A force or a torque on bodies, by an expression of each body's own motion.

        An expression may read ``x``, ``y``, ``vx``, ``vy``, ``speed``, ``ax``, ``ay`` of the point
        ``at``, ``angle``, ``omega``, ``alpha``, ``mass``, ``inertia`` of the body, the time ``t``,
        parameters and tables.

        Args:
            name: Its name; quantities are ``<name>.<body>.fx`` and so on.
            bodies: The bodies that it acts on, each by its own motion: a name, a pattern such as
                ``"ball*"``, or a list of them. By default every body that moves freely; what a
                pattern fits and does not move freely is left out.
            force: The force [x, y] at the point ``at`` [N]: ``["=-0.2 * vx", "=-0.2 * vy"]``.
            acceleration: In place of ``force`` the force [x, y] per mass of the body [m/s^2], as a
                field has it: ``[0, "-1.62 m/s^2"]``.
            torque: A torque on the body besides [N m], positive counter-clockwise: ``"=-0.01 *
                omega"``.
            at: The point that the force acts on, in the frame of each body [m]; by default its
                centre of mass. Where it is and how it moves is what the expressions read.
            frame: Along whose axes the two components are: the world's, or those of the body, which
                turn with it. ``vx``, ``vy``, ``ax``, ``ay`` are along the same ones; ``x``, ``y``
                and ``angle`` are of the world.
        """
    @staticmethod
    def drag(
        name: str,
        *,
        bodies: str | Sequence[str] | None = None,
        linear: Number | None = None,
        area: Number | None = None,
        coefficient: Number | None = None,
        density: Number | None = None,
        turning: Number | None = None,
        flow: Sequence[Number] | None = None,
    ) -> Entry:
        """What a medium does against the motion of bodies through it, at their centres of mass.

        F = -(linear + density / 2 * coefficient * area * |v|) v, v against the medium.

        Args:
            name: Its name; quantities are ``<name>.<body>.fx`` and so on.
            bodies: The bodies that it acts on: a name, a pattern such as ``"ball*"``, or a list of
                them. By default every body that moves freely.
            linear: Force per speed [N s/m], as of what is slow and small in what is viscous.
            area: Of the body as the flow sees it, across the motion [m^2]; by default there is no
                part that grows with the square of the speed.
            coefficient: The drag coefficient of that area: 0.47 of a ball, 1.1 of a disc across the
                flow.
            density: Of the medium [kg/m^3]; by default that of air.
            turning: Torque per angular speed [N m s/rad], against it.
            flow: The velocity [x, y] of the medium in the world, such as wind [m/s]; none by
                default.
        """
    @staticmethod
    def buoyancy(
        name: str,
        *,
        bodies: str | Sequence[str] | None = None,
        level: Number | None = None,
        density: Number | None = None,
    ) -> Entry:
        """What a liquid at rest lifts bodies by, as far as their shapes are below its level.

        A body that ``displaces`` more than its shapes, an open bin, is lifted by that instead.

        F = density * thickness * (area below the level) * g, upwards, at the centroid of that area,
        with the ``thickness`` of the body and the scene's gravity, which has to point downwards. It
        is exact of every shape; shapes that overlap count twice, as they do in a body's mass. It
        takes no energy; a ``drag`` beside it does.

        Args:
            name: Its name; quantities are ``<name>.<body>.fy`` and so on.
            bodies: The bodies that it lifts: a name, a pattern such as ``"boat*"``, or a list of
                them. By default every body that moves freely and has an area.
            level: How high the liquid stands: its ``y`` in the world [m].
            density: Of the liquid [kg/m^3]; by default that of water.
        """

load: _Load

class _Drive:
    @staticmethod
    def force(
        name: str,
        *,
        body: str,
        direction: Sequence[Number],
        value: Number | Entry | Mapping[str, Any],
        at: Sequence[Number] | None = None,
        frame: Literal['world', 'body'] | None = None,
    ) -> Entry:
        """A force on a point of a body, along a fixed direction.

        Args:
            name: Its name; its value is recorded as ``<name>.value``.
            body: Name of the body that is pushed.
            at: The point that the force acts on, in the body's frame [m]; it moves with the body.
            direction: [x, y] of any length but zero: only its direction counts, and a negative
                value pushes the other way.
            frame: Whether the direction stays as it is in the world, or turns with the body.
            value: The force over time [N].
        """
    @staticmethod
    def torque(
        name: str,
        *,
        joint: str,
        value: Number | Entry | Mapping[str, Any],
    ) -> Entry:
        """A torque between the two bodies of a hinge, positive as the hinge turns.

        Args:
            name: Its name; its value is recorded as ``<name>.value``.
            joint: Name of the pin that it acts on.
            value: The torque over time [N m], in the hinge's sense: on its body ``b``, and the
                opposite on ``a``.
        """
    @staticmethod
    def pull(
        name: str,
        *,
        tendon: str,
        value: Number | Entry | Mapping[str, Any],
    ) -> Entry:
        """Sets the tension of a tendon: an actuator at its last guide. Below 0 counts as 0.

        Args:
            name: Its name; its value is recorded as ``<name>.value``.
            tendon: Name of a tendon, or of a finger or tree: then its own tendon is pulled.
            value: The tension over time [N]; below 0 counts as 0.
        """
    @staticmethod
    def radius(
        name: str,
        *,
        body: str,
        value: Number | Entry | Mapping[str, Any],
        shape: int | None = None,
    ) -> Entry:
        """Sets the radius of a body's circle over time: an object that swells or shrinks.

        Args:
            name: Its name; its value is recorded as ``<name>.value``.
            body: Name of the body; mass and inertia stay as they are.
            shape: Which of the body's shapes, counted from 0; it has to be a circle.
            value: The radius over time [m].
        """
    @staticmethod
    def stiffness(
        name: str,
        *,
        spring: str | None = None,
        tendon: str | None = None,
        value: Number | Entry | Mapping[str, Any] | None = None,
    ) -> Entry:
        """Sets the stiffness of a spring or of a tendon over time. Below 0 counts as 0.

        Args:
            name: Its name; its value is recorded as ``<name>.value``.
            spring: Name of the spring, linear or rotary; its damping stays as it is. This or
                ``tendon``.
            tendon: In place of ``spring`` the name of a tendon of less than 100 kN/m that no drive
                pulls and no guide holds by friction, or of a finger or tree: then its own tendon.
                Its damping and its length at rest stay as they are; this is also the length that a
                ``pretension`` gives it by the tendon's own stiffness.
            value: The stiffness over time, [N/m] of a linear spring or a tendon, [N m/rad] of a
                rotary spring; by default what it has itself, which a controller may then change.
        """
    @staticmethod
    def motor(
        name: str,
        *,
        joint: str,
        value: Number | Entry | Mapping[str, Any] | None = None,
        torque: Number | None = None,
        stall: Number | None = None,
        no_load: Number | None = None,
    ) -> Entry:
        """Turns a hinge: at a set speed with no more than a given torque, or along a line.

        With ``stall`` and ``no_load`` its torque is on a line that falls with the speed w of the
        hinge, T = stall (u - w) / no_load, u the ``value``: it drives while w is between 0 and u,
        brakes and gives power back where w is beyond u, and brakes with more than ``stall`` where
        it is turned against u; where u is below 0, all of it the other way round.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, what it gives as
                ``<name>.torque``.
            joint: Name of the pin that it acts on.
            value: The speed of ``b`` against ``a`` over time [rad/s], in the hinge's own sense. Of
                a motor with a line it is that at which it gives no torque, by default ``no_load``:
                half of it is half the voltage, minus it the full voltage backwards.
            torque: The most that it can give, either way [N m]; may be left out of a motor with a
                line, which then gives whatever the line says.
            stall: Of a motor with a line: its torque at rest [N m], while ``value`` is ``no_load``.
            no_load: Of a motor with a line: the speed at which its torque is 0 [rad/s], while
                ``value`` is this, as it is by default.
        """
    @staticmethod
    def brake(
        name: str,
        *,
        joint: str,
        value: Number | Entry | Mapping[str, Any],
    ) -> Entry:
        """Holds a hinge with at most a given torque and slips above it: a lock, a brake.

        Friction that a hinge always has is its own ``friction``.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, what it holds with as
                ``<name>.torque``.
            joint: Name of the pin that it holds.
            value: The torque up to which it holds over time [N m]; 0 lets go, below 0 counts as 0.
        """
    @staticmethod
    def servo(
        name: str,
        *,
        joint: str,
        value: Number | Entry | Mapping[str, Any],
        torque: Number,
        stiffness: Number | None = None,
        damping: Number | None = None,
        speed: Number | None = None,
    ) -> Entry:
        """Brings a hinge to an angle and holds it there, with no more than a given torque.

        With ``stiffness`` it is a controller with a spring's law: torque = stiffness (value -
        angle) - damping rate, up to ``torque``. Loads then move it away from its target, as they do
        a real one without an integrator. Without ``stiffness`` it is rigid: it goes to its target
        with ``torque``, brakes in time so as not to overshoot, and holds it exactly as long as
        ``torque`` suffices.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, what it gives as
                ``<name>.torque``.
            joint: Name of the pin that it acts on.
            value: The angle to go to over time [rad], as the hinge counts it: in its own sense,
                from its ``zero``.
            torque: The most that it can give, either way [N m].
            stiffness: Torque for each radian that is missing [N m/rad]; without, the default, it is
                rigid.
            damping: With ``stiffness``: torque against the hinge's rate, per rate [N m s/rad].
            speed: Of a rigid one the most that it turns at [rad/s]; no limit by default.
        """
    @staticmethod
    def push(
        name: str,
        *,
        joint: str,
        value: Number | Entry | Mapping[str, Any],
    ) -> Entry:
        """A force between the two points of an actuator, along the line through them.

        Args:
            name: Its name; its value is recorded as ``<name>.value``.
            joint: Name of the actuator that it acts on.
            value: The force over time [N]; positive pushes the points apart, negative pulls them
                together.
        """
    @staticmethod
    def extend(
        name: str,
        *,
        joint: str,
        value: Number | Entry | Mapping[str, Any],
        force: Number,
    ) -> Entry:
        """Lengthens an actuator at a set speed, with no more than a given force.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, what it gives as
                ``<name>.force``.
            joint: Name of the actuator that it acts on.
            value: The speed over time [m/s]; positive makes the actuator longer.
            force: The most that it can give, either way [N].
        """
    @staticmethod
    def length(
        name: str,
        *,
        joint: str,
        value: Number | Entry | Mapping[str, Any],
        force: Number,
        stiffness: Number | None = None,
        damping: Number | None = None,
        speed: Number | None = None,
    ) -> Entry:
        """Brings an actuator to a length and holds it there, with no more than a given force.

        With ``stiffness`` its force = stiffness (value - length) - damping speed, up to ``force``.
        Without, it is rigid: it goes to its target with ``force``, brakes in time so as not to
        overshoot, and holds it exactly as long as ``force`` suffices.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, what it gives as
                ``<name>.force``.
            joint: Name of the actuator that it acts on.
            value: The distance of the actuator's two points to go to over time [m].
            force: The most that it can give, either way [N].
            stiffness: Force for each metre that is missing [N/m]; without, the default, it is
                rigid.
            damping: With ``stiffness``: force against the actuator's speed, per speed [N s/m].
            speed: Of a rigid one the fastest that its length changes [m/s]; no limit by default.
        """
    @staticmethod
    def flow(
        name: str,
        *,
        line: str,
        value: Number | Entry | Mapping[str, Any],
    ) -> Entry:
        """Pumps fluid into a line, however high the pressure: the line's ``relief`` bounds it.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, the work on the fluid as
                ``<name>.work``.
            line: Name of the line that it feeds.
            value: The flow over time [m^3/s], of a gas as it would be at the pressure of the
                surroundings; below 0 it is sucked out.
        """
    @staticmethod
    def pressure(
        name: str,
        *,
        line: str,
        value: Number | Entry | Mapping[str, Any],
        resistance: Number | None = None,
    ) -> Entry:
        """A source of pressure that a line is fed from, and that takes fluid back.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, what it gives as
                ``<name>.flow``.
            line: Name of the line that it feeds.
            value: The pressure over time [Pa], above the surroundings; the line's ``least`` and
                ``relief`` bound what it comes to there.
            resistance: Pressure that is lost per flow between the source and the line [Pa s/m^3];
                with 0, the default, the line has the pressure of the source.
        """
    @staticmethod
    def opening(
        name: str,
        *,
        valve: str,
        value: Number | Entry | Mapping[str, Any],
    ) -> Entry:
        """Opens and shuts a valve.

        Args:
            name: Its name; its value is recorded as ``<name>.value``.
            valve: Name of the valve; one that no drive opens is fully open.
            value: How far it is open over time: 0 is shut, 1 fully open. Below 0 counts as 0.
        """
    @staticmethod
    def surface(
        name: str,
        *,
        body: str,
        value: Number | Entry | Mapping[str, Any],
        positive: Literal['counterclockwise', 'clockwise'] | None = None,
    ) -> Entry:
        """Lets the surface of a body run along its outline, as that of a conveyor; the body stays.

        What touches it is carried along by friction.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, friction times speed as
                ``<name>.power``.
            body: Name of the body, all of whose shapes run; its mass and pose are not changed by
                that.
            positive: Which way round the body, as seen, a positive speed runs: with ``clockwise``
                its top runs to the right.
            value: The speed along the surface over time [m/s], seen from the body.
        """
    @staticmethod
    def hold(
        name: str,
        *,
        element: str,
        value: Number | Entry | Mapping[str, Any],
    ) -> Entry:
        """Lets go of a joint, a spring or a tendon and takes it up again, as often as its value
        says.

        A clutch, a magnet, a latch that a controller works. What breaks stays broken until the
        value has been 0.5 or less and rises again.

        Args:
            name: Its name; its value is recorded as ``<name>.value``, and whether the element holds
                as ``<element>.held``.
            element: Name of the joint, spring or tendon. A joint closes its gap in its
                ``takes_up_in``.
            value: Over time: above 0.5 it is held, else let go. An event that lets go of the same
                element or takes it up counts until this value crosses 0.5 the next time.
        """

drive: _Drive

class _Controller:
    @staticmethod
    def pid(
        name: str,
        *,
        writes: str,
        reads: str,
        target: Number | Entry | Mapping[str, Any],
        rate: Number | None = None,
        active: bool | None = None,
        limits: Sequence[Number] | None = None,
        slew: Number | None = None,
        kp: Number | None = None,
        ki: Number | None = None,
        kd: Number | None = None,
        filter: Number | None = None,
        bias: Number | None = None,
        bumpless: bool | None = None,
        anti_windup: Literal['clamp', 'back_calculation', 'none'] | None = None,
        tracking: Number | None = None,
    ) -> Entry:
        """Brings a reading to its target by a drive: a PID controller.

        u = bias + kp e + ki ∫e dt - kd d(reading)/dt with e = target - reading.

        Gains may be negative, where more of the input makes the reading less.

        Args:
            name: Its name, by which events set ``<name>.target`` and ``<name>.active``.
            rate: How often it acts [Hz]; by default 1 kHz or the nearest rate that the step
                divides.
            active: Whether it acts from the start; an event may switch it by setting
                ``<name>.active``.
            writes: Name of the drive that it sets.
            limits: [lowest, highest] that it sets, in the drive's unit; none by default.
            slew: Largest change a second, either way, in the drive's unit; none by default.
            reads: A quantity (``finger.mcp.angle``) or an expression (``"=a.angle - b.angle"``).
            target: What the reading shall be over time, in the reading's unit; an event may set
                ``<name>.target``.
            kp: Gain of the error [drive's unit per reading's unit].
            ki: Gain of the error's integral [drive's unit per reading's unit and second].
            kd: Gain of the reading's rate, against it [drive's unit times seconds per reading's
                unit].
            filter: Time constant of the low-pass on the derivative [s]; 0 is none.
            bias: What is added to the law, in the drive's unit; by default the drive's value when
                the controller begins.
            bumpless: Begin with the integral at which the first output is the bias. Switched on in
                the middle of a run, a loop with an integral goes on from what the drive has, in any
                case.
            anti_windup: What becomes of the integral while the output is cut: ``clamp`` holds it
                while it would lead further beyond what can be set, ``back_calculation`` leads it
                back, ``none`` lets it run on.
            tracking: Time constant of the back-calculation [s]; by default |kp / ki|, and at once
                if kp is 0.
        """
    @staticmethod
    def schedule(
        name: str,
        *,
        writes: str,
        value: Number | Entry | Mapping[str, Any],
        rate: Number | None = None,
        active: bool | None = None,
        limits: Sequence[Number] | None = None,
        slew: Number | None = None,
    ) -> Entry:
        """Sets a drive to a value over time, at its own rate and within limits.

        Args:
            name: Its name, by which events set ``<name>.target`` and ``<name>.active``.
            rate: How often it acts [Hz]; by default 1 kHz or the nearest rate that the step
                divides.
            active: Whether it acts from the start; an event may switch it by setting
                ``<name>.active``.
            writes: Name of the drive that it sets.
            limits: [lowest, highest] that it sets, in the drive's unit; none by default.
            slew: Largest change a second, either way, in the drive's unit; none by default.
            value: What the drive is set to over time, in its unit.
        """
    @staticmethod
    def feedback(
        name: str,
        *,
        writes: str,
        value: str,
        rate: Number | None = None,
        active: bool | None = None,
        limits: Sequence[Number] | None = None,
        slew: Number | None = None,
    ) -> Entry:
        """Sets a drive to an expression of quantities and of the time ``t``.

        Args:
            name: Its name, by which events set ``<name>.target`` and ``<name>.active``.
            rate: How often it acts [Hz]; by default 1 kHz or the nearest rate that the step
                divides.
            active: Whether it acts from the start; an event may switch it by setting
                ``<name>.active``.
            writes: Name of the drive that it sets.
            limits: [lowest, highest] that it sets, in the drive's unit; none by default.
            slew: Largest change a second, either way, in the drive's unit; none by default.
            value: What the drive is set to, in its unit: an expression of quantities, of parameters
                and of the time ``t`` [s], such as ``"=0.2 * cos(axle.angle)"``.
        """
    @staticmethod
    def switch(
        name: str,
        *,
        writes: str,
        reads: str,
        below: Number,
        above: Number,
        value_below: Number,
        value_above: Number,
        rate: Number | None = None,
        active: bool | None = None,
        limits: Sequence[Number] | None = None,
        slew: Number | None = None,
    ) -> Entry:
        """On/off with hysteresis: one value once the reading fell below, another once it rose
        above.

        In between the drive keeps what it has; at the start of a run that is ``value_below``.

        Args:
            name: Its name, by which events set ``<name>.target`` and ``<name>.active``.
            rate: How often it acts [Hz]; by default 1 kHz or the nearest rate that the step
                divides.
            active: Whether it acts from the start; an event may switch it by setting
                ``<name>.active``.
            writes: Name of the drive that it sets.
            limits: [lowest, highest] that it sets, in the drive's unit; none by default.
            slew: Largest change a second, either way, in the drive's unit; none by default.
            reads: A quantity (``finger.mcp.angle``) or an expression (``"=a.angle - b.angle"``).
            below: The reading under which ``value_below`` is set, in the reading's unit.
            above: The reading over which ``value_above`` is set, in the reading's unit; more than
                ``below``.
            value_below: What the drive is set to once the reading is less than ``below``, in the
                drive's unit.
            value_above: What the drive is set to once the reading is more than ``above``, in the
                drive's unit.
        """
    @staticmethod
    def relay(
        name: str,
        *,
        writes: str,
        reads: str,
        target: Number | Entry | Mapping[str, Any],
        amplitude: Number,
        rate: Number | None = None,
        active: bool | None = None,
        limits: Sequence[Number] | None = None,
        slew: Number | None = None,
        hysteresis: Number | None = None,
        cycles: int | None = None,
        rule: Literal['ziegler_nichols_pi', 'ziegler_nichols_pid', 'tyreus_luyben_pi',
            'tyreus_luyben_pid', 'no_overshoot_pid'] | None = None,
        bias: Number | None = None,
    ) -> Entry:
        """A PID controller that first finds its gains itself, by switching its drive to and fro.

        That is relay auto-tuning (Astrom and Hagglund 1984). The drive is switched between bias +
        amplitude and bias - amplitude until the reading has gone round ``cycles`` times; amplitude
        and period of those after the first give the gains. What was found stands in ``run.json``.

        Args:
            name: Its name, by which events set ``<name>.target`` and ``<name>.active``.
            rate: How often it acts [Hz]; by default 1 kHz or the nearest rate that the step
                divides.
            active: Whether it acts from the start; an event may switch it by setting
                ``<name>.active``.
            writes: Name of the drive that it sets.
            limits: [lowest, highest] that it sets, in the drive's unit; none by default.
            slew: Largest change a second, either way, in the drive's unit; none by default.
            reads: A quantity (``finger.mcp.angle``) or an expression (``"=a.angle - b.angle"``).
            target: What the reading shall swing about, and then be, in the reading's unit.
            amplitude: Half the height of what is switched, in the drive's unit; not 0, and negative
                where more of the input makes the reading less.
            hysteresis: How far the reading passes the target before the relay switches, in the
                reading's unit.
            cycles: How often the reading goes round before gains are worked out; the first time is
                not measured.
            rule: Which rule gives the gains for the ultimate gain and period that were found, and
                whether the law has a derivative.
            bias: Middle of what is switched, in the drive's unit; by default the drive's value when
                the controller begins.
        """
    @staticmethod
    def state_feedback(
        name: str,
        *,
        writes: Sequence[str | Entry],
        reads: Sequence[str | Entry],
        targets: Sequence[Number | Entry | Mapping[str, Any]],
        gains: Sequence[Sequence[Number | Entry] | Entry],
        rate: Number | None = None,
        active: bool | None = None,
        limits: Sequence[Sequence[Number]] | None = None,
        slew: Sequence[Number] | None = None,
        integral_gains: Sequence[Sequence[Number]] | None = None,
        bias: Sequence[Number] | None = None,
    ) -> Entry:
        """Brings several readings to their targets at once, by a gain for each.

        u = bias + gains (targets - readings) + integral_gains ∫(targets - readings) dt.

        The gains come from a design such as a linear-quadratic one.

        Args:
            name: Its name, by which events set ``<name>.target`` and ``<name>.active``.
            rate: How often it acts [Hz]; by default 1 kHz or the nearest rate that the step
                divides.
            active: Whether it acts from the start; an event may switch it by setting
                ``<name>.active``.
            writes: Names of the drives that it sets.
            limits: [lowest, highest] of each drive, in its unit; none by default.
            slew: Largest change a second of each drive, either way, in its unit; none by default.
            reads: Quantities, or expressions of them, in the order of the columns of ``gains``.
            targets: What each reading shall be over time, in the reading's unit.
            gains: A row for each drive, a column for each reading [drive's unit per reading's
                unit].
            integral_gains: Gains of the errors' integrals, in the shape of ``gains``; none by
                default. Where a row's drive is at its limit, that row's integral is held.
            bias: What is added for each drive, in its unit; by default the drives' values when the
                controller begins.
        """
    @staticmethod
    def equilibrium(
        name: str,
        *,
        writes: Sequence[str | Entry],
        tendon: str,
        joints: Sequence[str | Entry],
        targets: Sequence[Number | Entry | Mapping[str, Any]],
        kp: Sequence[Number | Entry],
        rate: Number | None = None,
        active: bool | None = None,
        limits: Sequence[Sequence[Number]] | None = None,
        slew: Sequence[Number] | None = None,
        pull: Number | None = None,
        ki: Sequence[Number] | None = None,
        kd: Sequence[Number] | None = None,
        rise: Number | None = None,
        guard: Number | None = None,
        geometry: Entry | None = None,
    ) -> Entry:
        """Holds the joints of a pulled finger by the stiffness of its springs, from T h = k dlm hm.

        k = T h / (dlm hm) at the targets, and what is left, torque = kp (rotation - reference) + kd
        rate + ki ∫(rotation - reference) dt, as stiffness torque / (dlm hm) at the present
        rotations. h is the tendon's arm, dlm the spring's elongation and hm its arm.

        Args:
            name: Its name, by which events set ``<name>.target`` and ``<name>.active``.
            rate: How often it acts [Hz]; by default 1 kHz or the nearest rate that the step
                divides.
            active: Whether it acts from the start; an event may switch it by setting
                ``<name>.active``.
            writes: Names of the drives that it sets.
            limits: [lowest, highest] of each drive, in its unit; none by default.
            slew: Largest change a second of each drive, either way, in its unit; none by default.
            tendon: Name of the tendon that turns the joints.
            joints: Names of the hinges; ``writes`` are the stiffness drives of the springs across
                them, in this order.
            targets: Of the joints' rotations over time [rad], each in its hinge's sense.
            pull: T that is reckoned with [N]; by default the tension that the tendon has.
            kp: Torque per error of rotation, one for each joint [N m/rad].
            ki: Torque per integral of the error, one for each joint [N m/(rad s)]; none by default.
                The integral begins once ``rise`` is over.
            kd: Torque per rate of rotation, one for each joint [N m s/rad]; none by default.
            rise: Time in which the reference goes from where the joints are to the targets [s].
            guard: dlm hm, 0 in the straight finger, counts as no less than it is at this rotation
                [rad].
            geometry: What the law takes the finger for; by default what it is.
        """

controller: _Controller

class _Part:
    @staticmethod
    def finger(
        name: str,
        *,
        lengths: Sequence[Number | Entry],
        radii: Sequence[Number | Entry],
        guides: Sequence[Sequence[Number] | Entry],
        at: Sequence[Number] | None = None,
        angle: Number | None = None,
        palm: Literal['below', 'above'] | None = None,
        on: str | None = None,
        masses: Sequence[Number] | None = None,
        density: Number | None = None,
        thickness: Number | None = None,
        springs: Entry | None = None,
        damping: Number | Sequence[Number] | None = None,
        limits: Number | Sequence[Number] | Sequence[Number | Sequence[Number]] | None = None,
        start: Number | Sequence[Number] | None = None,
        tendon: Entry | None = None,
        tendon_to: Sequence[Entry] | None = None,
        anchor: Sequence[Number] | None = None,
        material: str | None = None,
        plane: int | str | Sequence[int | str] | Literal['all'] | None = None,
    ) -> Entry:
        """A finger of ``n = len(lengths)`` phalanges, from the palm to the tip.

        Args:
            name: Its name, with which those of its elements begin: ``<name>.proximal``,
                ``<name>.mcp``, ``<name>.tendon``.
            at: The first hinge, in the world or in the frame of ``on`` [m].
            angle: Turn of the straight finger against the world, or against ``on`` [rad], counter-
                clockwise; 0 points along +x.
            palm: The side to which the finger closes, seen along the straight finger: its palm side
                is -y with ``below``, the whole finger is mirrored with ``above``.
            on: A body that serves as the palm; by default the finger has a fixed one of its own.
            lengths: Lengths of the phalanges [m], the proximal one first; the last reaches to the
                middle of the round tip.
            radii: Half the thickness of each phalanx [m].
            masses: Mass of each phalanx [kg]; either these or ``density``.
            density: Mass per volume of all phalanges [kg/m^3], instead of ``masses``.
            thickness: Depth across the plane [m], used with ``density`` only.
            guides: V_0 in the palm's frame, then V_1 ... V_n, each in its phalanx's frame [m].
            springs: Extensor springs over the backs of the hinges; none by default.
            damping: Viscous friction of the hinges [N m s/rad]; one for all or one each.
            limits: Highest rotation, or [lowest, highest], of each hinge [rad], closing counted
                positive; a single one stands for [0, it]. None by default.
            start: Rotations at t = 0 [rad], closing counted positive; one for all or one each.
            tendon: How much the finger's cord gives, and its friction.
            tendon_to: Further guides of the cord after V_0, on its way to what pulls it.
            anchor: Where the tendon ends when nothing else pulls it, in the palm's frame [m]; by
                default 15 mm behind V_0.
            material: Name of the phalanges' material, one of the scene's ``materials``.
            plane: Layer in which its bodies lie, as a body's ``plane``: fingers of different planes
                pass each other.
        """
    @staticmethod
    def rocker_tree(
        name: str,
        *,
        pulls: Sequence[str | Entry],
        shares: Sequence[Number] | None = None,
        direction: Number | None = None,
        pitch: Number | None = None,
        gap: Number | None = None,
        level: Number | None = None,
        travel: Number | None = None,
        mass: Number | None = None,
        stiffness: Number | None = None,
        damping: Number | None = None,
        radius: Number | None = None,
        links: Literal['tendon', 'rope'] | None = None,
    ) -> Entry:
        """Rockers on sliding pivots; a string at each end of a rocker.

        Args:
            name: Its name, with which those of its elements begin; a pull drive that names it pulls
                ``<name>.tendon``.
            pulls: Names of fingers, tendons or bodies, in the order in which they lie side by side.
            shares: Of the pull, one for each leaf in any measure; by default all equal.
            direction: Direction of the pull in the world [rad], counter-clockwise from +x; by
                default along -x.
            pitch: Between neighbouring strings, across the pull [m]; by default they lie as the
                leaves do. With it each string is led over two eyes of the tree's frame, ``gap``
                behind the rearmost leaf, from its leaf's line to its own, so that wheels and
                rockers may be smaller, or larger, than the leaves lie apart. Where leaves lie in
                one line along the pull it is ``travel`` by default.
            gap: From the rearmost leaf to the first level, along the pull [m]; where there are
                eyes, to them and once more from them to the first level.
            level: From one level to the next, along the pull [m].
            travel: How far every wheel or rocker can move along the pull from where it starts [m];
                there its slot ends.
            mass: Of each wheel or rocker [kg].
            stiffness: Tension per stretch of the strings [N/m]; the default stands for strings
                without stretch.
            damping: Tension per rate of stretch of the strings [N s/m].
            radius: Half the thickness of a rocker [m]; it is drawn with it, and its inertia follows
                from it.
            links: What ties the levels together: tendons, or the engine's own slide-joint ropes. A
                string that passes eyes is a tendon.
        """
    @staticmethod
    def pulley_tree(
        name: str,
        *,
        pulls: Sequence[str | Entry],
        shares: Sequence[Number] | None = None,
        direction: Number | None = None,
        pitch: Number | None = None,
        gap: Number | None = None,
        level: Number | None = None,
        travel: Number | None = None,
        mass: Number | None = None,
        stiffness: Number | None = None,
        damping: Number | None = None,
    ) -> Entry:
        """Wheels on sliding centres; strings wound on their rims, equations (1)-(7).

        Args:
            name: Its name, with which those of its elements begin; a pull drive that names it pulls
                ``<name>.tendon``.
            pulls: Names of fingers, tendons or bodies, in the order in which they lie side by side.
            shares: Of the pull, one for each leaf in any measure; by default all equal.
            direction: Direction of the pull in the world [rad], counter-clockwise from +x; by
                default along -x.
            pitch: Between neighbouring strings, across the pull [m]; by default they lie as the
                leaves do. With it each string is led over two eyes of the tree's frame, ``gap``
                behind the rearmost leaf, from its leaf's line to its own, so that wheels and
                rockers may be smaller, or larger, than the leaves lie apart. Where leaves lie in
                one line along the pull it is ``travel`` by default.
            gap: From the rearmost leaf to the first level, along the pull [m]; where there are
                eyes, to them and once more from them to the first level.
            level: From one level to the next, along the pull [m].
            travel: How far every wheel or rocker can move along the pull from where it starts [m];
                there its slot ends.
            mass: Of each wheel or rocker [kg].
            stiffness: Tension per stretch of the strings [N/m]; the default stands for strings
                without stretch.
            damping: Tension per rate of stretch of the strings [N s/m].
        """
    @staticmethod
    def section(
        name: str,
        *,
        circle: Number,
        at: Sequence[Number] | None = None,
        square: Number | None = None,
        rod: Number | Sequence[Number] | None = None,
        angle: Number | None = None,
        mass: Number | None = None,
        hold: Number | None = None,
        damping: Number | None = None,
        material: str | None = None,
        plane: int | str | Sequence[int | str] | Literal['all'] | None = None,
    ) -> Entry:
        """A fixed circle; with ``square``, also a square held out from its centre by a rod.

        Args:
            name: Its name, with which those of its elements begin: ``<name>.circle``,
                ``<name>.square``.
            at: Centre of the circle in the world [m].
            circle: Radius of the circle [m].
            square: Side of the square [m]; without it the section is the circle alone.
            rod: From the circle's centre to the square's [m]: a length, or [shortest, longest] of a
                telescope.
            angle: Direction in which the square starts, seen from the circle's centre [rad],
                counter-clockwise from +x.
            mass: Mass of the square [kg].
            hold: Stiffness of the weak springs that hold the square in its place, along the rod and
                across it [N/m].
            damping: Damping of the same springs [N s/m].
            material: Name of both bodies' material, one of the scene's ``materials``.
            plane: Layer in which its bodies lie, as a body's ``plane``.
        """
    @staticmethod
    def assembly(
        name: str,
        *,
        at: Sequence[Number] | None = None,
        angle: Number | None = None,
        mirror: Literal['left-right', 'up-down'] | None = None,
        scale: Number | None = None,
        materials: Mapping[str, Any] | None = None,
        bodies: Sequence[Entry] | None = None,
        joints: Sequence[Entry] | None = None,
        springs: Sequence[Entry] | None = None,
        tendons: Sequence[Entry] | None = None,
        lines: Sequence[Entry] | None = None,
        valves: Sequence[Entry] | None = None,
        loads: Sequence[Entry] | None = None,
        drives: Sequence[Entry] | None = None,
        controllers: Sequence[Entry] | None = None,
        events: Sequence[Entry] | None = None,
        contacts: Sequence[Entry] | None = None,
        groups: Sequence[Entry] | None = None,
        meters: Sequence[Entry] | None = None,
        parts: Sequence[Entry] | None = None,
    ) -> Entry:
        """Elements and parts in one piece: placed, turned, mirrored and scaled as one.

        They are written as in a scene, about an origin of their own. In the scene their names begin
        with the assembly's: its ``jaw`` is ``left.jaw``. A name that the assembly does not have is
        the scene's. It is scaled first, then mirrored, then turned, then moved.

        Args:
            name: Of the assembly; the names of its elements begin with it and a dot.
            at: Its origin, in the world or in the assembly that it is part of.
            angle: By which it is turned about its origin.
            mirror: Which sides change places, about its origin. Hinges then count the other turn as
                positive, so that their angles, stops and drives stay what they are.
            scale: Of all lengths in the plane, and of speeds; inertias by its square. Masses,
                stiffnesses, forces, areas of pistons and volumes stay as they are written, and so
                does ``thickness``.
            materials: Its own contact surfaces, by name.
            bodies: Its bodies.
            joints: Its joints; one of the two bodies may be the scene's.
            springs: Its springs.
            tendons: Its tendons.
            lines: Its lines of fluid.
            valves: Its valves.
            loads: Its loads. Their expressions, components and levels are of the world, however the
                assembly is turned.
            drives: Its drives.
            controllers: Its controllers. They read quantities as they are: in a mirror those of
                hinges stay the same, a body's ``x`` and ``angle`` do not.
            events: Its events.
            contacts: Rules among its bodies, and between them and the scene's; the scene's own come
                later.
            groups: Its groups. All its bodies together are a group of the assembly's name.
            meters: Its meters.
            parts: Its parts, assemblies among them.
        """

part: _Part

class _Signal:
    @staticmethod
    def ramp(
        *,
        to: Number,
        over: Number,
        from_: Number | None = None,
        start: Number | None = None,
    ) -> Entry:
        """Linear from ``from`` to ``to``, then held.

        Args:
            from_: Value before and at the beginning, in the unit of what is set.
            to: Value at the end and after it, in the unit of what is set.
            start: When the ramp begins [s].
            over: How long it takes [s]; 0 is a step.
        """
    @staticmethod
    def table(
        *,
        table: Sequence[Sequence[Number] | Entry],
        between: Literal['linear', 'step'] | None = None,
    ) -> Entry:
        """Points ``[t, value]`` in order of time, held before the first and after the last.

        Args:
            table: Points ``[t, value]``: times [s] that increase, and values in the unit of what is
                set.
            between: How values between two points follow: ``linear`` on the straight line, ``step``
                as at the point before.
        """
    @staticmethod
    def formula(
        *,
        expression: str,
    ) -> Entry:
        """An expression of the time ``t`` [s]; parameters are bound when it is read.

        Args:
            expression: An expression of ``t`` [s] and of parameters, such as ``"=pull * sin(2 * pi
                * t)"``.
        """
    @staticmethod
    def constant(
        *,
        constant: Number,
    ) -> Entry:
        """The same value at all times.

        Args:
            constant: The value, in the unit of what is set.
        """

signal: _Signal
