// Panels, buttons and keys: they change the app's choices and show them.

import { AskPanel } from './ask_panel.js'
import { GRIDS, LAYERS, LEVELS, MARKS, OCCLUDED, QUESTIONS, VIEWS, VOXEL_DETAIL, WITHIN_M } from './choices.js'
import { agentColor, css, rampCss, readable } from './colors.js'
import { Plots } from './plots.js'
import { Tools } from './tools.js'
import { $, boxFacts, check, make, options, swatch } from './ui.js'
import { MAP_KINDS } from './view/lines.js'
import { MODES } from './view/navigation.js'
import { COLORINGS } from './view/points.js'

const LAYER_KEYS = { KeyP: 'points', KeyB: 'boxes', KeyL: 'labels', KeyM: 'map', KeyT: 'tracks', KeyX: 'voxels', KeyG: 'grid' }
const LAYER_NAMES = { labels: 'labels', map: 'map lines' }
const MARK_NAMES = { boxes: 'boxes, 3-D', boxes2d: 'boxes, 2-D', masks: 'masks', flow: 'flow', names: 'names' }
const GRID_NAMES = { agent: 'one agent', agents: 'all agents', object: 'chosen object' }
const MODE_NAMES = { follow: ['Around', 'Around the agent'], chase: ['Behind', 'Behind the agent'], top: ['Above', 'From above'], fly: ['Free', 'Fly: W A S D Q E'] }
const COLOR_NAMES = { height: 'height', tag: 'semantic tag', id: 'object id', intensity: 'intensity', agent: 'agent', plain: 'grey' }
const KIND_NAMES = { RGB: 'colour', SEG: 'semantic', IST: 'instance', DPT: 'depth' }
/** A press that moves less than this is a click, pixels. */
const CLICK_PX = 4

export class Panels {
  constructor(app) {
    this.app = app
    this.legendKey = ''
    options($('scene'), app.store.index.scenes.map(s => [s.folder, s.title]), '')
    options($('voxel-detail'), Object.entries(VOXEL_DETAIL).map(([key, d]) => [key, d.label]), 'wide')
    options($('boxes-by'), [['class', 'class'], ['id', 'object id'], ['agent', 'who saw it']], 'class')
    options($('grid'), GRIDS.map(g => [g, GRID_NAMES[g]]), 'agent')
    options($('within'), WITHIN_M.map(m => [m, m ? `${m} m` : 'everywhere']), '')
    options($('occluded'), OCCLUDED.map(s => [s, !s ? 'no matter' : s === '1' ? 'in a picture' : `up to ${100 * s} %`]), '')
    this.ask = new AskPanel(app, () => {
      this.toggles()
      app.update()
    })
    this.colorings()
    $('modes').replaceChildren(...MODES.map(mode => this.button(MODE_NAMES[mode][0], MODE_NAMES[mode][1], () => this.setMode(mode), mode)))
    this.tools = new Tools(app, this)
    this.plots = new Plots(frame => app.setFrame(frame))
  }

  /** Colourings that the points on the screen do not say cannot be chosen. */
  colorings() {
    const { unknown, choices } = this.app
    options($('coloring'), COLORINGS.map(c => unknown.has(c) ? [c, `${COLOR_NAMES[c]} (not known)`, true] : [c, COLOR_NAMES[c]]), choices.color)
  }

  button(text, title, pressed, mode) {
    const button = make('button', { textContent: text, title })
    button.dataset.mode = mode
    button.addEventListener('click', pressed)
    return button
  }

  /** A scene has been opened. */
  newScene(sensors) {
    const { app } = this
    const { scene, choices: c } = app
    options($('scene'), app.store.index.scenes.map(s => [s.folder, s.title]), scene.folder)
    const { info } = scene
    const length = `${info.frames} frames, ${(info.frames * app.names.frame_period_s).toFixed(1)} s${info.imported ? ', imported' : ''}`
    $('facts').textContent = $('facts').title = app.store.index.excerpt ?? length
    $('report').hidden = !app.store.index.report
    // Frames of an excerpt keep the numbers that they have in the scene.
    this.first = info.first_frame ?? 0
    document.title = `${app.store.index.name} · scene ${scene.folder}`
    options($('sensor'), sensors.map(s => [s, s]), c.sensor)
    $('slider').max = scene.frames - 1
    this.agents()
    this.classes()
    this.toggles()
    this.views()
  }

