// The page: theme, filters, links into packed sections, copied commands, discs on demand.
// Everything that fails is plain HTML; without this script the page is only less handy.

const all = (selector, within = document) => [...within.querySelectorAll(selector)];
const byId = (id) => document.getElementById(id);
const json = (script) => JSON.parse(script.textContent);

function chooseTheme() {
  const button = byId("theme");
  const themes = ["auto", "light", "dark"];
  button.hidden = false;
  button.addEventListener("click", () => {
    const next = themes[(themes.indexOf(button.dataset.theme) + 1) % themes.length];
    button.dataset.theme = next;
    button.textContent = `Theme: ${next}`;
    document.documentElement.dataset.theme = next;
  });
}

/** Puts a text on the clipboard, also where the page has no right to it by itself. */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = element("textarea", { "aria-hidden": "true", class: "visually-hidden" });
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  }
}

function offerCopies(within) {
  all("code.command", within).forEach((code) => {
    const button = element("button", { type: "button", class: "copy" }, "Copy");
    button.setAttribute("aria-label", `Copy: ${code.textContent}`);
    code.after(button);
    button.addEventListener("click", async () => {
      const done = await copy(code.textContent);
      button.textContent = done ? "Copied" : "Select it by hand";
      byId("said").textContent = done ? "Command copied" : "The browser does not let this page copy";
      setTimeout(() => (button.textContent = "Copy"), 2000);
    });
  });
}

// ---- Sections ----

/** What is packed comes after the script. */
const arrived = new Promise((resolve) => {
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", resolve);
  else resolve();
});

async function unpackInto(details) {
  const body = element("div");
  details.append(body);
  await arrived;
  const bytes = await unpack(fromBase64(byId(`p-${details.dataset.packed}`).textContent));
  // The page's own markup: names in it are escaped where it is made.
  body.innerHTML = new TextDecoder().decode(bytes);
  prepare(body);
}

/** Opens a section that passes; the first time it is unpacked. */
async function open(details) {
  details.open = true;
  details.unpacking ??= unpackInto(details);
  await details.unpacking;
}

/** Follows a link to a section, or to a check within one. */
async function follow() {
  const id = decodeURIComponent(location.hash.slice(1));
  if (!id.startsWith("s-")) return;
  const section = byId(id.split("--")[0]);
  if (!section) return;
  section.hidden = false;
  const details = section.querySelector("details[data-packed]");
  if (details) await open(details);
  const target = byId(id) ?? section;
  all(".target").forEach((old) => old.classList.remove("target"));
  target.classList.add("target");
  target.scrollIntoView();
  target.setAttribute("tabindex", "-1");
  target.focus({ preventScroll: true });
}

function prepareSections() {
  document.addEventListener(
    "toggle",
    ({ target }) => target.open && target.dataset.packed && open(target),
    true,
  );
  window.addEventListener("hashchange", () => (readFilter() ? filter() : follow()));
  // Cells that pass are no links, so that a large table stays light: the row's name is.
  byId("matrix").addEventListener("click", ({ target }) => {
    const cell = target.closest("td");
    if (!cell || target.closest("a") || !cell.textContent) return;
    const column = matrixChecks()[cell.cellIndex - 1];
    const check = column.replace(/[^A-Za-z0-9]/g, "-");
    location.hash = `${cell.parentElement.dataset.section}--${check}`;
  });
}

// ---- Filters ----

const matrixChecks = () => all("#matrix thead th[data-check]").map((th) => th.dataset.check);

/** The filter in words of the address: #q=…&verdict=…&check=…. */
function filterHash() {
  const form = byId("filters");
  const parts = new URLSearchParams();
  if (form.q.value) parts.set("q", form.q.value);
  const verdicts = all("input[name=verdict]:checked", form).map((box) => box.value);
  if (verdicts.length) parts.set("verdict", verdicts.join(" "));
  if (form.check.value) parts.set("check", form.check.value);
  if (form.changed?.checked) parts.set("changed", "1");
  return parts.toString();
}

/** Sets the controls from the address; false where it holds no filter. */
function readFilter() {
  const parts = new URLSearchParams(location.hash.slice(1));
  const known = ["q", "verdict", "check", "changed"];
  if (![...parts.keys()].some((key) => known.includes(key))) return false;
  const form = byId("filters");
  form.q.value = parts.get("q") ?? "";
  const verdicts = (parts.get("verdict") ?? "").split(" ");
  all("input[name=verdict]", form).forEach((box) => (box.checked = verdicts.includes(box.value)));
  form.check.value = parts.get("check") ?? "";
  if (form.check.selectedIndex < 0) form.check.value = "";
  if (form.changed) form.changed.checked = parts.has("changed");
  return true;
}

