// What a page and a live view have around their stages: buttons, keys, the field that finds
// quantities, the body that the camera goes along with.

function button(id, text, title, act) {
  const b = el("button", { id, textContent: text, title });
  b.onclick = act;
  return b;
}

// A box that lists the keys, and below them how the pointer is used.
function keysBox(root, keys, pointer) {
  const box = el("dialog", { className: "help" }, el("h2", { textContent: "keys" }), el("dl", {},
    ...keys.flatMap(([key, what]) => [el("dt", { textContent: key }), el("dd", { textContent: what })])),
    el("p", { textContent: pointer }));
  box.append(button("", "close", "", () => box.close()));
  root.append(box);
  return box;
}

// Do what keys ask, but not while something is typed; `free` says whether they count at all.
function onKeys(acts, free) {
  const quiet = "input:not([type=range]):not([type=checkbox]), select, textarea";
  addEventListener("keydown", (e) => {
    const on = (what) => e.target.matches && e.target.matches(what), slid = on("input[type=range]");
    if (on(quiet) || e.ctrlKey || e.metaKey || e.altKey || !acts[e.key] || !free()) return;
    if (e.key === " " && on("button, summary")) return;
    if (slid && e.target.dataset.control && /^(Arrow|Home|End|Page)/.test(e.key)) return;   // it moves
    e.preventDefault();
    acts[e.key](e);
  });
}

// Draw anew when the room for some stages changes, or day and night; `dressed` gives what has colours.
function onLooks(box, dressed, redraw) {
  new ResizeObserver(redraw).observe(box);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    for (const one of dressed()) one.dress();
    redraw();
  });
}

// How fast, of SPEEDS or as `speed` says, which then is one of them; set(speed) is asked for it.
function speedBox(set) {
  const box = el("select", { title: "speed ([ and ])", ariaLabel: "speed", id: "speed" });
  const every = () => [...box.options].map((one) => +one.value);
  box.take = (speed) => {
    const all = [...new Set([...SPEEDS, speed])].sort((a, b) => a - b);
    box.replaceChildren(...all.map((v) => el("option", { value: String(v), textContent: `${v}\u00d7` })));
    box.value = String(speed);
  };
  box.faster = (way) => set(every()[clamp(every().indexOf(+box.value) + way, 0, box.options.length - 1)]);
  box.onchange = () => set(+box.value);
  return box;
}

// Which body the camera goes along with; `stages` gives those that do. fill() lists the first one's.
function followBox(stages, redraw) {
  const box = el("select", { title: "the camera goes along with a body", ariaLabel: "follow" });
  box.fill = () => {
    const [{ head, follow }] = stages();
    box.replaceChildren(el("option", { value: "-1", textContent: "follow nothing" }),
      ...head.bodies.flatMap((b, i) => (b.fixed ? [] : [el("option", { value: String(i), textContent: b.name })])));
    box.value = String(follow);
  };
  box.onchange = () => {
    const all = stages(), { name } = all[0].head.bodies[+box.value] || {};
    for (const s of all) s.follow = s.head.bodies.findIndex((body) => body.name === name);
    redraw();
  };
  return box;
}

const STEP = 40;                                          // by which a key moves a picture [px]
function moves(stages, redraw) {                          // keys that move pictures
  const by = (x, y) => () => { for (const { pan } of stages()) { pan[0] += x; pan[1] += y; } redraw(); };
  return { ",": by(STEP, 0), ".": by(-STEP, 0), ArrowUp: by(0, STEP), ArrowDown: by(0, -STEP) };
}
function fitAll(stages, redraw) {
  for (const s of stages) s.fit();
  redraw();
}
function zoomAll(stages, factor, redraw) {
  for (const s of stages) s.zoomAt(factor, s.w / 2, (s.h - s.foot) / 2);
  redraw();
}

// A field that takes the name of a quantity or a pattern. `every` gives the names there are,
// found(names, text) what to do with those that fit, missed(text) what to say where none does; `late` are names that
// are not offered, and count where no other fits. Who can look for pairs of bodies is given what none fits, by `pairs`.
function finder(what, every, found, missed, late = () => [], pairs = null) {
  const list = el("datalist", { id: "quantities" });
  const input = el("input", { type: "search", id: "add", placeholder: `${what}, or a pattern such as *.tension`,
                              ariaLabel: what, autocomplete: "off", maxLength: 1000 });
  input.setAttribute("list", "quantities");
  input.onfocus = () => {
    if (!list.children.length) list.append(...every().map((name) => el("option", { value: name })));
  };
  input.onchange = () => {
    const text = input.value.trim();
    if (!text) return;
    const fitting = matching(text, every()), names = fitting.length ? fitting : matching(text, late());
    if (!names.length && pairs && text.includes("/")) { pairs(text); input.value = ""; return; }
    const near = names.length ? "" : nearest(text, [...every(), ...late()]);
    missed(names.length ? "" : `no quantity fits ${text}${near ? `; did you mean ${near}?` : ""}`);
    if (names.length) { found(names, text); input.value = ""; }
  };
  const box = el("div", { className: "adder" }, input, list);
  box.renew = () => list.replaceChildren();
  return box;
}

// What the box beside the pointer says of what it points at; read(name) tells a quantity's value.
function toldOf(pick, series, read) {
  const lines = [pick.n];
  if (pick.row) return [...lines, `${short(Math.hypot(pick.row[2], pick.row[3]))} N`];
  for (const name of quantitiesOf(pick, series).slice(0, 6)) {
    const text = read(name);
    if (text) lines.push(`${name.slice(pick.n.length + 1) || "value"}  ${text}`);
  }
  return lines;
}
