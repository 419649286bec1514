// Drives, loads, contact forces, traces, and what is shown on wish.

const sizeOf = (s, text) => [0.31 * s.text * text.length + 1, 0.62 * s.text + 1];   // half of a label's

function besideTip(s, tail, tip, text) {                  // places for a text, best first
  const d = unit(tail, tip), [w, h] = sizeOf(s, text);
  return [0, 0.6, -0.6, 1.1, -1.1, 1.6, -1.6, 2.2, -2.2].map((angle) => {
    const [dx, dy] = turned(d, angle);
    const r = Math.min(w / Math.max(Math.abs(dx), 1e-6), h / Math.max(Math.abs(dy), 1e-6)) + 3 * s.u;
    return [tip[0] + dx * r, tip[1] + dy * r];
  });
}

KINDS.contacts = (s, p, f) => {
  const { metres, reference, longest } = s.head.scale;
  if (!metres) return;
  const rows = f.contacts.filter((row) => !p.of || p.of.includes(row[4]) || p.of.includes(row[5]))
    .map((row) => [Math.hypot(row[2], row[3]), row]).sort((a, b) => b[0] - a[0]);
  const drawn = rows.map(([size, row]) => {
    const k = metres * Math.min(1, longest / (size || 1)), [x, y, fx, fy] = row;
    return { size, row, tail: s.px(x, y), tip: s.px(x + k * fx, y + k * fy) };
  }).filter(({ tail, tip }) => apart(tail, tip) >= 2.5 * s.u);
  for (const { size, row, tail, tip } of [...drawn].reverse()) {
    const [a, b] = [row[4], row[5]].map((i) => s.head.bodies[i].name);
    s.arrow(tail, tip, FINE, s.ink("FORCE"));
    if (size > longest) cutMarks(s, tail, tip, 4.5);
    s.hit({ k: "contact", n: `${a}/${b}`, b: row[4], row }, [tail, tip], 5);
    s.keepLine([between(tail, tip, 0.3), tip], 3);
  }
  for (const { size, tail, tip } of drawn.slice(0, MOST_LABELS)) {
    if (size < LABELLED * reference) break;
    const text = `${numberText(size, reference)} N`;
    s.label(text, besideTip(s, tail, tip, text), s.ink("FORCE"), false, tip);
  }
};

function cutMarks(s, tail, tip, half) {                   // two bars: it would be longer
  const [ux, uy] = unit(tail, tip), reach = half * s.u, lean = 2 * s.u;
  for (const w of [0.4, 0.5]) {
    const [x, y] = between(tail, tip, w);
    s.line([[x + uy * reach - ux * lean, y - ux * reach - uy * lean],
            [x - uy * reach + ux * lean, y + ux * reach + uy * lean]], s.back, 1.8);
  }
}

// Strips along flat sides, out of the body, as high as the force per length.
KINDS.pressure = (s, p, f) => {
  const edge = s.ink("FORCE"), pale = mixed(edge, s.back, 0.6);
  const rows = [...f.patches].sort((a, b) => Math.max(b[2], b[5]) - Math.max(a[2], a[5]));
  rows.forEach(([x, y, q, x1, y1, q1], i) => {
    const a = s.px(x, y), b = s.px(x1, y1), [ux, uy] = unit(a, b);
    const top = ([px, py], v) => {
      const high = s.scale * p.metres * Math.min(v, p.longest);
      return [px + high * uy, py - high * ux];
    };
    const [over, over1] = [top(a, q), top(b, q1)], most = Math.max(q, q1);
    s.area([a, b, over1, over], pale, edge, 1.2);
    if (i >= MOST_LABELS / 2 || most < LABELLED * p.most) return;
    const text = `${numberText(most, p.most)} N/m`;
    s.label(text, q > q1 ? besideTip(s, a, over, text) : besideTip(s, b, over1, text), edge);
  });
};

KINDS.loads = (s, p, f) => {
  p.at.forEach((at, i) => {
    if (p.of && !p.of.includes(i)) return;
    const [fx, fy, torque] = f.load.slice(3 * i, 3 * i + 3), size = Math.hypot(fx, fy);
    if (!(size > 0.02 * p.most) || !p.metres) return;
    let tail = s.at(at);
    if (p.lifts[i] && fy) tail = [tail[0] + torque / fy * s.scale, tail[1]];
    const k = s.scale * p.metres * Math.min(1, p.longest / size);
    const tip = [tail[0] + k * fx, tail[1] - k * fy];
    if (apart(tail, tip) < 5 * s.u) return;
    s.arrow(tail, tip, SLIM, s.ink("DRIVE"));
    if (size > p.longest) cutMarks(s, tail, tip, 5.5);
    s.hit({ k: "load", n: p.names[i], b: at[0] }, [tail, tip]);
    const text = `${p.names[i]} ${numberText(size, p.most)} N`;
    if (p.told) s.label(text, besideTip(s, tail, tip, text), s.ink("DRIVE"));
  });
};

