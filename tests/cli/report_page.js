// Drives a report's page in headless Chromium through its debugging pipe and checks it against the report's JSON.
// Usage: node report_page.js CHROMIUM PAGE.html REPORT.json [SCREENSHOT-PREFIX]
// The JSON is that of `bench error`, of `bench all` (whose first figure is driven) or of `compare` (whose page has one row).
// Prints a line a fault and ends with 1 where there is one; "N checks" and 0 otherwise.
'use strict';
const {spawn} = require('child_process');
const fs = require('fs'), os = require('os'), path = require('path');
const [chromium, page, jsonFile, prefix] = process.argv.slice(2);
const written = JSON.parse(fs.readFileSync(jsonFile, 'utf8').replace(/\bNaN\b/g, 'null'));
const json = Array.isArray(written.error) ? written.error[0] : written;

const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'lucerna-page-'));
const browser = spawn(chromium, ['--headless', '--no-sandbox', '--disable-gpu', '--hide-scrollbars', `--user-data-dir=${profile}`, '--remote-debugging-pipe', '--window-size=1280,1000', 'about:blank'],
                      {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
let next = 1, buffer = '';
const waiting = new Map(), events = [];
browser.stdio[4].on('data', data => {
  buffer += data;
  for (let end; (end = buffer.indexOf('\0')) >= 0; buffer = buffer.slice(end + 1)) {
    const message = JSON.parse(buffer.slice(0, end));
    if (message.id) { const w = waiting.get(message.id); waiting.delete(message.id); message.error ? w.reject(new Error(message.error.message)) : w.resolve(message.result); }
    else events.push(message);
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

// A pair of pictures: one row, without times.
async function compareChecks(evaluate, press, state) {
  const rows = await evaluate('return f.rows');
  check(rows.length === 1, `${rows.length} rows`);
  for (const key of ['l2', 'nrmse', 'relmse', 'flip', 'bias', 'relative_bias']) check(near(rows[0][key], written[key], 1e-12), `${key} ${rows[0][key]} instead of ${written[key]}`);
  const shown = await evaluate(`f.select(0); return f.factsBox.textContent`);
  for (const [name, value, digits] of [['relative L2', 100 * written.l2, 6e-3], ['NRMSE', 100 * written.nrmse, 6e-3], ['FLIP', written.flip, 6e-3]]) {
    const found = shown.match(new RegExp(name + '\\s*(?:< )?(-?[0-9.e+-]+)'));
    check(found && near(Number(found[1]), value, digits), `${name} is shown as ${found && found[1]} instead of ${value}`);
  }
  const p = await evaluate('const d = f.difference(1), t = f.truth(0); let s = 0, m = 0; for (let k = 0; k < d.length; ++k) { s += d[k] * d[k]; m += t[k]; } return {rmse: Math.sqrt(s / d.length), mean: m / d.length}');
  check(near(p.rmse, written.rmse, 2e-3) && near(p.mean, written.reference_mean, 1e-3), `pixels: RMSE ${p.rmse} instead of ${written.rmse}, mean ${p.mean} instead of ${written.reference_mean}`);
  // The first crop is where they differ most, not in the black beside the scene.
  const crop = await evaluate('const c = f.state.crops[0]; if (!c) return null; const d = f.difference(1); let inside = 0; for (let y = c.y; y < c.y + c.height; ++y) for (let x = c.x; x < c.x + c.width; ++x) inside += d[3 * (y * f.width + x)] !== 0; return inside / (c.width * c.height)');
  check(crop !== null && crop > 0.5, `the first crop shows ${crop} of differing pixels`);
  await evaluate('f.root.focus(); f.show(1)');
  for (const [key, holds] of [['0', s => s.current === 0], ['1', s => s.current === 1], ['w', s => s.mode === 'wipe'], ['s', s => s.mode === 'side'], ['m', s => s.map === 'signed'], ['v', s => s.mode === 'single']]) {
    await press(key);
    check(holds(await state()), `key ${key}: ${JSON.stringify(await state())}`);
  }
}

async function main() {
  const {targetInfos} = await send('Target.getTargets');
  const {sessionId} = await send('Target.attachToTarget', {targetId: targetInfos.find(t => t.type === 'page').targetId, flatten: true});
  const call = (method, params) => send(method, params, sessionId);
  await call('Runtime.enable');
  await call('Network.enable');
  await call('Page.enable');
  await call('Page.navigate', {url: 'file://' + path.resolve(page)});
  const evaluate = async expression => {
    const r = await call('Runtime.evaluate', {expression: `(() => { const report = window.lucernaReport, f = report && report.figures[0]; ${expression} })()`, returnByValue: true, awaitPromise: true});
    if (r.exceptionDetails) throw new Error(r.exceptionDetails.exception.description || r.exceptionDetails.text);
    return r.result.value;
  };
  for (let i = 0; i < 100 && !(await evaluate('return !!report && document.readyState === "complete"')); ++i) await sleep(100);
  const state = () => evaluate('return JSON.parse(JSON.stringify({...f.state, shown: f.shown()}))');
  const codes = {'+': 'Equal', '-': 'Minus', '?': 'Slash'};
  const press = async key => {
    const shift = key.startsWith('Shift+'), name = shift ? key.slice(6) : key;
    const event = {key: name, code: codes[name] || name, modifiers: shift ? 8 : 0, text: name.length === 1 ? name : undefined};
    await call('Input.dispatchKeyEvent', {type: 'keyDown', ...event});
    await call('Input.dispatchKeyEvent', {type: 'keyUp', ...event});
  };

  // The page is one file, small, ready soon, without errors of its own, and fetches nothing.
  check(fs.statSync(page).size <= 20e6, `the page has ${fs.statSync(page).size} bytes`);
  const ready = await evaluate('return report.ready');
  console.log(`ready after ${ready.toFixed(0)} ms, ${fs.statSync(page).size} bytes`);
  const fetched = events.filter(e => e.method === 'Network.requestWillBeSent' && !/^(file|data|blob):/.test(e.params.request.url));
  check(fetched.length === 0, `fetched ${fetched.map(e => e.params.request.url)}`);

  const screenshots = async views => {
    for (const width of prefix ? [1280, 2560] : []) {
      await call('Emulation.setDeviceMetricsOverride', {width, height: 1500, deviceScaleFactor: 1, mobile: false});
      for (const [name, script] of views) {
        await evaluate(script);
        fs.writeFileSync(`${prefix}-${name}-${width}.png`, Buffer.from((await call('Page.captureScreenshot')).data, 'base64'));
      }
    }
    if (prefix) await call('Emulation.clearDeviceMetricsOverride');
  };
  if (Array.isArray(written.error)) {
    const figures = await evaluate('return report.figures.map(g => g.rows.length)'), reports = [...written.error, ...(written.deviations || [])];
    check(JSON.stringify(figures) === JSON.stringify(reports.map(r => r.rows.length)), `figures of ${figures} rows`);
  }
  if (written.a) {
    await compareChecks(evaluate, press, state);
    await screenshots([['side', 'f.state.mode = "side"; f.state.map = "picture"; f.draw(); f.root.scrollIntoView()'], ['signed', 'f.state.map = "signed"; f.draw()']]);
    const errors = events.filter(e => e.method === 'Runtime.exceptionThrown').map(e => e.params.exceptionDetails.exception.description);
    check(errors.length === 0, `errors of the page: ${errors}`);
    console.log(`${checks} checks, ${faults} faults`);
    return;
  }

  // Every row is the JSON's.
  const rows = await evaluate('return f.rows');
  check(rows.length === json.rows.length, `${rows.length} rows instead of ${json.rows.length}`);
  rows.forEach((row, i) => check(JSON.stringify(row) === JSON.stringify(json.rows[i]), `row ${i} is not the JSON's`));
  // What is shown of a row: the figures of its panel, to the digits that it has.
  for (let i = 0; i < rows.length; ++i) {
    const facts = await evaluate(`f.select(${i}); return Object.fromEntries([...f.factsBox.querySelectorAll('dl > div')].map(d => [d.querySelector('dt').textContent, d.querySelector('dd').textContent]))`);
    const row = json.rows[i], number = text => parseFloat(String(text).replace(/^< /, ''));
    check(near(number(facts.picture), row.ms, 6e-4), `${row.label}: picture ${facts.picture} against ${row.ms}`);
    check(near(number(facts['set-up']), row.setup_ms, 6e-4), `${row.label}: set-up ${facts['set-up']} against ${row.setup_ms}`);
    check(near(number(facts['relative L2']), 100 * (row.at_noise ? 3 * row.noise_l2 : row.l2), 6e-3), `${row.label}: L2 ${facts['relative L2']} against ${row.l2}`);
    check(/noise/.test(facts['relative L2']) === row.at_noise, `${row.label}: noise ${facts['relative L2']}`);
    check(near(number(facts.NRMSE), 100 * (row.at_noise ? 3 * row.noise_nrmse : row.nrmse), 6e-3), `${row.label}: NRMSE ${facts.NRMSE}`);
    check(near(number(facts.bias), 100 * row.relative_bias, 6e-3), `${row.label}: bias ${facts.bias} against ${row.relative_bias}`);
    check(near(number(facts.FLIP), row.flip, 6e-3), `${row.label}: FLIP ${facts.FLIP} against ${row.flip}`);
    for (const key of ['renderer', 'driver', 'program', 'date', 'command', 'picture_command']) check(typeof row[key] === 'string' && row[key].length > 0, `${row.label}: no ${key}`);
    check((facts['measured by'] || '').startsWith(row.command) && facts.renderer === row.renderer && facts.date === row.date, `${row.label}: provenance`);
  }
  // The plot's points are at the JSON's figures, for each choice of axes; its front is the JSON's.
  for (const [cost, metric] of [['ms', 'l2'], ['setup', 'nrmse'], ['cpu_ms', 'relmse'], ['ms', 'flip'], ['ms', 'bias'], ['ms', 'inside']]) {
    const points = await evaluate(`f.state.cost = '${cost}'; f.state.metric = '${metric}'; f.drawPlot(); return [...f.plotBox.querySelectorAll('.point')].map(p => ({row: Number(p.dataset.row), cost: Number(p.dataset.cost), error: Number(p.dataset.error)}))`);
    for (const p of points) {
      const row = json.rows[p.row], expected = {ms: row.ms, setup: row.ms + row.setup_ms, cpu_ms: row.cpu_ms}[cost];
      check(near(p.cost, expected, 1e-12), `${row.label}: plotted at ${p.cost} instead of ${expected}`);
      const error = {l2: row.at_noise ? 3 * row.noise_l2 : row.l2, nrmse: row.at_noise ? 3 * row.noise_nrmse : row.nrmse, flip: row.flip, relmse: p.error,
                     bias: row.bias_at_noise ? 3 * Math.abs(row.bias_error * row.relative_bias / row.bias) : Math.abs(row.relative_bias),
                     inside: row.inside_model && (row.inside_model.at_noise ? 3 * row.inside_model.noise_l2 : row.inside_model.l2)}[metric];
      check(near(p.error, error, 1e-12), `${row.label}: ${metric} plotted at ${p.error} instead of ${error}`);
    }
    const expected = json.rows.filter(r => r.ms > 0 && (metric !== 'l2' || (r.at_noise ? r.noise_l2 : r.l2) > 0)).length;
    if (metric === 'l2') check(points.length === expected, `${points.length} points of ${expected}`);
  }
  const front = await evaluate('f.state.cost = "ms"; f.state.metric = "l2"; f.drawPlot(); f.drawTables(); return report.frontOf(f.rows, "ms", "l2")');
  check(JSON.stringify(front.sort((a, b) => a - b)) === JSON.stringify(json.rows.map((r, i) => (r.pareto ? i : -1)).filter(i => i >= 0)), `front ${front}`);
  // Equal time, by a computation of its own.
  const entries = await evaluate('return f.tableData().ms');
  for (const s of entries.equalTime) {
    const ladder = json.rows.filter(r => r.series === s.series && !r.at_noise && r.l2 > 0).sort((a, b) => a.ms - b.ms);
    s.entries.forEach((e, k) => {
      const t = entries.times[k], j = ladder.findIndex(r => r.ms >= t);
      if (!e) { check(j < 1 || ladder.length < 2, `${s.series} at ${t} ms: no entry`); return; }
      if (!e.interpolated) return;
      const a = ladder[j - 1], b = ladder[j], expected = a.l2 * (b.l2 / a.l2) ** (Math.log(t / a.ms) / Math.log(b.ms / a.ms));
      check(near(e.value, expected, 1e-9), `${s.series} at ${t} ms: ${e.value} instead of ${expected}`);
    });
  }
  // Pixels: what the picture's mean, its NRMSE and FLIP come to is the JSON's, up to halves and bytes.
  const items = await evaluate('return f.items.length');
  for (let i = 1; i < items; ++i) {
    const p = await evaluate(`const d = f.difference(${i}), t = f.truth(f.items[${i}].truth); let s = 0, m = 0, b = 0; for (let k = 0; k < d.length; ++k) { s += d[k] * d[k]; m += t[k]; b += d[k]; } const v = f.flipMap(${i}); return {row: f.items[${i}].row, rmse: Math.sqrt(s / d.length), mean: m / d.length, bias: b / d.length, flip: v ? v.reduce((a, c) => a + c, 0) / v.length / 255 : null}`);
    const row = json.rows[p.row];
    if (await evaluate('return f.facts.block') > 1) continue;
    if (!row.seeds || row.seeds.seed.length === 1) check(near(p.rmse / p.mean, row.measured_nrmse, 1e-3), `${row.label}: NRMSE of the pixels ${p.rmse / p.mean} against ${row.measured_nrmse}`);
    check(Math.abs(p.bias - row.bias) <= 1e-3 * p.rmse + 1e-12, `${row.label}: bias of the pixels ${p.bias} against ${row.bias}`);
    if (p.flip !== null) check(Math.abs(p.flip - row.flip) < 2e-3, `${row.label}: FLIP of the pixels ${p.flip} against ${row.flip}`);
  }
  // Values under the cursor are the arrays'.
  await evaluate('f.moveCursor(7, 5); f.draw()');
  const cells = await evaluate('return [...f.valuesBox.querySelectorAll("tr")].map(r => [...r.children].map(c => c.textContent))');
  check(cells[0][0] === 'pixel 7, 5', `cursor ${cells[0][0]}`);
  const under = await evaluate('const k = 5 * f.width + 7, p = f.pixels(1); return {p: [p[3*k], p[3*k+1], p[3*k+2]], t: f.truth(0)[3*k], e: f.truthError(0)[3*k], z: f.mapValue(1, "z", k), label: f.label(1)}');
  const line = cells.find(c => c[0] === under.label);
  under.p.forEach((v, c) => check(near(Number(line[c + 1]), v, 1e-4), `under the cursor ${line[c + 1]} instead of ${v}`));
  check(near(Number(cells[1][1]), under.t, 1e-4) && near(Number(cells[2][1]), under.e, 1e-4), `reference ${cells[1][1]} +- ${cells[2][1]} instead of ${under.t} +- ${under.e}`);
  check(!Number.isFinite(under.z) || near(Number(line[7]), under.z, 6e-3), `z-score ${line[7]} instead of ${under.z}`);
  // z: grey where below 3, coloured where not.
  const z = await evaluate('const c = f.canvasOf(1, "z"), d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data, v = f.values(1, "z"); let wrong = 0; for (let k = 0; k < v.length; ++k) wrong += (d[4*k] === 150 && d[4*k+1] === 150 && d[4*k+2] === 150) !== Math.abs(v[k]) < 3; return wrong');
  check(z === 0, `${z} pixels of the z-score have the wrong colour`);

  // Keys: each does what help says of it.
  await evaluate('f.root.focus(); f.show(1)');
  const help = await evaluate('return [...f.help.querySelectorAll("dt")].flatMap(d => [...d.querySelectorAll("kbd")].map(k => k.textContent))');
  const known = await evaluate('return report.KEYS.flatMap(k => k.keys.map(x => x.label || x))');
  check(JSON.stringify(help) === JSON.stringify(known) && help.length > 40, 'help lists the keys that there are');
  const tested = new Set();
  const expectKey = async (key, label, holds) => { tested.add(key); const before = await state(); await press(key); const after = await state(); check(holds(before, after), `key ${key}: ${label}; ${JSON.stringify([before, after])}`); };
  await expectKey('0', 'reference', (a, b) => b.current === 0);
  for (let k = 1; k <= 9; ++k) await expectKey(String(k), 'method', (a, b) => b.current === (k < items ? k : a.current));
  await expectKey('n', 'next', (a, b) => b.current === (a.current + 1) % items);
  await expectKey('b', 'before', (a, b) => b.current === (a.current + items - 1) % items);
  await expectKey('f', 'flip', (a, b) => b.flipped && b.shown === b.before);
  await expectKey('f', 'flip back', (a, b) => !b.flipped && b.shown === b.current);
  await expectKey('w', 'wipe', (a, b) => b.mode === 'wipe');
  await expectKey(',', 'wipe to the left', (a, b) => near(b.wipe, a.wipe - 0.05, 1e-9));
  await expectKey('.', 'wipe to the right', (a, b) => near(b.wipe, a.wipe + 0.05, 1e-9));
  await expectKey('s', 'side by side', (a, b) => b.mode === 'side');
  await press('1');
  await expectKey('a', 'out of the set', (a, b) => a.chosen.includes(1) && !b.chosen.includes(1));
  await expectKey('a', 'into the set', (a, b) => b.chosen.includes(1));
  await screenshots([['side', 'f.state.map = "z"; f.draw(); f.root.scrollIntoView()'], ['wipe', 'f.state.mode = "wipe"; f.state.map = "signed"; f.draw()'],
                     ['plot', 'f.state.mode = "side"; f.state.map = "picture"; f.draw(); f.plotBox.scrollIntoView()']]);
  await expectKey('v', 'one', (a, b) => b.mode === 'single');
  for (const map of ['signed', 'relative', 'flip', 'z', 'picture']) await expectKey('m', 'map', (a, b) => b.map === map);
  await expectKey('M', 'map before', (a, b) => b.map === 'z');
  await press('1');
  const range = () => evaluate('return f.range(f.shown(), f.state.map)');
  for (const [key, factor] of [[']', 2], ['[', 0.5]]) { tested.add(key); const a = await range(); await press(key); check(near(await range(), factor * a, 1e-9), `key ${key}: range ${a} to ${await range()}`); }
  await expectKey('l', 'unlock', (a, b) => a.lock && !b.lock);
  await expectKey('l', 'lock', (a, b) => b.lock);
  await expectKey('E', 'brighter', (a, b) => b.stops === a.stops + 0.5);
  await expectKey('e', 'darker', (a, b) => b.stops === a.stops - 0.5);
  await expectKey('t', 'tone map', (a, b) => a.tone === 'filmic' && b.tone === 'linear');
  const scale = () => evaluate('return f.layout().scale');
  for (const [key, factor] of [['+', 1.25], ['-', 0.8]]) { tested.add(key); const a = await scale(); await press(key); check(near(await scale(), factor * a, 1e-9), `key ${key}: zoom ${a} to ${await scale()}`); }
  for (const [key, x, y] of [['ArrowLeft', -1, 0], ['ArrowRight', 1, 0], ['ArrowUp', 0, -1], ['ArrowDown', 0, 1]]) {
    await expectKey(key, 'pan', (a, b) => Math.sign(b.x - a.x) === x && Math.sign(b.y - a.y) === y);
    await expectKey('Shift+' + key, 'cursor', (a, b) => b.cursor.x - a.cursor.x === x && b.cursor.y - a.cursor.y === y);
  }
  await expectKey('r', 'fit', (a, b) => b.zoom === 0);
  await expectKey('c', 'crop', (a, b) => b.crops.length === a.crops.length + 1);
  await expectKey('C', 'crop away', (a, b) => b.crops.length === a.crops.length - 1);
  await press('C');
  await expectKey('A', 'crops of its own', (a, b) => b.crops.length === 3);
  await expectKey('k', 'cost', (a, b) => a.cost === 'ms' && b.cost === 'setup');
  await expectKey('y', 'error', (a, b) => a.metric === 'l2' && b.metric === 'nrmse');
  const saved = async key => { tested.add(key); await press(key); return evaluate('return report.lastSaved'); };
  const figure = await saved('x'), plot = await saved('X'), csv = await saved('d'), tex = await saved('L');
  check(figure.name === 'figure.svg' && /<image [^>]*data:image\/png/.test(figure.text), 'figure as SVG');
  check(plot.name === 'plot.svg' && (plot.text.match(/class="point"/g) || []).length > 3, 'plot as SVG');
  const csvLines = csv.text.trim().split('\n');
  check(csvLines.length === json.rows.length + 1, `CSV of ${csvLines.length} lines`);
  check(/\\begin{tabular}/.test(tex.text) && /\\addplot/.test(tex.text), 'LaTeX');
  tested.add('p'); await press('p');
  check(await evaluate('return report.lastCopied') === json.rows[(await state()).selected].command, 'key p: the command is copied');
  tested.add('?'); await press('?');
  check(await evaluate('return f.help.open'), 'key ?: help');
  tested.add('P'); await evaluate('window.printed = 0; window.print = () => { ++window.printed; }'); await press('P');
  check(await evaluate('return window.printed') === 1, 'key P: print');
  const all = await evaluate('return report.KEYS.flatMap(k => k.keys.map(x => x.key || x))');
  check(all.every(k => tested.has(k)), `keys without a test: ${all.filter(k => !tested.has(k))}`);
  // A click, and Enter, on a point load its picture.
  const target = await evaluate('return f.items[f.items.length - 1].row');
  await evaluate(`f.plotBox.querySelector('.point[data-row="${target}"]').dispatchEvent(new MouseEvent('click', {bubbles: true}))`);
  check((await state()).current === items - 1, 'a click on a point loads its picture');
  const another = await evaluate('f.state.cost = "ms"; f.state.metric = "l2"; f.drawPlot(); const row = f.items[1].row; f.plotBox.querySelector(`.point[data-row="${row}"]`).focus(); return row');
  await press('Enter');
  check((await state()).current === 1 && (await state()).selected === another, 'Enter on a point loads its picture');

  const errors = events.filter(e => e.method === 'Runtime.exceptionThrown').map(e => e.params.exceptionDetails.exception.description);
  check(errors.length === 0, `errors of the page: ${errors}`);
  console.log(`${checks} checks, ${faults} faults`);
}
main().catch(error => { console.log('FAULT ' + error.stack); faults = 1; }).finally(() => {
  browser.on('exit', () => {
    // Its other processes may still write there.
    fs.rmSync(profile, {recursive: true, force: true, maxRetries: 20, retryDelay: 100});
    process.exit(faults ? 1 : 0);
  });
  browser.kill('SIGKILL');
});
