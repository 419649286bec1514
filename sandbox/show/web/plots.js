// Elements of the page, and plots with one time cursor.

const INKS = ["#0e4a9e", "#c1570b", "#2f7d63", "#7a3fb0", "#b01668", "#7a5c00"];
const PLOT_FONT = '11px "DejaVu Sans", system-ui, sans-serif';

function el(tag, props = {}, ...kids) {
  const e = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (key in e) e[key] = value; else e.setAttribute(key, value);
  }
  e.append(...kids);
  return e;
}

const isDark = (e) => getComputedStyle(e).getPropertyValue("--dark").trim() === "1";
const DASHES = [undefined, [7, 3], [2, 3]];
const inkOf = (i, dark) => (dark ? mixed(INKS[i % INKS.length], "#ffffff", 0.5) : INKS[i % INKS.length]);

function fitting(ctx, text, room) {
  if (ctx.measureText(text).width <= room) return text;
  let cut = text;
  while (cut.length > 1 && ctx.measureText(`${cut}\u2026`).width > room) cut = cut.slice(0, -1);
  return `${cut}\u2026`;
}

// What a curve is called where it ends: labels that would lie on each other move apart.
function endLabels(u, names, colours) {
  const { ctx, bbox, data } = u, dpr = devicePixelRatio || 1, found = [];
  ctx.save();
  ctx.font = `${11 * dpr}px "DejaVu Sans", system-ui, sans-serif`; ctx.textBaseline = "middle"; ctx.textAlign = "left";
  names.forEach((name, i) => {
    const row = data[i + 1];
    let k = row.length - 1;
    while (k >= 0 && (row[k] === null || row[k] === undefined || Number.isNaN(row[k]))) k--;
    if (k >= 0 && name) found.push({ name: fitting(ctx, name, (END_ROOM - 8) * dpr), colour: colours[i], y: u.valToPos(row[k], "y", true) });
  });
  found.sort((a, b) => a.y - b.y);
  const gap = 12 * dpr, room = Math.floor((bbox.height + 8 * dpr) / gap);
  if (found.length > room) found.length = room;
  for (let k = 1; k < found.length; k++) found[k].y = Math.max(found[k].y, found[k - 1].y + gap);
  const over = found.length ? found[found.length - 1].y - (bbox.top + bbox.height - 4 * dpr) : 0;
  if (over > 0) for (const one of found) one.y -= over;
  for (const { name, colour, y } of found) {
    ctx.fillStyle = colour; ctx.fillText(name, bbox.left + bbox.width + 5 * dpr, y);
  }
  ctx.restore();
}

const END_ROOM = 118;                                     // for those words, alike in all plots