// -- drives -------------------------------------------------------------------------------------------

function pointing(s, p) {                                 // the way of a drive's arrow
  const [a, b] = [s.at(p.to[0]), s.at(p.to[1])], d = [b[0] - a[0], b[1] - a[1]];
  const r = p.radius * s.scale, square = d[0] ** 2 + d[1] ** 2;
  if (r && square > r * r) {                              // a cord leaves its wheel at a tangent
    return turned(d, Math.atan2(r, Math.sqrt(square - r * r)));
  }
  return [d[0] + p.dir[0], d[1] - p.dir[1]];
}

KINDS.drive = (s, p, f) => {
  const value = f.drive[p.d], at = s.at(p.at), colour = s.ink("DRIVE");
  if (!(Math.abs(value) > 5e-3 * p.most)) return;
  const text = `${p.n} ${p.bend ? +value.toPrecision(3) : numberText(Math.abs(value), p.usual)} ${p.unit}`;
  if (p.bend) {
    const before = s.abouts.filter((other) => apart(other, at) < 6 * s.u).length, r = 15 + 6 * before;
    s.abouts.push(at);
    turnArrow(s, at, p.bend * Math.sign(value), r);
    s.keep(at, 0.8 * r * s.u);
    s.label(text, [25, -25, 41, -41].map((way) => [at[0], at[1] + way * s.u]), colour, true);
    s.hit(p, arc(at, r * s.u, 0, TAU, 12), 5);
    return;
  }
  const { metres, longest } = s.head.scale, share = p.usual > 0 ? Math.abs(value) / p.usual : 0;
  const length = s.scale * (p.scaled ? Math.min(Math.abs(value), longest) * metres
    : p.long * (0.5 + 0.5 * Math.min(share, 1.5)));
  const d = pointing(s, p), k = Math.sign(value) * length / (Math.hypot(...d) || 1);
  const tip = [at[0] + k * d[0], at[1] + k * d[1]];
  s.arrow(at, tip, p.scaled ? SLIM : BLOCK, colour);
  if (p.scaled ? Math.abs(value) > longest : share > 1.5) cutMarks(s, at, tip, p.scaled ? 5.5 : 9);
  s.label(text, besideTip(s, at, tip, text), colour, true);
  s.hit(p, [at, tip], 8);
};

function turnArrow(s, at, sense, points) {
  const angles = Array.from({ length: 26 }, (_, k) => (-50 + 10 * k) * Math.PI / 180);
  const pts = angles.map((a) => around(at, points * s.u, -(sense < 0 ? Math.PI - a : a)));
  s.line(pts.slice(0, -3), s.ink("DRIVE"), 3.2, { cap: "butt" });
  s.area(arrowShape(pts[pts.length - 4], pts[pts.length - 1], 3.2 * s.u, 12 * s.u), s.ink("DRIVE"));
}

function brakeMark(s, [x, y], holds) {
  const h = 5.6 * s.u;
  s.area([[x - h, y - h], [x + h, y - h], [x + h, y + h], [x - h, y + h]],
         holds ? s.ink("DRIVE") : s.back, s.ink("DRIVE"), 1.5);
}
function motorMark(s, at, sense) {
  const r = 9.5 * s.u, colour = s.ink("DRIVE"), from = -sense * Math.PI / 4;
  if (!sense) { s.dot(at, r, null, colour, 1.5); return; }
  const pts = arc(at, r, from, -sense * 3.9), end = from - sense * 3.9, [x, y] = pts[pts.length - 1];
  s.line(pts, colour, 1.5);
  const on = (ahead, aside) => [x + ahead * sense * Math.sin(end) + aside * Math.cos(end),
                                y - ahead * sense * Math.cos(end) + aside * Math.sin(end)];
  s.area([on(8 * s.u, 0), on(0, 3 * s.u), on(0, -3 * s.u)], colour);
}
function servoMark(s, at) {
  s.dot(at, 9.5 * s.u, null, s.ink("DRIVE"), 1.5);
  for (let k = 0; k < 4; k++) {
    s.line([7, 12.5].map((r) => around(at, r * s.u, k * Math.PI / 2)), s.ink("DRIVE"), 2);
  }
}
const marked = (draw) => (s, p, f) => {
  const at = s.at(p.at);
  draw(s, at, p, f.drive[p.d]);
  s.hit(p, arc(at, 9.5 * s.u, 0, TAU, 12), 4);
};
KINDS.brake = marked((s, at, p, value) => brakeMark(s, at, value > 0));
KINDS.motor = marked((s, at, p, value) => motorMark(s, at, Math.sign(p.sense * value)));
KINDS.servo = marked((s, at) => servoMark(s, at));

