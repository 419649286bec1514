// Numbers and units as people read them.

const decimalsOf = (scale) => (scale > 0 && scale < 0.1 ? Math.min(1 - Math.floor(Math.log10(scale)), 9)
  : scale < 10 ? 2 : scale < 100 ? 1 : 0);
const numberText = (value, scale) => value.toFixed(decimalsOf(scale));
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

function pressureText(pascals, scale) {
  const units = [[1e6, "MPa"], [1e5, "bar"], [1e3, "kPa"], [1, "Pa"]];
  const [factor, name] = units.find(([f]) => scale >= 0.9995 * f) || units[3];
  return `${numberText(pascals / factor, scale / factor)} ${name}`;
}

function roundLength(most) {                              // 1, 2, 5 times a power of ten
  const power = 10 ** Math.floor(Math.log10(most));
  return power * [5, 2, 1].find((s) => s * power <= most * (1 + 1e-9));
}
const lengthText = (m) => (m >= 0.9995 ? `${+m.toPrecision(6)} m`
  : m >= 0.9995e-3 ? `${+(m * 1e3).toPrecision(6)} mm` : `${+(m * 1e6).toPrecision(3)} \u00b5m`);
