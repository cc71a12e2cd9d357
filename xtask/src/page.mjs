// Uses a report as a reader would and checks what moved: node page.mjs CHROMIUM REPORT...
import assert from 'node:assert/strict';
import { chromium } from 'playwright-core';
import { study } from './cost.mjs';
import * as tools from './tools.mjs';

const [executablePath, ...reports] = process.argv.slice(2);
const flags = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync'];
const browser = await chromium.launch({ executablePath, args: flags });

let filmed = false; // one video is enough

// Two at a time: a page waits for its drawings as long as it computes.
const waiting = [...reports];
await Promise.all([openOneByOne(), openOneByOne()]);
await browser.close();
console.log(`${reports.length} passed, 0 failed`);

async function openOneByOne() {
    for (let report = waiting.shift(); report !== undefined; report = waiting.shift()) await open(report);
}

async function open(report) {
    const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
    const complaints = [];
    page.on('console', message => complaints.push(message.text()));
    page.on('pageerror', error => complaints.push(error.message));
    page.on('request', request => /^(file|data|blob):/.test(request.url()) || complaints.push(`asks for ${request.url()}`));
    await page.goto(`file://${report}`);
    if (report.endsWith('/cost.html')) {
        await study(page);
        assert.deepEqual(complaints, [], report);
        await page.close();
        console.log(`${report.split('/').at(-2)}: curves, figures, dragged error, fits`);
        return;
    }
    const kind = await page.evaluate(() => JSON.parse(document.querySelector('#data').textContent).analysis);
    const rests = await page.isHidden('#play');
    if (rests) await (kind === 'equilibrium' ? rest(page) : swing(page));
    else await use(page);
    if (kind === 'inverse') await forces(page);
    if (report.includes('-ended/')) await end(page);
    if (report.includes('-overlaid/')) await overlaid(page);
    if (report.includes('-sliding/')) await tools.slides(page);
    await fitsAPhone(page);
    assert.deepEqual(complaints, [], report);
    await page.close();
    const did = { equilibrium: 'says its verdict', modes: 'shows its modes', inverse: 'plots its forces' }[kind] || 'slides, plays, switches';
    console.log(`${report.split('/').at(-2)}: ${did}, fits`);
}

async function use(page) {
    const time = () => page.$eval('#time', element => Number(element.dataset.value));
    const drawing = () => page.$eval('#stage', element => element.innerHTML);
    const before = { time: await time(), drawing: await drawing() };
    await page.focus('#scrub');
    for (let key = 0; key < 20; key++) await page.keyboard.press('ArrowRight');
    assert.ok(await time() > before.time, 'the slider moves the time');
    assert.notEqual(await drawing(), before.drawing, 'the slider moves the mechanism');

    const still = await time();
    await page.click('#play');
    await page.waitForFunction(from => Number(document.querySelector('#time').dataset.value) !== from, still);
    assert.equal((await page.textContent('#play')).trim(), 'Pause');
    await page.keyboard.press('Space');
    assert.equal((await page.textContent('#play')).trim(), 'Play', 'the space bar pauses');

    const choices = await page.$$eval('#assembly input', inputs => inputs.map(input => input.value));
    assert.equal(await page.isHidden('#assembly'), choices.length === 1, 'one choice is none');
    const drawings = new Set([await drawing()]);
    if (choices.length > 1) drawings.clear();
    for (const choice of choices.length > 1 ? choices : []) {
        await page.check(`#assembly input[value="${choice}"]`);
        drawings.add(await drawing());
    }
    assert.equal(drawings.size, choices.length, 'every assembly looks different');

    const plot = await page.$('.plot');
    await plot.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await plot.boundingBox();
    await page.mouse.move(x + 0.4 * width, y + height / 2);
    await page.mouse.down();
    const from = await time();
    await page.mouse.move(x + 0.8 * width, y + height / 2, { steps: 5 });
    await page.mouse.up();
    assert.ok(await time() > from, 'dragging in a plot moves the time');

    if (choices.length > 1) await page.check(`#assembly input[value="${choices[0]}"]`);
    const video = !filmed;
    filmed = true;
    for (const tool of [tools.frames, tools.loops, tools.abscissa, tools.degrees, tools.camera, tools.switches, tools.zoomOfPlots,
        tools.cursor, tools.styles, tools.units, tools.digits, tools.zeros, tools.folded]) await tool(page);
    await tools.files(page, video);
}

/** A page of a rest: its verdict in words before all else, the stable rest on show, nothing that needs a time. */
async function rest(page) {
    const verdicts = await page.$$eval('.verdict', lines => lines.map(line => [line.dataset.course, line.textContent, line.getAttribute('aria-pressed')]));
    assert.ok(verdicts.length > 0, 'a verdict');
    const chosen = verdicts.find(([, , pressed]) => pressed === 'true');
    if (verdicts.some(([course]) => course !== 'unstable')) assert.notEqual(chosen[0], 'unstable', 'the stable rest is on show');
    for (const [course, text] of verdicts) if (course === 'unstable') assert.match(text, /unstable;.*e-fold [\d.e−-]+ s/);
    const [verdict, stage] = await page.$$eval('#verdicts, #stage', nodes => nodes.map(node => node.getBoundingClientRect().top));
    assert.ok(verdict < stage, 'the verdict stands before the drawing');
    for (const hidden of ['.transport', '#time', '#plots']) assert.ok(await page.isHidden(hidden), `${hidden} is not there`);
    assert.equal(await page.$$eval('#values thead th', cells => cells.length), 2, 'no rates');
    const forces = await page.$$eval('#stage .force', arrows => arrows.filter(arrow => arrow.getAttribute('d')).length);
    const expected = await page.evaluate(() => JSON.parse(document.querySelector('#data').textContent).forces.length);
    assert.ok(expected === 0 || forces > 0, 'reactions are drawn');
    for (const tool of [tools.camera, tools.degrees, tools.units, tools.digits, tools.zeros, tools.folded]) await tool(page);
    await tools.files(page, false);
}

