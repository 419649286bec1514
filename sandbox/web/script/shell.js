// What report and live view have in common: pointer and keys on a Stage, pictures, films.

// Names of the quantities of a picked element.
function quantitiesOf(pick, series) {
  if (pick.n.includes("/")) {
    const [a, b] = pick.n.split("/");
    return [`${a}/${b}.normal`, `${b}/${a}.normal`].filter((name) => series.has(name));
  }
  return [...series.keys()].filter((name) => name === pick.n
    || (name.startsWith(`${pick.n}.`) && !name.slice(pick.n.length + 1).includes("contact.f")));
}

function save(blob, name) {
  const link = el("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
const fileName = (text) => text.replace(/[^A-Za-z0-9_.-]+/g, "_").slice(0, 60) || "run";

function button(id, textContent, title, onclick, className = "") {
  return el("button", { id, textContent, title, onclick, className });
}

function fold(title, ...kids) {
  return el("details", {}, el("summary", { textContent: title }), ...kids);
}

const STEP = 40;                                          // by which a key moves a picture [px]
// Subclasses have stages, plots, head, t and redraw(), and may have setSpeed(speed) and grab().
class Viewer {
  constructor(pointer, keys) {                            // keys: [names, words, {key: act}]
    this.play = button("play", "\u25b6", "run or pause (space)", () => this.toggle());
    this.clock = el("output", { id: "clock" });
    this.tip = el("div", { className: "tip", hidden: true });
    this.sheets = el("div", { className: "sheets" });
    this.follow = el("select", { title: "the camera goes along with a body", ariaLabel: "follow", onchange: () => {
      const { name } = this.head.bodies[+this.follow.value] || {};
      for (const s of this.stages) s.follow = s.head.bodies.findIndex((body) => body.name === name);
      this.redraw();
    } });
    this.speeds = el("select", { title: "speed ([ and ])", ariaLabel: "speed", id: "speed", onchange: () => this.setSpeed?.(+this.speeds.value) });
    keys.push(["[ and ]", "slower, faster", { "[": () => this.faster(-1), "]": () => this.faster(1) }],
      ["+, -", "zoom", { "+": () => this.zoom(1.25), "-": () => this.zoom(0.8) }],
      [", . up, down", "move the picture", { ",": () => this.move(STEP, 0), ".": () => this.move(-STEP, 0),
                                             ArrowUp: () => this.move(0, STEP), ArrowDown: () => this.move(0, -STEP) }],
      ["0", "fit", { 0: () => this.fit() }], ["s", "save the picture", { s: () => this.picture() }],
      ["?", "these keys", { "?": () => this.help.showModal() }]);
    this.help = el("dialog", { className: "help" }, el("h2", { textContent: "keys" }), el("table", {},
      ...keys.map((words) => el("tr", {}, ...words.slice(0, 2).map((textContent) => el("td", { textContent }))))),
      el("p", { textContent: pointer }), button("", "close", "", () => this.help.close()));
    addEventListener("keydown", (e) => {
      const on = (what) => e.target.matches?.(what), act = keys.find(([,, acts]) => e.key in acts)?.[2][e.key];
      if (!act || !this.stages.length || this.help.open || e.ctrlKey || e.metaKey || e.altKey) return;
      if (on("input:not([type=range]):not([type=checkbox]), select, textarea") || (e.key === " " && on("button, summary"))) return;
      if (on("input[type=range][data-control]") && /^(Arrow|Home|End|Page)/.test(e.key)) return;   // moves the slider
      e.preventDefault();
      act(e);
    });
    DARK.addEventListener("change", () => {
      for (const one of [...this.stages, ...this.plots]) one.dress();
      this.redraw();
    });
  }
  offerSpeed(speed) {                                     // one of SPEEDS, or one more
    const all = [...new Set([...SPEEDS, speed])].sort((a, b) => a - b);
    this.speeds.replaceChildren(...all.map((value) => el("option", { value, textContent: `${value}\u00d7` })));
    this.speeds.value = speed;
  }
  faster(way) {
    this.speeds.selectedIndex = clamp(this.speeds.selectedIndex + way, 0, this.speeds.length - 1);
    this.speeds.onchange();
  }
  // Wheel zooms at the pointer, drag pans, double click fits, two fingers pinch. grab(pick, x, y) of a subclass
  // may take a drag for itself and answers with {move, drop}.
  camera(stage, series, read) {
    const { canvas } = stage, down = new Map(), at = (e) => [e.offsetX, e.offsetY];
    const middle = (all) => [0, 1].map((k) => (all[0][k] + all.at(-1)[k]) / 2), spread = (all) => apart(all[0], all.at(-1));
    let moved = 0, grip = null;
    canvas.addEventListener("wheel", (e) => {
      e.preventDefault();
      stage.zoomAt(Math.exp(-clamp(e.deltaY, -300, 300) / 400), ...at(e));
      this.redraw();
    }, { passive: false });
    canvas.onpointerdown = (e) => {
      canvas.setPointerCapture(e.pointerId);
      down.set(e.pointerId, at(e));
      moved = 0;
      grip = down.size === 1 ? this.grab?.(stage.pick(...at(e)), ...at(e)) : null;
    };
    canvas.onpointermove = (e) => {
      const was = down.get(e.pointerId), now = at(e);
      if (!was) {
        const found = stage.pick(...now), before = stage.hover;
        stage.hover = found;
        canvas.style.cursor = found ? "pointer" : "grab";
        this.point(found, e, series, read);
        if (found?.n !== before?.n || found?.value !== before?.value) this.redraw();
        return;
      }
      const before = [...down.values()], after = [...down.set(e.pointerId, now).values()];
      moved += apart(was, now);
      if (grip) { grip.move(...now); return; }
      if (moved <= 3) return;
      middle(after).forEach((at, k) => { stage.pan[k] += at - middle(before)[k]; });
      if (after.length > 1) stage.zoomAt(spread(after) / (spread(before) || 1), ...middle(after));
      this.redraw();
    };
    canvas.onpointerup = canvas.onpointercancel = (e) => {
      if (down.delete(e.pointerId) && grip) { grip.drop(); grip = null; }
      else if (e.type === "pointerup" && moved <= 3) this.click(stage.pick(...at(e)), series);
    };
    canvas.onpointerleave = () => { stage.hover = null; this.tip.hidden = true; this.redraw(); };
    new ResizeObserver(() => { stage.size = null; this.redraw(); }).observe(canvas);
    canvas.ondblclick = () => { stage.fit(); this.redraw(); };
  }
  get playing() { return this.on; }
  set playing(on) {
    this.on = on;
    this.play.textContent = on ? "\u275a\u275a" : "\u25b6";
    this.play.ariaLabel = on ? "pause" : "play";
  }
  tools(...more) {
    this.film = button("film", "film", "record the motion as a film", () => this.record());
    return el("div", { className: "tools" }, button("fit", "fit", "show all (0)", () => this.fit()), this.follow,
      button("picture", "picture", "save this picture (s)", () => this.picture()), this.film, ...more,
      button("help", "?", "keys", () => this.help.showModal()));
  }
  followable() {                                          // the bodies of the first stage
    this.follow.replaceChildren(el("option", { value: "-1", textContent: "follow nothing" }), ...this.head.bodies.flatMap((b, i) => (
      b.fixed ? [] : [el("option", { value: String(i), textContent: b.name })])));
    this.follow.value = String(this.stages[0].follow);
  }
  layerBoxes(changed) {                                   // folded where they would be larger than the picture
    const [{ layers }] = this.stages;
    const box = fold("layers", el("div", { className: "layers" }, ...this.head.layers.map(({ name, words, about }) => {
      const tick = el("input", { type: "checkbox", checked: layers.has(name), "data-layer": name, onchange: () => {
        for (const s of this.stages) if (tick.checked) s.layers.add(name); else s.layers.delete(name);
        changed();
      } });
      return el("label", { title: about }, tick, words);
    })));
    box.open = innerWidth > 900;
    return box;
  }
  point(pick, e, series, read) {                          // values beside the pointer; read(name) is a text
    const { tip } = this;
    tip.hidden = !pick;
    if (!pick) return;
    const lines = pick.value ? [pick.value] : quantitiesOf(pick, series).slice(0, 6).flatMap((name) => {
      const text = read(name);
      return text ? [`${name.slice(pick.n.length + 1) || "value"}  ${text}`] : [];
    });
    tip.replaceChildren(...[pick.n, ...lines].map((text) => el("div", { textContent: text })));
    tip.style.left = `${clamp(e.clientX + 14, 4, Math.max(4, innerWidth - tip.offsetWidth - 6))}px`;
    tip.style.top = `${clamp(e.clientY + 16, 4, Math.max(4, innerHeight - tip.offsetHeight - 6))}px`;
  }
  fit() { for (const s of this.stages) s.fit(); this.redraw(); }
  zoom(factor) { for (const s of this.stages) s.zoomAt(factor, s.w / 2, (s.h - s.foot) / 2); this.redraw(); }
  move(x, y) { for (const { pan } of this.stages) { pan[0] += x; pan[1] += y; } this.redraw(); }
  picture() {
    drawAll(this.sheets).toBlob((blob) => save(blob, `${fileName(this.head.name)}_${this.t.toFixed(3)}s.png`));
  }
  record(begin = () => {}) {                              // begin or end a film
    if (this.filming) { this.filming.stop(); return; }
    const type = ["video/mp4;codecs=avc1", "video/webm;codecs=vp9", "video/webm"].find((k) => globalThis.MediaRecorder?.isTypeSupported(k));
    if (!type) { this.film.textContent = "no film in this browser"; return; }
    begin();
    const canvas = drawAll(this.sheets), pieces = [];
    const recorder = new MediaRecorder(canvas.captureStream(60), { mimeType: type, videoBitsPerSecond: 8e6 });
    recorder.ondataavailable = (e) => pieces.push(e.data);
    recorder.onstop = () => {
      save(new Blob(pieces, { type }), `${fileName(this.head.name)}.${type.slice(6).split(";")[0]}`);
      this.filming = null;
      this.film.textContent = "film";
    };
    recorder.start();
    this.filming = { frame: () => drawAll(this.sheets, canvas), stop: () => { if (recorder.state !== "inactive") recorder.stop(); } };
    this.film.textContent = "stop the film";
  }
}

// A field for the name of a quantity or a pattern, of `every()`. Calls found(names, text), also if there are none.
function finder(what, every, found) {
  const list = el("datalist", { id: "quantities" });
  const input = el("input", {
    type: "search", id: "add", placeholder: `${what}, or a pattern such as *.tension`, ariaLabel: what, autocomplete: "off", maxLength: 1000,
    onfocus: () => list.replaceChildren(...every().map((name) => el("option", { value: name }))),
    onchange: () => {
      const text = input.value.trim(), names = matching(text, every());
      if (text) found(names, text);
      if (names.length) input.value = "";
    },
  });
  input.setAttribute("list", "quantities");
  return el("div", { className: "adder" }, input, list);
}

// Draw all pictures and their names as they stand in a box on one canvas, which keeps its size.
function drawAll(box, given) {
  const all = box.getBoundingClientRect(), [width, height] = [all.width, all.height].map((v) => 2 * Math.ceil(v * (devicePixelRatio || 1) / 2));
  const canvas = given || el("canvas", { width, height }), { width: w, height: h } = canvas;   // films want even sides
  const ctx = canvas.getContext("2d"), k = Math.min(w / all.width, h / all.height);
  ctx.setTransform(1, 0, 0, 1, 0, 0);
  ctx.fillStyle = getComputedStyle(box.parentElement).backgroundColor; ctx.fillRect(0, 0, w, h);
  ctx.setTransform(k, 0, 0, k, -k * all.left, -k * all.top);
  for (const one of box.querySelectorAll("h2, canvas")) {
    const { left, top, width, height } = one.getBoundingClientRect(), style = getComputedStyle(one), bar = parseFloat(style.borderLeftWidth);
    if (!width) continue;
    if (one.getContext) { ctx.drawImage(one, left, top, width, height); continue; }
    ctx.fillStyle = style.borderLeftColor; ctx.fillRect(left, top, bar, height);
    ctx.fillStyle = style.color; ctx.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`; ctx.textBaseline = "middle";
    ctx.fillText(one.textContent, left + bar + 6, top + height / 2, width - bar - 6);
  }
  return canvas;
}
