// Curves that coincide, taken apart as figures take them: each shows its colour by turns where they run as one.

const LOOKED_AT = 4000;                                   // points of a curve, more or less: all of one run's on a page

// Where each of some lines runs alone and where with others. `x` and `lines` are shares of the width and height of
// the axes; the x rise. A stretch is {first, last, rank, turns}: places, how many lines before it run here, and of how many.
function strands(x, lines) {
  const n = x.length, ranks = lines.map(() => new Uint8Array(n)), turns = lines.map(() => new Uint8Array(n).fill(1));
  for (let i = 0; i < lines.length; i++) {
    for (let j = i + 1; j < lines.length; j++) {
      const one = lines[i], other = lines[j];
      for (let k = 0, first = -1; k <= n; k++) {
        if (k < n && Math.abs(one[k] - other[k]) < AS_ONE) { if (first < 0) first = k; continue; }
        if (first >= 0 && x[k - 1] - x[first] >= CROSSING) {
          for (let m = first; m < k; m++) { turns[i][m]++; turns[j][m]++; ranks[j][m]++; }
        }
        first = -1;
      }
    }
  }
  return lines.map((_, i) => {
    const found = [], rank = ranks[i], of = turns[i];
    for (let k = 0, first = 0; k < n; k++) {
      if (k + 1 < n && rank[k + 1] === rank[k] && of[k + 1] === of[k]) continue;
      found.push({ first, last: k, rank: rank[k], turns: of[k] });
      first = k + 1;
    }
    return found;
  });
}

// The values of a row at some places, straight between those that it has; nan before the first and after the last.
function filled(row, time, at) {
  const known = (v) => v !== null && v !== undefined && Number.isFinite(v);
  let before = -1, after = -1, seen = 0;
  return at.map((k) => {
    for (; seen <= k; seen++) if (known(row[seen])) before = seen;
    if (before === k) return row[k];
    if (after < k) for (after = k; after < row.length && !known(row[after]); after++);
    if (before < 0 || after >= row.length) return NaN;
    return row[before] + (row[after] - row[before]) * (time[k] - time[before]) / (time[after] - time[before]);
  });
}

// Draws turns over the curves of a plot. Dashed ones stay as they are: their dashes tell them apart.
function takeApart(u, inks, dark, width) {
  const { ctx, bbox, data } = u, [time, ...rows] = data, [from, to] = u.series[0].idxs;
  const solid = rows.map((_, i) => i).filter((i) => !DASHES[inks[i][1] % DASHES.length]);
  if (solid.length < 2 || !(to > from) || !(bbox.height > 0)) return;
  const at = [], step = Math.ceil((to - from) / LOOKED_AT);
  for (let k = from; k <= to; k += step) at.push(k);
  const { x: { min: x0, max: x1 }, y: { min: y0, max: y1 } } = u.scales, stroke = TURN * width;
  const x = at.map((k) => (time[k] - x0) / (x1 - x0));
  const lines = solid.map((i) => filled(rows[i], time, at).map((v) => (v - y0) / (y1 - y0)));
  ctx.save();
  ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
  ctx.lineWidth = width; ctx.lineJoin = "round"; ctx.lineCap = "butt";
  strands(x, lines).forEach((stretches, i) => {
    ctx.strokeStyle = inkOf(inks[solid[i]][0], dark);
    for (const { first, last, rank, turns } of stretches) {
      if (turns < 2) continue;
      ctx.beginPath();
      for (let k = first; k <= last; k++) {
        ctx.lineTo(bbox.left + x[k] * bbox.width, bbox.top + (1 - lines[i][k]) * bbox.height);
      }
      ctx.setLineDash([stroke, stroke * (turns - 1)]);
      ctx.lineDashOffset = stroke * (turns - rank);
      ctx.stroke();
    }
  });
  ctx.restore();
}

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

const isDark = (e) => getComputedStyle(e).getPropertyValue("--dark").trim() === "1";
const DASHES = [undefined, [7, 3], [2, 3]];
const inkOf = (i, dark) => (dark ? mixed(INKS[i % INKS.length], "#ffffff", 0.4) : INKS[i % INKS.length]);

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
  let least = bbox.top + bbox.height - 4 * dpr;           // what would end below moves up, and what that meets
  for (const one of [...found].reverse()) { one.y = Math.min(one.y, least); least = one.y - gap; }
  for (const { name, colour, y } of found) {
    ctx.fillStyle = colour; ctx.fillText(name, bbox.left + bbox.width + 5 * dpr, y);
  }
  ctx.restore();
}

