// Checks of the page's tools, one each: what a reader does, and what the page must show then.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFile } from 'node:fs/promises';

// A message shows what differs, and two drawings would be all of it.
const digest = text => createHash('sha256').update(text).digest('hex');
const drawing = async page => digest(await page.$eval('#stage', element => element.innerHTML));
const time = page => page.$eval('#time', element => Number(element.dataset.value));
const settled = page => page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
const curves = async page => digest(await page.$$eval('.plot .curve', paths => paths.map(path => path.getAttribute('d')).join()));
const axisTitles = page => page.$$eval('.plot .axis-title', texts => texts.map(text => text.textContent));

/** Middle of an element on the screen, after it has been scrolled there. */
async function middle(page, selector) {
    const element = await page.$(selector);
    await element.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await element.boundingBox();
    return { x: x + width / 2, y: y + height / 2, width, height };
}

async function drag(page, from, by) {
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(from.x + by.x, from.y + by.y, { steps: 4 });
    await page.mouse.up();
    await settled(page);
}

/** What a tool must change, within a second. */
async function changes(look, act, what) {
    const before = await look();
    await act();
    for (let wait = 0; wait < 20 && await look() === before; wait++) await pause();
    assert.notEqual(await look(), before, what);
}

const pause = () => new Promise(done => setTimeout(done, 50));

export async function frames(page) {
    await page.click('#back');
    const from = await time(page);
    await page.click('#on');
    const next = await time(page);
    assert.ok(next > from, 'one instant on');
    await page.click('#back');
    assert.equal(await time(page), from, 'one instant back');
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('.');
    assert.equal(await time(page), next, 'the key . goes one instant on');
    await page.keyboard.press('Home');
    const first = await time(page);
    await page.keyboard.press('End');
    assert.ok(await time(page) > first, 'End is behind Home');
}

export async function loops(page) {
    const count = await page.$eval('#scrub', scrub => Number(scrub.max));
    const set = async index => page.$eval('#scrub', (scrub, index) => { scrub.value = index; scrub.dispatchEvent(new Event('input')); }, index);
    const first = await page.$eval('#speed', speed => { const before = speed.value; speed.value = 10; speed.dispatchEvent(new Event('change')); return before; });
    await page.selectOption('#loop', 'once');
    await set(count - 1);
    await page.click('#play');
    await page.waitForFunction(() => document.querySelector('#play').textContent === 'Play');
    assert.equal(await page.$eval('#scrub', scrub => Number(scrub.value)), count, 'once stops at the end');
    await page.selectOption('#loop', 'pingpong');
    await set(count - 1);
    await page.click('#play');
    await page.waitForFunction(most => Number(document.querySelector('#scrub').value) < most - 1, count, { timeout: 5000 });
    assert.equal((await page.textContent('#play')).trim(), 'Pause', 'to and fro goes on');
    await page.click('#play');
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('l');
    assert.notEqual(await page.$eval('#loop', loop => loop.value), 'pingpong', 'the key l chooses the next');
    await page.$eval('#speed', (speed, first) => { speed.value = first; speed.dispatchEvent(new Event('change')); }, first);
}

export async function abscissa(page) {
    if (await page.isHidden('#over')) return;
    await page.selectOption('#over', '');
    assert.ok((await axisTitles(page)).some(title => title.startsWith('t [')), 'plots over time');
    const name = await page.$eval('#over option:last-child', option => option.value);
    // At constant speed from 0 the curves keep their shape: the axis tells.
    await changes(async () => (await axisTitles(page)).join(), () => page.selectOption('#over', name), 'plots over an angle');
    assert.ok((await axisTitles(page)).some(title => title === `${name} [°]`), `${name} in degrees`);
}

export async function degrees(page) {
    if (await page.isHidden('#degrees')) return;
    const texts = () => page.$$eval('#values td, .plot .axis-title', cells => cells.map(cell => cell.textContent).join());
    assert.ok((await texts()).includes('°'), 'degrees at first');
    await changes(texts, () => page.uncheck('#degrees'), 'values or plots in radians');
    assert.ok(!(await axisTitles(page)).some(title => title.includes('°')), 'no plot in degrees');
    await page.check('#degrees');
}

