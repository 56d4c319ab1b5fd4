// Looks at the page as people do: every mode at a desktop's and a phone's width, with keys and links. Errors on the console fail.
//
//     node test/look.mjs CHROMIUM ADDRESS FOLDER [--script-ms MS]        ADDRESS: http://127.0.0.1:PORT/, or file:///EXCERPT.html
//
// Screenshots and measures.json go to FOLDER. With --script-ms more milliseconds of script for a frame that is played fail; without
// it no time does, as machines are busy with other things.

import assert from 'node:assert/strict'
import { mkdir, writeFile } from 'node:fs/promises'
import path from 'node:path'
import { Chromium } from './chromium.mjs'

const [program, address, folder, flag, value] = process.argv.slice(2)
const mostMs = flag === undefined ? Infinity : Number(value)
if (!folder || (flag !== undefined && flag !== '--script-ms') || !(mostMs > 0)) {
  console.error('usage: node look.mjs CHROMIUM ADDRESS FOLDER [--script-ms MS]')
  process.exit(2)
}
const isExcerpt = address.startsWith('file:')
const settled = `window.convoy?.scene && !document.querySelector('.note.busy') && !convoy.scene.cache.pool.waiting.length && !convoy.scene.cache.pool.running.size && !convoy.isDirty`
const has3d = `convoy.pointsFrame === convoy.frame && convoy.pointCount > 0`

const base = 'layers=points,boxes,labels,map,grid'
const modes = {
  '3d-height': ['', has3d],
  '3d-tag': ['color=tag', has3d],
  '3d-id': ['color=id&boxes=id', has3d],
  '3d-intensity': ['color=intensity', has3d],
  '3d-agent': ['color=agent&boxes=agent', has3d],
  '3d-top': ['mode=top&color=tag', has3d],
  '3d-chase': ['mode=chase&color=tag', has3d],
  tracks: [`${base},tracks&mode=top&frame=12`, has3d],
  map: ['layers=map,grid,boxes&mode=top', 'convoy.map'],
  bev: ['view=bev', `document.querySelector('#view-bev canvas').width > 300`],
}
const stored = {
  cameras: ['view=cameras', 'convoy.grid.pictures.size > 0'],
  'cameras-masks': ['view=cameras&marks=masks,boxes2d', 'convoy.grid.pictures.size > 0'],
  'cameras-one': ['view=cameras&camera=CAM_FRONT&marks=boxes,names,masks', 'convoy.grid.pictures.size === 1'],
  'cameras-instance': ['view=cameras&kind=IST', 'convoy.grid.pictures.size > 0'],
  voxels: ['layers=voxels,grid,labels', 'convoy.view.voxels.shown?.count > 0'],
  'voxels-near': ['layers=voxels&voxels=near&mode=chase', 'convoy.view.voxels.shown?.count > 0'],
}

await mkdir(folder, { recursive: true })
const browser = await Chromium.start(program)
const measures = {}
try {
  await desktop()
  await phone()
} finally {
  await browser.stop()
}
await writeFile(path.join(folder, 'measures.json'), JSON.stringify(measures, null, 2))
console.log(JSON.stringify(measures))
const { scriptMsPerFrame, points } = measures.playing
console.log(`script: ${scriptMsPerFrame.toFixed(1)} ms a frame at ${points.toLocaleString('en')} points`)
if (scriptMsPerFrame > mostMs) {
  console.error(`that is more than ${mostMs} ms`)
  process.exitCode = 1
}

async function shot(page, name) {
  // Two frames: what was asked for is drawn, and shown.
  await page.evaluate('new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))')
  await writeFile(path.join(folder, `${name}.png`), await page.picture())
}

function link(hash) {
  return `${address}#${hash}`
}

async function show(page, name, [hash, ready]) {
  await page.open(link(hash))
  await page.until(`${settled} && ${ready}`)
  await shot(page, name)
  assert.deepEqual(page.errors, [], `${name}: the console has errors`)
  const notes = await page.evaluate(`[...document.querySelectorAll('.note, .message')].map(n => n.textContent.trim()).filter(Boolean)`)
  assert.ok(!notes.some(text => /could not|undefined|null/i.test(text)), `${name}: ${notes}`)
  measures.notes = { ...measures.notes, ...(notes.length ? { [name]: notes } : {}) }
}

