// Discs of a case: what the sampler drew, what pdf says, and by how much they differ.

const SIDE = 264;
// Lines and letters are sharper than cells, which need no more than a pixel.
const SHARP = 2;
const DENSITY_STEPS = 64;
const NAMES = ["samples", "pdf", "difference"];
const degrees = (radians) => (radians * 180) / Math.PI;
const mark = { fail: "✗", error: "E", inconclusive: "?", warn: "!", waived: "w", pass: "✓", skipped: "–" };

function between(anchors, t) {
  const place = Math.min(Math.max(t, 0), 1) * (anchors.length - 1);
  const below = Math.min(Math.floor(place), anchors.length - 2);
  return anchors[below].map((a, k) => Math.round(a + (place - below) * (anchors[below + 1][k] - a)));
}

const css = ([r, g, b], alpha = 1) => `rgba(${r}, ${g}, ${b}, ${alpha})`;

/** The first of 1, 2, 5 times a power of ten that is at least `least`. */
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((k) => k * power).find((step) => step >= least * 0.999) ?? 10 * power;
}

/** A number as people read it. */
function figure(value) {
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(2) : String(+value.toPrecision(5));
  return text.replace("-", "−");
}

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** The discs of a subject. `source` has its cases; `load` brings a case's cells. */
class Discs {
  constructor(holder, source, load, scales) {
    Object.assign(this, { holder, load, scales, cases: source.cases, number: source.first });
    this.zoomed = true;
    this.places = new Map();
    this.build();
    this.show();
  }

  build() {
    const distinct = (of) => [...new Set(this.cases.map(of))];
    const isBack = (c) => (c.theta > 90 ? "back" : "front");
    this.controls = element("div", { class: "controls" });
    this.choices = [
      ["light", "transport", (c) => c.transport],
      ["wo on the", "side", isBack],
    ]
      .filter(([, , of]) => distinct(of).length > 1)
      .map(([label, name, of]) => {
        const select = element("select", { "data-choice": name });
        distinct(of).forEach((value) => select.append(new Option(value, value)));
        this.controls.append(element("label", {}, `${label} `, select));
        select.addEventListener("change", () => this.choose());
        return { select, of };
      });
    this.slider = element("input", { type: "range", min: 0, step: 1 });
    this.theta = element("output");
    this.controls.append(element("label", { class: "theta" }, "θo ", this.slider, " ", this.theta));
    this.slider.addEventListener("input", () => this.choose());
    this.phi = element("select");
    this.phiLabel = element("label", {}, "φo ", this.phi);
    this.phi.addEventListener("change", () => this.choose());
    this.zoom = element("input", { type: "checkbox" });
    this.zoom.checked = true;
    this.zoomLabel = element("label", {}, this.zoom, " zoom to the lobe");
    this.zoom.addEventListener("change", () => {
      this.zoomed = this.zoom.checked;
      this.draw();
    });
    this.controls.append(this.phiLabel, this.zoomLabel);
    this.rows = element("div", { class: "disc-rows" });
    this.reading = element("p", { class: "reading", "aria-live": "polite" });
    this.note = element("div", { class: "note" });
    this.holder.append(this.controls, this.rows, this.reading, this.note);
    const first = this.cases[this.number];
    this.choices.forEach(({ select, of }) => (select.value = of(first)));
    this.fill(first);
    if (this.cases.length === 1) this.controls.classList.add("single");
  }

  /** Cases that the choices leave. */
  left() {
    return this.cases.filter((c) => this.choices.every(({ select, of }) => of(c) === select.value));
  }

  /** Sets the slider and φo to a case. */
  fill(chosen) {
    this.thetas = [...new Set(this.left().map((c) => c.theta))].sort((a, b) => a - b);
    this.slider.max = this.thetas.length - 1;
    this.slider.value = this.thetas.indexOf(chosen.theta);
    const phis = this.left().filter((c) => c.theta === chosen.theta).map((c) => c.phi);
    this.phi.replaceChildren(...phis.map((phi) => new Option(`${figure(phi)}°`, phi)));
    this.phi.value = chosen.phi;
    this.phi.disabled = phis.length < 2;
    const verdict = `${mark[chosen.verdict]} ${chosen.verdict}`;
    this.theta.textContent = `${figure(chosen.theta)}° ${verdict}`;
    this.slider.setAttribute("aria-valuetext", `θo ${figure(chosen.theta)}°, ${chosen.verdict}`);
  }

