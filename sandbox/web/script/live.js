// The live view of a session: messages are JSON, or the bytes of a frame.

const KEPT = 1500;                                        // frames that plots of watched quantities show
const STILL = 1e-4;                                       // of a value: less is not spread over a plot, as frames are float32
const WAY = 20000;
const PULLING = "Drag a body to pull it: the longer the line, the stronger. Drag beside bodies to move the picture, wheel "
  + "or two fingers zoom, double click fits. Click a body, tendon or spring for its meter.";

class Live extends Viewer {
  constructor(root) {
    super(PULLING, [["space", "run or pause", { " ": () => this.toggle() }],
      ["right, left", "one frame on or back", { ArrowRight: () => this.ask({ do: "step" }), ArrowLeft: () => this.ask({ do: "back" }) }],
      ["r", "from the beginning", { r: () => this.ask({ do: "reset" }) }]]);
    const socket = new WebSocket(location.href.replace(/^http/, "ws").replace(/[?#].*/, ""));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => { if (typeof data === "string") this.receive(JSON.parse(data)); else this.take(data); };
    socket.onclose = () => { if (this.head) this.tell("the view has ended; start it again, and open the address that it says", true, this.state); };
    this.link = { send: (text) => { if (socket.readyState === 1) socket.send(text); } };
    Object.assign(this, { ids: 0, answered: 0, drawn: 0, asked: false, frame: null, ways: new Map(), instants: [], waiting: new Map(), working: false,
                          plots: [], time: [], rows: new Map() });   // samples of watched quantities, rows by name
    const list = (id, ariaLabel) => el("ul", { id, className: "warned", ariaLabel, hidden: true });
    this.title = el("h1");
    this.state = el("output", { id: "state" }); this.said = el("output", { id: "said" });   // state of the run; result of the last action
    this.warned = list("warned", "warnings of the scene check");
    this.absent = list("absent", "meters that are left out");
    this.sheet = el("div", { className: "sheet" });
    this.sheets.append(this.sheet);
    this.layers = el("div");
    this.meters = el("div", { className: "plots" });
    const side = el("section", { className: "plots", ariaLabel: "controls and meters" });
    this.controls = new Controls((name, value) => this.set(name, value));
    const search = finder("show a quantity", () => [...this.units.keys()],
                          (names, text) => this.watch(names.length ? names : [text]));   // the answer says why not
    side.append(this.controls.box, search, this.absent, this.meters);
    root.replaceChildren(this.title, el("div", { className: "top" }, el("section", { className: "bench", ariaLabel: "motion" },
      this.sheets, this.bar(), this.tools(), this.layers, this.warned), side),
      el("div", { className: "messages" }, this.state, this.said), this.tip, this.help);
  }
  bar() {
    this.pace = el("output", { id: "pace" });
    return el("div", { className: "bar" }, this.play,
      button("back", "\u25c0|", "one frame back (left)", () => this.ask({ do: "back" })),
      button("step", "|\u25b6", "one frame on (right)", () => this.ask({ do: "step" })),
      button("reset", "reset", "from the beginning (r)", () => this.ask({ do: "reset" })),
      this.speeds, this.clock, this.pace);
  }
  tools() {
    return super.tools(
      button("save-run", "save run", "run it again with your actions, and save the run", () => this.ask({ save: "run" })),
      button("save-scene", "save scene", "save a scene that repeats what you did", () => this.ask({ save: "scene" })));
  }
  get stages() { return this.stage ? [this.stage] : []; }
  get t() { return this.frame.t; }

  // -- messages --------------------------------------------------------------------------------
  receive(message) {
    if (message.head) this.begin(message.head);
    if (message.relisted) this.relisted = message.relisted;   // from the next frame on
    if (message.status) this.status(message.status);
    if (message.controls) this.controls.show(message.controls);
    if (message.given) this.controls.given(message.given);
    if (message.watched) this.showMeters(message.watched);
    if ("working" in message) this.busy(message.working);
    if (message.said) this.tell(message.said);
    if (message.error) this.tell(message.error, true);
    if (message.text) save(new Blob([message.text], { type: "application/json" }), fileName(message.file));
  }
  begin(head) {                                           // a scene, perhaps another one than before
    const old = this.stage;
    this.head = head;
    this.title.textContent = document.title = head.title;
    const stage = this.stage = new Stage(head, "drag a body to pull it");
    stage.extra.push((s) => this.drawHand(s));
    if (old) {                        // keep the camera and the body that it follows
      Object.assign(stage, { zoom: old.zoom, pan: old.pan, layers: old.layers });
      const { name } = old.head.bodies[old.follow] || {};
      if (head.view.follow === old.head.view.follow) stage.follow = head.bodies.findIndex((b) => b.name === name);
    }
    this.units = new Map(Object.entries(head.units));
    this.camera(stage, this.units, (name) => this.lastText(name));
    Object.assign(this, { instants: [], ways: new Map(), frame: null, held: null, relisted: null });
    for (const row of this.samples()) row.length = 0;
    this.layers.replaceChildren(this.layerBoxes(() => this.layersChosen()));
    this.layersChosen();
    this.followable();
    this.controls.show(head.controls);
    this.showMeters(head.watched.map((name) => ({ name, unit: this.units.get(name) })));
  }
  status({ playing, trouble, note, speed, warnings, left_out: leftOut }) {
    this.playing = playing;
    this.offerSpeed(speed);
    this.tell(trouble || note, !!trouble, this.state);
    for (const [box, lines] of [[this.warned, warnings], [this.absent, leftOut]]) {
      box.replaceChildren(...lines.map((text) => el("li", { textContent: text })));
      box.hidden = !lines.length;
    }
  }
  busy(working) {
    this.working = working;
    this.pace.textContent = working ? "working\u2026" : "";
    this.pace.className = working ? "working" : "";
    this.sheet.ariaBusy = String(working);
  }
  tell(text, bad = false, box = this.said) {
    box.textContent = text;
    box.classList.toggle("bad", bad);
  }

  // -- frames --------------------------------------------------------------------------------------
  take(buffer) {
    const { head } = this, numbers = new Float32Array(buffer);
    if (this.relisted) {                                  // other items than before, such as those of another layer
      Object.assign(head, this.relisted);
      this.stage.list = head.list;
      this.relisted = null;
    }
    let i = head.head.length;
    const f = Object.fromEntries(head.head.map((name, k) => [name, numbers[k]]));
    const take = (count) => numbers.subarray(i, i += count);
    f.pose = take(3 * head.frames); f.values = take(head.columns); f.drives = take(head.drives);
    const values = take(this.rows.size), names = Object.keys(head.tables), counts = take(names.length);
    f.tables = Object.fromEntries(names.map((name, k) => [name, Array.from({ length: counts[k] }, () => [...take(head.tables[name])])]));
    f.places = numbers.subarray(i);
    const last = this.frame, passed = last ? f.t - last.t : 0;
    if (passed < 0) this.wentBack(f.t);
    this.trace(f);
    if (!last || passed !== 0) this.keep(f.t, values);
    this.frame = f;
    this.redraw();
  }
  wentBack(t) {                                           // nothing is known from then on
    const count = (times) => times.findLastIndex((one) => one < t) + 1, kept = count(this.time);
    for (const row of this.samples()) row.length = kept;
    this.instants.length = count(this.instants);
    for (const way of this.ways.values()) way.length = Math.min(way.length, 2 * this.instants.length);
  }
  trace(f) {                                              // with what lay between two frames
    const { frame: last, instants } = this, m = f.trail, since = last && last.t < f.t ? last.t : f.t;
    const trails = this.head.list.items.filter((item) => item.k === "trail");
    if (trails.length) for (let k = 1; k <= m; k++) instants.push(since + (f.t - since) * k / m);
    trails.forEach((item, w) => {
      const key = item.at.join(), way = this.ways.get(key) || [];
      while (way.length < 2 * (instants.length - m)) way.push(f.places[2 * m * w], f.places[2 * m * w + 1]);
      way.push(...f.places.subarray(2 * m * w, 2 * m * (w + 1)));
      this.ways.set(key, way);
    });
    if (instants.length > WAY) {
      instants.splice(0, WAY / 2);
      for (const way of this.ways.values()) way.splice(0, WAY);
    }
    f.trail = (item) => ({ way: this.ways.get(item.at.join()) || [], times: instants, count: instants.length });
  }
  layersChosen() { this.send({ layers: [...this.stage.layers] }); this.redraw(); }
  redraw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.paint());
  }
  paint() {
    this.asked = false;
    const f = this.frame;
    if (!f) return;
    if (!this.stage.canvas.isConnected) this.sheet.replaceChildren(this.stage.canvas);   // the old picture stays until now
    Object.assign(this.stage, { stamp: `t = ${f.t.toFixed(2)} s`, moving: this.playing });
    this.stage.draw(f);
    this.clock.textContent = `${f.t.toFixed(3)} s`;
    const slow = this.playing && f.rate < 0.9 * +this.speeds.value && f.t > 0.5;
    if (!this.working) this.pace.textContent = slow ? `${f.rate.toFixed(2)} \u00d7 real time` : "";
    this.controls.follow(f.drives);
    if (this.filming) this.filming.frame();
    this.drawn++;
    if (!this.playing || this.drawn % 3 === 0) {
      for (const made of this.plots) {
        made.set(this.time, made.rows());
        made.at(f.t);
      }
    }
    this.answered = f.ack;
    this.setNext();
    if (f.seq !== this.shown) { this.shown = f.seq; this.link.send(`{"seen":${f.seq}}`); }
  }
  drawHand(s) {
    const f = this.frame;
    if (!f || f.hand < 0 || !this.held) return;
    const from = s.px(f.from_x, f.from_y), to = s.px(...this.held.to), colour = s.ink("drive");
    polyline(s.pen(null, colour, 1.6 * s.u, 5 * s.u), [from, to]);
    s.dot(from, 3.2 * s.u, colour); s.dot(to, 4.5 * s.u, null, colour);
    s.words.push({ text: `${+Math.hypot(f.force_x, f.force_y).toPrecision(2)} N`, tip: to, side: to[0] < from[0] ? 4 : 0, rank: -1, ink: colour, clear: 4 });
  }

  // -- requests -----------------------------------------------------------------------------------
  ask(what) {                                             // a new action clears the message of the last one
    this.tell("");
    this.send(what);
  }
  send(what) { this.link.send(JSON.stringify({ ...what, id: ++this.ids })); }
  set(name, value) { this.waiting.set(name, value); this.setNext(); }
  setNext() {                                             // one request at a time: the next goes when its frame is drawn
    const [next] = this.waiting;
    if (!next || this.setting > this.answered) return;
    this.waiting.delete(next[0]);
    this.ask({ set: next[0], value: next[1] });
    this.setting = this.ids;
  }
  toggle() { this.ask({ do: this.playing ? "pause" : "run" }); }
  grab(pick, x, y) {
    const { stage, head } = this, under = this.frame && stage.pick(x, y, (b) => b >= 0 && b < head.bodies.length && !head.bodies[b].fixed);
    if (!under) return null;
    const body = head.bodies[under.f].name, [bx, by, angle] = stage.pose.slice(3 * under.f), [wx, wy] = stage.world(x, y);
    const at = turned([wx - bx, wy - by], -angle);
    let moved = 0, was = [x, y];
    this.tip.hidden = true;
    return {
      move: (mx, my) => {
        moved += apart(was, [mx, my]); was = [mx, my];
        if (moved <= 3) return;
        this.held = { body, to: stage.world(mx, my) };
        this.ask({ drag: [body, ...at], to: this.held.to });
        this.redraw();
      },
      drop: () => {
        if (this.held) { this.held = null; this.send({ drop: 1 }); } else this.click(pick);
        this.redraw();
      },
    };
  }
  click(pick) { if (pick) this.watch(quantitiesOf(pick, this.units).slice(0, 2)); }
  setSpeed(speed) { this.ask({ speed }); }

  // -- meters: plots of watched quantities over the last KEPT frames -----------------------------------
  watch(names) { this.ask({ watch: [...new Set([...this.rows.keys(), ...names])] }); }
  samples() { return [this.time, ...this.rows.values()]; }
  keep(t, values) {
    const rows = this.samples();
    [t, ...values].forEach((v, k) => rows[k].push(Number.isFinite(v) ? v : null));
    if (this.time.length > KEPT + 300) for (const row of rows) row.splice(0, 300);
  }
  showMeters(watched) {                                   // [{name, unit}]: the meters of the scene's view, then a plot for each unit
    const units = new Map(watched.map(({ name, unit }) => [name, unit])), names = [...units.keys()];
    this.rows = new Map(names.map((name) => [name, this.rows.get(name) || this.time.map(() => null)]));
    const meters = this.head.meters.filter((meter) => meter.names.every((name) => units.has(name)));
    const rest = names.filter((name) => !meters.some((meter) => meter.names.includes(name)));
    for (const some of Map.groupBy(rest, (name) => units.get(name)).values()) meters.push({ names: some });
    for (const made of this.plots) made.remove();
    this.plots = meters.map((meter) => {
      const rows = () => meter.names.map((name) => this.rows.get(name));
      return Object.assign(plot(this.meters, { ...meter, unit: units.get(meter.names[0]), curves: curvesOf(meter.names), least: STILL,
        time: this.time, rows: rows(), close: () => this.ask({ watch: names.filter((name) => !meter.names.includes(name)) }) }), { rows });
    });
  }
  lastText(name) {                                        // the last value of a watched quantity, as its plot shows it
    const row = this.rows.get(name), value = row?.at(-1) ?? null;
    return value === null ? "" : textOf(value, row, this.units.get(name));
  }
}

// Sliders, fields and switches of a running scene.

const HEADINGS = { parameter: "parameters", drive: "drives", target: "targets", switch: "controllers" };
const BEYOND = 10;                                        // times its own span a slider goes for a typed value

class Controls {
  constructor(set) {                                      // set(name, value): asks for it
    Object.assign(this, { set, kinds: [], rows: new Map(), box: el("section", { className: "controls", ariaLabel: "controls" }) });
  }
  show(list) {                                            // again with other values, or anew
    const kinds = list.map(({ name, unit }) => `${name} ${unit}`);
    if (!alike(kinds, this.kinds)) {
      this.kinds = kinds;
      this.rows = new Map(list.map((control) => [control.name, control.kind === "switch" ? this.toggle(control) : this.slider(control)]));
      this.box.replaceChildren(...[...Map.groupBy(list, ({ kind }) => HEADINGS[kind])].flatMap(([textContent, some]) => [
        el("h2", { textContent }), ...some.map(({ name }) => this.rows.get(name).box)]));
      this.box.hidden = !list.length;
    }
    for (const control of list) this.rows.get(control.name).take(control);
  }
  toggle({ name }) {
    const input = el("input", { type: "checkbox", "data-control": name, onchange: () => this.set(name, input.checked ? 1 : 0) });
    const box = el("label", { className: "control" }, input, name.replace(/\.active$/, ""));
    return { box, take: (c) => { input.checked = c.value !== 0; } };
  }
  slider(control) {
    const { name, kind, unit: unitName } = control, label = name.replace(/^parameters\./, "");
    const most = BEYOND * Math.max(-control.low, control.high), state = { touched: false, typing: false, value: control.value };
    const show = (value) => {
      state.value = value;
      if (value > +range.max) range.max = Math.min(2 * value, most);
      if (value < +range.min) range.min = Math.max(2 * value, -most);
      if (!state.typing) text.value = short(value);
      range.value = value;
    };
    const ask = (value) => {
      Object.assign(state, { touched: true, value });
      this.set(name, kind === "parameter" && unitName ? `${value} ${unitName}` : value);
    };
    const range = el("input", { type: "range", "data-control": name, step: "any", min: control.low, max: control.high, ariaLabel: label,
      oninput: () => { const v = +(+range.value).toPrecision(6); text.value = short(v); ask(v); } });
    const text = el("input", { type: "text", "data-typed": name, inputMode: "decimal", ariaLabel: `${label}, typed`, size: 8, maxLength: 200,
      oninput: () => { state.typing = true; },
      onchange: () => {                                   // a number; else the answer is the value, or what is wrong
        const given = text.value.replace("\u2212", "-").trim();
        state.typing = false;
        if (given && Number.isFinite(+given)) { show(+given); ask(+given); return; }
        this.set(name, given);
        text.value = short(state.value);
      } });
    return {
      box: el("div", { className: "control" }, el("span", { className: "name", textContent: label, title: label }), range, text,
        el("span", { className: "unit", textContent: unitName })),
      given: (value) => { state.touched = true; show(value); },
      take: (c) => {
        state.drive = c.drive;
        Object.assign(range, { min: c.low, max: c.high });
        if (document.activeElement !== range || !state.touched) { show(c.value); state.touched = false; }
      },
      follow: (drive) => {                                // a drive that its own signal leads
        if (state.drive >= 0 && drive && !state.touched && document.activeElement !== range) show(drive[state.drive]);
      },
    };
  }
  given({ name, value }) { this.rows.get(name).given(value); }
  follow(drive) { for (const row of this.rows.values()) row.follow?.(drive); }
}
