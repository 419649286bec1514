// Plots that a reader opens: quantities of one unit side by side, of all runs at once.

const MOST_CURVES = 8, MOST_PLOTS = 6;

// What names begin and end with alike, whole words of them.
function common(names) {
  const words = names.map((n) => n.split(".")), least = Math.min(...words.map((w) => w.length)) - 1;
  let a = 0, b = 0;
  while (a < least && words.every((w) => w[a] === words[0][a])) a++;
  while (b < least - a && words.every((w) => w[w.length - 1 - b] === words[0][words[0].length - 1 - b])) b++;
  const cut = (name) => name.split(".").slice(a, b ? -b : undefined).join(".");
  return { cut, title: [...words[0].slice(0, a), ...(b ? words[0].slice(-b) : [])].join(".") };
}

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
    for (const [unitName, some] of units) {
      const key = some.join(" "), there = this.plots.find((p) => p.key === key);
      if (there) { there.box.scrollIntoView({ block: "nearest" }); flash(there.box); continue; }
      this.openOne(some.slice(0, MOST_CURVES), unitName, title, key);
    }
    this.show();
  },
  openOne(names, unitName, title, key) {
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
    const bands = this.heads[0].words.expect.filter((v) => names.length === 1 && v.quantity === names[0]
      && v.over && ["mean", "final", "min", "max"].includes(v.statistic))
      .map((v) => ({ from: v.over[0], to: v.over[1], low: v.low, high: v.high, ok: v.ok }));
    const made = plot(this.meters, {
      title: names.length === 1 ? names[0] : title || alike.title || unitName, unit: unitName,
      names: labels, short: words, time: [...time], rows: rows.map((r) => Array.from(r, (v) => (Number.isNaN(v) ? null : v))),
      bands, inks, seek: (t) => this.hold(t), close: () => { this.plots = this.plots.filter((p) => p !== made); } });
    made.key = key;
    this.plots.push(made);
  },
  // At first: what the header names, by unit and last word, as many as are readable.
  openFirst() {
    const groups = new Map();
    for (const name of this.heads[0].plots) {
      const of = this.series.find((s) => s.has(name));
      if (!of) continue;
      const key = `${of.unit(name)} ${name.slice(name.lastIndexOf(".") + 1)}`;
      if (!groups.has(key)) groups.set(key, []);
      groups.get(key).push(name);
    }
    const most = this.heads.length > 1 ? 2 : MOST_CURVES;
    const wanted = [...groups].flatMap(([key, names]) => {
      const found = [];
      for (let i = 0; i < names.length; i += most) {
        const some = names.slice(i, i + most);
        found.push([some, some.length > 1 ? key.slice(key.indexOf(" ") + 1) : ""]);
      }
      return found;
    });
    for (const [names, title] of wanted.slice(0, MOST_PLOTS)) this.open(names, title);
  },
  adder() {
    const list = el("datalist", { id: "quantities" }), every = new Set(this.series.flatMap((s) => [...s.keys()]));
    const fill = () => {
      if (!list.children.length) list.append(...[...every].map((name) => el("option", { value: name })));
    };
    const input = el("input", { type: "search", id: "add", placeholder: "plot a quantity, or a pattern such as *.tension",
                                ariaLabel: "plot a quantity", autocomplete: "off" });
    input.setAttribute("list", "quantities");
    const said = el("output", { className: "said" });
    input.onfocus = fill;
    input.onchange = () => {
      const text = input.value.trim();
      if (!text) return;
      const names = matching(text, [...every]);
      said.textContent = names.length ? "" : `no quantity fits ${text}`
        + (nearest(text, [...every]) ? `; did you mean ${nearest(text, [...every])}?` : "");
      if (names.length) { this.open(names, text); input.value = ""; }
    };
    return el("div", { className: "adder" }, input, list, said);
  },
});

function matching(pattern, names) {
  if (names.includes(pattern)) return [pattern];
  const test = new RegExp(`^${pattern.split("*").map((s) => s.replace(/[.+?^${}()|[\]\\]/g, "\\$&")).join(".*")}$`);
  return names.filter((name) => test.test(name));
}

function nearest(text, names) {                           // by pairs of letters that both have
  const pairs = (s) => new Set(Array.from({ length: Math.max(0, s.length - 1) }, (_, i) => s.slice(i, i + 2)));
  const own = pairs(text.toLowerCase());
  let best = "", most = 0.4;
  for (const name of names) {
    const other = pairs(name.toLowerCase());
    const both = [...own].filter((p) => other.has(p)).length, share = 2 * both / (own.size + other.size || 1);
    if (share > most) { most = share; best = name; }
  }
  return best;
}

function flash(box) {
  box.classList.add("flash");
  setTimeout(() => box.classList.remove("flash"), 600);
}
