// The page of a report: runs with one clock, plots beside them, results below.

const SPEEDS = [0.02, 0.05, 0.1, 0.25, 0.5, 1, 2];
const POINTER = "Wheel or two fingers zoom, drag moves, double click fits. Point at anything for its values, click it for "
  + "its plot. Click in a plot to go to that time, drag in it to zoom.";

const MOST_CURVES = 8, MOST_PLOTS = 12, AT_FIRST = 2;
const parted = (all, size) => Array.from({ length: Math.ceil(all.length / size) }, (_, i) => all.slice(i * size, (i + 1) * size));

function marksOf(heads) {                                 // events and failed expectations, in order; those without a window are at the end
  return heads.flatMap(({ words }) => [
    ...words.events.map((e) => ({ t: e.t, text: `${e.name} at ${short(e.t)} s`, bad: false })),
    ...words.expect.filter((v) => !v.ok).map((v) => ({ t: v.over ? v.over[1] : Infinity,
      text: `${v.quantity} ${v.statistic}: ${v.reason || "out of its range"}`, bad: true }))])
    .sort((a, b) => a.t - b.t);
}

class Report extends Viewer {
  constructor(root, runs) {
    const heads = runs.map((run) => run.head), marks = marksOf(heads), many = runs.length > 1;
    super(POINTER, [
      ["space", "play or pause", { " ": () => this.toggle() }],
      ["left, right", "one sample back or on; with shift ten", { ArrowLeft: (e) => this.go(-1, e), ArrowRight: (e) => this.go(1, e) }],
      ["home, end", "first or last instant", { Home: () => this.hold(this.first), End: () => this.hold(this.last) }],
      ...(marks.length ? [["n, p", "next or previous mark on the bar", { n: () => this.jump(1), p: () => this.jump(-1) }]] : []),
      ["l", "loop", { l: () => this.loops.click() }],
      ...(many ? [["g", "side by side or over each other", { g: () => this.lay() }]] : [])]);
    addEventListener("hashchange", () => this.hold(this.askedTime(this.t)));
    Object.assign(this, { runs, head: heads[0], marks, plots: [], t: 0, drawn: 0, playing: false, over: false });
    this.first = Math.min(...runs.map((r) => r.first));
    this.last = Math.max(...runs.map((r) => r.last));
    this.step = Math.min(...heads.map((h) => 1 / h.words.rate));
    this.meters = el("section", { className: "plots", ariaLabel: "plots" });
    const bench = el("section", { className: "bench", ariaLabel: "motion" }, this.sheets);
    root.replaceChildren(banner(heads), el("div", { className: "top" }, bench, this.meters),
      el("section", { className: "facts", ariaLabel: "results" }, ...heads.flatMap((head, i) => factsOf(head, many ? ` of run ${i + 1}` : ""))),
      this.tip, this.help);
    this.stages = runs.map((run, i) => {
      const stage = new Stage(run.head, "click an element for its plot"), name = el("h2", { textContent: `${i + 1}  ${run.head.words.apart}` });
      name.style.borderColor = INKS[i];
      this.sheets.append(el("div", { className: "sheet" }, ...(many ? [name] : []), stage.canvas));
      this.camera(stage, run, (quantity) => run.text(quantity, this.t));
      return stage;
    });
    bench.append(this.bar(), this.tools(), this.layerBoxes(() => this.redraw()));
    this.openFirst();
    this.seek(this.askedTime(this.first));
  }
  click(pick, run) { if (pick) this.open(quantitiesOf(pick, run).slice(0, 3), pick.n); }

