// Curves that coincide, taken apart as figures take them: each shows its colour by turns where they run as one.

const LOOKED_AT = 4000;                                   // points of a curve, more or less: all of one run's on a page

// Where each of some lines runs alone and where with others. `x` and `lines` are shares of the width and height of
// the axes; the x rise. A stretch is {first, last, rank, turns}: places, how many lines before it run here, and of how many.
function strands(x, lines) {
  const n = x.length, ranks = lines.map(() => new Uint8Array(n)), turns = lines.map(() => new Uint8Array(n).fill(1));
  for (let i = 0; i < lines.length; i++) {
    for (let j = i + 1; j < lines.length; j++) {
      const one = lines[i], other = lines[j];
      for (let k = 0, first = -1; k <= n; k++) {
        if (k < n && Math.abs(one[k] - other[k]) < AS_ONE) { if (first < 0) first = k; continue; }
        if (first >= 0 && x[k - 1] - x[first] >= CROSSING) {
          for (let m = first; m < k; m++) { turns[i][m]++; turns[j][m]++; ranks[j][m]++; }
        }
        first = -1;
      }
    }
  }
  return lines.map((_, i) => {
    const found = [], rank = ranks[i], of = turns[i];
    for (let k = 0, first = 0; k < n; k++) {
      if (k + 1 < n && rank[k + 1] === rank[k] && of[k + 1] === of[k]) continue;
      found.push({ first, last: k, rank: rank[k], turns: of[k] });
      first = k + 1;
    }
    return found;
  });
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

// Draws turns over the curves of a plot. Dashed ones stay as they are: their dashes tell them apart.
function takeApart(u, inks, dark, width) {
  const { ctx, bbox, data } = u, [time, ...rows] = data, [from, to] = u.series[0].idxs;
  const solid = rows.map((_, i) => i).filter((i) => !DASHES[inks[i][1] % DASHES.length]);
  if (solid.length < 2 || !(to > from) || !(bbox.height > 0)) return;
  const at = [], step = Math.ceil((to - from) / LOOKED_AT);
  for (let k = from; k <= to; k += step) at.push(k);
  const { x: { min: x0, max: x1 }, y: { min: y0, max: y1 } } = u.scales, stroke = TURN * width;
  const x = at.map((k) => (time[k] - x0) / (x1 - x0));
  const lines = solid.map((i) => filled(rows[i], time, at).map((v) => (v - y0) / (y1 - y0)));
  ctx.save();
  ctx.beginPath(); ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height); ctx.clip();
  ctx.lineWidth = width; ctx.lineJoin = "round"; ctx.lineCap = "butt";
  strands(x, lines).forEach((stretches, i) => {
    ctx.strokeStyle = inkOf(inks[solid[i]][0], dark);
    for (const { first, last, rank, turns } of stretches) {
      if (turns < 2) continue;
      ctx.beginPath();
      for (let k = first; k <= last; k++) {
        ctx.lineTo(bbox.left + x[k] * bbox.width, bbox.top + (1 - lines[i][k]) * bbox.height);
      }
      ctx.setLineDash([stroke, stroke * (turns - 1)]);
      ctx.lineDashOffset = stroke * (turns - rank);
      ctx.stroke();
    }
  });
  ctx.restore();
}
