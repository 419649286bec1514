// Each kind of item on a Stage: LINES are added to a path in pixels, PAINT draws the others.

const LINES = {
  line(s, item, path) { polyline(path, item.p.map((p) => s.at(p))); },
  span(s, item, path) {                                   // a pattern between two points
    const a = s.at(item.a), b = s.at(item.b), d = apart(a, b) || 1e-9, [ex, ey] = [(b[0] - a[0]) / d, (b[1] - a[1]) / d], { t } = item, { u } = s;
    const draw = (from, along, across) => {
      for (let i = 0; i < t.length; i += 2) {
        const w = from + t[i] * along, v = t[i + 1] * across, x = a[0] + w * ex + v * ey, y = a[1] + w * ey - v * ex;
        if (i) path.lineTo(x, y); else path.moveTo(x, y);
      }
    };
    if (item.every) for (let k = 1; k < Math.min(2000, d / (item.every * u)); k++) draw(k * item.every * u, u, u);
    else draw(0, d, clamp(item.w[0] * d, item.w[1] * u, item.w[2] * u));
  },
  spiral(s, item, path) {
    const [x, y] = s.at(item.at), [r0, r1] = item.r.map((r) => r * s.u), from = s.value(item.start), sweep = s.value(item.sweep), head = (item.head || 0) * s.u;
    const back = head ? Math.min(0.8 * Math.abs(sweep), head / r1) / Math.max(Math.abs(sweep), 1e-9) : 0;
    const spot = (w) => [x + (r0 + (r1 - r0) * w) * Math.cos(from + sweep * w), y - (r0 + (r1 - r0) * w) * Math.sin(from + sweep * w)];
    for (let k = 0; k < 24; k++) if (k) path.lineTo(...spot(k / 23 * (1 - back))); else path.moveTo(...spot(0));
    return [spot(1 - back), spot(1)];
  },
  taut(s, item, path) {
    let begun = false;
    for (const [f, x, y, radius, sense, meets, leaves] of item.p) {
      const [px, py] = s.at([f, x, y]), round = meets !== undefined, from = round && s.value(meets), to = round && s.value(leaves);
      if (Number.isNaN(from + to)) continue;              // off this circle
      const r = round ? Math.max(0, s.value(radius) * s.scale) : 0, first = [px + r * Math.cos(from), py - r * Math.sin(from)];
      if (begun) path.lineTo(...first); else path.moveTo(...first);
      begun = true;
      if (round) path.arc(px, py, r, -from, -to, to > from || (to === from && sense < 0));
    }
    if (item.c) path.closePath();
  },
  sag(s, item, path) {
    const a = s.at(item.a), b = s.at(item.b);
    path.moveTo(...a);
    path.quadraticCurveTo((a[0] + b[0]) / 2, (a[1] + b[1]) / 2 + 2 * s.value(item.depth) * s.scale, ...b);
  },
  trail(s, item, path) {                                  // returns the places of its marks
    const { way, times, count } = s.frame.trail(item), points = [], spots = [];
    let [x, y] = [Infinity, Infinity], next = item.every * Math.ceil(times[0] / item.every + 1e-9);
    for (let k = 0; k < count; k++) {
      const at = s.px(way[2 * k], way[2 * k + 1]);
      if (times[k] >= next - 1e-9) { spots.push(at); next = item.every * (Math.floor(times[k] / item.every + 1e-9) + 1); }
      if (!(Math.hypot(at[0] - x, at[1] - y) < SHORTEST)) { points.push(at); [x, y] = at; }
    }
    polyline(path, [...points, s.at(item.at)]);
    return spots;
  },
};

const PAINT = {
  path(s, item) {
    const path = s.path(item), { ctx } = s, { fill, edge, width, dash, hatched } = s.look(item), rule = item.m ? "nonzero" : "evenodd", k = 1 / s.scale;
    s.flush();
    s.place(item.f);
    if (item.m) s.stroke(path, edge, 2 * width * k, dash * k);   // one outline round the union
    if (fill) { ctx.fillStyle = fill; ctx.fill(path, rule); }
    if (hatched) { ctx.fillStyle = s.hatch(edge); ctx.fill(path, rule); }
    if (!item.m) s.stroke(path, edge, width * k, dash * k);
  },
  mark(s, item) { s.glyph(s.choice(item, item.g), s.at(item.at), item.turn === undefined ? 0 : s.value(item.turn)); },
  spiral(s, item) {
    const { edge, width } = s.look(item), end = LINES.spiral(s, item, s.pen(null, edge, width));
    if (item.head) arrowOn(s.pen(edge, null), ...end, width, item.head * s.u);
  },
  arrows(s, item) {
    const { fill, edge: rim, width } = s.look(item);
    for (const [row, tail, tip, size] of s.vectors(item)) {
      if (rim) s.arrow(s.pen(rim, null), tail, tip, item.size, width);
      s.arrow(s.pen(fill, null), tail, tip, item.size);
      if (size > item.most) {                             // two slanted bars across it
        const d = apart(tail, tip) || 1, half = (item.size[0] + 6.5) / 2 * s.u, [x, y] = [(tip[0] - tail[0]) / d, (tip[1] - tail[1]) / d];
        const bar = [y * half - 2 * s.u * x, -x * half - 2 * s.u * y];
        const end = (w, side) => [0, 1].map((k) => tail[k] + w * (tip[k] - tail[k]) + side * bar[k]);
        for (const w of [0.4, 0.5]) polyline(s.pen(null, rim, 1.8 * s.u), [end(w, 1), end(w, -1)]);
      }
      const name = item.names?.[row[1]] || "";
      if (size >= 0.5 * (item.labelled || 0)) s.say(item, row[1], `${name} ${s.arrowText(item, row, size)}`.trim(), tip, [tip[0] - tail[0], tip[1] - tail[1]], fill, size);
    }
  },
  strips(s, item) {
    const { fill, edge, width } = s.look(item);
    for (const row of s.frame.tables[item.t] || []) {
      const corners = [0, 1, 2, 3].map((k) => s.px(row[2 + 2 * k], row[3 + 2 * k])), path = s.pen(fill, edge, width);
      polyline(path, corners);
      path.closePath();
      const high = apart(corners[2], corners[1]) > apart(corners[3], corners[0]), [tip, foot] = high ? [corners[2], corners[1]] : [corners[3], corners[0]];
      if (row[10] >= item.least) s.say(item, row[1], s.valueText(item, row[10]), tip, [tip[0] - foot[0], tip[1] - foot[1]], edge || fill, row[10]);
    }
  },
  trail(s, item) {
    const { fill, edge, width } = s.look(item);
    for (const spot of LINES.trail(s, item, s.pen(null, edge, width))) s.dot(spot, item.mark * s.u, fill || edge);
    s.dot(s.at(item.at), 1.5 * width, fill || edge);
  },
  text(s, item) {
    const words = "value" in item ? `${item.words} ${s.valueText(item, s.value(item.value))}`.trim() : item.words;
    s.say(item, 0, words, s.at(item.at), null, s.look(item).edge, 0);
  },
};
