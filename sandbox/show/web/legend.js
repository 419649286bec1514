// The legend below the drawing: symbols of what this run shows, with words.

const SYMBOLS = {                                         // how each is drawn, by its name
  length: (s, x, y, w) => {
    s.line([[x, y], [x + w, y]], s.ink("INK"), 1.6, { cap: "butt" });
    for (const end of [x, x + w]) s.line([[end, y - 4 * s.u], [end, y + 4 * s.u]], s.ink("INK"), 1.6);
  },
  force: (s, x, y, w) => s.arrow([x, y], [x + w, y], FINE, s.ink("FORCE")),
  vector: (s, x, y, w, p) => s.arrow([x, y], [x + w, y], FINE, s.ink(p.ink)),
  cut: (s, x, y, w) => {
    s.arrow([x, y], [x + w, y], FINE, s.ink("FORCE"));
    cutMarks(s, [x, y], [x + w, y], 4.5);
  },
  patch: (s, x, y, w) => {                                // half a trapezium as high as a line
    const h = 6 * s.u, edge = s.ink("FORCE");
    s.area([[x, y + h], [x + w, y + h], [x + w, y], [x, y - h]], mixed(edge, s.back, 0.6), edge, 1.2);
  },
  pull: (s, x, y, w) => ramp(s, x, y, w, s.ramps.pull),
  both: (s, x, y, w) => ramp(s, x, y, w, [...s.ramps.push].reverse().concat(s.ramps.pull)),
  vane: (s, x, y, w) => {
    s.dot([x + w / 2, y], 7 * s.u, s.ink("PIN_RING"));
    s.dot([x + w / 2, y], 5.8 * s.u, levelOf(s.ramps.pull, 0.5));
  },
  rope: (s, x, y, w) => twisted(s, [x, y], [x + w, y], s.ink("ROPE")),
  slack: (s, x, y, w) => s.line([[x, y], [x + w, y]], s.ink("SLACK"), 1.8, { dash: [5, 4], cap: "butt" }),
  spring: (s, x, y, w) => s.line(coilPath([x, y], [x + w, y], 4 * s.u), s.ink("SPRING"), 1.2),
  stiffer: (s, x, y, w) =>
    s.line(coilPath([x, y], [x + w, y], 4 * s.u), drivenInk(s, THICK[1]), COIL * thickened(THICK[1])),
  wider: (s, x, y, w) => s.line([[x, y], [x + w, y]], levelOf(s.ramps.pull, 0.5), CORD * thickened(THICK[1]), { cap: "butt" }),
  braked: (s, x, y, w) => hinged(s, x + w / 2, y, (at) => brakeMark(s, at, true)),
  unbraked: (s, x, y, w) => hinged(s, x + w / 2, y, (at) => brakeMark(s, at, false)),
  motor: (s, x, y, w) => hinged(s, x + w / 2, y, (at) => motorMark(s, at, 1)),
  servo: (s, x, y, w) => hinged(s, x + w / 2, y, (at) => servoMark(s, at)),
  belt: (s, x, y, w) => beltMark(s, [x + w / 2, y - 4.5 * s.u], [1, 0], -1),
  rubs: (s, x, y, w) => hinged(s, x + w / 2, y, (at) => collar(s, at, true)),
  slides: (s, x, y, w) => hinged(s, x + w / 2, y, (at) => collar(s, at, false)),
  load: (s, x, y, w) => s.arrow([x, y], [x + w, y], SLIM, s.ink("DRIVE")),
  scaled: (s, x, y, w) => s.arrow([x, y], [x + w, y], SLIM, s.ink("DRIVE")),
  driven: (s, x, y, w) => s.arrow([x, y], [x + w, y], BLOCK, s.ink("DRIVE")),
  torque: (s, x, y, w) => turnArrow(s, [x + w / 2, y + 2 * s.u], 1, 8),
  holds: (s, x, y, w) => diamond(s, [x + w / 2, y], true),
  gone: (s, x, y, w) => diamond(s, [x + w / 2, y], false),
  open: (s, x, y, w) => valveMark(s, [x + w / 2, y], [1, 0], true),
  shut: (s, x, y, w) => valveMark(s, [x + w / 2, y], [1, 0], false),
  stop: (s, x, y) => hinged(s, x + 4 * s.u, y, (at) => wedge(s, at, 0)),
  trace: (s, x, y, w) => {
    s.line([[x, y], [x + w, y]], s.ink("TRACE"), 1.8);
    s.dot([x + w, y], 2.7 * s.u, s.ink("TRACE"));
  },
  fixed: (s, x, y, w, p) => {
    const h = 6 * s.u, [fill, edge] = s.fills[p.f];
    const box = [[x, y - h], [x + w, y - h], [x + w, y + h], [x, y + h]];
    s.area(box, fill);
    s.area(box, s.hatch(edge), edge, 1.2);
  },
};
SYMBOLS.bars = SYMBOLS.both;
SYMBOLS.pressure = SYMBOLS.pull;
function hinged(s, x, y, mark) { mark([x, y]); s.ring([x, y], PIN, 1.4); }

