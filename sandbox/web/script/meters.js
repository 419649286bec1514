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
