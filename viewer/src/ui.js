// Small makers of elements, and the texts of the page.

export const $ = id => document.getElementById(id)

export function make(name, properties = {}, ...children) {
  const element = document.createElement(name)
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith('aria-') || key === 'role' || key === 'for') element.setAttribute(key, value)
    else if (key === 'style') Object.assign(element.style, value)
    else element[key] = value
  }
  element.append(...children)
  return element
}

export function check(label, isOn, changed, swatch) {
  const input = make('input', { type: 'checkbox', checked: isOn })
  input.addEventListener('change', () => changed(input.checked))
  const parts = [input]
  if (swatch) parts.push(make('span', { className: 'swatch', style: { background: swatch } }))
  parts.push(make('span', { className: 'name', textContent: label.replaceAll('_', ' ') }))
  return make('label', { title: label.replaceAll('_', ' ') }, ...parts)
}

export function swatch(label, color, className = 'swatch') {
  const name = label.replaceAll('_', ' ')
  return make('span', { className: 'item', title: name }, make('span', { className, style: { background: color } }), make('span', { className: 'name', textContent: name }))
}

/** Entries are `[value, text]`, or `[value, text, true]` for what cannot be chosen. */
export function options(select, entries, chosen) {
  const key = JSON.stringify(entries)
  if (select.dataset.entries !== key) {
    select.dataset.entries = key
    select.replaceChildren(...entries.map(([value, text, disabled]) => make('option', { value, textContent: text, disabled: disabled === true })))
  }
  select.value = chosen
}

/** Buttons of which one is pressed; entries are `[value, text, title]`. */
export function segments(host, entries, pressed) {
  host.replaceChildren(...entries.map(([value, text, title]) => {
    const button = make('button', { type: 'button', textContent: text, title })
    button.dataset.value = value
    button.addEventListener('click', () => pressed(value))
    return button
  }))
}

export function note(kind, ...parts) {
  return make('div', { className: `note ${kind}` }, ...parts)
}

/** What may be done about what is not there, in words. */
export function advice({ why, command }) {
  return why ? [why] : ['Run ', make('code', { textContent: command })]
}

export const KEYS = [
  ['Space', 'play, pause'], ['← →', 'one frame back, ahead (Shift: ten)'], ['Home End', 'first, last frame'], ['1 … 9', 'choose an agent'],
  ['V', '3-D, cameras, BEV'], ['C', 'next colouring of points'], ['F', 'around the agent, behind it, from above, free'], ['R', 'the view as it was at first'],
  ['W A S D Q E', 'fly (free view; Shift: faster)'], ['P B L M T X G', 'points, boxes, labels, map, tracks, voxels, grid'], ['N', 'next camera'], ['K', 'next question: scene, partners, model'], ['U', 'measure a distance: two clicks'], ['/', 'find an object by its id'], ['Esc', 'nothing chosen'], ['?', 'this list'],
]

export function keysDialog(dialog) {
  const list = make('dl')
  for (const [keys, meaning] of KEYS) {
    list.append(make('dt', {}, ...keys.split(' ').flatMap(k => [make('kbd', { textContent: k }), ' '])), make('dd', { textContent: meaning }))
  }
  const close = make('button', { textContent: 'Close', autofocus: true })
  close.addEventListener('click', () => dialog.close())
  dialog.replaceChildren(make('h1', { textContent: 'Keys' }), list,
    make('p', { textContent: 'Drag to turn, right button or two fingers to move, wheel or pinch to come nearer. Click a box to see what is known of it.' }), close)
}

/** What a box is called: an object by its id, a prediction by its score. */
export function boxName(box) {
  return `${box.class.replaceAll('_', ' ')} ${box.isPrediction ? box.score.toFixed(2) : box.id}`
}

/** What is known of a box, as pairs. */
export function boxFacts(box) {
  if (box.isPrediction) return predictionFacts(box)
  const facts = [['class', box.class.replaceAll('_', ' ')], ['id', String(box.id)]]
  const add = (name, value) => {
    if (value !== null && value !== undefined && value !== '') facts.push([name, String(value)])
  }
  add('model', box.model)
  add('size', box.size.map(v => v.toFixed(2)).join(' × ') + ' m')
  add('speed', `${box.speed.toFixed(1)} m/s`)
  add('heading', `${(box.rpy[2] * 180 / Math.PI).toFixed(1)}°`)
  add('lidar points', box.lidarPoints)
  add('radar points', box.radarPoints)
  add('difficulty', box.difficulty)
  if (box.seenBy.length) add('seen by', box.seenBy.join(', '))
  add('light', box.signalState)
  add('OpenDRIVE id', box.opendriveId)
  try {
    for (const [name, value] of Object.entries(JSON.parse(box.attributes ?? '{}'))) add(name.replaceAll('_', ' '), value)
  } catch {
    add('attributes', box.attributes)
  }
  return facts
}

function predictionFacts(box) {
  return [
    ['class', box.class.replaceAll('_', ' ')], ['score', String(Number(box.score.toPrecision(4)))],
    ['size', box.size.map(v => v.toFixed(2)).join(' × ') + ' m'], ['heading', `${(box.rpy[2] * 180 / Math.PI).toFixed(1)}°`],
    ['found', box.foundId ? `object ${box.foundId}` : 'nothing: false'],
  ]
}
