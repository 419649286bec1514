// The page of a report: runs with one clock, plots beside them, what was found below.

const SPEEDS = [0.02, 0.05, 0.1, 0.25, 0.5, 1, 2];
const KEYS = [["space", "play or pause"], ["left, right", "one sample back or on; with shift ten"],
  ["home, end", "first or last instant"], ["n, p", "next or previous mark on the bar"],
  ["[ and ]", "slower, faster"], ["l", "loop"], ["+, -", "zoom"], ["0", "fit"],
  ["g", "side by side or over each other"], ["s", "save the picture"], ["?", "these keys"]];

class Series {                                            // quantities of one run by name
  constructor(head, data) {
    this.time = data.ptime[0];
    this.by = new Map(head.series.map((one) => [one.name, one]));
    this.columns = data.plots;
    this.known = new Map();
  }
  column(c) {
    if (!this.known.has(c)) this.known.set(c, this.columns.at(c));
    return this.known.get(c);
  }
  has(name) { return this.by.has(name); }
  keys() { return this.by.keys(); }
  unit(name) { return this.by.get(name).unit; }
  row(name) {
    const one = this.by.get(name);
    return one.c === undefined ? Float64Array.from(this.time, () => one.v) : this.column(one.c);
  }
  at(name, t) {
    const one = this.by.get(name);
    if (one.c === undefined) return one.v;
    const row = this.column(one.c), i = indexBelow(this.time, t), j = Math.min(i + 1, row.length - 1);
    const w = j > i ? clamp((t - this.time[i]) / (this.time[j] - this.time[i]), 0, 1) : 0;
    return row[i] + w * (row[j] - row[i]);
  }
}

class Report {
  constructor(root, heads, datas) {
    Object.assign(this, { root, heads, plots: [], t: 0, playing: false, speed: 1, loop: true, over: false });
    this.replays = heads.map((head, i) => new Replay(head, datas[i]));
    this.series = heads.map((head, i) => new Series(head, datas[i]));
    this.first = Math.min(...this.replays.map((r) => r.first));
    this.last = Math.max(...this.replays.map((r) => r.last));
    this.step = Math.min(...heads.map((h) => 1 / h.words.rate));
    this.drawn = 0;
    this.build();
    this.listen();
    const asked = this.askedTime();
    this.seek(asked === null ? this.last : asked);
  }
  build() {
    const { root, heads } = this;
    this.sheets = el("div", { className: "sheets" });
    this.meters = el("section", { className: "plots", ariaLabel: "plots" });
    const bench = el("section", { className: "bench", ariaLabel: "motion" }, this.sheets);
    root.replaceChildren(banner(heads), el("div", { className: "top" }, bench, this.meters), facts(heads));
    this.tip = tooltip(root);
    this.stages = heads.map((head, i) => this.sheet(head, i));
    this.sheets.dataset.runs = heads.length;
    bench.append(this.bar(), this.tools(), layerBoxes(this.stages, () => this.show()));
    this.meters.append(this.adder());
    this.openFirst();
    this.help = helpBox(root);
  }
  sheet(head, i) {
    const canvas = el("canvas", { tabIndex: 0, ariaLabel: "the mechanism in motion" });
    const sheet = el("div", { className: "sheet" });
    if (this.heads.length > 1) sheet.append(nameOf(head, i));
    sheet.append(canvas);
    this.sheets.append(sheet);
    canvas.style.aspectRatio = String(head.view.aspect);
    const stage = new Stage(canvas, head);
    stage.sheet = sheet;
    camera(stage, () => this.show(), {
      hover: (pick, e) => this.tell(i, pick, e),
      click: (pick) => pick && this.open(quantitiesOf(pick, this.series[i]).slice(0, 3), pick.n),
    });
    return stage;
  }
  tell(i, pick, e) {
    if (!pick || !pick.n) { this.tip(null); return; }
    const of = this.series[i], lines = [pick.n];
    if (pick.row) lines.push(`${short(Math.hypot(pick.row[2], pick.row[3]))} N`);
    for (const name of quantitiesOf(pick, of).slice(0, 6)) {
      const what = name.slice(pick.n.length + 1) || "value";
      if (!pick.row) lines.push(`${what}  ${short(of.at(name, this.t))}${unitText(of.unit(name))}`);
    }
    this.tip(lines, e);
  }

