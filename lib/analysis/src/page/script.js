// Sorts tables, filters scenes, and leads to the viewer. Without it the page is whole, but stands still.
'use strict'
const number = (text) => Number(text.replace(/[,%]/g, ''))
for (const table of document.querySelectorAll('table')) {
  const heads = [...table.tHead.rows[0].cells]
  heads.forEach((head, column) => {
    const sort = () => {
      const up = head.getAttribute('aria-sort') !== 'ascending'
      heads.forEach((other) => other.removeAttribute('aria-sort'))
      head.setAttribute('aria-sort', up ? 'ascending' : 'descending')
      const rows = [...table.tBodies[0].rows]
      const text = (row) => row.cells[column].textContent
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

const choices = document.querySelector('.choices')
if (choices) {
  choices.hidden = false
  const selects = [...choices.querySelectorAll('select')]
  const count = choices.querySelector('output')
  const table = document.querySelector('tr[data-map]').closest('table')
  const column = [...table.tHead.rows[0].cells].findIndex((head) => head.textContent === 'frames')
  const frames = (shown) => [...table.tBodies[0].rows].filter(shown)
    .reduce((sum, row) => sum + number(row.cells[column].textContent), 0).toLocaleString('en')
  const filter = () => {
    const shown = (item) => selects.every((s) => !s.value || item.dataset[s.name] === s.value)
    for (const item of document.querySelectorAll('[data-map]')) item.hidden = !shown(item)
    const cards = [...document.querySelectorAll('.card')]
    count.textContent = cards.filter(shown).length + ' of ' + cards.length + ' scenes, ' + frames(shown) + ' frames'
  }
  selects.forEach((select) => select.addEventListener('change', filter))
  filter()
}

// `convoy view` shows stores below /store/; whatever else shows this page has no viewer.
const isServed = location.pathname === '/store/stats/report.html'
const quoted = (path) => /^[\w./-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`
const store = () => location.protocol === 'file:' ? quoted(decodeURIComponent(location.pathname).split('/stats/')[0]) : 'STORE'
const how = document.getElementById('how')
for (const card of document.querySelectorAll('.card')) {
  if (isServed) {
    card.href = '/#scene=' + card.dataset.scene
  } else {
    card.addEventListener('click', (event) => {
      event.preventDefault()
      how.hidden = false
      how.querySelector('b').textContent = 'scene ' + card.dataset.scene
      how.querySelector('code').textContent = 'convoy view ' + store()
    })
  }
}
