// From the bytes of a run to frames: what a Stage draws at an instant.

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Columns of every block by its key; see sandbox/web/packing.py for how they are kept. The first line completes the head.
async function unpack(head, text) {
  const parts = await Promise.all(text.split("\n").map(inflate));
  Object.assign(head, JSON.parse(new TextDecoder().decode(parts[0])));
  const found = {}, known = [];
  for (const block of head.blocks) {
    const raw = parts[block.part];
    found[block.key] = block.key === "plots" ? { at: (c) => (known[c] ??= columnOf(block, c, raw)) }   // on first use
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
    column[i] = q === none ? NaN : q && 2 * Math.abs(v) <= h ? 0 : v;     // exact zeros
  }
  return column;
}

const clamp = (v, low, high) => Math.min(high, Math.max(low, v));

// The last index i of a rising array with array[i] <= value, at least 0.
function indexBelow(array, value) {
  let low = 0, high = array.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (array[middle] <= value) low = middle; else high = middle - 1;
  }
  return low;
}

// The index of the sample of a row nearest to an instant. Where several runs share an axis, a row is
// undefined at the samples of the others.
function indexNear(times, t, row = times) {
  let a = indexBelow(times, t), b = Math.min(a + 1, times.length - 1);
  while (a > 0 && row[a] === undefined) a--;
  while (b < times.length - 1 && row[b] === undefined) b++;
  if (row[a] === undefined || row[b] === undefined) return row[a] === undefined ? b : a;
  return Math.abs(times[b] - t) < Math.abs(t - times[a]) ? b : a;
}

// A recorded run: its quantities by name, and frames at any time: poses and even columns between samples, others of the nearest.
class Run extends Map {
  constructor(head, data) {
    super(head.series.map((one) => [one.name, one]));
    const [time] = data.t, tables = Object.keys(head.tables).map((name) => [name, rowsOf(data[`table ${name}`])]);
    Object.assign(this, { head, data, time, tables, times: data.ptime[0], last: time.at(-1), ways: new Map(), steady: new Set(head.list.steady) });
    this.first = time[0] <= (1 + 1e-9) / head.words.rate ? 0 : time[0];   // a sample is taken within a step: none lies at the start
    this.pose = Float64Array.from(head.rest); this.values = new Float64Array(head.columns);   // of the last frame
  }
  unit(name) { return this.get(name).unit; }
  row(name) {
    const { c, v } = this.get(name);
    return c === undefined ? Float64Array.from(this.times, () => v) : this.data.plots.at(c);
  }
  text(name, t) {                                         // of a value with its unit, as in its plot
    const row = this.row(name);
    return textOf(row[indexNear(this.times, t)], row, this.unit(name));
  }
  frame(t) {
    const { head, time, data, pose, values } = this, n = time.length;
    const i = Math.min(Math.max(n - 2, 0), indexBelow(time, t)), j = Math.min(i + 1, n - 1);
    const w = j > i ? clamp((t - time[i]) / (time[j] - time[i]), 0, 1) : 0, near = w > 0.5 ? j : i;
    const between = (c) => c[i] + w * (c[j] - c[i]), { moving } = head;
    for (let m = 0; m < moving.length; m++) {
      for (let q = 0; q < 3; q++) pose[3 * moving[m] + q] = between(data.pose[3 * m + q]);
    }
    for (let k = 0; k < values.length; k++) values[k] = this.steady.has(k) ? data.columns[k][near] : between(data.columns[k]);
    const tables = {};
    for (const [name, rows] of this.tables) tables[name] = rows.get(near);
    return { t, pose, values, tables, trail: (item) => ({ way: this.way(item), times: time, count: near + 1 }) };
  }
  way({ at: [f, x, y] }) {                                // of a point, x and y in turn
    const key = [f, x, y].join(), { moving, rest } = this.head, m = moving.indexOf(f);
    if (this.ways.has(key)) return this.ways.get(key);
    const found = new Float64Array(2 * this.time.length), pose = (q, i) => (m < 0 ? rest[3 * f + q] : this.data.pose[3 * m + q][i]);
    for (let i = 0; i < this.time.length; i++) {
      const c = Math.cos(pose(2, i)), s = Math.sin(pose(2, i));
      found[2 * i] = pose(0, i) + c * x - s * y; found[2 * i + 1] = pose(1, i) + s * x + c * y;
    }
    this.ways.set(key, found);
    return found;
  }
}

// Rows by sample, which is their first column.
const rowsOf = (columns) => Map.groupBy(Array.from(columns?.[0] || [], (_, i) => columns.map((c) => c[i])), ([sample]) => sample);

