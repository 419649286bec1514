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