async function desktop() {
  const page = await browser.page({ width: 1440, height: 900 })
  await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: 'dark' }] })
  const all = isExcerpt ? modes : { ...modes, ...stored }
  for (const [name, mode] of Object.entries(all)) await show(page, `desktop-${name}`, mode)
  await colors(page)
  await play(page)
  await keys(page)
  await picking(page)
  await names(page)
  await page.evaluate(`document.getElementById('theme').click()`)
  await page.until(settled)
  await shot(page, 'desktop-light')
  await page.press('?', 'Slash')
  await shot(page, 'desktop-help')
  assert.equal(await page.evaluate(`document.getElementById('keys').open`), true, '? opens the list of keys')
  assert.deepEqual(page.errors, [])
  await page.close()
}

/** The picture shows more than its ground. */
async function colors(page) {
  await page.open(link('color=tag&layers=points'))
  await page.until(`${settled} && ${has3d}`)
  const count = await page.evaluate(`(() => {
    convoy.view.render()
    const small = Object.assign(document.createElement('canvas'), { width: 200, height: 120 }).getContext('2d')
    small.drawImage(convoy.view.renderer.domElement, 0, 0, 200, 120)
    return new Set(new Uint32Array(small.getImageData(0, 0, 200, 120).data.buffer)).size
  })()`)
  assert.ok(count > 50, `only ${count} colours in the picture of points`)
}

/** Plays twice through what fits into memory, and measures the second time: script alone, for each frame that was drawn. */
async function play(page) {
  await page.open(link(`agents=${await firstAgent(page)}&layers=points,boxes,labels,map,grid,tracks`))
  await page.until(`${settled} && ${has3d}`)
  await page.evaluate(`(() => {
    const show = convoy.player.show
    convoy.played = []
    convoy.player.show = frame => { const t = performance.now(); show(frame); convoy.played.push({ frame, ms: performance.now() - t }) }
    const render = convoy.view.render.bind(convoy.view)
    convoy.drawn = []
    convoy.view.render = () => { const t = performance.now(); render(); convoy.drawn.push(performance.now() - t) }
  })()`)
  await page.press(' ', 'Space')
  const frames = await page.evaluate('convoy.scene.frames')
  await page.until(`convoy.played.length > ${Math.min(frames, 40)}`, 400)
  await page.evaluate('convoy.played = [], convoy.drawn = []')
  const [before, start] = [await page.metrics(), Date.now()]
  await page.until('convoy.played.length >= 20', 400)
  const after = await page.metrics()
  const played = await page.evaluate('convoy.played')
  const drawn = await page.evaluate('convoy.drawn')
  await page.press(' ', 'Space')
  const isPlaying = await page.evaluate('convoy.player.isPlaying')
  assert.equal(isPlaying, false, 'Space pauses')
  const mean = list => list.reduce((a, b) => a + b, 0) / list.length
  measures.playing = {
    points: await page.evaluate('convoy.pointCount'), frames: played.length, framesPerSecond: 1000 * played.length / (Date.now() - start),
    scriptMsPerFrame: 1000 * (after.ScriptDuration - before.ScriptDuration) / played.length,
    choicesMs: mean(played.map(p => p.ms)), drawMs: mean(drawn), heapMB: after.JSHeapUsedSize / 1e6,
    cacheMB: await page.evaluate('convoy.scene.cache.bytes') / 1e6, budgetMB: await page.evaluate('convoy.scene.cache.budget') / 1e6,
  }
  assert.ok(measures.playing.cacheMB <= measures.playing.budgetMB, 'decoded frames stay within their budget')
}

async function firstAgent(page) {
  await page.open(link(''))
  await page.until(settled)
  return page.evaluate('convoy.ego')
}