function filter() {
  const form = byId("filters");
  const words = form.q.value.toLowerCase().split(/\s+/).filter(Boolean);
  const verdicts = new Set(all("input[name=verdict]:checked", form).map((box) => box.value));
  const column = matrixChecks().indexOf(form.check.value);
  const changed = form.changed?.checked;
  let shown = 0;
  for (const row of byId("matrix").tBodies[0].rows) {
    const cells = column < 0 ? [...row.cells].slice(1) : [row.cells[column + 1]];
    const name = row.cells[0].textContent.toLowerCase();
    const fits =
      words.every((word) => name.includes(word)) &&
      (column < 0 || cells[0].className !== "none") &&
      (!verdicts.size || cells.some((cell) => verdicts.has(cell.className))) &&
      (!changed || cells.some((cell) => cell.querySelector(".trend")));
    if (row.hidden === fits) row.hidden = !fits;
    const section = byId(row.dataset.section);
    if (section && section.hidden === fits) section.hidden = !fits;
    if (fits) shown += 1;
  }
  const count = byId("matrix").tBodies[0].rows.length;
  byId("shown").textContent = shown === count ? `All ${count} subjects` : `${shown} of ${count} subjects`;
}

function prepareFilters() {
  const form = byId("filters");
  form.hidden = false;
  const apply = () => {
    const hash = filterHash();
    history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
    filter();
  };
  form.addEventListener("input", apply);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(apply));
  readFilter();
  filter();
}

// ---- Discs ----

const scales = json(byId("scales"));
let carried = null;

/** Cells that the page carries, by the file of their evidence. */
async function carriedCells(path) {
  await arrived;
  carried ??= new Map(all("script[data-cells]").map((script) => [script.dataset.cells, script]));
  return carried.get(path);
}

const loaded = new Map();

/** The cells of a case: from the page, else from its evidence. */
async function load(chosen, ask) {
  const path = chosen.evidence;
  if (!loaded.has(path)) {
    const script = await carriedCells(path);
    const cells = script ? decodeCells(await unpack(fromBase64(script.textContent))) : await fetched(path, ask);
    loaded.set(path, cells);
  }
  return loaded.get(path);
}

async function fetched(path, ask) {
  let packed;
  if (location.protocol === "file:") {
    packed = await chosenFile(path, ask);
  } else {
    const answer = await fetch(path);
    if (!answer.ok) throw new Error(`${path} is not there (${answer.status}): the page carries no cells of this case.`);
    packed = new Uint8Array(await answer.arrayBuffer());
  }
  // A server may have unpacked it on the way.
  const bytes = packed[0] === 0x1f && packed[1] === 0x8b ? await unpack(packed) : packed;
  const cells = cellsOfEvidence(JSON.parse(new TextDecoder().decode(bytes)));
  if (!cells) throw new Error(`${path} has no cells: nothing was counted or integrated.`);
  return cells;
}

/** Pages opened from a file may not read other files: the reader hands it over. */
function chosenFile(path, ask) {
  const input = element("input", { type: "file", accept: ".gz" });
  const told = `The page does not carry the cells of this direction, and a page opened from a file may not read others. Choose ${path}: `;
  ask(element("p", {}, element("label", {}, told, input)));
  return new Promise((resolve) => {
    input.addEventListener("change", async () => resolve(new Uint8Array(await input.files[0].arrayBuffer())));
  });
}

/** Draws discs when they come into sight. */
const inSight = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    inSight.unobserve(target);
    target.discs = new Discs(target, json(target.querySelector("script")), load, scales);
  }
}, { rootMargin: "200px" });

function prepare(within) {
  offerCopies(within);
  all(".discs", within).forEach((holder) => {
    holder.hidden = false;
    inSight.observe(holder);
  });
}

document.documentElement.classList.add("scripted");
chooseTheme();
prepare(document);
prepareSections();
prepareFilters();
follow();
// On paper everything that a reader could open is open, and discs are pictures: canvases
// are drawn when they come into sight, which is too late.
window.addEventListener("beforeprint", () => {
  all("details:not([data-packed])").forEach((details) => (details.open = true));
  all(".subject noscript").forEach((hidden) => {
    const figure = element("div", { class: "for-paper" });
    figure.innerHTML = hidden.textContent;
    hidden.replaceWith(figure);
  });
});
