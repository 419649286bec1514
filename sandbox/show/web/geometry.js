// Points and paths in pixels, y down; nothing here draws.

const TAU = 2 * Math.PI;
const clamp = (v, low, high) => Math.min(high, Math.max(low, v));
const apart = (a, b) => Math.hypot(b[0] - a[0], b[1] - a[1]);
const between = (a, b, w) => [a[0] + w * (b[0] - a[0]), a[1] + w * (b[1] - a[1])];
const unit = (a, b) => {
  const d = apart(a, b) || 1e-12;
  return [(b[0] - a[0]) / d, (b[1] - a[1]) / d];
};
const turned = ([x, y], angle) => {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * x - s * y, s * x + c * y];
};
const around = ([x, y], r, angle) => [x + r * Math.cos(angle), y + r * Math.sin(angle)];
const arc = (centre, r, from, sweep, steps = 24) =>
  Array.from({ length: steps + 1 }, (_, k) => around(centre, r, from + sweep * k / steps));

function toSegment(p, a, b) {                             // how far a point is from a line
  const dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy || 1e-12;
  const w = clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, 0, 1);
  return Math.hypot(p[0] - a[0] - w * dx, p[1] - a[1] - w * dy);
}
const toPath = (p, pts) => {
  let least = Infinity;
  for (let i = 0; i + 1 < pts.length; i++) least = Math.min(least, toSegment(p, pts[i], pts[i + 1]));
  return least;
};

// -- cords: wheels are {c: [x, y], r, s}, s +1 where the centre lies right of the way, y up ------

function tangent(a, b) {
  const dx = b.c[0] - a.c[0], dy = b.c[1] - a.c[1], d = Math.hypot(dx, dy);
  const offset = a.s * a.r - b.s * b.r;
  if (d <= Math.abs(offset) || !d) return [a.c, b.c];
  const m = offset / d, k = Math.sqrt(1 - m * m), ex = dx / d, ey = dy / d;
  const nx = m * ex - k * ey, ny = m * ey + k * ex;
  return [[a.c[0] + a.s * a.r * nx, a.c[1] + a.s * a.r * ny],
          [b.c[0] + b.s * b.r * nx, b.c[1] + b.s * b.r * ny]];
}

function onWheel(w, arrive, leave) {                      // corners between two tangent points
  const a = Math.atan2(arrive[1] - w.c[1], arrive[0] - w.c[0]);
  const b = Math.atan2(leave[1] - w.c[1], leave[0] - w.c[0]);
  let sweep = (w.s * (a - b)) % TAU;
  if (sweep < 0) sweep += TAU;
  if (sweep > TAU - 1e-6) sweep = 0;
  if (w.around) sweep += TAU;                             // it goes all around it as well
  const steps = Math.max(1, Math.ceil(sweep / Math.min(0.2, 2 * Math.sqrt(0.1 / w.r))));
  return arc(w.c, w.r, a, -w.s * sweep, steps).slice(1, -1);
}

function woundOn(c, start, sweep) {
  const r = apart(c, start), from = Math.atan2(start[1] - c[1], start[0] - c[0]);
  return arc(c, r, from, sweep, Math.max(12, Math.ceil(WOUND / (2 * Math.sqrt(0.1 / r))))).slice(1);
}

// Straight piece by straight piece, each with half of its arcs on wheels.
function cordPieces(wheels, closed) {
  const pieces = [], last = wheels.length - 1;
  for (let i = 0; i < last; i++) {
    const [leave, arrive] = tangent(wheels[i], wheels[i + 1]);
    if (i && wheels[i].r > 0) {
      const before = pieces[i - 1], on = onWheel(wheels[i], before[before.length - 1], leave);
      const half = on.length >> 1;
      before.push(...on.slice(0, half + 1));
      pieces.push([...on.slice(half), leave, arrive]);
    } else pieces.push([leave, arrive]);
  }
  const end = pieces[pieces.length - 1];
  if (closed && wheels[0].r > 0) {
    const on = onWheel(wheels[0], end[end.length - 1], pieces[0][0]), half = on.length >> 1;
    end.push(...on.slice(0, half + 1));
    pieces[0].unshift(...on.slice(half));
  }
  if (!closed && wheels[0].r > 0) {
    pieces[0].unshift(...woundOn(wheels[0].c, pieces[0][0], wheels[0].s * WOUND).reverse());
  }
  if (!closed && wheels[last].r > 0) {
    end.push(...woundOn(wheels[last].c, end[end.length - 1], -wheels[last].s * WOUND));
  }
  return pieces;
}

// -- shapes ---------------------------------------------------------------------------------------

function arrowShape(tail, tip, shaft, head) {             // its seven corners
  const length = apart(tail, tip), [ux, uy] = unit(tail, tip), [nx, ny] = [-uy, ux];
  const h = Math.min(head, 0.62 * length), half = shaft / 2, wide = Math.max(half, 0.45 * h);
  const at = (along, side) => [tip[0] - ux * along + nx * side, tip[1] - uy * along + ny * side];
  return [at(length, half), at(h, half), at(h, wide), tip, at(h, -wide), at(h, -half),
          at(length, -half)];
}

function sagging(a, b, length) {                          // a slack rope as a flat parabola
  const span = apart(a, b), depth = Math.min(length / 2, span > 0
    ? Math.sqrt(Math.max(length - span, 0) * span * 3 / 8) : length / 2);
  return Array.from({ length: 17 }, (_, k) => {
    const w = k / 16, [x, y] = between(a, b, w);
    return [x, y + 4 * depth * w * (1 - w)];
  });
}

function coilPath(a, b, half) {
  const [ux, uy] = unit(a, b), pts = [a], n = 10;
  const on = (w, side) => {
    const [x, y] = between(a, b, w);
    pts.push([x - uy * half * side, y + ux * half * side]);
  };
  on(0.16, 0);
  for (let k = 0; k < n; k++) on(0.16 + 0.68 * (k + 0.5) / n, k % 2 ? -1 : 1);
  on(0.84, 0);
  pts.push(b);
  return pts;
}

function along(pts, gap) {                                // points so far apart on a line
  const [a, b] = pts, length = apart(a, b), found = [];
  for (let d = gap; d < length; d += gap) found.push(between(a, b, d / length));
  return found;
}

// -- colours -------------------------------------------------------------------------------------------

const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
const mixed = (a, b, w) => {
  const [p, q] = [rgb(a), rgb(b)];
  return "#" + p.map((v, i) => Math.round(v + w * (q[i] - v)).toString(16).padStart(2, "0")).join("");
};
const levelOf = (ramp, share) => ramp[Math.min(ramp.length - 1, Math.floor(Math.abs(share) * (ramp.length - 1) + 0.5))];