const END_ROOM = 118;                                     // the most that those words get
const ROOMS = new WeakMap();                              // of plots in one column: what each needs, and its layout
function roomIn(parent, box, words, layout) {             // what all of them get: their times lie below each other
  if (!ROOMS.has(parent)) ROOMS.set(parent, new Map());
  const all = ROOMS.get(parent), most = () => Math.max(...[...all.values()].map((one) => one.room), 0), before = most();
  if (words) all.set(box, { room: roomFor(words), layout }); else all.delete(box);
  if (most() !== before) for (const [other, one] of all) if (other !== box) one.layout();
  return most;
}
function roomFor(words) {
  const ctx = roomFor.ctx || (roomFor.ctx = new OffscreenCanvas(1, 1).getContext("2d"));
  ctx.font = PLOT_FONT;
  const widest = Math.max(...words.map((word) => ctx.measureText(word).width));
  return widest > 0 ? Math.min(END_ROOM, widest + 10) : 10;
}

// From where to where an axis goes for values between two. What changes by no more than rounding does is
// drawn flat, and so is what changes by no more than a share `least` of itself: between 0 and itself, or about 0.
function spanOf(low, high, least = 0) {
  if (low === null || !Number.isFinite(low + high)) return [0, 1];
  const most = Math.max(Math.abs(low), Math.abs(high));
  if (most < LEAST) return [-1, 1];
  if (high - low > Math.max(FLAT, least) * most) return uPlot.rangeNum(low, high, 0.1, true);
  return low > 0 ? [0, 1.2 * high] : [1.2 * low, 0];
}
const FLAT = 2e-7;                                        // of its size: rounding, in 32 bits too

// As many digits as tell ticks apart.
function tickTexts(ticks) {
  const step = Math.abs(ticks[1] - ticks[0]) || 1, most = Math.max(...ticks.map(Math.abs));
  const digits = clamp(Math.ceil(Math.log10(most / step || 1)) + 2, 3, 12);
  return ticks.map((v) => short(Math.abs(v) < 1e-6 * step ? 0 : v, digits));
}

// A value of a plot, after the name of its curve and a piece of its line where there are several.
function valueCell(parent, word, name, [, dash]) {
  const number = el("data"), box = el("b", { title: name });
  if (word) box.append(el("em", { className: `line${dash % DASHES.length}`, textContent: word }));
  box.append(number); parent.append(box);
  return { box, number };
}
const cellWidth = (words) => clamp(Math.max(...words.map((word) => word.length)) + 11, 14, 40);   // letters, of such cells

