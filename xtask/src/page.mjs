// Uses a report as a reader would and checks what moved: node page.mjs CHROMIUM REPORT...
import assert from 'node:assert/strict';
import { chromium } from 'playwright-core';

const [executablePath, ...reports] = process.argv.slice(2);
const flags = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync'];
const browser = await chromium.launch({ executablePath, args: flags });

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
    page.on('request', request => request.url().startsWith('file:') || complaints.push(`asks for ${request.url()}`));
    await page.goto(`file://${report}`);
    const rests = await page.isHidden('#play');
    await (rests ? swing(page) : use(page));
    await fitsAPhone(page);
    assert.deepEqual(complaints, [], report);
    await page.close();
    console.log(`${report.split('/').at(-2)}: ${rests ? 'shows its modes' : 'slides, plays, switches'}, fits`);
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
    const drawings = new Set();
    for (const choice of choices) {
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
}

async function swing(page) {
    const modes = await page.$$('.mode svg');
    const lines = await page.$$eval('#small tbody tr', rows => rows.length);
    assert.ok(modes.length > 0 && modes.length === lines, 'every mode has a line and a picture');
    const points = await page.$$eval('#small tbody th', cells => cells.flatMap(cell => cell.textContent.split(',')).length);
    assert.equal(await page.$$eval('#small circle title', titles => titles.length), points, 'every eigenvalue is a point of the plane');
    for (const mode of modes) {
        const still = await mode.innerHTML();
        await mode.hover();
        await page.waitForFunction(([svg, still]) => svg.innerHTML !== still, [mode, still]);
    }
}

async function fitsAPhone(page) {
    await page.setViewportSize({ width: 360, height: 740 });
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 360, `${width} pixels wide on a phone of 360`);
}
