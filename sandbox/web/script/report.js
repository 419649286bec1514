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

class Report extends Viewer {
  constructor(root, heads, datas) {
    super();
    Object.assign(this, { root, heads, head: heads[0], plots: [], t: 0, playing: false, speed: heads[0].view.speed, loop: true, over: false });
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
    const box = super.tools();
    this.follow.fill();
    if (this.heads.length > 1) {
      this.layer = button("over", "over each other", "runs side by side or as ghosts (g)", () => this.lay());
      box.prepend(this.layer);
    }
    return box;
  }
  redraw() { this.show(); }
  lay() {
    this.over = !this.over;
    this.sheets.dataset.over = this.over ? "1" : "";
    this.layer.textContent = this.over ? "side by side" : "over each other";
    this.show();
  }
  record() {
    if (this.filming) this.playing = false;
    super.record(() => { if (this.playing) this.toggle(); this.seek(this.first); });
    if (this.filming && !this.playing) this.toggle();
  }
  listen() {
    super.listen(this.sheets, () => this.plots, {
      " ": () => this.toggle(), ArrowRight: (e) => this.hold(this.t + (e.shiftKey ? 10 : 1) * this.step),
      ArrowLeft: (e) => this.hold(this.t - (e.shiftKey ? 10 : 1) * this.step), Home: () => this.hold(this.first),
      End: () => this.hold(this.last), n: () => this.jump(1), p: () => this.jump(-1),
      l: () => this.loops.click(), g: () => this.layer && this.lay(),
    });
    addEventListener("hashchange", () => { const t = this.askedTime(); if (t !== null) this.hold(t); });
  }
}

// Plots that a reader opens: quantities of one unit side by side, of all runs at once.

const MOST_CURVES = 8, MOST_PLOTS = 12, AT_FIRST = 2;
const FLATTENED = 1e-3;                                   // a curve so much lower than another is none beside it

