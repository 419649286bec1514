"""Where a message is explained: its family, by words that stay the same, and the family's page.

A family is a section of docs/messages.md. Its key here is the section's anchor, its value are
patterns of the words that all its messages have in common. The first family that fits has the
message, so that what is told of one kind of thing stands before what is told of any.
tests/test_messages.py holds the table against the page, and against what the sources can say.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache

FOLDER = "docs/"
"""Where pages are: in the repository. The site has the same names."""
MESSAGES = f"{FOLDER}messages.md"
ELEMENTS = f"{FOLDER}elements.md"
"""The page with the fields of every element."""
PARTS = f"{FOLDER}parts.md"
"""The page with the fields of every part."""
STUDIES = f"{FOLDER}sweeps.md#a-study-as-a-file"
SEARCHES = f"{FOLDER}searches.md#a-search-as-a-file"
MOST_TOLD = 3
"""Sections that one line names."""

FAMILIES: dict[str, tuple[str, ...]] = {
    # what stops a run or a command
    "a-fault-of-sandbox-itself": ("a fault of sandbox itself",),
    "interrupted": ("^interrupted", "the page was closed"),
    "the-simulation-diverged": (
        "the simulation diverged", "contacts at once", "hang together in so many loops",
        "this simulation ended"),
    "the-mechanism-jammed": ("the mechanism jammed",),
    "controller-act-at-t": (
        r"act\(\) at t = ", "are no controllers", "a controller's name is made",
        "^controllers?[ :]", "stopped with the verdict"),
    "needs-a-package": ("needs? .*(pip install|websockets)", "which is not installed"),
    "nothing-to-certify": (
        "nothing to certify", "an event may stop the run", "fewer than four steps"),
    # studies, sweeps, searches
    "a-worker-process-ended": ("a worker process", "worker processes are not begun"),
    "the-cluster-cannot-be-reached": ("the cluster", "has no workers", "has sandbox .*, here"),
    "another-process-is-at-these-runs": (
        "another process is at these runs", "another run is being written",
        "this line is no row of a sweep"),
    "the-same-at-both-ends-of-the-range": (
        "has no threshold at its ends", "of starts at one end", "a threshold is looked for",
        "the run tells nothing of whether", "a share of random starts", "a bracket is no narrower",
        "no run tells whether"),
    "no-run-has-an-answer": (
        "no run of .* (has an answer|meets all conditions)", "too few runs have an answer",
        "a run on the way has no values", "no run of those at the start",
        "measured numbers cannot tell"),
    "holds-no-measurements": (
        "holds no measurements", "has no column of times", "two columns of one name",
        "a row has no time", "cells under", "has no column ", "has more than .* bytes",
        ": .* is no number$", ": .* is not finite$", "say which file has what was measured",
        "the noise of", "no column of .* has the name", "has no number in",
        "numbers to be compared", "has times from", "has not the times and columns", ", row 1: "),
    "what-a-study-varies-and-keeps": (
        "the study ", "a study is", "the search does not say", "say what is varied",
        "is varied twice", "is given values twice", "a design ", "paired paths",
        "has a distribution", "does not say how many numbers", "has a count(,| of its own)",
        "distribution", "a log scale", "one number cannot be at both ends",
        "there is nothing to vary", "there are no values", "has too many parts",
        "lies from '…' to", "takes no more than",
        "of the form path=values", "is another column of the table", "two results have the name",
        "quantities of each run would be kept", "whole recordings need", "a seed is a number",
        "is a study file", "says this itself", "shape parameters", "a .* needs a count"),
    "what-a-search-asks": (
        "a search does not vary", "is no condition", "no run keeps",
        "a fit varies", "say what is kept", "what matters is asked", "[Ss]obol's points",
        "the count is 4 or more", "say what is to be least or most", "cannot be least and most",
        "there is no (method|sampler|search) ", "cmaes looks", "the scene expects nothing: say",
        "does not say which search", "[Ss]ay which search", "of the form name=value",
        "There is no search"),
    # files and directories
    "the-run-is-damaged": (
        "is damaged", "is not a recording", "are of different runs", "this version reads up to",
        "its directory claims", "it is no object"),
    "there-is-no-run-in": (
        "there is no (run|recording) in", "there is no directory", "the run .* is given twice",
        "there is no run to show", "a page shows up to", "at least 2 are needed"),
    "cannot-write": (
        "cannot write", "is no place for", "cannot make a temporary", "is not overwritten",
        "it is a directory",
        "^(?!.*cannot (be )?read).*(No space left|Permission denied|Read-only|File name too long"
        "|Is a directory|Not a directory|File exists)"),
    "there-is-no-scene-beside-this-one": (
        "there is no scene .* beside this one", "is the name of a scene, not", "includes a scene",
        "a scene that includes itself", "to include from", "is not the name of a scene in",
        "leads out of this scene's folder", "is no file that holds a scene",
        "the included scene has no parameter"),
    "larger-than-the-limit": (
        "limit '", "are no limits", "nested (too deeply|deeper)", "too many brackets",
        "no more than .* are looked into", "copies are more than",
        "stopped at t = .* recorded until then", "not enough memory", "no room for .* GB"),
    "a-drawing-without-an-outline": (
        "drawing", "outlines? is open", "an outline at .* has no area", "holds no outline",
        "outlines that are not one in the other", "neither an SVG nor a DXF", "has no layer",
        "has no id", "does not say its unit", "which is not followed", "its curves have more than",
        "a curve has more than", "in the scene's folder", "the scene's own folder",
        "is empty, or no file"),
    "there-is-no-such-file": (
        "No such file or directory", "no such file", "there is no file", "this is a directory",
        "the file cannot be read", "no shipped scene", "cannot read", "is no scene$",
        "cannot be read(:| as)"),
    "the-file-is-not-json": (
        "is not JSON", "is not a JSON number", "a second time", "half a character",
        "the file is (empty|not UTF-8|UTF-16)", "duplicate key", "more text after",
        "JSON has no comments", "the file ends inside", "a key in double quotes",
        "expected ':' after", "text stands in double quotes", "a comma", "unknown escape",
        "a (scene|study) is an object", "not Unicode", "a key is text"),
    "this-scene-has-format": ("this scene has format",),
    # quantities of a run
    "unknown-quantity": (
        "unknown quantity", "cannot be read while it runs", "no quantity (is|matches)",
        "has the quantity", "is no quantity", "is not the name of a quantity",
        "is a pattern, and one quantity", "is an expression$", "fits quantities of",
        r"\bmeters depend on each other", "for one meter", "curves of one meter",
        "asks how .* is held", "divides in an expression"),
    "no-sample-in-this-time": (
        "is not within the run", "no window of time", "has more than one '", "the run lasts",
        "is not after the beginning", "a plot needs", "a figure needs", "no samples",
        "fewer than 2 samples", "there is no statistic", "has no name$",
        "the (window|instant) (is|ends)"),
    "not-all-expectations-hold": ("expectations hold",),
    # tendons, springs, drives, control
    "has-no-stiffness-to-set": (
        "no stiffness to set", "the stiffness of .* cannot be set", "a stiffness drive",
        "only a circle has a radius", "has no shape ", ", and '.*' acts on",
        "which cannot be let go", "may be let go", "let go, they are never",
        "does not set the stiffness", "cannot reckon with", "resists nothing at the guard",
        "does not run straight"),
    "guides-that-coincide": (
        "its guides? ", "the wheels? of its guide", "which has no end to pull at", "a loop round",
        "cannot begin off its wheel", "begins off its wheel", "turns no wheel", "crosses itself",
        "does nothing: ", "do nothing: ", "is shorter than its path", "a pretension of",
        "a cord has a pretension", "passes no body"),
    "does-not-mesh": (
        "does not mesh", "its teeth lie in one another", "its pitch line", "no joint holds",
        "only springs or cords hold", "have two radii", "its centres are .* its circles touch"),
    "not-assembled": ("not assembled at t = 0", "starts at .* outside its limits"),
    "hold-more-than-can-move": (
        "hold more than can move", "which statics does not decide", "neither .* can move freely"),
    "overlaps": ("overlaps? .*at t = 0",),
    "too-stiff-for-the-step": (
        "stiff for the step", "the damper is too strong", "rings at", "masses are 1 : ",
        "does not divide the sampling", "is shorter than a step"),
    "snaps-over-the-centre": ("snaps over the centre", "its ends coincide", "its law has no value"),
    "is-set-already": (
        "is (set|written|pulled) already", "which would set it again", "is set by",
        "sets? it again"),
    "a-motor-needs": (
        "motor", "'…' goes with '…'$", "does not go with", "asks .* (its limits|it is .* long)",
        "stops are at"),
    "an-algebraic-loop": ("an algebraic loop", "a controller's target"),
    "hz-is-no-whole-number-of-steps": ("Hz is (no whole number|more often)", "as a rate this is"),
    "this-event-can-never-happen": (
        "this event can never happen", "reads nothing, so it never", "needs something that was",
        "give either '…' or '…'$", "is let go and taken up by one",
        "is for '…', not for", "which nothing lets go", "released from the start", "is 0 or 1"),
    "can-hardly-act": (
        "acts on .*cannot move", "no surface that", "moves no body", "does not move freely",
        "(?<!nothing )moves freely$", "is pumped", "has no area that a liquid",
        "no body lies in the window", "after the end of the run", "it jumps there",
        "which cannot move freely", "nearest object", "nothing any more"),
    "fluid-in-lines": (
        "the (least |most )?pressure", "relief", "a gas has", "no gas in", "a valve ",
        "its volume at t = 0", "a displacement of 0", "its cylinder", "a liquid lifts"),
    # commands, pictures
    "it-does-not-come-to-rest": (
        "come to rest", "is given twice; several", "rest has no time", "along a value",
        "values is no range", "stiffness can't be told", "at the start", "stages are not",
        "can't go with", "there is no --along", "PATH=FROM:TO:COUNT", "PATH=VALUE", "combinations"),
    "nothing-touches": ("nothing touches", "bodies with the role"),
    "outside-of-what-mechanics-allows": ("outside of what mechanics allows",),
    "mujoco-has-no-counterpart": ("MuJoCo has no counterpart", "no format to export"),
    "cannot-listen-on-port": ("cannot listen on port",),
    "no-picture-can-be-drawn": (
        "too many for one", "no (film|picture) can have", "a strip", "figure",
        "asks for .* which no .* has", "asks for paper", "panels", "is not of the form WIDTH",
        "does not end in", "pixels", "a picture on paper", "no runs? has both",
        "name the quantities", "say what to compare", "--with, --x", "a page is an .html",
        "--format says"),
    # words of a scene
    "unknown-key": ("unknown key",),
    "unknown-type": ("unknown type",),
    "cannot-set": (
        "cannot set ", "nothing in .* is named", "has no entry ", "there is no list",
        "of the form path=value", "the whole scene cannot be replaced", "has no .* in it",
        "the scene has no ", "not the text of a path", "what to replace", "there is nothing named",
        "is not a path such as"),
    "templates-and-repeats": (
        "is the name of a template", "templates? ", "a repeat has", "copies", "a line or circle",
        "line or on a circle", "lies nowhere by itself", "an index", "the index"),
    "the-name-is-taken": (
        "the name .* (is|also)", "is not a name", "parameter's name", "is a parameter,",
        "a table's name", "reads parameters itself", "another controller has this name",
        "the name of another element", "that a scene can use"),
    "there-is-no-body-named": (
        "there is no .* named", "is no body$",
        r"no (body|finger|tendon|part|material|joint)\b.*named", "no body's name matches",
        "no body has the role",
        "there is no (template|option|element|layer|case|parameter|export format)",
        "no body of this assembly"),
    "is-missing": ("is missing",),
    "unknown-unit": (
        "unknown unit", "is a unit of", "is not a number with a unit", "are two units",
        "has (the|no) unit", "these are a ", "is in .*, and", "takes no unit"),
    "expected-one-thing-got-another": (
        "expected ", "a finger of .* phalanges", "at most .* characters", "is not a number"),
    "is-not-an-expression": (
        "is not an expression", "parameters (that )?depend", "has no place in",
        "unknown (function|name)", "^an expression ", "the expression is", "cannot be computed: ",
        "has no finite value", "the function ", "inside an expression", "number of the expression",
        "an exponent is", "which an expression cannot", "cannot be computed with$"),
    "a-table-of-values": ("table", "the x of a", "points .* are too close", "path with a"),
    "an-outline-that-crosses-itself": (
        "outline", "a polyline has no area", "corners", "the same point", "cam ", "the lift",
        "the angles of", "the radius of the roller", "hole", "triangles cover"),
    "there-is-nothing-to-simulate": ("there is nothing to simulate", "nothing moves freely"),
    "this-part-cannot-be-built": ("this part cannot be built", "for every leaf", "is a length or"),
    "must-be-greater-than": (
        "must (not )?be", "outside of .* to ", "is no value for", "has to be less than",
        "is larger than", "too (large|small) to be computed", "is too (large|small)",
        "too large a number", "is not greater than 0", "is nowhere near", "so large or so small",
        "is no direction", "as a direction", r"\[lowest, highest\]", "at t = .* s$",
        "shortest side", "is no finite number"),
    "give-either-not-both": (
        "not both", "give (exactly )?one of", "give (a )?'", "belong together", "has either",
        'is for "', "needs ('|a )", "says at least one", "nothing to act with", "is where a",
        "without shapes needs", "multiple of friction"),
    "is-not-allowed-here": (
        "is not allowed here", "is no (colour|plane|layer|format)", "names no layers", "no plane$",
        "is shown for all bodies", "does not say of what"),
    # what click says
    "no-such-option": (
        "No such (option|command)", "Missing (argument|option)", "Invalid value", "Got unexpected",
        "does not take a value", "requires an argument", "is not one of", "is not of the form",
        "is not a valid", "is named", "path is empty", "is not in the range"),
}
"""Anchors of docs/messages.md, and the words by which a message belongs there."""

_NAMES = re.compile(r"(?<!\w)'[^']*'(?!\w)|\S+/\S+\.\w+")
"""What stands in quotes is the author's, as files are, and says nothing of the family."""


