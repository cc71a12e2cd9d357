// Checks of the page of `mbs cost`: what a reader does, and what the page must show then.
import assert from 'node:assert/strict';

const chosen = page => page.$eval('#chosen', element => element.textContent);
const spots = (page, curve) => page.$$eval('#time .spot', (all, curve) => all.filter(spot => spot.dataset.curve === curve).length, curve);

/** Uses the page as a reader would. */
export async function study(page) {
    const names = await page.$$eval('#legend button', buttons => buttons.map(button => button.textContent));
    assert.ok(names.length >= 3, 'at least three curves');
    assert.match(await page.$eval('#sentence', element => element.textContent), /^\d(\.\d)?e-\d+: /, 'the choice in one sentence');
    assert.ok(await page.$eval('#kinematics-panel', panel => panel.hidden), 'sines are compared in motions from drives');
    const shown = await page.$eval('#legend button:not(.off)', button => button.textContent);
    const count = await spots(page, shown);
    assert.ok(count > 2, 'a curve has points');
    await page.click('#legend button:not(.off)');
    assert.equal(await spots(page, shown), 0, 'a click hides a curve');
    await page.click('#front');
    assert.equal(await spots(page, shown), count, 'the front shows it again');
    await page.$eval('#time .area', area => area.dispatchEvent(new PointerEvent('pointerenter', { clientX: 100, clientY: 100 })));
    assert.ok(await page.isVisible('#tip'), 'figures under the pointer');
    assert.match(await page.$eval('#tip', element => element.textContent), /error.*time.*evaluations/s, 'with error, time and counts');
    await drags(page);
    const before = await page.$eval('#counts', element => element.innerHTML);
    await page.selectOption('#count', 'steps');
    assert.notEqual(await page.$eval('#counts', element => element.innerHTML), before, 'another count');
    assert.match(await page.$eval('#rust', element => element.textContent), /Simulation|Stepper/, 'Rust of the choice');
    await fits(page);
}

async function drags(page) {
    const before = await chosen(page);
    const handle = await page.$('#time .handle');
    await handle.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await handle.boundingBox();
    const from = { x: x + width / 2, y: y + height / 2 };
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(from.x, from.y - 90, { steps: 5 });
    await page.mouse.up();
    assert.notEqual(await chosen(page), before, 'another error asked for chooses another setting');
}

async function fits(page) {
    await page.setViewportSize({ width: 390, height: 844 });
    const [inside, wide] = await page.evaluate(() => [innerWidth, document.documentElement.scrollWidth]);
    assert.ok(wide <= inside, `the page is ${wide} px wide on a phone of ${inside} px`);
}
