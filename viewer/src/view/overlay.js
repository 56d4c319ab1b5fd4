// What is written over the picture: labels of boxes and agents, a scale, which way the axes point.

import { Vector3 } from 'three'

/** More labels than this hide the scene; the nearest ones stay. */
const MAX_LABELS = 60
const FONT = '12px system-ui, sans-serif'

export class Overlay {
  constructor(canvas) {
    this.canvas = canvas
    this.context = canvas.getContext('2d')
    this.widths = new Map()
  }

  resize(width, height, ratio) {
    Object.assign(this, { width, height, ratio })
    this.canvas.width = Math.round(width * ratio)
    this.canvas.height = Math.round(height * ratio)
  }

  draw(camera, target, labels, theme) {
    const c = this.context
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0)
    c.clearRect(0, 0, this.width, this.height)
    this.labels(camera, labels, theme)
    this.axes(camera, theme)
    this.scale(camera, target, theme)
  }

  labels(camera, labels, theme) {
    const c = this.context
    c.font = FONT
    c.textBaseline = 'middle'
    const at = new Vector3()
    const shown = []
    for (const label of labels) {
      at.set(...label.place)
      const distance = at.distanceTo(camera.position)
      at.project(camera)
      if (at.z < -1 || at.z > 1 || Math.abs(at.x) > 1.05 || Math.abs(at.y) > 1.05) continue
      shown.push({ ...label, distance: label.isFirst ? 0 : distance, x: (at.x + 1) * 0.5 * this.width, y: (1 - at.y) * 0.5 * this.height })
    }
    shown.sort((a, b) => a.distance - b.distance)
    const taken = []
    for (const { text, color, x, y } of shown.slice(0, 3 * MAX_LABELS)) {
      if (taken.length >= MAX_LABELS) break
      let wide = this.widths.get(text)
      if (wide === undefined) {
        if (this.widths.size > 5000) this.widths.clear()
        this.widths.set(text, wide = c.measureText(text).width)
      }
      const box = { left: x - 0.5 * wide - 9, top: y - 20, right: x + 0.5 * wide + 5, bottom: y - 3 }
      if (taken.some(t => t.left < box.right && box.left < t.right && t.top < box.bottom && box.top < t.bottom)) continue
      taken.push(box)
      c.fillStyle = theme.label
      c.beginPath()
      c.roundRect(box.left, box.top, box.right - box.left, box.bottom - box.top, 3)
      c.fill()
      c.fillStyle = color
      c.fillRect(box.left, box.top + 2, 3, box.bottom - box.top - 4)
      c.fillStyle = theme.text
      c.fillText(text, box.left + 7, 0.5 * (box.top + box.bottom) + 0.5)
    }
  }

  /** East, north and up, in the lower left corner. */
  axes(camera, theme) {
    const c = this.context
    const middle = { x: 46, y: this.height - 46 }
    const turn = camera.matrixWorldInverse
    const arms = [['x', '#e0524d', 1, 0, 0], ['y', '#3aa655', 0, 1, 0], ['z', '#3987e5', 0, 0, 1]].map(([name, color, ...axis]) => {
      const v = new Vector3(...axis).transformDirection(turn)
      return { name, color, v }
    })
    arms.sort((a, b) => a.v.z - b.v.z)
    c.lineWidth = 2
    c.font = '600 11px system-ui, sans-serif'
    c.textAlign = 'center'
    for (const { name, color, v } of arms) {
      const [x, y] = [middle.x + 24 * v.x, middle.y - 24 * v.y]
      c.strokeStyle = c.fillStyle = color
      c.beginPath()
      c.moveTo(middle.x, middle.y)
      c.lineTo(x, y)
      c.stroke()
      c.fillStyle = theme.text
      c.fillText(name, middle.x + 33 * v.x, middle.y - 33 * v.y)
    }
    c.textAlign = 'left'
  }

  /** A bar of a round length at the target's distance. */
  scale(camera, target, theme) {
    const c = this.context
    const distance = camera.position.distanceTo(target)
    const metersPerPixel = 2 * distance * Math.tan(0.5 * camera.fov * Math.PI / 180) / this.height
    const rough = 110 * metersPerPixel
    const decade = 10 ** Math.floor(Math.log10(rough))
    const length = decade * [5, 2, 1].find(n => n * decade <= rough)
    const wide = length / metersPerPixel
    const [x, y] = [96, this.height - 34]
    c.strokeStyle = theme.text
    c.lineWidth = 1.5
    c.beginPath()
    c.moveTo(x, y - 4)
    c.lineTo(x, y)
    c.lineTo(x + wide, y)
    c.lineTo(x + wide, y - 4)
    c.stroke()
    c.font = FONT
    c.fillStyle = theme.text
    c.textBaseline = 'alphabetic'
    c.fillText(`${length >= 1 ? length : length.toFixed(1)} m`, x + 4, y - 6)
  }
}