KINDS.told = (s, p, f) => {
  const [a, b] = p.at.map((at) => s.at(at)), [x, y] = between(a, b, 0.5), { u } = s;
  let shown = (f.given ? f.given[p.c] : 0).toFixed(p.decimals);
  if (!+shown) shown = shown.replace("-", "");
  const text = `${p.n} ${shown} ${p.unit}`, aside = sizeOf(s, text)[0] + 16 * u;
  s.label(text, [...(apart(a, b) < 1e-6 ? [[x, y + 20 * u], [x, y - 20 * u]] : []),
                 [x + aside, y], [x - aside, y], [x, y + 34 * u]], s.ink("DRIVE"));
};

KINDS.belt = (s, p, f) => {                               // marks that run along an outline
  if (!p.lengths) {
    p.lengths = [0];
    for (let i = 2; i < p.r.length; i += 2) {
      p.lengths.push(p.lengths[i / 2 - 1] + Math.hypot(p.r[i] - p.r[i - 2], p.r[i + 1] - p.r[i - 1]));
    }
  }
  const whole = p.lengths[p.lengths.length - 1], sign = p.sense * f.drive[p.d] < 0 ? -1 : 1;
  const count = Math.max(3, Math.round(whole * s.scale / (34 * s.u)));
  for (let k = 0; k < count; k++) {
    const at = (((f.way[p.w] + whole * k / count) % whole) + whole) % whole;
    const i = Math.min(indexBelow(p.lengths, at), p.lengths.length - 2), w = at - p.lengths[i];
    const a = [p.b, p.r[2 * i], p.r[2 * i + 1]], b = [p.b, p.r[2 * i + 2], p.r[2 * i + 3]];
    const share = w / (p.lengths[i + 1] - p.lengths[i] || 1);
    beltMark(s, between(s.at(a), s.at(b), share), unit(s.at(a), s.at(b)).map((v) => sign * v), sign);
  }
};
function beltMark(s, [x, y], [ux, uy], inward) {
  const size = 6 * s.u, [ix, iy] = [inward * uy * size, -inward * ux * size];
  const [mx, my] = [x + 0.75 * ix, y + 0.75 * iy];
  s.area([[mx + size * ux, my + size * uy], [mx - 0.6 * size * ux + 0.7 * ix, my - 0.6 * size * uy + 0.7 * iy],
          [mx - 0.6 * size * ux - 0.7 * ix, my - 0.6 * size * uy - 0.7 * iy]], s.ink("DRIVE"), s.back, 0.6);
}

KINDS.trace = (s, p, f) => {
  const way = f.ways && f.ways[p.w], tip = s.at(p.at), pts = [], colour = p.ink || s.ink("TRACE");
  for (let i = 0; way && i <= f.upto && 2 * i + 1 < way.length; i++) {
    const at = s.px(way[2 * i], way[2 * i + 1]);
    if (!pts.length || apart(pts[pts.length - 1], at) > 1.5) pts.push(at);
  }
  s.line([...pts, tip], colour, 1.8);
  s.dot(tip, 2.7 * s.u, colour);
  if (p.name && !s.layers.has("body_names")) nameAbout(s, p.name, tip, colour);
  if (!f.times || !f.times.length) return;
  const end = Math.min(f.t, f.times[f.times.length - 1]) * (1 + 1e-6);
  let last = null, k = Math.floor(f.times[0] / p.every * (1 - 1e-9)) + 1;
  for (; k * p.every <= end; k++) {                       // at round times, which may lie between samples
    const at = s.px(...wayAt(f.times, way, k * p.every));
    if (last && apart(last, at) < 9 * s.u) continue;
    s.dot(at, 3 * s.u, colour);
    last = at;
  }
};

