// Bodies and joints, one function for each kind of part.

function capsuleInto(path, [x0, y0, x1, y1, r]) {
  const along = Math.atan2(y1 - y0, x1 - x0), q = Math.PI / 2;
  path.moveTo(x1 + r * Math.cos(along - q), y1 + r * Math.sin(along - q));
  path.arc(x1, y1, r, along - q, along + q);
  path.arc(x0, y0, r, along + q, along + 3 * q);
  path.closePath();
}

function pathInto(path, flat, closed) {
  for (let i = 0; i < flat.length; i += 2) {
    if (i) path.lineTo(flat[i], flat[i + 1]); else path.moveTo(flat[i], flat[i + 1]);
  }
  if (closed) path.closePath();
}

function outlineOf(p) {
  if (p.path) return p.path;
  p.path = new Path2D();
  for (const capsule of p.c || []) capsuleInto(p.path, capsule);
  for (const ring of p.r || []) pathInto(p.path, ring, true);
  p.holes = !p.m && (p.r || []).length > 1;
  for (const [key, of] of [["pitch", p.p], ["spoke", p.o]]) {
    if (of) { p[key] = new Path2D(); pathInto(p[key], of); }
  }
  return p.path;
}

const edgeOf = (s, p) => (s.hover && s.hover.b === p.b && s.hover.n === p.n
  ? s.ink("FORCE") : s.fills[p.f][1]);

KINDS.poly = (s, p) => {
  const { ctx, u, scale } = s, path = outlineOf(p), edge = edgeOf(s, p), rule = p.holes ? "evenodd" : "nonzero";
  s.place(p.b);
  ctx.strokeStyle = edge; ctx.fillStyle = s.fills[p.f][0];
  ctx.lineWidth = (p.m ? 2 : 1) * EDGE * u / scale;
  if (p.m) ctx.stroke(path);
  ctx.fill(path, rule);
  if (p.h) {
    s.plain();
    const [a, b, c, d, e, f] = s.frameOf(p.b).map((v) => v / s.dpr), moved = new Path2D();
    moved.addPath(path, new DOMMatrix([a, b, c, d, e, f]));
    ctx.fillStyle = s.hatch(s.fills[p.f][1]); ctx.fill(moved, rule);
    s.place(p.b);
  }
  if (!p.m) ctx.stroke(path);
  if (p.pitch) { ctx.lineWidth = HAIR * u / scale; ctx.stroke(p.pitch); }
  if (p.spoke) { ctx.lineWidth = EDGE * u / scale; ctx.stroke(p.spoke); }
  s.plain();
};

KINDS.dry = (s, p) => {                                   // what keeps a liquid out
  s.place(p.b);
  s.ctx.fillStyle = s.back; s.ctx.fill(outlineOf(p));
  s.plain();
};

KINDS.disc = (s, p, f) => {
  const edge = edgeOf(s, p), c = s.at(p.at), r = p.d === undefined ? p.s : f.drive[p.d];
  s.dot(c, r * s.scale, s.fills[p.f][0], edge, EDGE);
  if (p.h) s.dot(c, r * s.scale, s.hatch(s.fills[p.f][1]));
  else if (r > 0) s.line([c, s.at([p.b, p.at[1] + r, p.at[2]])], edge, EDGE);
  if (!p.path || r !== p.now) {
    p.path = new Path2D(); p.path.arc(p.at[1], p.at[2], Math.max(r, 1e-9), 0, TAU); p.now = r;
  }
};

KINDS.bar = (s, p) => {
  const ends = [s.at(p.a), s.at(p.e)];
  s.line(ends, edgeOf(s, p), 8 + EDGE); s.line(ends, s.fills[p.f][0], 8 - EDGE);
  s.hit({ k: "body", n: p.n, b: p.b }, ends);
};

KINDS.stalk = (s, p) => s.line([s.at(p.a), s.at(p.b)], s.fills[p.f][1], 2.2, { cap: "butt" });

KINDS.liquid = (s, p) => {
  const y = clamp(s.px(0, p.y)[1], -10, s.h + 10), { ctx } = s;
  ctx.fillStyle = s.ink("LIQUID"); ctx.fillRect(0, y, s.w, s.h - y);
  s.line([[0, y], [s.w, y]], s.ink("LIQUID_EDGE"), 1.4);
};

