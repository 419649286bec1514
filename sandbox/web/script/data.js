// From the bytes of a run to frames: what a Stage draws at an instant.

function fromBase64(text) {
  const letters = atob(text), found = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) found[i] = letters.charCodeAt(i);
  return found;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Columns of every block by its key; see sandbox/web/packing.py for how they are kept. The first part completes the head.
async function unpack(head, bytes) {
  const parts = [];
  for (let i = 0, at = 0; i < head.sizes.length; at += head.sizes[i++]) {
    parts.push(await inflate(bytes.subarray(at, at + head.sizes[i])));
  }
  Object.assign(head, JSON.parse(new TextDecoder().decode(parts[0])));
  const found = {};
  for (const block of head.blocks) {
    const raw = parts[block.part];
    found[block.key] = block.key === "plots" ? { at: (c) => columnOf(block, c, raw) }   // when asked
      : Array.from({ length: block.k }, (_, c) => columnOf(block, c, raw));
  }
  return found;
}

function columnOf({ n, k, at, low, step, bytes }, c, raw) {
  const plane = n * k, none = 2 ** (8 * bytes) - 1, column = new Float64Array(n), a = low[c], h = step[c];
  let q = 0, p = at + c * n;
  for (let i = 0; i < n; i++, p++) {
    q = (q + raw[p] + 256 * raw[p + plane] + (bytes > 2 ? 65536 * raw[p + 2 * plane] : 0)) & none;
    const v = a + h * q;
    column[i] = q === none ? NaN : q && 2 * Math.abs(v) <= h ? 0 : v;     // what was 0 is again
  }
  return column;
}

// The last index i of a rising array with array[i] <= value, at least 0.
function indexBelow(array, value) {
  let low = 0, high = array.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (array[middle] <= value) low = middle; else high = middle - 1;
  }
  return low;
}

// The place of the sample nearest to an instant among those of a row that are there: where several
// runs share an axis, a row is undefined at the others' samples.
function indexNear(times, t, row = times) {
  let a = indexBelow(times, t), b = Math.min(a + 1, times.length - 1);
  while (a > 0 && row[a] === undefined) a--;
  while (b < times.length - 1 && row[b] === undefined) b++;
  if (row[a] === undefined || row[b] === undefined) return row[a] === undefined ? b : a;
  return Math.abs(times[b] - t) < Math.abs(t - times[a]) ? b : a;
}

// Frames of a recording at any time: poses and even columns between samples, others of the nearest.
class Replay {
  constructor(head, data) {
    this.head = head; this.data = data; this.time = data.t[0];
    this.first = this.time[0]; this.last = this.time[this.time.length - 1];
    this.pose = Float64Array.from(head.rest);
    this.steady = new Set(head.list.steady);
    this.tables = Object.fromEntries(Object.keys(head.tables).map((name) => [name, rowsOf(data[`table ${name}`], this.time.length)]));
    this.ways = new Map();
  }
  frame(t) {
    const { head, time, data, pose } = this, n = time.length;
    const i = Math.min(Math.max(n - 2, 0), indexBelow(time, t)), j = Math.min(i + 1, n - 1);
    const w = j > i ? Math.min(1, Math.max(0, (t - time[i]) / (time[j] - time[i]))) : 0, near = w > 0.5 ? j : i;
    head.moving.forEach((f, m) => {
      for (let q = 0; q < 3; q++) { const c = data.pose[3 * m + q]; pose[3 * f + q] = c[i] + w * (c[j] - c[i]); }
    });
    const values = (data.columns || []).map((c, k) => (this.steady.has(k) ? c[near] : c[i] + w * (c[j] - c[i])));
    const tables = Object.fromEntries(Object.entries(this.tables).map(([name, rows]) => [name, rows[near]]));
    return { t, pose, values, tables, trail: (item) => ({ way: this.way(item), times: time, count: near + 1 }) };
  }
  way(item) {                                             // of a point, x and y in turn
    const key = item.at.join();
    if (this.ways.has(key)) return this.ways.get(key);
    const [f, x, y] = item.at, m = this.head.moving.indexOf(f), n = this.time.length, found = new Float64Array(2 * n), rest = this.head.rest.slice(3 * f, 3 * f + 3);
    const pose = m < 0 ? rest.map((v) => new Float64Array(n).fill(v)) : this.data.pose.slice(3 * m, 3 * m + 3);
    for (let i = 0; i < n; i++) {
      const c = Math.cos(pose[2][i]), s = Math.sin(pose[2][i]);
      found[2 * i] = pose[0][i] + c * x - s * y; found[2 * i + 1] = pose[1][i] + s * x + c * y;
    }
    this.ways.set(key, found);
    return found;
  }
}

function rowsOf(columns, n) {                             // rows by sample, which is their first column
  const found = Array.from({ length: n }, () => []);
  if (columns) for (let i = 0; i < columns[0].length; i++) found[columns[0][i]].push(columns.map((c) => c[i]));
  return found;
}