export async function camera(page) {
    const look = () => drawing(page);
    await changes(look, async () => { await page.click('#camera button:nth-child(1)'); await settled(page); }, 'zooms in');
    const at = await middle(page, '#stage');
    await changes(look, async () => { await page.mouse.move(at.x, at.y); await page.keyboard.down('Control'); await page.mouse.wheel(0, -200); await page.keyboard.up('Control'); await settled(page); }, 'the wheel zooms');
    await page.keyboard.down('Shift');
    await changes(look, () => drag(page, at, { x: 40, y: 20 }), 'pans');
    await page.keyboard.up('Shift');
    await page.click('#camera button:nth-child(3)');
    await settled(page);
    if (await page.$eval('#stage', stage => !stage.querySelector('.triad'))) return;
    const places = () => page.$$eval('#stage .triad path', paths => paths.map(path => path.getAttribute('d')).join());
    await changes(places, () => drag(page, at, { x: 60, y: 25 }), 'an orbit turns the axes');
    await changes(places, async () => { await page.click('#camera button:has-text("xy")'); await settled(page); }, 'looks at a plane');
    await page.click('#camera button:nth-child(3)');
    await settled(page);
}

const drawn = {
    trace: '.trace', velocity: '.arrow[style*="--velocity"]', acceleration: '.arrow[style*="--acceleration"]', forces: '.arrow.force', labels: 'text.label, text.name',
};

export async function switches(page) {
    await page.$eval('#scrub', scrub => { scrub.value = Math.round(scrub.max / 3); scrub.dispatchEvent(new Event('input')); });
    for (const [key, selector] of Object.entries(drawn)) {
        const box = await page.$(`#show-${key}`);
        if (!box) continue;
        const count = () => page.$$eval(`#stage :is(${selector})`, nodes => nodes.filter(node => !node.closest('[hidden]') && node.getAttribute('d') !== '').length);
        const before = await count();
        assert.ok(before > 0 || key === 'velocity' || key === 'acceleration', `${key} is drawn`);
        await box.uncheck();
        assert.equal(await count(), 0, `${key} is switched off`);
        await box.check();
        assert.equal(await count(), before, `${key} is back`);
    }
}

export async function zoomOfPlots(page) {
    const look = () => curves(page), before = await look();
    await page.check('#drag input[value="zoom"]');
    const box = await middle(page, '.plot .chart');
    await changes(look, () => drag(page, { x: box.x - box.width / 6, y: box.y }, { x: box.width / 4, y: 0 }), 'dragging zooms');
    await page.check('#drag input[value="pan"]');
    const pan = await middle(page, '.plot .chart');
    await changes(look, () => drag(page, pan, { x: -30, y: 0 }), 'dragging pans');
    await page.click('#unzoom');
    assert.equal(await look(), before, 'all is shown again');
    const over = await middle(page, '.plot .chart');
    await changes(look, async () => { await page.mouse.move(over.x, over.y); await page.keyboard.down('Control'); await page.mouse.wheel(0, -100); await page.keyboard.up('Control'); await settled(page); }, 'the wheel zooms');
    await page.mouse.dblclick(over.x, over.y);
    assert.equal(await look(), before, 'a double click shows all');
    await page.check('#drag input[value="time"]');
}

export async function cursor(page) {
    const at = await middle(page, '.plot .chart');
    await page.mouse.move(at.x, at.y);
    await settled(page);
    const [plots, lines] = await page.$$eval('.plot', plots => [plots.filter(plot => plot.querySelector('.curve')).length, plots.filter(plot => plot.querySelector('.hover')).length]);
    assert.equal(lines, plots, 'the cursor is in every plot');
    assert.equal(await page.$$eval('.tip', tips => tips.filter(tip => !tip.hidden).length), 1, 'one tip');
    const places = await page.$$eval('.plot > .cursor', cursors => cursors.length);
    assert.ok(places >= plots, 'the time is marked in every plot');
    await page.mouse.move(1, 1);
}

