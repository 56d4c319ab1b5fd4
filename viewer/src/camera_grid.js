// Cameras side by side: all of an agent, the same one of several agents, or all that see one object; or one alone.

import { remedy } from './data/store.js'
import { $, advice, make } from './ui.js'
import { camerasThatSee } from './view/cameras_of_object.js'
import { SHOWN_AS, drawCamera, pictureElement } from './view/pictures.js'

/** Pictures in a grid are decoded in steps of this width, at most the other, pixels: a window that grows a little decodes nothing anew. */
const STEP_PX = 160
const WIDEST_PX = 960
const NARROW_PX = 700

export const kindAtHand = (kinds, wanted) => kinds.includes(wanted) ? wanted : kinds.includes('RGB') ? 'RGB' : kinds[0]

export class CameraGrid {
  constructor(app) {
    this.app = app
    this.host = $('view-cameras')
    /** By agent and camera: `{agent, camera, element}`. */
    this.pictures = new Map()
  }

  /** `common` is what all pictures share; `boxesOf(agent)` are the boxes that are drawn into an agent's pictures. */
  async show(common, boxesOf) {
    const { scene, choices, panels } = this.app
    const views = await this.views()
    if (!common.isCurrent()) return
    const key = `${scene.folder} ${choices.grid} ${views.map(v => `${v.agent.name}/${v.camera}`)}`
    if (this.key !== key) {
      this.key = key
      this.pictures = new Map(views.map(view => [`${view.agent.name}/${view.camera}`, { ...view, element: pictureElement('') }]))
      this.host.replaceChildren(...[...this.pictures.values()].map(p => p.element.figure))
      for (const { agent, camera, element: { figure } } of this.pictures.values()) {
        figure.addEventListener('dblclick', () => {
          const isAlone = choices.grid === 'agent' && choices.camera === camera
          choices.grid = 'agent'
          this.app.ego = agent.name
          panels.setCamera(isAlone ? '' : camera)
          panels.agents()
        })
      }
      if (!views.length) this.host.append(this.nothing())
    }
    this.host.style.gridTemplateColumns = `repeat(${this.across()}, minmax(0, 1fr))`
    for (const { agent, camera, pixels, element } of this.pictures.values()) {
      const kind = kindAtHand(scene.cameras(agent.name).get(camera), choices.kind)
      const facts = [choices.grid === 'agent' ? camera : `${agent.name} · ${camera}`]
      if (kind !== choices.kind) facts.push(`(${kind})`)
      if (pixels) facts.push(`${pixels.toLocaleString('en')} px`)
      element.caption.textContent = facts.join(' ')
      drawCamera(element, { ...common, agent, kind, camera, width: this.width(), marks: choices.marks, boxes: boxesOf(agent) })
    }
  }

  nothing() {
    const { scene, ego, choices, chosen } = this.app
    if (choices.grid === 'object') {
      const text = chosen === null ? 'Choose an object first: click a box in 3-D, or search for its id.' : `No camera shows object ${chosen} at this frame.`
      return make('p', { className: 'note', textContent: text })
    }
    return make('p', { className: 'note' }, `No pictures of ${ego}. `, ...advice(remedy(scene, 'sensors/')))
  }

  /** Which pictures are wanted: `{agent, camera, pixels}`, `pixels` where it is known how many show the chosen object. */
  async views() {
    const { app } = this
    const { scene, choices, chosen, frame, ego } = app
    if (choices.grid === 'object') {
      const box = chosen === null ? null : scene.tables.boxesAt(frame).find(b => b.id === chosen)
      return box ? camerasThatSee(scene, box, frame) : []
    }
    if (choices.grid === 'agents') {
      const shown = scene.agents.filter(a => choices.agents.has(a.name))
      return shown.flatMap(agent => {
        const cameras = [...scene.cameras(agent.name).keys()]
        const camera = [choices.camera, 'CAM_FRONT', cameras[0]].find(c => cameras.includes(c))
        return camera ? [{ agent, camera }] : []
      })
    }
    const cameras = [...scene.cameras(ego).keys()]
    const names = cameras.includes(choices.camera) ? [choices.camera] : cameras.sort(byPlace)
    return names.map(camera => ({ agent: app.egoAgent, camera }))
  }

  across() {
    const { size } = this.pictures
    if (size === 1 || this.host.clientWidth < NARROW_PX) return 1
    return size === 3 && this.app.choices.grid === 'agent' || size > 4 ? 3 : 2
  }

  /** How wide pictures are decoded; one alone as it is. */
  width() {
    if (this.pictures.size === 1) return undefined
    const wanted = this.host.clientWidth / this.across() * Math.min(devicePixelRatio, 2)
    return Math.min(WIDEST_PX, Math.ceil(wanted / STEP_PX) * STEP_PX)
  }

  /** The requests for all pictures of a frame. */
  requests(frame) {
    const { scene, choices } = this.app
    return Promise.all([...this.pictures.values()].map(({ agent, camera }) => {
      const kind = kindAtHand(scene.cameras(agent.name).get(camera) ?? [], choices.kind)
      return scene.imageRequest(agent.name, kind, camera, frame, SHOWN_AS[kind], this.width())
    }))
  }
}

/** Left of front, front, right of front; then the back ones. */
function byPlace(a, b) {
  const rank = name => (name.includes('BACK') ? 3 : 0) + (name.includes('LEFT') ? 0 : name.includes('RIGHT') ? 2 : 1)
  return rank(a) - rank(b) || a.localeCompare(b)
}