@cache
def _words() -> dict[str, re.Pattern[str]]:
    """The patterns of each family as one, made when the first message is told."""
    return {anchor: re.compile("|".join(patterns)) for anchor, patterns in FAMILIES.items()}


def family_of(message: str) -> str:
    """The anchor of what explains a message; ``""`` if nothing does."""
    plain = _NAMES.sub("'…'", message)
    return next((anchor for anchor, words in _words().items() if words.search(plain)), "")


def page_of(message: str, allowed: str = "") -> str:
    """Where a message is explained, as ``docs/messages.md#unknown-key``; ``""`` if nowhere.

    Args:
        message: what is wrong.
        allowed: what would be right: of what is beyond a limit this alone says so.
    """
    anchor = family_of("the limit '" if "the limit '" in allowed else message)
    return f"{MESSAGES}#{anchor}" if anchor else ""


def read_on(pages: Iterable[str], fields: Iterable[str] = ()) -> list[str]:
    """A line that says where to read on, or none.

    Args:
        pages: what explains each of the messages.
        fields: what has the fields of each of the elements.
    """
    told, named = (list(filter(None, dict.fromkeys(each))) for each in (pages, fields))
    pieces = []
    if told:
        others = f", {MESSAGES} the others" if len(told) > MOST_TOLD else ""
        pieces.append(f"{', '.join(told[:MOST_TOLD])} "
                      f"{'explains it' if len(told) == 1 else 'explain them'}{others}")
    if named:
        pieces.append(f"{', '.join(named[:MOST_TOLD])} {'has' if len(named) == 1 else 'have'} "
                      "the fields")
    return ["; ".join(pieces)] if pieces else []