async function keys(page) {
  await page.open(link('frame=2'))
  await page.until(settled)
  await page.press('ArrowRight')
  assert.equal(await page.evaluate('convoy.frame'), 3)
  await page.press('ArrowLeft', 'ArrowLeft', 8)
  assert.equal(await page.evaluate('convoy.frame'), 0)
  await page.press('End')
  assert.equal(await page.evaluate('convoy.frame === convoy.scene.frames - 1'), true)
  await page.press('c', 'KeyC')
  assert.equal(await page.evaluate('convoy.choices.color'), 'tag')
  await page.press('g', 'KeyG')
  assert.equal(await page.evaluate('convoy.choices.layers.has("grid")'), false)
  await page.press('v', 'KeyV')
  assert.equal(await page.evaluate('document.body.dataset.view'), 'cameras')
  if (await page.evaluate('convoy.scene.agents.length') > 1) {
    await page.press('2', 'Digit2')
    assert.equal(await page.evaluate('convoy.ego === convoy.scene.agents[1].name'), true)
  }
  // The address has it all: who opens it sees the same.
  await page.until(settled)
  await new Promise(resolve => setTimeout(resolve, 600))
  const [hash, state] = await page.evaluate('[location.hash, [convoy.ego, convoy.frame, convoy.choices.color, convoy.choices.view]]')
  await page.open(address + hash)
  await page.until(settled)
  assert.deepEqual(await page.evaluate('[convoy.ego, convoy.frame, convoy.choices.color, convoy.choices.view]'), state)
  // Flying moves the view.
  await page.open(link('mode=fly'))
  await page.until(settled)
  const place = await page.evaluate('convoy.view.camera.position.toArray()')
  await page.send('Input.dispatchKeyEvent', { type: 'keyDown', key: 'w', code: 'KeyW' })
  // Held until the view has moved: a busy machine draws late.
  await page.until(`convoy.view.camera.position.toArray().join() !== '${place.join()}'`, 30)
  await page.send('Input.dispatchKeyEvent', { type: 'keyUp', key: 'w', code: 'KeyW' })
}

/** A click on a box shows what is known of it. */
async function picking(page) {
  await page.open(link('mode=top'))
  await page.until(settled)
  const at = await page.evaluate(`(() => {
    const box = convoy.boxesShown().find(b => b.id === convoy.egoAgent.id) ?? convoy.boxesShown()[0]
    const [c, area] = [convoy.view.camera, convoy.view.renderer.domElement.getBoundingClientRect()]
    const v = convoy.view.navigation.controls.target.clone().set(...box.center).project(c)
    return { id: box.id, x: area.left + (v.x + 1) / 2 * area.width, y: area.top + (1 - v.y) / 2 * area.height }
  })()`)
  await page.click(at.x, at.y)
  await page.until(`document.querySelector('#object dl')`, 10)
  assert.equal(await page.evaluate('convoy.chosen'), at.id)
  await shot(page, 'desktop-object')
}

/** Whatever can be operated has a name for those who do not see it. */
async function names(page) {
  const nameless = await page.evaluate(`[...document.querySelectorAll('button, select, input, [role=img]')].filter(e => {
    const labels = e.labels ? [...e.labels].map(l => l.textContent).join('') : ''
    return !(e.getAttribute('aria-label') || labels || e.textContent).trim()
  }).map(e => e.outerHTML)`)
  assert.deepEqual(nameless, [])
}

async function phone() {
  const page = await browser.page({ width: 390, height: 844, scale: 2, isPhone: true })
  await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: 'light' }] })
  const shown = { '3d': ['color=tag', has3d], bev: modes.bev, ...(isExcerpt ? {} : { cameras: stored.cameras }) }
  for (const [name, mode] of Object.entries(shown)) {
    await show(page, `phone-${name}`, mode)
    const [wide, seen] = await page.evaluate('[document.documentElement.scrollWidth, innerWidth]')
    assert.ok(wide <= seen, `phone-${name}: the page is ${wide} wide, the screen ${seen}`)
  }
  await page.open(link('color=tag'))
  await page.until(`${settled} && ${has3d}`)
  for (const [button, panel] of [['menu', 'choices'], ['side-toggle', 'side']]) {
    assert.equal(await page.evaluate(`document.getElementById('${panel}').offsetWidth`), 0, `${panel} is shut at first`)
    await page.evaluate(`document.getElementById('${button}').click()`)
    await page.until(settled)
    assert.ok(await page.evaluate(`document.getElementById('${panel}').offsetWidth`) > 200, `${button} opens ${panel}`)
    await shot(page, `phone-${panel}`)
    await page.evaluate(`document.getElementById('${button}').click()`)
  }
  assert.deepEqual(page.errors, [])
  await page.close()
}
