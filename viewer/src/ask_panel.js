// The panel of the questions: modes, range and score, and what was counted.

import { QUESTIONS } from './choices.js'
import { RESULT_COLORS, SIGHT_COLORS, agentColor, css, bytesOf, readable } from './colors.js'
import { PARTNER_MODES } from './data/cooperation.js'
import { $, make, options, segments } from './ui.js'

const QUESTION_NAMES = { scene: ['Scene', 'What is there?'], partners: ['Partners', 'What do partners add?'], model: ['Model', 'What did the model see?'] }
const MODE_NAMES = { '-': 'not said', none: 'none: alone', x2v: 'x2v: with vehicles', x2i: 'x2i: with RSUs', x2x: 'x2x: with both' }
const SIGHT_NAMES = { ego: 'seen by the ego', partners: 'only by partners', nobody: 'by neither' }
const STEPS = 400

export class AskPanel {
  constructor(app, changed) {
    Object.assign(this, { app, changed })
    segments($('ask'), QUESTIONS.filter(q => q !== 'model' || app.ask.about).map(q => [q, ...QUESTION_NAMES[q]]), q => this.askFor(q))
    const { choices: c } = app
    const set = (id, event, key, read) => $(id).addEventListener(event, e => {
      c[key] = read(e.target)
      this.changed()
    })
    options($('partner-mode'), PARTNER_MODES.map(m => [m, MODE_NAMES[m]]), c.partners)
    set('partner-mode', 'change', 'partners', e => e.value)
    set('comm-range', 'input', 'range', e => Number(e.value))
    set('elevation', 'input', 'elevation', e => Number(e.value))
    set('heard-only', 'change', 'heardOnly', e => e.checked)
    const { about } = app.ask
    if (!about) return
    options($('model-mode'), about.modes.map(m => [m, MODE_NAMES[m]]), app.ask.mode)
    if (about.modes.join() === '-') $('model-mode').parentElement.style.display = 'none'
    options($('threshold'), about.thresholds_m.map((m, i) => [String(i), `${m} m`]), String(c.threshold))
    set('model-mode', 'change', 'partners', e => e.value)
    set('threshold', 'change', 'threshold', e => Number(e.value))
    set('score', 'input', 'score', e => this.scoreAt(Number(e.value)))
    $('score-best').addEventListener('click', () => {
      c.score = ''
      this.changed()
    })
  }

  askFor(question) {
    const { choices } = this.app
    choices.ask = question
    // Whose points they are is a part of one question; in the other colours are for boxes.
    const color = { partners: 'agent', model: 'plain', scene: 'height' }
    if (Object.values(color).includes(choices.color)) choices.color = color[question]
    this.changed()
  }

  scoreAt(step) {
    const [low, high] = this.app.ask.predictions.range
    return Number((low + (high - low) * step / STEPS).toPrecision(4))
  }

  /** Shows choices and counts anew; `boxes` are all of the frame that filters leave. */
  show(boxes) {
    const { app } = this
    const { choices: c, ask } = app
    for (const button of $('ask').children) button.setAttribute('aria-pressed', button.dataset.value === c.ask)
    document.body.dataset.ask = c.ask
    $('tally').replaceChildren()
    this.marks(ask.events())
    if (c.ask === 'partners') this.partners(boxes)
    if (c.ask === 'model') this.model()
  }

  partners(boxes) {
    const { app } = this
    const { choices: c, ask, scene } = app
    $('partner-mode').value = c.partners
    for (const [id, key, unit] of [['comm-range', 'range', 'm'], ['elevation', 'elevation', 'm']]) {
      if (document.activeElement !== $(id)) $(id).value = c[key]
      $(`${id}-value`).textContent = `${c[key]} ${unit}`
    }
    $('heard-only').checked = c.heardOnly
    const { partners } = ask.look()
    const { counts, each } = ask.sights(boxes)
    const color = name => css(readable(bytesOf(SIGHT_COLORS[name]), app.isDark))
    this.chips(Object.entries(counts).map(([name, count]) => [SIGHT_NAMES[name], count, color(name)]))
    const rows = scene.agents.map((agent, i) => {
      const partner = partners.find(p => p.name === agent.name)
      const { sees, adds } = each.get(agent.name)
      const where = !partner ? 'ego' : `${partner.distance.toFixed(0)} m`
      const what = !partner ? '' : partner.isHeard ? `+${adds}` : partner.isInReach ? 'not heard' : 'out of reach'
      const row = make('tr', { className: partner && !partner.isHeard ? 'off' : '' },
        make('th', { scope: 'row' }, make('span', { className: 'swatch', style: { background: agentColor(i) } }), agent.name),
        ...[where, String(sees), what].map(text => make('td', { textContent: text })))
      return row
    })
    const head = make('tr', {}, ...['agent', 'away', 'sees', 'adds'].map(text => make('th', { textContent: text, scope: 'col' })))
    $('partner-table').replaceChildren(head, ...rows)
    $('partner-note').textContent = scene.tables.isMerged ? '' : 'Who saw what is known only after merge-tracks.'
  }