export async function styles(page) {
    const groups = await page.$$eval('.group .legend', legends => legends.map(legend => [...legend.querySelectorAll('button svg path')].map(path => path.getAttribute('style').replace(/stroke-width[^;]*/, ''))));
    for (const group of groups) assert.ok(new Set(group).size >= Math.min(group.length, 12), 'at least 12 line styles can be told apart');
}

async function download(page, selector) {
    const [file] = await Promise.all([page.waitForEvent('download', { timeout: 60_000 }), page.click(selector)]);
    return [file.suggestedFilename(), await readFile(await file.path())];
}

export async function files(page, withVideo) {
    const [name, svg] = await download(page, '#save-svg');
    assert.ok(name.endsWith('.svg') && svg.toString().startsWith('<svg') && svg.includes('--paper:'), 'an SVG with its colours');
    const [, png] = await download(page, '#save-png');
    assert.deepEqual([...png.subarray(1, 4)], [...Buffer.from('PNG')], 'a PNG');
    const opened = await page.evaluate(async bytes => { const image = await createImageBitmap(new Blob([new Uint8Array(bytes)])); return image.width; }, [...png]);
    assert.ok(opened > 300, 'a PNG that opens');
    const [, csv] = await download(page, '#save-csv');
    const lines = csv.toString().trim().split('\n');
    assert.ok(lines[0].startsWith('run,t [s],') && !/\*|\^/.test(lines[0]), `units in one spelling: ${lines[0].slice(0, 200)}`);
    assert.ok(lines.length > 1, 'a line an instant');
    if (!withVideo) return;
    await page.$eval('#speed', speed => { speed.value = 10; speed.dispatchEvent(new Event('change')); });
    const [, gif] = await download(page, '#save-gif');
    assert.equal(gif.subarray(0, 6).toString(), 'GIF89a', 'a GIF');
    // The browser's own decoder, and its first picture beside the PNG of the start.
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('Home');
    const [, still] = await download(page, '#save-png');
    const { frames, off, moved } = await page.evaluate(async ([gif, png]) => {
        const decoder = new ImageDecoder({ type: 'image/gif', data: new Uint8Array(gif) });
        await decoder.tracks.ready;
        await decoder.completed;
        const { frameCount } = decoder.tracks.selectedTrack;
        const pixels = (image, width, height) => {
            const context = new OffscreenCanvas(width, height).getContext('2d');
            context.drawImage(image, 0, 0, width, height);
            return context.getImageData(0, 0, width, height).data;
        };
        const [first, later] = await Promise.all([0, Math.floor(frameCount / 3)].map(async frameIndex => (await decoder.decode({ frameIndex })).image));
        const [width, height] = [first.displayWidth, first.displayHeight];
        const [begin, then, drawn] = [first, later, await createImageBitmap(new Blob([new Uint8Array(png)]))].map(image => pixels(image, width, height));
        /** Share of the pixels that differ by more than the palette and the edges of lines do. */
        const differing = (a, b) => { let count = 0; for (let i = 0; i < a.length; i += 4) if ([0, 1, 2].some(c => Math.abs(a[i + c] - b[i + c]) > 64)) count += 1; return 4 * count / a.length; };
        return { frames: frameCount, off: differing(begin, drawn), moved: differing(begin, then) };
    }, [[...gif], [...still]]);
    assert.ok(frames >= 50, `${frames} pictures of a GIF`);
    assert.ok(off < .005 && moved > 4 * off, `of the first picture ${off} differs from the drawing, ${moved} from a later one`);
    const [, video] = await download(page, '#save-webm');
    assert.deepEqual([...video.subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3], 'a WebM');
    const width = await page.evaluate(async bytes => {
        const video = Object.assign(document.createElement('video'), { muted: true, src: URL.createObjectURL(new Blob([new Uint8Array(bytes)], { type: 'video/webm' })) });
        await new Promise((done, fail) => { video.onloadeddata = done; video.onerror = () => fail(video.error); });
        return video.videoWidth;
    }, [...video]);
    assert.ok(width > 600, `${width} pixels of video`);
}

