// Sliders, typed values and switches of what can be set while a scene runs.

const HEADINGS = { parameter: "parameters", drive: "drives", target: "targets", switch: "controllers" };

const BEYOND = 10;                                       // times its own span a slider goes for a typed value

// A typed value: a number, or a number with a unit. null where it is neither.
function typed(text, unitName) {
  const found = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*)?$/.exec(text.replace("\u2212", "-"));
  if (!found) return null;
  return { value: Number(found[1]), unit: (found[2] || unitName).trim() };
}

class Controls {
  constructor(parent, set) {                              // set(name, value): asks for it
    this.set = set; this.rows = new Map();
    this.box = el("section", { className: "controls", ariaLabel: "what can be set" });
    parent.append(this.box);
  }
  show(list) {                                            // again with other values, or anew
    const same = list.length === this.rows.size && list.every((c) => this.rows.has(c.name) && this.rows.get(c.name).unit === c.unit);
    if (!same) this.build(list);
    for (const control of list) this.rows.get(control.name).take(control);
  }
  build(list) {
    this.rows.clear();
    this.box.replaceChildren();
    let heading = "";
    for (const control of list) {
      if (HEADINGS[control.kind] !== heading) {
        heading = HEADINGS[control.kind];
        this.box.append(el("h2", { textContent: heading }));
      }
      const row = control.kind === "switch" ? this.toggle(control) : this.slider(control);
      this.rows.set(control.name, row);
      this.box.append(row.box);
    }
    this.box.hidden = !list.length;
  }
  toggle({ name }) {
    const input = el("input", { type: "checkbox" });
    input.dataset.control = name;
    input.onchange = () => this.set(name, input.checked ? 1 : 0);
    const box = el("label", { className: "control" }, input);
    box.append(name.replace(/\.active$/, ""));
    return { box, unit: "", take: (c) => { input.checked = c.value !== 0; }, follow: () => {} };
  }
  slider(control) {
    const { name, kind, unit: unitName } = control, label = name.replace(/^parameters\./, "");
    const range = el("input", { type: "range", step: "any", min: control.low, max: control.high, ariaLabel: label });
    const text = el("input", { type: "text", inputMode: "decimal", ariaLabel: `${label}, typed`, size: 8, maxLength: 200 });
    range.dataset.control = name; text.dataset.typed = name;
    const words = el("span", { className: "name", textContent: label, title: label });
    const box = el("div", { className: "control" }, words, range, text,
                   el("span", { className: "unit", textContent: unitName }));
    const state = { touched: false, typing: false, value: control.value };
    const most = BEYOND * Math.max(-control.low, control.high);
    const ask = (value, given = unitName) => {
      state.value = value;
      this.set(name, kind === "parameter" && given ? `${value} ${given}` : value);
    };
    range.oninput = () => { state.touched = true; const v = +(+range.value).toPrecision(6); text.value = short(v); ask(v); };
    text.oninput = () => { state.typing = true; };
    text.onchange = () => {
      state.typing = false;
      const found = typed(text.value, unitName);
      if (!found || (kind !== "parameter" && found.unit !== unitName)) {
        this.set(name, text.value);                       // which is answered by what is wrong with it, or what it is in SI
        text.value = short(state.value);
        if (found) return;
        text.classList.add("wrong");
        setTimeout(() => text.classList.remove("wrong"), 900);
        return;
      }
      state.touched = true;
      if (found.unit === unitName) show(found.value);
      ask(found.value, found.unit);
    };
    const show = (value) => {
      state.value = value;
      if (value > +range.max) range.max = Math.min(2 * value, most);
      if (value < +range.min) range.min = Math.max(2 * value, -most);
      if (!state.typing) text.value = short(value);
      range.value = value;
    };
    return {
      box, unit: unitName,
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
  follow(drive) { for (const row of this.rows.values()) row.follow(drive); }
}
