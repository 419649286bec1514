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