// One figure, of values in SI, shown as people read them. `names`, `rows`, and `short`, the words at the ends of curves, belong together, and so
// do `inks`, numbers of colours and dashes; `least` is that of spanOf(). Returns {u, at(t), dress(), set(time, rows), box}: at(t)
// moves the cursor.
function plot(parent, { title, unit: unitName, names, short: words, time, rows, seek, close, bands = [], least = 0,
                        range, number, inks = names.map((_, i) => [i, 0]) }) {
  const box = el("figure", { className: number ? "plot number" : "plot" }), caption = el("figcaption"), state = { t: 0, live: true };
  const what = el("span"), values = el("output"), several = names.length > 1;
  values.classList.toggle("many", several);               // each after its name, below the title
  if (several) values.style.gridTemplateColumns = `repeat(auto-fill, minmax(min(100%, ${cellWidth(words)}ch), 1fr))`;
  const cells = names.map((name, i) => valueCell(values, several ? words[i] || name : "", name, inks[i]));
  let shown, told;                                        // how values are shown, and as such
  const take = () => {
    shown = shownAs(unitName, range ? sizeOfRow(range) : sizeOfRows(rows));
    told = shown.factor === 1 ? rows : rows.map((row) => row.map((v) => (v && shown.factor * (Math.abs(v) < LEAST ? 0 : v))));
    what.textContent = [title, shown.unit && (title ? `[${shown.unit}]` : shown.unit)].filter(Boolean).join(" ");
  };
  take();
  caption.append(what, values);
  if (close) {
    const button = el("button", { className: "close", title: "close this plot", textContent: "\u00d7" });
    button.onclick = () => { watch.disconnect(); u.destroy(); box.remove(); roomIn(parent, box); close(); };
    caption.append(button);
  }
  box.append(caption); parent.append(box);
  box.role = "img"; box.ariaLabel = `plot of ${names.join(", ")}`;
  const size = () => ({ width: Math.max(180, box.clientWidth - 12), height: 150 });
  let night = isDark(box);
  const dark = () => night, colours = () => inks.map(([i]) => inkOf(i, dark()));
  const axis = () => ({ stroke: dark() ? "#9aa6b2" : "#5b6570", font: PLOT_FONT,
    grid: { stroke: dark() ? "#232b34" : "#e9ecef", width: 1 }, ticks: { show: false } });
  let last = box.clientWidth;
  const wide = () => last >= 400;
  const make = () => new uPlot({
    ...size(), legend: { show: false },
    scales: { x: { time: false }, y: { range: (_, low, high) => (range ? range.map((v) => v * shown.factor) : spanOf(low, high, least)) } },
    padding: [8, () => (wide() ? room() : 8), 0, 0],
    cursor: { drag: { x: true, y: false }, sync: { key: "sandbox" }, points: { size: 6 } },
    axes: [{ ...axis(), size: 26, values: (_, ticks) => ticks.map((v, i) =>
      `${+v.toPrecision(8)}${i === ticks.length - 1 ? " s" : ""}`) }, { ...axis(), values: (_, ticks) => tickTexts(ticks),
      size: (_, texts) => Math.max(54, 14 + 7 * Math.max(0, ...(texts || []).map((text) => text.length))) }],
    series: [{}, ...names.map((name, i) => ({ label: name, stroke: colours()[i], width: CURVE,
      dash: DASHES[inks[i][1] % DASHES.length], spanGaps: true, pxAlign: 0,      // whole pixels would be stairs
      points: { show: false } }))],
    hooks: {
      drawAxes: [(q) => bandsOn(q, bands, shown.factor, dark())],
      draw: [(q) => { takeApart(q, inks, dark(), CURVE * (devicePixelRatio || 1)); if (wide()) endLabels(q, words, colours()); if (line) placeCursor(q, line, state.t); }],
      setCursor: [() => tellValues()],
    },
  }, [time, ...told], box);
  const room = number ? () => 0 : roomIn(parent, box, words, () => u.setSize(size()));
  let line = null, u = make();
  const tellValues = () => {
    if (!u) return;
    const { left } = u.cursor, inside = left !== undefined && left >= 0;
    const at = inside ? u.posToVal(left, "x") : state.t;
    told.forEach((row, k) => {
      const v = row[indexNear(time, at, row)], text = short(v === undefined ? null : v), { box: one, number: said } = cells[k];
      if (said.textContent !== text) said.textContent = text;
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
    set(newTime, newRows) { time = newTime; rows = newRows; take(); u.setData([time, ...told]); },
  };
}

// The time cursor is a line above the canvas: the curves need no stroke anew to move it.
function placeCursor(u, line, t) {
  const x = u.valToPos(t, "x"), inside = x >= -1 && x <= u.over.clientWidth + 1;
  line.style.transform = `translateX(${x.toFixed(2)}px)`;
  line.style.visibility = inside ? "visible" : "hidden";
}

// What scenes expect, from when to when; that of one run among several in its colour, after its word.
function bandsOn(q, bands, factor, dark) {
  const { ctx, bbox } = q;
  ctx.save();
  ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
  for (const { from, to, low, high, ok, ink, word } of bands) {
    const x0 = q.valToPos(from, "x", true), x1 = q.valToPos(to, "x", true);
    const y0 = high === null ? bbox.top : q.valToPos(factor * high, "y", true);
    const y1 = low === null ? bbox.top + bbox.height : q.valToPos(factor * low, "y", true);
    ctx.fillStyle = ok ? (dark ? "#2f7d6355" : "#2f7d6333") : (dark ? "#d0206055" : "#d0206033");
    const least = Math.max(8 * (devicePixelRatio || 1) - (y1 - y0), 0);   // seen beside its curve
    if (ink !== null) ctx.fillStyle = `${inkOf(ink, dark)}33`;
    const wide = Math.max(x1 - x0, 8 * (devicePixelRatio || 1));   // of a last value up to its instant
    ctx.fillRect(x1 - wide, y0 - least / 2, wide, y1 - y0 + least);
    if (!word) continue;
    ctx.fillStyle = ink === null ? (ok ? (dark ? "#7fc8ae" : "#1f5d4a") : (dark ? "#f08aa8" : "#a01848")) : inkOf(ink, dark);
    ctx.font = `${11 * (devicePixelRatio || 1)}px "DejaVu Sans", system-ui, sans-serif`;
    const foot = y1 + least / 2, inside = foot - 2 - 13 * (devicePixelRatio || 1) > bbox.top;   // else below it
    ctx.textAlign = "left"; ctx.textBaseline = inside ? "bottom" : "top";
    ctx.fillText(word, Math.max(x0, bbox.left) + 4, foot + (inside ? -2 : 2));
  }
  ctx.restore();
}
