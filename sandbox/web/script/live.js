// The meters of a live view: quantities that are watched, over the last while.

const KEPT = 1500;                                        // frames
const STILL = 1e-4;                                       // of a value: less is not spread over a plot, as frames are float32

class Meters {
  constructor(box, ask) {                                 // ask(names): to watch these
    Object.assign(this, { box, ask, first: [], watched: [], time: [], rows: [], plots: [] });
  }
  names() { return this.watched.map((w) => w.name); }
  more(names) { this.ask([...new Set([...this.names(), ...names])]); }
  forget() { this.back(-Infinity); }
  back(t) {                                               // what was from t on is not any more
    const kept = this.time.findLastIndex((one) => one < t) + 1;
    for (const row of [this.time, ...this.rows]) row.length = kept;
  }
  show(watched) {                                         // [{name, unit}], a plot for each unit
    const before = new Map(this.watched.map((w, k) => [w.name, this.rows[k]]));
    this.watched = watched;
    this.rows = watched.map((w) => before.get(w.name) || this.time.map(() => null));
    for (const made of this.plots) { made.quiet = true; made.box.querySelector(".close").click(); }
    const at = new Map(watched.map((w, k) => [w.name, k])), groups = new Map(), taken = new Set();
    const first = this.first.filter((meter) => meter.names.every((name) => at.has(name)));
    this.plots = first.map((meter) => {                   // those of the scene's view
      const of = meter.names.map((name) => at.get(name));
      for (const k of of) taken.add(k);
      return this.plot(watched[of[0]].unit, of, meter);
    });
    watched.forEach((w, k) => {
      if (taken.has(k)) return;
      if (!groups.has(w.unit)) groups.set(w.unit, []);
      groups.get(w.unit).push(k);
    });
    this.plots.push(...[...groups].map(([unitName, of]) => this.plot(unitName, of)));
  }
  plot(unitName, of, { title, range, number } = {}) {
    const names = of.map((k) => this.watched[k].name), alike = common(names);
    const made = plot(this.box, {
      title: title || (names.length === 1 ? names[0] : alike.title), range, number, unit: unitName,
      names, short: names.map((n) => (names.length > 1 ? alike.cut(n) : "")),
      least: STILL, time: this.time, rows: of.map((k) => this.rows[k]),
      close: () => { if (!made.quiet) this.ask(this.names().filter((n) => !names.includes(n))); },
    });
    made.of = of;
    return made;
  }
  keep(t, values) {
    this.time.push(t);
    this.rows.forEach((row, k) => row.push(Number.isFinite(values[k]) ? values[k] : null));
    if (this.time.length > KEPT + 300) for (const row of [this.time, ...this.rows]) row.splice(0, 300);
  }
  row(name) { return this.rows[this.names().indexOf(name)]; }   // undefined if it is not watched
  scroll(t) {
    for (const made of this.plots) {
      made.set(this.time, made.of.map((k) => this.rows[k]));
      made.at(t);
    }
  }
}

// The live view: a Stage that shows what a session does, and asks it for things.
// link = {send(text), onmessage(data), onclose()}: text is JSON, data is JSON or a frame's bytes.

const WAY = 20000;
const LIVE_KEYS = [["space", "run or pause"], ["right, left", "one frame on or back"], ["r", "from the beginning"],
  ["[ and ]", "slower, faster"], ["+, -", "zoom"], [", . up, down", "move the picture"], ["0", "fit"], ["s", "save the picture"], ["?", "these keys"]];
const PULLING = "Drag a body to pull it: the longer the line, the stronger. Drag beside bodies to move the picture, wheel "
  + "or two fingers zoom, double click fits. Click a body, cord or spring for its meter.";