function wayAt(times, way, t) {                           // where a point was [m]
  const i = Math.min(indexBelow(times, t), Math.max(times.length - 2, 0)), j = Math.min(i + 1, times.length - 1);
  const w = times[j] > times[i] ? clamp((t - times[i]) / (times[j] - times[i]), 0, 1) : 0;
  return between(way.slice(2 * i, 2 * i + 2), way.slice(2 * j, 2 * j + 2), w);
}

KINDS.band = (s, p, f) => {                               // a bar in the colour of what it carries
  const ends = [s.at(p.a), s.at(p.e)], tension = f.bars ? f.bars[p.j] : 0, top = s.head.scale.bars;
  const share = tension / (top || Infinity), push = s.ramps[share < 0 ? "push" : "pull"];
  s.line(ends, s.ink("PIN_RING"), 6.8, { cap: "butt" });
  s.line(ends, levelOf(push, share), 5, { cap: "butt" });
  s.hit({ k: "body", n: p.n, b: p.b }, ends);
  if (p.told && apart(...ends) > SHORT * s.u) beside(s, ...ends, `${numberText(tension, top)} N`);
};

KINDS.vectors = (s, p, f) => {                            // velocities, accelerations, forces of hinges
  const values = f[p.v];
  if (!values) return;
  const found = p.at.map((at, i) => [at, values[2 * i], values[2 * i + 1]])
    .filter((_, i) => !p.of || p.of.includes(i))
    .map(([at, x, y]) => ({ at, x, y, size: Math.hypot(x, y) })).sort((a, b) => b.size - a.size);
  found.forEach(({ at, x, y, size }, i) => {
    const k = s.scale * p.metres * Math.min(1, p.longest / (size || 1)), tail = s.at(at);
    const tip = [tail[0] + k * x, tail[1] - k * y], text = `${numberText(size, p.most)} ${p.unit}`;
    if (apart(tail, tip) < 5 * s.u) return;
    s.arrow(tail, tip, FINE, s.ink(p.ink));
    if (size > p.longest) cutMarks(s, tail, tip, 4.5);
    if (i < MOST_LABELS && size >= LABELLED * p.most) s.label(text, besideTip(s, tail, tip, text), s.ink(p.ink));
  });
};

// -- bodies' names and frames, the grid --------------------------------------------------------------

KINDS.name = (s, p) => nameAbout(s, p.n, s.at(p.at), s.ink("FAINT_INK"));  // of a body, beside its centre of mass

function nameAbout(s, name, [x, y], colour) {
  const aside = sizeOf(s, name)[0] + 8 * s.u, away = 15 * s.u;
  s.label(name, [1, 1.8, 2.8].flatMap((k) => [[x, y - away * k], [x, y + away * k],
                                             [x + aside * k, y], [x - aside * k, y]]), colour);
}

KINDS.axes = (s, { b }) => {
  const [x, y] = s.px(s.pose[3 * b], s.pose[3 * b + 1]), angle = s.pose[3 * b + 2];
  [["x", angle], ["y", angle + Math.PI / 2]].forEach(([name, q]) => {
    const tip = [x + 26 * s.u * Math.cos(q), y - 26 * s.u * Math.sin(q)];
    s.arrow([x, y], tip, [[3.4, 8], [1.4, 7]], s.ink("AXES"));
    s.label(name, besideTip(s, [x, y], tip, name), s.ink("AXES"));
  });
};

function grid(s) {                                        // lines of the world with numbers
  const step = roundLength(110 / s.scale), [x0, y1] = s.world(0, 0), [x1, y0] = s.world(s.w, s.h - s.foot);
  const { ctx } = s;
  ctx.font = `${Math.max(10, s.text - 2)}px ${FONT}`; ctx.fillStyle = s.ink("FAINT_INK");
  ctx.textAlign = "left"; ctx.textBaseline = "bottom";
  for (let k = Math.ceil(x0 / step); k <= x1 / step; k++) {
    const [x] = s.px(k * step, 0);
    s.line([[x, 0], [x, s.h - s.foot]], s.ink("HAIRLINE"), k ? 0.8 : 1.6);
    ctx.fillText(k ? `${k < 0 ? "-" : ""}${lengthText(Math.abs(k * step))}` : "0", x + 3, s.h - s.foot - 2);
  }
  for (let k = Math.ceil(y0 / step); k <= y1 / step; k++) {
    const [, y] = s.px(0, k * step);
    s.line([[0, y], [s.w, y]], s.ink("HAIRLINE"), k ? 0.8 : 1.6);
    if (k) ctx.fillText(`${k < 0 ? "-" : ""}${lengthText(Math.abs(k * step))}`, 3, y - 2);
  }
}