KINDS.ground = (s, p) => {
  const [x, y] = s.at(p.at), { u, ctx } = s, [fill, edge] = s.fills[p.f];
  s.area([[x, y], [x - 8 * u, y + 12 * u], [x + 8 * u, y + 12 * u]],
         fill, s.ink("FAINT_INK"), 1.2);
  ctx.fillStyle = s.hatch(edge); ctx.fillRect(x - 12 * u, y + 12 * u, 24 * u, 5 * u);
  s.line([[x - 12 * u, y + 12 * u], [x + 12 * u, y + 12 * u]], s.ink("INK"), 1.4);
};

// -- joints -----------------------------------------------------------------------------------------

KINDS.groove = (s, p) => {
  const ends = [s.at(p.a), s.at(p.b)];
  s.line(ends, s.ink("PIN_RING"), 5.2); s.line(ends, s.back, 3);
};

KINDS.rail = (s, p) => {                                  // in the ground: two lines and strokes
  const sorted = [s.at(p.a), s.at(p.b)].sort((a, b) => a[0] - b[0] || b[1] - a[1]);
  const [a, b] = sorted, [ux, uy] = unit(a, b), half = GAUGE / 2 * s.u, tick = 5 * s.u;
  const off = ([x, y], way) => [x - way * uy, y + way * ux];
  for (const way of [-half, half]) s.line([off(a, way), off(b, way)], s.ink("INK"), 1);
  for (const end of [a, b]) s.line([off(end, half), off(end, -half)], s.ink("INK"), 1);
  for (const [x, y] of along([off(a, half), off(b, half)], 8 * s.u)) {
    s.line([[x, y], [x - tick * (uy + ux), y + tick * (ux - uy)]], s.ink("FAINT_INK"), 0.9);
  }
};

KINDS.roller = (s, p) => {
  const at = s.at(p.b), r = GAUGE / 2 - 0.5;
  if (p.turns) { s.ring(at, r, 1.1, s.back); return; }
  const [ux, uy] = unit(s.at(p.a), s.at(p.e)), d = 2 * r * s.u;
  const ends = [[at[0] - d * ux, at[1] - d * uy], [at[0] + d * ux, at[1] + d * uy]];
  s.line(ends, s.ink("PIN_RING"), 2 * r, { cap: "butt" });
  s.line(ends, s.back, 2 * r - 2.2, { cap: "butt" });
};

function linkColour(s, p, f) {
  const tension = f.link ? f.link[p.j] : 0, share = tension / (s.head.scale.tension || Infinity);
  return Math.abs(share) > 1e-3 ? s.tensionColour(tension) : null;
}

function tell(s, p, f, a, b) {                            // what a rod or rope carries
  s.hit(p, [a, b]);
  if (!s.layers.has("tensions") || !f.link || !p.told || apart(a, b) < SHORT * s.u) return;
  if (!linkColour(s, p, f) ) return;
  beside(s, a, b, `${numberText(f.link[p.j], s.head.scale.tension)} N`);
}

function beside(s, a, b, text) {                          // a label of a bar, above it or right of it
  s.keepLine([a, b], 2.5);
  let [nx, ny] = [unit(a, b)[1], -unit(a, b)[0]];
  if (ny > 0 || (ny === 0 && nx < 0)) [nx, ny] = [-nx, -ny];
  const [w, h] = sizeOf(s, text), reach = Math.abs(nx) * w + Math.abs(ny) * h + 4 * s.u;
  const spots = [0.5, 0.4, 0.6, 0.3, 0.7].flatMap((share) => [reach, -reach].map((way) => {
    const [x, y] = between(a, b, share);
    return [x + way * nx, y + way * ny];
  }));
  s.label(text, spots, s.ink("INK"));
}

KINDS.rod = (s, p, f) => {
  const ends = [s.at(p.a), s.at(p.b)];
  s.line(ends, s.ink("PIN_RING"), 4.4); s.line(ends, linkColour(s, p, f) || s.back, 2.6);
  tell(s, p, f, ...ends);
};

function twisted(s, a, b, colour) {
  const [ux, uy] = unit(a, b), half = 0.62 * 4.6 * s.u;
  s.line([a, b], colour, 4.6, { cap: "butt" });
  for (const [x, y] of along([a, b], 6.5 * s.u)) {
    s.line([[x - half * (ux - uy), y - half * (uy + ux)], [x + half * (ux - uy), y + half * (uy + ux)]],
           s.back, 1.3, { cap: "butt" });
  }
}

