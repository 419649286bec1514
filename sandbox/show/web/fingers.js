// Names of fingers: each rides beside the hinge that its finger begins at, on a short leader, where nothing
// that is drawn at any time of the run gets in its way; one that finds no such place is left out.

const CELL = 4;                                           // pixels of the picture for one that is looked at

function fingerNames(s, f) {
  const key = [s.scale, s.w, s.h, s.foot, Math.round(s.ox / 200), Math.round(s.oy / 200)].join(" ");
  if (!s.names || s.names.key !== key) s.names = { key, all: placed(s, f) };
  for (const one of s.names.all) {
    const hinge = s.at(one.at), [a, b] = leader(s, one, hinge), ink = s.ink("FAINT_INK");
    s.line([a, b], ink, 1);
    s.label(one.text, [[hinge[0] + one.away[0], hinge[1] + one.away[1]]], ink, true);
  }
}

// What is drawn of one frame, small: how many cells of every rectangle from the corner are covered.
function covered(s, f) {
  const w = Math.ceil(s.w / CELL), h = Math.ceil((s.h - s.foot) / CELL);
  const g = new OffscreenCanvas(Math.max(w, 1), Math.max(h, 1)).getContext("2d", { willReadFrequently: true });
  const own = { ctx: s.ctx, dpr: s.dpr, labels: s.labels, busy: s.busy, hits: s.hits, abouts: s.abouts, patterns: s.patterns };
  Object.assign(s, { ctx: g, dpr: 1 / CELL, labels: [], busy: [], hits: [], abouts: [], patterns: {} });
  g.lineJoin = g.lineCap = "round";
  s.plain();
  s.parts(s.head.parts, f);
  const { data } = g.getImageData(0, 0, Math.max(w, 1), Math.max(h, 1)), sums = new Int32Array((w + 1) * (h + 1));
  Object.assign(s, own);
  for (let y = 0; y < h; y++) {
    for (let x = 0, row = 0; x < w; x++) {
      row += data[4 * (y * w + x) + 3] > 20 ? 1 : 0;
      sums[(y + 1) * (w + 1) + x + 1] = sums[y * (w + 1) + x + 1] + row;
    }
  }
  return ([x0, y0, x1, y1]) => {                          // whether a rectangle of the picture is free
    if (x0 < 0 || y0 < 0 || x1 > s.w || y1 > s.h - s.foot) return false;
    const [a, b] = [Math.floor(x0 / CELL), Math.floor(y0 / CELL)], [c, d] = [Math.ceil(x1 / CELL), Math.ceil(y1 / CELL)];
    const at = (x, y) => sums[Math.min(y, h) * (w + 1) + Math.min(x, w)];
    return at(c, d) - at(a, d) - at(c, b) + at(a, b) === 0;
  };
}

function placed(s, f) {
  const fingers = s.head.fingers.map(({ name, body }) => ({ text: name, at: [body, 0, 0] })), seen = [];
  if (!fingers.length) return [];
  const pose = Float64Array.from(f.pose), see = (frame) => {
    s.pose = frame.pose;
    seen.push({ free: covered(s, frame), hinges: fingers.map(({ at }) => s.at(at)) });
  };
  if (s.moments) s.moments(see); else see(f);
  f.pose.set(pose); s.pose = f.pose;                      // which the frames of a run share
  s.ctx.font = s.labelFont();
  const seekers = fingers.map((one, k) => {
    const half = [s.ctx.measureText(one.text).width / 2 + 2, 0.62 * s.text + 1], way = seen.map(({ hinges }) => hinges[k]);
    const found = spots(s, half, OF_FINGERS).map((away) => ({ ...one, away, half }))
      .filter((name) => seen.every(({ free }, m) => free(rectOf(name, way[m]))));
    return { way, found };
  });
  // who chooses first may stand in the others' way: of a few orders the best
  const orders = [seekers, ...[0, 1].map((axis) => [...seekers].sort((a, b) => a.way[0][axis] - b.way[0][axis]))];
  const tried = [...orders, ...orders.map((order) => [...order].reverse())].map((order) => chosen(s, order));
  const far = (all) => all.reduce((sum, { away }) => sum + Math.hypot(...away), 0);
  return tried.sort((a, b) => b.length - a.length || far(a) - far(b))[0];
}

function spots(s, [w, h], [nearest, farthest, further, ways]) {   // from a point to a text's middle, nearest first
  const found = [];
  for (let gap = nearest; gap <= farthest; gap += further) {
    for (let n = 0; n < ways; n++) {                      // to either side by turns, upwards first
      const turn = TAU / ways * Math.ceil(n / 2) * (n % 2 ? 1 : -1), dx = Math.sin(turn), dy = -Math.cos(turn);
      found.push([dx * gap * s.u + (Math.abs(dx) < 1e-9 ? 0 : Math.sign(dx)) * w,
                  dy * gap * s.u + (Math.abs(dy) < 1e-9 ? 0 : Math.sign(dy)) * h]);
    }
  }
  return found;
}

const rectOf = ({ away, half }, [x, y]) => [x + away[0] - half[0], y + away[1] - half[1],
                                            x + away[0] + half[0], y + away[1] + half[1]];

function leader(s, name, hinge, before = HINGE) {         // from the text to just before the hinge
  const [x0, y0, x1, y1] = rectOf(name, hinge), from = [clamp(hinge[0], x0, x1), clamp(hinge[1], y0, y1)];
  const length = apart(from, hinge) || 1e-9, end = Math.max(0, 1 - before * s.u / length);
  return [between(from, hinge, Math.min(RIM * s.u / length, end)), between(from, hinge, end)];
}

function chosen(s, order) {                               // one after another the nearest that meets none before
  const taken = [];
  for (const { way, found } of order) {
    const name = found.find((one) => taken.every(({ other, along }) =>
      way.every((at, m) => !meet(s, one, at, other, along[m]))));
    if (name) taken.push({ other: name, along: way });
  }
  return taken.map(({ other }) => other);
}

// Whether two names, or a name and a leader, or two leaders meet.
function meet(s, one, at, other, there) {
  const a = rectOf(one, at).map((v, i) => v + (i < 2 ? -3 : 3)), b = rectOf(other, there);
  const p = leader(s, one, at), q = leader(s, other, there), side = (u, v, w) =>
    (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0]);
  const cross = (c, d) => side(...c, d[0]) * side(...c, d[1]) < 0 && side(...d, c[0]) * side(...d, c[1]) < 0;
  const through = (line, [x0, y0, x1, y1]) => cross(line, [[x0, y0], [x1, y1]]) || cross(line, [[x0, y1], [x1, y0]]);
  return (a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]) || through(q, a) || through(p, b) || cross(p, q);
}