// One figure. `names`, `rows`, and `short`, the words at the ends of curves, belong together, and so
// do `inks`, numbers of colours and dashes. Returns {u, at(t), dress(), set(time, rows), box}: at(t)
// moves the cursor.
function plot(parent, { title, unit: unitName, names, short: words, time, rows, seek, close, bands = [],
                        inks = names.map((_, i) => [i, 0]) }) {
  const box = el("figure", { className: "plot" }), caption = el("figcaption"), state = { t: 0, live: true };
  const what = el("span"); what.textContent = title + (unitName && unitName !== "1" ? ` [${unitName}]` : "");
  const values = el("output");
  caption.append(what, values);
  if (close) {
    const button = el("button", { className: "close", title: "close this plot", textContent: "\u00d7" });
    button.onclick = () => { watch.disconnect(); u.destroy(); box.remove(); close(); };
    caption.append(button);
  }
  box.append(caption); parent.append(box);
  const size = () => ({ width: Math.max(180, box.clientWidth - 12), height: 150 });
  let night = isDark(box);
  const dark = () => night, colours = () => inks.map(([i]) => inkOf(i, dark()));
  const axis = () => ({ stroke: dark() ? "#9aa6b2" : "#5b6570", font: PLOT_FONT,
    grid: { stroke: dark() ? "#232b34" : "#e9ecef", width: 1 }, ticks: { show: false } });
  let last = box.clientWidth;
  const wide = () => last >= 400;
  const make = () => new uPlot({
    ...size(), legend: { show: false }, scales: { x: { time: false } },
    padding: [8, wide() ? END_ROOM : 8, 0, 0],
    cursor: { drag: { x: true, y: false }, sync: { key: "sandbox" }, points: { size: 6 } },
    axes: [{ ...axis(), size: 26, values: (_, ticks) => ticks.map((v, i) =>
      `${+v.toPrecision(8)}${i === ticks.length - 1 ? " s" : ""}`) }, { ...axis(), size: 54,
      values: (_, ticks) => ticks.map((v) => short(v, 5)) }],
    series: [{}, ...names.map((name, i) => ({ label: name, stroke: colours()[i], width: 1.5,
      dash: DASHES[inks[i][1] % DASHES.length], spanGaps: true, points: { show: false } }))],
    hooks: {
      drawAxes: [(q) => bandsOn(q, bands, dark())],
      draw: [(q) => { if (wide()) endLabels(q, words, colours()); if (line) placeCursor(q, line, state.t); }],
      setCursor: [() => tellValues()],
    },
  }, [time, ...rows], box);
  let line = null, u = make();
  const tellValues = () => {
    if (!u) return;
    const { left } = u.cursor, inside = left !== undefined && left >= 0;
    const at = inside ? u.posToVal(left, "x") : state.t, i = indexBelow(time, at);
    const shown = rows.slice(0, wide() ? 8 : 3);
    while (values.children.length > shown.length) values.lastChild.remove();
    shown.forEach((row, k) => {
      const one = values.children[k] || values.appendChild(el("b"));
      let j = i;                                          // of runs on one axis, its last sample
      while (j > 0 && (row[j] === null || row[j] === undefined)) j--;
      const text = short(row[j] === undefined ? NaN : row[j]);
      if (one.textContent !== text) one.textContent = text;
      if (one.dataset.dark !== `${night}`) { one.dataset.dark = `${night}`; one.style.color = inkOf(inks[k][0], night); }
    });
  };
  const seekHere = (e) => { if (seek && u.select.width < 3) seek(u.posToVal(e.offsetX, "x")); };
  const listen = () => {
    u.over.addEventListener("click", seekHere);
    line = el("div", { className: "now" });
    u.over.append(line);
    placeCursor(u, line, state.t);
  };
  listen();
  const watch = new ResizeObserver(() => {
    if (Math.abs(box.clientWidth - last) > 2) { last = box.clientWidth; u.setSize(size()); }
  });
  watch.observe(box);
  return {
    get u() { return u; }, box, values,
    at(t) { state.t = t; placeCursor(u, line, t); tellValues(); },
    dress() { night = isDark(box); line = null; u.destroy(); u = make(); listen(); },
    set(newTime, newRows) { time = newTime; rows = newRows; u.setData([time, ...rows]); },
  };
}

// The time cursor is a line above the canvas: the curves need no stroke anew to move it.
function placeCursor(u, line, t) {
  const x = u.valToPos(t, "x"), inside = x >= -1 && x <= u.over.clientWidth + 1;
  line.style.transform = `translateX(${x.toFixed(2)}px)`;
  line.style.visibility = inside ? "visible" : "hidden";
}

function bandsOn(q, bands, dark) {                        // what a scene expects, from when to when
  const { ctx, bbox } = q;
  ctx.save();
  ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
  for (const { from, to, low, high, ok } of bands) {
    const x0 = q.valToPos(from, "x", true), x1 = q.valToPos(to, "x", true);
    const y0 = high === null ? bbox.top : q.valToPos(high, "y", true);
    const y1 = low === null ? bbox.top + bbox.height : q.valToPos(low, "y", true);
    ctx.fillStyle = ok ? (dark ? "#2f7d6355" : "#2f7d6333") : (dark ? "#d0206055" : "#d0206033");
    const least = Math.max(8 * (devicePixelRatio || 1) - (y1 - y0), 0);   // seen beside its curve
    ctx.fillRect(x0, y0 - least / 2, Math.max(x1 - x0, 2), y1 - y0 + least);
  }
  ctx.restore();
}
