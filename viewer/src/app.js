// The choices, and what follows from them on the screen.

import { Ask } from './ask.js'
import { CameraGrid, kindAtHand } from './camera_grid.js'
import { DEFAULTS, VOXEL_DETAIL, freshChoices, takeLink } from './choices.js'
import { agentColor, classColors } from './colors.js'
import { mapElements } from './data/scene.js'
import { Occlusions, filtered } from './filters.js'
import { remedy } from './data/store.js'
import { readLink, writeLink } from './link.js'
import { recall, remember } from './memory.js'
import { Panels } from './panels.js'
import { Player } from './player.js'
import { stale, unmade } from './scene_notes.js'
import { $, advice, boxName, keysDialog, make, note } from './ui.js'
import { strideFor } from './view/detail.js'
import { drawBev, drawCamera, pictureElement } from './view/pictures.js'
import { View3d, boxColor } from './view/view3d.js'

/** Frames that are fetched before they are shown. */
const AHEAD = 6
const THUMB_PX = 640

export class App {
  constructor(store) {
    this.store = store
    this.names = store.names
    this.classColor = classColors(store.names)
    this.choices = freshChoices()
    this.link = {}
    this.version = 0
    this.isDirty = true
    /** Of how many points one is read while the scene plays, and was for what is on the screen. */
    this.playStride = this.shownStride = 1
    this.notes = new Map()
    this.view = new View3d($('view-3d'), this.names.tags, () => {
      this.isDirty = true
      this.linkSoon()
    })
    /** What the points on the screen do not say, by colouring: `tag`, `id`, `intensity`. */
    this.unknown = new Set()
    this.ask = new Ask(this)
    this.panels = new Panels(this)
    this.player = new Player({ periodS: this.names.frame_period_s, isReady: frame => this.isReady(frame), show: frame => this.setFrame(frame) })
    this.grid = new CameraGrid(this)
    this.inset = pictureElement('')
    this.insetBev = pictureElement('')
    this.bev = pictureElement('')
    for (const [host, element] of [['inset-picture', this.inset], ['inset-bev', this.insetBev], ['view-bev', this.bev]]) {
      element.caption.remove()
      $(host).append(element.figure)
    }
  }

