// The Stage: a canvas, the camera, colours of the theme, labels, and draw(frame).

const KINDS = {};                                         // by the kind of a part: (stage, part, frame)
const NIGHT = "#12171d", FONT = '"DejaVu Sans", system-ui, sans-serif';
const NIGHT_INKS = {
  BACKGROUND: NIGHT, INK: "#e6eaee", FAINT_INK: "#9aa6b2", HAIRLINE: "#2c353f", FORCE: "#6fb0ff",
  STOP: "#ff5cb4", DRIVE: "#c79df2", SPRING: "#a3b2c2", PIN_FILL: NIGHT, PIN_RING: "#c3ccd6",
  SLACK: "#717b86", ROPE: "#b9ac98", TRACE: "#4cc3dd",
  VELOCITY: "#62d489", ACCELERATION: "#f0b052", REACTION: "#93aaf5", AXES: "#e08f8f", LIQUID: "#16283a", LIQUID_EDGE: "#4f7ea6",
};

class Stage {
  constructor(canvas, head) {
    this.canvas = canvas; this.ctx = canvas.getContext("2d"); this.head = head;
    this.layers = new Set(head.layers.filter((l) => l.on).map((l) => l.name));
    this.zoom = 1; this.pan = [0, 0]; this.hover = null; this.extra = []; this.stamp = ""; this.lines = 0;
    const follow = head.view && head.view.follow;
    this.follow = follow ? head.bodies.findIndex((b) => b.name === follow) : -1;
    this.dark = false; this.held = null; this.hits = []; this.names = null;
    this.moments = null;                                  // (see) shows frames of the whole run, if they are known
    this.dress();
  }
  dress() {                                               // take on light or dark
    this.dark = getComputedStyle(document.documentElement).getPropertyValue("--dark").trim() === "1";
    this.patterns = {};
    const { head } = this, [back, night] = [this.ink("BACKGROUND"), this.dark];
    this.fills = head.fills.map(([fill, edge]) => (night
      ? [mixed(fill, NIGHT, 0.7), mixed(edge, "#ffffff", 0.3)] : [fill, edge]));
    this.ramps = { pull: head.ramps.pull.map((c) => (night ? mixed(c, "#ffffff", 0.12) : c)),
                   push: head.ramps.push.map((c) => (night ? mixed(c, "#ffffff", 0.3) : c)) };
    this.back = back;
  }
  ink(name) { return this.dark ? NIGHT_INKS[name] : this.head.colours[name]; }

  // -- camera -----------------------------------------------------------------------------------
  resize() {
    const { canvas, head } = this, dpr = globalThis.devicePixelRatio || 1;
    const w = canvas.clientWidth || 300, h = canvas.clientHeight || 200;
    const [W, H] = [Math.round(w * dpr), Math.round(h * dpr)];
    if (canvas.width !== W || canvas.height !== H) { canvas.width = W; canvas.height = H; }
    Object.assign(this, { w, h, dpr, u: clamp(Math.min(w / 800, h / 560), 0.62, 1.5) });
    this.text = Math.max(10.5, Math.round(13 * this.u));
    this.rows = legendRows(this, head.legend);
    const lines = Math.max(this.rows.length, this.lines, this.stamp ? 1 : 0);
    this.foot = lines ? (1.6 * lines + 0.8) * this.text : 0;
    const [x0, y0, x1, y1] = this.follow < 0 ? head.unfollowed : head.box;
    const v = head.view || {}, free = 1 - 2 * MARGIN;
    const [width, height] = [Math.max(x1 - x0, 1e-9), Math.max(y1 - y0, 1e-9)];
    const [cx, cy] = v.centre || [(x0 + x1) / 2, (y0 + y1) / 2];
    const room = Math.max(h - this.foot, 20);
    const fitted = v.width ? Math.min(w / v.width, room * v.aspect / v.width)
      : free * Math.min(w / (2 * Math.max(x1 - cx, cx - x0, width / 2)),
                        room / (2 * Math.max(y1 - cy, cy - y0, height / 2)));
    this.scale = this.zoom * fitted;
    const [fx, fy] = this.followed();
    this.ox = w / 2 - this.scale * (cx + fx) + this.pan[0];
    this.oy = room / 2 + this.scale * (cy + fy) + this.pan[1];
  }
  followed() {                                            // how far the camera goes along
    const { follow: b, head, pose } = this;
    if (!(b >= 0) || !pose) return [0, 0];
    const c = head.bodies[b].centre, r = head.rest.slice(3 * b, 3 * b + 3);
    const now = turned(c, pose[3 * b + 2]), then = turned(c, r[2]);
    return [pose[3 * b] + now[0] - r[0] - then[0], pose[3 * b + 1] + now[1] - r[1] - then[1]];
  }
  px(x, y) { return [this.ox + this.scale * x, this.oy - this.scale * y]; }
  world(x, y) { return [(x - this.ox) / this.scale, (this.oy - y) / this.scale]; }
  local(b, [x, y]) {                                      // a point of the world in a body's frame
    const p = this.pose;
    return turned([x - p[3 * b], y - p[3 * b + 1]], -p[3 * b + 2]);
  }
  at([b, x, y]) {
    const p = this.pose, a = p[3 * b + 2], c = Math.cos(a), s = Math.sin(a);
    return this.px(p[3 * b] + c * x - s * y, p[3 * b + 1] + s * x + c * y);
  }
  frameOf(b) {                                            // metres of body b to device pixels
    const p = this.pose, a = p[3 * b + 2], k = this.scale * this.dpr;
    const c = Math.cos(a) * k, s = Math.sin(a) * k, [x, y] = this.px(p[3 * b], p[3 * b + 1]);
    return [c, -s, -s, -c, x * this.dpr, y * this.dpr];
  }
  place(b) { this.ctx.setTransform(...this.frameOf(b)); }
  plain() { this.ctx.setTransform(this.dpr, 0, 0, this.dpr, 0, 0); }
  zoomAt(factor, x, y) {                                  // the point at (x, y) stays where it is
    const [a, b] = this.world(x, y);
    this.zoom = clamp(this.zoom * factor, 0.1, 400);
    this.resize();
    const [p, q] = this.px(a, b);
    this.pan[0] += x - p; this.pan[1] += y - q;
  }
  fit() { this.zoom = 1; this.pan = [0, 0]; }