  // -- time ------------------------------------------------------------------------------------------
  redraw() {
    const texts = !this.playing || this.filming || ++this.drawn % 3 === 0;   // of a motion in every third frame
    const frames = this.runs.map((run) => run.frame(this.t));
    const seen = this.stages.slice(0, this.over ? 1 : undefined);
    const ghosts = this.stages.slice(seen.length).map(({ list }, k) => ({ list, frame: frames[k + 1], colour: inkOf(k + 1) }));
    for (const stage of seen) stage.resize();
    const lines = Math.max(...seen.map((stage) => stage.lines));
    seen.forEach((stage, i) => {                          // drawings beside each other stand at one height
      Object.assign(stage, { lines, keepTexts: !texts, moving: this.playing });
      if (texts) stage.stamp = `t = ${Math.min(this.t, this.runs[i].last).toFixed(3)} s`;
      stage.draw(frames[i], ghosts);
    });
    if (texts) { this.scrub.value = this.t; this.clock.textContent = `${this.t.toFixed(3)} s`; }
    for (const one of this.plots) one.at(this.t, texts);
    if (this.filming) this.filming.frame();
  }
  seek(t) {
    this.t = clamp(t, this.first, this.last);
    this.redraw();
    if (!this.playing) this.remember();
  }
  hold(t) { this.playing = false; this.seek(t); }
  go(way, { shiftKey }) { this.hold(this.t + (shiftKey ? 10 : 1) * way * this.step); }
  remember() {
    clearTimeout(this.later);
    this.later = setTimeout(() => {
      try { history.replaceState(null, "", `#t=${+this.t.toFixed(4)}`); } catch { /* in a frame of others */ }
    }, 150);
  }
  askedTime(otherwise) {
    const t = parseFloat(new URLSearchParams(location.hash.slice(1)).get("t"));
    return Number.isFinite(t) ? t : otherwise;
  }
  toggle() {
    this.playing = !this.playing;
    if (this.playing) {
      if (this.t >= this.last - 1e-9) this.t = this.first;
      this.before = null;
      requestAnimationFrame((now) => this.tick(now));
    }
    this.seek(this.t);
  }
  tick(now) {
    if (!this.playing) return;
    let t = this.t + (this.before === null ? 0 : (now - this.before) / 1000) * +this.speeds.value;
    this.before = now;
    if (t > this.last) {
      if (this.loops.checked && !this.filming) t = this.first; else this.playing = false;
    }
    this.seek(t);
    if (this.playing) requestAnimationFrame((next) => this.tick(next)); else this.filming?.stop();
  }
  jump(way) {
    const times = this.marks.map((m) => Math.min(m.t, this.last));
    const next = way > 0 ? times.find((t) => t > this.t + 1e-6) : times.findLast((t) => t < this.t - 1e-6);
    if (next !== undefined) this.hold(next);
  }

  // -- controls ------------------------------------------------------------------------------------------
  bar() {
    this.scrub = el("input", { type: "range", id: "scrub", min: this.first, max: this.last, step: "any", ariaLabel: "time",
                               oninput: () => this.hold(+this.scrub.value) });
    const span = this.last - this.first || 1, ticks = this.marks.map((mark) => {
      const tick = el("i", { className: mark.bad ? "mark bad" : "mark", title: mark.text });
      tick.style.left = `${100 * clamp((mark.t - this.first) / span, 0, 1)}%`;
      return tick;
    });
    this.offerSpeed(this.head.view.speed);
    this.loops = el("input", { type: "checkbox", checked: true });
    return el("div", { className: "bar" }, this.play, el("div", { className: "track" }, this.scrub, ...ticks), this.clock, this.speeds,
              el("label", { title: "begin again at the end (l)" }, this.loops, "loop"));
  }
  tools() {
    const box = super.tools();
    this.followable();
    if (this.runs.length > 1) {
      this.layer = button("over", "over each other", "runs side by side or as ghosts (g)", () => this.lay());
      box.prepend(this.layer);
    }
    return box;
  }
  lay() {
    this.over = this.sheets.classList.toggle("over");
    this.layer.textContent = this.over ? "side by side" : "over each other";
    this.redraw();
  }
  record() {
    if (this.filming) this.playing = false;
    super.record(() => { if (this.playing) this.toggle(); this.seek(this.first); });
    if (this.filming && !this.playing) this.toggle();
  }