  agents() {
    const { app } = this
    $('agents').replaceChildren(...app.scene.agents.map((agent, i) => {
      const input = make('input', { type: 'checkbox', checked: app.choices.agents.has(agent.name), 'aria-label': `show ${agent.name}` })
      input.addEventListener('change', () => app.toggle('agents', agent.name))
      const name = make('button', { className: 'name', title: `${agent.name}: ${agent.model}`, 'aria-pressed': agent.name === app.ego },
        agent.name, ' ', make('small', { textContent: agent.model }))
      name.addEventListener('click', () => app.setEgo(agent.name))
      return make('div', { className: 'agent' }, input, make('span', { className: 'swatch', style: { background: agentColor(i) } }), name)
    }))
    this.cameras()
  }

  cameras() {
    const { app } = this
    const cameras = [...app.scene.cameras(app.ego).keys()]
    options($('camera'), [['', 'all'], ...cameras.map(c => [c, c])], cameras.includes(app.choices.camera) ? app.choices.camera : '')
    options($('inset-camera'), cameras.map(c => [c, c]), app.camera().name ?? '')
    const kinds = [...new Set([...app.scene.cameras(app.ego).values()].flat())]
    options($('kind'), kinds.map(k => [k, KIND_NAMES[k]]), app.choices.kind)
  }

  setCamera(name) {
    this.app.choices.camera = name
    this.cameras()
    this.app.update()
  }

  setMode(mode) {
    this.app.choices.mode = mode
    this.app.view.navigation.setMode(mode)
    this.toggles()
    this.app.linkSoon()
  }

  classes() {
    const { app } = this
    const { hidden } = app.choices
    $('classes').replaceChildren(...app.scene.tables.classes.map(name => check(name, !hidden.has(name), on => {
      if (on) hidden.delete(name)
      else hidden.add(name)
      app.drawTracks()
      app.update()
    }, css(readable(app.classColor(name), app.isDark)))))
  }

  toggles() {
    const { app } = this
    const c = app.choices
    const kinds = [['layers', LAYERS, LAYER_NAMES], ['marks', MARKS, MARK_NAMES], ['levels', LEVELS, {}]]
    for (const [kind, all, names] of kinds) {
      const focused = document.activeElement?.dataset?.choice
      $(kind).replaceChildren(...all.map(name => {
        const label = check(names[name] ?? name, c[kind].has(name), () => app.toggle(kind, name))
        label.firstChild.dataset.choice = name
        return label
      }))
      if (focused) $(kind).querySelector(`[data-choice="${CSS.escape(focused)}"]`)?.focus()
    }
    if (app.scene) {
      for (const [i, agent] of app.scene.agents.entries()) $('agents').children[i].firstChild.checked = c.agents.has(agent.name)
    }
    for (const button of $('modes').children) button.setAttribute('aria-pressed', button.dataset.mode === c.mode)
    $('coloring').value = c.color
    $('point-size').value = c.size
    $('boxes-by').value = c.boxes
    $('valid-only').checked = c.valid
    $('bev-boxes').checked = c.bevBoxes
    $('voxel-detail').value = c.voxels
    $('kind').value = c.kind
    $('grid').value = c.grid
    document.body.classList.toggle('no-side', !c.side)
    $('side-toggle').setAttribute('aria-expanded', c.side)
    $('within').value = c.within
    $('occluded').value = c.occluded
    $('points-from').value = c.points
    $('voxel-row').style.display = c.layers.has('voxels') ? '' : 'none'
    $('map-legend').replaceChildren(...(c.layers.has('map') ? this.mapKinds() : []))
    this.legend(this.tags ?? 0)
  }

  mapKinds() {
    const { scene, isDark } = this.app
    if (scene?.info.imported && !scene.listing.map_bytes) return [make('span', { className: 'wide', textContent: 'No map lines: the scene was imported without its map.' })]
    return MAP_KINDS.map(k => swatch(k.name, isDark ? k.dark : k.light, 'line'))
  }