  /** The case that the controls stand at. */
  choose() {
    const left = this.left();
    const theta = this.thetas[this.slider.value];
    const off = (c) => Math.abs(c.theta - theta) + (String(c.phi) === this.phi.value ? 0 : 1e-3);
    const chosen = left.reduce((a, b) => (off(b) < off(a) ? b : a));
    this.number = this.cases.indexOf(chosen);
    this.fill(chosen);
    this.show();
  }

  async show() {
    const number = this.number;
    const chosen = this.cases[number];
    this.note.replaceChildren();
    try {
      const cells = await this.load(chosen, (question) => this.note.append(question));
      if (number !== this.number) return;
      this.cells = cells;
      this.draw();
    } catch (error) {
      if (number !== this.number) return;
      this.cells = null;
      this.rows.replaceChildren();
      this.reading.textContent = "";
      this.note.append(element("p", {}, error.message));
      if (chosen.plot) {
        const link = element("a", { href: chosen.plot }, chosen.plot);
        this.note.append(element("p", {}, "Its picture: ", link));
      }
    }
  }

  draw() {
    const { cells } = this;
    if (!cells) return;
    const sides = [true, false].filter((front) => isMet(cells, front));
    const densities = [cells.observed, cells.expected].map(
      (values) => values && values.map((v, leaf) => v / cells.scale / solidAngle(cells, leaf)),
    );
    const largest = Math.max(0, ...densities.flatMap((d) => (d ? [d.reduce((a, b) => Math.max(a, b), 0)] : [])));
    const residuals =
      cells.observed && cells.expected
        ? cells.observed.map((_, leaf) => residual(cells, leaf, this.scales))
        : null;
    this.zoomLabel.hidden = sides.every((front) => lobeWindow(cells, front, this.scales) === WHOLE);
    this.reading.textContent =
      "Point at a cell, or focus the discs and use the arrow keys, to read it. Ring: wo; cross: its mirror direction.";
    this.rows.replaceChildren();
    if (sides.length === 0) this.reading.textContent = "Nothing was drawn here, and pdf is 0.";
    for (const front of sides) {
      const window = this.zoomed ? lobeWindow(cells, front, this.scales) : WHOLE;
      this.rows.append(this.row(front, window, [...densities, residuals], largest, sides.length > 1));
    }
  }

