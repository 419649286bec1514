// Springs, cords and lines of fluid, one function for each kind of part.

const stiffer = (share) => {                              // -1 to 1, 0 at its own stiffness
  const [low, high] = THICK, f = clamp(share, low, high);
  return f > 1 ? Math.log(f) / Math.log(high) : -Math.log(f) / Math.log(low);
};
const thickened = (share) => {
  const w = stiffer(share);
  return 1 + (w > 0 ? 1.2 : 0.3) * w;
};
const drivenInk = (s, share) => {
  const w = stiffer(share);
  return mixed(s.ink("SPRING"), s.ink(w > 0 ? "DRIVE" : "SLACK"), Math.abs(w));
};

function springLook(s, p, f, now) {                       // colour and width
  if (p.side && p.side * (now - p.rest) <= 0) return [s.ink("SLACK"), COIL];
  if (p.d === undefined) return [s.ink("SPRING"), COIL];
  const share = f.drive[p.d] / p.own;
  return [drivenInk(s, share), COIL * thickened(share)];
}

KINDS.coil = (s, p, f) => {
  const a = s.at(p.a), now = apart(a, s.at(p.b)) / s.scale;
  let b = s.at(p.b);
  if (p.side < 0 && now > p.rest) b = between(a, b, p.rest / now);
  const [colour, width] = springLook(s, p, f, now), half = clamp(0.09 * apart(a, b), 3.2 * s.u, 8 * s.u);
  const lit = s.hover && s.hover.n === p.n ? s.ink("FORCE") : colour;
  s.line(coilPath(a, b, half), lit, width);
  for (const end of [a, b]) s.dot(end, 1.7 * s.u, lit);
  s.hit(p, [a, b], 8);
};

KINDS.spiral = (s, p, f) => {
  const at = s.at(p.at), from = s.pose[3 * p.a + 2], wind = s.pose[3 * p.b + 2] - from;
  const [colour, width] = springLook(s, p, f, p.sense * wind - p.zero), sweep = -(p.sense * 1.5 * TAU + wind);
  const pts = Array.from({ length: 36 }, (_, k) => around(at, (5 + 6 * k / 35) * s.u, -from + sweep * k / 35));
  s.line(pts, s.hover && s.hover.n === p.n ? s.ink("FORCE") : colour, width);
  s.hit(p, pts, 3);
};

// -- cords --------------------------------------------------------------------------------------------

KINDS.wheel = (s, p) => {
  const c = s.at(p.at), [fill, edge] = s.fills[p.f];
  s.dot(c, p.s * s.scale - 0.6 * s.u, fill, edge, 1.2);
  if (p.spoke) s.line([c, s.at([p.at[0], p.at[1] + p.s, p.at[2]])], edge, 1.2);
};

KINDS.cord = (s, p, f) => {
  const off = new Set((p.off || []).filter(([, c]) => f.lifted && f.lifted[c] > 0).map(([g]) => g));
  const on = p.g.map((_, i) => i).filter((i) => !off.has(i));
  const wheels = on.map((i) => {
    const [b, x, y, r, side, around] = p.g[i];
    return { c: s.at([b, x, y]), r: r * s.scale, s: -side, around };   // y runs down on the picture
  });
  const pieces = cordPieces(wheels, p.closed), one = p.c.length === 1;
  const width = CORD * (p.d === undefined ? 1 : thickened(f.drive[p.d] / p.own));
  const paths = one ? [pieces.flat()] : pieces;
  paths.forEach((path, i) => {
    const tension = f.tension[p.c[one ? 0 : on[i]]];
    if (tension <= SLACK_SHARE * s.head.scale.tension) {
      s.line(path, s.ink("SLACK"), 1.8, { dash: [5, 4], cap: "butt" });
    } else {
      const lit = s.hover && s.hover.k === "cord" && s.hover.n === p.n;
      s.line(path, lit ? s.ink("FORCE") : s.tensionColour(tension), width, { cap: "butt" });
    }
    s.hit(p, path);
  });
  for (const [guide, c] of p.grips || []) {
    const before = one ? null : pieces[on.indexOf(guide || p.g.length - 1) - 1];
    if (before) collar(s, before[before.length - 1], !(f.slip && f.slip[c] > 0));
  }
  for (const [b, x, y, r] of p.g) if (!r) s.ring(s.at([b, x, y]), 2.7, 1);
};

// -- fluid --------------------------------------------------------------------------------------------

function pressureInk(s, f, line) {
  const share = Math.abs(f.pressure[line]) / (s.head.scale.pressure || 1);
  return levelOf(s.ramps.pull, share);
}

function portAt(s, port) {                                // where a hose meets a chamber
  if (port.at) return s.at(port.at);
  const a = s.at(port.a), b = s.at(port.b), length = apart(a, b);
  const way = port.pulls ? Math.min(port.tube * s.scale, length) - 3 * s.u : 3 * s.u;
  return between(a, b, way / (length || 1));
}