  views() {
    document.body.dataset.view = this.app.choices.view
    for (const tab of document.querySelectorAll('[data-tab]')) tab.setAttribute('aria-selected', tab.dataset.tab === this.app.choices.view)
  }

  /** What the colours of points mean; `tags` are those on the screen, as bits. */
  legend(tags) {
    this.tags = tags
    const { app } = this
    const { color, layers, sensor } = app.choices
    const key = `${color} ${tags} ${app.isDark} ${[...layers]} ${[...app.unknown]} ${sensor}`
    if (key === this.legendKey) return
    this.legendKey = key
    const ramp = (low, high) => make('div', { className: 'ramp' }, make('i', { style: { background: rampCss() } }), make('span', {}, make('span', { textContent: low }), make('span', { textContent: high })))
    const shown = layers.has('points') ? app.coloring : layers.has('voxels') ? 'tag' : ''
    const parts = {
      height: () => [ramp('−1 m', '7 m above the agent')],
      intensity: () => [ramp('0', '1 (root scale)')],
      id: () => [make('span', { className: 'wide', textContent: 'A colour for each object, the same in masks and boxes by id; grey has none.' })],
      agent: () => [make('span', { className: 'wide', textContent: 'The colours beside the agents above.' })],
      plain: () => [],
      tag: () => app.names.tags.map((tag, i) => [tag, i]).filter(([, i]) => tags >>> i & 1).map(([tag]) => swatch(tag.name, css(readable(tag.rgb, app.isDark)))),
    }[shown]?.() ?? []
    if (layers.has('points') && sensor === 'Radars') parts.push(make('span', { className: 'wide', textContent: "Lines: a second's way over ground along the ray, from 1 m/s on; orange towards the radar, blue away." }))
    if (layers.has('points') && shown !== color) parts.unshift(make('span', { className: 'wide', textContent: this.whyUnknown(color) }))
    $('legend').replaceChildren(...parts)
  }

  /** Why points are coloured by height, although something else is chosen. */
  whyUnknown(color) {
    const { scene, choices } = this.app
    const why = scene.info.imported ? 'the dataset that was imported does not say it' : 'this sensor does not say it'
    return `No ${COLOR_NAMES[color]} of ${choices.sensor} is known: ${why}. Coloured by height:`
  }

  bevLegend({ masks, about }) {
    const { app } = this
    const hidden = app.choices.hiddenBev
    const names = about.classes ?? app.names.bev.map(c => c.name)
    const key = `${masks.present} ${[...hidden]}`
    if ($('bev-legend').dataset.key === key) return
    $('bev-legend').dataset.key = key
    $('bev-legend').replaceChildren(...names.map(name => check(name, !hidden.has(name), on => {
      if (on) hidden.delete(name)
      else hidden.add(name)
      app.update()
    }, css(app.names.bev.find(c => c.name === name)?.rgb ?? [200, 200, 200]))))
  }

  /** The frame has changed. */
  frame() {
    const { app } = this
    const period = app.names.frame_period_s
    $('slider').value = app.frame
    $('slider').setAttribute('aria-valuetext', `frame ${this.first + app.frame}`)
    if (app.frame === app.scene.frames - 1) this.tools.endFilm()
    const shown = this.first + app.frame
    $('time').replaceChildren(make('b', { textContent: String(shown) }), ` / ${this.first + app.scene.frames - 1} · ${(shown * period).toFixed(2)} s`)
  }

  waiting(isWaiting) {
    const text = this.app.player.isPlaying ? (isWaiting ? '…' : '❚❚') : '▶'
    if ($('play').textContent === text) return
    $('play').textContent = text
    $('play').setAttribute('aria-label', this.app.player.isPlaying ? 'Pause' : 'Play')
  }