  model() {
    const { app } = this
    const { choices: c, ask } = app
    $('model-body').hidden = !ask.predictions
    $('model-none').textContent = ask.predictions ? '' : `${ask.about.file} has no predictions of this scene.`
    if (!ask.predictions) return
    const { rule } = ask
    const [low, high] = ask.predictions.range
    $('model-mode').value = ask.mode
    $('threshold').value = String(c.threshold)
    $('score').max = STEPS
    if (document.activeElement !== $('score')) $('score').value = high > low ? (rule.score - low) / (high - low) * STEPS : 0
    $('score-value').textContent = Number(rule.score.toPrecision(3))
    $('score-best').disabled = c.score === ''
    const { frame, scene, worst } = ask.counts()
    const color = name => css(readable(bytesOf(RESULT_COLORS[name]), app.isDark))
    const { frames } = ask.predictions
    $('model-note').textContent = frame ? '' : `Nothing was predicted for ${app.ego} here; the file has frames ${told(frames, this.app.panels.first)}.`
    const all = frame?.all ?? { found: 0, missed: 0, false: 0 }
    this.chips([['found', all.found, color('found')], ['missed', all.missed, color('missed')], ['false', all.false, color('false')]])
    const head = make('tr', {}, make('th', { textContent: 'this frame', scope: 'col' }), ...['found', 'missed', 'false'].map(name => make('th', { scope: 'col', textContent: name, style: { borderBottom: `2px solid ${color(name)}` } })))
    const line = (name, { found, missed, false: wrong }, className = '') => make('tr', { className }, make('th', { scope: 'row', textContent: name.replaceAll('_', ' ') }), ...[found, missed, wrong].map(n => make('td', { textContent: n || '·' })))
    const classes = [...frame?.byClass ?? []].map(([name, counts]) => line(name, counts))
    $('model-table').replaceChildren(head, ...classes, line('all', all, 'sum'))
    const part = (a, b) => a + b ? `${(100 * a / (a + b)).toFixed(0)} %` : '–'
    $('model-scene').textContent = `${app.ego}, whole scene: recall ${part(scene.found, scene.missed)}, precision ${part(scene.found, scene.false)}.`
    this.worst(worst)
  }

  /** The list of the worst frames; it is made anew only where it is another one, so that it keeps the keyboard. */
  worst(worst) {
    const { app } = this
    if (this.listed !== worst) {
      this.listed = worst
      $('worst').replaceChildren(...worst.map(({ sample, missed, false: wrong }) => {
        const button = make('button', { title: 'Go to this frame' },
          make('b', { textContent: String(app.panels.first + sample.frame) }), ` ${sample.agent} `, make('small', { textContent: `${missed} missed, ${wrong} false` }))
        button.addEventListener('click', () => app.goTo(sample.agent, sample.frame))
        return make('li', {}, button)
      }))
    }
    const frame = app.scene.tables.boxFrame(app.frame)
    for (const [i, { sample }] of worst.entries()) {
      $('worst').children[i].firstChild.setAttribute('aria-pressed', sample.agent === app.ego && sample.frame === frame)
    }
  }

  /** Marks on the time line: partners see something new (orange), the ego sees what partners saw before (blue). */
  marks(events) {
    if (this.marked === events) return
    this.marked = events
    const last = Math.max(1, this.app.scene.frames - 1)
    const words = { partners: 'first seen, by partners alone', ego: 'the ego sees now what partners saw before' }
    $('marks-of-time').replaceChildren(...events.map(({ frame, kind, ids }) => {
      const place = { left: `${100 * frame / last}%`, top: kind === 'ego' ? '3px' : '-4px', background: SIGHT_COLORS[kind] }
      const mark = make('i', { style: place, title: `frame ${this.app.panels.first + frame}: ${words[kind]}: ${ids.slice(0, 8).join(', ')}${ids.length > 8 ? ', …' : ''}` })
      mark.addEventListener('click', () => this.app.setFrame(frame))
      return mark
    }))
  }

  /** What was counted, over the picture: also where the panel is shut. */
  chips(entries) {
    $('tally').replaceChildren(...entries.map(([name, count, color]) => make('span', {}, make('i', { className: 'swatch', style: { background: color } }), make('b', { textContent: String(count) }), name)))
  }
}

/** Frames in words: all of them, or the first ones. */
function told(frames, first) {
  const list = frames.slice(0, 4).map(f => String(first + f))
  return frames.length > 4 ? `${list.join(', ')}, … ${first + frames.at(-1)}` : list.join(', ')
}
