// Boxes as lines, with an arrow on the ground where their front is.

import { LineSegments2 } from 'three/addons/lines/LineSegments2.js'
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js'
import { LineMaterial } from 'three/addons/lines/LineMaterial.js'
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineDashedMaterial, LineSegments, Vector3 } from 'three'
import { BOX_EDGES, boxCorners, boxMatrix } from '../geometry.js'

/** Slower than this objects have no arrow of their velocity, m/s. */
const SLOW_MPS = 0.3

export class BoxLines {
  /** `dashed` lines are of boxes that a model found; `hasThin` is for machines on which wide lines take long, see `setThin`. */
  constructor({ dashed = false, hasThin = false } = {}) {
    const dash = { dashSize: 0.5, gapSize: 0.3 }
    const dashes = dashed ? { dashed, ...dash } : {}
    this.dashed = dashed
    this.material = new LineMaterial({ linewidth: 1.6, vertexColors: true, ...dashes })
    this.strong = new LineMaterial({ linewidth: 3.2, vertexColors: true, ...dashes })
    this.all = new LineSegments2(new LineSegmentsGeometry(), this.material)
    this.chosen = new LineSegments2(new LineSegmentsGeometry(), this.strong)
    this.objects = [this.all, this.chosen]
    this.thin = null
    this.hasBoxes = false
    if (hasThin) {
      const material = dashed ? new LineDashedMaterial({ vertexColors: true, ...dash }) : new LineBasicMaterial({ vertexColors: true })
      this.thin = new LineSegments(new BufferGeometry(), material)
      this.objects.push(this.thin)
    }
    for (const object of this.objects) object.frustumCulled = false
  }

  /** Whether boxes have lines of a pixel, all but the chosen one: a processor draws wide ones ten times slower. */
  setThin(isThin) {
    if (!this.thin) return
    this.thin.visible = this.hasBoxes && isThin
    this.all.visible = this.hasBoxes && !isThin
  }

  /** `boxes` with a colour each, sRGB bytes; one may be chosen by id. */
  show(boxes, colorOf, chosenId) {
    const others = segments(boxes.filter(box => box.id !== chosenId), colorOf)
    this.hasBoxes = others.places.length > 0
    this.draw(this.all, others)
    this.draw(this.chosen, segments(boxes.filter(box => box.id === chosenId), colorOf))
    if (!this.thin) return
    this.thin.geometry.dispose()
    const geometry = this.thin.geometry = new BufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(others.places, 3))
    geometry.setAttribute('color', new BufferAttribute(others.colors, 3))
    if (this.dashed) this.thin.computeLineDistances()
    this.setThin(false)
  }

  draw(lines, { places, colors }) {
    lines.visible = places.length > 0
    if (!places.length) return
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

/** Ends of lines and their colours, three numbers each: edges, the front, the velocity. */
function segments(boxes, colorOf) {
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
  return { places: new Float32Array(places), colors: new Float32Array(colors) }
}
