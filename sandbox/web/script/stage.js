// A display list on a canvas; sandbox/picture/listing.py describes its format.

const TAU = 2 * Math.PI, FONT = '"DejaVu Sans", system-ui, sans-serif';
const SMALL = 500, MAX_NUMBERS = 24, SMALL_NUMBERS = 6;               // of a picture [px]; numbers in a picture, in a small one
const PITCH = 7, REACH = 12, SHORTEST = 1.5;              // of hatching [points]; of picking [px]; between points of a trail [px]
const INSIDE = 14;                                        // by which labels are moved into the picture, at most [points]
const LEGEND = 0.4;                                       // of a picture's height, which the legend has at most
const TURNS = [0, 8, 1, 7, 9, 15, 2, 6, 10, 14, 3, 5, 11, 13, 4, 12];   // by eighths of a turn, 8 more with a line: from a side to others, near ones first
const CIRCLE = { c: [0, 0, 0, 0] };
const apart = (a, b) => Math.hypot(b[0] - a[0], b[1] - a[1]);
const turned = ([x, y], a) => [Math.cos(a) * x - Math.sin(a) * y, Math.sin(a) * x + Math.cos(a) * y];

// Adds a ring, {c: a capsule or circle}, {l: an open line}, with the place of its origin, its turn and scale, and -1 to flip y.
function subpath(path, d, radius, x = 0, y = 0, c = 1, s = 0, flip = 1) {
  const px = (p, q) => x + c * p - s * q, py = (p, q) => y + flip * (s * p + c * q);
  if (d.c) {
    const [a, b, a1, b1] = d.c, x0 = px(a, b), y0 = py(a, b), r = Math.max(radius, 0), q = Math.PI / 2;
    if (a === a1 && b === b1) { path.moveTo(x0 + r, y0); path.arc(x0, y0, r, 0, TAU); return; }
    const x1 = px(a1, b1), y1 = py(a1, b1), way = Math.atan2(y1 - y0, x1 - x0), from = way - q;
    path.moveTo(x1 + r * Math.cos(from), y1 + r * Math.sin(from));
    path.arc(x1, y1, r, from, way + q); path.arc(x0, y0, r, way + q, way + 3 * q);
  } else {
    const flat = d.l || d;
    path.moveTo(px(flat[0], flat[1]), py(flat[0], flat[1]));
    for (let i = 2; i < flat.length; i += 2) path.lineTo(px(flat[i], flat[i + 1]), py(flat[i], flat[i + 1]));
  }
  if (!d.l) path.closePath();
}
function polyline(path, points) {
  path.moveTo(points[0][0], points[0][1]);
  for (let i = 1; i < points.length; i++) path.lineTo(points[i][0], points[i][1]);
}
function arrowOn(path, [x0, y0], [x1, y1], shaft, head) { // widths and length [px]
  const d = Math.hypot(x1 - x0, y1 - y0) || 1e-9, ux = (x1 - x0) / d, uy = (y1 - y0) / d;
  const long = Math.min(head, 0.62 * d), half = shaft / 2, wide = Math.max(half, 0.45 * long), neck = d - long;
  const put = (along, across) => path.lineTo(x0 + along * ux - across * uy, y0 + along * uy + across * ux);
  path.moveTo(x0 - half * uy, y0 + half * ux);
  put(neck, half); put(neck, wide); put(d, 0); put(neck, -wide); put(neck, -half); put(0, -half);
  path.closePath();
}
const alike = (a, b) => a.length === b.length && a.every((one, i) => one === b[i]);
const DARK = matchMedia("(prefers-color-scheme: dark)");
const lighter = (colour, percent) => (DARK.matches ? `color-mix(in srgb, ${colour}, #ffffff ${percent}%)` : colour);   // by night