  /** Three discs of a hemisphere. */
  row(front, window, panels, largest, named) {
    const side = front ? "front" : "back";
    const what = this.cells.normals ? "normals" : "directions";
    const row = element("div", {
      class: "disc-row",
      tabindex: 0,
      role: "application",
      "aria-label": `Discs of ${what} on the ${side}; arrow keys move the crosshair`,
    });
    const leaves = this.leaves(front, window);
    const drawn = panels.map((values, k) => {
      const canvas = element("canvas", { width: SHARP * SIDE, height: SHARP * SIDE, role: "img" });
      const scale = k < 2 ? this.densityScale(largest) : this.residualScale();
      const title = named ? `${NAMES[k]} (${side})` : NAMES[k];
      const caption = element("figcaption", {}, element("b", {}, title), " ", scale.told);
      row.append(element("figure", {}, canvas, caption));
      if (!values) {
        canvas.setAttribute("aria-label", `${title}: not measured`);
        caption.replaceChildren(element("b", {}, title), " not measured");
        return null;
      }
      canvas.setAttribute("aria-label", `${title} ${this.alternative(values, k, front)}`);
      return this.paint(canvas, leaves, values, scale, front, window);
    });
    const canvases = [...row.querySelectorAll("canvas")];
    const state = { place: null };
    const move = (x, y) => {
      state.place = [Math.min(Math.max(x, 0), SIDE - 1), Math.min(Math.max(y, 0), SIDE - 1)];
      canvases.forEach((canvas, k) => {
        if (!drawn[k]) return;
        const context = canvas.getContext("2d");
        context.putImageData(drawn[k], 0, 0);
        this.crosshair(context, state.place);
      });
      this.read(front, window, state.place);
    };
    canvases.forEach((canvas) => {
      canvas.addEventListener("pointermove", (event) => {
        const box = canvas.getBoundingClientRect();
        const scale = SIDE / box.width;
        move((event.clientX - box.left) * scale, (event.clientY - box.top) * scale);
      });
    });
    row.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 1 : 6;
      const by = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
      if (!by) return;
      event.preventDefault();
      const [x, y] = state.place ?? [SIDE / 2, SIDE / 2];
      move(x + by[0], y + by[1]);
    });
    return row;
  }

  /** The direction under a pixel. */
  direction(front, window, [x, y]) {
    const { centre, half } = window;
    const at = [centre[0] - half + (2 * half * x) / SIDE, centre[1] + half - (2 * half * y) / SIDE];
    return fromDisc(this.cells.chart, at, front);
  }

  /** The leaf of each pixel; −1 outside of the disc. */
  leaves(front, window) {
    const leaves = new Int32Array(SIDE * SIDE);
    for (let k = 0; k < SIDE * SIDE; k++) {
      const direction = this.direction(front, window, [(k % SIDE) + 0.5, Math.floor(k / SIDE) + 0.5]);
      leaves[k] = direction ? locate(this.cells, direction) : -1;
    }
    return leaves;
  }

  densityScale(largest) {
    const { floor, nothing, sequential } = this.scales;
    const colour = (value) => {
      if (!(value > 0)) return nothing;
      const t = 1 + Math.log10(value / largest) / -Math.log10(floor);
      return between(sequential, Math.round(Math.min(Math.max(t, 0), 1) * (DENSITY_STEPS - 1)) / (DENSITY_STEPS - 1));
    };
    return { colour, told: `up to ${figure(largest)} sr⁻¹, log scale of ${-Math.log10(floor)} decades; grey: 0` };
  }

  residualScale() {
    const { clip, fewest, unknown, diverging } = this.scales;
    const colour = (value) => {
      if (Number.isNaN(value)) return unknown;
      const t = 0.5 + 0.5 * Math.min(Math.max(value / clip, -1), 1);
      return between(diverging, Math.round(t * DENSITY_STEPS) / DENSITY_STEPS);
    };
    return { colour, told: `−${clip} σ blue, +${clip} σ orange; grey: fewer than ${fewest} expected` };
  }

  /** What a screen reader says of a disc. */
  alternative(values, k, front) {
    const found = [...values.keys()].filter((leaf) => isFront(this.cells, leaf) === front && !Number.isNaN(values[leaf]));
    if (found.length === 0) return "without any cell to judge";
    const worst = found.reduce((a, b) => (Math.abs(values[b]) > Math.abs(values[a]) ? b : a));
    const { lo, hi } = this.cells.partition;
    const middle = [0, 1].map((axis) => 0.5 * (lo[worst][axis] + hi[worst][axis]));
    const unit = k < 2 ? "per steradian" : "standard deviations";
    return `largest: ${figure(values[worst])} ${unit} at ${this.angles(toDirection(this.cells.chart, middle))}`;
  }

  paint(canvas, leaves, values, scale, front, window) {
    const context = canvas.getContext("2d", { willReadFrequently: true });
    const coarse = element("canvas", { width: SIDE, height: SIDE });
    const image = new ImageData(SIDE, SIDE);
    const colours = Array.from(values, (value) => scale.colour(value));
    leaves.forEach((leaf, k) => {
      if (leaf < 0) return;
      image.data.set(colours[leaf], 4 * k);
      image.data[4 * k + 3] = 255;
    });
    coarse.getContext("2d").putImageData(image, 0, 0);
    context.scale(SHARP, SHARP);
    context.imageSmoothingEnabled = false;
    context.drawImage(coarse, 0, 0);
    context.lineJoin = "round";
    this.graticule(context, front, window);
    return context.getImageData(0, 0, SHARP * SIDE, SHARP * SIDE);
  }

  /** Lines of equal θ and φ, wo as a ring and its mirror direction as a cross. */
  graticule(context, front, window) {
    const { chart, wo } = this.cells;
    const { ink, paper } = this.scales;
    const { centre, half } = window;
    const zoomed = window !== WHOLE;
    const pixel = ([x, y]) => [((x - centre[0] + half) * SIDE) / (2 * half), ((centre[1] + half - y) * SIDE) / (2 * half)];
    const radius = (theta) => Math.SQRT2 * Math.sin((theta * Math.PI) / 360);
    const thetaAt = (r) => 2 * degrees(Math.asin(Math.min(r / Math.SQRT2, 1)));
    const middle = Math.hypot(...centre);
    const [near, far] = [Math.max(middle - 1.5 * half, 0), Math.min(middle + 1.5 * half, 1)];
    const step = zoomed ? niceStep((thetaAt(far) - thetaAt(near)) / 6) : 30;
    const turn = zoomed && near > 0 ? niceStep(degrees((2 * half) / middle) / 3.5) : 30;
    const zero = degrees(Math.atan2(chart.sin, chart.cos));
    const stroke = (trace) => {
      for (const [colour, width] of [[css(paper, 0.45), 2.2], [css(ink, 0.65), 0.8]]) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.beginPath();
        trace();
        context.stroke();
      }
    };
    const [x0, y0] = pixel([0, 0]);
    const unit = SIDE / (2 * half);
    const labels = [];
    for (let k = Math.ceil(thetaAt(near) / step - 1e-9); k * step < Math.min(thetaAt(far) + 1e-9, 90); k++) {
      if (k === 0) continue;
      const r = radius(k * step) * unit;
      stroke(() => context.arc(x0, y0, r, 0, 2 * Math.PI));
      const heading = zoomed ? Math.atan2(centre[1], centre[0]) : -1.2;
      const shown = front ? k * step : 180 - k * step;
      labels.push([`${figure(shown)}°`, x0 + r * Math.cos(heading), y0 - r * Math.sin(heading)]);
    }
    for (let phi = 0; phi < 360 - 1e-9; phi += turn) {
      const angle = ((phi - zero) * Math.PI) / 180;
      const from = zoomed ? near : 0.96;
      const ray = (r) => pixel([r * Math.cos(angle), r * Math.sin(angle)]);
      stroke(() => {
        context.moveTo(...ray(from));
        context.lineTo(...ray(zoomed ? far : 1));
      });
      const [x, y] = zoomed ? ray(Math.min(middle + 0.85 * half, 1)) : ray(0.87);
      const inside = x > 0 && x < SIDE && y > 0 && y < SIDE;
      if (inside && (zoomed || phi % 90 === 0)) labels.push([`φ ${figure(phi)}°`, x, y]);
    }
    stroke(() => context.arc(x0, y0, unit - (zoomed ? 0 : 1), 0, 2 * Math.PI));
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const [text, x, y] of labels) {
      if (x < 14 || x > SIDE - 14 || y < 8 || y > SIDE - 8) continue;
      context.lineWidth = 3;
      context.strokeStyle = css(paper, 0.85);
      context.strokeText(text, x, y);
      context.fillStyle = css(ink);
      context.fillText(text, x, y);
    }
    const symbol = (direction, trace) => {
      const place = toDisc(chart, direction);
      if (direction[2] > 0 !== front || place.some((v, k) => Math.abs(v - centre[k]) > half)) return;
      const at = pixel(place);
      for (const [colour, width] of [[css(paper), 4], [css(ink), 2]]) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.beginPath();
        trace(...at);
        context.stroke();
      }
    };
    symbol(wo, (x, y) => context.arc(x, y, 5, 0, 2 * Math.PI));
    symbol([-wo[0], -wo[1], wo[2]], (x, y) => {
      context.moveTo(x - 5, y - 5);
      context.lineTo(x + 5, y + 5);
      context.moveTo(x - 5, y + 5);
      context.lineTo(x + 5, y - 5);
    });
  }

  crosshair(context, [x, y]) {
    for (const [colour, width] of [[css(this.scales.paper, 0.9), 3], [css(this.scales.ink), 1]]) {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.beginPath();
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.moveTo(x + 4 * dx, y + 4 * dy);
        context.lineTo(x + 14 * dx, y + 14 * dy);
      }
      context.stroke();
    }
  }

  angles([x, y, z]) {
    const theta = degrees(Math.atan2(Math.hypot(x, y), z));
    const phi = (degrees(Math.atan2(y, x)) + 360) % 360;
    return `θ ${theta.toFixed(2)}°, φ ${phi.toFixed(1)}°`;
  }

  /** Tells the cell under the crosshair. */
  read(front, window, place) {
    const direction = this.direction(front, window, place);
    if (!direction) {
      this.reading.textContent = "Outside of the disc.";
      return;
    }
    const { cells } = this;
    const leaf = locate(cells, direction);
    const parts = [];
    if (cells.observed) parts.push(`observed ${figure(cells.observed[leaf])}`);
    if (cells.expected) parts.push(`expected ${figure(cells.expected[leaf])}`);
    if (cells.observed && cells.expected) {
      const sigma = residual(cells, leaf, this.scales);
      const signed = `${sigma > 0 ? "+" : ""}${sigma.toFixed(1)}`.replace("-", "−");
      parts.push(Number.isNaN(sigma) ? "too few are expected to judge" : `${signed} σ`);
    }
    parts.push(`a cell of ${figure(solidAngle(cells, leaf))} sr`);
    const where = cells.normals ? "normal at" : "wi at";
    this.reading.textContent = `${where} ${this.angles(direction)}: ${parts.join(", ")}`;
  }
}