function portOf(s, p, line) {                             // of a line; without chambers beside its neighbour
  if (p.ports[line] && p.ports[line].length) return portAt(s, p.ports[line][0]);
  for (const [a, b] of p.pairs) {
    const other = b === line ? a : a === line ? b : -1;
    if (other >= 0 && p.ports[other].length) {
      const [x, y] = portAt(s, p.ports[other][0]);
      return [x - 78 * s.u, y - 12 * s.u];
    }
  }
  return null;
}

KINDS.hose = (s, p, f) => {
  const places = p.ports.map((port) => portAt(s, port));
  if (places.length > 1) s.line(places, pressureInk(s, f, p.line), 1.6);
  const first = p.ports.find((port) => !port.at);
  if (!first) return;
  const a = s.at(first.a), b = s.at(first.b), [ux, uy] = unit(a, b), [x, y] = between(a, b, 0.35);
  const aside = (40 + 8 * Math.abs(ux)) * s.u;
  s.label(pressureText(f.pressure[p.line], s.head.scale.pressure), [1, -1].map((sign) =>
    (Math.abs(uy) > Math.abs(ux) ? [x + sign * aside, y] : [x, y + sign * 20 * s.u])), s.ink("SPRING"));
};

KINDS.tube = (s, p, f) => {
  const a = s.at(p.a), b = s.at(p.b), [ux, uy] = unit(a, b), length = apart(a, b), { u } = s;
  const whole = p.tube * s.scale, piston = p.end * s.scale - p.slope * (p.longest * s.scale - length);
  const half = clamp(0.13 * whole, 4.5 * u, 9 * u), edge = s.ink("SPRING");
  const box = (from, to, wide) => [[from, 1], [to, 1], [to, -1], [from, -1]].map(([d, side]) =>
    [a[0] + d * ux - side * wide * uy, a[1] + d * uy + side * wide * ux]);
  s.area(box(0, whole, half + 1.2 * u), edge);
  s.area(box(0, whole, half), s.back);
  s.area(p.pulls ? box(piston, whole, half) : box(0, piston, half),
         mixed(pressureInk(s, f, p.line), s.back, 0.15));
  s.area(box(piston, length, 1.6 * u), edge);
  s.area(box(piston - 1.8 * u, piston, half), s.ink("PIN_RING"));
  for (const end of [a, b]) s.ring(end, 2.2, 0.9, s.back);
  s.hit(p, [a, b], 8);
};

KINDS.vane = (s, p, f) => {
  const at = s.at(p.at);
  s.ring(at, 10, 1.2, pressureInk(s, f, p.line));
  s.hit(p, [at, at], 8);
};

KINDS.valve = (s, p, f) => {
  const { u } = s, ends = p.ends.map((line) => (line >= 0 ? portOf(s, p, line) : null));
  if (!ends[0] && !ends[1]) return;
  for (const i of [0, 1]) {
    if (ends[i]) continue;
    const [x, y] = ends[1 - i];
    ends[i] = [x + 40 * u, y - 14 * u];
    s.line([[-1, 0], [-1, 6], [1, 6], [1, 0]].map(([q, d]) => [ends[i][0] + 6 * q * u, ends[i][1] + d * u]),
           s.ink("SPRING"), 1.2);
  }
  s.line(ends, s.ink("SPRING"), 1.2);
  const at = between(...ends, 0.5);
  valveMark(s, at, unit(...ends), f.flow && f.flow[p.v]);
  s.hit(p, [at, at], 9);
};
function valveMark(s, [x, y], way, open) {
  const [ux, uy] = way.map((v) => 7 * s.u * v);
  for (const sign of [1, -1]) {
    s.area([[x, y], [x + sign * ux - 0.6 * uy, y + sign * uy + 0.6 * ux],
            [x + sign * ux + 0.6 * uy, y + sign * uy - 0.6 * ux]], open ? s.ink("DRIVE") : s.back,
           s.ink("DRIVE"), 1.2);
  }
}

KINDS.pump = (s, p, f) => {
  const port = portOf(s, p, p.line), { u } = s, colour = s.ink("DRIVE");
  if (!port) return;
  const [x, y] = [port[0] - 24 * u * (1 + 1.6 * p.beside), port[1] - 26 * u];
  s.line([port, [x, y]], s.ink("SPRING"), 1.2);
  s.ring([x, y], 7.5, 1.2, s.back, colour);
  s.area([[x - 4 * u, y - 2 * u], [x + 4 * u, y - 2 * u], [x, y + 6 * u]], colour);
  const value = f.drive[p.d], most = s.head.drives[p.d].most;
  const shown = p.unit === "Pa" ? pressureText(value, most) : `${numberText(value * 1e6, most * 1e6)} ml/s`;
  s.label(`${p.n} ${shown}`, [[x, y - 15 * u]], colour, true);
  s.hit(p, [[x, y], [x, y]], 9);
};