  async start() {
    this.link = readLink(location.hash)
    this.isOwn = location.hash.length <= 1 && !this.store.index.excerpt
    if (this.isOwn) recall(this.choices)
    else takeLink(this.choices, this.link)
    this.setTheme(storedTheme() ?? (matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark'))
    this.bind()
    keysDialog($('keys'))
    const scenes = this.store.index.scenes
    if (!scenes.length) throw new Error('it has no scenes yet: make dataset')
    await this.openScene(scenes.some(s => s.folder === this.link.scene) ? this.link.scene : scenes[0].folder)
    requestAnimationFrame(now => this.tick(now))
  }

  async openScene(folder) {
    const version = ++this.version
    this.panels.tools.endFilm()
    this.player.toggle(false)
    this.notes.clear()
    this.setNote('scene', note('busy', `Scene ${folder} is read …`))
    this.view.clear()
    try {
      const scene = await this.store.scene(folder)
      const predictions = await this.ask.read(scene)
      if (version !== this.version) return
      this.scene = scene
      this.ask.openScene(predictions)
      this.map = null
      this.setNote('scene', null)
      const names = scene.agents.map(a => a.name)
      const c = this.choices
      c.agents = new Set((this.link.agents ?? names).filter(n => names.includes(n)))
      this.ego = names.includes(this.link.agent) ? this.link.agent : names[0]
      this.chosen = this.link.object ? Number(this.link.object) : null
      this.frame = Math.min(this.link.frame ?? 0, scene.frames - 1)
      const sensors = [...new Set(names.flatMap(n => this.sensorChoices(n)))]
      if (!sensors.includes(c.sensor)) c.sensor = sensors[0] ?? ''
      this.panels.newScene(sensors)
      this.view.navigation.mode = c.mode
      this.drawTracks()
      const { missing } = scene.store.index.scenes.find(s => s.folder === folder) ?? {}
      if (missing?.length) this.setNote('stages', unmade(scene, missing))
      if (scene.listing.stale?.length) this.setNote('stale', stale(scene.listing.stale))
      this.update()
      if (this.link.pose) this.view.navigation.pose = this.link.pose
      this.link = {}
    } catch (error) {
      if (version === this.version) this.fail('scene', error, { folder, store: this.store, info: {} })
    }
  }

  /** Sensors of an agent that give points; radars are one choice together. */
  sensorChoices(agent) {
    const sensors = this.scene.pointSensors(agent)
    return [...new Set(sensors.map(s => s.startsWith('RAD_') ? 'Radars' : s))]
  }

  sensorsShown(agent) {
    const { sensor } = this.choices
    return this.scene.pointSensors(agent).filter(s => sensor === 'Radars' ? s.startsWith('RAD_') : s === sensor)
  }

  /** What colours of points tell: the choice, or heights where the points do not say it. */
  get coloring() {
    const { color } = this.choices
    return this.unknown.has(color) ? 'height' : color
  }

  get egoAgent() {
    return this.scene.agents.find(a => a.name === this.ego)
  }

  get egoIndex() {
    return this.scene.agents.indexOf(this.egoAgent)
  }

  setTheme(theme) {
    document.documentElement.dataset.theme = theme
    this.isDark = theme === 'dark'
    this.view.setTheme(this.isDark)
    this.pictureTheme = this.isDark ? { bev: '#1b212b', text: '#f2f4f7', plate: 'rgb(15 19 25 / 78%)' } : { bev: '#e3e7ec', text: '#14181d', plate: 'rgb(255 255 255 / 82%)' }
    if (this.scene) {
      this.drawTracks()
      this.update()
    }
  }

  setNote(key, element) {
    if (element) this.notes.set(key, element)
    else if (!this.notes.delete(key)) return
    $('notes').replaceChildren(...this.notes.values())
  }

  fail(key, error, scene = this.scene) {
    if (error.name === 'AbortError') return
    if (error.name === 'MissingFile' && scene) {
      const path = error.path.replace(/^scenes\/[^/]+\//, '')
      const { stage, ...way } = remedy(scene, path)
      this.setNote(key, note('', `There is no ${path}${stage ? `: ${stage} writes it` : ''}. `, ...advice(way)))
      return
    }
    console.error(error)
    this.setNote(key, note('bad', error.message))
  }

  setFrame(frame) {
    const last = this.scene.frames - 1
    this.frame = Math.max(0, Math.min(frame, last))
    this.update()
  }

  setEgo(name) {
    this.ego = name
    this.choices.agents.add(name)
    this.view.navigation.anchor = null
    this.panels.agents()
    this.update()
  }

  /** A frame as an ego has it. */
  goTo(ego, frame) {
    if (ego !== this.ego) this.setEgo(ego)
    this.setFrame(frame)
  }

  setView(view) {
    this.panels.tools.endFilm()
    this.choices.view = view
    this.panels.views()
    this.resize()
    this.update()
  }

  toggle(kind, name) {
    const set = this.choices[kind]
    if (!set.delete(name)) set.add(name)
    this.panels.toggles()
    this.update()
  }

  /** How much the ego's cameras hide of objects, or null: nobody asks, it is not known, or it is read first. */
  occlusionOf() {
    const { scene, ego } = this
    if (!this.choices.occluded) return null
    if (this.occlusions?.scene !== scene || this.occlusions.ego !== ego) {
      const read = this.occlusions = Object.assign(new Occlusions(scene, ego), { ego })
      this.setNote('occluded', read.isThere ? null : note('', `Nobody knows what ${ego} sees occluded: it has no 2-D boxes (camera.boxes_2d).`))
      if (read.isThere) read.read().then(() => read === this.occlusions && this.update()).catch(error => this.fail('occluded', error))
    }
    return this.occlusions.byFrame && this.occlusions.at(this.frame)
  }

  /** All boxes of the frame that filters leave. */
  boxesLeft() {
    const e = this.scene.tables.poseAt(this.egoAgent, this.frame).matrix.elements
    const always = new Set([this.chosen, ...this.scene.agents.map(a => a.id)])
    return filtered(this.scene.tables.boxesAt(this.frame), this.choices, { here: [e[12], e[13]], always, occlusionOf: this.occlusionOf() })
  }

  boxesShown() {
    return this.ask.boxes(this.boxesLeft())
  }

  drawTracks() {
    const { hidden } = this.choices
    const color = boxColor(this.choices.boxes === 'id' ? 'id' : 'class', this.classColor, this.scene.agents, this.isDark)
    this.view.setTracks(this.scene.tables.tracks().filter(t => !hidden.has(t.class)), color)
  }

  /** Draws everything anew that follows from choices and frame. */
  update() {
    if (!this.scene) return
    const { choices: c, scene } = this
    const ego = this.egoAgent
    const pose = scene.tables.poseAt(ego, this.frame)
    this.panels.frame()
    const left = this.boxesLeft()
    const boxes = this.ask.boxes(left)
    const colorOf = this.ask.colorOf() ?? boxColor(c.boxes, this.classColor, scene.agents, this.isDark)
    if (c.view === '3d') {
      this.view.navigation.anchorAt(pose.matrix)
      this.view.update({
        coloring: this.coloring, pointSize: c.size, layers: c.layers, frame: this.frame, groundZ: pose.matrix.elements[14],
        place: { x: pose.matrix.elements[12], y: pose.matrix.elements[13] }, boxes: c.layers.has('boxes') ? boxes : [], colorOf, chosen: this.chosen,
        labels: c.layers.has('labels') ? this.labels(boxes, colorOf) : [], ...this.lines(boxes, colorOf, pose),
      })
      this.showPoints()
      this.showVoxels()
      if (c.layers.has('map')) this.showMap()
    }
    this.showPictures(boxes, colorOf)
    this.panels.ask.show(left)
    this.panels.object(this.chosen === null ? null : [...scene.tables.boxesAt(this.frame), ...boxes].find(b => b.id === this.chosen))
    this.prefetch()
    this.isDirty = true
    this.linkSoon()
  }

  /** What is drawn between boxes: who hears whom and how far, which prediction found what. */
  lines(boxes, colorOf, pose) {
    const { links, results } = this.ask.look()
    const e = pose.matrix.elements
    const { range, partners } = this.choices
    const ring = this.choices.ask === 'partners' && partners !== 'none' ? { center: [e[12], e[13], e[14]], radius: range, color: [125, 135, 150] } : null
    const at = new Map(boxes.map(b => [b.id, b]))
    const found = results ? boxes.filter(b => b.foundId && at.has(b.foundId)) : []
    return { links, ring, pairs: this.choices.layers.has('boxes') ? found.map(b => [b.center, at.get(b.foundId).center, colorOf(b)]) : [] }
  }

  labels(boxes, colorOf) {
    const { agents, tables } = this.scene
    const { results } = this.ask.look()
    const ids = new Map(agents.map((agent, i) => [agent.id, [agent, i]]))
    const labels = agents.map((agent, i) => {
      const e = tables.poseAt(agent, this.frame).matrix.elements
      return { text: agent.name, color: agentColor(i), place: [e[12], e[13], e[14] + (agent.name.startsWith('rsu') ? 5 : 2.2)], isFirst: true }
    })
    if (!this.choices.layers.has('boxes')) return labels
    for (const box of boxes) {
      // What was found needs no name: the missed and the false are looked for.
      if (ids.has(box.id) || box.result === 'right' || (box.id !== this.chosen && results?.targets.get(box.id) === 'found')) continue
      const [r, g, b] = colorOf(box)
      labels.push({ text: boxName(box), color: `rgb(${r} ${g} ${b})`, place: [box.center[0], box.center[1], box.center[2] + 0.5 * box.size[2] + 0.3], isFirst: box.id === this.chosen })
    }
    return labels
  }

  /** Whether an agent's points are shown: those of agents that are not heard are none of the ego's. */
  isShown(name) {
    const { agents, ask, heardOnly } = this.choices
    if (ask !== 'partners' || !heardOnly || name === this.ego) return agents.has(name)
    return agents.has(name) && this.ask.look().partners.some(p => p.name === name && p.isHeard)
  }

  /** The requests for the points of all shown agents at a frame. */
  async pointRequests(frame) {
    const requests = []
    const stride = this.stride()
    for (const agent of this.scene.agents) {
      if (!this.isShown(agent.name)) continue
      for (const sensor of this.sensorsShown(agent.name)) {
        requests.push({ agent, about: await this.scene.sensor(agent.name, sensor), request: await this.scene.pointsRequest(agent.name, sensor, frame, stride) })
      }
    }
    return requests
  }

  /** Points are read all, or each so-manieth: so many as a scene that plays is drawn of. What is once less stays so until it is still. */
  stride() {
    this.playStride = this.player.isPlaying ? Math.max(this.playStride, strideFor(this.view.detail.share)) : 1
    return this.playStride
  }

  async showPoints() {
    const { scene, frame, choices: c } = this
    this.shownStride = this.stride()
    const version = this.pointVersion = (this.pointVersion ?? 0) + 1
    if (!c.layers.has('points')) {
      for (const agent of scene.agents) this.view.hidePoints(agent.name)
      return
    }
    try {
      const wanted = await this.pointRequests(frame)
      const readings = await Promise.all(wanted.map(async w => ({ ...w, reading: await scene.cache.get(w.request) })))
      // Readings of different frames do not appear together.
      if (version !== this.pointVersion || scene !== this.scene) return
      this.setUnknown(readings)
      let tags = 0
      let count = 0
      for (const [index, agent] of scene.agents.entries()) {
        const own = readings.filter(r => r.agent === agent)
        this.view.setPoints(agent.name, index, scene.tables.poseAt(agent, frame), own)
        for (const { reading } of own) {
          tags |= reading.tags
          count += reading.total
        }
      }
      this.pointsFrame = frame
      this.pointCount = count
      this.panels.legend(tags >>> 0)
      this.setNote('points', readings.length || !c.agents.size ? null : this.noPoints())
      this.isDirty = true
    } catch (error) {
      if (version === this.pointVersion) this.fail('points', error)
    }
  }

  /** Looks which colourings the sensors of some readings say nothing of. */
  setUnknown(readings) {
    const unknown = new Set(['tag', 'id', 'intensity'].filter(column => readings.some(({ about }) => !about.known(column))))
    if ([...unknown].join() === [...this.unknown].join()) return
    this.unknown = unknown
    this.panels.colorings()
    this.view.setColoring(this.coloring)
  }

  noPoints() {
    if (this.scene.agents.some(a => this.scene.sensors(a.name).length)) return note('', 'The shown agents have no such sensor.')
    return note('', 'No sensors yet. ', ...advice(remedy(this.scene, 'sensors/')))
  }

  async showVoxels() {
    const { scene, frame, choices: c } = this
    const version = this.voxelVersion = (this.voxelVersion ?? 0) + 1
    if (!c.layers.has('voxels')) {
      this.view.voxels.hide()
      this.setNote('voxels', null)
      return
    }
    const kind = scene.voxelKinds.find(k => scene.has(`${k}/${this.ego}.npz`))
    if (!kind) {
      this.view.voxels.hide()
      this.setNote('voxels', note('', `No voxels of ${this.ego}. `, ...advice(remedy(scene, 'occupancy/'))))
      return
    }
    try {
      const request = await scene.voxelRequest(this.ego, kind, frame, VOXEL_DETAIL[c.voxels])
      const about = await scene.archive(`${kind}/${this.ego}.npz`)
      if (!scene.cache.peek(request)) this.setNote('voxels', note('busy', 'Voxels are unpacked …'))
      const faces = await scene.cache.get(request)
      if (version !== this.voxelVersion || scene !== this.scene) return
      this.setNote('voxels', faces.isCut ? note('', `More than ${VOXEL_DETAIL[c.voxels].limit.toLocaleString('en')} faces: the rest is left out.`) : null)
      this.view.voxels.show(faces, about, scene.tables.poseAt(this.egoAgent, request.frame).matrix)
      if (!c.layers.has('points')) this.panels.legend(faces.tags)
      this.isDirty = true
    } catch (error) {
      if (version === this.voxelVersion) this.fail('voxels', error)
    }
  }

  async showMap() {
    if (this.map) return
    const { scene } = this
    this.map = mapElements(scene)
    try {
      const elements = await this.map
      if (scene !== this.scene) return
      if (!elements.length && !scene.info.imported) this.setNote('map', note('', `The store has no lines of ${scene.info.map}. Run `, make('code', { textContent: 'make stage STAGE=spawn-planner' })))
      this.view.setMap(elements)
      this.isDirty = true
    } catch (error) {
      this.fail('map', error)
    }
  }

  /** The chosen camera and kind of image, or what comes nearest to them. */
  camera() {
    const cameras = this.scene.cameras(this.ego)
    const { camera } = this.choices
    const name = cameras.has(camera) ? camera : cameras.has('CAM_FRONT') ? 'CAM_FRONT' : [...cameras.keys()][0]
    return { name, kind: kindAtHand(cameras.get(name) ?? [], this.choices.kind) }
  }

  showPictures(boxes, colorOf) {
    const { choices: c, scene, frame } = this
    const version = this.pictureVersion = (this.pictureVersion ?? 0) + 1
    const isCurrent = () => version === this.pictureVersion && scene === this.scene
    const common = { scene, agent: this.egoAgent, frame, classColor: this.classColor, chosen: this.chosen, isCurrent, colorOf: c.ask === 'scene' ? b => this.classColor(b.class) : colorOf }
    if (c.view === 'cameras') this.grid.show(common, agent => this.boxesInPictures(boxes, agent)).catch(error => this.fail('pictures', error))
    const bev = (element, withBoxes) => this.isMissing(element, `bev/${this.ego}.npz`, 'No BEV masks') ? Promise.resolve(null)
      : drawBev(element, { ...common, boxes, hidden: c.hiddenBev, withBoxes, theme: this.pictureTheme, colorOf: c.ask === 'scene' ? null : colorOf })
    if (c.view === 'bev') bev(this.bev, c.bevBoxes).then(drawn => drawn && this.panels.bevLegend(drawn))
    if (c.view === '3d' && $('side').offsetWidth) {
      const { name, kind } = this.camera()
      if (name) drawCamera(this.inset, { ...common, boxes: this.boxesInPictures(boxes, this.egoAgent), kind, camera: name, width: THUMB_PX, marks: new Set(['boxes']) })
      else this.isMissing(this.inset, 'sensors/', 'No pictures')
      bev(this.insetBev, true)
    }
  }

  /** What only others saw would be drawn through walls, and is left out unless just that is asked. */
  boxesInPictures(boxes, agent) {
    const { ask, valid } = this.choices
    if (ask === 'scene') return valid ? boxes.filter(b => !b.seenBy.length || b.seenBy.includes(agent.name) || b.id === this.chosen) : boxes
    if (ask === 'partners') return boxes.filter(b => b.seenBy.length || b.id === this.chosen)
    // Predictions are those of the ego.
    return agent === this.egoAgent ? boxes : boxes.filter(b => !b.isPrediction)
  }

  /** Whether a file is not there; then the place of its picture says which stage writes it. */
  isMissing(element, path, what) {
    if (this.scene.has(path)) return false
    element.message.replaceChildren(make('span', {}, `${what} of ${this.ego}. `, ...advice(remedy(this.scene, path))))
    element.canvas.getContext('2d').clearRect(0, 0, element.canvas.width, element.canvas.height)
    return true
  }

  /** What the frames after this one need, while there is time. */
  async prefetch() {
    const { scene, frame } = this
    const version = this.aheadVersion = (this.aheadVersion ?? 0) + 1
    scene.cache.dropAhead()
    if (!this.player.isPlaying) return
    for (let step = 1; step <= AHEAD; step++) {
      for (const request of await this.needs((frame + step) % scene.frames)) {
        if (version !== this.aheadVersion || scene !== this.scene) return
        scene.cache.get(request, 1).catch(() => {})
      }
    }
  }

  /** The requests without which a frame is not played. */
  async needs(frame) {
    const { choices: c, scene } = this
    try {
      if (c.view === '3d') return c.layers.has('points') ? (await this.pointRequests(frame)).map(w => w.request) : []
      if (c.view === 'bev') return [await scene.bevRequest(this.ego, frame, c.hiddenBev)]
      return await this.grid.requests(frame)
    } catch {
      return []
    }
  }

  /** Whether all that a frame needs is at hand; asks for what is not. */
  isReady(frame) {
    if (this.ready?.version !== this.aheadVersion) this.ready = { version: this.aheadVersion, frames: new Map() }
    const { frames } = this.ready
    if (!frames.has(frame)) {
      frames.set(frame, null)
      this.needs(frame).then(requests => {
        frames.set(frame, requests)
        // What cannot be had holds nothing up: showing the frame tells why.
        for (const request of requests) this.scene.cache.get(request, 1).catch(() => frames.set(frame, frames.get(frame).filter(r => r !== request)))
      })
    }
    return frames.get(frame)?.every(request => this.scene.cache.peek(request)) ?? false
  }

  resize() {
    this.view.resize()
    this.isDirty = true
  }

  tick(now) {
    requestAnimationFrame(next => this.tick(next))
    const seconds = (now - (this.lastTick ?? now)) / 1000
    this.lastTick = now
    this.player.step(seconds, this.frame, this.scene?.frames ?? 0)
    if (this.view.navigation.step(seconds, this.isShiftHeld)) this.isDirty = true
    this.panels.waiting(this.player.isWaiting)
    if (this.shownStride > this.stride()) this.showPoints()
    if (this.choices.view !== '3d') this.isDirty = false
    else if (this.view.tick(now, this.isDirty, this.player.isPlaying)) this.isDirty = false
  }

  /** The address follows the choices, some moments later. */
  linkSoon() {
    if (!this.scene || this.linkTimer) return
    this.linkTimer = setTimeout(() => {
      this.linkTimer = null
      history.replaceState(null, '', this.linkHash())
      if (this.isOwn) remember(this.choices)
    }, 400)
  }

  linkHash() {
    const { choices: c, scene } = this
    const names = scene.agents.map(a => a.name)
    const all = { scene: scene.folder, frame: this.frame, agent: this.ego, object: this.chosen, ...c, pose: c.view === '3d' ? this.view.navigation.pose : undefined }
    return writeLink(all, { ...DEFAULTS, agents: names, agent: names[0] })
  }

  bind() {
    this.panels.bind()
    new ResizeObserver(() => {
      this.resize()
      if (this.scene) this.update()
    }).observe($('stage'))
    addEventListener('hashchange', () => {
      const link = readLink(location.hash)
      if (!this.scene || writeLink({}, {}) === location.hash || location.hash === this.linkHash()) return
      this.link = link
      Object.assign(this.choices, freshChoices())
      takeLink(this.choices, link)
      this.panels.toggles()
      this.panels.views()
      this.openScene(this.store.index.scenes.some(s => s.folder === link.scene) ? link.scene : this.scene.folder)
    })
  }
}

function storedTheme() {
  try {
    return localStorage.getItem('convoy-theme')
  } catch {
    return null
  }
}

