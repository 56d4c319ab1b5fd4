// Uses the report's pages as a reader would, at a desktop's and a phone's width, on light and on dark, from a file and served.
//
//     node look.mjs CHROMIUM FOLDER [SHOTS]

import assert from 'node:assert/strict'
import { createServer } from 'node:http'
import { mkdir, readFile, writeFile } from 'node:fs/promises'
import path from 'node:path'
import { pathToFileURL } from 'node:url'
import { Chromium } from '../../../../../viewer/test/chromium.mjs'

const [program, folder, shots] = process.argv.slice(2)

// Texts of a figure that lie over one another, or stick out of it.
const badTexts = `[...document.querySelectorAll('.figures svg')].flatMap(svg => {
  const title = svg.querySelector('title').textContent
  const frame = svg.getBoundingClientRect()
  const texts = [...svg.querySelectorAll('text')].map(text => ({ text: text.textContent, box: text.getBoundingClientRect() }))
  const out = texts.filter(({ box }) => box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1)
  const over = texts.flatMap((a, i) => texts.slice(i + 1).filter(b =>
    Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left) > 1 &&
    Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top) > 4).map(b => [a, b]))
  return [...out.map(a => title + ': "' + a.text + '" sticks out'), ...over.map(([a, b]) => title + ': "' + a.text + '" over "' + b.text + '"')]
})`

async function isSound(page, name) {
  await page.evaluate(`for (const image of document.images) image.loading = 'eager'`)
  await page.evaluate(`Promise.all([...document.images].map(image => image.decode()))`)
  const [wide, tall, broken] = await page.evaluate(`[document.documentElement.scrollWidth - innerWidth, document.documentElement.scrollHeight,
    [...document.images].filter(image => !image.naturalWidth).length]`)
  assert.ok(wide <= 0, `${name}: ${wide} pixels stick out of the page`)
  assert.equal(broken, 0, `${name}: broken pictures`)
  assert.deepEqual(await page.evaluate(badTexts), [], name)
  const shrunk = `[...document.querySelectorAll('.figures svg')].filter(svg => svg.getBoundingClientRect().width < 0.8 * svg.viewBox.baseVal.width).length`
  assert.equal(await page.evaluate(shrunk), 0, `${name}: figures too small to read`)
  assert.ok(await page.evaluate(`document.fonts.check('600 12px Inter') && [...document.fonts].some(font => font.status === 'loaded')`), `${name}: the typeface`)
  assert.deepEqual(page.errors, [], name)
  if (shots) {
    await mkdir(shots, { recursive: true })
    const width = await page.evaluate('innerWidth')
    for (let y = 0; y < tall; y += 1500) {
      const clip = { x: 0, y, width, height: Math.min(1500, tall - y), scale: 1 }
      const { data } = await page.send('Page.captureScreenshot', { format: 'png', captureBeyondViewport: true, clip })
      await writeFile(path.join(shots, `${name}-${y / 1500}.png`), Buffer.from(data, 'base64'))
    }
  }
}

/** A column of the table of scenes, as it is shown. */
const column = (name, shown = '') => `(() => {
  const head = [...document.querySelectorAll('th')].find(th => th.textContent === '${name}' && th.closest('table').querySelector('[data-map]'))
  ${shown}
  return [...head.closest('table').tBodies[0].rows].filter(row => !row.hidden).map(row => row.cells[head.cellIndex].textContent)
})()`