// The names that match a pattern as in Python's fnmatch, case-sensitive: *, ?, [ab], [a-f], [!ab]. Those of pairs need a / in it, and match in
// either order.
function matching(pattern, names) {
  const text = pattern.replace(/\[(!?)([^][^\]]*)\]|[^]/g, (all, not, some) => (
    some ? `[${not && "^"}${some.replace(/[\\[\]^]/g, "\\$&")}]`
      : all === "*" ? "[^]*" : all === "?" ? "[^]" : all.replace(/[.+^${}()|[\]\\]/, "\\$&")));
  if (names.includes(pattern)) return [pattern];
  let fits = /^[]$/;                                      // none, as of [f-a]
  try { fits = new RegExp(`^${text}$`, "u"); } catch { /* no range */ }
  const pairs = pattern.includes("/");
  const swapped = (name) => name.replace(/^(.*)\/(.*)\.([^.]*)$/, "$2/$1.$3");
  return names.filter((name) => (name.includes("/") ? pairs && (fits.test(name) || fits.test(swapped(name)))
    : fits.test(name)));
}

function nearest(text, names) {                           // by pairs of letters in common; "" if these are few
  const pairs = (s) => new Set(Array.from(s.toLowerCase(), (letter, i) => letter + s.charAt(i + 1).toLowerCase())), own = pairs(text);
  const shares = names.map((name) => { const other = pairs(name); return 2 * [...own].filter((p) => other.has(p)).length / (own.size + other.size); });
  const most = Math.max(0.4, ...shares);
  return names[shares.indexOf(most)] ?? "";
}

// The words that names have in common at their begin and end: cut() takes them from a name; as a pattern they are the title, if there are any.
function common(names) {
  const words = names.map((n) => n.split(".")), least = Math.min(...words.map((w) => w.length)) - 1;
  let a = 0, b = 0;
  while (a < least && words.every((w) => w[a] === words[0][a])) a++;
  while (b < least - a && words.every((w) => w[w.length - 1 - b] === words[0][words[0].length - 1 - b])) b++;
  if (names.length === 1) return { cut: () => "", title: names[0] };
  const cut = (name) => name.split(".").slice(a, b ? -b : undefined).join(".");
  return { cut, title: a + b ? [...words[0].slice(0, a), "*", ...(b ? words[0].slice(-b) : [])].join(".") : "" };
}

const fixedText = (value, decimals) => {                  // without a negative 0
  const text = value.toFixed(decimals);
  return +text ? text : text.replace("-", "");
};
const LEAST = 1e-15;                                      // smaller values are rounding errors
const short = (v, digits = 4) => (v === null || !Number.isFinite(v) ? "-" : Math.abs(v) < LEAST ? "0"
  : Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3 ? v.toExponential(digits - 1).replace(/\.?0*e\+?/, "e")
    : String(+v.toPrecision(digits)));
// A value of a quantity that grows up to `most`, with as many decimals as all its values.
const steady = (v, most) => (v === null || !Number.isFinite(v) || !(most >= 1e-3 && most < 1e5) ? short(v)
  : v.toFixed(clamp(3 - Math.floor(Math.log10(most)), 0, 6)).replace(/^-(0\.?0*)$/, "$1"));

// Factor from SI, unit, and suffix of a number, as in figures (figure/style.py: shown_as), for values up to `most`.
function shownAs(unitName, most) {
  if (unitName === "rad") return { factor: 180 / Math.PI, unit: "deg", sign: "\u00b0" };
  if (unitName === "rad/s") return { factor: 180 / Math.PI, unit: "deg/s", sign: " deg/s" };
  if (unitName === "m" && most < MANY_MM) return { factor: 1e3, unit: "mm", sign: " mm" };
  const [size, unit] = unitName !== "Pa" ? [1, unitName === "1" ? "" : unitName]
    : PRESSURES.find(([pascals]) => most >= 0.9995 * pascals) ?? PRESSURES.at(-1);
  return { factor: 1 / size, unit, sign: unit && ` ${unit}` };
}

// The largest absolute value; 0 if there is none.
const sizeOfRow = (row) => row.reduce((most, v) => (Math.abs(v) > most ? Math.abs(v) : most), 0);

function textOf(value, row, unitName) {                   // of a row, with its unit, as in its plot
  const most = sizeOfRow(row), { factor, sign } = shownAs(unitName, most);
  return `${steady(factor * value, factor * most)}${sign}`;
}

function roundLength(most) {                              // 1, 2, 5 times a power of ten
  const power = 10 ** Math.floor(Math.log10(most));
  return power * [5, 2, 1].find((s) => s * power <= most * (1 + 1e-9));
}
const lengthText = (m) => (m >= 0.9995 ? `${+m.toPrecision(6)} m`
  : m >= 0.9995e-3 ? `${+(m * 1e3).toPrecision(6)} mm` : `${+(m * 1e6).toPrecision(3)} \u00b5m`);