class Stage {
  constructor(head, use) {
    const canvas = el("canvas", { tabIndex: 0, role: "img", ariaLabel: `${head.title} in motion: ${use}` });
    canvas.style.aspectRatio = String(head.view.aspect);
    Object.assign(this, { canvas, head, list: head.list, ctx: canvas.getContext("2d"), zoom: 1, pan: [0, 0], hover: null, extra: [],
                          stamp: "", lines: 0, kept: [] });
    this.layers = new Set(head.layers.filter((l) => l.on).map((l) => l.name));
    this.follow = head.view.follow ? head.bodies.findIndex((b) => b.name === head.view.follow) : -1;
    this.dress();
  }
  dress() {                                               // light or dark colours
    this.night = +DARK.matches;
    this.back = this.ink("paper");
  }
  ink(token, by = 0) {
    if (!token) return null;
    if (token[0] !== "@") return this.list.inks[token][this.night];
    const layer = this.head.ramps[token.slice(1)];        // a ramp that a layer switches off is one colour
    if (layer && !this.layers.has(layer)) return this.ink(this.head.plain);
    const ramp = this.list.ramps[token.slice(1)][by < 0 ? 0 : 1], k = Math.min(ramp.length - 1, Math.floor(Math.abs(by) * (ramp.length - 1) + 0.5));
    return this.night ? lighter(ramp[k], by < 0 ? 30 : 12) : ramp[k];
  }

  // -- camera -----------------------------------------------------------------------------------
  resize() {
    const { canvas, head } = this, dpr = globalThis.devicePixelRatio || 1;
    const [w, h] = this.size ??= [canvas.clientWidth || 300, canvas.clientHeight || 200];   // reading it may lay out the page
    const [W, H] = [Math.round(w * dpr), Math.round(h * dpr)];
    if (canvas.width !== W || canvas.height !== H) { canvas.width = W; canvas.height = H; }
    const u = clamp(Math.min(w / 800, h / 400), 0.6, 1.5);
    Object.assign(this, { w, h, dpr, u, small: w < SMALL, thin: w < SMALL ? 0.75 : 1, text: Math.max(11, Math.round(13 * u)) });
    const kept = [w, h, dpr, this.stamp.length, this.night, this.list.items, ...this.layers];
    if (!alike(kept, this.kept)) {                        // all that is worked out once until one of these changes
      Object.assign(this, { kept, lines: 1, legendAt: null, patterns: {}, looks: [], glyphs: {}, widths: new Map(),
                            shown: this.list.items.filter((item) => this.layers.has(item.l)) });
    }
    if (this.legendAt !== this.scale) {                   // its lines do not become fewer, since that would change the scale again
      Object.assign(this, { legendAt: this.scale, rows: this.legend(), turned: new Map() });
      this.lines = Math.max(this.lines, this.rows.length);
    }
    this.foot = h - Math.floor((h - (1.5 * this.lines + 0.6) * this.text) * dpr) / dpr;   // from a whole pixel on
    const [x0, y0, x1, y1] = head.box, v = head.view, room = Math.max(h - this.foot, 20);
    const [cx, cy] = v.centre || [(x0 + x1) / 2, (y0 + y1) / 2];
    const fitted = v.width ? Math.min(w / v.width, room * v.aspect / v.width)
      : 0.94 * Math.min(w / (2 * Math.max(x1 - cx, cx - x0, 1e-9)), room / (2 * Math.max(y1 - cy, cy - y0, 1e-9)));
    this.scale = this.zoom * fitted;
    const [fx, fy] = this.followed();
    this.ox = w / 2 - this.scale * (cx + fx) + this.pan[0];
    this.oy = room / 2 + this.scale * (cy + fy) + this.pan[1];
  }
  followed() {                                            // how far the camera goes along with a body
    const { follow: b, head, pose } = this;
    if (!(b >= 0) || !pose) return [0, 0];
    const c = head.bodies[b].centre, r = head.rest.slice(3 * b, 3 * b + 3), now = turned(c, pose[3 * b + 2]), then = turned(c, r[2]);
    return [pose[3 * b] + now[0] - r[0] - then[0], pose[3 * b + 1] + now[1] - r[1] - then[1]];
  }
  px(x, y) { return [this.ox + this.scale * x, this.oy - this.scale * y]; }
  world(x, y) { return [(x - this.ox) / this.scale, (this.oy - y) / this.scale]; }
  at(point) {
    const p = this.pose, f = 3 * point[0], x = point[1], y = point[2], c = Math.cos(p[f + 2]), s = Math.sin(p[f + 2]), k = this.scale;
    const at = [this.ox + k * (p[f] + c * x - s * y), this.oy - k * (p[f + 1] + s * x + c * y)];
    if (point.length > 3) { at[0] += point[3] * this.u; at[1] -= point[4] * this.u; }
    return at;
  }
  place(f) {                                              // metres of a frame to device pixels
    const p = this.pose, a = p[3 * f + 2], k = this.scale * this.dpr, c = k * Math.cos(a), s = k * Math.sin(a);
    this.ctx.setTransform(c, -s, -s, -c, this.dpr * (this.ox + this.scale * p[3 * f]), this.dpr * (this.oy - this.scale * p[3 * f + 1]));
    this.placed = true;
  }
  plain() {
    if (this.placed) this.ctx.setTransform(this.dpr, 0, 0, this.dpr, 0, 0);
    this.placed = false;
  }
  zoomAt(factor, x, y) {                                  // the point at (x, y) stays where it is
    const [a, b] = this.world(x, y);
    this.zoom = clamp(this.zoom * factor, 0.1, 400);
    this.resize();
    const [p, q] = this.px(a, b);
    this.pan[0] += x - p; this.pan[1] += y - q;
  }
  fit() { this.zoom = 1; this.pan = [0, 0]; }

