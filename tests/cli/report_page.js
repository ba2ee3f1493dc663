// Drives a report's page in headless Chromium through its debugging pipe and checks it against the report's JSON.
// Usage: node report_page.js CHROMIUM PAGE.html REPORT.json [SCREENSHOT-PREFIX]
// The JSON is that of `bench error`, of `bench all` (whose first figure is driven) or of `compare` (whose page has one
// row).
// Prints a line a fault and ends with 1 where there is one; "N checks" and 0 otherwise.
'use strict';
const {spawn} = require('child_process');
const fs = require('fs'), os = require('os'), path = require('path');
const [chromium, page, jsonFile, prefix] = process.argv.slice(2);
const written = JSON.parse(fs.readFileSync(jsonFile, 'utf8').replace(/\bNaN\b/g, 'null'));
const json = Array.isArray(written.error) ? written.error[0] : written;

const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'lucerna-page-'));
const flags = ['--headless', '--no-sandbox', '--disable-gpu', '--hide-scrollbars', `--user-data-dir=${profile}`,
               '--remote-debugging-pipe', '--window-size=1280,1000', 'about:blank'];
const browser = spawn(chromium, flags, {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'], detached: true});
let next = 1, buffer = '';
const waiting = new Map(), events = [];
browser.stdio[4].on('data', data => {
  buffer += data;
  for (let end; (end = buffer.indexOf('\0')) >= 0; buffer = buffer.slice(end + 1)) {
    const message = JSON.parse(buffer.slice(0, end));
    if (message.id) {
      const w = waiting.get(message.id);
      waiting.delete(message.id);
      message.error ? w.reject(new Error(message.error.message)) : w.resolve(message.result);
    } else events.push(message);
  }
});
const send = (method, params = {}, sessionId = undefined) => new Promise((resolve, reject) => {
  waiting.set(next, {resolve, reject});
  browser.stdio[3].write(JSON.stringify({id: next++, method, params, sessionId}) + '\0');
});
const sleep = ms => new Promise(resolve => setTimeout(resolve, ms));

let checks = 0, faults = 0;
function check(condition, text) { ++checks; if (!condition) { ++faults; console.log('FAULT ' + text); } }
const near = (a, b, e) => Math.abs(a - b) <= e * Math.max(Math.abs(a), Math.abs(b), 1e-30);

// How far apart two sRGB colours are, 0..255 each, for eyes that lack one kind of cones [Machado2009, severity 1] or
// none: CIEDE2000 [Sharma2005].
const EYES = {
  normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
};
function labOf(rgb, eyes) {
  const linear = rgb.map(v => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
  const seen = row => row[0] * linear[0] + row[1] * linear[1] + row[2] * linear[2];
  const [r, g, b] = EYES[eyes].map(row => Math.min(1, Math.max(0, seen(row))));
  const f = t => (t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116);
  const x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}
function ciede2000([l1, a1, b1], [l2, a2, b2]) {
  const rad = Math.PI / 180, mean = (Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2;
  const g = 1.5 - 0.5 * Math.sqrt(mean ** 7 / (mean ** 7 + 25 ** 7));
  const c1 = Math.hypot(g * a1, b1), c2 = Math.hypot(g * a2, b2);
  const hue = (a, b) => (a === 0 && b === 0 ? 0 : (Math.atan2(b, a) / rad + 360) % 360);
  const h1 = hue(g * a1, b1), h2 = hue(g * a2, b2), grey = c1 * c2 === 0;
  const turn = grey ? 0 : (h2 - h1 + 540) % 360 - 180, dh = 2 * Math.sqrt(c1 * c2) * Math.sin(turn * rad / 2);
  const dl = l2 - l1, dc = c2 - c1, l = (l1 + l2) / 2, c = (c1 + c2) / 2;
  const h = grey ? h1 + h2 :
    Math.abs(h1 - h2) <= 180 ? (h1 + h2) / 2 : (h1 + h2 + (h1 + h2 < 360 ? 360 : -360)) / 2;
  const t = 1 - 0.17 * Math.cos((h - 30) * rad) + 0.24 * Math.cos(2 * h * rad) +
    0.32 * Math.cos((3 * h + 6) * rad) - 0.2 * Math.cos((4 * h - 63) * rad);
  const sl = 1 + 0.015 * (l - 50) ** 2 / Math.sqrt(20 + (l - 50) ** 2), sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
  const rt = -2 * Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7)) * Math.sin(60 * rad * Math.exp(-(((h - 275) / 25) ** 2)));
  return Math.sqrt((dl / sl) ** 2 + (dc / sc) ** 2 + (dh / sh) ** 2 + rt * dc / sc * dh / sh);
}

// Colours of methods and of maps stay apart for every kind of eyes, and no method is told by its colour alone.
async function colourChecks(evaluate) {
  // The formula itself, by three of Sharma's pairs.
  const pairs = [
    [[50, 2.6772, -79.7751], [50, 0, -82.7485], 2.0425],
    [[50, 2.5, 0], [73, 25, -18], 27.1492],
    [[60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644],
  ];
  for (const [a, b, expected] of pairs)
    check(Math.abs(ciede2000(a, b) - expected) < 1e-4, `CIEDE2000 ${ciede2000(a, b)} instead of ${expected}`);
  const {palette, signed, noise, styles} = await evaluate(`
    const {PALETTE, SIGNED, NOISE, colourAt} = report.colours;
    f.seriesNames.push(...Array.from({length: 24 - f.seriesNames.length}, (_, i) => 'another ' + i));
    const styles = f.seriesNames.map(name => f.style(name));
    f.seriesNames = f.seriesNames.filter(name => !name.startsWith('another '));
    const rgb = c => [1, 3, 5].map(i => parseInt(c.slice(i, i + 2), 16));
    const signed = [0, 0.25, 0.35, 0.65, 0.75, 1].map(t => colourAt(SIGNED, t));
    return {palette: PALETTE.map(rgb), signed, noise: NOISE, styles}`);
  check(palette.length >= 8, `a palette of ${palette.length}`);
  for (const eyes of Object.keys(EYES)) {
    const apart = (a, b) => ciede2000(labOf(a, eyes), labOf(b, eyes));
    const distance = (a, b) => apart(a, b).toFixed(1), white = [255, 255, 255];
    palette.forEach((a, i) => {
      palette.forEach((b, j) => {
        check(j >= i || apart(a, b) > 10, `${eyes}: colours ${j} and ${i} are ${distance(a, b)} apart`);
      });
      check(apart(a, white) > 20, `${eyes}: colour ${i} on white is ${distance(a, white)}`);
    });
    // Above and below the reference, and either from what noise explains, from 3 of 10 standard errors on.
    for (let k = 0; k < 3; ++k) {
      const below = signed[k], above = signed[5 - k];
      check(apart(below, above) > 20, `${eyes}: signs are ${distance(below, above)} apart at ${k}`);
    }
    signed.forEach(c => check(apart(c, noise) > 10, `${eyes}: noise and ${c} are ${distance(c, noise)} apart`));
  }
  // 24 series, more than any report has: each pair differs by its mark or by the dashes of its line.
  const plain = styles.map(s => `${s.mark} ${s.dash}`);
  check(styles.length === 24 && new Set(plain).size === 24, `marks and dashes ${plain}`);
}

// On a sheet of A4 nothing is cut off or distorted, nothing is dark but the pictures, and what cannot be used there is
// gone.
async function printChecks(call, evaluate) {
  const sheet = 703;  // 186 mm between margins of 12 mm
  await evaluate('f.state.mode = "side"; f.draw()');
  await call('Emulation.setEmulatedMedia', {media: 'print'});
  await call('Emulation.setDeviceMetricsOverride', {width: sheet, height: 1000, deviceScaleFactor: 1, mobile: false});
  const found = await evaluate(`
    const off = [], dark = [];
    for (const e of document.querySelectorAll('body *')) {
      const r = e.getBoundingClientRect(), name = e.tagName + '.' + e.className;
      if (!r.width || !r.height || e.closest('svg') !== null && e.tagName !== 'svg') continue;
      if (r.right > ${sheet} + 1 || r.left < -1) off.push(name + ' ' + Math.round(r.left) + '..' + Math.round(r.right));
      const [red, green, blue, alpha] = (getComputedStyle(e).backgroundColor.match(/[\\d.]+/g) || []).map(Number);
      if (alpha !== 0 && red + green + blue < 600) dark.push(name);
    }
    const shape = f.canvas.getBoundingClientRect();
    const controls = document.querySelectorAll('button, select, nav, .lf-list');
    return {
      off,
      dark,
      used: [...controls].filter(e => e.getClientRects().length).length,
      stretch: shape.width / shape.height / (f.canvas.width / f.canvas.height),
      crops: document.querySelectorAll('.lf-crops canvas').length,
    }`);
  check(found.off.length === 0, `cut off in print: ${found.off.slice(0, 5)}`);
  check(found.dark.length === 0, `dark in print: ${found.dark.slice(0, 5)}`);
  check(found.used === 0, `${found.used} controls are printed`);
  check(near(found.stretch, 1, 0.02), `pictures are stretched by ${found.stretch} in print`);
  check(found.crops > 0, 'no crops in print');
  await call('Emulation.clearDeviceMetricsOverride');
  await call('Emulation.setEmulatedMedia', {media: ''});
  const printed = await call('Page.printToPDF', {printBackground: true, preferCSSPageSize: true});
  const pdf = Buffer.from(printed.data, 'base64');
  const hasPages = /\/Type\s*\/Page\b/.test(pdf.toString('latin1'));
  check(pdf.subarray(0, 5).toString() === '%PDF-' && hasPages, 'a PDF with pages');
  await evaluate('f.state.mode = "single"; f.draw()');
}

// Tab alone comes to every control, which then shows that it has the focus; keys operate it.
async function tabChecks(call, evaluate, press, state) {
  const count = await evaluate(`
    const all = document.querySelectorAll('button, select, summary, a[href], [tabindex="0"]');
    window.controls = [...all].filter(e => e.getClientRects().length);
    document.activeElement.blur();
    window.scrollTo(0, 0);
    return controls.length`);
  await evaluate('document.body.tabIndex = -1; document.body.focus()');
  const reached = new Set();
  let bare = '';
  for (let k = 0; k < count + 5; ++k) {
    await press('Tab');
    const at = await evaluate(`
      const e = document.activeElement, s = getComputedStyle(e);
      const ring = e.querySelector && e.classList.contains('point') &&
        getComputedStyle(e.querySelector('.ring')).strokeWidth === '3px';
      const shown = s.outlineStyle !== 'none' || s.boxShadow !== 'none' || ring;
      return {index: controls.indexOf(e), tag: e.tagName + '.' + e.getAttribute('class'), shown}`);
    if (at.index < 0) continue;
    reached.add(at.index);
    if (!at.shown) bare = at.tag;
  }
  await evaluate('document.body.removeAttribute("tabindex")');
  const names = await evaluate(`
    return controls.map(e => e.tagName + '.' + e.getAttribute('class') + ' ' + e.textContent.slice(0, 20))`);
  const missed = names.filter((name, i) => !reached.has(i));
  check(count > 20 && missed.length === 0, `of ${count} controls Tab does not come to ${missed.slice(0, 5)}`);
  check(bare === '', `${bare} does not show that it has the focus`);
  await evaluate('f.buttons.wipe.focus()');
  await press(' ');
  check((await state()).mode === 'wipe', 'the space bar presses a button');
  await evaluate('f.buttons.single.focus()');
  await press('Enter');
  check((await state()).mode === 'single', 'Enter presses a button');
  await evaluate('f.state.map = "picture"; f.draw(); f.mapSelect.focus()');
  await press('ArrowDown');
  check((await state()).map === 'signed', `an arrow chooses the next map: ${(await state()).map}`);
  await press('ArrowUp');
  await evaluate('f.show(1); f.list.focus()');
  await press('ArrowUp');
  const above = await evaluate('return f.order[f.order.indexOf(1) - 1]');
  check((await state()).current === above, 'an arrow chooses what is above');
  await press('ArrowDown');
  check((await state()).current === 1, 'an arrow chooses the method below');
  await evaluate('f.root.focus()');
}

// What a mouse does: the wheel zooms about the pointer, a drag pans, with Shift it cuts a crop, on the wipe's edge it
// moves that.
async function mouseChecks(call, evaluate, state) {
  const wholePicture = 'f.state.zoom = 0; f.state.x = f.width / 2; f.state.y = f.height / 2; f.draw();';
  await evaluate(`f.state.mode = "single"; ${wholePicture} f.root.scrollIntoView()`);
  const box = await evaluate(`
    const r = f.canvas.getBoundingClientRect();
    return {x: r.x, y: r.y, width: r.width, height: r.height}`);
  const mouse = (type, u, v, more = {}) => call('Input.dispatchMouseEvent', {
    type,
    x: box.x + u * box.width,
    y: box.y + v * box.height,
    button: type === 'mouseMoved' || type === 'mouseWheel' ? 'none' : 'left',
    clickCount: 1,
    ...more,
  });
  const settled = () => evaluate(`
    return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))`);
  await mouse('mouseMoved', 0.5, 0.5);
  await settled();
  const cursor = (await state()).cursor, middle = await evaluate('return {x: f.width / 2, y: f.height / 2}');
  const isAtMiddle = Math.abs(cursor.x - middle.x) <= 1 && Math.abs(cursor.y - middle.y) <= 1;
  check(isAtMiddle, `the pointer's pixel is ${JSON.stringify(cursor)}`);
  const scale = await evaluate('return f.layout().scale');
  await mouse('mouseWheel', 0.5, 0.5, {deltaX: 0, deltaY: -100});
  await settled();
  check(near(await evaluate('return f.layout().scale'), 1.25 * scale, 1e-9), 'the wheel zooms in');
  const drag = async (from, to, modifiers = 0) => {
    await mouse('mousePressed', ...from, {modifiers, buttons: 1});
    await mouse('mouseMoved', ...to, {modifiers, buttons: 1, button: 'left'});
    await mouse('mouseReleased', ...to, {modifiers});
    await settled();
  };
  let before = await state();
  await drag([0.5, 0.5], [0.6, 0.5]);
  let after = await state();
  check(after.x < before.x && near(after.y, before.y, 1e-3), `a drag pans: ${before.x} to ${after.x}`);
  before = after;
  await drag([0.45, 0.45], [0.55, 0.6], 8);
  after = await state();
  const crop = after.crops[after.crops.length - 1];
  check(after.crops.length === before.crops.length + 1 && after.x === before.x && crop.width >= 1 &&
        crop.height > crop.width / 4, `a drag with Shift cuts a crop: ${JSON.stringify(crop)}`);
  await evaluate('f.state.crops.pop(); f.state.mode = "wipe"; f.state.wipe = 0.5; f.draw()');
  await drag([0.5, 0.5], [0.7, 0.5]);
  check(near((await state()).wipe, 0.7, 0.02), `a drag moves the wipe: ${(await state()).wipe}`);
  await evaluate(`f.state.mode = "single"; f.state.wipe = 0.5; ${wholePicture}`);
}

// A pair of pictures: one row, without times.
async function compareChecks(evaluate, press, state) {
  const rows = await evaluate('return f.rows');
  check(rows.length === 1, `${rows.length} rows`);
  for (const key of ['l2', 'nrmse', 'relmse', 'flip', 'bias', 'relative_bias'])
    check(near(rows[0][key], written[key], 1e-12), `${key} ${rows[0][key]} instead of ${written[key]}`);
  const shown = await evaluate(`f.select(0); return f.factsBox.textContent`);
  const figures = [
    ['relative L2', 100 * written.l2, 6e-3],
    ['NRMSE', 100 * written.nrmse, 6e-3],
    ['FLIP', written.flip, 6e-3],
  ];
  for (const [name, value, digits] of figures) {
    const found = shown.match(new RegExp(name + '\\s*(?:< )?(-?[0-9.e+-]+)')), text = found && found[1];
    check(found && near(Number(text), value, digits), `${name} is shown as ${text} instead of ${value}`);
  }
  const p = await evaluate(`
    const d = f.difference(1), t = f.reference(0);
    let s = 0, m = 0;
    for (let k = 0; k < d.length; ++k) {
      s += d[k] * d[k];
      m += t[k];
    }
    return {rmse: Math.sqrt(s / d.length), mean: m / d.length}`);
  check(near(p.rmse, written.rmse, 2e-3) && near(p.mean, written.reference_mean, 1e-3),
        `pixels: RMSE ${p.rmse} instead of ${written.rmse}, mean ${p.mean} instead of ${written.reference_mean}`);
  // The first crop is where they differ most, not in the black beside the scene.
  const crop = await evaluate(`
    const c = f.state.crops[0];
    if (!c) return null;
    const d = f.difference(1);
    let inside = 0;
    for (let y = c.y; y < c.y + c.height; ++y)
      for (let x = c.x; x < c.x + c.width; ++x) inside += d[3 * (y * f.width + x)] !== 0;
    return inside / (c.width * c.height)`);
  check(crop !== null && crop > 0.5, `the first crop shows ${crop} of differing pixels`);
  await evaluate('f.root.focus(); f.show(1)');
  const expected = [
    ['0', s => s.current === 0],
    ['1', s => s.current === 1],
    ['w', s => s.mode === 'wipe'],
    ['s', s => s.mode === 'side'],
    ['m', s => s.map === 'signed'],
    ['v', s => s.mode === 'single'],
  ];
  for (const [key, holds] of expected) {
    await press(key);
    check(holds(await state()), `key ${key}: ${JSON.stringify(await state())}`);
  }
}

// Every row is the JSON's.
async function rowChecks(evaluate) {
  const rows = await evaluate('return f.rows');
  check(rows.length === json.rows.length, `${rows.length} rows instead of ${json.rows.length}`);
  rows.forEach((row, i) => check(JSON.stringify(row) === JSON.stringify(json.rows[i]), `row ${i} is not the JSON's`));
  // What is shown of a row: the figures of its panel, to the digits that it has.
  for (let i = 0; i < rows.length; ++i) {
    const facts = await evaluate(`
      f.select(${i});
      const lines = [...f.factsBox.querySelectorAll('dl > div')];
      const text = (line, tag) => line.querySelector(tag).textContent;
      return Object.fromEntries(lines.map(d => [text(d, 'dt'), text(d, 'dd')]))`);
    const row = json.rows[i], number = text => parseFloat(String(text).replace(/^< /, ''));
    const expectFigure = (name, value, digits) => {
      check(near(number(facts[name]), value, digits), `${row.label}: ${name} ${facts[name]} against ${value}`);
    };
    expectFigure('picture', row.ms, 6e-4);
    expectFigure('set-up', row.setup_ms, 6e-4);
    expectFigure('relative L2', 100 * (row.at_noise ? 3 * row.noise_l2 : row.l2), 6e-3);
    check(/noise/.test(facts['relative L2']) === row.at_noise, `${row.label}: noise ${facts['relative L2']}`);
    expectFigure('NRMSE', 100 * (row.at_noise ? 3 * row.noise_nrmse : row.nrmse), 6e-3);
    expectFigure('bias', 100 * row.relative_bias, 6e-3);
    expectFigure('FLIP', row.flip, 6e-3);
    for (const key of ['renderer', 'driver', 'program', 'date', 'command', 'picture_command'])
      check(typeof row[key] === 'string' && row[key].length > 0, `${row.label}: no ${key}`);
    const command = facts['measured by'] || '';
    check(command.startsWith(row.command) && facts.renderer === row.renderer && facts.date === row.date,
          `${row.label}: provenance`);
  }
}

// The plot's points are at the JSON's figures, for each choice of axes; its front is the JSON's.
async function plotChecks(evaluate) {
  const axes = [
    ['ms', 'l2'], ['setup', 'nrmse'], ['cpu_ms', 'relmse'], ['ms', 'flip'], ['ms', 'bias'], ['ms', 'inside'],
  ];
  for (const [cost, metric] of axes) {
    const points = await evaluate(`
      f.state.cost = '${cost}';
      f.state.metric = '${metric}';
      f.drawPlot();
      const data = [...f.plotBox.querySelectorAll('.point')].map(p => p.dataset);
      return data.map(d => ({row: Number(d.row), cost: Number(d.cost), error: Number(d.error)}))`);
    for (const p of points) {
      const row = json.rows[p.row], expected = {ms: row.ms, setup: row.ms + row.setup_ms, cpu_ms: row.cpu_ms}[cost];
      check(near(p.cost, expected, 1e-12), `${row.label}: plotted at ${p.cost} instead of ${expected}`);
      const inside = row.inside_model;
      const error = {
        l2: row.at_noise ? 3 * row.noise_l2 : row.l2,
        nrmse: row.at_noise ? 3 * row.noise_nrmse : row.nrmse,
        flip: row.flip,
        relmse: p.error,
        bias: row.bias_at_noise ? 3 * Math.abs(row.bias_error * row.relative_bias / row.bias) :
          Math.abs(row.relative_bias),
        inside: inside && (inside.at_noise ? 3 * inside.noise_l2 : inside.l2),
      }[metric];
      check(near(p.error, error, 1e-12), `${row.label}: ${metric} plotted at ${p.error} instead of ${error}`);
    }
    const expected = json.rows.filter(r => r.ms > 0 && (r.at_noise ? r.noise_l2 : r.l2) > 0).length;
    if (metric === 'l2') check(points.length === expected, `${points.length} points of ${expected}`);
  }
  const front = await evaluate(`
    f.state.cost = "ms";
    f.state.metric = "l2";
    f.drawPlot();
    f.drawTables();
    return report.frontOf(f.rows, "ms", "l2")`);
  const pareto = json.rows.map((r, i) => (r.pareto ? i : -1)).filter(i => i >= 0);
  check(JSON.stringify(front.sort((a, b) => a - b)) === JSON.stringify(pareto), `front ${front}`);
  // Equal time, by a computation of its own.
  const entries = await evaluate('return f.tableData().ms');
  for (const s of entries.equalTime) {
    const sweep = json.rows.filter(r => r.series === s.series && !r.at_noise && r.l2 > 0).sort((a, b) => a.ms - b.ms);
    s.entries.forEach((e, k) => {
      const t = entries.times[k], j = sweep.findIndex(r => r.ms >= t);
      if (!e) {
        check(j < 1 || sweep.length < 2, `${s.series} at ${t} ms: no entry`);
        return;
      }
      if (!e.interpolated) return;
      const a = sweep[j - 1], b = sweep[j];
      const expected = a.l2 * (b.l2 / a.l2) ** (Math.log(t / a.ms) / Math.log(b.ms / a.ms));
      check(near(e.value, expected, 1e-9), `${s.series} at ${t} ms: ${e.value} instead of ${expected}`);
    });
  }
}

// Pixels: what the picture's mean, its NRMSE and FLIP come to is the JSON's, up to halves and bytes.
async function pixelChecks(evaluate) {
  const items = await evaluate('return f.items.length');
  for (let i = 1; i < items; ++i) {
    const p = await evaluate(`
      const d = f.difference(${i}), t = f.reference(f.items[${i}].reference), v = f.flipMap(${i}), n = d.length;
      let s = 0, m = 0, b = 0;
      for (let k = 0; k < n; ++k) {
        s += d[k] * d[k];
        m += t[k];
        b += d[k];
      }
      const flip = v ? v.reduce((a, c) => a + c, 0) / v.length / 255 : null;
      return {row: f.items[${i}].row, rmse: Math.sqrt(s / n), mean: m / n, bias: b / n, flip}`);
    const row = json.rows[p.row];
    if (await evaluate(`return f.facts.block * f.picture(${i}).block`) > 1) continue;
    const nrmse = p.rmse / p.mean;
    if (!row.seeds || row.seeds.seed.length === 1)
      check(near(nrmse, row.measured_nrmse, 1e-3),
            `${row.label}: NRMSE of the pixels ${nrmse} against ${row.measured_nrmse}`);
    check(Math.abs(p.bias - row.bias) <= 1e-3 * p.rmse + 1e-12,
          `${row.label}: bias of the pixels ${p.bias} against ${row.bias}`);
    if (p.flip !== null)
      check(Math.abs(p.flip - row.flip) < 2e-3, `${row.label}: FLIP of the pixels ${p.flip} against ${row.flip}`);
  }
  // So is the reference's standard error.
  if (await evaluate('return f.facts.block') === 1) {
    for (let t = 0; t < await evaluate('return f.facts.references.length'); ++t) {
      const reference = await evaluate(`
        const rms = p => Math.sqrt(p.reduce((a, v) => a + v * v, 0) / p.length), t = f.reference(${t});
        return {mean: t.reduce((a, v) => a + v, 0) / t.length, error: rms(f.referenceError(${t}))}`);
      const materials = t === 0 ? 'lambert' : 'all';
      const all = json.references.filter(r => r.transport === 'all' && r.materials === materials &&
        near(r.mean.reduce((a, v) => a + v, 0) / 3, reference.mean, 1e-5));
      check(all.length === 1 && near(all[0].pixel_error, reference.error, 1e-3),
            `standard error of reference ${t} ${reference.error}: ${JSON.stringify(all)}`);
    }
  }
}

// Values under the cursor are the arrays'.
async function cursorChecks(evaluate) {
  // Where a picture and the reference's noise are largest, off the edge: some pictures are black all over.
  const place = await evaluate(`
    const e = f.referenceError(0), best = {product: -1};
    for (let i = 1; i < f.items.length; ++i) {
      const p = f.pixels(i);
      for (let y = 1; y < f.height - 1; ++y)
        for (let x = 1; x < f.width - 1; ++x) {
          const k = y * f.width + x, product = p[3*k] * e[3*k];
          if (product > best.product) Object.assign(best, {i, x, y, k, product});
        }
    }
    f.moveCursor(best.x, best.y);
    f.draw();
    return best`);
  const cells = await evaluate(`
    const rows = [...f.valuesBox.querySelectorAll("tr")];
    return rows.map(r => [...r.children].map(c => c.textContent))`);
  check(cells[0][0] === `pixel ${place.x}, ${place.y}`, `cursor ${cells[0][0]}`);
  const under = await evaluate(`
    const k = ${place.k}, i = ${place.i}, p = f.pixels(i);
    return {
      p: [p[3*k], p[3*k+1], p[3*k+2]],
      t: f.reference(0)[3*k],
      e: f.referenceError(0)[3*k],
      z: f.mapValue(i, "z", k),
      label: f.label(i),
    }`);
  const line = cells.find(c => c[0] === under.label);
  under.p.forEach((v, c) => {
    check(near(Number(line[c + 1]), v, 1e-4), `under the cursor ${line[c + 1]} instead of ${v}`);
  });
  const [shownReference, shownError] = [cells[1][1], cells[2][1]];
  check(near(Number(shownReference), under.t, 1e-4) && near(Number(shownError), under.e, 1e-4),
        `reference ${shownReference} +- ${shownError} instead of ${under.t} +- ${under.e}`);
  check(!Number.isFinite(under.z) || near(Number(line[7]), under.z, 6e-3),
        `z-score ${line[7]} instead of ${under.z}`);
  // What is read of one pixel alone, of pictures that are not decoded, is what the whole pictures hold.
  const apart = await evaluate(`
    const k = ${place.k}, wrong = [];
    const same = (a, b) => Object.is(a, b) || Math.abs(a - b) <= 1e-6 * Math.abs(a);
    for (let i = 1; i < f.items.length; ++i) {
      const one = f.pixel(i, k), p = f.pixels(i);
      const values = [0, 1, 2].every(c => same(one.values[c], p[3*k+c]));
      const maps = ["signed", "relative", "z", "flip"].every(m => same(one[m], f.mapValue(i, m, k)));
      if (!values || !maps) wrong.push(f.label(i));
    }
    return wrong`);
  check(under.p.some(v => v > 0) && under.e > 0, 'the pixel under the cursor is lit');
  check(apart.length === 0, `a pixel alone is not the picture's: ${apart}`);
  // z: grey where below 3, coloured where not.
  const z = await evaluate(`
    const c = f.canvasOf(1, "z"), v = f.values(1, "z");
    const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
    let wrong = 0;
    for (let k = 0; k < v.length; ++k) {
      const isGrey = d[4*k] === 150 && d[4*k+1] === 150 && d[4*k+2] === 150;
      wrong += isGrey !== Math.abs(v[k]) < 3;
    }
    return wrong`);
  check(z === 0, `${z} pixels of the z-score have the wrong colour`);
}

// What keys save, copy and print; notes which were tested.
async function exportChecks(evaluate, press, state, tested) {
  const saved = async key => {
    tested.add(key);
    await press(key);
    return evaluate('return report.lastSaved');
  };
  const figure = await saved('x'), plot = await saved('X'), csv = await saved('d'), tex = await saved('L');
  check(figure.name === 'figure.svg' && /<image [^>]*data:image\/png/.test(figure.text), 'figure as SVG');
  check(plot.name === 'plot.svg' && (plot.text.match(/class="point"/g) || []).length > 3, 'plot as SVG');
  const legend = await evaluate('return f.seriesNames.filter(name => f.seriesPoints(name).length)');
  const isNamed = name => plot.text.includes(`>${name}</text>`);
  check(legend.every(isNamed) && plot.text.endsWith('</svg>'), 'the plot as SVG names its series');
  const csvLines = csv.text.trim().split('\n');
  check(csvLines.length === json.rows.length + 1, `CSV of ${csvLines.length} lines`);
  const hasPoints = json.rows.some(r => r.ms > 0 && r.l2 > 0 && !r.at_noise);
  check(/\\begin{tabular}/.test(tex.text) && /\\addplot/.test(tex.text) === hasPoints, 'LaTeX');
  tested.add('p');
  await press('p');
  const {command} = json.rows[(await state()).selected];
  check(await evaluate('return report.lastCopied') === command, 'key p: the command is copied');
  tested.add('?');
  await press('?');
  check(await evaluate('return f.help.open'), 'key ?: help');
  tested.add('P');
  await evaluate('window.printed = 0; window.print = () => { ++window.printed; }');
  await press('P');
  check(await evaluate('return window.printed') === 1, 'key P: print');
}

// Keys: each does what help says of it.
async function keyChecks(evaluate, press, state, screenshots) {
  const items = await evaluate('return f.items.length');
  await evaluate('f.root.focus(); f.show(1)');
  const help = await evaluate(`
    const terms = [...f.help.querySelectorAll("dt")];
    return terms.flatMap(d => [...d.querySelectorAll("kbd")].map(k => k.textContent))`);
  const known = await evaluate('return report.KEYS.flatMap(k => k.keys.map(x => x.label || x))');
  check(JSON.stringify(help) === JSON.stringify(known) && help.length > 40, 'help lists the keys that there are');
  const tested = new Set();
  const expectKey = async (key, label, holds) => {
    tested.add(key);
    const before = await state();
    await press(key);
    const after = await state();
    check(holds(before, after), `key ${key}: ${label}; ${JSON.stringify([before, after])}`);
  };
  const expectFactor = async (key, label, value, factor) => {
    tested.add(key);
    const before = await value();
    await press(key);
    const after = await value();
    check(near(after, factor * before, 1e-9), `key ${key}: ${label} ${before} to ${after}`);
  };
  // Each method beside the reference that judges it: in the set from the start, and by key 0.
  const judged = await evaluate('return f.items.map((item, i) => (i > 0 ? f.picture(i).reference : 0))');
  const set = (await state()).chosen;
  check(set.every(i => set.includes(i > 0 ? 0 - judged[i] : i)), `in the set ${set}, judged by ${judged}`);
  for (const i of [...judged.keys()].slice(1)) {
    await evaluate(`f.show(${i})`);
    await expectKey('0', 'reference', (a, b) => b.current === 0 - judged[i]);
  }
  await evaluate('f.show(0)');
  const references = await evaluate('return f.facts.references.map(t => t.name)');
  for (let k = 1; k <= references.length; ++k) {
    await press('0');
    const shown = await evaluate(`
      const i = f.state.current, line = f.list.querySelector('[data-item="' + i + '"]');
      return {label: f.label(i), list: line.children[2].textContent, same: f.pixels(i) === f.reference(-i)}`);
    check(shown.label === references[k % references.length] && shown.list === shown.label && shown.same,
          `key 0 again: ${JSON.stringify(shown)}`);
  }
  // Methods.
  for (let k = 1; k <= 9; ++k)
    await expectKey(String(k), 'method', (a, b) => b.current === (k < items ? k : a.current));
  const order = [...references.keys()].map(t => 0 - t).concat([...judged.keys()].slice(1));
  const places = order.length;
  await expectKey('n', 'next', (a, b) => b.current === order[(order.indexOf(a.current) + 1) % places]);
  await expectKey('b', 'before', (a, b) => b.current === order[(order.indexOf(a.current) + places - 1) % places]);
  await expectKey('f', 'flip', (a, b) => b.flipped && b.shown === b.before);
  await expectKey('f', 'flip back', (a, b) => !b.flipped && b.shown === b.current);
  // Ways to see them: wipe, side by side, one.
  await expectKey('w', 'wipe', (a, b) => b.mode === 'wipe');
  await expectKey(',', 'wipe to the left', (a, b) => near(b.wipe, a.wipe - 0.05, 1e-9));
  await expectKey('.', 'wipe to the right', (a, b) => near(b.wipe, a.wipe + 0.05, 1e-9));
  await expectKey('s', 'side by side', (a, b) => b.mode === 'side');
  await press('1');
  await expectKey('a', 'out of the set', (a, b) => a.chosen.includes(1) && !b.chosen.includes(1));
  await expectKey('a', 'into the set', (a, b) => b.chosen.includes(1));
  await screenshots([
    ['side', 'f.state.map = "z"; f.draw(); f.root.scrollIntoView()'],
    ['wipe', 'f.state.mode = "wipe"; f.state.map = "signed"; f.draw()'],
    ['plot', 'f.state.mode = "side"; f.state.map = "picture"; f.draw(); f.plotBox.scrollIntoView()'],
  ]);
  await expectKey('v', 'one', (a, b) => b.mode === 'single');
  // Maps, their range, exposure.
  for (const map of ['signed', 'relative', 'flip', 'z', 'picture'])
    await expectKey('m', 'map', (a, b) => b.map === map);
  await expectKey('M', 'map before', (a, b) => b.map === 'z');
  await press('1');
  const range = () => evaluate('return f.range(f.shown(), f.state.map)');
  await expectFactor(']', 'range', range, 2);
  await expectFactor('[', 'range', range, 0.5);
  await expectKey('l', 'unlock', (a, b) => a.lock && !b.lock);
  await expectKey('l', 'lock', (a, b) => b.lock);
  await expectKey('E', 'brighter', (a, b) => b.stops === a.stops + 0.5);
  await expectKey('e', 'darker', (a, b) => b.stops === a.stops - 0.5);
  await expectKey('t', 'tone map', (a, b) => a.tone === 'filmic' && b.tone === 'linear');
  // Place and crops.
  const scale = () => evaluate('return f.layout().scale');
  await expectFactor('+', 'zoom', scale, 1.25);
  await expectFactor('-', 'zoom', scale, 0.8);
  for (const [key, x, y] of [['ArrowLeft', -1, 0], ['ArrowRight', 1, 0], ['ArrowUp', 0, -1], ['ArrowDown', 0, 1]]) {
    await expectKey(key, 'pan', (a, b) => Math.sign(b.x - a.x) === x && Math.sign(b.y - a.y) === y);
    await expectKey('Shift+' + key, 'cursor', (a, b) => b.cursor.x - a.cursor.x === x && b.cursor.y - a.cursor.y === y);
  }
  await expectKey('r', 'fit', (a, b) => b.zoom === 0);
  await expectKey('c', 'crop', (a, b) => b.crops.length === a.crops.length + 1);
  await expectKey('C', 'crop away', (a, b) => b.crops.length === a.crops.length - 1);
  await press('C');
  await expectKey('A', 'crops of its own', (a, b) => b.crops.length === 3);
  // Plot and what is saved.
  await expectKey('k', 'cost', (a, b) => a.cost === 'ms' && b.cost === 'setup');
  await expectKey('y', 'error', (a, b) => a.metric === 'l2' && b.metric === 'nrmse');
  await exportChecks(evaluate, press, state, tested);
  const all = await evaluate('return report.KEYS.flatMap(k => k.keys.map(x => x.key || x))');
  check(all.every(k => tested.has(k)), `keys without a test: ${all.filter(k => !tested.has(k))}`);
}

// A click, and Enter, on a point load its picture.
async function pointChecks(evaluate, press, state) {
  const items = await evaluate('return f.items.length');
  const target = await evaluate('return f.items[f.items.length - 1].row');
  await evaluate(`
    const point = f.plotBox.querySelector('.point[data-row="${target}"]');
    point.dispatchEvent(new MouseEvent('click', {bubbles: true}))`);
  check((await state()).current === items - 1, 'a click on a point loads its picture');
  const another = await evaluate(`
    f.state.cost = "ms";
    f.state.metric = "l2";
    f.drawPlot();
    const row = f.items[1].row;
    f.plotBox.querySelector('.point[data-row="' + row + '"]').focus();
    return row`);
  await press('Enter');
  check((await state()).current === 1 && (await state()).selected === another, 'Enter on a point loads its picture');
}

// Loads the page; how to call the browser, evaluate in the page (report, f: its first figure), press keys, and see the
// figure's state.
async function openPage() {
  const {targetInfos} = await send('Target.getTargets');
  const {targetId} = targetInfos.find(t => t.type === 'page');
  const {sessionId} = await send('Target.attachToTarget', {targetId, flatten: true});
  const call = (method, params) => send(method, params, sessionId);
  await call('Runtime.enable');
  await call('Network.enable');
  await call('Page.enable');
  await call('Page.navigate', {url: 'file://' + path.resolve(page)});
  const evaluate = async expression => {
    const named = `const report = window.lucernaReport, f = report && report.figures[0]; ${expression}`;
    const r = await call('Runtime.evaluate', {
      expression: `(() => { ${named} })()`,
      returnByValue: true,
      awaitPromise: true,
    });
    if (r.exceptionDetails) throw new Error(r.exceptionDetails.exception.description || r.exceptionDetails.text);
    return r.result.value;
  };
  const isLoaded = () => evaluate('return !!report && document.readyState === "complete"');
  for (let i = 0; i < 600 && !(await isLoaded()); ++i) await sleep(100);
  const state = () => evaluate('return JSON.parse(JSON.stringify({...f.state, shown: f.shown()}))');
  const codes = {'+': 'Equal', '-': 'Minus', '?': 'Slash', ' ': 'Space'};
  const keys = {Tab: 9, Enter: 13, ' ': 32, ArrowUp: 38, ArrowDown: 40};
  const press = async key => {
    const shift = key.startsWith('Shift+'), name = shift ? key.slice(6) : key;
    const event = {
      key: name,
      code: codes[name] || name,
      modifiers: shift ? 8 : 0,
      text: name.length === 1 ? name : name === 'Enter' ? '\r' : undefined,
      windowsVirtualKeyCode: keys[name],
    };
    await call('Input.dispatchKeyEvent', {type: 'keyDown', ...event});
    await call('Input.dispatchKeyEvent', {type: 'keyUp', ...event});
  };
  return {call, evaluate, press, state};
}

async function main() {
  const {call, evaluate, press, state} = await openPage();
  // The page is one file, small, ready soon, without errors of its own, and fetches nothing.
  check(fs.statSync(page).size <= 20e6, `the page has ${fs.statSync(page).size} bytes`);
  const ready = await evaluate('return report.ready');
  console.log(`ready after ${ready.toFixed(0)} ms, ${fs.statSync(page).size} bytes`);
  const isFetch = e => e.method === 'Network.requestWillBeSent' && !/^(file|data|blob):/.test(e.params.request.url);
  const fetched = events.filter(isFetch).map(e => e.params.request.url);
  check(fetched.length === 0, `fetched ${fetched}`);

  const screenshots = async views => {
    for (const width of prefix ? [1280, 2560] : []) {
      await call('Emulation.setDeviceMetricsOverride', {width, height: 1500, deviceScaleFactor: 1, mobile: false});
      for (const [name, script] of views) {
        await evaluate(script);
        const picture = (await call('Page.captureScreenshot')).data;
        fs.writeFileSync(`${prefix}-${name}-${width}.png`, Buffer.from(picture, 'base64'));
      }
    }
    if (prefix) await call('Emulation.clearDeviceMetricsOverride');
  };
  const finish = () => {
    const thrown = events.filter(e => e.method === 'Runtime.exceptionThrown');
    const errors = thrown.map(e => e.params.exceptionDetails.exception.description);
    check(errors.length === 0, `errors of the page: ${errors}`);
    console.log(`${checks} checks, ${faults} faults`);
  };
  if (Array.isArray(written.error)) {
    const figures = await evaluate('return report.figures.map(g => g.rows.length)');
    const reports = [...written.error, ...(written.deviations || [])];
    check(JSON.stringify(figures) === JSON.stringify(reports.map(r => r.rows.length)), `figures of ${figures} rows`);
  }
  if (written.a) {
    await compareChecks(evaluate, press, state);
    await printChecks(call, evaluate);
    await screenshots([
      ['side', 'f.state.mode = "side"; f.state.map = "picture"; f.draw(); f.root.scrollIntoView()'],
      ['signed', 'f.state.map = "signed"; f.draw()'],
    ]);
    finish();
    return;
  }

  await rowChecks(evaluate);
  await plotChecks(evaluate);
  await pixelChecks(evaluate);
  await cursorChecks(evaluate);
  await keyChecks(evaluate, press, state, screenshots);
  await pointChecks(evaluate, press, state);
  await colourChecks(evaluate);
  await tabChecks(call, evaluate, press, state);
  await mouseChecks(call, evaluate, state);
  await printChecks(call, evaluate);
  // Every point has its picture, unless there was none to be had.
  const clicked = await evaluate(`
    const isWithoutPicture = p => {
      p.dispatchEvent(new MouseEvent("click", {bubbles: true}));
      const item = f.items[f.state.current];
      return !item || item.row !== Number(p.dataset.row);
    };
    return [...f.plotBox.querySelectorAll(".point")].filter(isWithoutPicture).length`);
  check(clicked === 0, `${clicked} points load no picture`);

  finish();
}
main().catch(error => { console.log('FAULT ' + error.stack); faults = 1; }).finally(() => {
  browser.on('exit', () => {
    // Its other processes may still write there: what stays behind is no fault of the page.
    try {
      fs.rmSync(profile, {recursive: true, force: true, maxRetries: 20, retryDelay: 100});
    } catch (error) {
      console.log('left behind: ' + error.message);
    }
    process.exit(faults ? 1 : 0);
  });
  process.kill(-browser.pid, 'SIGKILL');  // with its other processes
});