  // -- one frame ------------------------------------------------------------------------------------
  draw(frame, ghosts = []) {
    const { ctx } = this;
    this.pose = frame.pose; this.frame = frame;
    this.resize(); this.plain();
    ctx.lineJoin = ctx.lineCap = "round"; ctx.globalAlpha = 1;
    ctx.fillStyle = this.back; ctx.fillRect(0, 0, this.w, this.h);
    this.labels = []; this.busy = []; this.hits = []; this.abouts = [];
    if (this.layers.has("coordinates")) grid(this);
    this.parts(this.head.parts, frame);
    for (const ghost of ghosts) this.ghost(ghost);
    if (this.layers.has("names") && this.follow < 0) fingerNames(this, frame);
    for (const more of this.extra) more(this, frame);
    this.strip();
    this.write();
  }
  parts(parts, f) {
    const gone = (tie) => tie !== undefined && f.held && f.held[tie] === 0;   // none: not recorded
    for (const p of parts) {
      if (this.layers.has(p.l) && !gone(p.tie) && !gone(p.tie2)) KINDS[p.k](this, p, f);
    }
  }
  ghost({ head, frame, fills: own }) {                    // bodies of another run, in its colours
    const { pose, fills, hits } = this;
    Object.assign(this, { pose: frame.pose, fills: own, hits: [] });
    const solid = head.parts.filter((p) => ["poly", "disc", "bar"].includes(p.k) && !p.h);
    this.parts(solid, frame);
    Object.assign(this, { pose, fills, hits });
  }
  strip() {                                               // the legend, and the time
    const { ctx } = this;
    if (!this.foot) return;
    ctx.fillStyle = this.back; ctx.fillRect(0, this.h - this.foot, this.w, this.foot);
    drawLegend(this);
  }

  // -- strokes --------------------------------------------------------------------------------------
  line(pts, colour, width, { dash, cap = "round", closed } = {}) {
    const { ctx, u } = this;
    ctx.strokeStyle = colour; ctx.lineWidth = width * u; ctx.lineCap = cap;
    if (dash) ctx.setLineDash(dash.map((d) => d * u));
    ctx.beginPath();
    pts.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
    if (closed) ctx.closePath();
    ctx.stroke();
    if (dash) ctx.setLineDash([]);
    ctx.lineCap = "round";
  }
  area(pts, fill, edge, width) {
    const { ctx } = this;
    ctx.beginPath();
    pts.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
    ctx.closePath();
    if (fill) { ctx.fillStyle = fill; ctx.fill(); }
    if (edge) { ctx.strokeStyle = edge; ctx.lineWidth = width * this.u; ctx.stroke(); }
  }
  dot([x, y], r, fill, edge, width) {                     // r in pixels
    const { ctx } = this;
    ctx.beginPath(); ctx.arc(x, y, Math.max(r, 0.01), 0, TAU);
    if (fill) { ctx.fillStyle = fill; ctx.fill(); }
    if (edge) { ctx.strokeStyle = edge; ctx.lineWidth = width * this.u; ctx.stroke(); }
  }
  ring(at, points, width, fill = this.ink("PIN_FILL"), edge = this.ink("PIN_RING")) {
    this.dot(at, (points - width / 2) * this.u, fill, edge, width);
  }
  arrow(tail, tip, widths, colour) {                      // rim's, then its own [shaft, head]
    const { u } = this;
    this.area(arrowShape(tail, tip, widths[0][0] * u, widths[0][1] * u), this.back);
    this.area(arrowShape(tail, tip, widths[1][0] * u, widths[1][1] * u), colour);
    for (const w of [0.55, 0.75, 1]) this.keep(between(tail, tip, w), 3 * u);
  }
  hatch(edge) {
    if (!this.patterns[edge]) {
      const pitch = 7 * this.u * this.dpr, side = Math.max(4, Math.round(pitch * Math.SQRT1_2 * 1.4));
      const c = new OffscreenCanvas(side, side), g = c.getContext("2d");
      g.strokeStyle = this.dark ? mixed(edge, NIGHT, 0.4) : mixed(edge, "#ffffff", 0.45);
      g.lineWidth = 0.9 * this.u * this.dpr;
      g.beginPath();
      for (const o of [-side, 0, side]) { g.moveTo(o - 1, side + 1); g.lineTo(o + side + 1, -1); }
      g.stroke();
      this.patterns[edge] = this.ctx.createPattern(c, "repeat");
      this.patterns[edge].setTransform(new DOMMatrix().scale(1 / this.dpr));
    }
    return this.patterns[edge];
  }
  tensionColour(tension) {
    if (!this.layers.has("tensions")) return this.ink("SPRING");
    const share = tension / (this.head.scale.tension || 1), ramp = this.ramps[share < 0 ? "push" : "pull"];
    return levelOf(ramp, share);
  }