  /** What is known of the chosen box. */
  object(box) {
    const { app } = this
    if (app.chosen === null) {
      if ($('object').childElementCount) $('object').replaceChildren()
      return
    }
    const close = make('button', { textContent: 'close', title: 'Esc' })
    close.addEventListener('click', () => this.choose(null))
    const list = make('dl')
    if (box) for (const [name, value] of boxFacts(box)) list.append(make('dt', { textContent: name }), make('dd', { textContent: value }))
    const parts = [make('h2', {}, box?.isPrediction ? 'Prediction' : `Object ${app.chosen}`, close)]
    if (box && !box.isPrediction) parts.push(this.camerasOf())
    $('object').replaceChildren(...parts, box ? list : make('p', { textContent: 'In no list at this frame.' }), ...this.plotsOf(box))
  }

  /** What the chosen object does over the scene; predictions have no ids over time. */
  plotsOf(box) {
    const { app } = this
    if (box?.isPrediction) return []
    const key = [app.scene.folder, app.chosen, app.ego].join()
    if (this.plotted !== key) {
      this.plotted = key
      const { tables, frames } = app.scene
      this.plots.show(tables.history(app.chosen, app.egoAgent), { frames, every: tables.everyNFrames, first: this.first })
    }
    this.plots.at(app.frame, app.scene.tables.boxFrame(app.frame))
    return [this.plots.element]
  }

  /** A button: all cameras that see the chosen object. */
  camerasOf() {
    const button = make('button', { className: 'small', textContent: 'all cameras that see it' })
    button.addEventListener('click', () => {
      this.app.choices.grid = 'object'
      this.toggles()
      this.app.setView('cameras')
    })
    return button
  }

  choose(box) {
    this.app.chosen = box?.id ?? null
    if (box) document.body.classList.add('side-open')
    this.app.update()
  }

  play(isPlaying) {
    this.app.player.toggle(isPlaying)
    this.app.prefetch()
  }

  bind() {
    const { app } = this
    const c = app.choices
    const on = (id, event, act) => $(id).addEventListener(event, act)
    on('scene', 'change', e => app.openScene(e.target.value))
    on('play', 'click', () => this.play())
    on('back', 'click', () => app.setFrame(app.frame - 1))
    on('ahead', 'click', () => app.setFrame(app.frame + 1))
    on('slider', 'input', e => app.setFrame(Number(e.target.value)))
    on('speed', 'change', e => { app.player.speed = Number(e.target.value) })
    const choose = (id, key, read = e => e.target.value, after = () => {}) => on(id, id === 'point-size' ? 'input' : 'change', e => {
      c[key] = read(e)
      after()
      this.toggles()
      app.update()
    })
    choose('sensor', 'sensor')
    choose('coloring', 'color')
    choose('point-size', 'size', e => Number(e.target.value))
    choose('boxes-by', 'boxes', undefined, () => app.drawTracks())
    choose('valid-only', 'valid', e => e.target.checked)
    choose('bev-boxes', 'bevBoxes', e => e.target.checked)
    choose('voxel-detail', 'voxels')
    choose('kind', 'kind')
    choose('grid', 'grid')
    choose('within', 'within')
    choose('occluded', 'occluded')
    choose('points-from', 'points', e => Math.max(0, Math.round(Number(e.target.value)) || 0))
    on('camera', 'change', e => this.setCamera(e.target.value))
    on('inset-camera', 'change', e => this.setCamera(e.target.value))
    const tabs = [...document.querySelectorAll('[data-tab]')]
    for (const tab of tabs) tab.addEventListener('click', () => app.setView(tab.dataset.tab))
    on('theme', 'click', () => this.switchTheme())
    on('help', 'click', () => $('keys').showModal())
    on('link', 'click', () => this.copyLink())
    on('menu', 'click', () => this.drawer('menu-open', 'menu'))
    on('side-toggle', 'click', () => this.toggleSide())
    this.bindPicking()
    addEventListener('keydown', e => this.key(e, true))
    addEventListener('keyup', e => this.key(e, false))
    addEventListener('blur', () => app.view.navigation.release())
  }

  bindPicking() {
    const { app } = this
    let down = null
    const canvas = app.view.renderer.domElement
    canvas.addEventListener('pointerdown', e => { down = [e.clientX, e.clientY] })
    canvas.addEventListener('click', e => {
      if (!down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > CLICK_PX) return
      if (app.view.measure.isOn) {
        app.view.measureAt(e.clientX, e.clientY)
        return app.update()
      }
      const box = app.view.pick(e.clientX, e.clientY)
      if (box || app.chosen !== null) this.choose(box)
      document.body.classList.remove('menu-open')
    })
  }

