// Asks the page what partners add and what a model saw, of a store with predictions.
//
//     node test/ask.mjs CHROMIUM ADDRESS FOLDER      screenshots go to FOLDER
//
// ADDRESS: http://127.0.0.1:PORT/ of `convoy view STORE --predictions FILE`, or file:///EXCERPT.html.

import assert from 'node:assert/strict'
import { mkdir, writeFile } from 'node:fs/promises'
import path from 'node:path'
import { Chromium } from './chromium.mjs'

const [program, address, folder] = process.argv.slice(2)
const settled = `window.convoy?.scene && !document.querySelector('.note.busy') && !convoy.scene.cache.pool.waiting.length && !convoy.scene.cache.pool.running.size && !convoy.isDirty`
const has3d = `convoy.pointsFrame === convoy.frame && convoy.pointCount > 0`

await mkdir(folder, { recursive: true })
const browser = await Chromium.start(program)
try {
  for (const [name, size] of Object.entries({ desktop: { width: 1440, height: 900 }, phone: { width: 390, height: 844, isPhone: true } })) {
    const page = await browser.page(size)
    await model(page, name)
    await partners(page, name)
    if (name === 'desktop') await tools(page)
    if (name === 'desktop' && !address.startsWith('file:')) await memory(page)
    assert.deepEqual(page.errors, [])
    await page.close()
  }
} finally {
  await browser.stop()
}

async function show(page, name, hash, ready = has3d) {
  await page.open('about:blank')
  await page.open(`${address}#${hash}`)
  await page.until(`${settled} && ${ready}`)
  await page.evaluate('new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))')
  await writeFile(path.join(folder, `${name}.png`), await page.picture())
  const [wide, seen] = await page.evaluate('[document.documentElement.scrollWidth, innerWidth]')
  assert.ok(wide <= seen, `${name}: the page is ${wide} wide, the screen ${seen}`)
}

/** The numbers that lie over the picture. */
function tally(page) {
  return page.evaluate(`[...document.querySelectorAll('#tally b')].map(b => Number(b.textContent))`)
}

async function model(page, name) {
  await show(page, `${name}-model`, 'ask=model&color=plain&mode=top')
  const targets = await page.evaluate(`convoy.ask.look().sample.targets.length`)
  assert.ok(targets > 5, `${targets} targets`)
  const [found, missed, wrong] = await tally(page)
  assert.equal(found + missed, targets)
  assert.ok(found > 0, 'something is found')
  // Every box on the screen has one of four colours; as many predictions as were found or are false.
  const drawn = await page.evaluate(`(() => {
    const boxes = convoy.boxesShown()
    return { found: boxes.filter(b => b.result === 'right').length, wrong: boxes.filter(b => b.result === 'false').length, truths: boxes.filter(b => !b.isPrediction).length }
  })()`)
  assert.deepEqual(drawn, { found, wrong, truths: targets })
  // From the least score on there are false ones; with the highest alone nearly all is missed.
  const slide = async value => {
    await page.evaluate(`(e => { e.value = ${value}; e.dispatchEvent(new Event('input')) })(document.getElementById('score'))`)
    await page.until(settled)
    return tally(page)
  }
  const all = await slide(0)
  assert.ok(all[2] > 0 && all[0] + all[1] === targets, `${all}`)
  const surest = await slide(400)
  assert.ok(surest[0] <= 1 && surest[0] + surest[1] === targets, `${surest}`)
  const link = await page.evaluate('convoy.linkHash()')
  assert.match(link, /ask=model/)
  assert.match(link, /score=/)
  // The worst frames are in order, and lead to what they say.
  await slide(0)
  const worst = await page.evaluate(`convoy.ask.counts().worst.map(w => w.missed + w.false)`)
  assert.ok(worst.length > 0 && worst.every((n, i) => i === 0 || n <= worst[i - 1]), `${worst}`)
  await page.evaluate(`document.querySelector('#worst li:last-child button').click()`)
  await page.until(settled)
  const [, lastMissed, lastWrong] = await tally(page)
  assert.equal(lastMissed + lastWrong, worst.at(-1))
}