KINDS.rope = (s, p, f) => {
  const a = s.at(p.a), b = s.at(p.b), [least, most] = p.reach, colour = linkColour(s, p, f);
  if (least > 0) {                                        // a least length besides: a cylinder
    const middle = between(a, b, 0.5);
    s.line([a, middle], s.ink("PIN_RING"), 4.4); s.line([a, middle], colour || s.back, 2.6);
    s.line([middle, b], s.ink("PIN_RING"), 1.6);
  } else if (apart(a, b) > 0.998 * most * s.scale) {
    twisted(s, a, b, colour || s.ink("ROPE"));
  } else {
    s.line(sagging(a, b, most * s.scale), s.ink("ROPE"), 1.3, { dash: [5, 3], cap: "butt" });
  }
  tell(s, p, f, a, b);
};

KINDS.actuator = (s, p) => {
  const a = s.at(p.a), b = s.at(p.b), length = apart(a, b), { u } = s, ring = s.ink("PIN_RING");
  const [low, high] = p.reach.map((v) => v * s.scale), stroke = high - low;
  let tube, piston;
  if (stroke <= 0.88 * low && 0.85 * low >= 12 * u) {
    tube = Math.min(Math.max(0.85 * low, stroke / 0.88 * 0.96), 0.96 * low);
    piston = (tube - stroke) / 2 + length - low;
  } else {
    tube = Math.min(Math.max(0.85 * low, 0.2 * high, 12 * u), 0.9 * length);
    piston = tube * (0.14 + 0.72 * clamp(stroke > 0 ? (length - low) / stroke : 0.5, 0, 1));
  }
  const on = (way) => between(a, b, length > 0 ? way / length : 0), flat = { cap: "butt" };
  s.line([on(piston), b], ring, 4.4, flat);
  s.line([a, on(tube)], ring, 13, flat);
  s.line([on(1.4 * u), on(tube - 1.4 * u)], s.back, 10.4, flat);
  s.line([on(piston), on(tube)], ring, 4.4, flat);
  const middle = Math.min(Math.max(piston, 4.4 * u), tube - 4.4 * u);
  s.line([on(middle - 3 * u), on(middle + 3 * u)], p.driven ? s.ink("DRIVE") : ring, 10.4, flat);
  s.hit(p, [a, b], 8);
};

function wedge(s, at, direction, size = 13) {
  s.area([at, ...arc(at, size * s.u, direction - 0.5, 1, 8)], s.ink("STOP"));
}

KINDS.stop = (s, p, f) => {
  const sign = f.stop ? f.stop[p.j] : 0;
  if (!sign) return;
  const at = s.at(p.at), sense = p.sense * Math.sign(sign);
  const [a, b] = [s.at(p.a), s.at(p.b)].map(([x, y]) => Math.atan2(-(y - at[1]), x - at[0]));
  const sweep = (((sense * (b - a)) % TAU) + TAU) % TAU;
  wedge(s, at, -(a + sense * sweep / 2));
};

function collar(s, at, holds) {
  s.ring(at, COLLAR, 1.1, holds ? s.ink("FAINT_INK") : s.back, s.ink("FAINT_INK"));
}
KINDS.collar = (s, p, f) => collar(s, s.at(p.at), f.sticks && f.sticks[p.j] === 1);

KINDS.pin = (s, p) => {
  const at = s.at(p.b);
  s.ring(at, PIN, 1.4);
  s.hit({ k: "joint", n: p.n, b: [p.b[0], p.a[0]].find((b) => s.head.moving.includes(b)) }, [at, at], 5);
};
KINDS.ends = (s, p) => { for (const end of [p.a, p.b]) s.ring(s.at(end), 0.75 * PIN, 1.2); };
KINDS.weld = (s, p) => {
  const [x, y] = s.at(p.a), h = 2.6 * s.u;
  s.ctx.fillStyle = s.ink("PIN_RING"); s.ctx.fillRect(x - h, y - h, 2 * h, 2 * h);
  s.hit({ k: "joint", n: p.n }, [[x, y], [x, y]], 5);
};

function diamond(s, [x, y], holds) {
  const h = 8.5 * s.u;
  s.area([[x + h, y], [x, y + h], [x - h, y], [x, y - h]], holds ? s.ink("INK") : s.back,
         s.ink("INK"), 1.4);
}
KINDS.latch = (s, p, f) => diamond(s, s.at(p.at), f.held && f.held[p.held] !== 0);