/** A slider through a parameter's range: its ends are those of the text, every stop has motions of its own. */
export async function slides(page) {
    const { range, value, unit } = await page.evaluate(() => JSON.parse(document.querySelector('#data').textContent).slider);
    const shown = async () => parseFloat((await page.textContent('#stop')).replace('−', '-'));
    const near = (a, b) => Math.abs(a - b) <= 1e-4 * Math.max(Math.abs(a), Math.abs(b));
    assert.ok(near(await shown(), value), 'it opens with the value of the run');
    // Names of points settle where they were last.
    const bodies = async () => digest(await page.$$eval('#stage path', paths => paths.map(path => path.getAttribute('d')).join()));
    const opening = [await bodies(), await curves(page)], axis = (await axisTitles(page)).join();
    for (const [end, key] of [[range[0], 'Home'], [range[1], 'End']]) {
        await page.focus('#slide');
        await page.keyboard.press(key);
        await settled(page);
        assert.ok(near(await shown(), end), `${key} is the end of the range, ${end} ${unit}: ${await shown()}`);
        if (await page.isHidden('#reason')) assert.notEqual(await bodies(), opening[0], 'another mechanism');
        else assert.match(await page.textContent('#reason'), / = .*: ./);
    }
    await page.evaluate(() => document.activeElement.blur());
    const before = await shown();
    await page.keyboard.press('[');
    assert.notEqual(await shown(), before, 'the key [ goes one stop back');
    await page.click('#slider button');
    await settled(page);
    assert.deepEqual([await bodies(), await curves(page)], opening, 'reset leads back');
    assert.equal((await axisTitles(page)).join(), axis);
}

export async function units(page) {
    const text = await page.$$eval('main table, .axis-title, .tip, #show', nodes => nodes.map(node => node.textContent).join('\n'));
    assert.ok(!/N\*m|m\/s\^2|\)\/s/.test(text), 'units in one spelling');
}

/** Values of one unit in a column have as many decimals. */
export async function digits(page) {
    const rows = await page.$$eval('#values tbody tr', rows => rows.map(row => [...row.cells].slice(1).map(cell => cell.textContent.trim())));
    for (const column of rows[0] ? rows[0].map((_, i) => rows.map(row => row[i])) : []) {
        const byUnit = new Map();
        for (const text of column) {
            const [, number, unit] = /^(\S+)\s*(.*)$/.exec(text);
            if (/×|–|^0$/.test(number)) continue;
            byUnit.set(unit, [...(byUnit.get(unit) || []), (number.split('.')[1] || '').length]);
        }
        for (const [unit, decimals] of byUnit) assert.equal(new Set(decimals).size, 1, `equal digits in ${unit}: ${column}`);
    }
}

/** What rounding leaves of zero is shown as zero, at any instant. */
export async function zeros(page) {
    for (const part of [0, .13, .5, .77, 1]) {
        await page.$eval('#scrub', (scrub, part) => { scrub.value = Math.round(part * scrub.max); scrub.dispatchEvent(new Event('input')); }, part);
        const texts = await page.$$eval('#values td, #loads td', cells => cells.map(cell => cell.textContent));
        assert.deepEqual(texts.filter(text => /×10⁻(¹[³⁴⁵⁶⁷⁸⁹]|[²³⁴⁵⁶⁷⁸⁹][⁰¹²³⁴⁵⁶⁷⁸⁹])/.test(text)), [], 'noise in place of zero');
    }
}

export async function folded(page) {
    if (await page.isHidden('#fold-multipliers')) return;
    assert.equal(await page.$eval('#fold-multipliers', fold => fold.open), false, 'multipliers are folded away');
    await page.click('#fold-multipliers > summary');
    assert.ok(await page.$eval('#multipliers', host => host.offsetHeight > 20), 'and open on demand');
    await page.click('#fold-multipliers > summary');
}
