// Boxes as lines, with an arrow on the ground where their front is.

import { LineSegments2 } from 'three/addons/lines/LineSegments2.js'
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js'
import { LineMaterial } from 'three/addons/lines/LineMaterial.js'
import { Vector3 } from 'three'
import { BOX_EDGES, boxCorners, boxMatrix } from '../geometry.js'

/** Slower than this objects have no arrow of their velocity, m/s. */
const SLOW_MPS = 0.3

export class BoxLines {
  /** `dashed` lines are of boxes that a model found. */
  constructor({ dashed = false } = {}) {
    const dashes = dashed ? { dashed, dashSize: 0.5, gapSize: 0.3 } : {}
    this.dashed = dashed
    this.material = new LineMaterial({ linewidth: 1.6, vertexColors: true, ...dashes })
    this.strong = new LineMaterial({ linewidth: 3.2, vertexColors: true, ...dashes })
    this.all = new LineSegments2(new LineSegmentsGeometry(), this.material)
    this.chosen = new LineSegments2(new LineSegmentsGeometry(), this.strong)
    this.objects = [this.all, this.chosen]
    for (const object of this.objects) object.frustumCulled = false
  }

  /** `boxes` with a colour each, sRGB bytes; one may be chosen by id. */
  show(boxes, colorOf, chosenId) {
    this.draw(this.all, boxes.filter(box => box.id !== chosenId), colorOf)
    this.draw(this.chosen, boxes.filter(box => box.id === chosenId), colorOf)
  }

  draw(lines, boxes, colorOf) {
    lines.visible = boxes.length > 0
    if (!boxes.length) return
    const [places, colors] = [[], []]
    for (const box of boxes) {
      const color = colorOf(box).map(v => v / 255)
      const add = (a, b) => {
        places.push(a.x, a.y, a.z, b.x, b.y, b.z)
        colors.push(...color, ...color)
      }
      const corners = boxCorners(box)
      for (const [a, b] of BOX_EDGES) add(corners[a], corners[b])
      // The front: a chevron on the ground.
      const matrix = boxMatrix(box.center, box.rpy)
      const [l, w, h] = box.size
      const point = (x, y) => new Vector3(x, y, -0.5 * h).applyMatrix4(matrix)
      const reach = Math.min(1, 0.4 * w) + 0.5 * l
      add(point(0.5 * l, 0.5 * w), point(reach, 0))
      add(point(0.5 * l, -0.5 * w), point(reach, 0))
      if (box.speed > SLOW_MPS) {
        const from = point(0, 0)
        add(from, from.clone().add(new Vector3(...box.velocity)))
      }
    }
    // A new geometry each time: the old one's buffers have another length.
    lines.geometry.dispose()
    lines.geometry = new LineSegmentsGeometry()
    lines.geometry.setPositions(places)
    lines.geometry.setColors(colors)
    if (this.dashed) lines.computeLineDistances()
  }

  setSize(width, height) {
    this.material.resolution.set(width, height)
    this.strong.resolution.set(width, height)
  }
}
