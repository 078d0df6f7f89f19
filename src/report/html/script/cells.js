// The cells of a case: the partition of the sphere that its draws were counted in.
// src/report/html/cells.rs writes them for the page, src/report/saved.rs as evidence;
// the maps are those of src/sphere/chart.rs.

const GRID = 2 ** 40;
const SHAPES = ["equal-area", "projected-concentric", "projected-cylindrical"];

/** Unpacks gzip. */
async function unpack(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Bytes of base64. */
function fromBase64(text) {
  return Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
}

/** A tree in preorder: the node after a cut is its lower part, `above` names the other. */
function tree(nodes) {
  return {
    axis: new Int8Array(nodes).fill(-1),
    at: new Float64Array(nodes),
    above: new Int32Array(nodes),
    leaf: new Int32Array(nodes).fill(-1),
    lo: [],
    hi: [],
  };
}

/** Walks a tree in preorder; `cut(node, lo, hi)` is [axis, place], or null at a leaf. */
function grow(nodes, cut) {
  const grown = tree(nodes);
  const open = [[-1, [0, 0], [2, 1]]];
  for (let node = 0; node < nodes; node++) {
    const [below, lo, hi] = open.pop();
    if (below >= 0) grown.above[below] = node;
    const found = cut(node, lo, hi);
    if (!found) {
      grown.leaf[node] = grown.lo.length;
      grown.lo.push(lo);
      grown.hi.push(hi);
      continue;
    }
    const [axis, at] = found;
    grown.axis[node] = axis;
    grown.at[node] = at;
    const middleHi = [...hi];
    const middleLo = [...lo];
    middleHi[axis] = at;
    middleLo[axis] = at;
    open.push([node, middleLo, hi], [-1, lo, middleHi]);
  }
  return grown;
}

/** Cells as the page carries them. */
function decodeCells(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [version, shape, flags] = bytes;
  if (version !== 1) throw new Error(`cells of version ${version}`);
  const floats = Array.from({ length: 6 }, (_, k) => view.getFloat64(3 + 8 * k, true));
  let at = 3 + 6 * 8;
  const number = () => {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      const byte = bytes[at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
    }
  };
  const nodes = number();
  const codes = at;
  let cuts = codes + Math.ceil(nodes / 4);
  const partition = grow(nodes, (node, lo, hi) => {
    const code = (bytes[codes + (node >> 2)] >> (2 * (node & 3))) & 3;
    if (code < 2) return null;
    const axis = code - 2;
    const cut = view.getUint16(cuts, true);
    cuts += 2;
    return [axis, lo[axis] + (hi[axis] - lo[axis]) * (cut / 65536)];
  });
  at = cuts;
  const leaves = partition.lo.length;
  const column = (part) => Float64Array.from({ length: leaves }, () => number() / part);
  const observed = flags & 1 ? column(1) : null;
  const expected = flags & 2 ? column(16) : null;
  const [cos, sin, x, y, z, scale] = floats;
  const chart = { cos, sin, shape: SHAPES[shape] };
  return { partition, chart, wo: [x, y, z], scale, observed, expected, normals: Boolean(flags & 4) };
}

/** The same of evidence, a case's own file. */
function cellsOfEvidence(evidence) {
  const saved = evidence.partition;
  if (!saved || !evidence.integrals) return null;
  // Leaves are numbered in the order in which cuts were made.
  const order = [];
  const numbers = [0];
  let next = 1;
  const partition = grow(saved.preorder.length, (node) => {
    const number = numbers.pop();
    const code = saved.preorder[node];
    if (code < 0) {
      order.push(number);
      return null;
    }
    numbers.push(next + 1, next);
    next += 2;
    return [code % 2, Math.floor(code / 2) / GRID];
  });
  const sorted = [...order].sort((a, b) => a - b);
  const rank = new Map(sorted.map((number, k) => [number, k]));
  const inPreorder = (values) => Float64Array.from(order, (number) => values[rank.get(number)]);
  const draws = evidence.draws.find((d) => d.samples > 0);
  const scale = draws ? draws.samples : 2 ** 18;
  const masses = evidence.description.has.pdf ? inPreorder(evidence.integrals.pdf) : null;
  const [cos, sin] = saved.x_axis;
  return {
    partition,
    chart: { cos, sin, shape: saved.shape ?? SHAPES[0] },
    wo: evidence.wo,
    scale,
    observed: draws ? inPreorder(draws.counts) : null,
    expected: masses && masses.map((mass) => Math.max(mass, 0) * scale),
    normals: evidence.description.kind === "distribution",
  };
}

/** The point of a direction in the chart's two squares. */
function toPoint({ cos, sin, shape }, [dx, dy, dz]) {
  const below = 1 - Number.EPSILON;
  const x = cos * dx + sin * dy;
  const y = cos * dy - sin * dx;
  const side = dz > 0 ? 0 : 1;
  const square = x * x + y * y;
  if (shape === SHAPES[2]) {
    const turns = Math.atan2(y, x) / (2 * Math.PI);
    return [side + Math.min(turns < 0 ? turns + 1 : turns, below), Math.min(square, 1)];
  }
  const r = Math.min(Math.sqrt(shape === SHAPES[0] ? square / (1 + Math.abs(dz)) : square), 1);
  const [ax, ay] = [Math.abs(x), Math.abs(y)];
  const alongX = ax >= ay;
  const [major, minor] = alongX ? [ax, ay] : [ay, ax];
  const other = major === 0 ? 0 : (r * Math.atan(minor / major) * 4) / Math.PI;
  const signed = (size, like) => (like < 0 || Object.is(like, -0) ? -size : size);
  const u = Math.min(0.5 + 0.5 * signed(alongX ? r : other, x), below);
  const v = Math.min(0.5 + 0.5 * signed(alongX ? other : r, y), 1);
  return [side + u, v];
}

/** The direction of a point. */
function toDirection(chart, [u, v]) {
  const side = u < 1 ? 1 : -1;
  if (u >= 1) u -= 1;
  if (chart.shape === SHAPES[2]) {
    const r = Math.sqrt(v);
    const turn = 2 * Math.PI * u;
    return turnedBack(chart, r * Math.cos(turn), r * Math.sin(turn), side * Math.sqrt(Math.max(1 - v, 0)));
  }
  const [a, b] = [2 * u - 1, 2 * v - 1];
  const alongX = Math.abs(a) >= Math.abs(b);
  const [major, minor] = alongX ? [a, b] : [b, a];
  const angle = major === 0 ? 0 : ((Math.PI / 4) * minor) / major;
  const [along, across] = [major * Math.cos(angle), major * Math.sin(angle)];
  const [x, y] = alongX ? [along, across] : [across, along];
  const rest = (1 - major) * (1 + major);
  if (chart.shape === SHAPES[1]) return turnedBack(chart, x, y, side * Math.sqrt(Math.max(rest, 0)));
  const stretch = Math.sqrt(2 - major * major);
  return turnedBack(chart, x * stretch, y * stretch, side * rest);
}

function turnedBack({ cos, sin }, x, y, z) {
  return [cos * x - sin * y, sin * x + cos * y, z];
}

/** Where a disc shows a direction. */
function toDisc({ cos, sin }, [dx, dy, dz]) {
  const scale = 1 / Math.sqrt(1 + Math.abs(dz));
  return [(cos * dx + sin * dy) * scale, (cos * dy - sin * dx) * scale];
}

/** The direction at a place of a disc, or null outside of it. */
function fromDisc(chart, [x, y], front) {
  const t = x * x + y * y;
  if (t > 1) return null;
  const stretch = Math.sqrt(2 - t);
  return turnedBack(chart, x * stretch, y * stretch, front ? 1 - t : t - 1);
}

/** The leaf that holds a direction. */
function locate({ partition, chart }, direction) {
  const point = toPoint(chart, direction);
  let node = 0;
  while (partition.axis[node] >= 0) {
    node = point[partition.axis[node]] >= partition.at[node] ? partition.above[node] : node + 1;
  }
  return partition.leaf[node];
}

/** The solid angle of a leaf in steradians. */
function solidAngle({ partition, chart }, leaf) {
  const [lo, hi] = [partition.lo[leaf], partition.hi[leaf]];
  if (chart.shape === SHAPES[0]) return 2 * Math.PI * (hi[0] - lo[0]) * (hi[1] - lo[1]);
  if (chart.shape === SHAPES[2]) {
    const cos = (v) => Math.sqrt(Math.max(1 - v, 0));
    return 2 * Math.PI * (hi[0] - lo[0]) * (cos(lo[1]) - cos(hi[1]));
  }
  const side = lo[0] < 1 ? 0 : 1;
  const [a0, a1] = [lo[0], hi[0]].map((u) => 2 * (u - side) - 1);
  const [b0, b1] = [lo[1], hi[1]].map((v) => 2 * v - 1);
  const corner = (x, y) => {
    const less = Math.min(Math.abs(x), Math.abs(y), 1);
    const more = Math.min(Math.max(Math.abs(x), Math.abs(y)), 1);
    const size = 2 * (1 - Math.sqrt((1 - less) * (1 + less))) + less * (Math.asin(more) - Math.asin(less));
    return Math.sign(x) * Math.sign(y) * size;
  };
  return (Math.PI / 4) * (corner(a1, b1) - corner(a0, b1) - corner(a1, b0) + corner(a0, b0));
}

/** By how many standard deviations a leaf is off; NaN where too little is expected. */
function residual({ observed, expected }, leaf, { fewest, clip }) {
  const [o, e] = [observed[leaf], expected[leaf]];
  if (e >= fewest) return (o - e) / Math.sqrt(e);
  const surplus = (o - e) / Math.sqrt(Math.max(e, 1));
  return surplus >= clip ? surplus : NaN;
}

const isFront = ({ partition }, leaf) => partition.lo[leaf][0] < 1;

/** Whether a hemisphere has any count or mass. */
function isMet(cells, front) {
  const any = (values) => values && values.some((v, leaf) => v > 0 && isFront(cells, leaf) === front);
  return Boolean(any(cells.observed) || any(cells.expected));
}

/** The square that holds nearly all of a hemisphere's samples and pdf, if it is small;
    as in src/report/plots/disc_leaves.rs. */
function lobeWindow(cells, front, { share, zoom_below }) {
  const PARTS = 8;
  const { partition, chart, observed, expected, scale } = cells;
  const found = [];
  partition.lo.forEach((lo, leaf) => {
    const weight = ((observed?.[leaf] ?? 0) + (expected?.[leaf] ?? 0)) / scale;
    if (isFront(cells, leaf) !== front || !(weight > 0)) return;
    const hi = partition.hi[leaf];
    const places = [];
    for (let k = 0; k < (PARTS + 1) ** 2; k++) {
      const [s, t] = [(k % (PARTS + 1)) / PARTS, Math.floor(k / (PARTS + 1)) / PARTS];
      let u = lo[0] + s * (hi[0] - lo[0]);
      if (front) u = Math.min(u, 1 - Number.EPSILON);
      places.push(toDisc(chart, toDirection(chart, [u, lo[1] + t * (hi[1] - lo[1])])));
    }
    found.push([places, weight]);
  });
  const total = found.reduce((sum, [, weight]) => sum + weight, 0);
  const quantile = (part, key) => {
    const keys = found.map(([places, weight]) => [key(places), weight]).sort((a, b) => a[0] - b[0]);
    let sum = 0;
    const reached = keys.find(([, weight]) => (sum += weight) >= part * total);
    return reached ? reached[0] : 1;
  };
  const middle = (PARTS / 2) * (PARTS + 2);
  const centre = [0, 1].map((k) => quantile(0.5, (places) => places[middle][k]));
  const distance = (p) => Math.max(Math.abs(p[0] - centre[0]), Math.abs(p[1] - centre[1]));
  const half = 1.2 * quantile(share, (places) => Math.min(...places.map(distance)));
  return half > 0 && half < zoom_below ? { centre, half } : WHOLE;
}

const WHOLE = { centre: [0, 0], half: 1 };
