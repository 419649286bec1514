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
const inkOf = (i, dark) => (dark ? mixed(INKS[i % INKS.length], "#ffffff", 0.5) : INKS[i % INKS.length]);

// What a curve is called where it ends: labels that would lie on each other move apart.
function endLabels(u, names, colours) {
  const { ctx, bbox, data } = u, dpr = devicePixelRatio || 1, found = [];
  names.forEach((name, i) => {
    const row = data[i + 1];
    let k = row.length - 1;
    while (k >= 0 && (row[k] === null || row[k] === undefined || Number.isNaN(row[k]))) k--;
    if (k >= 0) found.push({ name, colour: colours[i], y: u.valToPos(row[k], "y", true) });
  });
  found.sort((a, b) => a.y - b.y);
  const gap = 12 * dpr;
  for (let k = 1; k < found.length; k++) found[k].y = Math.max(found[k].y, found[k - 1].y + gap);
  const over = found.length ? found[found.length - 1].y - (bbox.top + bbox.height - 4 * dpr) : 0;
  if (over > 0) for (const one of found) one.y -= over;
  ctx.save();
  ctx.font = `${11 * dpr}px "DejaVu Sans", system-ui, sans-serif`; ctx.textBaseline = "middle"; ctx.textAlign = "left";
  for (const { name, colour, y } of found) {
    ctx.fillStyle = colour; ctx.fillText(name, bbox.left + bbox.width + 5 * dpr, y);
  }
  ctx.restore();
}

// One figure. `names` and `rows` belong together; `short` are the words at the ends of curves.
// Returns {u, at(t), colours(), box, key}: at(t) moves the cursor.
function plot(parent, { title, unit: unitName, names, short: words, time, rows, seek, close, bands = [] }) {
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
  const longest = Math.max(...words.map((w) => w.length)), room = Math.min(150, 12 + 6.6 * longest);
  const size = () => ({ width: Math.max(180, box.clientWidth), height: 150 });
  const dark = () => isDark(box), colours = () => names.map((_, i) => inkOf(i, dark()));
  const axis = () => ({ stroke: dark() ? "#9aa6b2" : "#5b6570", font: PLOT_FONT,
    grid: { stroke: dark() ? "#232b34" : "#e9ecef", width: 1 }, ticks: { show: false } });
  const wide = () => box.clientWidth >= 400;
  const make = () => new uPlot({
    ...size(), legend: { show: false }, scales: { x: { time: false } },
    padding: [8, wide() ? room : 8, 0, 0],
    cursor: { drag: { x: true, y: false }, sync: { key: "sandbox" }, points: { size: 6 } },
    axes: [{ ...axis(), size: 26 }, { ...axis(), size: 54,
      values: (_, ticks) => ticks.map((v) => (Math.abs(v) >= 1e5 || (v && Math.abs(v) < 1e-3)
        ? v.toExponential(0) : String(+v.toPrecision(6)))) }],
    series: [{}, ...names.map((name, i) => ({ label: name, stroke: inkOf(i, dark()), width: 1.5,
      spanGaps: true, points: { show: false } }))],
    hooks: {
      drawAxes: [(q) => bandsOn(q, bands, dark())],
      draw: [(q) => { if (wide()) endLabels(q, words, colours()); cursorOn(q, state.t); }],
      setCursor: [() => tellValues()],
    },
  }, [time, ...rows], box);
  let u = make();
  const tellValues = () => {
    if (!u) return;
    const { left } = u.cursor, inside = left !== undefined && left >= 0;
    const at = inside ? u.posToVal(left, "x") : state.t, i = indexBelow(time, at);
    const shown = rows.length > 3 && !wide() ? rows.slice(0, 3) : rows;
    values.replaceChildren(...shown.map((row, k) => {
      const one = el("b"); one.style.color = inkOf(k, dark());
      one.textContent = short(row[i] === undefined ? NaN : row[i]);
      return one;
    }));
  };
  const seekHere = (e) => { if (seek && u.select.width < 3) seek(u.posToVal(e.offsetX, "x")); };
  const listen = () => u.over.addEventListener("click", seekHere);
  listen();
  let last = box.clientWidth;
  const watch = new ResizeObserver(() => {
    if (Math.abs(box.clientWidth - last) > 2) { last = box.clientWidth; u.setSize(size()); }
  });
  watch.observe(box);
  return {
    get u() { return u; }, box, values,
    at(t) { state.t = t; u.redraw(false, false); tellValues(); },
    dress() { u.destroy(); u = make(); listen(); },
    set(newTime, newRows) { time = newTime; rows = newRows; u.setData([time, ...rows]); },
  };
}

function cursorOn(q, t) {
  const x = q.valToPos(t, "x", true), { ctx, bbox } = q, dpr = devicePixelRatio || 1;
  if (x < bbox.left - 1 || x > bbox.left + bbox.width + 1) return;
  ctx.save(); ctx.fillStyle = "#c8107a";
  ctx.fillRect(x - 0.7 * dpr, bbox.top, 1.4 * dpr, bbox.height);
  ctx.restore();
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
    ctx.fillRect(x0, y0, Math.max(x1 - x0, 2), Math.max(y1 - y0, 2));
  }
  ctx.restore();
}
