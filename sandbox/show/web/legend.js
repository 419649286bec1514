// The legend below the drawing: symbols of what this run shows, with words.

const SYMBOLS = {                                         // width in points, and how it is drawn
  length: [0, (s, x, y, w) => {
    s.line([[x, y], [x + w, y]], s.ink("INK"), 1.6, { cap: "butt" });
    for (const end of [x, x + w]) s.line([[end, y - 4 * s.u], [end, y + 4 * s.u]], s.ink("INK"), 1.6);
  }],
  force: [0, (s, x, y, w) => s.arrow([x, y], [x + w, y], FINE, s.ink("FORCE"))],
  vector: [0, (s, x, y, w, p) => s.arrow([x, y], [x + w, y], FINE, s.ink(p.ink))],
  cut: [34, (s, x, y, w) => {
    s.arrow([x, y], [x + w, y], FINE, s.ink("FORCE"));
    cutMarks(s, [x, y], [x + w, y], 4.5);
  }],
  pull: [64, (s, x, y, w) => ramp(s, x, y, w, s.ramps.pull)],
  both: [96, (s, x, y, w) => ramp(s, x, y, w, [...s.ramps.push].reverse().concat(s.ramps.pull))],
  rope: [30, (s, x, y, w) => twisted(s, [x, y], [x + w, y], s.ink("ROPE"))],
  slack: [26, (s, x, y, w) => s.line([[x, y], [x + w, y]], s.ink("SLACK"), 1.8, { dash: [5, 4], cap: "butt" })],
  spring: [36, (s, x, y, w) => s.line(coilPath([x, y], [x + w, y], 4 * s.u), s.ink("SPRING"), 1.2)],
  stiffer: [36, (s, x, y, w) =>
    s.line(coilPath([x, y], [x + w, y], 4 * s.u), drivenInk(s, 6), COIL * thickened(6))],
  wider: [22, (s, x, y, w) => s.line([[x, y], [x + w, y]], levelOf(s.ramps.pull, 0.5), CORD * thickened(6), { cap: "butt" })],
  braked: [12, (s, x, y, w) => hinged(s, x + w / 2, y, (at) => brakeMark(s, at, true))],
  unbraked: [12, (s, x, y, w) => hinged(s, x + w / 2, y, (at) => brakeMark(s, at, false))],
  motor: [20, (s, x, y, w) => hinged(s, x + w / 2, y, (at) => motorMark(s, at, 1))],
  servo: [30, (s, x, y, w) => hinged(s, x + w / 2, y, (at) => servoMark(s, at))],
  belt: [16, (s, x, y, w) => beltMark(s, [x + w / 2, y - 4.5 * s.u], [1, 0], -1)],
  rubs: [14, (s, x, y, w) => hinged(s, x + w / 2, y, (at) => collar(s, at, true))],
  slides: [14, (s, x, y, w) => hinged(s, x + w / 2, y, (at) => collar(s, at, false))],
  load: [30, (s, x, y, w) => s.arrow([x, y], [x + w, y], SLIM, s.ink("DRIVE"))],
  holds: [18, (s, x, y, w) => diamond(s, [x + w / 2, y], true)],
  gone: [18, (s, x, y, w) => diamond(s, [x + w / 2, y], false)],
  open: [15, (s, x, y, w) => valveMark(s, [x + w / 2, y], [1, 0], true)],
  shut: [15, (s, x, y, w) => valveMark(s, [x + w / 2, y], [1, 0], false)],
  stop: [16, (s, x, y) => hinged(s, x + 4 * s.u, y, (at) => wedge(s, at, 0))],
  trace: [30, (s, x, y, w) => {
    s.line([[x, y], [x + w, y]], s.ink("TRACE"), 1.8);
    s.dot([x + w, y], 2.7 * s.u, s.ink("TRACE"));
  }],
  fixed: [22, (s, x, y, w) => {
    const h = 6 * s.u, box = [[x, y - h], [x + w, y - h], [x + w, y + h], [x, y + h]];
    s.area(box, s.dark ? mixed("#bac3ce", NIGHT, 0.7) : "#bac3ce");
    s.area(box, s.hatch("#545e6b"), "#545e6b", 1.2);
  }],
};
function hinged(s, x, y, mark) { mark([x, y]); s.ring([x, y], PIN, 1.4); }

function ramp(s, x, y, w, colours) {
  const h = 4.5 * s.u, step = w / colours.length;
  colours.forEach((c, k) => { s.ctx.fillStyle = c; s.ctx.fillRect(x + k * step, y - h, step + 0.6, 2 * h); });
}

function legendItem(s, { s: symbol, before, after, of }) {
  const { scale, u } = s, part = of === undefined ? null : s.head.parts[of], force = part || s.head.scale;
  if (symbol === "length" && scale > 0) {
    const bar = roundLength(80 * u / scale);
    return { symbol, before, after: lengthText(bar), w: bar * scale };
  }
  if ((symbol === "force" || part) && scale > 0) {
    const most = roundLength(52 * u / (force.metres * scale));
    return { symbol, before, after: `${+most.toPrecision(3)} ${part ? part.unit : "N"} ${after}`,
             w: most * force.metres * scale, part };
  }
  return { symbol, before, after, w: SYMBOLS[symbol][0] * u };
}

// Items in rows that fit; what finds no room in a third of the height is left out, last ones first.
function legendRows(s, items) {
  const { ctx } = s, gap = 17 * s.u, width = s.w - 1.6 * s.text, rows = [];
  const most = Math.max(0, Math.min(6, Math.floor(0.3 * s.h / (1.6 * s.text))));
  ctx.font = `${s.text}px ${FONT}`;
  let used = Infinity;
  for (const item of items) {
    if (item.l && !s.layers.has(item.l)) continue;
    const one = legendItem(s, item);
    const words = [one.before, one.after].filter(Boolean);
    const needs = one.w + words.reduce((sum, w) => sum + ctx.measureText(w).width + 5 * s.u, 0);
    if (used + needs > width) {
      if (rows.length === most || needs > width) continue;
      rows.push([]); used = 0;
    }
    rows[rows.length - 1].push(item); used += needs + gap;
  }
  return rows;
}

function drawLegend(s) {
  const { ctx, u } = s, left = 0.8 * s.text, top = s.h - s.foot + 0.5 * s.text;
  s.line([[left, top - 0.3 * s.text], [s.w - left, top - 0.3 * s.text]], s.ink("HAIRLINE"), 1);
  const write = (text, x, y) => {
    ctx.font = `${s.text}px ${FONT}`; ctx.textAlign = "left"; ctx.textBaseline = "middle";
    ctx.fillStyle = s.ink("FAINT_INK"); ctx.fillText(text, x, y);
    return ctx.measureText(text).width + 5 * u;
  };
  s.rows.forEach((row, k) => {
    let x = left;
    const y = top + (k + 0.5) * 1.6 * s.text;
    for (const item of row) {
      const one = legendItem(s, item);
      if (one.before) x += write(one.before, x, y);
      SYMBOLS[one.symbol][1](s, x, y, one.w, one.part);
      x += one.w + 5 * u;
      if (one.after) x += write(one.after, x, y);
      x += 17 * u - 5 * u;
    }
  });
}
