// Mouse, fingers and keys on a Stage: zoom, pan, hover, click.

// Wheel zooms at the pointer, drag pans, double click fits, two fingers pinch. `hooks`: hover(pick,
// event), click(pick), grab(pick, x, y) may take a drag for itself and answers with {move, drop}.
function camera(stage, redraw, hooks = {}) {
  const { canvas } = stage, down = new Map();
  let pinch = 0, moved = 0, grip = null;
  const at = (e) => [e.offsetX, e.offsetY];
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    stage.zoomAt(Math.exp(-clamp(e.deltaY, -300, 300) / 400), ...at(e));
    redraw();
  }, { passive: false });
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    down.set(e.pointerId, at(e));
    pinch = 0; moved = 0;
    grip = down.size === 1 && hooks.grab ? hooks.grab(stage.pick(...at(e)), ...at(e)) : null;
  });
  canvas.addEventListener("pointermove", (e) => {
    const was = down.get(e.pointerId), now = at(e);
    if (!was) {
      const found = stage.pick(...now), before = stage.hover;
      stage.hover = found;
      canvas.style.cursor = found ? "pointer" : "grab";
      if (hooks.hover) hooks.hover(found, e);
      if ((found && found.n) !== (before && before.n) || !!(found && found.row) !== !!(before && before.row)) redraw();
      return;
    }
    moved += apart(was, now);
    down.set(e.pointerId, now);
    if (grip) { grip.move(...now); return; }
    if (down.size === 1 && moved > 3) {
      stage.pan[0] += now[0] - was[0]; stage.pan[1] += now[1] - was[1];
      redraw();
    } else if (down.size > 1) {
      const [p, q] = [...down.values()], d = apart(p, q);
      if (pinch) { stage.zoomAt(d / pinch, (p[0] + q[0]) / 2, (p[1] + q[1]) / 2); redraw(); }
      pinch = d;
    }
  });
  const up = (e) => {
    if (down.delete(e.pointerId) && grip) { grip.drop(); grip = null; }
    else if (e.type === "pointerup" && moved <= 3 && hooks.click) hooks.click(stage.pick(...at(e)), e);
    pinch = 0;
  };
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, up);
  canvas.addEventListener("pointerleave", () => {
    stage.hover = null;
    if (hooks.hover) hooks.hover(null);
    redraw();
  });
  canvas.addEventListener("dblclick", () => { stage.fit(); redraw(); });
}

// A box beside the pointer: the first line is a name.
function tooltip(root) {
  const box = el("div", { className: "tip", hidden: true });
  root.append(box);
  return (lines, e) => {
    box.hidden = !lines;
    if (!lines) return;
    box.replaceChildren(...lines.map((text) => el("div", { textContent: text })));
    const w = box.offsetWidth, h = box.offsetHeight;
    box.style.left = `${clamp(e.clientX + 14, 4, Math.max(4, innerWidth - w - 6))}px`;
    box.style.top = `${clamp(e.clientY + 16, 4, Math.max(4, innerHeight - h - 6))}px`;
  };
}

// Checkboxes of the layers that these stages have, folded where they would be larger than the picture.
function layerBoxes(stages, redraw) {
  const head = stages[0].head, box = fold("layers", el("div", { className: "layers" }, ...head.layers.map(({ name, words, about }) => {
    const tick = el("input", { type: "checkbox", checked: stages[0].layers.has(name) });
    tick.dataset.layer = name;
    tick.onchange = () => {
      for (const s of stages) if (tick.checked) s.layers.add(name); else s.layers.delete(name);
      redraw();
    };
    const label = el("label", { title: about }, tick);
    label.append(words);
    return label;
  })));
  box.open = innerWidth > 900;
  return box;
}

