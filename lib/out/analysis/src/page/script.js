// Sorts tables, filters scenes, and leads to the viewer. Without it the page is whole, but stands still.
'use strict'
const number = (text) => Number(text.replace(/[,%]/g, ''))
const sortable = (table) => {
  const heads = [...table.tHead.rows[0].cells]
  heads.forEach((head, column) => {
    const sort = () => {
      const up = head.getAttribute('aria-sort') !== 'ascending'
      heads.forEach((other) => other.removeAttribute('aria-sort'))
      head.setAttribute('aria-sort', up ? 'ascending' : 'descending')
      const rows = [...table.tBodies[0].rows]
      const text = (row) => row.cells[column].dataset.value ?? row.cells[column].textContent
      const plain = rows.filter((row) => !row.classList.contains('total'))
      const numeric = !head.classList.contains('name')
      plain.sort((a, b) => {
        const [x, y] = up ? [a, b] : [b, a]
        if (!numeric) return text(x).localeCompare(text(y), 'en', { numeric: true })
        const [p, q] = [number(text(x)), number(text(y))]
        // What has no number comes last either way.
        if (isNaN(p) || isNaN(q)) return isNaN(number(text(a))) - isNaN(number(text(b)))
        return p - q
      })
      const totals = rows.filter((row) => row.classList.contains('total'))
      table.tBodies[0].append(...plain, ...totals)
    }
    head.tabIndex = 0
    head.title = 'sort'
    head.addEventListener('click', sort)
    head.addEventListener('keydown', (event) => {
      if (event.key === 'Enter' || event.key === ' ') {
        event.preventDefault()
        sort()
      }
    })
  })
}
document.querySelectorAll('table').forEach(sortable)
for (const cell of document.querySelectorAll('td[data-value]')) cell.title = Number(cell.dataset.value).toLocaleString('en')

// The contents say which section is in sight: the last that begins above the middle of the window.
const links = new Map([...document.querySelectorAll('nav a[href^="#"]')].map((link) => [link.hash.slice(1), link]))
const mark = () => {
  const begun = [...document.querySelectorAll('section')].filter((section) => section.getBoundingClientRect().top < innerHeight / 2)
  const current = links.get((begun.at(-1) ?? document.querySelector('section'))?.id)
  for (const link of links.values()) link.toggleAttribute('aria-current', link === current)
}
document.addEventListener('scroll', mark, { passive: true })
mark()

const choices = document.querySelector('.choices')
if (choices) {
  choices.hidden = false
  const selects = [...choices.querySelectorAll('select')]
  const count = choices.querySelector('output')
  const table = document.querySelector('tr[data-map]').closest('table')
  const column = [...table.tHead.rows[0].cells].findIndex((head) => head.textContent === 'frames')
  const frames = (shown) => [...table.tBodies[0].rows].filter(shown)
    .reduce((sum, row) => sum + number(row.cells[column].textContent), 0).toLocaleString('en')
  const cards = [...document.querySelectorAll('.card')]
  // What each section shows of all scenes, and of those of each choice that the page holds.
  const sections = [...document.querySelectorAll('section')].map((section) => {
    const part = section.querySelector('.part')
    return { section, part, whole: [...part.childNodes] }
  })
  const parts = new Map([...document.querySelectorAll('template')].map((part) => [part.dataset.scenes, part]))
  const swap = (template) => {
    const open = new Set([...document.querySelectorAll('details[open] > summary')].map((summary) => summary.textContent))
    const content = template && template.content.cloneNode(true)
    if (content) content.querySelectorAll('table').forEach(sortable)
    for (const { section, part, whole } of sections) {
      const found = content && content.querySelector(`[data-section="${section.id}"]`)
      part.replaceChildren(...(content ? found ? found.childNodes : [] : whole))
      section.classList.toggle('empty', !part.childNodes.length && !section.querySelector('.cards'))
    }
    for (const details of document.querySelectorAll('details')) details.open = open.has(details.firstElementChild.textContent)
  }
  let kept
  const filter = () => {
    const shown = (item) => selects.every((s) => !s.value || item.dataset[s.name] === s.value)
    const some = cards.filter(shown)
    const template = some.length < cards.length ? parts.get(some.map((card) => card.dataset.scene).join(' ')) : undefined
    if (template !== kept) swap(template)
    kept = template
    for (const item of document.querySelectorAll('[data-map]')) item.hidden = !shown(item)
    const whose = some.length === cards.length ? '' : template ? '; all figures and tables are of these alone'
      : '; figures and sums are of all ' + cards.length + ' scenes'
    count.textContent = some.length + ' of ' + cards.length + ' scenes, ' + frames(shown) + ' frames' + whose
  }
  selects.forEach((select) => select.addEventListener('change', filter))
  filter()
}

// `convoy view` shows stores below /store/; whatever else shows this page has no viewer.
const isServed = location.pathname.startsWith('/store/')
const quoted = (path) => /^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`
const store = () => location.protocol === 'file:' && location.pathname.includes('/stats/') ? quoted(decodeURIComponent(location.pathname).split('/stats/')[0]) : 'STORE'
const how = document.getElementById('how')
for (const card of document.querySelectorAll('.card, .moment')) {
  const { scene, frame, ego } = card.dataset
  if (isServed) {
    card.href = '/#scene=' + scene + (frame ? '&frame=' + frame + '&agent=' + ego : '')
  } else {
    card.addEventListener('click', (event) => {
      event.preventDefault()
      how.hidden = false
      how.querySelector('b').textContent = 'scene ' + scene + (frame ? ', frame ' + frame : '')
      how.querySelector('code').textContent = 'convoy view ' + store()
    })
  }
}
