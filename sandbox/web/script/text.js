// Names of quantities: which fit a pattern, which is meant, what several have in common.

// A pattern as in Python's fnmatch: * is any letters, ? any one, [ab] and [a-f] one of these, [!ab] one that
// is none of these; capitals matter.
function globbed(pattern) {
  let text = "";
  for (let i = 0; i < pattern.length; i++) {
    const c = pattern[i], negated = pattern[i + 1] === "!" ? 1 : 0;
    const end = c === "[" ? pattern.indexOf("]", i + 2 + negated) : -1;
    if (c === "*") text += "[^]*";
    else if (c === "?") text += "[^]";
    else if (end > 0) {
      text += `[${negated ? "^" : ""}${pattern.slice(i + 1 + negated, end).replace(/[\\\[\]^]/g, "\\$&")}]`;
      i = end;
    } else text += c.replace(/[.+^${}()|[\]\\]/, "\\$&");
  }
  try { return new RegExp(`^${text}$`, "u"); } catch { return /^[]$/; }   // such as [f-a]: none
}

// The names that a pattern fits. Those of pairs need a / in it, and fit either way round.
function matching(pattern, names) {
  if (names.includes(pattern)) return [pattern];
  const fits = globbed(pattern), pairs = pattern.includes("/");
  const swapped = (name) => name.replace(/^(.*)\/(.*)\.([^.]*)$/, "$2/$1.$3");
  return names.filter((name) => (name.includes("/") ? pairs && (fits.test(name) || fits.test(swapped(name)))
    : fits.test(name)));
}

function nearest(text, names) {                           // by pairs of letters that both have
  const pairs = (s) => new Set(Array.from({ length: Math.max(0, s.length - 1) }, (_, i) => s.slice(i, i + 2)));
  const own = pairs(text.toLowerCase());
  let best = "", most = 0.4;
  for (const name of names) {
    const other = pairs(name.toLowerCase());
    const both = [...own].filter((p) => other.has(p)).length, share = 2 * both / (own.size + other.size || 1);
    if (share > most) { most = share; best = name; }
  }
  return best;
}

// What names begin and end with alike, whole words of them.
function common(names) {
  const words = names.map((n) => n.split(".")), least = Math.min(...words.map((w) => w.length)) - 1;
  let a = 0, b = 0;
  while (a < least && words.every((w) => w[a] === words[0][a])) a++;
  while (b < least - a && words.every((w) => w[w.length - 1 - b] === words[0][words[0].length - 1 - b])) b++;
  const cut = (name) => name.split(".").slice(a, b ? -b : undefined).join(".");
  return { cut, title: [...words[0].slice(0, a), ...(b ? words[0].slice(-b) : [])].join(".") };
}

// Numbers and units as people read them.

const fixedText = (value, decimals) => {                  // without a negative 0
  const text = value.toFixed(decimals);
  return +text ? text : text.replace("-", "");
};
const LEAST = 1e-15;                                      // what is less is what rounding leaves
const short = (v, digits = 4) => (v === null || !Number.isFinite(v) ? "-" : Math.abs(v) < LEAST ? "0"
  : Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3 ? v.toExponential(digits - 1).replace(/\.?0*e\+?/, "e")
    : String(+v.toPrecision(digits)));
const unitText = (unitName) => (unitName === "1" || !unitName ? "" : ` ${unitName}`);

// How a quantity is shown, by the rule of figures (figure/style.py: shown_as): in SI it is at most
// `most`, shown it is that times `factor` in `unit`, which is `sign` after a number.
function shownAs(unitName, most) {
  if (unitName === "rad") return { factor: 180 / Math.PI, unit: "deg", sign: "\u00b0" };
  if (unitName === "rad/s") return { factor: 180 / Math.PI, unit: "deg/s", sign: " deg/s" };
  if (unitName === "m" && most < MANY_MM) return { factor: 1e3, unit: "mm", sign: " mm" };
  return { factor: 1, unit: unitName === "1" ? "" : unitName, sign: unitText(unitName) };
}

function sizeOfRow(row) {                                 // the largest size in it; 0 where nothing is
  let most = 0;
  for (const v of row) if (Math.abs(v) > most) most = Math.abs(v);
  return most;
}
const sizeOfRows = (rows) => Math.max(0, ...rows.map(sizeOfRow));

function roundLength(most) {                              // 1, 2, 5 times a power of ten
  const power = 10 ** Math.floor(Math.log10(most));
  return power * [5, 2, 1].find((s) => s * power <= most * (1 + 1e-9));
}
const lengthText = (m) => (m >= 0.9995 ? `${+m.toPrecision(6)} m`
  : m >= 0.9995e-3 ? `${+(m * 1e3).toPrecision(6)} mm` : `${+(m * 1e6).toPrecision(3)} \u00b5m`);
