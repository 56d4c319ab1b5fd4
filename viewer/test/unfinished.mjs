// Looks at a store of which only the simulation is made: boxes and the map are shown, for all else the page says which stage to run.
//
//     node test/unfinished.mjs CHROMIUM ADDRESS

import assert from 'node:assert/strict'
import { Chromium } from './chromium.mjs'

const [program, address] = process.argv.slice(2)
const browser = await Chromium.start(program)
try {
  const page = await browser.page({ width: 1440, height: 900 })
  const settled = `window.convoy?.scene && !document.querySelector('.note.busy') && !convoy.scene.cache.pool.running.size && !convoy.isDirty`
  const texts = async (hash, selector) => {
    await page.open(`${address}#${hash}`)
    await page.until(settled)
    return page.evaluate(`[...document.querySelectorAll('${selector}')].map(n => n.textContent).join('\\n')`)
  }
  const notes = await texts('layers=points,boxes,map,voxels', '.note')
  assert.match(notes, /make stage STAGE=render-sensors SCENES=0/)
  assert.match(notes, /make stage STAGE=occupancy-gt SCENES=0/)
  assert.match(notes, /Not made yet: render-sensors, bev-gt, occupancy-gt, postprocess-valid, merge-tracks/)
  assert.ok(await page.evaluate('convoy.boxesShown().length') > 0, 'raw boxes are shown before tracks are merged')
  assert.ok(await page.evaluate('convoy.view.elements?.length') > 0, 'the map is shown')
  assert.match(await texts('view=cameras', '#view-cameras'), /make stage STAGE=render-sensors SCENES=0/)
  assert.match(await texts('view=bev', '#view-bev'), /make stage STAGE=bev-gt SCENES=0/)
  assert.deepEqual(page.errors, [])
} finally {
  await browser.stop()
}