Object.assign(Report.prototype, {
  // A plot of some quantities for each unit that they have.
  open(names, title) {
    const units = new Map();
    for (const name of names) {
      const of = this.series.find((s) => s.has(name));
      if (!of) continue;
      const unitName = of.unit(name);
      if (!units.has(unitName)) units.set(unitName, []);
      units.get(unitName).push(name);
    }
    for (const [unitName, some] of [...units].flatMap(([one, all]) => this.bySize(all).map((of) => [one, of]))) {
      const key = some.join(" "), there = this.plots.find((p) => p.key === key);
      if (there) { there.box.scrollIntoView({ block: "nearest" }); flash(there.box); continue; }
      this.openOne(some.slice(0, MOST_CURVES), unitName, { title: some.length > 1 ? title : "", key });
    }
    this.show();
  },
  // Names in groups whose curves can be seen beside each other; what is 0 is with the largest.
  bySize(names) {
    const sizes = new Map(names.map((name) => [name, sizeOfRows(this.series.filter((s) => s.has(name)).map((s) => s.row(name)))]));
    const groups = [];
    for (const name of [...names].sort((a, b) => sizes.get(b) - sizes.get(a))) {
      const size = sizes.get(name), last = groups[groups.length - 1];
      if (!last || (size > 0 && size < FLATTENED * sizes.get(last[0]))) groups.push([name]);
      else (size > 0 ? last : groups[0]).push(name);
    }
    return groups.map((group) => names.filter((name) => group.includes(name)));
  },
  openOne(names, unitName, { title, key, range, number }) {
    const many = this.heads.length > 1, tables = [], labels = [], words = [], inks = [], alike = common(names);
    this.series.forEach((of, k) => {
      const mine = names.filter((name) => of.has(name));
      if (!mine.length) return;
      tables.push([of.time, ...mine.map((name) => of.row(name))]);
      mine.forEach((name, i) => {
        const word = names.length > 1 ? alike.cut(name) : "";
        labels.push(many ? `${name} (${k + 1})` : name);
        words.push(many ? `${word} (${k + 1})`.trim() : word);
        inks.push(many ? [k, i] : [i, Math.floor(i / INKS.length)]);
      });
    });
    const [time, ...rows] = tables.length > 1 ? uPlot.join(tables, tables.map((t) => t.map(() => 2))) : tables[0];
    const bands = names.length === 1 ? this.bands(names[0]) : [];
    const made = plot(this.meters, {
      title: title || (names.length === 1 ? names[0] : alike.title), unit: unitName, range, number,
      names: labels, short: words, time: [...time], rows: rows.map((r) => Array.from(r, (v) => (Number.isNaN(v) ? null : v))),
      bands, inks, seek: (t) => this.hold(t), close: () => { this.plots = this.plots.filter((p) => p !== made); } });
    Object.assign(made, { key, bands });
    this.plots.push(made);
  },
  // What runs expect of a quantity: what all of them do once, else that of each in its colour.
  bands(name) {
    const groups = new Map(), all = this.heads.length;
    this.heads.forEach(({ words }, k) => {
      for (const { quantity, statistic, over, low, high, ok } of words.expect) {
        if (quantity !== name || !over || statistic === "std") continue;
        const mean = statistic === "mean", key = JSON.stringify([over, low, high, mean]);
        if (!groups.has(key)) groups.set(key, { from: over[0], to: over[1], low, high, mean, ok: true, runs: new Set() });
        const band = groups.get(key);
        band.runs.add(k);
        band.ok = band.ok && ok;
      }
    });
    return [...groups.values()].flatMap(({ runs, mean, ...band }) => (      // a curve need not lie in the band of its mean
      runs.size === all ? [{ ...band, ink: null, word: mean ? "mean" : "" }]
        : [...runs].map((k) => ({ ...band, ink: k, word: `expected${mean ? " mean" : ""} (${k + 1})` }))));
  },
  // At first: the meters of the scene's view; then what else the header names, by unit and last word. The first
  // AT_FIRST are open, the others have a button each.
  openFirst() {
    const groups = new Map(), { meters, plots } = this.heads[0], shown = new Set(), offers = [];
    for (const meter of meters) {
      const names = meter.names.filter((name) => this.series.some((s) => s.has(name)));
      if (!names.length) continue;
      const of = this.series.find((s) => s.has(names[0]));
      offers.push([meter.title || common(names).title || names[0], () => this.openOne(names, of.unit(names[0]), { ...meter, key: names.join(" ") })]);
      for (const name of names) shown.add(name);
    }
    for (const name of plots) {
      const of = this.series.find((s) => s.has(name));
      if (!of || shown.has(name)) continue;
      const last = name.slice(name.lastIndexOf(".") + 1), key = JSON.stringify([of.unit(name), last]);
      if (!groups.has(key)) groups.set(key, { last, names: [] });
      groups.get(key).names.push(name);
    }
    const most = this.heads.length > 1 ? 2 : MOST_CURVES;
    for (const { last, names } of groups.values()) {
      for (let i = 0; i < names.length; i += most) {
        const some = names.slice(i, i + most);
        offers.push([some.length > 1 ? `${last}${i ? ` ${i / most + 1}` : ""}` : some[0], () => this.open(some, some.length > 1 ? last : "")]);
      }
    }
    const closed = el("div", { className: "closed" });
    for (const [title, open] of offers.slice(0, MOST_PLOTS)) {
      if (this.plots.length < AT_FIRST) { open(); continue; }
      const box = button("", `+ ${title}`, "plot this", () => { box.remove(); open(); });
      closed.append(box);
    }
    this.meters.append(closed);
  },
  adder() {
    const every = [...new Set(this.series.flatMap((s) => [...s.keys()]))];
    const said = el("output", { className: "said" });
    const box = finder("plot a quantity", () => every, (names, text) => this.open(names, text),
                       (text) => { said.textContent = text; });
    box.append(said);
    return box;
  },
});

function flash(box) {
  box.classList.add("flash");
  setTimeout(() => box.classList.remove("flash"), 600);
}
