// The live view: a Stage that shows what a session does, and asks it for things.
// link = {send(text), onmessage(data), onclose()}: text is JSON, data is JSON or a frame's bytes.

const RATES = [0.05, 0.1, 0.25, 0.5, 1, 2], KEPT = 1500, WAY = 20000;
const LIVE_KEYS = [["space", "run or pause"], ["right, left", "one frame on or back"], ["r", "from the beginning"],
  ["[ and ]", "slower, faster"], ["+, -", "zoom"], ["0", "fit"], ["s", "save the picture"], ["?", "these keys"]];

function socketLink(address) {
  const socket = new WebSocket(address.replace(/^http/, "ws").replace(/[?#].*/, ""));
  socket.binaryType = "arraybuffer";
  const link = { send: (text) => { if (socket.readyState === 1) socket.send(text); }, onmessage() {}, onclose() {} };
  socket.onmessage = (e) => link.onmessage(e.data);
  socket.onclose = () => link.onclose();
  return link;
}

class Live {
  constructor(root, link) {
    Object.assign(this, { root, link, ids: 0, sent: new Map(), asked: false, frame: null, plots: [], watched: [],
                          time: [], kept: [], ways: [], instants: [], waiting: new Map(), busy: null,
                          stats: { drawn: 0, got: 0, latency: [], costs: [] } });
    link.onmessage = (data) => { if (typeof data === "string") this.hear(JSON.parse(data)); else this.take(data); };
    link.onclose = () => { if (this.head) this.tell("the view has ended; start it again, and open the address that it says", true); };
    this.build();
    this.listen();
  }

  // -- what is there -------------------------------------------------------------------------------
  build() {
    this.title = el("h1"); this.said = el("output", { id: "said", className: "told", role: "status" });
    this.sheet = el("div", { className: "sheet" });
    this.layers = el("div");
    const bench = el("section", { className: "bench", ariaLabel: "motion" },
      el("div", { className: "sheets" }, this.sheet), this.bar(), this.tools(), this.layers, this.said);
    this.side = el("section", { className: "plots", ariaLabel: "controls and meters" });
    this.controls = new Controls(this.side, (name, value) => this.set(name, value));
    this.meters = el("div", { className: "plots" });
    this.side.append(this.adder(), this.meters);
    this.root.replaceChildren(this.title, el("div", { className: "top" }, bench, this.side));
    this.tip = tooltip(this.root);
    this.help = this.helpBox();
  }
  button(id, text, title, act) {
    const b = el("button", { id, textContent: text, title });
    b.onclick = act;
    return b;
  }
  bar() {
    this.play = this.button("play", "\u25b6", "run or pause (space)", () => this.toggle());
    this.clock = el("output", { id: "clock" });
    this.pace = el("output", { id: "pace" });
    this.speeds = el("select", { title: "speed ([ and ])", ariaLabel: "speed", id: "speed" }, ...RATES.map((v) =>
      el("option", { value: String(v), textContent: `${v}\u00d7`, selected: v === 1 })));
    this.speeds.onchange = () => this.ask({ speed: +this.speeds.value });
    return el("div", { className: "bar" }, this.play,
      this.button("back", "\u25c0|", "one frame back (left)", () => this.ask({ do: "back" })),
      this.button("step", "|\u25b6", "one frame on (right)", () => this.ask({ do: "step" })),
      this.button("reset", "reset", "from the beginning (r)", () => this.ask({ do: "reset" })),
      this.speeds, this.clock, this.pace);
  }
  tools() {
    this.follow = el("select", { title: "the camera goes along with a body", ariaLabel: "follow" });
    this.follow.onchange = () => { this.stage.follow = +this.follow.value; this.redraw(); };
    this.film = this.button("film", "film", "record what is seen", () => this.record());
    return el("div", { className: "tools" },
      this.button("fit", "fit", "show all (0)", () => { this.stage.fit(); this.redraw(); }), this.follow,
      this.button("picture", "picture", "save this picture (s)", () => this.picture()), this.film,
      this.button("save-run", "save run", "run it again as it was played, and save that", () => this.ask({ save: "run" })),
      this.button("save-scene", "save scene", "what was played as a scene of its own", () => this.ask({ save: "scene" })),
      this.button("help", "?", "keys", () => this.help.showModal()));
  }
  helpBox() {
    const box = el("dialog", { className: "help" }, el("h2", { textContent: "keys" }), el("dl", {},
      ...LIVE_KEYS.flatMap(([key, what]) => [el("dt", { textContent: key }), el("dd", { textContent: what })])),
      el("p", { textContent: "Drag a body to pull it: the longer the line, the stronger. Drag beside bodies to move the "
        + "picture, wheel or two fingers zoom, double click fits. Click a body, cord or spring for its meter." }));
    box.append(this.button("", "close", "", () => box.close()));
    this.root.append(box);
    return box;
  }
  adder() {
    this.names = el("datalist", { id: "quantities" });
    this.add = el("input", { type: "search", id: "add", placeholder: "a meter for a quantity, or a pattern such as *.tension",
                             ariaLabel: "a meter for a quantity", autocomplete: "off" });
    this.add.setAttribute("list", "quantities");
    this.add.onchange = () => {
      const text = this.add.value.trim(), every = [...this.units.keys()], names = text ? matching(text, every) : [];
      if (!text) return;
      if (names.length) { this.watch(names); this.add.value = ""; return; }
      const near = nearest(text, every);
      this.tell(`no quantity fits ${text}${near ? `; did you mean ${near}?` : ""}`, true);
    };
    return el("div", { className: "adder" }, this.add, this.names);
  }

  // -- what is heard -------------------------------------------------------------------------------
  hear(message) {
    if (message.head) this.begin(message.head);
    if (message.status) this.status(message.status);
    if (message.controls) this.controls.show(message.controls);
    if (message.watched) this.metersFor(message.watched);
    if (message.said) this.tell(message.said);
    if (message.error) this.tell(message.error, true);
    if (message.text) save(new Blob([message.text], { type: "application/json" }), fileName(message.file));
  }
  begin(head) {                                           // a scene, perhaps another one than before
    const old = this.stage;
    this.head = head;
    this.title.textContent = document.title = head.title;
    if (this.recorder) this.recorder.stop();
    this.canvas = el("canvas", { tabIndex: 0, ariaLabel: "the mechanism in motion: drag a body to pull it" });
    this.canvas.style.aspectRatio = String(head.view.aspect);
    this.sheet.replaceChildren(this.canvas);
    const stage = this.stage = new Stage(this.canvas, head);
    stage.extra.push((s) => this.drawHand(s));
    if (old) {                                            // the camera stays
      Object.assign(stage, { zoom: old.zoom, pan: old.pan, layers: old.layers });
      if (old.follow >= 0) stage.follow = head.bodies.findIndex((b) => b.name === old.head.bodies[old.follow].name);
    }
    camera(stage, () => this.redraw(), { grab: (pick, x, y) => this.grab(pick, x, y), hover: (pick, e) => this.hover(pick, e),
                                         click: (pick) => this.click(pick) });
    this.pose = Float64Array.from(head.rest); this.instants = [];
    this.frame = null; this.held = null; this.time = []; this.kept = [];
    this.ways = head.parts.filter((p) => p.k === "trace").map((p) => ({ at: p.at, way: [] }));
    this.layers.replaceChildren(layerBoxes([this.stage], () => this.layersChosen()));
    this.layersChosen();
    this.follow.replaceChildren(el("option", { value: "-1", textContent: "follow nothing" }),
      ...head.bodies.flatMap((b, i) => (b.fixed ? [] : [el("option", { value: String(i), textContent: b.name })])));
    this.follow.value = String(this.stage.follow);
    this.units = new Map(head.quantities.map((q) => [q.name, q.unit]));
    this.names.replaceChildren(...head.quantities.map((q) => el("option", { value: q.name })));
    this.controls.show(head.controls);
    this.metersFor(head.watched.map((name) => ({ name, unit: this.units.get(name) })));
    this.said.textContent = "";
  }
  status({ playing, trouble, over, speed }) {
    this.playing = playing;
    this.play.textContent = playing ? "\u275a\u275a" : "\u25b6";
    this.play.ariaLabel = playing ? "pause" : "run";
    this.speeds.value = String(speed);
    if (trouble || over) this.tell(trouble || "the scene has ended this run; reset begins anew", true);
    else if (this.said.classList.contains("bad")) this.tell("");
  }
  tell(text, bad = false) {
    this.said.textContent = text;
    this.said.classList.toggle("bad", bad);
  }

  // -- frames --------------------------------------------------------------------------------------
  take(buffer) {
    const { head } = this, numbers = new Float32Array(buffer);
    let i = head.head.length;
    const f = Object.fromEntries(head.head.map((name, k) => [name, numbers[k]]));
    for (const [name, width] of head.layout) { f[name] = numbers.subarray(i, i + width); i += width; }
    const values = numbers.subarray(i, i + this.watched.length), rows = [];
    i += this.watched.length;
    for (let k = 0; k < f.contacts; k++, i += 6) rows.push([...numbers.subarray(i, i + 6)]);
    f.contacts = rows;
    f.places = numbers.subarray(i);
    const last = this.frame, passed = last ? f.t - last.t : 0;
    if (passed < 0) { this.time = []; this.kept = this.watched.map(() => []); this.instants = []; for (const one of this.ways) one.way = []; }
    head.moving.forEach((b, m) => {
      for (let q = 0; q < 3; q++) this.pose[3 * b + q] = f.pose[3 * m + q];
    });
    f.pose = this.pose;
    this.trace(f);
    if (!last || passed !== 0) this.keep(f.t, values);
    this.frame = f;
    this.stats.got++;
    this.redraw();
  }
  trace(f) {                                              // with what lay between two frames
    const { frame: last, instants } = this, m = f.trail, since = last && last.t < f.t ? last.t : f.t;
    for (let k = 1; k <= Math.max(m, 1) && this.ways.length; k++) instants.push(since + (f.t - since) * k / Math.max(m, 1));
    this.ways.forEach((one, w) => {
      const [b, x, y] = one.at, [px, py] = turned([x, y], this.pose[3 * b + 2]);
      if (m) one.way.push(...f.places.subarray(2 * m * w, 2 * m * (w + 1)));
      else one.way.push(this.pose[3 * b] + px, this.pose[3 * b + 1] + py);
    });
    if (this.instants.length > WAY) {
      this.instants.splice(0, WAY / 2);
      for (const one of this.ways) one.way.splice(0, WAY);
    }
    f.ways = this.ways.map((one) => one.way); f.times = this.instants; f.upto = this.instants.length - 1;
  }
  keep(t, values) {
    this.time.push(t);
    this.kept.forEach((row, k) => row.push(Number.isFinite(values[k]) ? values[k] : null));
    if (this.time.length > KEPT + 300) { this.time.splice(0, 300); for (const row of this.kept) row.splice(0, 300); }
  }
  layersChosen() { this.ask({ layers: [...this.stage.layers] }); this.redraw(); }
  redraw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.paint());
  }
  paint() {
    this.asked = false;
    const f = this.frame, began = performance.now();
    if (!f) return;
    this.stage.stamp = `t = ${f.t.toFixed(2)} s`;
    this.stage.draw(f);
    this.clock.textContent = `${f.t.toFixed(3)} s`;
    const slow = this.playing && f.rate < 0.9 * +this.speeds.value && f.t > 0.5;
    this.pace.textContent = slow ? `${f.rate.toFixed(2)} \u00d7 real time` : "";
    this.controls.follow(f.drive);
    this.stats.drawn++;
    if (!this.playing || this.stats.drawn % 3 === 0) this.scroll(f.t);
    for (const [id, at] of this.sent) {
      if (id > f.ack) break;
      this.stats.latency.push(performance.now() - at); this.sent.delete(id);
    }
    if (f.seq !== this.shown) { this.shown = f.seq; this.link.send(`{"seen":${f.seq}}`); }
    this.stats.costs.push(performance.now() - began);
    if (this.stats.costs.length > 2000) { this.stats.costs.splice(0, 1000); this.stats.latency.splice(0, 1000); }
  }
  drawHand(s) {
    const f = this.frame;
    if (!f || f.hand < 0 || !this.held) return;
    const from = s.px(f.from_x, f.from_y), to = s.px(...this.held.to), colour = s.ink("DRIVE");
    s.line([from, to], colour, 1.6, { dash: [5, 4] });
    s.dot(from, 3.2 * s.u, colour); s.dot(to, 4.5 * s.u, null, colour, 1.6);
    s.label(`${+Math.hypot(f.force_x, f.force_y).toPrecision(2)} N`, besideTip(s, from, to, "0.00 N"), colour, true);
  }

  // -- meters --------------------------------------------------------------------------------------
  watch(names) { this.ask({ watch: [...new Set([...this.watched.map((w) => w.name), ...names])] }); }
  metersFor(watched) {
    const before = new Map(this.watched.map((w, k) => [w.name, this.kept[k]]));
    this.watched = watched;
    this.kept = watched.map((w) => before.get(w.name) || this.time.map(() => null));
    for (const made of this.plots) { made.quiet = true; made.box.querySelector(".close").click(); }
    const groups = new Map();
    watched.forEach((w, k) => { if (!groups.has(w.unit)) groups.set(w.unit, []); groups.get(w.unit).push(k); });
    this.plots = [...groups].map(([unitName, rows]) => this.meter(unitName, rows));
  }
  meter(unitName, rows) {
    const names = rows.map((k) => this.watched[k].name), alike = common(names);
    const made = plot(this.meters, {
      title: names.length === 1 ? names[0] : alike.title || unitName, unit: alike.title || names.length === 1 ? unitName : "",
      names, short: names.map((n) => (names.length > 1 ? alike.cut(n) : "")),
      time: this.time, rows: rows.map((k) => this.kept[k]),
      close: () => { if (!made.quiet) this.ask({ watch: this.watched.map((w) => w.name).filter((n) => !names.includes(n)) }); },
    });
    made.indices = rows;
    return made;
  }
  scroll(t) {
    for (const made of this.plots) {
      made.set(this.time, made.indices.map((k) => this.kept[k]));
      made.at(t);
    }
  }

  // -- what is asked ---------------------------------------------------------------------------------
  ask(what) {
    const id = ++this.ids;
    this.sent.set(id, performance.now());
    this.link.send(JSON.stringify({ ...what, id }));
  }
  set(name, value) {                                      // of values that come fast the last one counts
    if (!name.startsWith("parameters.")) { this.ask({ set: name, value }); return; }
    this.waiting.set(name, value);
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      for (const [each, last] of this.waiting) this.ask({ set: each, value: last });
      this.waiting.clear();
    }, 40);
  }
  toggle() { this.ask({ do: this.playing ? "pause" : "run" }); }
  grab(pick, x, y) {
    if (!pick || !(pick.b >= 0) || !this.head.moving.includes(pick.b)) return null;
    const { stage } = this, body = this.head.bodies[pick.b].name, at = stage.local(pick.b, stage.world(x, y));
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
        if (this.held) { this.held = null; this.ask({ drop: 1 }); } else this.click(pick);
        this.redraw();
      },
    };
  }
  click(pick) {
    if (pick && pick.n) this.watch(quantitiesOf(pick, this.units).slice(0, 2));
  }
  hover(pick, e) {
    if (!pick || !pick.n) { this.tip(null); return; }
    this.tip([pick.n, ...(pick.row ? [`${short(Math.hypot(pick.row[2], pick.row[3]))} N`] : [])], e);
  }
  picture() {
    this.canvas.toBlob((blob) => save(blob, `${fileName(this.head.name)}_${this.frame.t.toFixed(3)}s.png`));
  }
  record() {
    if (this.recorder) { this.recorder.stop(); return; }
    const kind = ["video/mp4;codecs=avc1", "video/webm;codecs=vp9", "video/webm"].find((k) =>
      globalThis.MediaRecorder && MediaRecorder.isTypeSupported(k));
    if (!kind) { this.tell("this browser records no film", true); return; }
    const pieces = [], recorder = new MediaRecorder(this.canvas.captureStream(60),
      { mimeType: kind, videoBitsPerSecond: 8e6 });
    recorder.ondataavailable = (e) => pieces.push(e.data);
    recorder.onstop = () => {
      this.recorder = null; this.film.textContent = "film";
      save(new Blob(pieces, { type: kind }), `${fileName(this.head.name)}.${kind.slice(6).split(";")[0]}`);
    };
    this.recorder = recorder; this.film.textContent = "stop the film";
    recorder.start();
  }
  faster(way) {
    const next = RATES[clamp(RATES.indexOf(+this.speeds.value) + way, 0, RATES.length - 1)];
    this.ask({ speed: next });
  }
  zoom(factor) { const s = this.stage; s.zoomAt(factor, s.w / 2, (s.h - s.foot) / 2); this.redraw(); }
  listen() {
    const act = {
      " ": () => this.toggle(), ArrowRight: () => this.ask({ do: "step" }), ArrowLeft: () => this.ask({ do: "back" }),
      r: () => this.ask({ do: "reset" }), "[": () => this.faster(-1), "]": () => this.faster(1),
      "+": () => this.zoom(1.25), "-": () => this.zoom(0.8), 0: () => { this.stage.fit(); this.redraw(); },
      s: () => this.picture(), "?": () => this.help.showModal(),
    };
    addEventListener("keydown", (e) => {
      const typing = e.target.matches && e.target.matches("input:not([type=checkbox]), select, textarea");
      if (typing || e.ctrlKey || e.metaKey || e.altKey || !act[e.key] || this.help.open || !this.head) return;
      if (e.key === " " && e.target.matches && e.target.matches("button, summary")) return;
      e.preventDefault();
      act[e.key]();
    });
    new ResizeObserver(() => this.redraw()).observe(this.sheet);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const one of [this.stage, ...this.plots]) one.dress();
      this.redraw();
    });
  }
}

function live(root, link) {
  globalThis.sandbox = new Live(root, link);
  return globalThis.sandbox;
}
