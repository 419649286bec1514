// The page of a report: runs with one clock, plots beside them, what was found below.

const SPEEDS = [0.02, 0.05, 0.1, 0.25, 0.5, 1, 2];
const KEYS = [["space", "play or pause"], ["left, right", "one sample back or on; with shift ten"],
  ["home, end", "first or last instant"], ["n, p", "next or previous mark on the bar"],
  ["[ and ]", "slower, faster"], ["l", "loop"], ["+, -", "zoom"], [", . up, down", "move the picture"], ["0", "fit"],
  ["g", "side by side or over each other"], ["s", "save the picture"], ["?", "these keys"]];
const POINTER = "Wheel or two fingers zoom, drag moves, double click fits. Point at anything for its values, click it for "
  + "its plot. Click in a plot to go to that time, drag in it to zoom.";

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
    return this.column(one.c)[indexNear(this.time, t)];
  }
  told(name, t) {                                         // with its unit, as its plot shows it
    const { factor, sign } = shownAs(this.unit(name), sizeOfRow(this.row(name)));
    return `${short(factor * this.at(name, t))}${sign}`;
  }
}

class Report {
  constructor(root, heads, datas) {
    Object.assign(this, { root, heads, plots: [], t: 0, playing: false, speed: heads[0].view.speed, loop: true, over: false });
    this.replays = heads.map((head, i) => new Replay(head, datas[i]));
    this.series = heads.map((head, i) => new Series(head, datas[i]));
    this.first = Math.min(...this.replays.map((r) => r.first));
    this.last = Math.max(...this.replays.map((r) => r.last));
    this.step = Math.min(...heads.map((h) => 1 / h.words.rate));
    this.drawn = 0;
    this.build();
    this.listen();
    const asked = this.askedTime();
    this.seek(asked === null ? this.first : asked);
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
    this.help = keysBox(root, KEYS, POINTER);
  }
  sheet(head, i) {
    const canvas = el("canvas", { tabIndex: 0, role: "img", ariaLabel: `${head.title} in motion` });
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
    const of = this.series[i], read = (name) => of.told(name, this.t);
    this.tip(pick && pick.n ? toldOf(pick, of, read) : null, e);
  }

  // -- time ------------------------------------------------------------------------------------------
  show() {
    const frames = this.replays.map((r) => r.frame(this.t)), stamp = `t = ${this.t.toFixed(3)} s`;
    const ghosts = this.over ? frames.slice(1).map((frame, k) => ({
      head: this.heads[k + 1], frame, colour: inkOf(k + 1, this.stages[0].dark) })) : [];
    const seen = this.stages.slice(0, this.over ? 1 : undefined);
    for (const stage of seen) stage.resize();
    const lines = Math.max(...seen.map((stage) => stage.rows.length));
    seen.forEach((stage, i) => {
      stage.lines = lines;                                // drawings beside each other stand at one height
      stage.stamp = stamp;
      stage.draw(frames[i], i ? [] : ghosts);
    });
    this.play.textContent = this.playing ? "\u275a\u275a" : "\u25b6";
    this.play.ariaLabel = this.playing ? "pause" : "play";
    this.scrub.value = this.t;
    this.clock.textContent = `${this.t.toFixed(3)} s`;
    for (const one of this.plots) one.at(this.t);
    this.drawn++;
    if (this.filming) this.filming.frame(this.stages);
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
      if (this.loop && !this.filming) t = this.first;
      else { this.playing = false; t = this.last; }
    }
    this.seek(t);
    if (this.playing) requestAnimationFrame((next) => this.tick(next));
    else if (this.filming) this.filming.stop();
  }
  marks() {
    return this.heads.flatMap((head) => [
      ...head.words.events.map((e) => ({ t: e.t, text: `${e.name} at ${short(e.t)} s`, bad: false })),
      ...head.words.expect.filter((v) => !v.ok).map((v) => ({ t: v.over ? v.over[1] : this.last,
        text: `${v.quantity} ${v.statistic}: ${v.reason || "out of its range"}`, bad: true }))])
      .sort((a, b) => a.t - b.t);
  }
  jump(way) {
    const times = this.marks().map((m) => m.t);
    const next = way > 0 ? times.find((t) => t > this.t + 1e-6) : times.reverse().find((t) => t < this.t - 1e-6);
    if (next !== undefined) this.hold(next);
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
    this.speeds = speedBox((speed) => { this.speed = speed; this.speeds.value = String(speed); });
    this.speeds.take(this.speed);
    this.loops = el("input", { type: "checkbox", checked: true });
    this.loops.onchange = () => { this.loop = this.loops.checked; };
    return el("div", { className: "bar" }, this.play, track, this.clock, this.speeds,
              el("label", { title: "begin again at the end (l)" }, this.loops, "loop"));
  }
  tools() {
    this.follow = followBox(() => this.stages, () => this.show());
    this.follow.fill();
    this.film = button("film", "film", "record the motion as a film", () => this.record());
    const found = [button("fit", "fit", "show all (0)", () => this.fit()), this.follow,
                   button("picture", "picture", "save this picture (s)", () => this.picture()), this.film,
                   button("help", "?", "keys", () => this.help.showModal())];
    if (this.heads.length > 1) {
      this.layer = button("over", "over each other", "runs side by side or as ghosts (g)", () => this.lay());
      found.unshift(this.layer);
    }
    return el("div", { className: "tools" }, ...found);
  }
  fit() { fitAll(this.stages, () => this.show()); }
  zoom(factor) { zoomAll(this.stages, factor, () => this.show()); }
  lay() {
    this.over = !this.over;
    this.sheets.dataset.over = this.over ? "1" : "";
    this.layer.textContent = this.over ? "side by side" : "over each other";
    this.show();
  }
  picture() { savePicture(this.stages, this.heads[0].name, this.t); }
  record() {
    if (this.filming) { this.playing = false; this.filming.stop(); return; }
    if (!Filming.kind()) { this.film.textContent = "no film in this browser"; return; }
    if (this.playing) this.toggle();
    this.seek(this.first);
    this.filming = new Filming(this.stages, this.heads[0].name, () => { this.filming = null; this.film.textContent = "film"; });
    this.film.textContent = "stop the film";
    this.toggle();
  }
  listen() {
    onKeys({
      " ": () => this.toggle(), ArrowRight: (e) => this.hold(this.t + (e.shiftKey ? 10 : 1) * this.step),
      ArrowLeft: (e) => this.hold(this.t - (e.shiftKey ? 10 : 1) * this.step), Home: () => this.hold(this.first),
      End: () => this.hold(this.last), n: () => this.jump(1), p: () => this.jump(-1), "[": () => this.speeds.faster(-1),
      "]": () => this.speeds.faster(1), l: () => this.loops.click(), "+": () => this.zoom(1.25),
      "-": () => this.zoom(0.8), ...moves(() => this.stages, () => this.show()), 0: () => this.fit(), g: () => this.layer && this.lay(), s: () => this.picture(),
      "?": () => this.help.showModal(),
    }, () => !this.help.open);
    onLooks(this.sheets, () => [...this.stages, ...this.plots], () => this.show());
    addEventListener("hashchange", () => { const t = this.askedTime(); if (t !== null) this.hold(t); });
  }
}