  // -- one frame ------------------------------------------------------------------------------------
  draw(frame, ghosts = []) {                              // {t, pose, values, tables: rows by name, trail(item)}; ghosts: {list, frame, colour}
    const { ctx } = this;
    this.frame = frame; this.pose = frame.pose; this.values = frame.values;
    this.resize();
    this.placed = true; this.plain();
    ctx.lineJoin = "round";
    this.words = [];
    ctx.fillStyle = this.back; ctx.fillRect(0, 0, this.w, this.h);
    if (this.layers.has("coordinates")) this.grid();
    for (const item of this.shown) if (this.on(item)) this.paint(item);
    for (const ghost of ghosts) this.ghost(ghost);
    for (const more of this.extra) more(this, frame);
    this.flush();
    this.write();
    this.strip();
  }
  on(item) { return item.if === undefined || this.value(item.if) > 0.5; }
  paint(item) {
    if (item.k in PAINT) { PAINT[item.k](this, item); return; }
    const { edge, width, dash } = this.look(item);
    LINES[item.k](this, item, this.pen(null, edge, width, dash));
  }
  ghost({ list, frame, colour }) {                        // areas of another run, in its colour
    const { pose, values } = this, fill = `color-mix(in srgb, ${colour} 9%, transparent)`;
    Object.assign(this, { pose: frame.pose, values: frame.values, tint: { fill, edge: colour, width: 1.2 * this.u, dash: 0 } });
    const seen = (item) => item.k === "path" && this.layers.has(item.l) && this.on(item) && !list.styles[item.s]?.[4];
    for (const item of list.items) if (seen(item)) PAINT.path(this, item);
    Object.assign(this, { pose, values, tint: null });
  }
  value(v) { return typeof v === "number" ? v : this.values[v[0]]; }
  choice(item, all) {                                     // of a list, the one that the item's state picks
    return Array.isArray(all) ? all[clamp(Math.round(item.state === undefined ? 0 : this.value(item.state)), 0, all.length - 1)] : all;
  }
  look(item) {                                            // {fill, edge, width, dash [px], hatched}
    if (this.tint) return this.tint;
    const number = this.choice(item, item.s), lit = item.n && this.hover?.n === item.n;
    if (item.by === undefined && item.wide === undefined && !lit) return this.looks[number] ??= this.lookOf(this.list.styles[number], 0, this.thin);
    const by = item.by === undefined ? 0 : this.value(item.by), wide = item.wide === undefined ? 1 : this.value(item.wide);
    const found = this.lookOf(this.list.styles[number], by, wide * this.thin);
    return lit ? { ...found, edge: this.ink("force") } : found;
  }
  lookOf([fill, edge, width, dash, hatched], by, wide) {
    return { fill: this.ink(fill, by), edge: this.ink(edge, by), width: width * wide * this.u, dash: dash * this.u, hatched: hatched && !this.small };
  }
  path(item) {                                            // in metres; made once, but for what swells
    item.swells ??= item.d.some((d) => d.c && Array.isArray(d.c[4]));
    if (!item.path || item.swells) {
      item.path = new Path2D();
      for (const d of item.d) subpath(item.path, d, d.c && this.value(d.c[4]));
    }
    return item.path;
  }
  pen(fill, edge, width = 0, dash = 0) {                  // the context, to add a path in pixels; consecutive paths of one look are painted at once
    const { ctx, pending: last } = this;
    if (last && last.fill === fill && last.edge === edge && last.width === width && last.dash === dash) return ctx;
    this.flush();
    this.pending = { fill, edge, width, dash };
    this.plain();
    ctx.beginPath();
    return ctx;
  }
  flush() {
    const { ctx, pending } = this;
    if (!pending) return;
    this.pending = null;
    if (pending.fill) { ctx.fillStyle = pending.fill; ctx.fill(); }
    this.stroke(null, pending.edge, pending.width, pending.dash);
  }
  stroke(path, edge, width, dash = 0) {                   // null is the path of the context
    const { ctx } = this;
    if (!edge || !(width > 0)) return;
    ctx.strokeStyle = edge; ctx.lineWidth = width;
    if (dash) ctx.setLineDash([dash, 0.8 * dash]);
    if (path) ctx.stroke(path); else ctx.stroke();
    if (dash) ctx.setLineDash([]);
  }
  dot([x, y], r, fill, edge) { subpath(this.pen(fill, edge, 1.6 * this.u), CIRCLE, r, x, y); }
  hatch(edge) {
    if (!this.patterns[edge]) {
      const side = Math.max(4, Math.round(PITCH * this.u * this.dpr)), c = new OffscreenCanvas(side, side), g = c.getContext("2d");
      g.strokeStyle = edge; g.globalAlpha = 0.55; g.lineWidth = 0.9 * this.u * this.dpr;
      for (const o of [-side, 0, side]) { g.moveTo(o - 1, side + 1); g.lineTo(o + side + 1, -1); }
      g.stroke();
      this.patterns[edge] = this.ctx.createPattern(c, "repeat");
    }
    this.patterns[edge].setTransform(this.ctx.getTransform().inverse());   // hatches stay on the screen
    return this.patterns[edge];
  }
  glyph(name, [x, y], turn = 0) {                         // a symbol of constant size
    const { u } = this, c = u * Math.cos(turn), s = u * Math.sin(turn);
    this.glyphs[name] ??= this.list.glyphs[name].map(([style, d]) => ({ d, look: this.lookOf(this.list.styles[style], 1, 1) }));
    for (const { d, look } of this.glyphs[name]) {
      subpath(this.pen(d.l ? null : look.fill, look.edge, look.width, look.dash), d, d.c && d.c[4] * u, x, y, c, s, -1);
    }
  }
  arrow(path, tail, tip, [shaft, head], more = 0) {
    const u = this.u * (this.small ? 0.8 : 1);
    arrowOn(path, tail, tip, shaft * u + more, head * u + more);
  }
  vectors(item) {                                         // [row, tail, tip, size] of arrows in sight, small ones first
    const found = [];
    for (const row of this.frame.tables[item.t] || []) {
      const size = Math.hypot(row[4], row[5]), long = item.metres * this.scale * Math.min(1, item.most / Math.max(size, 1e-30));
      const tail = this.px(row[2], row[3]), tip = [tail[0] + long * row[4], tail[1] - long * row[5]];
      if (size * long >= item.least * this.u && Math.abs(tail[0]) < 4e3 && Math.abs(tail[1]) < 4e3) found.push([row, tail, tip, size]);
    }
    return found.sort((a, b) => a[3] - b[3]);
  }
  grid() {                                                // lines of equal x and equal y
    const bottom = this.h - this.foot, low = this.world(0, bottom), high = this.world(this.w, 0), step = roundLength(175 * this.u / this.scale);
    const [factor, unitName] = step >= 0.1 ? [1, "m"] : [1e3, "mm"];
    for (const k of [0, 1]) {
      for (let n = Math.ceil(low[k] / step); n * step <= Math.min(high[k], low[k] + 200 * step); n++) {
        const path = [low, high].map((end) => this.px(...end.with(k, n * step)));
        polyline(this.pen(null, this.ink("hairline"), (n ? 0.9 : 1.8) * this.u), path);
        this.words.push({ text: `${+(n * step * factor).toPrecision(6)} ${unitName}`, tip: k ? [this.text * 2.4, path[0][1]] : [path[0][0], bottom],
                          side: 2, rank: 6, ink: this.ink("faint_ink"), clear: 0 });
      }
    }
  }
  // -- texts ------------------------------------------------------------------------------------------
  // A text at its side: that of the list, or else, once and for all, the one that its arrow points to.
  say(item, key, text, tip, away, ink, size) {
    const { head } = this;
    let place = item.k === "text" ? ("side" in item ? item.place ??= [item.side, item.show] : null) : item.labels?.[key];
    if (!place && (head.live || !item.placed)) {
      item.sides ??= {};
      place = item.sides[key] ??= [away ? (Math.round(Math.atan2(-away[1], away[0]) / (Math.PI / 4)) + 8) % 8 : 2, 1];
    }
    if (!place || this.value(place[1]) <= 0.5) return;
    const texts = item.texts ??= {};
    text = texts[key] = (this.keepTexts && texts[key]) || text;
    this.words.push({ text, tip, place, side: place[0], rank: item.rank ?? 1, ink, size, clear: (item.clear || 0) * this.u,
                      number: item.k !== "text" || "value" in item });
  }
  arrowText(item, row, size) { return this.valueText(item, row.length > 6 ? row[6] : size); }
  valueText(item, value) { return `${fixedText(value * item.factor, item.decimals)} ${item.unit}`; }
  write() {                                               // of two on one spot the first stays
    const { ctx } = this, taken = [], most = this.small ? SMALL_NUMBERS : MAX_NUMBERS;
    let numbers = 0;
    ctx.font = `600 ${this.text}px ${FONT}`;
    ctx.globalAlpha = 0.6;                                // of lines to labels farther off
    this.plain();
    this.words.sort((a, b) => a.rank - b.rank || (b.size || 0) - (a.size || 0));
    for (const word of this.words) {
      const { place, side: own, number } = word, kept = this.turned.get(place);
      if (number && numbers >= most) continue;
      let side = kept ?? own, at = this.spot(word, side, taken);
      if (!at && place && !(this.moving && kept !== undefined)) {   // the nearest side with room, which it keeps during a motion
        side = TURNS.map((k) => ((own ^ k) & 8) + (own + k) % 8).find((one) => (at = this.spot(word, one, taken)));
      }
      if (!at) continue;
      if (place && kept !== side) this.turned.set(place, side);
      taken.push(at);
      numbers += number ? 1 : 0;
      if (at.line) polyline(this.pen(null, word.ink, 1), at.line);
    }
    this.flush();
    Object.assign(ctx, { globalAlpha: 1, textAlign: "center", textBaseline: "middle", lineWidth: 3, strokeStyle: this.back });
    for (const { text, x, y } of taken) ctx.strokeText(text, x, y);
    for (const { text, x, y, ink } of taken) { ctx.fillStyle = ink; ctx.fillText(text, x, y); }
  }
  spot({ text, tip, ink, clear }, side, taken) {          // of a label at a side; null if it would be outside, or on another one
    const { u } = this, w = this.widthOf(text) / 2, h = 0.55 * this.text, [dx, dy, far] = this.list.sides[side], reach = (3 + far) * u + clear;
    const wx = tip[0] + dx * (w + reach), wy = tip[1] - dy * (h + reach), x = clamp(wx, w, this.w - w), y = clamp(wy, h, this.h - this.foot - h);
    if (Math.hypot(wx - x, wy - y) > INSIDE * u || taken.some((one) => Math.abs(x - one.x) < w + one.w && Math.abs(y - one.y) < 2 * h)) return null;
    return { x, y, w, text, ink, line: far && [2 * u, reach - u].map((away) => [tip[0] + dx * away, tip[1] - dy * away]) };
  }
  widthOf(text) {                                         // of a label; digits have one width
    if (this.widths.size > 2000) this.widths.clear();
    if (!this.widths.has(text)) this.widths.set(text, this.ctx.measureText(text.replace(/\d/g, "0")).width);
    return this.widths.get(text);
  }
  legend() {                                              // rows of {row, lead, symbol, before, after, needs}: of all entries, or of the first ones
    const all = this.list.legend.filter((row) => this.layers.has(row.l)), wanted = all.filter((one, k) => all[k + 1]?.instead !== one.l);
    const most = clamp(Math.floor((LEGEND * this.h / this.text - 0.6) / 1.5), 1, 3);
    for (;; wanted.pop()) {
      for (const [count, share] of [[2, 1], [2, 0.5], [3, 1], [3, 0.5]]) {
        const found = this.arranged(wanted, Math.min(count, most), share);
        if (found) return found;
      }
    }
  }
  arranged(legend, count, share) {                        // each in the first row with room, or null; symbols have a share of their width
    const { ctx, u, scale, text } = this, width = this.w - 2 * text;
    ctx.font = `600 ${text}px ${FONT}`;
    const stamp = ctx.measureText(`${this.stamp}00`).width + 2 * text;
    const rows = Array.from({ length: count }, (_, k) => ({ room: k ? width : width - stamp, entries: [] }));
    ctx.font = `${text}px ${FONT}`;
    for (const row of legend) {
      let symbol = row.k === "ramp" ? share * 64 * u : (row.width || 0) * u, after = row.after ?? row.words;
      if (row.k === "scale") {
        const size = roundLength(share * (row.size ? 52 : 80) * u / (row.metres * scale || 1));
        symbol = size * row.metres * (scale || 0);
        after = row.size ? `${+size.toPrecision(6)} ${row.unit} ${row.words}` : lengthText(size);
      }
      const before = row.before || "", lead = before ? ctx.measureText(before).width + 5 * u : 0, needs = lead + symbol + ctx.measureText(after).width + 22 * u;
      const free = rows.find(({ room }) => needs <= room);
      if (!free) return null;
      free.entries.push({ row, lead, symbol, before, after, needs });
      free.room -= needs;
    }
    return rows.map(({ entries }) => entries).slice(0, 1 + rows.findLastIndex(({ entries }) => entries.length));
  }
  strip() {                                               // the legend and the time
    const { ctx, w, h, foot, text, u } = this, faint = this.ink("faint_ink");
    ctx.fillStyle = this.back; ctx.fillRect(0, h - foot, w, foot);
    ctx.textAlign = "right"; ctx.fillStyle = faint;
    ctx.fillText(this.stamp, w - text, h - foot + text);
    ctx.textAlign = "left"; ctx.font = `${text}px ${FONT}`;
    this.rows.forEach((entries, k) => {
      const y = h - foot + (1.5 * k + 1) * text;
      let x = text;
      for (const { row, lead, symbol, before, after, needs } of entries) {
        this.symbol(row, x + lead, y, symbol);
        this.flush();
        ctx.fillStyle = faint;
        ctx.fillText(before, x, y); ctx.fillText(after, x + lead + symbol + 5 * u, y);
        x += needs;
      }
    });
  }
  symbol(row, x, y, width) {
    const { ctx, u } = this;
    if (row.k === "ramp") {
      ctx.fillStyle = ctx.createLinearGradient(x, 0, x + width, 0);
      for (let k = 0; k < 32; k++) ctx.fillStyle.addColorStop(k / 31, this.ink(`@${row.ramp}`, row.low + (1 - row.low) * k / 31));
      ctx.fillRect(x, y - 4.5 * u, width, 9 * u);
    } else if (row.k === "glyph") this.glyph(row.g, [row.centred ? x + width / 2 : x, y]);
    else if (row.size) this.arrow(this.pen(this.ink(this.list.styles[row.s][0])), [x, y], [x + width, y], row.size);
    else {
      const path = this.pen(null, this.ink("ink"), 1.6 * u);
      for (const [a, b] of [[[x, y], [x + width, y]], ...[x, x + width].map((end) => [[end, y - 4 * u], [end, y + 4 * u]])]) polyline(path, [a, b]);
    }
  }

