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

// Columns of every block by its key; see sandbox/show/packing.py for how they are kept.
async function unpack(head, bytes) {
  const parts = [];
  for (let i = 0, at = 0; i < head.sizes.length; at += head.sizes[i++]) {
    parts.push(await inflate(bytes.subarray(at, at + head.sizes[i])));
  }
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

// Frames of a recording at any time: poses and smooth values between samples, others of the nearest.
class Replay {
  constructor(head, data) {
    this.head = head; this.data = data; this.time = data.t[0];
    this.first = this.time[0]; this.last = this.time[this.time.length - 1];
    this.pose = Float64Array.from(head.rest);
    this.channels = head.blocks.filter(({ key, smooth }) => smooth !== undefined && key !== "pose");
    this.rows = rowsOf(data.contact, this.time.length);
    this.strips = rowsOf(data.patch, this.time.length);
  }
  frame(t) {
    const { time, data } = this, n = time.length;
    const i = Math.min(Math.max(n - 2, 0), indexBelow(time, t)), j = Math.min(i + 1, n - 1);
    const w = j > i ? Math.min(1, Math.max(0, (t - time[i]) / (time[j] - time[i]))) : 0;
    const near = w > 0.5 ? j : i, replay = this;
    const found = { t, upto: near, times: time, get ways() { return replay.ways; } };
    this.place(i, j, w);
    for (const { key, smooth } of this.channels) {
      found[key] = data[key].map((c) => (smooth ? c[i] + w * (c[j] - c[i]) : c[near]));
    }
    found.pose = this.pose;
    found.contacts = this.rows ? this.rows[near] : [];
    found.patches = this.strips ? this.strips[near] : [];
    return found;
  }
  moments(see, count = 6) {                               // frames from first to last, one at a time
    for (let k = 0; k < count; k++) see(this.frame(this.first + k / (count - 1) * (this.last - this.first)));
  }
  place(i, j, w) {
    const { head, data, pose } = this;
    head.moving.forEach((b, m) => {
      for (let q = 0; q < 3; q++) {
        const c = data.pose[3 * m + q];
        pose[3 * b + q] = c[i] + w * (c[j] - c[i]);
      }
    });
  }
  get ways() {                                            // of all traced points, once they are asked for
    this.known = this.known || this.head.parts.filter((p) => p.k === "trace").map((p) => this.way(p.at));
    return this.known;
  }
  way([body, x, y]) {                                     // of a point, x and y in turn
    const m = this.head.moving.indexOf(body), n = this.time.length, found = new Float64Array(2 * n);
    if (m < 0) return found.subarray(0, 0);
    const [px, py, angle] = this.data.pose.slice(3 * m, 3 * m + 3);
    for (let i = 0; i < n; i++) {
      const c = Math.cos(angle[i]), s = Math.sin(angle[i]);
      found[2 * i] = px[i] + c * x - s * y; found[2 * i + 1] = py[i] + s * x + c * y;
    }
    return found;
  }
}

// Rows by sample, of which the last column tells: of contacts [x, y, fx, fy, body, other], of patches
// [x, y, force per length] of either end.
function rowsOf(columns, n) {
  if (!columns) return null;
  const found = Array.from({ length: n }, () => []);
  const [a, b, c, d, e, f, sample] = columns;
  for (let i = 0; i < a.length; i++) found[sample[i]].push([a[i], b[i], c[i], d[i], e[i], f[i]]);
  return found;
}