  // -- labels and picking ---------------------------------------------------------------------------
  keep([x, y], half) { this.busy.push([x - half, y - half, x + half, y + half]); }
  keepLine(pts, half) { for (const at of along(pts, 6 * this.u)) this.keep(at, half * this.u); }
  labelFont() { return `600 ${Math.max(10, this.text - 1)}px ${FONT}`; }
  // A text at the first of its spots that is free; one that tells of a point `tip` may stand off, on a line.
  label(text, spots, colour, required, tip) { this.labels.push({ text, spots, colour, required, tip }); }
  halo(text, x, y, colour) {
    const { ctx } = this;
    ctx.lineWidth = 3; ctx.strokeStyle = this.back; ctx.lineJoin = "round";
    ctx.strokeText(text, x, y);
    ctx.fillStyle = colour; ctx.fillText(text, x, y);
  }
  write() {
    const { ctx, text: size } = this, taken = this.busy, bottom = this.h - this.foot;
    ctx.font = this.labelFont();
    ctx.textAlign = "center"; ctx.textBaseline = "middle";
    for (const label of [...this.labels].sort((a, b) => !!b.required - !!a.required)) {
      const w = ctx.measureText(label.text).width / 2 + 1, h = 0.62 * size;
      const free = ([x, y]) => x - w >= 0 && x + w <= this.w && y - h >= 0 && y + h <= bottom
        && taken.every(([a, b, c, d]) => x + w <= a || x - w >= c || y + h <= b || y - h >= d);
      let at = label.spots.find(free);
      if (!at && label.required) {
        const [x, y] = label.spots[0];
        if (x > -w && x < this.w + w && y > -h && y < bottom + h) {
          at = [clamp(x, w, this.w - w), clamp(y, h, bottom - h)];
        }
      }
      if (!at && label.tip) {
        const away = spots(this, [w, h], OF_NUMBERS).find(([dx, dy]) => free([label.tip[0] + dx, label.tip[1] + dy]));
        if (away) {
          at = [label.tip[0] + away[0], label.tip[1] + away[1]];
          this.line(leader(this, { away, half: [w, h] }, label.tip, TIP), mixed(label.colour, this.back, 0.35), 1);
        }
      }
      if (!at) continue;
      taken.push([at[0] - w, at[1] - h, at[0] + w, at[1] + h]);
      this.halo(label.text, at[0], at[1], label.colour);
    }
  }
  hit(part, pts, reach = 6) { this.hits.push({ part, pts, reach }); }
  // What is at a pixel of the last frame, null if nothing: {k, n, b}, its kind, name and body (or -1);
  // of a contact force also its row. `of` says which bodies count.
  pick(x, y, of = () => true) {
    for (let i = this.hits.length - 1; i >= 0; i--) {
      const { part, pts, reach } = this.hits[i], b = typeof part.b === "number" ? part.b : -1;
      if (of(b) && toPath([x, y], pts) < reach) return { k: part.k, n: part.n, b, row: part.row };
    }
    for (let i = this.head.parts.length - 1; i >= 0; i--) {
      const p = this.head.parts[i];
      if (p.path && this.layers.has(p.l) && p.n && of(p.b) && this.inside(p, x, y)) return { k: "body", n: p.n, b: p.b };
    }
    return null;
  }
  inside(p, x, y) {
    this.place(p.b);
    const found = this.ctx.isPointInPath(p.path, x * this.dpr, y * this.dpr,
                                         p.holes ? "evenodd" : "nonzero");
    this.plain();
    return found;
  }
}
