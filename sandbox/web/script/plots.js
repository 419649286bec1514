// Elements of the page, and plots with one time cursor.

const INKS = ["#0e4a9e", "#c1570b", "#2f7d63", "#7a3fb0", "#b01668", "#7a5c00"];
const CURVE = 1.5;                                        // how thick curves are
const PLOT_FONT = '11px "DejaVu Sans", system-ui, sans-serif';

function el(tag, props = {}, ...kids) {
  const e = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (key in e) e[key] = value; else e.setAttribute(key, value);
  }
  e.append(...kids);
  return e;
}

const DASHES = [undefined, [7, 3], [2, 3]];
const inkOf = (i) => lighter(INKS[i % INKS.length], 40);

// Coinciding curves alternate their colours: the n-th is on top in every n-th slice of the plot. Dashed ones are drawn over them.
function takeTurns({ ctx, bbox, series }, solid, colours, dpr) {
  const slice = Math.round(TURN * CURVE * dpr), count = solid.length;
  const inside = (turn, of, indices) => {                 // strokes curves in every of-th slice
    const slices = new Path2D();
    for (let x = bbox.left + turn * slice; x < bbox.left + bbox.width; x += of * slice) slices.rect(x, bbox.top, slice, bbox.height);
    ctx.save();
    ctx.clip(slices);
    Object.assign(ctx, { globalAlpha: 1, lineWidth: CURVE * dpr, lineJoin: "round" });
    for (const i of indices) {
      const { dash, _paths } = series[i + 1];
      ctx.setLineDash(dash || []); ctx.strokeStyle = colours[i];
      if (_paths?.stroke) ctx.stroke(_paths.stroke);
    }
    ctx.restore();
  };
  solid.forEach((_, turn) => inside(turn, count, [...solid.slice(turn + 1), ...solid.slice(0, turn + 1)]));
  inside(0, 1, [...colours.keys()].filter((i) => !solid.includes(i)));
}

// The limits of an axis. Values that change only by rounding, or by a share `least` of their size, are drawn flat.
function spanOf(low, high, least = 0) {
  if (low === null || !Number.isFinite(low + high)) return [0, 1];
  const most = Math.max(Math.abs(low), Math.abs(high));
  if (most < LEAST) return [-1, 1];
  if (high - low > Math.max(FLAT, least) * most) return uPlot.rangeNum(low, high, 0.1, true);
  return low > 0 ? [0, 1.2 * high] : [1.2 * low, 0];
}
const FLAT = 2e-7;                                        // of its size: rounding, in 32 bits too

// Ticks with as many digits as distinguish them.
function tickTexts(ticks) {
  const step = Math.abs(ticks[1] - ticks[0]) || 1, most = Math.max(...ticks.map(Math.abs));
  const digits = clamp(Math.ceil(Math.log10(most / step || 1)) + 2, 3, 12);
  return ticks.map((v) => short(Math.abs(v) < 1e-6 * step ? 0 : v, digits));
}

// Curves of quantities: each with its name without their common words, its number and that of its dashes.
const curvesOf = (names) => names.map((name, i) => ({ name, word: common(names).cut(name), ink: i, dash: Math.floor(i / INKS.length) }));