/** A page of inverse dynamics: a small plot a force with its magnitude, over the crank's angle; arrows in the drawing. */
async function forces(page) {
    const [loads, arrows] = await page.evaluate(() => {
        const data = JSON.parse(document.querySelector('#data').textContent);
        return [new Set(data.runs[0].dynamics.loads.map(load => load.name.replace(/\.\d+$/, ''))).size, data.forces.length];
    });
    assert.equal(await page.$$eval('.small-panels .plot', plots => plots.length), loads, 'a plot a force');
    const drawn = await page.$$eval('#stage .force', nodes => nodes.filter(node => node.getAttribute('d')).length);
    assert.ok(drawn > 0 && drawn <= arrows, 'arrows in the drawing');
    assert.ok(await page.$$eval('.small-panels .axis-title', titles => titles.some(title => title.textContent.includes('N·m'))), 'a torque');
    const legend = await page.$eval('#loads .legend', legend => legend.textContent);
    assert.ok(legend.includes('|F|') && legend.includes('x') && legend.includes('y'), legend);
}

/** Measured points are dots over the curve, over the time and over an angle. */
async function overlaid(page) {
    const dots = () => page.$$eval('path.measured', paths => paths.map(path => path.getAttribute('d').split('M').length - 1));
    assert.deepEqual(await dots(), [4], 'the points within the motion are drawn, in one plot');
    const legends = await page.$$eval('.legend', legends => legends.map(legend => legend.textContent).join(' '));
    assert.match(legends, /phi3, dots: .*rocker[.]csv/, 'the legend names the table');
    const places = () => page.$eval('path.measured', path => path.getAttribute('d'));
    const overTime = await places(), choice = await page.$('#over');
    const angle = await choice.$$eval('option', options => options.map(option => option.value).find(value => value !== ''));
    await choice.selectOption(angle);
    assert.deepEqual(await dots(), [4], 'they stay over an angle');
    const numbers = d => d.match(/-?[0-9.]+/g).map(Number);
    const moved = numbers(await places()).map((x, k) => Math.abs(x - numbers(overTime)[k]));
    assert.ok(moved.every(distance => distance < 1), 'at constant speed they stand where they were');
}

/** A page of a motion that ends early: the end in words and marked in the drawing and the plots. */
async function end(page) {
    assert.match(await page.textContent('#ended'), /^the motion ends at t = [\d.]+ s: /);
    assert.ok(await page.$eval('#stage', stage => stage.querySelector('path.end') !== null), 'marked in the drawing');
    const [plots, marked] = await page.$$eval('.plot', plots => [plots.filter(plot => plot.querySelector('.curve')).length, plots.filter(plot => plot.querySelector('path.end')).length]);
    assert.equal(marked, plots, 'marked in the plots');
}

async function swing(page) {
    // Runs of one rest are one choice, and have facts of their own.
    const [heads, labels] = await page.evaluate(() => [[...document.querySelectorAll('#facts thead th')].slice(1).map(cell => cell.textContent),
        JSON.parse(document.querySelector('#data').textContent).runs.map(run => run.label)]);
    if (heads.length) assert.deepEqual(heads, labels, 'a column of facts a run');
    const modes = await page.$$('.mode svg');
    const lines = await page.$$eval('#small tbody tr', rows => rows.length);
    assert.ok(modes.length > 0 && modes.length === lines, 'every mode has a line and a picture');
    const numbers = await page.$$eval('#small .numbers', cells => cells.flatMap(cell => cell.textContent.split(',')).length);
    const points = numbers || lines;
    assert.equal(await page.$$eval('#small circle title', titles => titles.length), points, 'every eigenvalue is a point of the plane');
    for (const mode of modes) {
        const still = await mode.innerHTML();
        await mode.hover();
        await page.waitForFunction(([svg, still]) => svg.innerHTML !== still, [mode, still]);
    }
}

async function fitsAPhone(page) {
    await page.setViewportSize({ width: 360, height: 740 });
    // The page lays itself out anew in the next frame.
    await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    const wide = await page.$$eval('body *', nodes => nodes.filter(node => node.getBoundingClientRect().right > 362 && !node.closest('.scroll, aside, pre, svg'))
        .map(node => `${node.tagName} ${node.id} ${node.className} ${node.textContent.slice(0, 30)}`));
    assert.ok(width <= 360, `${width} pixels wide on a phone of 360: ${wide.slice(0, 4)}`);
}