  // -- picking ------------------------------------------------------------------------------------------
  // The topmost named item under a pixel, {n, f, value}: its name, frame (or -1) and the text of an arrow; `of` says which frames count.
  pick(x, y, of = () => true) {
    const { ctx } = this, [px, py] = [x * this.dpr, y * this.dpr], { bodies } = this.head;
    const pair = (key) => `${bodies[Math.floor(key / bodies.length)].name}/${bodies[key % bodies.length].name}`;
    for (const item of this.shown.toReversed()) {
      const f = item.k === "path" ? item.f : -1, path = new Path2D();
      if (!item.n || !of(f) || !this.on(item)) continue;
      const [row,,, size] = item.k !== "arrows" ? [] : this.vectors(item).findLast(([, tail, tip]) => {
        const arrow = new Path2D();
        this.arrow(arrow, tail, tip, item.size);
        return ctx.isPointInPath(arrow, px, py);
      }) || [];
      if (row) return { n: item.l === "contacts" ? pair(row[1]) : item.n, f, value: this.arrowText(item, row, size) };
      if (f >= 0) this.place(f);
      if (item.k in LINES) LINES[item.k](this, item, path);
      ctx.lineWidth = REACH;
      const hit = item.k === "arrows" ? false : item.k === "mark" ? apart(this.at(item.at), [x, y]) <= REACH / 2
        : f >= 0 ? ctx.isPointInPath(this.path(item), px, py, item.m ? "nonzero" : "evenodd") : ctx.isPointInStroke(path, px, py);
      this.plain();
      if (hit) return { n: item.n, f };
    }
    return null;
  }
}
