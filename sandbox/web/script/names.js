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