function save(blob, name) {
  const link = el("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
const fileName = (text) => text.replace(/[^A-Za-z0-9_.-]+/g, "_").slice(0, 60) || "run";

// Names of the quantities of what was picked, in the order in which they are looked at.
function quantitiesOf(pick, series) {
  if (pick.n.includes("/")) {
    const [a, b] = pick.n.split("/");
    return [`${a}/${b}.normal`, `${b}/${a}.normal`].filter((name) => series.has(name));
  }
  return [...series.keys()].filter((name) => name === pick.n
    || (name.startsWith(`${pick.n}.`) && !name.slice(pick.n.length + 1).includes("contact.f")));
}

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
class Viewer {                                            // what a report and a live view share: they have stages, head, t and redraw()
  tools(...more) {
    this.follow = followBox(() => this.stages, () => this.redraw());
    this.film = button("film", "film", "record the motion as a film", () => this.record());
    return el("div", { className: "tools" }, button("fit", "fit", "show all (0)", () => this.fit()), this.follow,
      button("picture", "picture", "save this picture (s)", () => this.picture()), this.film, ...more,
      button("help", "?", "keys", () => this.help.showModal()));
  }
  fit() { for (const s of this.stages) s.fit(); this.redraw(); }
  zoom(factor) { for (const s of this.stages) s.zoomAt(factor, s.w / 2, (s.h - s.foot) / 2); this.redraw(); }
  move(x, y) { for (const { pan } of this.stages) { pan[0] += x; pan[1] += y; } this.redraw(); }
  picture() { savePicture(this.stages, this.head.name, this.t); }
  record(begin = () => {}) {                              // begin or end a film
    if (this.filming) { this.filming.stop(); return; }
    if (!Filming.kind()) { this.film.textContent = "no film in this browser"; return; }
    begin();
    this.filming = new Filming(this.stages, this.head.name, () => { this.filming = null; this.film.textContent = "film"; });
    this.film.textContent = "stop the film";
  }
  listen(box, dressed, acts) {
    onKeys({
      "[": () => this.speeds.faster(-1), "]": () => this.speeds.faster(1), "+": () => this.zoom(1.25), "-": () => this.zoom(0.8),
      ",": () => this.move(STEP, 0), ".": () => this.move(-STEP, 0), ArrowUp: () => this.move(0, STEP), ArrowDown: () => this.move(0, -STEP),
      0: () => this.fit(), s: () => this.picture(), "?": () => this.help.showModal(), ...acts,
    }, () => this.stages.length && !this.help.open);
    onLooks(box, () => [...this.stages, ...dressed()], () => this.redraw());
  }
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

// Pictures and films of what is seen: all stages as they stand beside each other, under their names.

// Draw what is seen on one canvas; of a size that is given, so that the frames of a film are alike.
function seenOn(stages, canvas, size = null) {
  const boxes = stages.map((s) => s.canvas.parentElement.getBoundingClientRect());
  const [left, top] = [Math.min(...boxes.map((b) => b.left)), Math.min(...boxes.map((b) => b.top))];
  const [right, bottom] = [Math.max(...boxes.map((b) => b.right)), Math.max(...boxes.map((b) => b.bottom))];
  const dpr = stages[0].canvas.width / stages[0].canvas.clientWidth || 1;
  const [w, h] = size || [right - left, bottom - top].map((v) => 2 * Math.ceil(v * dpr / 2));   // films want even sides
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  const ctx = canvas.getContext("2d"), k = Math.min(w / (right - left), h / (bottom - top));
  ctx.setTransform(1, 0, 0, 1, 0, 0);
  ctx.fillStyle = stages[0].back; ctx.fillRect(0, 0, w, h);
  ctx.setTransform(k, 0, 0, k, 0, 0);
  for (const { canvas: one } of stages) {
    const name = one.parentElement.querySelector("h2"), box = one.getBoundingClientRect();
    if (name) heading(ctx, name, left, top);
    if (box.width) ctx.drawImage(one, box.left - left, box.top - top, box.width, box.height);
  }
  return [w, h];
}

function heading(ctx, name, left, top) {                  // as the page shows it
  const box = name.getBoundingClientRect(), style = getComputedStyle(name), bar = parseFloat(style.borderLeftWidth);
  ctx.fillStyle = style.borderLeftColor; ctx.fillRect(box.left - left, box.top - top, bar, box.height);
  ctx.fillStyle = style.color; ctx.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
  ctx.textBaseline = "middle"; ctx.textAlign = "left";
  ctx.fillText(fitting(ctx, name.textContent, box.width - bar - 6), box.left - left + bar + 6, box.top - top + box.height / 2);
}

function savePicture(stages, name, t) {
  const canvas = el("canvas");
  seenOn(stages, canvas);
  canvas.toBlob((blob) => save(blob, `${fileName(name)}_${t.toFixed(3)}s.png`));
}

// A film that is being made. frame() adds what is seen by now, stop() saves it and calls `ended`.
class Filming {
  static kind() {                                         // what this browser makes films of; undefined: none
    return ["video/mp4;codecs=avc1", "video/webm;codecs=vp9", "video/webm"].find((k) =>
      globalThis.MediaRecorder && MediaRecorder.isTypeSupported(k));
  }
  constructor(stages, name, ended) {
    this.canvas = el("canvas");
    this.size = seenOn(stages, this.canvas);
    const type = Filming.kind(), pieces = [];
    this.recorder = new MediaRecorder(this.canvas.captureStream(60), { mimeType: type, videoBitsPerSecond: 8e6 });
    this.recorder.ondataavailable = (e) => pieces.push(e.data);
    this.recorder.onstop = () => {
      save(new Blob(pieces, { type }), `${fileName(name)}.${type.slice(6).split(";")[0]}`);
      ended();
    };
    this.recorder.start();
  }
  frame(stages) { seenOn(stages, this.canvas, this.size); }
  stop() { if (this.recorder.state !== "inactive") this.recorder.stop(); }
}
