// Lines between things that belong together: agents that hear each other, predictions and what they found; and how far the ego hears.

import { LineMaterial } from 'three/addons/lines/LineMaterial.js'
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js'
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js'

/** Links hang so high above agents' origins, m. */
const LIFT_M = 2.4
const RING_STEPS = 96

export class Links {
  constructor() {
    this.strong = lines(3)
    this.faint = lines(1.2)
    this.faint.material.transparent = true
    this.faint.material.opacity = 0.55
    this.objects = [this.strong, this.faint]
  }

  /** `links` are `{from, to, color, isStrong}`; `pairs` have two places and a colour; `ring` is `{center, radius, color}` or null; `measured` are pairs, too. */
  show(links, pairs, ring, measured = []) {
    const lifted = ([x, y, z]) => [x, y, z + LIFT_M]
    const of = isStrong => links.filter(l => l.isStrong === isStrong).map(l => [lifted(l.from), lifted(l.to), l.color])
    draw(this.strong, [...of(true), ...measured])
    draw(this.faint, [...of(false), ...pairs, ...ring ? circle(ring) : []])
  }

  setSize(width, height) {
    for (const { material } of this.objects) material.resolution.set(width, height)
  }
}

function lines(linewidth) {
  const made = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth, vertexColors: true }))
  made.frustumCulled = false
  made.visible = false
  return made
}

function draw(object, segments) {
  object.visible = segments.length > 0
  if (!segments.length) return
  object.geometry.dispose()
  object.geometry = new LineSegmentsGeometry()
  object.geometry.setPositions(segments.flatMap(([a, b]) => [...a, ...b]))
  object.geometry.setColors(segments.flatMap(([, , color]) => [...color, ...color].map(v => v / 255)))
}

function circle({ center: [x, y, z], radius, color }) {
  const at = i => [x + radius * Math.cos(2 * Math.PI * i / RING_STEPS), y + radius * Math.sin(2 * Math.PI * i / RING_STEPS), z + 0.1]
  return Array.from({ length: RING_STEPS }, (_, i) => [at(i), at(i + 1), color])
}