  // -- plots that a reader opens: quantities of one unit, of all runs at once --------------------------------
  known(names) { return names.filter((name) => this.runs.some((run) => run.has(name))); }
  unit(name) { return this.runs.find((run) => run.has(name)).unit(name); }
  grouped(names, keyOf) { return [...Map.groupBy(this.known(names), keyOf).values()]; }
  open(names, title = "") {
    const plots = this.grouped(names, (name) => this.unit(name)).flatMap((all) => parted(all, MOST_CURVES));
    for (const some of plots.slice(0, MOST_PLOTS)) {
      const there = this.plots.find((p) => p.key === some.join(" "));
      if (there) there.box.scrollIntoView({ block: "nearest" }); else this.openOne(some, { title: some.length > 1 ? title : "" });
    }
    this.redraw();
    return plots.length;
  }
  openOne(names, { title, range, number }) {
    const sets = this.runs.map((run, k) => ({ run, k, own: curvesOf(names).filter(({ name }) => run.has(name)) })).filter(({ own }) => own.length);
    const tables = sets.map(({ run, own }) => [run.times, ...own.map(({ name }) => run.row(name))]);
    const curves = this.runs.length === 1 ? sets[0].own : sets.flatMap(({ k, own }) => own.map(({ name, word }, dash) => (
      { name: `${name} (${k + 1})`, word: `${word} (${k + 1})`.trim(), ink: k, dash })));
    const [time, ...rows] = tables.length > 1 ? uPlot.join(tables, tables.map((t) => t.map(() => 2))) : tables[0];
    const bands = names.length === 1 ? this.bands(names[0]) : [];
    const made = plot(this.meters, {
      title: title || common(names).title, unit: this.unit(names[0]), range, number, bands, curves,
      time: [...time], rows: rows.map((r) => Array.from(r, (v) => (Number.isNaN(v) ? null : v))),
      seek: (t) => this.hold(t), close: () => { this.plots = this.plots.filter((p) => p !== made); } });
    this.plots.push(Object.assign(made, { key: names.join(" "), bands }));
  }
  bands(name) {                                           // what runs expect of a quantity: what all of them do once, else that of each in its colour
    const every = this.runs.flatMap(({ head }, run) => head.words.expect.filter((v) => v.quantity === name && v.over && v.statistic !== "std")
      .map(({ statistic, over: [from, to], low, high, ok }) => ({ run, from, to, low, high, ok, mean: statistic === "mean" ? "mean" : "" })));
    const alike = Map.groupBy(every, ({ from, to, low, high, mean }) => [from, to, low, high, mean].join());
    return [...alike.values()].flatMap((some) => {
      const [{ mean }] = some, inks = [...new Set(some.map(({ run }) => run))], of = { ...some[0], ok: some.every((one) => one.ok) };
      return inks.length === this.runs.length ? { ...of, ink: null, word: mean }   // a curve need not lie in the band of its mean
        : inks.map((ink) => ({ ...of, ink, word: `expected ${mean} (${ink + 1})`.replace("  ", " ") }));
    });
  }
  // At first: the meters of the scene's view; then what else the header names, by unit and last word. The first
  // AT_FIRST are open, the others have a button each.
  openFirst() {
    const every = [...new Set(this.runs.flatMap((run) => [...run.keys()]))], said = el("output", { className: "said" });
    const box = finder("plot a quantity", () => every, (names, text) => {
      const count = this.open(names, text), near = nearest(text, every);
      said.textContent = count > MOST_PLOTS ? `${text} needs ${count} plots; these are the first ${MOST_PLOTS}`
        : count ? "" : `no quantity matches ${text}${near ? `; did you mean ${near}?` : ""}`;
    });
    box.append(said);
    const { meters, plots } = this.head, closed = el("div", { className: "closed" }), most = this.runs.length > 1 ? 2 : MOST_CURVES;
    const offers = meters.map((meter) => [this.known(meter.names), meter]).filter(([names]) => names.length)
      .map(([names, meter]) => [meter.title || common(names).title || names.join(", "), () => this.openOne(names, meter)]);
    const others = plots.filter((name) => !meters.some((meter) => meter.names.includes(name)));
    for (const names of this.grouped(others, (name) => `${this.unit(name)} ${name.split(".").at(-1)}`)) {
      const parts = parted(names, most), kinds = parts.map(common), alike = new Set(kinds.map(({ title }) => title)).size < parts.length;
      parts.forEach((some, i) => {
        const which = some.length > 2 ? `${i + 1} of ${parts.length}` : some.map(kinds[i].cut).join(", ");
        offers.push([kinds[i].title + (alike && some.length > 1 ? ` (${which})` : ""), () => this.open(some)]);
      });
    }
    this.meters.append(box);
    for (const [title, open] of offers.splice(0, AT_FIRST)) open();
    for (const [title, open] of offers.slice(0, MOST_PLOTS - AT_FIRST)) {
      const one = button("", `+ ${title}`, "plot this", () => { one.remove(); open(); });
      closed.append(one);
    }
    this.meters.append(closed);
  }
}

// What was found of runs, in words and tables; and how the page begins.

const UNIT = ["unit", ({ unit }) => (unit === "1" ? "" : unit)];
const COLUMNS = {
  expect: [["", (v) => (v.ok ? "pass" : "FAIL")], ["quantity", (v) => v.quantity], ["", (v) => v.statistic], ["value", (v) => short(v.value, 6)],
    ["range", (v) => v.allowed], UNIT, ["because", (v) => (v.ok ? v.because : v.reason || v.because)]],
  audit: [["", (f) => f.verdict], ["figure", (f) => f.name], ["value", (f) => short(f.value)], ["at most", (f) => short(f.threshold)],
    UNIT, ["comparison", (f) => f.why]],
};

