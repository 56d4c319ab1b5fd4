// Looks at a store that was imported: what the dataset did not say of points is not painted and cannot be chosen, and nobody is told
// to run a stage that has no log.
//
//     node test/imported.mjs CHROMIUM ADDRESS FOLDER      screenshots go to FOLDER

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
  const page = await browser.page({ width: 1440, height: 900 })
  const show = async (name, hash) => {
    await page.open(`${address}#${hash}`)
    await page.until(`${settled} && ${has3d}`)
    await page.evaluate('new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))')
    await writeFile(path.join(folder, `imported-${name}.png`), await page.picture())
  }
  const off = () => page.evaluate(`[...document.getElementById('coloring').options].filter(o => o.disabled).map(o => o.textContent)`)
  const legend = () => page.evaluate(`document.getElementById('legend').textContent`)
  const painted = () => page.evaluate(`convoy.view.style.shared.coloring.value`)
  const notes = () => page.evaluate(`[...document.querySelectorAll('.note')].map(n => n.textContent).join('\\n')`)

  // A link from elsewhere chooses tags: heights are shown, and it is said why.
  for (const [color, name] of [['tag', 'semantic tag'], ['id', 'object id'], ['intensity', 'intensity']]) {
    await show(color, `sensor=LIDAR&color=${color}`)
    assert.deepEqual(await off(), ['semantic tag (not known)', 'object id (not known)', 'intensity (not known)'])
    assert.match(await legend(), new RegExp(`No ${name} of LIDAR is known: the dataset that was imported does not say it. Coloured by height`))
    assert.equal(await painted(), 0)
  }
  // C passes over them, also from a choice that cannot be shown.
  await page.press('c', 'KeyC')
  assert.equal(await page.evaluate('convoy.choices.color'), 'agent')
  await page.press('c', 'KeyC')
  assert.equal(await page.evaluate('convoy.choices.color'), 'plain')
  await page.press('c', 'KeyC')
  assert.equal(await page.evaluate('convoy.choices.color'), 'height')
  // A semantic lidar has its tags and ids.
  await show('semantic', 'sensor=SEG-LIDAR&color=tag')
  assert.deepEqual(await off(), ['intensity (not known)'])
  assert.equal(await painted(), 1)
  assert.doesNotMatch(await legend(), /known/)
  // Another sensor is another thing: choosing the lidar here and going back.
  const choose = async sensor => {
    await page.evaluate(`(s => { s.value = '${sensor}'; s.dispatchEvent(new Event('change')) })(document.getElementById('sensor'))`)
    await page.until(`${settled} && ${has3d}`)
  }
  await choose('LIDAR')
  assert.deepEqual([await painted(), await page.evaluate('convoy.choices.color')], [0, 'tag'])
  await choose('SEG-LIDAR')
  assert.equal(await painted(), 1)
  await show('radars', 'sensor=Radars&color=id')
  assert.equal(await painted(), 0)

  assert.doesNotMatch(await notes(), /spawn-planner|make dataset|render-sensors/)
  assert.match(await page.evaluate(`document.getElementById('map-legend').textContent`), /imported without its map/)
  assert.match(await page.evaluate(`document.getElementById('facts').textContent`), /imported/)
  assert.deepEqual(page.errors, [])
} finally {
  await browser.stop()
}