// A figure of values in SI, with rows of values of `curves`; `least` is that of spanOf(). at(t) moves the cursor.
function plot(parent, { title, unit: unitName, curves, time, rows, seek, close, bands = [], least = 0, range, number }) {
  const names = curves.map(({ name }) => name), box = el("figure", { className: number ? "plot number" : "plot", role: "img",
                                                                     ariaLabel: `plot of ${names.join(", ")}` });
  title ||= common(names).title;
  const what = el("span"), several = curves.length > 1, values = el("output", { className: several ? "many" : "" });
  const dashes = curves.map(({ dash }) => DASHES[dash % DASHES.length]), solid = curves.flatMap((_, i) => (dashes[i] ? [] : [i]));
  const cells = curves.map(({ name, word, dash }) => {    // the value of a curve, after its name where there are several
    const cell = el("b", { title: name }), said = el("data");
    if (several) cell.append(el("em", { className: `line${dash % DASHES.length}`, textContent: word || name }));
    cell.append(said); values.append(cell);
    return { cell, said };
  });
  const letters = clamp(Math.max(...curves.map(({ word }) => word.length)) + 11, 14, 40);
  values.style.gridTemplateColumns = `repeat(auto-fill, minmax(min(100%, ${letters}ch), 1fr))`;
  box.append(el("figcaption", {}, what, values)); parent.append(box);
  let shown, scaled, sizes, u, line, colours, now = 0, last = box.clientWidth;   // how values are shown; rows in that unit
  const take = () => {
    shown = shownAs(unitName, Math.max(0, ...(range ? [range] : rows).map(sizeOfRow)));
    scaled = shown.factor === 1 ? rows : rows.map((row) => row.map((v) => (v && shown.factor * (Math.abs(v) < LEAST ? 0 : v))));
    sizes = scaled.map(sizeOfRow);
    what.textContent = [title, shown.unit && (title ? `[${shown.unit}]` : shown.unit)].filter(Boolean).join(" ");
  };
  const size = () => ({ width: Math.max(180, box.clientWidth - 12), height: 150 });
  const showValues = () => {
    if (!u) return;
    const { left } = u.cursor, at = left >= 0 ? u.posToVal(left, "x") : now;
    scaled.forEach((row, k) => { cells[k].said.textContent = steady(row[indexNear(time, at, row)] ?? null, sizes[k]); });
  };
  const make = () => {
    const dark = DARK.matches;
    colours = curves.map(({ ink }) => inkOf(ink)); line = null;
    cells.forEach(({ cell }, k) => { cell.style.color = colours[k]; });
    const axis = { stroke: dark ? "#9aa6b2" : "#5b6570", font: PLOT_FONT, grid: { stroke: dark ? "#232b34" : "#e9ecef", width: 1 },
                   ticks: { show: false } };
    u = new uPlot({
      ...size(), legend: { show: false }, padding: [8, 10, 0, 0],
      scales: { x: { time: false }, y: { range: (_, low, high) => (range ? range.map((v) => v * shown.factor) : spanOf(low, high, least)) } },
      cursor: { drag: { x: true, y: false }, sync: { key: "sandbox" }, points: { size: 6 } },
      axes: [
        { ...axis, size: 26, values: (_, ticks) => ticks.map((v, i) => `${+v.toPrecision(8)}${i === ticks.length - 1 ? " s" : ""}`) },
        { ...axis, values: (_, ticks) => tickTexts(ticks),
          size: (_, texts) => Math.max(54, 14 + 7 * Math.max(0, ...(texts || []).map((text) => text.length))) }],
      series: [{}, ...curves.map(({ name }, i) => ({ label: name, stroke: colours[i], width: CURVE, dash: dashes[i], alpha: dashes[i] ? 1 : 0,
        spanGaps: true, pxAlign: 0, points: { show: false } }))],   // at whole pixels there would be stairs
      hooks: {
        drawAxes: [(q) => bandsOn(q, bands, shown.factor)],
        draw: [(q) => { takeTurns(q, solid, colours, devicePixelRatio || 1); if (line) placeCursor(q, line, now); }],
        setCursor: [showValues],
      },
    }, [time, ...scaled], box);
    line = el("div", { className: "now" });
    u.over.append(line);
    u.over.onclick = (e) => { if (seek && u.select.width < 3) seek(u.posToVal(e.offsetX, "x")); };
    placeCursor(u, line, now);
  };
  const watch = new ResizeObserver(() => {
    if (Math.abs(box.clientWidth - last) > 2) { last = box.clientWidth; u.setSize(size()); }
  });
  const remove = () => { watch.disconnect(); u.destroy(); box.remove(); };
  take();
  make();
  watch.observe(box);
  if (close) box.firstChild.append(button("", "\u00d7", "close this plot", () => { remove(); close(); }, "close"));
  return {
    get u() { return u; }, box, remove,
    at(t, texts = true) { now = t; placeCursor(u, line, t); if (texts) showValues(); },
    dress() { u.destroy(); make(); },
    set(newTime, newRows) { time = newTime; rows = newRows; take(); u.setData([time, ...scaled]); },
  };
}

// The time cursor is a line above the canvas: the curves need no stroke anew to move it.
function placeCursor(u, line, t) {
  const x = u.valToPos(t, "x"), inside = x >= -1 && x <= u.bbox.width / (devicePixelRatio || 1) + 1;   // no layout
  line.style.transform = `translateX(${x.toFixed(2)}px)`;
  if (line.inside !== inside) { line.inside = inside; line.hidden = !inside; }
}

// Bands of expectations; that of one run among several in its colour, with a word.
function bandsOn({ ctx, bbox, valToPos }, bands, factor) {
  const dpr = devicePixelRatio || 1, least = 8 * dpr;     // of a band that would be thinner than its curve
  ctx.save();
  ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
  ctx.font = `${11 * dpr}px ${FONT}`; ctx.textAlign = "left";
  for (const { from, to, low, high, ok, ink, word } of bands) {
    const x0 = valToPos(from, "x", true), x1 = valToPos(to, "x", true), wide = Math.max(x1 - x0, least);   // of a last value up to its instant
    const y0 = high === null ? bbox.top : valToPos(factor * high, "y", true);
    const y1 = low === null ? bbox.top + bbox.height : valToPos(factor * low, "y", true), more = Math.max(least - (y1 - y0), 0) / 2;
    const colour = ink !== null ? inkOf(ink) : lighter(ok ? "#1f5d4a" : "#a01848", 50);
    ctx.fillStyle = `color-mix(in srgb, ${colour} 20%, transparent)`;
    ctx.fillRect(x1 - wide, y0 - more, wide, y1 - y0 + 2 * more);
    if (!word) continue;
    const inside = y1 + more - 2 - 13 * dpr > bbox.top;   // else below it
    ctx.fillStyle = colour; ctx.textBaseline = inside ? "bottom" : "top";
    ctx.fillText(word, Math.max(x0, bbox.left) + 4, y1 + more + (inside ? -2 : 2));
  }
  ctx.restore();
}