function table(kind, rows) {
  const line = (tag, cells, className = "") => el("tr", { className }, ...cells.map(([of, textContent]) => el(tag, { textContent, "data-of": of })));
  const body = rows.map((row) => line("td", COLUMNS[kind].map(([of, read]) => [of, read(row)]), row.ok === false ? "bad" : row.verdict || "pass"));
  return el("div", { className: "wide" }, el("table", {}, el("thead", {}, line("th", COLUMNS[kind].map(([of]) => [of, of]))), el("tbody", {}, ...body)));
}

function banner(heads) {
  const { about } = heads[0].words, box = el("header", {}, el("h1", { textContent: [...new Set(heads.map((head) => head.title))].join(" / ") }));
  if (about) box.append(el("p", { className: "about", textContent: about }));
  heads.forEach(({ words }, i) => {
    const all = words.expect.length, passed = words.expect.filter((v) => v.ok).length, looks = words.audit.filter((f) => f.verdict === "look").length;
    const parts = [words.complete ? "" : `not complete: the run ${words.status}${words.reason && `, ${words.reason}`}`,
      all ? `${passed} of ${all} expectations passed` : "",
      looks ? `${looks} warning${looks > 1 ? "s" : ""}` : words.audit.length ? "all checks passed" : ""].filter(Boolean);
    const how = !words.complete || passed < all ? "bad" : looks ? "look" : parts.length ? "good" : "";
    const text = parts.join("; ") || "nothing was expected of this run";
    box.append(el("p", { className: `verdict ${how}`, textContent: heads.length > 1 ? `${i + 1}: ${text}` : text }));
  });
  return box;
}

function factsOf({ name, words, series, thinned }, whose) {
  const found = [], looks = words.audit.filter((f) => f.verdict === "look"), others = words.audit.filter((f) => f.verdict !== "look");
  const list = (items) => el("ul", {}, ...items.map((textContent) => el("li", { textContent }))), paragraph = (textContent, className = "") => el("p", { textContent, className });
  const add = (title, items, content) => { if (items.length) found.push(el("h2", { textContent: title + whose }), content(items)); };
  add("expectations", words.expect, (rows) => table("expect", rows));
  add("notes", words.notes, list);
  add("events", words.events, (all) => list(all.map((e) => `${e.name} at ${short(e.t)} s`)));
  add("warnings of the consistency checks", looks, (rows) => table("audit", rows));
  if (others.length) {
    found.push(fold(`consistency checks${whose}, as saved with the run: ${others.filter((f) => f.verdict === "pass").length} passed`, table("audit", others)));
  }
  const file = fileName(name), scene = el("pre"), versions = Object.entries(words.versions).map(([k, v]) => `${k} ${v}`);
  const text = fold(`scene${whose}`, button("", "save the scene", "", () => save(new Blob([words.scene], { type: "application/json" }), `${file}.json`)), scene);
  text.ontoggle = () => { scene.textContent ||= words.scene; };
  found.push(text, fold(`how to repeat it${whose}`,
    paragraph("Save the scene above and run it; the same versions on the same platform give the same numbers."),
    el("pre", { textContent: `sandbox run ${file}.json --out ${file}\nsandbox report ${file}` }),
    paragraph(`Made with ${versions.join(", ")}; steps of ${short(words.step)} s, ${words.samples} samples at ${short(words.rate)} Hz, ${series.length} quantities.`)));
  if (thinned.length) found.push(paragraph(`Thinned on this page${whose}: ${thinned.join("; ")}. The run itself has every sample.`, "thinned"));
  return found;
}

// The page: `scripts` hold the header of each run, and after each comes one with its numbers.
async function report(root, scripts) {
  try {
    const heads = scripts.map((s) => JSON.parse(s.textContent));
    const datas = await Promise.all(scripts.map((s, i) => unpack(heads[i], s.nextElementSibling.textContent)));
    globalThis.sandbox = new Report(root, heads.map((head, i) => new Run(head, datas[i])));
    document.documentElement.dataset.ready = "1";
    performance.mark("ready");
  } catch (error) {
    root.replaceChildren(el("p", { className: "verdict bad", textContent:
      `This page cannot be shown: ${error.message}. It needs a browser of 2024 or newer.` }));
    throw error;
  }
}