function socketLink(address) {
  const socket = new WebSocket(address.replace(/^http/, "ws").replace(/[?#].*/, ""));
  socket.binaryType = "arraybuffer";
  const link = { send: (text) => { if (socket.readyState === 1) socket.send(text); }, onmessage() {}, onclose() {} };
  socket.onmessage = (e) => link.onmessage(e.data);
  socket.onclose = () => link.onclose();
  return link;
}

class Live extends Viewer {
  constructor(root, link) {
    super();
    Object.assign(this, { root, link, ids: 0, sent: new Map(), asked: false, frame: null, ways: [], instants: [],
                          waiting: new Map(), working: false, stats: { drawn: 0, got: 0, latency: [], costs: [] } });
    link.onmessage = (data) => { if (typeof data === "string") this.hear(JSON.parse(data)); else this.take(data); };
    link.onclose = () => { if (this.head) this.tell("the view has ended; start it again, and open the address that it says", true, this.state); };
    this.build();
    this.listen();
  }

  // -- what is there -------------------------------------------------------------------------------
  build() {
    this.title = el("h1");
    this.state = el("output", { id: "state" }); this.said = el("output", { id: "said" });   // state of the run; result of the last action
    this.warned = el("ul", { id: "warned", className: "warned", ariaLabel: "what the check of the scene found", hidden: true });
    this.sheet = el("div", { className: "sheet" });
    this.layers = el("div");
    const bench = el("section", { className: "bench", ariaLabel: "motion" },
      el("div", { className: "sheets" }, this.sheet), this.bar(), this.tools(), this.layers, this.warned);
    this.side = el("section", { className: "plots", ariaLabel: "controls and meters" });
    this.controls = new Controls(this.side, (name, value) => this.set(name, value));
    const plots = el("div", { className: "plots" });
    this.meters = new Meters(plots, (names) => this.ask({ watch: names }));
    this.finder = finder("a meter for a quantity", () => [...this.units.keys()], (names) => this.watch(names),
                         (text) => text && this.tell(text, true), () => this.head.late, (text) => this.watch([text]));
    this.absent = el("ul", { id: "absent", className: "warned", ariaLabel: "meters that are left out", hidden: true });
    this.side.append(this.finder, this.absent, plots);
    this.root.replaceChildren(this.title, el("div", { className: "top" }, bench, this.side),
      el("div", { className: "messages" }, this.state, this.said));
    this.tip = tooltip(this.root);
    this.help = keysBox(this.root, LIVE_KEYS, PULLING);
  }
  bar() {
    this.play = button("play", "\u25b6", "run or pause (space)", () => this.toggle());
    this.clock = el("output", { id: "clock" });
    this.pace = el("output", { id: "pace" });
    this.speeds = speedBox((speed) => this.ask({ speed }));
    return el("div", { className: "bar" }, this.play,
      button("back", "\u25c0|", "one frame back (left)", () => this.ask({ do: "back" })),
      button("step", "|\u25b6", "one frame on (right)", () => this.ask({ do: "step" })),
      button("reset", "reset", "from the beginning (r)", () => this.ask({ do: "reset" })),
      this.speeds, this.clock, this.pace);
  }
  tools() {
    return super.tools(
      button("save-run", "save run", "run it again as it was played, and save that", () => this.ask({ save: "run" })),
      button("save-scene", "save scene", "what was played as a scene of its own", () => this.ask({ save: "scene" })));
  }
  get stages() { return this.stage ? [this.stage] : []; }
  get t() { return this.frame.t; }

  // -- what is heard -------------------------------------------------------------------------------
  hear(message) {
    if (message.head) this.begin(message.head);
    if (message.relisted) this.relist(message.relisted);
    if (message.status) this.status(message.status);
    if (message.controls) this.controls.show(message.controls);
    if (message.given) this.controls.given(message.given);
    if (message.watched) this.meters.show(message.watched);
    if ("working" in message) this.busy(message.working);
    if (message.said) this.tell(message.said);
    if (message.error) this.tell(message.error, true);
    if (message.text) save(new Blob([message.text], { type: "application/json" }), fileName(message.file));
  }
  begin(head) {                                           // a scene, perhaps another one than before
    const old = this.stage;
    this.head = head;
    this.title.textContent = document.title = head.title;
    this.canvas = el("canvas", { tabIndex: 0, role: "img", ariaLabel: `${head.title} in motion: drag a body to pull it` });
    this.canvas.style.aspectRatio = String(head.view.aspect);
    const stage = this.stage = new Stage(this.canvas, head);
    stage.extra.push((s) => this.drawHand(s));
    if (old) {                                            // the camera stays, and whom it goes along with
      Object.assign(stage, { zoom: old.zoom, pan: old.pan, layers: old.layers });
      const { name } = old.head.bodies[old.follow] || {};
      if (head.view.follow === old.head.view.follow) stage.follow = head.bodies.findIndex((b) => b.name === name);
    }
    camera(stage, () => this.redraw(), { grab: (pick, x, y) => this.grab(pick, x, y), hover: (pick, e) => this.hover(pick, e),
                                         click: (pick) => this.click(pick) });
    this.instants = []; this.ways = new Map();
    this.frame = null; this.held = null; this.meters.forget();
    this.layers.replaceChildren(layerBoxes([this.stage], () => this.layersChosen()));
    this.layersChosen();
    this.follow.fill();
    this.units = new Map([...head.quantities, ...head.pairs].map((q) => [q.name, q.unit]));
    this.finder.renew();
    this.controls.show(head.controls);
    this.meters.first = head.meters;
    this.meters.show(head.watched.map((name) => ({ name, unit: this.units.get(name) })));
  }
  relist(found) {                                         // other items than before, such as those of another layer
    Object.assign(this.head, found);
    Object.assign(this.stage, { list: found.list, stamps: {} });
  }
  status({ playing, trouble, note, speed, warnings, left_out: leftOut }) {
    this.playing = playing;
    this.play.textContent = playing ? "\u275a\u275a" : "\u25b6";
    this.play.ariaLabel = playing ? "pause" : "run";
    this.speeds.take(speed);
    this.tell(trouble || note, !!trouble, this.state);
    this.warned.replaceChildren(...warnings.map((text) => el("li", { textContent: text })));
    this.warned.hidden = !warnings.length;
    this.absent.replaceChildren(...leftOut.map((text) => el("li", { textContent: text })));
    this.absent.hidden = !leftOut.length;
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
    let i = head.head.length;
    const f = Object.fromEntries(head.head.map((name, k) => [name, numbers[k]]));
    const take = (count) => numbers.subarray(i, i += count);
    f.pose = take(3 * head.frames); f.values = take(head.columns); f.drives = take(head.drives);
    const values = take(this.meters.watched.length), names = Object.keys(head.tables), counts = take(names.length);
    f.tables = Object.fromEntries(names.map((name, k) => [name, Array.from({ length: counts[k] }, () => [...take(head.tables[name])])]));
    f.places = numbers.subarray(i);
    const last = this.frame, passed = last ? f.t - last.t : 0;
    if (passed < 0) this.wentBack(f.t);
    this.trace(f);
    if (!last || passed !== 0) this.meters.keep(f.t, values);
    this.frame = f;
    this.stats.got++;
    this.redraw();
  }
  wentBack(t) {
    const kept = this.instants.findLastIndex((one) => one < t) + 1;
    this.meters.back(t);
    this.instants.length = kept;
    for (const way of this.ways.values()) way.length = Math.min(way.length, 2 * kept);
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
    const f = this.frame, began = performance.now();
    if (!f) return;
    if (!this.canvas.isConnected) this.sheet.replaceChildren(this.canvas);   // the old picture stays until now
    this.stage.stamp = `t = ${f.t.toFixed(2)} s`;
    this.stage.draw(f);
    this.clock.textContent = `${f.t.toFixed(3)} s`;
    const slow = this.playing && f.rate < 0.9 * +this.speeds.value && f.t > 0.5;
    if (!this.working) this.pace.textContent = slow ? `${f.rate.toFixed(2)} \u00d7 real time` : "";
    this.controls.follow(f.drives);
    if (this.filming) this.filming.frame(this.stages);
    this.stats.drawn++;
    if (!this.playing || this.stats.drawn % 3 === 0) this.meters.scroll(f.t);
    for (const [id, at] of this.sent) {
      if (id > f.ack) break;
      this.stats.latency.push(performance.now() - at); this.sent.delete(id);
    }
    this.setNext();
    if (f.seq !== this.shown) { this.shown = f.seq; this.link.send(`{"seen":${f.seq}}`); }
    this.stats.costs.push(performance.now() - began);
    if (this.stats.costs.length > 2000) { this.stats.costs.splice(0, 1000); this.stats.latency.splice(0, 1000); }
  }
  drawHand(s) {
    const f = this.frame;
    if (!f || f.hand < 0 || !this.held) return;
    const from = s.px(f.from_x, f.from_y), to = s.px(...this.held.to), colour = s.ink("drive");
    s.stroke(polyline([from, to]), colour, 1.6 * s.u, 5 * s.u);
    s.dot(from, 3.2 * s.u, colour); s.dot(to, 4.5 * s.u, null, colour);
    s.words.push({ text: `${+Math.hypot(f.force_x, f.force_y).toPrecision(2)} N`, tip: to, side: to[0] < from[0] ? 4 : 0, rank: -1, ink: colour, clear: 4 });
  }

  // -- what is asked ---------------------------------------------------------------------------------
  ask(what) {                                             // a new action clears the message of the last one
    this.tell("");
    this.send(what);
  }
  send(what) {
    const id = ++this.ids;
    this.sent.set(id, performance.now());
    this.link.send(JSON.stringify({ ...what, id }));
  }
  set(name, value) { this.waiting.set(name, value); this.setNext(); }
  setNext() {                                             // one request at a time: the next goes when its frame is drawn
    const [next] = this.waiting;
    if (!next || this.sent.has(this.setting)) return;
    this.waiting.delete(next[0]);
    this.ask({ set: next[0], value: next[1] });
    this.setting = this.ids;
  }
  watch(names) {                                          // one that no frame tells is asked for alone: the answer says why
    const told = names.filter((name) => this.units.has(name));
    this.meters.more(told.length ? told : names.slice(0, 1));
  }
  toggle() { this.ask({ do: this.playing ? "pause" : "run" }); }
  grab(pick, x, y) {
    const { stage, head } = this, under = this.frame && stage.pick(x, y, (b) => b >= 0 && b < head.bodies.length && !head.bodies[b].fixed);
    if (!under) return null;
    const body = head.bodies[under.f].name, at = stage.local(under.f, stage.world(x, y));
    let moved = 0, was = [x, y];
    this.tip(null);
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
  click(pick) {
    if (pick && pick.n) this.meters.more(quantitiesOf(pick, this.units).slice(0, 2));
  }
  hover(pick, e) {
    const read = (name) => {
      const row = this.meters.row(name), value = row && row[row.length - 1];
      if (value === undefined || value === null) return "";
      const { factor, sign } = shownAs(this.units.get(name), sizeOfRow(row));
      return `${short(factor * value)}${sign}`;
    };
    this.tip(pick && pick.n ? toldOf(pick, this.units, read) : null, e);
  }
  listen() {
    super.listen(this.sheet, () => this.meters.plots, {
      " ": () => this.toggle(), ArrowRight: () => this.ask({ do: "step" }), ArrowLeft: () => this.ask({ do: "back" }),
      r: () => this.ask({ do: "reset" }),
    });
  }
}

function live(root, link) {
  globalThis.sandbox = new Live(root, link);
  return globalThis.sandbox;
}