  // -- time ------------------------------------------------------------------------------------------
  show() {
    const frames = this.replays.map((r) => r.frame(this.t)), stamp = `t = ${this.t.toFixed(3)} s`;
    const ghosts = this.over ? frames.slice(1).map((frame, k) => ({
      head: this.heads[k + 1], frame, fills: ghostFills(this.heads[k + 1], k + 1, this.stages[0].dark) })) : [];
    this.stages.forEach((stage, i) => {
      if (this.over && i) return;
      stage.stamp = stamp;
      stage.draw(frames[i], i ? [] : ghosts);
    });
    this.play.textContent = this.playing ? "\u275a\u275a" : "\u25b6";
    this.play.ariaLabel = this.playing ? "pause" : "play";
    this.scrub.value = this.t;
    this.clock.textContent = `${this.t.toFixed(3)} s`;
    for (const one of this.plots) one.at(this.t);
    this.drawn++;
  }
  seek(t) {
    this.t = clamp(t, this.first, this.last);
    this.show();
    if (!this.playing) this.remember();
  }
  hold(t) { this.playing = false; this.seek(t); }
  remember() {
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      try { history.replaceState(null, "", `#t=${+this.t.toFixed(4)}`); } catch { /* in a frame of others */ }
    }, 150);
  }
  askedTime() {
    const found = /[#&]t=([0-9.eE+-]+)/.exec(location.hash), t = found ? Number(found[1]) : NaN;
    return Number.isFinite(t) ? t : null;
  }
  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.t >= this.last - 1e-9) this.t = this.first;
    if (!this.playing) { this.seek(this.t); return; }
    this.before = null;
    requestAnimationFrame((now) => this.tick(now));
    this.show();
  }
  tick(now) {
    if (!this.playing) return;
    const passed = this.before === null ? 0 : (now - this.before) / 1000;
    this.before = now;
    let t = this.t + passed * this.speed;
    if (t > this.last) {
      if (this.loop && !this.recording) t = this.first;
      else { this.playing = false; t = this.last; }
    }
    this.seek(t);
    if (this.playing) requestAnimationFrame((next) => this.tick(next));
    else if (this.recording) this.recording.stop();
  }
  marks() {
    return this.heads.flatMap((head) => [
      ...head.words.events.map((e) => ({ t: e.t, text: `event ${e.name} at ${short(e.t)} s`, bad: false })),
      ...head.words.expect.filter((v) => !v.ok).map((v) => ({ t: v.over ? v.over[1] : this.last,
        text: `${v.quantity} ${v.statistic}: ${v.reason || "out of its range"}`, bad: true }))])
      .sort((a, b) => a.t - b.t);
  }
  jump(way) {
    const times = this.marks().map((m) => m.t);
    const next = way > 0 ? times.find((t) => t > this.t + 1e-6) : times.reverse().find((t) => t < this.t - 1e-6);
    if (next !== undefined) this.hold(next);
  }
  faster(way) {
    const i = clamp(SPEEDS.indexOf(this.speed) + way, 0, SPEEDS.length - 1);
    this.speed = SPEEDS[i]; this.speeds.value = String(this.speed);
  }

  // -- controls ------------------------------------------------------------------------------------------
  bar() {
    this.play = el("button", { id: "play", title: "play or pause (space)" });
    this.play.onclick = () => this.toggle();
    this.clock = el("output", { id: "clock" });
    this.scrub = el("input", { type: "range", id: "scrub", min: this.first, max: this.last, step: "any",
                               ariaLabel: "time" });
    this.scrub.oninput = () => this.hold(+this.scrub.value);
    const track = el("div", { className: "track" }, this.scrub), span = this.last - this.first || 1;
    for (const mark of this.marks()) {
      const tick = el("i", { className: mark.bad ? "mark bad" : "mark" });
      tick.title = mark.text;
      tick.style.left = `${100 * clamp((mark.t - this.first) / span, 0, 1)}%`;
      track.append(tick);
    }
    this.speeds = el("select", { title: "speed ([ and ])", ariaLabel: "speed" }, ...SPEEDS.map((v) =>
      el("option", { value: String(v), textContent: `${v}\u00d7`, selected: v === 1 })));
    this.speeds.onchange = () => { this.speed = +this.speeds.value; };
    this.loops = el("input", { type: "checkbox", checked: true });
    this.loops.onchange = () => { this.loop = this.loops.checked; };
    return el("div", { className: "bar" }, this.play, track, this.clock, this.speeds,
              el("label", { title: "begin again at the end (l)" }, this.loops, "loop"));
  }
  tools() {
    const button = (text, title, act) => {
      const b = el("button", { textContent: text, title });
      b.onclick = act;
      return b;
    };
    const follow = el("select", { title: "the camera goes along with a body", ariaLabel: "follow" },
      el("option", { value: "-1", textContent: "follow nothing" }));
    this.heads[0].bodies.forEach((body, b) => {
      if (!body.fixed) follow.append(el("option", { value: String(b), textContent: body.name }));
    });
    follow.value = String(this.stages[0].follow);
    follow.onchange = () => {
      const name = (this.heads[0].bodies[+follow.value] || {}).name;
      for (const s of this.stages) s.follow = s.head.bodies.findIndex((body) => body.name === name);
      this.show();
    };
    this.film = button("film", "record the motion as a film", () => this.record());
    const found = [button("fit", "show all (0)", () => this.fit()), follow,
                   button("picture", "save this picture (s)", () => this.picture()), this.film,
                   button("?", "keys", () => this.help.showModal())];
    if (this.heads.length > 1) {
      found.unshift(button("over each other", "runs side by side or as ghosts (g)", () => this.lay()));
      this.layer = found[0];
    }
    return el("div", { className: "tools" }, ...found);
  }
  fit() { for (const s of this.stages) s.fit(); this.show(); }
  lay() {
    this.over = !this.over;
    this.sheets.dataset.over = this.over ? "1" : "";
    this.layer.textContent = this.over ? "side by side" : "over each other";
    this.show();
  }
  picture() {
    this.stages[0].canvas.toBlob((blob) =>
      save(blob, `${fileName(this.heads[0].name)}_${this.t.toFixed(3)}s.png`));
  }
  record() {
    if (this.recording) { this.playing = false; this.recording.stop(); return; }
    const kind = ["video/mp4;codecs=avc1", "video/webm;codecs=vp9", "video/webm"].find((k) =>
      globalThis.MediaRecorder && MediaRecorder.isTypeSupported(k));
    if (!kind) { this.film.textContent = "no film in this browser"; return; }
    const pieces = [], recorder = new MediaRecorder(this.stages[0].canvas.captureStream(60),
      { mimeType: kind, videoBitsPerSecond: 8e6 });
    recorder.ondataavailable = (e) => pieces.push(e.data);
    recorder.onstop = () => {
      this.recording = null; this.film.textContent = "film";
      save(new Blob(pieces, { type: kind }), `${fileName(this.heads[0].name)}.${kind.slice(6, 10).replace(";", "")}`);
    };
    this.recording = recorder; this.film.textContent = "stop the film";
    if (this.playing) this.toggle();
    this.t = this.first;
    recorder.start();
    this.toggle();
  }
  listen() {
    const act = {
      " ": () => this.toggle(), ArrowRight: (e) => this.hold(this.t + (e.shiftKey ? 10 : 1) * this.step),
      ArrowLeft: (e) => this.hold(this.t - (e.shiftKey ? 10 : 1) * this.step), Home: () => this.hold(this.first),
      End: () => this.hold(this.last), n: () => this.jump(1), p: () => this.jump(-1), "[": () => this.faster(-1),
      "]": () => this.faster(1), l: () => this.loops.click(), "+": () => this.zoom(1.25),
      "-": () => this.zoom(0.8), 0: () => this.fit(), g: () => this.layer && this.lay(), s: () => this.picture(),
      "?": () => this.help.showModal(),
    };
    addEventListener("keydown", (e) => {
      const typed = e.target.matches && e.target.matches("input:not([type=range]):not([type=checkbox]), select, textarea");
      if (typed || e.ctrlKey || e.metaKey || e.altKey || !act[e.key] || this.help.open) return;
      if (e.key === " " && e.target.matches && e.target.matches("button, summary")) return;
      e.preventDefault();
      act[e.key](e);
    });
    new ResizeObserver(() => this.show()).observe(this.sheets);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const one of [...this.stages, ...this.plots]) one.dress();
      this.show();
    });
    addEventListener("hashchange", () => { const t = this.askedTime(); if (t !== null) this.hold(t); });
  }
  zoom(factor) {
    for (const s of this.stages) s.zoomAt(factor, s.w / 2, (s.h - s.foot) / 2);
    this.show();
  }
}
