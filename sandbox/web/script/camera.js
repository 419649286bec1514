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