function ramp(s, x, y, w, colours) {
  const h = 4.5 * s.u, step = w / colours.length;
  colours.forEach((c, k) => { s.ctx.fillStyle = c; s.ctx.fillRect(x + k * step, y - h, step + 0.6, 2 * h); });
}

function legendItem(s, { s: symbol, before, after, of, f, w = 0 }) {
  const { scale, u } = s, part = of === undefined ? null : s.head.parts[of], force = part || s.head.scale;
  if (symbol === "length" && scale > 0) {
    const bar = roundLength(80 * u / scale);
    return { symbol, before, after: lengthText(bar), w: bar * scale };
  }
  if ((symbol === "force" || symbol === "scaled" || part) && scale > 0) {
    const most = roundLength(52 * u / (force.metres * scale));
    return { symbol, before, after: `${+most.toPrecision(3)} ${part ? part.unit : "N"} ${after}`,
             w: most * force.metres * scale, part };
  }
  return { symbol, before, after, w: w * u, part: { f } };
}

// Items in rows that fit, the first of them beside the time; what finds no room in a third of the height is left out, last ones first.
function legendRows(s, items) {
  const { ctx } = s, gap = 17 * s.u, width = s.w - 1.6 * s.text, rows = [];
  const most = Math.max(0, Math.min(6, Math.floor(0.3 * s.h / (1.6 * s.text))));
  ctx.font = `${s.text}px ${FONT}`;
  const clock = s.stamp ? ctx.measureText(s.stamp.replace(/\d/g, "0")).width + gap : 0;
  const room = (row) => width - (row === 0 ? clock : 0);
  let used = Infinity;
  for (const item of items) {
    if (item.l.length && !item.l.some((layer) => s.layers.has(layer))) continue;
    const one = legendItem(s, item);
    const words = [one.before, one.after].filter(Boolean);
    const needs = one.w + words.reduce((sum, w) => sum + ctx.measureText(w).width + 5 * s.u, 0);
    if (used + needs > room(rows.length - 1)) {
      if (rows.length === most || needs > room(rows.length)) continue;
      rows.push([]); used = 0;
    }
    rows[rows.length - 1].push(item); used += needs + gap;
  }
  return rows;
}

function drawLegend(s) {
  const { ctx, u } = s, left = 0.8 * s.text, top = s.h - s.foot + 0.5 * s.text;
  s.line([[left, top - 0.3 * s.text], [s.w - left, top - 0.3 * s.text]], s.ink("HAIRLINE"), 1);
  ctx.font = `${s.text}px ${FONT}`;
  const write = (text, x, y) => {
    ctx.font = `${s.text}px ${FONT}`; ctx.textAlign = "left"; ctx.textBaseline = "middle";
    ctx.fillStyle = s.ink("FAINT_INK"); ctx.fillText(text, x, y);
    return ctx.measureText(text).width + 5 * u;
  };
  if (s.stamp) write(s.stamp, s.w - left - ctx.measureText(s.stamp).width, top + 0.8 * s.text);
  s.rows.forEach((row, k) => {
    let x = left;
    const y = top + (k + 0.5) * 1.6 * s.text;
    for (const item of row) {
      const one = legendItem(s, item);
      if (one.before) x += write(one.before, x, y);
      SYMBOLS[one.symbol](s, x, y, one.w, one.part);
      x += one.w + 5 * u;
      if (one.after) x += write(one.after, x, y);
      x += 17 * u - 5 * u;
    }
  });
}
