// Curves that coincide, taken apart as figures take them: each shows its colour by turns where they run as one.

const LOOKED_AT = 2000;                                   // points of a curve, more or less

// Where each of some lines runs alone and where with others. `x` and `lines` are shares of the width and height of
// the axes; the x rise. A stretch is {first, last, rank, turns}: places, how many lines before it run here, and of how many.
function strands(x, lines) {
  return lines.map((line, i) => {
    const rank = line.map(() => 0), turns = line.map(() => 1);
    lines.forEach((other, j) => {
      if (j === i) return;
      const near = line.map((y, k) => Math.abs(y - other[k]) < AS_ONE);
      for (const [first, last] of runsOf(near)) {
        if (!near[first] || x[last] - x[first] < CROSSING) continue;
        for (let k = first; k <= last; k++) { turns[k] += 1; rank[k] += j < i ? 1 : 0; }
      }
    });
    return runsOf(rank.map((r, k) => r + (lines.length + 1) * turns[k]))
      .map(([first, last]) => ({ first, last, rank: rank[first], turns: turns[first] }));
  });
}

function runsOf(values) {                                 // first and last place of each run of equal values
  const found = [];
  for (let k = 0, first = 0; k < values.length; k++) {
    if (k + 1 < values.length && values[k + 1] === values[k]) continue;
    found.push([first, k]);
    first = k + 1;
  }
  return found;
}

// The values of a row at some places, straight between those that it has; nan before the first and after the last.
function filled(row, time, at) {
  const known = (v) => v !== null && v !== undefined && Number.isFinite(v);
  let before = -1, after = -1, seen = 0;
  return at.map((k) => {
    for (; seen <= k; seen++) if (known(row[seen])) before = seen;
    if (before === k) return row[k];
    if (after < k) for (after = k; after < row.length && !known(row[after]); after++);
    if (before < 0 || after >= row.length) return NaN;
    return row[before] + (row[after] - row[before]) * (time[k] - time[before]) / (time[after] - time[before]);
  });
}

// Draws turns over the curves of a plot.
function takeApart(u, colours, width) {
  const { ctx, bbox, data } = u, [time, ...rows] = data, [from, to] = u.series[0].idxs;
  if (rows.length < 2 || !(to > from) || !(bbox.height > 0)) return;
  const at = [], step = Math.ceil((to - from) / LOOKED_AT);
  for (let k = from; k <= to; k += step) at.push(k);
  const [x0, x1, y0, y1] = [u.scales.x.min, u.scales.x.max, u.scales.y.min, u.scales.y.max];
  const x = at.map((k) => (time[k] - x0) / (x1 - x0));
  const lines = rows.map((row) => filled(row, time, at).map((v) => (v - y0) / (y1 - y0)));
  const stroke = TURN * width;
  ctx.save();
  ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
  ctx.lineWidth = width; ctx.lineJoin = "round"; ctx.lineCap = "butt";
  strands(x, lines).forEach((stretches, i) => {
    for (const { first, last, rank, turns } of stretches) {
      if (turns < 2) continue;
      ctx.beginPath();
      for (let k = first; k <= last; k++) {
        ctx.lineTo(bbox.left + x[k] * bbox.width, bbox.top + (1 - lines[i][k]) * bbox.height);
      }
      ctx.strokeStyle = colours[i];
      ctx.setLineDash([stroke, stroke * (turns - 1)]);
      // as if begun at the time 0, so that turns ride with curves that scroll
      ctx.lineDashOffset = stroke * (turns - rank) + (time[at[first]] / (x1 - x0)) * bbox.width;
      ctx.stroke();
    }
  });
  ctx.restore();
}