async function isUsable(page, address) {
  await page.open(address)
  // As a number, up and then down; a second key is not needed.
  const frames = await page.evaluate(column('frames'))
  const sorted = [...frames].sort((a, b) => Number(a.replaceAll(',', '')) - Number(b.replaceAll(',', '')))
  assert.notDeepEqual(frames, sorted, 'the numbers are given in another order')
  assert.deepEqual(await page.evaluate(column('frames', 'head.click()')), sorted)
  assert.deepEqual(await page.evaluate(column('frames', `head.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter' }))`)), sorted.toReversed())
  // Sums stay below what they are of.
  const last = await page.evaluate(`(() => {
    const table = document.querySelector('tr.total').closest('table')
    table.tHead.rows[0].cells[1].click()
    return table.tBodies[0].lastElementChild.className
  })()`)
  assert.equal(last, 'total')
  // Sizes are in units of people, and sorted by their bytes.
  const sizes = await page.evaluate(`(() => {
    const head = [...document.querySelectorAll('#sensor th')].find(th => th.textContent === 'size')
    head.click()
    return [...head.closest('table').tBodies[0].rows].map(row => [row.cells[head.cellIndex].textContent, Number(row.cells[head.cellIndex].dataset.value)])
  })()`)
  assert.ok(sizes.length > 1 && sizes.every(([text]) => / [kMGT]?B$/.test(text)), `${sizes}`)
  assert.deepEqual(sizes, sizes.toSorted(([, a], [, b]) => a - b))
  // Contents stay in sight, and say which section is.
  const contents = await page.evaluate(`(() => {
    document.getElementById('bev').scrollIntoView()
    mark()
    const { top, bottom } = document.querySelector('nav').getBoundingClientRect()
    const marked = [...document.querySelectorAll('nav a[aria-current]')].map(link => link.hash)
    scrollTo(0, 0)
    return { top, bottom, marked }
  })()`)
  assert.ok(contents.top >= 0 && contents.top < 60 && contents.bottom <= 900, JSON.stringify(contents))
  assert.deepEqual(contents.marked, ['#bev'])
  // Where there is room there are two columns, on a phone one.
  const lefts = await page.evaluate(`new Set([...document.querySelectorAll('.part > :not(.wide)')].map(part => part.getBoundingClientRect().left)).size`)
  assert.equal(lefts, await page.evaluate('innerWidth') > 1000 ? 2 : 1)
  // Cards and rows are those of the chosen map.
  const choose = (name, value) => page.evaluate(`(() => {
    const select = document.querySelector('select[name=${name}]')
    select.value = '${value}'
    select.dispatchEvent(new Event('change'))
    return [[...document.querySelectorAll('.card')].filter(card => !card.hidden).map(card => card.dataset.scene), document.querySelector('output').textContent]
  })()`)
  const parts = `[...document.querySelectorAll('.part')].map(part => part.textContent).join('|')`
  const whole = await page.evaluate(parts)
  const [cards, words] = await choose('map', 'Town02')
  assert.ok(words.endsWith('these alone'), words)
  assert.ok(cards.length > 0 && cards.every(scene => Number(scene) % 2 === 1), `${cards}`)
  assert.ok(words.startsWith(`${cards.length} of 12 scenes`), words)
  assert.equal((await page.evaluate(column('scene'))).length, cards.length)
  const [few] = await choose('split', 'val')
  assert.deepEqual(few, ['0003', '0009'])
  // Figures and tables are of these scenes alone: 70 boxes each, 30 of them valid, and no masks.
  const boxes = await page.evaluate(`(() => {
    const row = [...document.querySelectorAll('#boxes tr.total')].find(row => row.cells[0].textContent === 'total')
    return [row.cells[1].textContent, row.cells[2].textContent]
  })()`)
  assert.deepEqual(boxes, ['140', '60'])
  const drawn = `[...document.querySelectorAll('.figures svg title')].map(title => title.textContent)`
  const figures = await page.evaluate(drawn)
  assert.ok(figures.includes('Objects per class') && !figures.includes('BEV cells per class'), `${figures}`)
  assert.equal(await page.evaluate(`document.querySelector('#bev').offsetHeight`), 0, 'a section without anything is not shown')
  assert.notDeepEqual(await page.evaluate(column('scene', 'head.click()')), await page.evaluate(column('scene', 'head.click()')), 'its tables are sorted')
  await isSound(page, `${path.basename(address, '.html')}-filtered-${await page.evaluate('innerWidth')}`)
  await choose('map', '')
  const [all] = await choose('split', '')
  assert.equal(all.length, 12)
  assert.equal(await page.evaluate(parts), whole)
}

const types = { '.html': 'text/html', '.jpg': 'image/jpeg', '.csv': 'text/csv' }
const server = createServer(async (request, response) => {
  try {
    assert.ok(request.url.startsWith('/store/stats/'))
    const file = path.join(folder, path.basename(path.dirname(request.url)) === 'scenes' ? 'scenes' : '.', path.basename(request.url))
    response.setHeader('Content-Type', types[path.extname(file)])
    // What the viewer's server allows a file of the store.
    response.setHeader('Content-Security-Policy', `default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; font-src data:; img-src 'self' data:; frame-ancestors 'none'`)
    response.end(await readFile(file))
  } catch {
    response.writeHead(404).end()
  }
})
await new Promise(resolve => server.listen(0, '127.0.0.1', resolve))
const served = `http://127.0.0.1:${server.address().port}/store/stats`
const file = pathToFileURL(folder).href

const browser = await Chromium.start(program)
try {
  for (const [width, isPhone] of [[1280, false], [390, true]]) {
    const page = await browser.page({ width, height: 900, isPhone })
    for (const value of ['light', 'dark']) {
      await page.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value }] })
      for (const name of ['report', 'published', 'bare', 'scores']) {
        await page.open(`${file}/${name}.html`)
        const [paper] = (await page.evaluate('getComputedStyle(document.body).backgroundColor')).match(/\d+/)
        assert.equal(Number(paper) < 128, value === 'dark')
        await isSound(page, `${name}-${isPhone ? 'phone' : 'desktop'}-${value}`)
      }
    }
    await isUsable(page, `${file}/report.html`)
    // A file cannot start the viewer: it says how to.
    const how = await page.evaluate(`document.querySelector('.card[data-scene="0003"]').click(), document.getElementById('how').innerText`)
    assert.ok(how.includes('scene 0003') && how.includes(`convoy view '${path.dirname(folder)}'`), how)
    await isUsable(page, `${served}/report.html`)
    assert.equal(await page.evaluate(`document.querySelector('.card[data-scene="0003"]').getAttribute('href')`), '/#scene=0003')
    await isSound(page, 'served')
    await page.open(`${served}/scores.html`)
    assert.equal(await page.evaluate(`document.querySelector('.moment').getAttribute('href')`), '/#scene=0007&frame=40&agent=vehicle_0')
    await page.open(`${file}/scores.html`)
    const told = await page.evaluate(`document.querySelector('.moment').click(), document.getElementById('how').innerText`)
    assert.ok(told.includes('scene 0007, frame 40'), told)
    await page.close()
  }
} finally {
  await browser.stop()
  server.close()
}
