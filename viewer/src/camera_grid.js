// All cameras of an agent side by side, or one alone.

import { remedy } from './data/store.js'
import { $, advice, make } from './ui.js'
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
    this.pictures = new Map()
  }

  show(common) {
    const { scene, ego, choices, panels } = this.app
    const cameras = scene.cameras(ego)
    const names = this.names()
    const key = `${scene.folder} ${ego} ${names}`
    if (this.key !== key) {
      this.key = key
      this.pictures = new Map(names.map(name => [name, pictureElement(name)]))
      this.host.replaceChildren(...[...this.pictures.values()].map(p => p.figure))
      for (const [name, { figure }] of this.pictures) figure.addEventListener('dblclick', () => panels.setCamera(choices.camera ? '' : name))
      if (!names.length) this.host.append(make('p', { className: 'note' }, `No pictures of ${ego}. `, ...advice(remedy(scene, 'sensors/'))))
    }
    this.host.style.gridTemplateColumns = `repeat(${this.across()}, minmax(0, 1fr))`
    for (const [name, element] of this.pictures) {
      const kind = kindAtHand(cameras.get(name), choices.kind)
      element.caption.textContent = kind === choices.kind ? name : `${name} (${kind})`
      drawCamera(element, { ...common, kind, camera: name, width: this.width(), marks: choices.marks })
    }
  }

  names() {
    const cameras = this.app.scene.cameras(this.app.ego)
    const { camera } = this.app.choices
    return cameras.has(camera) ? [camera] : [...cameras.keys()].sort(byPlace)
  }

  across() {
    return this.pictures.size === 1 || this.host.clientWidth < NARROW_PX ? 1 : Math.min(3, this.pictures.size)
  }

  /** How wide pictures are decoded; one alone as it is. */
  width() {
    if (this.pictures.size === 1) return undefined
    const wanted = this.host.clientWidth / this.across() * Math.min(devicePixelRatio, 2)
    return Math.min(WIDEST_PX, Math.ceil(wanted / STEP_PX) * STEP_PX)
  }

  /** The requests for all pictures of a frame. */
  requests(frame) {
    const { scene, ego, choices } = this.app
    const cameras = scene.cameras(ego)
    return Promise.all([...this.pictures.keys()].map(name => {
      const kind = kindAtHand(cameras.get(name) ?? [], choices.kind)
      return scene.imageRequest(ego, kind, name, frame, SHOWN_AS[kind], this.width())
    }))
  }
}

/** Left of front, front, right of front; then the back ones. */
function byPlace(a, b) {
  const rank = name => (name.includes('BACK') ? 3 : 0) + (name.includes('LEFT') ? 0 : name.includes('RIGHT') ? 2 : 1)
  return rank(a) - rank(b) || a.localeCompare(b)
}