async function partners(page, name) {
  await show(page, `${name}-partners`, 'ask=partners&color=agent&mode=top&partners=x2x&range=1000&elevation=100')
  const [ego, added, neither] = await tally(page)
  assert.ok(ego > 0, 'the ego sees something')
  const agents = await page.evaluate('convoy.scene.agents.length')
  assert.ok(agents > 1 && await page.evaluate('convoy.ask.look().links.filter(l => l.isStrong).length') === agents - 1, 'a line to each partner')
  assert.ok(await page.evaluate('convoy.view.links.strong.visible'))
  // Alone, what partners added is seen by neither, and their points are gone.
  const count = await page.evaluate('convoy.pointCount')
  await show(page, `${name}-alone`, 'ask=partners&color=agent&mode=top&partners=none')
  assert.deepEqual(await tally(page), [ego, 0, neither + added])
  assert.ok(await page.evaluate('convoy.pointCount') < count, 'fewer points')
  assert.equal(await page.evaluate('convoy.view.links.strong.visible'), false)
}

async function tools(page) {
  const id = await page.evaluate(`convoy.scene.tables.boxesAt(convoy.frame).find(b => b.seenBy.length && !convoy.scene.agents.some(a => a.id === b.id)).id`)
  await page.press('/', 'Slash')
  assert.equal(await page.evaluate('document.activeElement.id'), 'search-id')
  await page.evaluate(`document.getElementById('search-id').value = '${id}'; document.getElementById('search').requestSubmit()`)
  await page.until(`${settled} && convoy.chosen === ${id}`)
  await page.evaluate(`document.getElementById('search-id').value = '65000'; document.getElementById('search').requestSubmit()`)
  assert.match(await page.evaluate(`document.getElementById('notes').textContent`), /No list of this scene has object 65000/)
  // Two clicks measure: on the ground, as there are no points.
  await show(page, 'desktop-measure', 'layers=grid&mode=top', settled)
  await page.press('u', 'KeyU')
  await page.click(600, 400)
  await page.click(700, 400)
  const label = await page.evaluate('convoy.view.labelList[0].text')
  assert.match(label, /^\d+\.\d\d m \(across \d/)
  await page.press('Escape')
  assert.equal(await page.evaluate('convoy.view.measure.isOn'), false)
  if (await page.evaluate('[...convoy.scene.cameras(convoy.ego).keys()].length') === 0) return
  await show(page, 'desktop-cameras-of-agents', 'view=cameras&grid=agents', 'convoy.grid.pictures.size === convoy.scene.agents.filter(a => convoy.scene.cameras(a.name).size).length')
  const seen = await page.evaluate(`convoy.scene.tables.boxesAt(0).filter(b => b.seenBy.length > 0).map(b => b.id)`)
  let pictures = 0
  for (const object of seen) {
    await page.evaluate(`convoy.choices.grid = 'object', convoy.chosen = ${object}, convoy.update()`)
    await page.until(`${settled} && convoy.grid.key?.includes(' object ')`)
    pictures = await page.evaluate('convoy.grid.pictures.size')
    if (pictures) break
  }
  assert.ok(pictures > 0, 'some object is seen by a camera')
}

/** A page without a link takes over the layout of last time; a link shows what its sender saw. */
async function memory(page) {
  const hasGrid = async hash => {
    await page.open('about:blank')
    await page.open(`${address}${hash}`)
    await page.until(settled)
    return page.evaluate(`convoy.choices.layers.has('grid')`)
  }
  assert.equal(await hasGrid(''), true)
  await page.press('g', 'KeyG')
  await page.until(`localStorage.getItem('convoy-layout')?.includes('layers=')`)
  assert.equal(await hasGrid(''), false)
  assert.equal(await hasGrid('#frame=1'), true)
  // The picture that would be saved has more than its ground.
  const bytes = await page.evaluate(`convoy.view.picture().then(blob => blob.size)`)
  assert.ok(bytes > 20_000, `${bytes} bytes`)
}
