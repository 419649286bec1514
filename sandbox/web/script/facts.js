// What was found of runs, in words and tables; and how the page begins.

const COLUMNS = {
  expect: [["", (v) => (v.ok ? "pass" : "FAIL")], ["quantity", (v) => v.quantity], ["", (v) => v.statistic], ["value", (v) => short(v.value, 6)],
    ["range", (v) => rangeText(v.low, v.high)], ["unit", (v) => (v.unit === "1" ? "" : v.unit)],
    ["because", (v) => (v.ok ? v.because : v.reason || v.because)]],
  audit: [["", (f) => f.verdict], ["figure", (f) => f.name], ["value", (f) => short(f.value)], ["at most", (f) => short(f.most)],
    ["unit", (f) => (f.unit === "1" ? "" : f.unit)], ["what was compared", (f) => f.why]],
};

const rangeText = (low, high) => (low === null && high === null ? "" : low === null
  ? `at most ${short(high, 6)}` : high === null ? `at least ${short(low, 6)}`
    : `${short(low, 6)} to ${short(high, 6)}`);

function table(kind, rows) {
  const columns = COLUMNS[kind];
  const body = rows.map((row) => {
    const line = el("tr", {}, ...columns.map(([of, read]) => el("td", { textContent: read(row), "data-of": of })));
    line.className = row.ok === false ? "bad" : row.verdict || "pass";
    return line;
  });
  return el("div", { className: "wide" }, el("table", {}, el("thead", {}, el("tr", {},
    ...columns.map(([name]) => el("th", { textContent: name })))), el("tbody", {}, ...body)));
}

const nameOf = (head, i) => {
  const h = el("h2", { textContent: `${i + 1}  ${head.words.apart}` });
  h.style.borderColor = INKS[i];
  return h;
};

function verdictOf({ words }) {
  const held = words.expect.filter((v) => v.ok).length, all = words.expect.length;
  const looks = words.audit.filter((f) => f.verdict === "look").length, parts = [];
  if (!words.complete) parts.push(`not complete: the run ${words.status}${words.reason ? `, ${words.reason}` : ""}`);
  if (all) parts.push(`${held} of ${all} expectations passed`);
  if (words.audit.length) parts.push(looks ? `${looks} warning${looks > 1 ? "s" : ""}` : "all checks passed");
  const how = !words.complete || held < all ? "bad" : looks ? "look" : parts.length ? "good" : "";
  return { text: parts.join("; ") || "nothing was expected of this run", how };
}

function banner(heads) {
  const box = el("header", {}, el("h1", { textContent: [...new Set(heads.map((head) => head.title))].join(" / ") }));
  if (heads[0].words.about) box.append(el("p", { className: "about", textContent: heads[0].words.about }));
  heads.forEach((head, i) => {
    const { text, how } = verdictOf(head), many = heads.length > 1;
    box.append(el("p", { className: `verdict ${how}`, textContent: many ? `${i + 1}: ${text}` : text }));
  });
  return box;
}

function facts(heads) {
  const box = el("section", { className: "facts", ariaLabel: "what was found" });
  heads.forEach((head, i) => box.append(...factsOf(head, heads.length > 1 ? ` of run ${i + 1}` : "")));
  return box;
}

function fold(title, ...kids) {
  return el("details", {}, el("summary", { textContent: title }), ...kids);
}

function factsOf(head, whose) {
  const { words } = head, found = [], list = (items) => el("ul", {}, ...items.map((text) =>
    el("li", { textContent: text })));
  if (words.expect.length) {
    found.push(el("h2", { textContent: `expectations${whose}` }), table("expect", words.expect));
  }
  if (words.notes.length) found.push(el("h2", { textContent: `notes${whose}` }), list(words.notes));
  if (words.events.length) {
    found.push(el("h2", { textContent: `events${whose}` }),
               list(words.events.map((e) => `${e.name} at ${short(e.t)} s`)));
  }
  if (words.audit.length) {
    const looks = words.audit.filter((f) => f.verdict === "look"), others = words.audit.filter((f) => f.verdict !== "look");
    if (looks.length) found.push(el("h2", { textContent: `warnings of the consistency checks${whose}` }), table("audit", looks));
    if (others.length) {
      found.push(fold(`consistency checks${whose}, as saved with the run: ${others.filter((f) => f.verdict === "pass").length} passed`,
        table("audit", others)));
    }
  }
  const scene = el("pre"), copy = el("button", { textContent: "save the scene" });
  copy.onclick = () => save(new Blob([words.scene], { type: "application/json" }), `${fileName(head.name)}.json`);
  const text = fold(`scene${whose}`, copy, scene);
  text.ontoggle = () => { if (!scene.textContent) scene.textContent = words.scene; };
  found.push(text, fold(`how to repeat it${whose}`, ...repeat(head)));
  if (head.thinned.length) {
    found.push(el("p", { className: "thinned", textContent: `Thinned on this page${whose}: ${head.thinned.join("; ")}. `
      + "The run itself has every sample." }));
  }
  return found;
}

function repeat({ name, words, series }) {
  const file = `${fileName(name)}.json`, versions = Object.entries(words.versions).map(([k, v]) => `${k} ${v}`);
  return [
    el("p", { textContent: "Save the scene above and run it; the same versions on the same platform give the same numbers." }),
    el("pre", { textContent: `sandbox run ${file} --out ${fileName(name)}\nsandbox report ${fileName(name)}` }),
    el("p", { textContent: `Made with ${versions.join(", ")}; steps of ${short(words.step)} s, `
      + `${words.samples} samples at ${short(words.rate)} Hz, ${series.length} quantities.` }),
  ];
}

// The page: `scripts` hold the header of each run, and after each comes one with its numbers.
async function report(root, scripts) {
  try {
    const heads = scripts.map((s) => JSON.parse(s.textContent));
    const datas = await Promise.all(scripts.map((s, i) =>
      unpack(heads[i], fromBase64(s.nextElementSibling.textContent))));
    globalThis.sandbox = new Report(root, heads, datas);
    document.documentElement.dataset.ready = "1";
    performance.mark("ready");
  } catch (error) {
    root.replaceChildren(el("p", { className: "verdict bad", textContent:
      `This page cannot be shown: ${error.message}. It needs a browser of 2023 or newer.` }));
    throw error;
  }
}
