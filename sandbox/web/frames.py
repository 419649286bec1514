"""The display list of a live view, and its frames.

A frame is float32 numbers: :data:`HEAD`, x, y and angle of each frame of the list, its columns, the
values of the drives, the watched quantities, the number of rows of each table, the rows, then, for
each trail in the list, the places of its point since the last frame, x and y in turn. Contact
forces are means over the steps since the last frame: those of a single step flicker.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from sandbox.elements.arrays import ARRAYS, CONTACT, STATIC, Arrays
from sandbox.engine.inspect_control import Checked
from sandbox.engine.live import Live
from sandbox.engine.simulation import Simulation
from sandbox.errors import SceneError, SimulationDiverged
from sandbox.model.catalogue import PAIR, UnknownQuantityError
from sandbox.model.compile import compile_mechanism
from sandbox.model.joints import placed
from sandbox.numeric import Array
from sandbox.picture.build import ELEMENTS, RAMPS, add_legend
from sandbox.picture.listing import Item, Listing, SomeSamples
from sandbox.picture.scales import bars_of, tensions_of
from sandbox.picture.subject import Subject, visible_layers
from sandbox.recording.recording import Recording
from sandbox.samples.contacts import on_the_other
from sandbox.scene.layers import LAYERS, shown
from sandbox.web.drawing import all_layers, drawing, expressions_of, listed, meters_of, page_list

HEAD = ("seq", "ack", "t", "rate", "hand", "from_x", "from_y", "force_x", "force_y", "trail")
"""The first numbers of a frame: its number; the last message that it answers; the time [s];
seconds of motion per second; the body that is held, or -1; the place [m] and the force [N]; the
number of places of each trail."""
TRAIL = 8  # maximum number of places of a trail in a frame
LOOK = 2.0  # seconds of the trial run that gives the picture its scales
MAX_PAIRS = 200  # pairs of bodies that are suggested; any can be watched
AT_ONCE = 4  # steps between two looks at the clock
_OF_DRIVES = [each.name for each in ARRAYS if "nd" in each.axes]


def looked_at(scene: Checked, seconds: float = LOOK) -> Recording:
    """A trial run of the scene, as far as the time allows: it gives the picture its scales."""
    simulation, began = Simulation(scene), time.perf_counter()
    every = round(1 / (scene.mechanism.run.sample_rate * scene.mechanism.run.step))
    with suppress(SimulationDiverged):
        while not simulation.finished and (
                simulation.steps < 2 * every or time.perf_counter() - began < seconds):
            simulation.step(AT_ONCE)
    return simulation.recording()


class LiveFrames:
    """Frames of one run; ``look`` is a trial run of the scene."""

    def __init__(self, live: Live, look: Recording) -> None:
        self.live, self.look, view = live, look, live.scene.view
        self.layers = set(shown(view.show, traced=bool(view.traces)))
        """Layers that are shown."""
        self._shown: set[str] | None = None  # those of the last frame
        self.watched: list[str] = []  # quantities in the frames
        self.units = {name: live.unit(name) for name in live.names()}
        """Quantities that frames can have, with their units."""
        self.left_out: list[str] = []
        """Reasons why meters of the scene's view are left out, a line each."""
        self.meters = list(self._own_meters())  # the other meters
        self._model = compile_mechanism(live.scene)
        self._on_other: dict[int, bool] = {}
        """By pair of bodies that have touched: whether the force is shown on the second."""
        self._full, self._box = listed(look, live=True)
        self._subject, self._scale = self._full, self._full.carried
        self._still: dict[Callable[[Subject], None], tuple[list[Item], list[Any]]] = {}
        """Items and keys of elements without columns, tables or frames."""
        self._items = list[Item]()  # as they are listed
        self._sent: tuple[list[Item], list[Item]] = [], []  # items and legend of the page
        self._steps = 0  # number of steps up to the last frame
        self._travel = np.zeros(len(live.scene.drives))
        """The integral of each drive's value over these: the travel of surfaces."""
        if not live.steps:
            live.step()  # before the first step there is no sample
        self._update()

    def _own_meters(self) -> Iterator[dict[str, Any]]:
        view, worked = self.live.scene.view, expressions_of(self.live.scene.view)
        for meter in meters_of(view, self.look.catalogue):
            wrong = dict[str, str]()  # why it cannot be read during a run, by name
            for name in meter["names"]:
                try:
                    self.live[name]
                except SceneError as error:
                    wrong[name] = error.problems[0].message
                except UnknownQuantityError as error:
                    wrong[name] = str(error)
            names = [name for name in meter["names"] if name not in wrong]
            part = "a curve of a meter" if names else "a meter"
            self.left_out += [f"{part} of the view is left out: {why}"
                              for why in dict.fromkeys(wrong.values())]
            self.units |= {name: worked[name] if name in worked else self.live.unit(name)
                           for name in names}
            if names:
                yield {**meter, "names": names}

    def _pairs(self) -> dict[str, str]:
        """Quantities of the pairs of bodies that touched in the trial run, with their units."""
        arrays, bodies = self.look.arrays, self.live.scene.bodies
        pairs = np.unique(np.sort(np.stack(
            (arrays["contact_body"], arrays["contact_other"]), axis=1), axis=1), axis=0)
        named = ((bodies[b].name, bodies[a].name) if bodies[a].motion == "fixed" else
                 (bodies[a].name, bodies[b].name) for a, b in pairs[:MAX_PAIRS].tolist())
        return {f"{one}/{other}.{quantity}": unit for one, other in named
                for quantity, unit in PAIR.items()}

    def drawing(self) -> dict[str, Any]:
        """Data that a ``Stage`` needs before the first frame."""
        return {**drawing(self.look, self._subject, self._box, live=True), **self._list(),
                "head": list(HEAD), "drives": len(self.live.scene.drives),
                "meters": self.meters, "units": {
                    **{name: self.units[name] for name in self.look.catalogue.telling
                       if name in self.units}, **self.units, **self._pairs()}}

    def _list(self) -> dict[str, Any]:
        self._sent = self._subject.out.items, self._subject.out.legend
        return page_list(self._subject.out)

    def relisted(self) -> dict[str, Any] | None:
        """The display list if it has other items than the page knows, else None."""
        self._update()
        out = self._subject.out
        return None if (out.items, out.legend) == self._sent else self._list()

    def frame(self, numbers: Sequence[float]) -> bytes:
        """The present instant, after :meth:`relisted`; ``numbers`` of HEAD but ``trail``."""
        out = self._subject.out
        last = len(out.time) - 1
        tables = [rows[rows[:, 0] == last] for rows in out.tables.values()]
        return np.concatenate([
            numbers, [self._trail.shape[1]], out.pose[-1].ravel(),
            [column[-1] for column in out.columns], self._drives,
            [self.live[name] for name in self.watched],
            [len(rows) for rows in tables], *(rows.ravel() for rows in tables),
            self._trail.ravel()]).astype("<f4").tobytes()

    def _update(self) -> None:
        """List the last samples, if there are new ones or other layers."""
        if self._steps and self.live.steps == self._steps and self.layers == self._shown:
            return
        drives = len(self.live.scene.drives)
        arrays = self.live.latest()
        for name in _OF_DRIVES:
            arrays[name] = arrays[name][:, :drives]
        start = max(len(arrays["time"]) - 2, 0)  # the last two samples
        late = arrays["contact_sample"] >= start
        few = {name: array if name in STATIC else array[late] if name in CONTACT
               else array[start:] for name, array in arrays.items()}
        few["contact_sample"] = few["contact_sample"] - start
        first = max(len(arrays["time"]) - (self.live.steps - self._steps), 0)
        self._travel += self.live.scene.run.step * arrays["drive_value"][first:].sum(axis=0)
        few["drive_travel"] = np.tile(self._travel, (len(few["time"]), 1))
        self._subject = self._listed(
            SomeSamples(self.live.scene, self._model, few, few["time"]))
        if "contacts" in self._subject.out.tables:
            self._subject.out.tables["contacts"] = self._mean_contacts(arrays, len(few["time"]) - 1)
        self._drives = few["drive_value"][-1]
        self._trail = self._places(arrays)
        self._steps, self._shown = self.live.steps, self.layers

    def _listed(self, run: SomeSamples) -> Subject:
        """The display list of some samples, on the scales of the trial run."""
        before, look = self._subject, self.look
        out = Listing.of(run.time, run.arrays["body_pose"], fixed_columns=True)
        out.ramps = RAMPS
        if self.layers != self._shown:
            view = all_layers(look.mechanism.view)
            view = view.model_copy(update={"show": {
                name: view.show.get(name, ()) if name in self.layers else () for name in LAYERS}})
            before = replace(self._full, view=view, layers=visible_layers(look, view), out=out,
                             beside=(look,), arrows={}, trace_ink="", signs=set())
            self._scale = tensions_of(look, bars_of(look, before.layers.get("bars", ())))
            self._items, self._still = [], {}
        else:
            out.share_styles(before.out)
        carried = tensions_of(run, bars_of(run, before.layers.get("bars", ())))
        self._scale, old = carried.beside([self._scale]), self._scale.largest  # it only grows
        s = replace(before, run=run, out=out, keys=[], carried=self._scale
                    if "tensions" in before.layers else self._scale.hidden())
        for add in ELEMENTS:
            count, sizes = len(out.items), out.sizes
            if known := self._still.get(add):
                out.items += known[0]
                s.keys += known[1]
            else:
                add(s)
                if out.sizes == sizes and len(out.items) > count:
                    self._still[add] = out.items[count:], s.keys[count:]
        if out.items == self._items and self._scale.largest == old:  # the order may differ
            out.items, out.legend = before.out.items, before.out.legend
        else:
            self._items = out.items
            add_legend(s, self._scale)
            s.close()
        return s

    def _places(self, arrays: Arrays) -> Array:
        """Places of the point of each trail since the last frame, [trails, m, 2] m."""
        points = [item["at"] for item in self._subject.out.items if item["k"] == "trail"]
        new = min(self.live.steps - self._steps, len(arrays["time"]))
        some = np.unique(np.linspace(-new, -1, TRAIL).round().astype(int)) if new > 0 else [-1]
        found = [placed(arrays["body_pose"][some, body], np.array([x, y])) for body, x, y in points]
        return np.array(found).reshape(len(found), len(some), 2)

    def _mean_contacts(self, arrays: Arrays, sample: int) -> Array:
        """The table of contacts: the mean force of each pair, at its mean place weighted by it."""
        bodies = len(self.live.scene.bodies)
        keys, which = np.unique(arrays["contact_body"] * bodies + arrays["contact_other"],
                                return_inverse=True)
        one, other = np.divmod(keys, bodies)

        def summed(values: Array) -> Array:
            return np.asarray(np.bincount(which, values, minlength=len(keys)))

        (x, y), (fx, fy) = arrays["contact_point"].T, arrays["contact_force"].T
        weight = np.hypot(fx, fy) + 1e-300
        total, samples = summed(weight), len(arrays["time"])
        # by the motion of bodies in the trial run, so that no arrow turns round
        known = self._on_other
        new = [k for k, key in enumerate(keys.tolist()) if key not in known]
        if new:
            found = on_the_other(self._model, self.look.arrays, one[new], other[new])
            known.update(zip(keys[new].tolist(), found.tolist(), strict=True))
        swapped = np.array([known[key] for key in keys.tolist()], dtype=bool)
        sign = np.where(swapped, -1.0, 1.0) / samples
        return np.column_stack([
            np.full(len(keys), sample), np.where(swapped, other * bodies + one, keys),
            summed(x * weight) / total, summed(y * weight) / total, sign * summed(fx),
            sign * summed(fy)])
