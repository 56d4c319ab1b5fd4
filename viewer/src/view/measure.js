// Measuring a distance: two clicks, each on the nearest point of a cloud under the pointer, or on the ground.

import { Plane, Raycaster, Vector2, Vector3 } from 'three'

/** A click takes a point that lies so near to it on the screen, pixels. */
const NEAR_PX = 7

export class Measure {
  constructor() {
    this.isOn = false
    this.ends = []
  }

  toggle(isOn = !this.isOn) {
    this.isOn = isOn
    this.ends = []
  }

  /** A click while measuring: the third one begins anew. */
  click(place) {
    if (this.ends.length === 2) this.ends = []
    if (place) this.ends.push(place)
  }

  /** The line between both ends, as the view draws lines. */
  line(color) {
    return this.ends.length === 2 ? [[this.ends[0].toArray(), this.ends[1].toArray(), color]] : []
  }

  /** What stands beside it, as labels. */
  labels(color) {
    const [a, b] = this.ends
    if (!a) return []
    if (!b) return [{ text: 'to …', color, place: a.toArray(), isFirst: true }]
    const across = Math.hypot(b.x - a.x, b.y - a.y)
    const text = `${a.distanceTo(b).toFixed(2)} m (across ${across.toFixed(2)}, up ${(b.z - a.z).toFixed(2)})`
    return [{ text, color, place: a.clone().add(b).multiplyScalar(0.5).toArray(), isFirst: true }]
  }
}

/** The place that a click means: the point of the clouds nearest to the eye among those under the pointer, else the ground; or null. */
export function placeUnder({ camera, area, clientX, clientY, clouds, groundZ }) {
  const at = new Vector2((clientX - area.left) / area.width * 2 - 1, 1 - (clientY - area.top) / area.height * 2)
  const [reachX, reachY] = [2 * NEAR_PX / area.width, 2 * NEAR_PX / area.height]
  const place = new Vector3()
  let best = null
  for (const cloud of clouds) {
    const { object } = cloud
    if (!object.visible || !cloud.shown) continue
    const { position, count } = cloud.shown
    const screen = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).multiply(object.matrixWorld)
    for (let i = 0; i < count; i++) {
      place.set(position[3 * i], position[3 * i + 1], position[3 * i + 2]).applyMatrix4(screen)
      if (place.z < -1 || place.z > 1 || Math.abs(place.x - at.x) > reachX || Math.abs(place.y - at.y) > reachY) continue
      if (!best || place.z < best.depth) best = { depth: place.z, cloud, i }
    }
  }
  if (best) {
    const { position } = best.cloud.shown
    return new Vector3(position[3 * best.i], position[3 * best.i + 1], position[3 * best.i + 2]).applyMatrix4(best.cloud.object.matrixWorld)
  }
  const caster = new Raycaster()
  caster.setFromCamera(at, camera)
  return caster.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -groundZ), new Vector3())
}