  switchTheme() {
    const theme = this.app.isDark ? 'light' : 'dark'
    try {
      localStorage.setItem('convoy-theme', theme)
    } catch {
      // Pages from files may not be allowed to: then the choice lasts as long as the page.
    }
    this.app.setTheme(theme)
    this.classes()
    this.toggles()
  }

  drawer(name, button) {
    const isOpen = document.body.classList.toggle(name)
    $(button).setAttribute('aria-expanded', isOpen)
    if (isOpen) document.body.classList.remove(name === 'menu-open' ? 'side-open' : 'menu-open')
    this.app.update()
  }

  toggleSide() {
    if (matchMedia('(max-width: 760px)').matches) return this.drawer('side-open', 'side-toggle')
    this.app.choices.side = !this.app.choices.side
    this.toggles()
    this.app.update()
  }

  async copyLink() {
    const { app } = this
    history.replaceState(null, '', app.linkHash())
    try {
      await navigator.clipboard.writeText(location.href)
      $('link').title = 'Copied'
    } catch {
      $('link').title = 'The address bar has the link'
    }
    $('link').classList.add('done')
    setTimeout(() => $('link').classList.remove('done'), 900)
  }

  key(event, isDown) {
    const { app } = this
    const at = event.target
    app.isShiftHeld = event.shiftKey
    if (!app.scene || event.ctrlKey || event.metaKey || event.altKey || $('keys').open) return
    if (at instanceof HTMLSelectElement || (at instanceof HTMLInputElement && at.type !== 'checkbox' && at.type !== 'range')) return
    if (app.choices.view === '3d' && app.view.navigation.key(event.code, isDown)) return event.preventDefault()
    if (!isDown) return
    if (this.press(event)) event.preventDefault()
  }

  /** Whether the key meant something. */
  press(event) {
    const { app } = this
    const { code, key, shiftKey, target } = event
    const next = (list, now) => list[(list.indexOf(now) + 1) % list.length]
    if (code === 'Space') {
      // On a button or a box the key presses that.
      if (target instanceof HTMLButtonElement || target.type === 'checkbox') return false
      this.play()
    } else if (code === 'ArrowLeft' || code === 'ArrowRight') {
      app.setFrame(app.frame + (code === 'ArrowLeft' ? -1 : 1) * (shiftKey ? 10 : 1))
    } else if (code === 'Home' || code === 'End') {
      app.setFrame(code === 'Home' ? 0 : app.scene.frames - 1)
    } else if (/^Digit[1-9]$/.test(code) && app.scene.agents[code[5] - 1]) {
      app.setEgo(app.scene.agents[code[5] - 1].name)
    } else if (code === 'KeyV') {
      app.setView(next(VIEWS, app.choices.view))
    } else if (code === 'KeyC') {
      app.choices.color = next(COLORINGS.filter(c => !app.unknown.has(c)), app.coloring)
      this.toggles()
      app.update()
    } else if (code === 'KeyF') {
      this.setMode(next(MODES, app.choices.mode))
    } else if (code === 'KeyR') {
      app.view.navigation.home()
    } else if (code === 'KeyN') {
      this.setCamera(next([...app.scene.cameras(app.ego).keys()], app.camera().name))
    } else if (code === 'KeyU') {
      this.tools.measure()
    } else if (code === 'KeyK') {
      this.ask.askFor(next(QUESTIONS.filter(q => q !== 'model' || app.ask.about), app.choices.ask))
    } else if (key === '/') {
      $('search-id').focus()
    } else if (LAYER_KEYS[code]) {
      app.toggle('layers', LAYER_KEYS[code])
    } else if (key === 'Escape') {
      document.body.classList.remove('menu-open', 'side-open')
      if (app.view.measure.isOn) this.tools.measure(false)
      else this.choose(null)
    } else if (key === '?') {
      $('keys').showModal()
    } else {
      return false
    }
    return true
  }
}
