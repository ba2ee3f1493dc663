// The figure of a report (demo/shared/figure.hpp): viewer of linear pictures, maps, error against time, tables, crops,
// exports. Plain script without dependencies; it fetches nothing. Its numbers are those of the report's JSON, or follow
// from them by the formulas below.
'use strict';
(() => {

// ------------------------------------------------------------------------------------------------ data

function bytesOf(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}
/// IEEE 754 halves to numbers, by a table of all of them.
let halfTable = null;
function halves(bytes, scale) {
  if (!halfTable) {
    halfTable = new Float32Array(65536);
    for (let h = 0; h < 65536; ++h) {
      const sign = h & 0x8000 ? -1 : 1, exponent = h >> 10 & 31, fraction = h & 1023;
      const magnitude = exponent === 31 ? (fraction ? NaN : Infinity) :
        exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction;
      halfTable[h] = sign * magnitude;
    }
  }
  const words = new Uint16Array(bytes.buffer), result = new Float32Array(words.length);
  for (let i = 0; i < words.length; ++i) result[i] = halfTable[words[i]] / scale;
  return result;
}
const luminance = (p, i) => 0.2126 * p[3 * i] + 0.7152 * p[3 * i + 1] + 0.0722 * p[3 * i + 2];
/// The pixel of a coordinate along a side of so many pixels.
const within = (v, size) => Math.min(Math.max(Math.floor(v), 0), size - 1);

// ------------------------------------------------------------------------------------------------ numbers as text

function short(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return '';
  if (!Number.isFinite(value)) return value > 0 ? 'inf' : '-inf';
  return String(Number(value.toPrecision(digits)));
}
const percent = (value, digits = 3) => (Number.isFinite(value) ? short(100 * value, digits) + '\u00a0%' : '');
const ENTITIES = {'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;'};
const escapeText = text => String(text).replace(/[&<>"]/g, c => ENTITIES[c]);
/// A text in lines of about so many characters; what does not fit into the last ends in dots.
function linesOf(text, length, most) {
  const lines = [''];
  for (const word of text.split(' ')) {
    const last = lines.length - 1, longer = lines[last] ? `${lines[last]} ${word}` : word;
    if (longer.length <= length || !lines[last]) lines[last] = longer;
    else if (lines.length < most) lines.push(word);
    else { lines[last] += '\u2026'; break; }
  }
  return lines;
}
/// 1, 2 or 5 times a power of ten, at least the value.
function roundUp(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  for (const step of [1, 2, 5]) if (value <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

// ------------------------------------------------------------------------------------------------ colours

// Stops of even distance whose lightness grows, so that they read in grey too; the signed one is blue to red, which
// colour-blind eyes tell apart.
const SEQUENTIAL = [
  [0, 0, 0], [66, 10, 74], [147, 26, 72], [222, 66, 37], [250, 146, 14], [252, 228, 120], [255, 255, 255],
];
const SIGNED = [
  [8, 48, 120], [52, 122, 190], [150, 199, 226], [247, 247, 247], [246, 178, 144], [206, 74, 64], [110, 4, 28],
];
const NOISE = [150, 150, 150], NOT_FINITE = [0, 255, 0];
function colourAt(stops, t) {
  const position = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
  const lower = Math.min(Math.floor(position), stops.length - 2), f = position - lower;
  return [0, 1, 2].map(c => Math.round(stops[lower][c] * (1 - f) + stops[lower + 1][c] * f));
}
// [Okabe2008] without its yellow, which white swallows, and two dark ones. Any two differ by CIEDE2000 10 at least,
// also without one of the three kinds of cones [Machado2009]; nothing is told by colour alone.
const PALETTE = ['#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9', '#333333', '#480060'];
const MARKS = ['circle', 'square', 'up', 'down', 'diamond', 'plus', 'cross', 'star'];
const DASHES = ['', '7 3', '2 3'];
const cropColour = k => PALETTE[(k + 1) % PALETTE.length];
function mark(kind, x, y, r, colour, hollow) {
  const fill = hollow ? '#fff' : colour;
  const path = d => `<path d="${d}" fill="${fill}" stroke="${colour}" stroke-width="1.6"/>`;
  const line = d => `<path d="${d}" fill="none" stroke="${colour}" stroke-width="2.2"/>`;
  switch (kind) {
    case 'square': return path(`M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}z`);
    case 'up': return path(`M${x} ${y - 1.2 * r}l${1.15 * r} ${2.1 * r}h${-2.3 * r}z`);
    case 'down': return path(`M${x} ${y + 1.2 * r}l${1.15 * r} ${-2.1 * r}h${-2.3 * r}z`);
    case 'diamond':
      return path(`M${x} ${y - 1.35 * r}l${1.35 * r} ${1.35 * r}l${-1.35 * r} ${1.35 * r}` +
                  `l${-1.35 * r} ${-1.35 * r}z`);
    case 'plus': return line(`M${x - 1.2 * r} ${y}h${2.4 * r}M${x} ${y - 1.2 * r}v${2.4 * r}`);
    case 'cross': return line(`M${x - r} ${y - r}l${2 * r} ${2 * r}M${x - r} ${y + r}l${2 * r} ${-2 * r}`);
    case 'star':
      return line(`M${x - 1.2 * r} ${y}h${2.4 * r}M${x - .7 * r} ${y - 1.1 * r}l${1.4 * r} ${2.2 * r}` +
                  `M${x + .7 * r} ${y - 1.1 * r}l${-1.4 * r} ${2.2 * r}`);
    default: return `<circle cx="${x}" cy="${y}" r="${r}" fill="${fill}" stroke="${colour}" stroke-width="1.6"/>`;
  }
}

// ------------------------------------------------------------------------------------------------ tone mapping

const srgb = v => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
const TONES = {
  filmic: {
    name: 'filmic (the engine\'s)',
    of: v => {
      const x = 0.6 * v;
      return Number.isFinite(x * x) ? x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14) : 1;
    },
  },
  linear: {name: 'linear, cut at 1', of: v => v},
  reinhard: {name: 'v / (1 + v)', of: v => (Number.isFinite(v) ? v / (1 + v) : 1)},
};
const MAPS = {
  picture: {name: 'picture'},
  signed: {name: 'signed difference', unit: 'radiance', stops: SIGNED},
  relative: {name: 'relative difference', unit: 'of sqrt(r\u00b2 + epsilon m\u00b2)', stops: SIGNED},
  flip: {name: 'FLIP', unit: '', stops: SEQUENTIAL},
  z: {name: 'z-score', unit: 'standard errors; grey: noise explains it (below 3)', stops: SIGNED},
};
// Rounding: of halves, in which pictures of the raster techniques are drawn.
const LIMIT_OF_NOISE = 3, ROUNDING = 2 ** -11;

// ------------------------------------------------------------------------------------ costs and errors of rows

const COSTS = {
  ms: {name: 'time of a picture, ms', of: row => row.ms},
  setup: {
    name: 'time of a picture with set-up, ms',
    of: row => (row.ms === null || row.setup_ms === null ? null : row.ms + row.setup_ms),
  },
  cpu_ms: {name: 'processor time of a picture, ms', of: row => row.cpu_ms},
};
/// of: a row's error; spread: its standard error; floor: three standard errors of the reference, null where none is
/// known.
const METRICS = {
  l2: {
    name: 'relative L2 of scattered light',
    of: r => r.l2,
    spread: r => r.l2_error,
    floor: r => 3 * r.noise_l2,
    seeds: 'l2',
  },
  nrmse: {name: 'NRMSE', of: r => r.nrmse, spread: r => r.nrmse_error, floor: r => 3 * r.noise_nrmse, seeds: 'nrmse'},
  relmse: {
    name: 'relative MSE',
    of: r => r.relmse,
    spread: r => r.relmse_error,
    floor: r => 9 * r.noise_relmse,
    seeds: 'relmse',
    isSquare: true,
  },
  flip: {name: 'FLIP (mean)', of: r => r.flip, spread: () => null, floor: () => null, seeds: null},
  bias: {
    name: 'bias, absolute',
    of: r => Math.abs(r.relative_bias),
    spread: r => Math.abs(r.bias_error * r.relative_bias / r.bias),
    floor: r => 3 * Math.abs(r.bias_error * r.relative_bias / r.bias),
    seeds: null,
  },
  inside: {
    name: 'relative L2 inside the model',
    of: r => (r.inside_model || {}).l2,
    spread: r => (r.inside_model || {}).l2_error,
    floor: r => (r.inside_model ? 3 * r.inside_model.noise_l2 : null),
    seeds: null,
  },
};
const isNumber = v => typeof v === 'number' && Number.isFinite(v);
function atNoise(row, metric) {
  if (metric === 'bias') return !!row.bias_at_noise;
  if (metric === 'flip') return false;
  if (metric === 'relmse') return METRICS.relmse.of(row) < (METRICS.relmse.floor(row) || 0) && !!row.at_noise;
  return !!(metric === 'inside' ? (row.inside_model || {}).at_noise : row.at_noise);
}
/// What a row is drawn and ranked at: its error, or the least that the reference can tell.
function ranked(row, metric) {
  const value = atNoise(row, metric) ? METRICS[metric].floor(row) : METRICS[metric].of(row);
  return isNumber(value) ? value : NaN;
}
function spreadOf(row, metric) {
  const s = atNoise(row, metric) ? 0 : METRICS[metric].spread(row);
  return isNumber(s) ? s : 0;
}
/// "12.3 %", or "< 0.4 % (noise)" where the reference cannot tell, as the tables have it.
function errorText(row, metric) {
  const value = METRICS[metric].of(row);
  if (!isNumber(value)) return '';
  return atNoise(row, metric) ? `< ${percent(METRICS[metric].floor(row))} (noise)` : percent(value);
}
/// The standard error of a median [order statistics]; 0 where there is none.
function medianError(values) {
  if (!Array.isArray(values) || values.length < 2) return 0;
  const mean = values.reduce((a, b) => a + b, 0) / values.length;
  const deviation = Math.sqrt(values.reduce((a, b) => a + (b - mean) ** 2, 0) / (values.length - 1));
  return deviation * (values.length === 3 ? 0.67 : Math.sqrt(1.5708 / values.length));
}
const costError = (row, cost) => medianError(cost === 'cpu_ms' ? (row.seeds || {}).cpu_ms : row.wall_ms_samples);
const isBelow = (a, ea, b, eb) => a < b && b - a > 2 * Math.hypot(ea, eb);
/// The front by a test, as engine/measure/front.hpp has it: settings of a technique must be on the front inside their
/// model first.
function frontOf(rows, cost, metric) {
  const pointOf = (row, index) => ({
    index,
    cost: COSTS[cost].of(row),
    error: ranked(row, metric),
    costError: costError(row, cost),
    spread: spreadOf(row, metric),
  });
  const points = rows.map(pointOf)
    .filter(p => isNumber(p.cost) && isNumber(p.error) && (metric === 'inside' || rows[p.index].inside_front));
  points.sort((a, b) => a.cost - b.cost || a.error - b.error || a.index - b.index);
  const kept = [];
  for (const p of points) if (kept.every(q => isBelow(p.error, p.spread, q.error, q.spread))) kept.push(p);
  const isBeaten = p => kept.some(q => isBelow(q.error, q.spread, p.error, p.spread) &&
    !isBelow(p.cost, p.costError, q.cost, q.costError));
  return kept.filter(p => !isBeaten(p)).map(p => p.index);
}
/// Error of a series at a cost: log-log between the points around it. {value, spread, interpolated}, or null outside
/// of the sweep.
function errorAt(points, cost) {
  for (let i = 0; i < points.length; ++i) {
    const a = points[i];
    if (Math.abs(a.cost / cost - 1) < 1e-9) return {value: a.error, spread: a.spread, interpolated: false};
    const b = points[i + 1];
    if (!b || !(a.cost < cost && cost < b.cost)) continue;
    const f = Math.log(cost / a.cost) / Math.log(b.cost / a.cost);
    const value = Math.exp((1 - f) * Math.log(a.error) + f * Math.log(b.error));
    const spread = value * Math.hypot((1 - f) * a.spread / a.error, f * b.spread / b.error);
    return {value, spread, interpolated: true};
  }
  return null;
}
/// Cost at which a series first gets down to an error: the point, or log-log between the points around it.
function costAt(points, error) {
  for (let i = 0; i < points.length; ++i) {
    const b = points[i], a = points[i - 1];
    if (b.error > error) continue;
    if (!a) return {value: b.cost, spread: b.costError, interpolated: false, atMost: b.error < error};
    const slope = Math.log(b.cost / a.cost) / Math.log(b.error / a.error);
    const f = Math.log(error / a.error) / Math.log(b.error / a.error);
    const value = a.cost * (b.cost / a.cost) ** f;
    const ofError = Math.abs(slope) * Math.hypot((1 - f) * a.spread / a.error, f * b.spread / b.error);
    const spread = value * Math.hypot(ofError, (1 - f) * a.costError / a.cost, f * b.costError / b.cost);
    return {value, spread, interpolated: f < 1 - 1e-9, atMost: false};
  }
  return null;
}

// ------------------------------------------------------------------------------------------------ steps and tables

/// Of every decade from 10^first to 10^last, these multiples.
function decadeSteps(first, last, multiples) {
  const list = [];
  for (let d = first; d <= last; ++d)
    for (const m of multiples) list.push(Number(`${m}e${d}`));
  return list;
}
/// Steps for a table between the least and the largest of some values; told: the series that have an entry at a step.
function tableSteps(values, count, told) {
  // 1, 2 and 5 of every decade between them, or finer ones where those are few, at which there is something to tell.
  const low = Math.min(...values), high = Math.max(...values);
  let list = [];
  for (const multiples of [[1, 2, 5], [1, 1.5, 2, 3, 5, 7]]) {
    list = decadeSteps(Math.floor(Math.log10(low)), Math.log10(high), multiples)
      .filter(v => v >= low * (1 - 1e-9) && v <= high * (1 + 1e-9) && told(v).length);
    if (list.length >= 4) break;
  }
  // At most `count`: those that tell of most series that the others do not, then of most.
  const kept = [], known = new Set();
  while (kept.length < count && list.length) {
    const worth = v => told(v).length + 100 * told(v).filter(name => !known.has(name)).length;
    const best = list.reduce((x, y) => (worth(y) > worth(x) ? y : x));
    kept.push(best);
    told(best).forEach(name => known.add(name));
    list.splice(list.indexOf(best), 1);
  }
  return kept.sort((x, y) => x - y);
}
/// A table with a line for each series that has entries, and a note that names the others.
function equalTable(kind, cost, heads, rows, cell) {
  const hasEntry = s => s.entries.some(e => e);
  const cellOf = e => (e ? `<td data-value="${e.value}">${cell(e)}</td>` : '<td>\u2013</td>');
  const lineOf = s => `<tr><td>${escapeText(s.series)}</td>${s.entries.map(cellOf).join('')}</tr>`;
  const others = rows.filter(s => !hasEntry(s)).map(s => s.series).join(', ');
  return `<div class="scroll" tabindex="0"><table class="${kind}" data-cost="${cost}">` +
    `<tr><th>series</th>${heads.map(v => `<th>${v}</th>`).join('')}</tr>` +
    `${rows.filter(hasEntry).map(lineOf).join('')}</table></div>` +
    (others ? `<p class="note">No entry: ${escapeText(others)}.</p>` : '');
}
/// Of text that lies on lines and bands.
const HALO = 'stroke="#fff" stroke-width="3" paint-order="stroke"';
// ------------------------------------------------------------------------------------------------ page elements

function add(parent, tag, name, html) {
  const e = document.createElement(tag);
  if (name) e.className = name;
  if (html) e.innerHTML = html;
  parent.appendChild(e);
  return e;
}
/// A selection with its title; the first option is chosen.
function addChoice(parent, title, options, change) {
  const span = add(parent, 'span', '', escapeText(title)), select = add(span, 'select');
  select.setAttribute('aria-label', title);
  const [first] = Object.keys(options);
  for (const [key, o] of Object.entries(options)) select.add(new Option(o.name, key, false, key === first));
  select.addEventListener('change', () => { change(select.value); });
  return select;
}
/// Text on a dark ground; it ends at x where it is aligned right.
function drawCaption(g, {text, x, y, align, room}) {
  g.font = '12px system-ui, sans-serif';
  g.textAlign = align;
  const w = Math.min(g.measureText(text).width + 10, room);
  g.fillStyle = 'rgba(0,0,0,.72)';
  g.fillRect(align === 'left' ? x : x - w, y, w, 19);
  g.fillStyle = '#fff';
  g.fillText(text, align === 'left' ? x + 5 : x - 5, y + 14, room - 10);
}

// ------------------------------------------------------------------------------------------------ a figure

const figures = [];
let active = null;

class Figure {
  constructor(root) {
    this.root = root;
    this.facts = JSON.parse(root.querySelector('script[type="application/json"]').textContent);
    this.rows = this.facts.rows;
    [this.width, this.height] = this.facts.picture_size;
    this.planes = {};
    for (const element of root.querySelectorAll('script[data-plane]')) this.planes[element.dataset.plane] = element;
    // 0, -1, ...: the references, by one of which each method is judged. From 1 on, methods: the front from its
    // fastest on, then the best of each sweep, then the others, in the order of the sweeps.
    const pictures = this.facts.pictures, rowOf = i => this.rows[pictures[i].row];
    const all = [...pictures.keys()];
    const front = all.filter(i => rowOf(i).pareto).sort((a, b) => rowOf(a).front - rowOf(b).front);
    const others = all.filter(i => !front.includes(i));
    const rest = [true, false].flatMap(first => others.filter(i => pictures[i].first_choice === first));
    const itemOf = i => ({picture: i, row: pictures[i].row, reference: pictures[i].reference});
    this.items = [null, ...front.concat(rest).map(itemOf)];
    this.order = [...this.facts.references.map((reference, t) => 0 - t), ...[...this.items.keys()].slice(1)];
    this.seriesNames = [...new Set(this.rows.map(r => r.series))];
    this.state = {
      current: Math.min(1, this.items.length - 1), before: 0, mode: 'single', flipped: false, chosen: [],
      map: 'picture', stops: 0, tone: 'filmic', zoom: 0, x: this.width / 2, y: this.height / 2,
      cursor: {x: this.width >> 1, y: this.height >> 1}, wipe: 0.5, ranges: {}, lock: true, cost: 'ms', metric: 'l2',
      crops: [], selected: this.items.length > 1 ? this.items[1].row : 0,
    };
    const first = [...this.items.keys()].slice(1, 4), judges = first.map(i => this.judgeOf(i));
    this.state.chosen = [...new Set([...(first.length ? judges : [0]), ...first])];
    this.cache = new Map();
    this.decoded = {};
    this.build();
    this.chooseCrops();
    this.drawPlot();
    this.drawTables();
    this.select(this.state.selected);
    this.draw();
  }

  label(i) { return i <= 0 ? this.facts.references[-i].name : this.rows[this.items[i].row].label; }
  /// The reference that a method is judged by; of a reference, itself.
  judgeOf(i) { return i <= 0 ? i : 0 - this.items[i].reference; }
  style(series) {
    const i = this.seriesNames.indexOf(series);
    const round = Math.floor(i / PALETTE.length);
    return {
      colour: PALETTE[i % PALETTE.length],
      mark: MARKS[(i + 3 * round) % MARKS.length],
      dash: DASHES[round % DASHES.length],
    };
  }

  // ---------------------------------------------------------------- pixels
  once(key, make) { return key in this.decoded ? this.decoded[key] : (this.decoded[key] = make()); }
  text(name) { return this.once('text ' + name, () => this.planes[name].textContent); }
  bytes(name) { return bytesOf(this.planes[name].textContent); }
  /// Some of them, without the others: a base64 digit has six bits.
  bytesAt(name, first, count) {
    const digits = this.text(name).slice(4 * Math.floor(first / 3), 4 * Math.ceil((first + count) / 3));
    return bytesOf(digits).slice(first % 3, first % 3 + count);
  }
  reference(t) { return this.once('reference' + t, () => new Float32Array(this.bytes('r' + t).buffer)); }
  referenceError(t) {
    const scale = this.facts.references[t].error_scale;
    return scale === null ? null : this.once('error' + t, () => halves(this.bytes(`r${t}e`), scale));
  }
  /// Pictures that found no room are means over blocks of pixels: their values, for each pixel.
  spread(values, block, channels) {
    if (block === 1) return values;
    const across = Math.ceil(this.width / block), result = new Float32Array(channels * this.width * this.height);
    for (let y = 0, at = 0; y < this.height; ++y)
      for (let x = 0; x < this.width; ++x)
        for (let c = 0; c < channels; ++c)
          result[at++] = values[channels * (Math.floor(y / block) * across + Math.floor(x / block)) + c];
    return result;
  }
  /// Means over such blocks; or, with squares, standard errors of those means.
  blocks(values, block, squares) {
    const across = Math.ceil(this.width / block), down = Math.ceil(this.height / block);
    const sums = new Float64Array(3 * across * down), counts = new Float64Array(across * down);
    for (let y = 0, at = 0; y < this.height; ++y)
      for (let x = 0; x < this.width; ++x) {
        const k = Math.floor(y / block) * across + Math.floor(x / block);
        ++counts[k];
        for (let c = 0; c < 3; ++c, ++at) sums[3 * k + c] += squares ? values[at] ** 2 : values[at];
      }
    const mean = (sum, j) => (squares ? Math.sqrt(sum) : sum) / counts[Math.floor(j / 3)];
    return this.spread(Float32Array.from(sums, mean), block, 3);
  }
  picture(i) { return this.facts.pictures[this.items[i].picture]; }
  difference(i) {
    const p = this.picture(i), plane = 'p' + this.items[i].picture;
    return this.once('difference' + i, () => this.spread(halves(this.bytes(plane), p.scale), p.block, 3));
  }
  ownError(i) {
    const p = this.picture(i), plane = `p${this.items[i].picture}e`;
    if (p.error_scale === null) return null;
    return this.once('own' + i, () => this.spread(halves(this.bytes(plane), p.error_scale), p.block, 3));
  }
  flipMap(i) {
    const p = this.picture(i), plane = `p${this.items[i].picture}f`;
    return p.flip ? this.once('flip' + i, () => this.spread(this.bytes(plane), p.block, 1)) : null;
  }
  /// The reference of a method, and its standard error, in the method's blocks.
  referenceOf(i) {
    const t = this.items[i].reference, block = this.picture(i).block;
    if (block === 1) return this.reference(t);
    return this.once(`reference ${t} by ${block}`, () => this.blocks(this.reference(t), block, false));
  }
  referenceErrorOf(i) {
    const t = this.items[i].reference, block = this.picture(i).block, e = this.referenceError(t);
    return block === 1 || !e ? e : this.once(`error ${t} by ${block}`, () => this.blocks(e, block, true));
  }
  pixels(i) {
    if (i <= 0) return this.reference(-i);
    return this.once('pixels' + i, () => {
      const d = this.difference(i), t = this.referenceOf(i), result = new Float32Array(d.length);
      for (let k = 0; k < d.length; ++k) result[k] = this.sum(t[k], d[k]);
      return result;
    });
  }
  /// A difference has 11 bits: a sum of fewer than its last is 0.
  sum(t, d) { return Math.abs(t + d) < Math.abs(d) / 1024 ? 0 : t + d; }
  /// A value of a map; NaN where there is none. Luminances: of the difference, the reference, its standard error (null:
  /// unknown), the method's own. Standard errors of channels, which share their paths, add up as if wholly dependent.
  mapOf(i, map, d, t, e, own, flip) {
    switch (map) {
      case 'signed': return d;
      case 'relative': {
        const mean = this.meanLuminance(this.items[i].reference);
        return d / Math.sqrt(t ** 2 + this.facts.relmse_epsilon * mean ** 2);
      }
      case 'flip': return flip;
      case 'z': {
        if (e === null) return NaN;
        // Where nothing is sampled, as in a plain sky, what is left is rounding.
        const s = Math.hypot(e, own, ROUNDING * t);
        return s > 0 ? d / s : d === 0 ? 0 : d > 0 ? Infinity : -Infinity;
      }
    }
    return NaN;
  }
  mapValue(i, map, k) {
    const e = this.referenceErrorOf(i), own = this.ownError(i), f = this.flipMap(i);
    const d = luminance(this.difference(i), k), t = luminance(this.referenceOf(i), k);
    return this.mapOf(i, map, d, t, e && luminance(e, k), own ? luminance(own, k) : 0, f ? f[k] / 255 : NaN);
  }
  /// A pixel of a method that may not be decoded yet: its values, and those of all maps.
  pixel(i, k) {
    const p = this.picture(i), name = 'p' + this.items[i].picture, x = k % this.width, y = Math.floor(k / this.width);
    const at = Math.floor(y / p.block) * Math.ceil(this.width / p.block) + Math.floor(x / p.block);
    const three = (plane, scale) => halves(this.bytesAt(plane, 6 * at, 6), scale);
    const d = three(name, p.scale), t = this.referenceOf(i), e = this.referenceErrorOf(i);
    const own = p.error_scale === null ? 0 : luminance(three(name + 'e', p.error_scale), 0);
    const flip = p.flip ? this.bytesAt(name + 'f', at, 1)[0] / 255 : NaN;
    const result = {values: Array.from(d, (v, c) => this.sum(t[3 * k + c], v))};
    for (const map of ['signed', 'relative', 'z', 'flip'])
      result[map] = this.mapOf(i, map, luminance(d, 0), luminance(t, k), e && luminance(e, k), own, flip);
    return result;
  }
  meanLuminance(t) {
    return this.once('mean' + t, () => {
      const p = this.reference(t);
      let sum = 0;
      for (let k = 0; k < this.width * this.height; ++k) sum += luminance(p, k);
      return sum / (this.width * this.height);
    });
  }
  values(i, map) {
    return this.once(`values ${map} ${i}`, () => {
      const v = new Float32Array(this.width * this.height);
      for (let k = 0; k < v.length; ++k) v[k] = this.mapValue(i, map, k);
      return v;
    });
  }
  /// The range that shows most of a map: 99 % of its values, rounded up to 1, 2 or 5 times a power of ten.
  fittingRange(i, map) {
    if (map === 'flip') return 1;
    if (map === 'z') return 10;
    const sorted = Float32Array.from(this.values(i, map), Math.abs).filter(Number.isFinite).sort();
    return roundUp(sorted[Math.floor(0.99 * (sorted.length - 1))]);
  }
  /// Locked: one range for all methods, until it is changed. Not locked: that of the method that is shown.
  range(i, map) {
    const s = this.state;
    if (s.lock) return s.ranges[map] || (s.ranges[map] = this.fittingRange(Math.max(1, s.current), map));
    return s.ranges[map + i] || this.fittingRange(i, map);
  }
  scaleRange(factor) {
    const s = this.state, i = this.shown();
    if (s.map === 'picture' || i <= 0) return;
    s.ranges[s.lock ? s.map : s.map + i] = this.range(i, s.map) * factor;
  }

  /// A method as a small canvas of the pictures' size.
  canvasOf(i, map = this.state.map) {
    const s = this.state, real = i <= 0 ? 'picture' : map, range = real === 'picture' ? 0 : this.range(i, real);
    const key = `${i} ${real} ${real === 'picture' ? s.stops + s.tone : range}`;
    if (this.cache.has(key)) return this.cache.get(key);
    if (this.cache.size > 40) this.cache.delete(this.cache.keys().next().value);
    const canvas = document.createElement('canvas'), context = canvas.getContext('2d');
    canvas.width = this.width, canvas.height = this.height;
    const image = context.createImageData(this.width, this.height), out = image.data, n = this.width * this.height;
    if (real === 'picture') {
      const p = this.pixels(i), exposure = this.facts.exposure * 2 ** s.stops, tone = TONES[s.tone].of;
      for (let k = 0; k < n; ++k) {
        const finite = Number.isFinite(p[3 * k] + p[3 * k + 1] + p[3 * k + 2]);
        for (let c = 0; c < 3; ++c) {
          const toned = tone(Math.max(exposure * p[3 * k + c], 0));
          out[4 * k + c] = finite ? Math.round(255 * srgb(Math.min(Math.max(toned, 0), 1))) : NOT_FINITE[c];
        }
        out[4 * k + 3] = 255;
      }
    } else {
      const v = this.values(i, real), stops = MAPS[real].stops;
      const colourOf = value => {
        if (Number.isNaN(value)) return NOT_FINITE;
        if (real === 'z' && Math.abs(value) < LIMIT_OF_NOISE) return NOISE;
        return colourAt(stops, stops === SIGNED ? 0.5 + 0.5 * value / range : value / range);
      };
      for (let k = 0; k < n; ++k) {
        const colour = colourOf(v[k]);
        out.set(colour, 4 * k);
        out[4 * k + 3] = 255;
      }
    }
    context.putImageData(image, 0, 0);
    this.cache.set(key, canvas);
    return canvas;
  }

  // ---------------------------------------------------------------- page elements
  build() {
    const root = this.root;
    root.tabIndex = 0;
    root.setAttribute('role', 'application');
    root.setAttribute('aria-label', `Figure: ${this.facts.title}. Press question mark for keys.`);
    this.buildBar(add(root, 'div', 'lf-bar'));
    const main = add(root, 'div', 'lf-main');
    this.buildList(add(main, 'div'));
    this.buildViewer(add(main, 'div'));
    this.buildHelp();

    // The plot, what it says of the selected row, tables, crops.
    const plotted = add(root, 'div');
    plotted.hidden = !this.rows.some(row => isNumber(row.ms));  // two pictures alone have no times
    add(plotted, 'h3', '', 'Error against time');
    this.buildAxes(add(plotted, 'div', 'lf-bar'));
    const columns = add(root, 'div', 'lf-columns');
    this.plotBox = add(columns, 'div', 'lf-plot');
    this.factsBox = add(columns, 'div', 'lf-facts');
    this.tableBox = add(root, 'div', 'lf-tables');
    add(root, 'h3', '', 'Crops');
    this.cropBox = add(root, 'div', 'lf-crops');
    this.plotBox.hidden = this.tableBox.hidden = plotted.hidden;
    root.addEventListener('focusin', () => { activate(this); });
    root.addEventListener('pointerdown', () => { activate(this); });
  }
  /// Buttons and selections over the pictures; each button is for a key.
  buildBar(bar) {
    this.buttons = {};
    const group = title => add(bar, 'span', '', escapeText(title));
    const button = (parent, key, text, action) => {
      const b = add(parent, 'button');
      b.textContent = text;
      b.type = 'button';
      b.title = `key ${key}`;
      b.addEventListener('click', () => { this.press(key); });
      this.buttons[action] = b;
    };
    const view = group('View');
    button(view, 'v', 'one', 'single');
    button(view, 'w', 'wipe', 'wipe');
    button(view, 's', 'side by side', 'side');
    button(view, 'f', 'flip', 'flip');
    const choose = (title, options, change) => addChoice(bar, title, options, value => {
      change(value);
      this.draw();
    });
    this.mapSelect = choose('Map', MAPS, v => { this.state.map = v; });
    this.toneSelect = choose('Tone map', TONES, v => { this.state.tone = v; });
    const exposure = group('Exposure');
    button(exposure, 'e', '\u2212', 'darker');
    this.stops = add(exposure, 'output');
    button(exposure, 'E', '+', 'brighter');
    const range = group('Range');
    button(range, '[', '\u2212', 'narrower');
    button(range, ']', '+', 'wider');
    button(range, 'l', 'lock over methods', 'lock');
    const zoom = group('Zoom');
    button(zoom, '-', '\u2212', 'out');
    button(zoom, '+', '+', 'in');
    button(zoom, 'r', 'fit', 'fit');
    const crop = group('Crops');
    button(crop, 'c', 'at the cursor', 'crop');
    button(crop, 'C', 'one less', 'cropAway');
    button(crop, 'A', 'automatic', 'cropsAuto');
    const save = group('Save');
    button(save, 'x', 'figure SVG', 'svg');
    button(save, 'X', 'plot SVG', 'plotSvg');
    button(save, 'd', 'data CSV', 'csv');
    button(save, 'L', 'LaTeX', 'latex');
    button(save, 'P', 'print, PDF', 'print');
    button(group(''), '?', 'keys', 'help');
  }
  /// The references and methods, to choose one and to take it into the set of side by side and crops.
  buildList(parent) {
    this.list = add(parent, 'div', 'lf-list');
    this.list.setAttribute('role', 'listbox');
    this.list.setAttribute('aria-label', 'Methods');
    this.list.tabIndex = 0;
    this.list.addEventListener('keydown', event => {
      const step = {ArrowUp: -1, ArrowDown: 1}[event.key];
      if (!step || event.shiftKey) return;
      event.preventDefault();
      const at = this.order.indexOf(this.state.current) + step;
      if (at in this.order) this.show(this.order[at]);
    });
    const membership = '<span class="set" title="in side by side and crops, or not: key a"></span>';
    for (const i of this.order) {
      const line = add(this.list, 'div'), key = i >= 0 && i <= 9 ? `<kbd>${i}</kbd>` : '<span></span>';
      line.setAttribute('role', 'option');
      line.id = `figure-${figures.length}-${i}`;
      line.dataset.item = i;
      if (i > 0) {
        const row = this.rows[this.items[i].row], style = this.style(row.series);
        line.innerHTML = `${key}<svg width="14" height="14">${mark(style.mark, 7, 7, 4, style.colour)}</svg>` +
          `<span>${escapeText(row.label)}${row.pareto ? ' \u2605' : ''}</span>${membership}`;
      } else {
        line.innerHTML = `${key}<span></span><span>${escapeText(this.label(i))}</span>${membership}`;
      }
      line.addEventListener('click', event => {
        this.show(i);
        if (event.target.className === 'set') this.press('a');
      });
    }
    const missing = this.rows.length - this.items.length + 1;
    if (missing > 0)
      add(parent, 'div', 'none', `${missing} rows without pictures: measured before pictures were kept`);
  }
  /// The pictures, the scale of their map, what they are, and the values under the cursor.
  buildViewer(parent) {
    this.canvas = add(add(parent, 'div', 'lf-view'), 'canvas');
    this.canvas.setAttribute('role', 'img');
    this.scaleBar = add(parent, 'div', 'lf-scale');
    this.status = add(parent, 'div', 'lf-status');
    this.status.setAttribute('aria-live', 'polite');
    this.valuesBox = add(parent, 'div', 'lf-values');
    this.bindPointer();
  }
  buildHelp() {
    const keysOf = k => k.keys.map(x => `<kbd>${escapeText(x.label || x)}</kbd>`).join(' ');
    const list = KEYS.map(k => `<div><dt>${keysOf(k)}</dt><dd>${escapeText(k.help)}</dd></div>`).join('');
    this.help = add(this.root, 'details', 'lf-help', `<summary>Keys</summary><dl class="keys">${list}</dl>`);
  }
  buildAxes(bar) {
    const choose = (title, options, change) => addChoice(bar, title, options, value => {
      change(value);
      this.drawPlot();
      this.drawTables();
    });
    this.costSelect = choose('Cost', COSTS, v => { this.state.cost = v; });
    this.metricSelect = choose('Error', METRICS, v => { this.state.metric = v; });
  }

  // ---------------------------------------------------------------- view
  shown() { return this.state.flipped && this.state.mode !== 'side' ? this.state.before : this.state.current; }
  show(i) {
    const s = this.state;
    if (!this.order.includes(i)) return;
    if (i !== s.current) s.before = s.current;
    s.current = i;
    s.flipped = false;
    if (i > 0) this.select(this.items[i].row);
    this.draw();
  }
  panes() {
    const s = this.state;
    if (s.mode === 'side') return s.chosen.length ? s.chosen : [s.current];
    return [this.shown()];
  }
  layout() {
    const box = this.canvas.parentElement.clientWidth || 800, panes = this.panes(), n = panes.length;
    const columns = n <= 1 ? 1 : n === 2 || n === 4 ? 2 : 3, lines = Math.ceil(n / columns);
    // All of it on the screen, beside the bars above and the values below.
    const most = Math.max(300, 0.7 * window.innerHeight / lines);
    const paneWidth = box / columns, paneHeight = Math.min(paneWidth * this.height / this.width, most);
    const scale = this.state.zoom || Math.min(paneWidth / this.width, paneHeight / this.height);
    return {columns, lines, paneWidth, paneHeight, width: box, height: lines * paneHeight, scale};
  }
  /// What a pane shows: the method, its map, its error.
  describe(i) {
    if (i <= 0) return this.label(i);
    const map = this.state.map === 'picture' ? '' : `: ${MAPS[this.state.map].name}`;
    return `${this.label(i)}${map}, L2 ${errorText(this.rows[this.items[i].row], 'l2')}`;
  }
  draw() {
    const l = this.layout(), ratio = window.devicePixelRatio || 1, canvas = this.canvas;
    canvas.style.height = l.height + 'px';
    canvas.width = Math.round(l.width * ratio), canvas.height = Math.round(l.height * ratio);
    const g = canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.imageSmoothingEnabled = false;
    const captions = [];  // above what is drawn over the pictures
    this.panes().forEach((i, p) => {
      const left = p % l.columns * l.paneWidth, top = Math.floor(p / l.columns) * l.paneHeight;
      captions.push(...this.drawPane(g, l, i, left, top));
    });
    for (const caption of captions) drawCaption(g, caption);
    this.updateControls();
    this.drawStatus(l);
    this.drawScale();
    this.drawValues();
    this.drawCrops();
  }
  /// A method in its pane, or two with the wipe between them, with crops and the cursor. Returns the pane's captions.
  drawPane(g, l, i, left, top) {
    const s = this.state, captions = [];
    if (s.mode === 'wipe') {
      const at = s.wipe * l.paneWidth, room = l.paneWidth / 2 - 4;
      this.drawPicture(g, l, s.before, left, top, 0, at);
      this.drawPicture(g, l, s.current, left, top, at, l.paneWidth);
      g.fillStyle = '#fff';
      g.fillRect(left + at - 1, top, 2, l.paneHeight);
      g.fillStyle = '#000';
      g.fillRect(left + at + 1, top, 1, l.paneHeight);
      captions.push({text: this.describe(s.before), x: left, y: top, align: 'left', room});
      captions.push({text: this.describe(s.current), x: left + l.paneWidth, y: top, align: 'right', room});
    } else {
      this.drawPicture(g, l, i, left, top, 0, l.paneWidth);
      captions.push({text: this.describe(i), x: left, y: top, align: 'left', room: l.paneWidth});
    }
    s.crops.forEach((c, k) => this.drawFrame(g, l, left, top, c, cropColour(k), 2, String(k + 1)));
    this.drawFrame(g, l, left, top, {x: s.cursor.x, y: s.cursor.y, width: 1, height: 1}, '#fff', 1);
    return captions;
  }
  /// The part of a picture that lies between two places across its pane.
  drawPicture(g, l, i, left, top, from, to) {
    const s = this.state;
    g.save();
    g.beginPath();
    g.rect(left + from, top, to - from, l.paneHeight);
    g.clip();
    const x = left + l.paneWidth / 2 - s.x * l.scale, y = top + l.paneHeight / 2 - s.y * l.scale;
    g.drawImage(this.canvasOf(i), x, y, this.width * l.scale, this.height * l.scale);
    g.restore();
  }
  /// A rectangle of the picture, outlined in its pane, with a number in its corner.
  drawFrame(g, l, left, top, rectangle, colour, width, text) {
    const x = left + l.paneWidth / 2 + (rectangle.x - this.state.x) * l.scale;
    const y = top + l.paneHeight / 2 + (rectangle.y - this.state.y) * l.scale;
    const w = rectangle.width * l.scale, h = rectangle.height * l.scale;
    g.save();
    g.beginPath();
    g.rect(left, top, l.paneWidth, l.paneHeight);
    g.clip();
    g.strokeStyle = '#000';
    g.lineWidth = width + 2;
    g.strokeRect(x, y, w, h);
    g.strokeStyle = colour;
    g.lineWidth = width;
    g.strokeRect(x, y, w, h);
    if (text) {
      g.font = 'bold 12px system-ui, sans-serif';
      g.textAlign = 'left';
      g.fillStyle = '#000';
      g.fillRect(x - 1, y + h - 16, 15, 17);
      g.fillStyle = '#fff';
      g.fillText(text, x + 3, y + h - 3);
    }
    g.restore();
  }
  /// Buttons, selections and the list show the state.
  updateControls() {
    const s = this.state;
    for (const mode of ['single', 'wipe', 'side'])
      this.buttons[mode].setAttribute('aria-pressed', String(s.mode === mode));
    this.buttons.flip.setAttribute('aria-pressed', String(s.flipped));
    this.buttons.lock.setAttribute('aria-pressed', String(s.lock));
    this.mapSelect.value = s.map;
    this.toneSelect.value = s.tone;
    this.stops.textContent = `${s.stops >= 0 ? '+' : ''}${s.stops} EV`;
    for (const line of this.list.querySelectorAll('[data-item]')) {
      const i = Number(line.dataset.item);
      line.setAttribute('aria-selected', String(i === this.shown()));
      line.querySelector('.set').textContent = s.chosen.includes(i) ? '\u25a3' : '\u25a1';
      if (i !== this.shown()) continue;
      this.list.setAttribute('aria-activedescendant', line.id);
      // In sight in the list, without a jump of the page.
      const low = line.offsetTop - this.list.offsetTop, high = low + line.offsetHeight - this.list.clientHeight;
      this.list.scrollTop = Math.max(high, Math.min(low, this.list.scrollTop));
    }
  }
  drawStatus(l) {
    const s = this.state, text = this.panes().map(i => this.describe(i)).join('; ');
    this.canvas.setAttribute('aria-label', text);
    const told = s.mode === 'wipe' ? `left: ${this.describe(s.before)}; right: ${this.describe(s.current)}` : text;
    this.status.textContent = `${told}. Zoom ${short(l.scale)}${this.blockNote()}`;
  }
  blockNote() {
    const most = Math.max(...this.panes().map(i => this.facts.block * (i > 0 ? this.picture(i).block : 1)));
    if (!(most > 1)) return '.';
    return `. Pixels are means over up to ${most} x ${most}, for want of room; ` +
      'figures in tables are of the whole picture.';
  }
  drawScale() {
    const s = this.state, i = s.mode === 'side' ? s.chosen.find(k => k > 0) || 0 : this.shown() || s.before;
    this.scaleBar.innerHTML = '';
    if (s.map === 'picture' || i <= 0) return;
    const range = this.range(i, s.map), stops = MAPS[s.map].stops, low = stops === SIGNED ? -range : 0;
    const canvas = document.createElement('canvas');
    canvas.width = 320, canvas.height = 1;
    const g = canvas.getContext('2d');
    for (let x = 0; x < 320; ++x) {
      const value = low + (range - low) * (x + 0.5) / 320;
      const isNoise = s.map === 'z' && Math.abs(value) < LIMIT_OF_NOISE;
      g.fillStyle = `rgb(${isNoise ? NOISE : colourAt(stops, (x + 0.5) / 320)})`;
      g.fillRect(x, 0, 1, 1);
    }
    const span = text => {
      const e = document.createElement('span');
      e.textContent = text;
      return e;
    };
    const {name, unit} = MAPS[s.map];
    const note = `${name}${unit ? ', ' + unit : ''}${s.lock ? '; range locked over methods' : ''}`;
    this.scaleBar.append(span(short(low)), canvas, span(short(range)), span(note));
  }
  drawValues() {
    const {x, y} = this.state.cursor, k = y * this.width + x;
    const three = (p, j = k) => [0, 1, 2].map(c => `<td>${short(p[3 * j + c], 5)}</td>`).join('');
    const columns = [`pixel ${x}, ${y}`, 'R', 'G', 'B', 'luminance', 'difference', 'relative', 'z-score', 'FLIP'];
    const none = '<td></td><td></td><td></td><td></td>';
    let html = `<table><tr>${columns.map(c => `<th>${c}</th>`).join('')}</tr>`;
    this.facts.references.forEach((reference, i) => {
      const p = this.reference(i), error = this.referenceError(i);
      html += `<tr class="marked"><td>${escapeText(reference.name)}</td>${three(p)}` +
        `<td>${short(luminance(p, k), 5)}</td>${none}</tr>`;
      if (!error) return;
      html += `<tr><td>its standard error</td>${three(error)}<td>${short(luminance(error, k), 3)}</td>${none}</tr>`;
    });
    this.items.forEach((item, i) => {
      if (i === 0) return;
      const p = this.pixel(i, k), shown = i === this.shown() ? ' class="marked"' : '';
      html += `<tr${shown}><td>${escapeText(this.label(i))}</td>${three(p.values, 0)}` +
        `<td>${short(luminance(p.values, 0), 5)}</td><td>${short(p.signed)}</td><td>${percent(p.relative)}</td>` +
        `<td>${short(p.z)}</td><td>${short(p.flip)}</td></tr>`;
    });
    this.valuesBox.innerHTML = html + '</table>';
  }
  pixelAt(event) {
    const r = this.canvas.getBoundingClientRect(), l = this.layout(), s = this.state;
    const x = (event.clientX - r.left) % l.paneWidth, y = (event.clientY - r.top) % l.paneHeight;
    return {
      x: s.x + (x - l.paneWidth / 2) / l.scale,
      y: s.y + (y - l.paneHeight / 2) / l.scale,
      paneX: x / l.paneWidth,
    };
  }
  moveCursor(x, y) {
    this.state.cursor = {x: within(x, this.width), y: within(y, this.height)};
  }
  zoomBy(factor, x, y) {
    const s = this.state, old = this.layout().scale, next = Math.min(Math.max(old * factor, 0.25), 64);
    if (x !== undefined) s.x = x - (x - s.x) * old / next, s.y = y - (y - s.y) * old / next;
    s.zoom = next;
  }
  bindPointer() {
    let drag = null, waiting = false;
    const later = () => {
      if (waiting) return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        this.draw();
      });
    };
    this.canvas.addEventListener('pointerdown', event => {
      this.root.focus({preventScroll: true});
      const p = this.pixelAt(event), s = this.state;
      drag = {
        x: event.clientX,
        y: event.clientY,
        wipe: s.mode === 'wipe' && Math.abs(p.paneX - s.wipe) < 0.03,
        crop: event.shiftKey ? {from: p, index: s.crops.length} : null,
      };
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener('pointerup', () => { drag = null; });
    this.canvas.addEventListener('pointermove', event => {
      const p = this.pixelAt(event), s = this.state;
      if (drag && drag.crop) s.crops[drag.crop.index] = this.cropBetween(drag.crop.from, p);
      else if (drag && drag.wipe) s.wipe = Math.min(Math.max(p.paneX, 0), 1);
      else if (drag) {
        const scale = this.layout().scale;
        s.x -= (event.clientX - drag.x) / scale, s.y -= (event.clientY - drag.y) / scale;
        drag.x = event.clientX, drag.y = event.clientY;
      } else this.moveCursor(p.x, p.y);
      later();
    });
    this.canvas.addEventListener('wheel', event => {
      event.preventDefault();
      const p = this.pixelAt(event);
      this.zoomBy(event.deltaY < 0 ? 1.25 : 0.8, p.x, p.y);
      later();
    }, {passive: false});
  }

  // ---------------------------------------------------------------- the selected row
  select(index) {
    const row = this.rows[index], f = this.facts;
    this.state.selected = index;
    const item = this.items.findIndex(it => it && it.row === index);
    const isEmpty = value => value === undefined || value === null || value === '';
    const line = (name, value) => (isEmpty(value) ? '' : `<div><dt>${escapeText(name)}</dt><dd>${value}</dd></div>`);
    const command = (name, text, note) => {
      if (!text) return '';
      const words = text.split(' ').map(word => `<span>${escapeText(word)}</span>`).join(' ');
      const copy = `<button type="button" data-copy="${escapeText(text)}">copy</button>`;
      const below = note ? `<br><span class="note">${escapeText(note)}</span>` : '';
      return line(name, `<code>${words}</code> ${copy}${below}`);
    };
    const milliseconds = value => (isNumber(value) ? `${short(value, 4)} ms` : '');
    const wall = Array.isArray(row.wall_ms_spread) ? row.wall_ms_spread.map(v => short(v)) : null;
    const error = metric => {
      const spread = spreadOf(row, metric);
      return escapeText(errorText(row, metric)) + (spread > 0 ? ` \u00b1 ${percent(spread, 2)}` : '');
    };
    const bias = `${percent(row.relative_bias)}${row.bias_at_noise ? ' (0)' : ''}`;
    const settings = [...(row.settings || []), ...(row.deviations || [])].join(' ');
    this.factsBox.innerHTML = `<strong>${escapeText(row.label)}</strong>` +
      (item < 0 ? '<p class="note">No picture of this row is on the page.</p>' : '') + '<dl>' +
      // Costs and errors.
      line('picture', milliseconds(row.ms) + (isNumber(row.ms) && wall ? ` (${wall[0]} .. ${wall[1]})` : '')) +
      line('set-up', milliseconds(row.setup_ms)) +
      line('processor time', milliseconds(row.cpu_ms)) +
      line('relative L2', error('l2')) +
      line('NRMSE', error('nrmse')) +
      line('inside its model', error('inside')) +
      line('bias', isNumber(row.relative_bias) ? bias : '') +
      line('relative MSE', short(row.relmse)) +
      line('FLIP', short(row.flip)) +
      line('GPU memory', isNumber(row.gpu_bytes) ? `${short(row.gpu_bytes / 1048576, 4)} MiB` : '') +
      // What was run, and where.
      line('settings', escapeText(settings)) +
      line('fidelity', escapeText(row.fidelity || '')) +
      line('seeds', row.seeds ? escapeText(row.seeds.seed.join(', ')) : '') +
      line('program', escapeText(row.program || f.program || '')) +
      line('renderer', escapeText(row.renderer || f.renderer || '')) +
      line('driver', escapeText(row.driver || f.driver || '')) +
      line('CPU', escapeText(row.cpu || f.cpu || '')) +
      line('date', escapeText(row.date || '')) +
      command('measured by', row.command || f.command) +
      command('picture by', row.picture_command,
              'highlights, filtering and pixel centres as the program has them for pictures; ' +
              'the row is measured without highlights') +
      '</dl>';
    for (const b of this.factsBox.querySelectorAll('[data-copy]'))
      b.addEventListener('click', () => copyText(b.dataset.copy, b));
    for (const p of this.plotBox.querySelectorAll('.point'))
      p.querySelector('.ring').setAttribute('stroke', Number(p.dataset.row) === index ? '#000' : 'transparent');
  }

  // ---------------------------------------------------------------- plot
  seriesPoints(name) {
    const {cost, metric} = this.state;
    const pointOf = (row, index) => ({
      index,
      cost: COSTS[cost].of(row),
      error: ranked(row, metric),
      spread: spreadOf(row, metric),
      costError: costError(row, cost),
      noise: atNoise(row, metric),
    });
    return this.rows.map(pointOf)
      .filter(p => this.rows[p.index].series === name && p.cost > 0 && p.error > 0).sort((a, b) => a.cost - b.cost);
  }
  drawPlot() { this.plotBox.innerHTML = this.plotSvg(); this.bindPlot(); }
  /// Series that have points with both the cost and the error chosen.
  shownSeries() {
    return this.seriesNames.map(name => ({name, points: this.seriesPoints(name)})).filter(s => s.points.length);
  }
  /// Errors to compare with: baselines, and what the reference can tell at all.
  plotLevels(metric) {
    const levels = [];
    for (const y of this.facts.baselines || []) levels.push({value: METRICS[metric].of(y), name: y.label});
    const bounds = this.rows.map(r => METRICS[metric].floor(r)).filter(isNumber);
    if (bounds.length)
      levels.push({
        value: metric === 'inside' || metric === 'bias' ? Math.min(...bounds) : bounds[0],
        name: metric === 'bias' ? 'least 3 standard errors of a bias' : '3 \u00d7 noise of the reference',
      });
    return levels;
  }
  /// The plot's measures: where a cost (X) and an error (Y) lie in it, and how an error is written.
  plotFrame(points, levels) {
    const {cost, metric} = this.state, W = 900, H = 560, left = 78, right = 14, top = 14, bottom = 52;
    const ys = points.flatMap(p => [p.error, p.error - 1.96 * p.spread, p.error + 1.96 * p.spread])
      .concat(levels.map(v => v.value)).filter(v => v > 0);
    const xs = points.map(p => p.cost);
    const pad = (a, b) => {
      const d = Math.max(Math.log(b / a) * 0.05, 0.1);
      return [a * Math.exp(-d), b * Math.exp(d)];
    };
    const [x0, x1] = pad(Math.min(...xs), Math.max(...xs));
    const least = Math.max(Math.min(...ys), Math.min(...points.map(p => p.error)) / 10);
    const [y0, y1] = pad(least, Math.max(...ys));
    const X = v => left + (W - left - right) * Math.log(v / x0) / Math.log(x1 / x0);
    const Y = v => H - bottom - (H - top - bottom) * Math.log(v / y0) / Math.log(y1 / y0);
    const unit = METRICS[metric].isSquare || metric === 'flip' ? v => short(v) : v => short(100 * v) + ' %';
    return {cost, metric, W, H, left, right, top, bottom, x0, x1, y0, y1, X, Y, unit};
  }
  axesSvg(frame) {
    const {cost, metric, W, H, left, right, top, bottom, X, Y} = frame;
    const tics = (a, b) => {
      // Whole decades over many, finer steps over few.
      for (const steps of Math.log10(b / a) > 4 ? [[1]] : [[1, 2, 5], [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9]]) {
        const inside = decadeSteps(Math.floor(Math.log10(a)), Math.ceil(Math.log10(b)), steps)
          .filter(v => v >= a && v <= b);
        if (inside.length >= 4 || steps.length !== 3) return inside;
      }
      return [];
    };
    let out = '';
    for (const v of tics(frame.x0, frame.x1))
      out += `<path d="M${X(v)} ${top}V${H - bottom}" stroke="#e2e2e6"/>` +
        `<text x="${X(v)}" y="${H - bottom + 18}" text-anchor="middle">${short(v)}</text>`;
    for (const v of tics(frame.y0, frame.y1))
      out += `<path d="M${left} ${Y(v)}H${W - right}" stroke="#e2e2e6"/>` +
        `<text x="${left - 8}" y="${Y(v) + 4}" text-anchor="end">${frame.unit(v)}</text>`;
    const middle = {x: (left + W - right) / 2, y: (top + H - bottom) / 2};
    return out + `<path d="M${left} ${top}V${H - bottom}H${W - right}" fill="none" stroke="#333"/>` +
      `<text x="${middle.x}" y="${H - 10}" text-anchor="middle">${escapeText(COSTS[cost].name)}</text>` +
      `<text transform="translate(16 ${middle.y}) rotate(-90)" text-anchor="middle">` +
      `${escapeText(METRICS[metric].name)}</text>` +
      `<clipPath id="plot-area"><rect x="${left}" y="${top}" width="${W - left - right}" ` +
      `height="${H - top - bottom}"/></clipPath>`;
  }
  levelLines(frame, levels) {
    const line = (level, k) => `<path class="level" data-value="${level.value}" ` +
      `d="M${frame.left} ${frame.Y(level.value)}H${frame.W - frame.right}" ` +
      `stroke="#444" stroke-dasharray="${['8 4', '2 4', '10 3 2 3'][k % 3]}"/>`;
    return levels.map(line).join('');
  }
  /// Names of the levels, each at the end where fewer points are in the way.
  levelNames(frame, levels, points) {
    const {W, left, right, X, Y} = frame;
    const name = level => {
      const isNear = (p, at) => Math.abs(Y(p.error) - Y(level.value)) < 18 && Math.abs(X(p.cost) - at) < 180;
      const near = at => points.filter(p => isNear(p, at)).length;
      const atLeft = near(left) < near(W - right);
      return `<text x="${atLeft ? left + 4 : W - right - 4}" y="${Y(level.value) - 4}" ` +
        `text-anchor="${atLeft ? 'start' : 'end'}" font-size="11" fill="#444" ${HALO} pointer-events="none">` +
        `${escapeText(level.name)}</text>`;
    };
    return levels.map(name).join('');
  }
  /// The front, from its cheapest to its best.
  frontLine(frame, front) {
    const {cost, metric, X, Y} = frame;
    const line = front.map(i => ({x: X(COSTS[cost].of(this.rows[i])), y: Y(ranked(this.rows[i], metric))}))
      .sort((a, b) => a.x - b.x);
    if (line.length <= 1) return '';
    return `<path class="front" d="M${line.map(p => `${p.x} ${p.y}`).join('L')}" fill="none" stroke="#f0dc82" ` +
      'stroke-width="9" stroke-linejoin="round" stroke-linecap="round"/>';
  }
  frontNumbers(frame, front) {
    if (front.length <= 1) return '';
    const {cost, metric, X, Y} = frame;
    const number = (i, k) => `<text class="number" x="${X(COSTS[cost].of(this.rows[i]))}" ` +
      `y="${Y(ranked(this.rows[i], metric)) - 13}" text-anchor="middle" font-size="11" font-weight="bold" ` +
      `fill="#5f4b00" ${HALO} pointer-events="none">${k + 1}</text>`;
    return front.map(number).join('');
  }
  /// Slope -1/2 (-1 for squares) through the path tracer's first point: what independent samples give.
  guideLine(frame, series) {
    const {metric, left, top, x0, x1, y1, X, Y} = frame;
    const path = series.find(s => s.name === 'path'), slope = METRICS[metric].isSquare ? -1 : -0.5;
    if (!path || metric === 'bias') return '';
    const a = path.points[0], guide = v => Y(a.error * (v / a.cost) ** slope);
    const atTop = X(a.cost * (a.error / y1) ** (-1 / slope)), room = atTop > left + 70;
    return `<path class="guide" clip-path="url(#plot-area)" d="M${X(x0)} ${guide(x0)}L${X(x1)} ${guide(x1)}" ` +
      'stroke="#555" stroke-dasharray="2 5"/>' +
      `<text x="${room ? atTop - 6 : left + 8}" y="${room ? top + 14 : guide(x0) - 8}" ` +
      `text-anchor="${room ? 'end' : 'start'}" font-size="11" fill="#555" ${HALO}>slope ${slope}</text>`;
  }
  seriesLine(frame, s) {
    const {metric, y0, X, Y} = frame;
    const seeds = METRICS[metric].seeds, style = this.style(s.name), real = s.points.filter(p => !p.noise);
    let out = '';
    // A band over seeds where there are some: from the least to the largest.
    const seedsOf = p => this.rows[p.index].seeds[seeds].filter(isNumber);
    const banded = real.filter(p => seeds && this.rows[p.index].seeds && seedsOf(p).length > 1);
    if (banded.length > 1) {
      const ends = f => banded.map(p => `${X(p.cost)} ${Y(Math.max(f(...seedsOf(p)), y0))}`);
      out += '<path class="band" clip-path="url(#plot-area)" ' +
        `d="M${ends(Math.min).join('L')}L${ends(Math.max).reverse().join('L')}z" ` +
        `fill="${style.colour}" fill-opacity=".22"/>`;
    }
    if (real.length > 1)
      out += `<path d="M${real.map(p => `${X(p.cost)} ${Y(p.error)}`).join('L')}" fill="none" ` +
        `stroke="${style.colour}" stroke-width="1.5" stroke-dasharray="${style.dash}"/>`;
    return out;
  }
  pointSvg(frame, p, style, isOnFront) {
    const {y0, X, Y} = frame;
    const x = X(p.cost), y = Y(p.error), bar = 1.96 * p.spread;
    const error = `${p.noise ? 'below ' : ''}${frame.unit(p.error)}${isOnFront ? ', on the front' : ''}`;
    const label = escapeText(`${this.rows[p.index].label}: ${short(p.cost, 4)} ms, ${error}`);
    const ring = p.index === this.state.selected ? '#000' : 'transparent';
    return `<g class="point" tabindex="0" role="button" data-row="${p.index}" data-cost="${p.cost}" ` +
      `data-error="${p.error}" aria-label="${label}"><title>${label}</title>` +
      (bar > 0 ? `<path d="M${x} ${Y(p.error + bar)}V${Y(Math.max(p.error - bar, y0))}" ` +
        `stroke="${style.colour}" clip-path="url(#plot-area)"/>` : '') +
      `<circle class="ring" cx="${x}" cy="${y}" r="10" fill="transparent" stroke="${ring}" stroke-width="2"/>` +
      mark(style.mark, x, y, 4.6, style.colour, p.noise) +
      (p.noise ? `<path d="M${x} ${y + 7}v9m-3 -4l3 4l3 -4" fill="none" stroke="${style.colour}"/>` : '') + '</g>';
  }
  legendHtml(series) {
    const entry = s => {
      const style = this.style(s.name);
      return `<span><svg width="34" height="14"><path d="M0 7H34" stroke="${style.colour}" stroke-width="1.5" ` +
        `stroke-dasharray="${style.dash}"/>${mark(style.mark, 17, 7, 4, style.colour)}</svg> ` +
        `${escapeText(s.name)}</span>`;
    };
    return `<div class="lf-legend">${series.map(entry).join('')}` +
      '<span>wide pale line with numbers: the front by a test (two standard errors); ' +
      'hollow with an arrow: below the reference\u2019s noise; ' +
      'bands: least to largest of the seeds; bars: 95 %</span></div>';
  }
  plotSvg() {
    const {cost, metric} = this.state, series = this.shownSeries(), all = series.flatMap(s => s.points);
    if (!all.length) return '<p>No row has both this cost and this error.</p>';
    const levels = this.plotLevels(metric), frame = this.plotFrame(all, levels), {W, H} = frame;
    const shownLevels = levels.filter(v => v.value >= frame.y0 && v.value <= frame.y1);
    const front = frontOf(this.rows, cost, metric);
    const title = [this.facts.title, METRICS[metric].name].map(escapeText).join(': ');
    let out = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${W} ${H}" width="${W}" height="${H}" ` +
      'font-family="system-ui, sans-serif" font-size="13">' +
      `<title>${title} against ${escapeText(COSTS[cost].name)}</title><rect width="${W}" height="${H}" fill="#fff"/>`;
    out += this.axesSvg(frame) + this.levelLines(frame, shownLevels);
    out += this.frontLine(frame, front) + this.guideLine(frame, series);
    for (const s of series) out += this.seriesLine(frame, s);
    for (const s of series)
      for (const p of s.points) out += this.pointSvg(frame, p, this.style(s.name), front.includes(p.index));
    // Numbers and names last, on a halo: lines and bands of the series lie below them.
    out += this.frontNumbers(frame, front) + this.levelNames(frame, shownLevels, all);
    return out + '</svg>' + this.legendHtml(series);
  }
  bindPlot() {
    const points = [...this.plotBox.querySelectorAll('.point')];
    for (const p of points) {
      const pick = () => {
        const row = Number(p.dataset.row), item = this.items.findIndex(it => it && it.row === row);
        if (item > 0) this.show(item);
        else this.select(row);
      };
      p.addEventListener('click', pick);
      p.addEventListener('keydown', event => {
        if (event.key !== 'Enter' && event.key !== ' ') return;
        event.preventDefault();
        event.stopPropagation();
        pick();
      });
    }
  }

  // ---------------------------------------------------------------- tables of equal time and equal error
  tableData() {
    const keep = this.state.cost, result = {};
    for (const cost of ['ms', 'setup']) {
      this.state.cost = cost;
      result[cost] = this.tablesOf(cost);
    }
    this.state.cost = keep;
    return result;
  }
  /// The tables of the cost that is chosen.
  tablesOf(cost) {
    const series = this.seriesNames.map(name => ({name, points: this.seriesPoints(name).filter(p => !p.noise)}))
      .filter(s => s.points.length);
    const all = series.flatMap(s => s.points);
    if (!all.length) return {times: [], errors: [], equalTime: [], equalError: [], unit: []};
    const reaches = (s, error) => {
      const at = costAt(s.points, error);
      return at && !at.atMost;
    };
    const namesOf = list => list.map(s => s.name);
    const times = tableSteps(all.map(p => p.cost), 6, v => namesOf(series.filter(s => errorAt(s.points, v))));
    const errors = tableSteps(all.map(p => p.error), 6, v => namesOf(series.filter(s => reaches(s, v)))).reverse();
    const path = series.find(s => s.name === 'path');
    const costEntry = (s, error) => {
      const at = costAt(s.points, error), of = path && costAt(path.points, error);
      return at && {...at, speedUp: of && !of.atMost && !at.atMost ? of.value / at.value : null};
    };
    return {
      times,
      errors,
      equalTime: series.map(s => ({series: s.name, entries: times.map(t => errorAt(s.points, t))})),
      equalError: series.map(s => ({series: s.name, entries: errors.map(e => costEntry(s, e))})),
      unit: series.filter(s => s.name === 'path').map(s => this.timeToUnitVariance(s, cost)),
    };
  }
  /// Time to unit variance [Mueller2016]: what an unbiased estimator needs for a relative variance of 1, time times
  /// variance; the mean over its points from 32 samples on, or over all where it has none.
  timeToUnitVariance(s, cost) {
    const long = s.points.filter(p => (this.rows[p.index].spp || 0) >= 32), points = long.length ? long : s.points;
    // Set-up is there once, however many samples follow.
    const timeOf = r => r.ms * r.nrmse ** 2 + (cost === 'setup' ? r.setup_ms : 0);
    const of = points.map(p => this.rows[p.index]).map(timeOf).filter(isNumber);
    if (!of.length) return {series: s.name, value: null};
    const mean = of.reduce((a, b) => a + b, 0) / of.length;
    const squares = of.reduce((a, b) => a + (b - mean) ** 2, 0);
    const spread = of.length > 1 ? Math.sqrt(squares / (of.length - 1) / of.length) : 0;
    return {series: s.name, value: mean, spread, points: of.length};
  }
  drawTables() {
    const data = this.tableData(), metric = this.state.metric;
    const value = METRICS[metric].isSquare || metric === 'flip' ? v => short(v) : v => percent(v);
    const range = (e, f) => {
      if (!(e.spread > 0)) return '';
      const low = f(Math.max(0, e.value - 1.96 * e.spread)).replace('\u00a0%', '');
      return ` <span class="note">(${low} .. ${f(e.value + 1.96 * e.spread)})</span>`;
    };
    const errorCell = e => `${e.interpolated ? '~' : ''}${value(e.value)}${range(e, value)}`;
    const costCell = e => {
      const sign = e.atMost ? '\u2264 ' : e.interpolated ? '~' : '';
      return `${sign}${short(e.value)}${range(e, short)}${e.speedUp ? ` <b>\u00d7${short(e.speedUp)}</b>` : ''}`;
    };
    const metricName = escapeText(METRICS[metric].name);
    let html = '';
    for (const cost of ['ms', 'setup']) {
      const t = data[cost], costName = escapeText(COSTS[cost].name);
      if (!t.times.length) continue;
      const timeHeads = t.times.map(v => `${short(v)} ms`), errorHeads = t.errors.map(value);
      html += `<div class="lf-pair"><section><h3>Equal time: ${metricName} by ${costName}</h3>` +
        `${equalTable('equal-time', cost, timeHeads, t.equalTime, errorCell)}</section>` +
        `<section><h3>Equal error: ${costName} for ${metricName}</h3>` +
        `${equalTable('equal-error', cost, errorHeads, t.equalError, costCell)}</section></div>`;
      for (const u of t.unit) {
        if (u.value === null) continue;
        html += `<p>Time to unit variance, ${escapeText(u.series)}, ${costName}: ` +
          `<b data-unit="${cost}">${short(u.value)}</b>${u.spread > 0 ? ` \u00b1 ${short(u.spread, 2)}` : ''} ` +
          `(time \u00d7 NRMSE\u00b2${cost === 'setup' ? ' and set-up' : ''}, mean of ${u.points} points).</p>`;
      }
    }
    this.tableBox.innerHTML = html + '<p class="note">~: log-log between two points of the series. ' +
      '\u2264: its first point is better already. ' +
      '\u2013: the sweep does not get there, or ends at the reference\u2019s noise. ' +
      'In brackets: 95 %, from the reference\u2019s noise, seeds and times. ' +
      '\u00d7: how many times faster than path tracing at that error.</p>';
  }

  // ---------------------------------------------------------------- crops
  /// Where the methods of the front disagree most, or a single one with the reference: windows of a sixth of the width
  /// with the largest sum of their luminances' relative variance, which do not overlap.
  chooseCrops() {
    const methods = [...this.items.keys()].filter(i => i > 0 && this.rows[this.items[i].row].pareto).slice(0, 8);
    const {width: w, height: h} = this.cropSize();
    const use = methods.length > 1 ? methods : this.items.map((it, i) => i).slice(1, 5);
    if (!use.length || this.width < w || this.height < h) return;
    const t = this.reference(0), ps = [...use.map(i => this.pixels(i)), ...(use.length === 1 ? [t] : [])];
    const epsilon = this.facts.relmse_epsilon * this.meanLuminance(0) ** 2;
    // Summed areas, with a column and a row of zeros before the first.
    const across = this.width + 1, sums = new Float64Array(across * (this.height + 1));
    for (let y = 0; y < this.height; ++y)
      for (let x = 0; x < this.width; ++x) {
        const k = y * this.width + x;
        let mean = 0, squares = 0;
        for (const p of ps) {
          const v = luminance(p, k);
          mean += v / ps.length;
          squares += v * v / ps.length;
        }
        const v = (squares - mean * mean) / (luminance(t, k) ** 2 + epsilon);
        const own = Number.isFinite(v) ? Math.min(Math.max(v, 0), 1) : 0;
        sums[(y + 1) * across + x + 1] =
          own + sums[y * across + x + 1] + sums[(y + 1) * across + x] - sums[y * across + x];
      }
    for (let k = 0; k < 3; ++k) {
      let best = null;
      for (let y = 0; y + h <= this.height; ++y)
        for (let x = 0; x + w <= this.width; ++x) {
          const overlaps = c => x < c.x + c.width && c.x < x + w && y < c.y + c.height && c.y < y + h;
          if (this.state.crops.some(overlaps)) continue;
          const at = (u, v) => sums[v * across + u];
          const sum = at(x + w, y + h) - at(x, y + h) - at(x + w, y) + at(x, y);
          if (!best || sum > best.sum) best = {x, y, width: w, height: h, sum};
        }
      if (best) this.state.crops.push(best);
    }
  }
  /// A new crop: a sixth of the picture's width, three quarters of that high.
  cropSize() {
    const width = Math.max(4, Math.round(this.width / 6));
    return {width, height: Math.max(4, Math.min(this.height, Math.round(width * 0.75)))};
  }
  cropAround(x, y) {
    const {width, height} = this.cropSize();
    return {
      x: Math.min(Math.max(x - (width >> 1), 0), this.width - width),
      y: Math.min(Math.max(y - (height >> 1), 0), this.height - height),
      width,
      height,
    };
  }
  /// The pixels of a rectangle between two points of the picture.
  cropBetween(a, b) {
    const x = within(Math.min(a.x, b.x), this.width), y = within(Math.min(a.y, b.y), this.height);
    const width = within(Math.max(a.x, b.x), this.width) - x + 1;
    const height = within(Math.max(a.y, b.y), this.height) - y + 1;
    return {x, y, width, height};
  }
  cropCanvas(i, c) {
    const canvas = document.createElement('canvas');
    const scale = Math.max(1, Math.round(300 / c.width));
    canvas.width = c.width * scale, canvas.height = c.height * scale;
    const g = canvas.getContext('2d');
    g.imageSmoothingEnabled = false;
    g.drawImage(this.canvasOf(i), c.x, c.y, c.width, c.height, 0, 0, canvas.width, canvas.height);
    return canvas;
  }
  /// Relative L2 of a crop, of the pictures as they are.
  cropError(i, c) {
    const d = this.difference(i), t = this.referenceOf(i);
    let a = 0, b = 0;
    for (let y = c.y; y < c.y + c.height; ++y)
      for (let x = c.x; x < c.x + c.width; ++x)
        for (let k = 0; k < 3; ++k) {
          const at = 3 * (y * this.width + x) + k;
          a += d[at] ** 2;
          b += t[at] ** 2;
        }
    return Math.sqrt(a / b);
  }
  drawCrops() {
    this.cropBox.innerHTML = '';
    const set = this.state.chosen.slice(0, 6), box = this.cropBox.clientWidth || 1100;
    // As many crops beside each other as leave their pictures 150 pixels.
    const widthOf = beside => (box - 26 * (beside - 1)) / beside / Math.max(set.length, 1) - 8;
    let beside = Math.max(this.state.crops.length, 1);
    while (beside > 1 && widthOf(beside) < 150) --beside;
    this.cropBox.style.setProperty('--crop', `${Math.max(100, Math.min(260, Math.floor(widthOf(beside))))}px`);
    for (const [k, c] of this.state.crops.entries()) {
      const line = document.createElement('div');
      line.className = 'lf-crop-line';
      this.cropBox.append(line);
      for (const i of set) {
        const figure = document.createElement('figure'), canvas = this.cropCanvas(i, c);
        const caption = document.createElement('figcaption');
        canvas.style.borderColor = cropColour(k);
        caption.textContent = `${k + 1}: ${this.label(i)}${i > 0 ? `, L2 ${percent(this.cropError(i, c))}` : ''}`;
        canvas.setAttribute('role', 'img');
        canvas.setAttribute('aria-label', caption.textContent);
        figure.append(canvas, caption);
        line.append(figure);
      }
    }
  }

  // ---------------------------------------------------------------- exports
  figureSvg() {
    const set = this.state.chosen.slice(0, 6), cw = 150, gap = 8;
    const scale = cw / this.width, ph = this.height * scale;
    let y = gap, out = '';
    set.forEach((i, k) => {
      const x = gap + k * (cw + gap);
      out += `<image x="${x}" y="${y}" width="${cw}" height="${ph}" image-rendering="pixelated" ` +
        `href="${this.canvasOf(i).toDataURL()}"/>`;
      this.state.crops.forEach((c, n) => {
        out += `<rect x="${x + c.x * scale}" y="${y + c.y * scale}" ` +
          `width="${c.width * scale}" height="${c.height * scale}" fill="none" stroke="${cropColour(n)}"/>`;
      });
      const row = i > 0 ? this.rows[this.items[i].row] : null;
      const figures = row ? `${isNumber(row.ms) ? short(row.ms) + ' ms, ' : ''}L2 ${errorText(row, 'l2')}` : '';
      [...linesOf(this.label(i), 32, 2), figures].forEach((text, n) => {
        out += `<text x="${x}" y="${y + ph + 13 + 12 * n}" font-size="9">${escapeText(text)}</text>`;
      });
    });
    y += ph + 46;
    this.state.crops.forEach((c, n) => {
      const h = cw * c.height / c.width;
      set.forEach((i, k) => {
        const x = gap + k * (cw + gap);
        const place = `x="${x}" y="${y}" width="${cw}" height="${h}"`;
        out += `<image ${place} image-rendering="pixelated" href="${this.cropCanvas(i, c).toDataURL()}"/>` +
          `<rect ${place} fill="none" stroke="${cropColour(n)}" stroke-width="2"/>`;
      });
      y += h + gap;
    });
    const width = gap + set.length * (cw + gap);
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${y}" width="${width}" height="${y}" ` +
      `font-family="sans-serif"><title>${escapeText(this.facts.title)}</title>` +
      `<rect width="100%" height="100%" fill="#fff"/>${out}</svg>`;
  }
  csv() {
    const isPlain = v => typeof v !== 'object' || v === null;
    const keys = [...new Set(this.rows.flatMap(r => Object.keys(r).filter(k => isPlain(r[k]))))];
    const cell = v => {
      if (v === null || v === undefined) return '';
      return typeof v === 'string' ? `"${v.replace(/"/g, '""')}"` : String(v);
    };
    return [keys.join(','), ...this.rows.map(r => keys.map(k => cell(r[k])).join(','))].join('\n') + '\n';
  }
  latex() {
    const {cost, metric} = this.state;
    const commands = {'\\': '\\textbackslash{}', '~': '\\textasciitilde{}', '^': '\\textasciicircum{}'};
    const tex = t => String(t).replace(/[\\&%$#_{}~^]/g, c => commands[c] || '\\' + c);
    const costName = tex(COSTS[cost].name), metricName = tex(METRICS[metric].name);
    let out = `% ${this.facts.title}; ${this.facts.command}\n% needs: booktabs, pgfplots\n` +
      '\\begin{tabular}{lrrr}\n\\toprule\n' + `method & ${costName} & ${metricName} & bias \\\\\n\\midrule\n`;
    for (const i of frontOf(this.rows, cost, metric)) {
      const r = this.rows[i], error = `${atNoise(r, metric) ? '$<$ ' : ''}${short(ranked(r, metric))}`;
      out += `${tex(r.label)} & ${short(COSTS[cost].of(r), 4)} & ${error} & ${short(r.relative_bias)} \\\\\n`;
    }
    out += '\\bottomrule\n\\end{tabular}\n\n\\begin{tikzpicture}\n' +
      `\\begin{loglogaxis}[xlabel={${costName}}, ylabel={${metricName}}, legend pos=outer north east]\n`;
    for (const name of this.seriesNames) {
      const points = this.seriesPoints(name).filter(p => !p.noise).map(p => `(${p.cost},${p.error})`);
      if (points.length) out += `\\addplot coordinates {${points.join(' ')}};\\addlegendentry{${tex(name)}}\n`;
    }
    return out + '\\end{loglogaxis}\n\\end{tikzpicture}\n';
  }
  /// The plot with its legend below it, as a file of its own.
  plotFile() {
    const svg = this.plotBox.querySelector('svg');
    if (!svg) return '';
    const shown = this.seriesNames.filter(name => this.seriesPoints(name).length), columns = 5, line = 19;
    const [, , width, height] = svg.getAttribute('viewBox').split(' ').map(Number);
    const legend = shown.map((name, k) => {
      const style = this.style(name), x = 20 + k % columns * (width - 20) / columns;
      const y = height + 12 + Math.floor(k / columns) * line;
      return `<path d="M${x} ${y}h34" stroke="${style.colour}" stroke-width="1.5" ` +
        `stroke-dasharray="${style.dash}"/>${mark(style.mark, x + 17, y, 4, style.colour)}` +
        `<text x="${x + 41}" y="${y + 4}" font-size="12">${escapeText(name)}</text>`;
    }).join('');
    const copy = svg.cloneNode(true), all = height + 12 + Math.ceil(shown.length / columns) * line;
    copy.setAttribute('viewBox', `0 0 ${width} ${all}`);
    copy.setAttribute('height', all);
    copy.querySelector('rect').setAttribute('height', all);
    return new XMLSerializer().serializeToString(copy).replace('</svg>', legend + '</svg>');
  }
  save(name, type, text) {
    lastSaved = {name, text};
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], {type}));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  /// Does what a key is for; false for keys that are for nothing here.
  press(key) {
    const found = KEYS.find(k => k.keys.some(x => (x.key || x) === key));
    if (!found) return false;
    found.run(this, key);
    return true;
  }
}

// ------------------------------------------------------ keys: the one list that help shows and that is obeyed

let lastSaved = null;
const cycle = (list, value, step = 1) => list[(list.indexOf(value) + step + list.length) % list.length];
const redraw = run => (f, key) => {
  run(f, key);
  f.draw();
};
const replot = run => f => {
  run(f);
  f.drawPlot();
  f.drawTables();
};
const DIRECTIONS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
const ARROWS = {ArrowLeft: '\u2190', ArrowRight: '\u2192', ArrowUp: '\u2191', ArrowDown: '\u2193'};
const arrows = prefix =>
  Object.keys(DIRECTIONS).map(k => ({key: prefix + k, label: (prefix ? 'Shift ' : '') + ARROWS[k]}));
const KEYS = [
  {keys: ['0'], help: 'the reference of this method; again: the next one, where methods are judged by several',
   run: f => {
     const at = f.state.current;
     f.show(at > 0 ? f.judgeOf(at) : 0 - (1 - at) % f.facts.references.length);
   }},
  {keys: ['1', '2', '3', '4', '5', '6', '7', '8', '9'], help: 'method 1 to 9 of the list',
   run: (f, k) => f.show(Number(k))},
  {keys: ['n', 'b'], help: 'next method, the one before',
   run: (f, k) => f.show(cycle(f.order, f.state.current, k === 'n' ? 1 : -1))},
  {keys: ['v'], help: 'one picture', run: redraw(f => { f.state.mode = 'single'; })},
  {keys: ['w'], help: 'wipe: the method before on the left, this one on the right',
   run: redraw(f => {
     f.state.mode = 'wipe';
     f.state.flipped = false;
   })},
  {keys: [',', '.'], help: 'move the wipe',
   run: redraw((f, k) => {
     f.state.wipe = Math.min(1, Math.max(0, f.state.wipe + (k === ',' ? -0.05 : 0.05)));
   })},
  {keys: ['s'], help: 'side by side, up to six', run: redraw(f => { f.state.mode = 'side'; })},
  {keys: ['a'], help: 'take this method into the set of side by side and crops, or out of it',
   run: redraw(f => {
     const s = f.state, at = s.chosen.indexOf(s.current);
     if (at >= 0) s.chosen.splice(at, 1);
     else if (s.chosen.length < 6) s.chosen.push(s.current);
   })},
  {keys: ['f'], help: 'flip to the method before and back',
   run: redraw(f => {
     f.state.flipped = !f.state.flipped;
     if (f.state.mode === 'side') f.state.mode = 'single';
   })},
  {keys: ['m', 'M'], help: 'next map, the one before: picture, signed, relative, FLIP, z-score',
   run: redraw((f, k) => { f.state.map = cycle(Object.keys(MAPS), f.state.map, k === 'm' ? 1 : -1); })},
  {keys: ['E', 'e'], help: 'exposure half a stop up, down',
   run: redraw((f, k) => { f.state.stops += k === 'E' ? 0.5 : -0.5; })},
  {keys: ['t'], help: 'next tone map', run: redraw(f => { f.state.tone = cycle(Object.keys(TONES), f.state.tone); })},
  {keys: [']', '['], help: 'range of the map doubled, halved',
   run: redraw((f, k) => f.scaleRange(k === ']' ? 2 : 0.5))},
  {keys: ['l'], help: 'one range for all methods, or each its own',
   run: redraw(f => { f.state.lock = !f.state.lock; })},
  {keys: ['+', '-'], help: 'zoom in, out, about the cursor',
   run: redraw((f, k) => f.zoomBy(k === '+' ? 1.25 : 0.8, f.state.cursor.x + 0.5, f.state.cursor.y + 0.5))},
  {keys: arrows(''), help: 'pan, all pictures in step',
   run: redraw((f, k) => {
     const [x, y] = DIRECTIONS[k], step = 40 / f.layout().scale;
     f.state.x += x * step;
     f.state.y += y * step;
   })},
  {keys: arrows('Shift+'), help: 'move the cursor by a pixel',
   run: redraw((f, k) => {
     const [x, y] = DIRECTIONS[k.slice(6)];
     f.moveCursor(f.state.cursor.x + x, f.state.cursor.y + y);
   })},
  {keys: ['r'], help: 'the whole picture again',
   run: redraw(f => {
     f.state.zoom = 0;
     f.state.x = f.width / 2;
     f.state.y = f.height / 2;
   })},
  {keys: ['c'], help: 'a crop around the cursor; or drag over the picture with Shift',
   run: redraw(f => { f.state.crops.push(f.cropAround(f.state.cursor.x, f.state.cursor.y)); })},
  {keys: ['C'], help: 'take the last crop away', run: redraw(f => { f.state.crops.pop(); })},
  {keys: ['A'], help: 'crops where methods disagree most',
   run: redraw(f => {
     f.state.crops = [];
     f.chooseCrops();
   })},
  {keys: ['k'], help: 'next cost of the plot: picture, with set-up, processor',
   run: replot(f => { f.costSelect.value = f.state.cost = cycle(Object.keys(COSTS), f.state.cost); })},
  {keys: ['y'], help: 'next error of the plot',
   run: replot(f => { f.metricSelect.value = f.state.metric = cycle(Object.keys(METRICS), f.state.metric); })},
  {keys: ['x'], help: 'save the figure (pictures and crops) as SVG',
   run: f => f.save('figure.svg', 'image/svg+xml', f.figureSvg())},
  {keys: ['X'], help: 'save the plot as SVG', run: f => f.save('plot.svg', 'image/svg+xml', f.plotFile())},
  {keys: ['d'], help: 'save all rows as CSV', run: f => f.save('rows.csv', 'text/csv', f.csv())},
  {keys: ['L'], help: 'save table and plot as LaTeX', run: f => f.save('figure.tex', 'text/x-tex', f.latex())},
  {keys: ['P'], help: 'print, or save as PDF', run: () => window.print()},
  {keys: ['p'], help: 'copy the command that measured the selected row',
   run: f => copyText(f.rows[f.state.selected].command || f.facts.command)},
  {keys: ['?'], help: 'show or hide this list', run: f => { f.help.open = !f.help.open; }},
];

let lastCopied = null;
function copyText(text, button) {
  lastCopied = text;
  const done = () => {
    if (!button) return;
    button.textContent = 'copied';
    setTimeout(() => { button.textContent = 'copy'; }, 1200);
  };
  const byHand = () => {
    const area = document.createElement('textarea');
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
    done();
  };
  if (navigator.clipboard && window.isSecureContext) navigator.clipboard.writeText(text).then(done, byHand);
  else byHand();
}

function activate(figure) {
  if (active === figure) return;
  active = figure;
  for (const f of figures) f.root.classList.toggle('lf-active', f === figure);
}
document.addEventListener('keydown', event => {
  if (!active || event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented) return;
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return;
  if (event.key.startsWith('Arrow') && event.target.closest('.scroll, pre')) return;  // they scroll there
  const key = event.key.startsWith('Arrow') && event.shiftKey ? 'Shift+' + event.key : event.key;
  if (active.press(key)) event.preventDefault();
});
for (const root of document.querySelectorAll('[data-figure]')) figures.push(new Figure(root));
if (figures.length) activate(figures[0]);
window.addEventListener('resize', () => figures.forEach(f => f.draw()));
// For tests: what the page holds, and when it was ready, ms after it began to load.
window.lucernaReport = {
  figures, KEYS, METRICS, COSTS, colours: {PALETTE, SIGNED, SEQUENTIAL, NOISE, colourAt}, frontOf, errorAt, costAt,
  ready: performance.now(),
  get lastCopied() { return lastCopied; },
  get lastSaved() { return lastSaved; },
};

})();
