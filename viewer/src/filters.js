// Which boxes are shown: by class, distance from the agent, points, difficulty, occlusion, and whether anybody saw them.

/** The boxes of a list that pass; the chosen one and agents always do. */
export function filtered(boxes, choices, { here, always, occlusionOf = null }) {
  const { hidden, valid, ask, within, points, levels, occluded } = choices
  // Who asks what partners add or a model saw wants to see what nobody saw, too.
  const isSeenOnly = valid && ask === 'scene'
  return boxes.filter(box => {
    if (hidden.has(box.class)) return false
    if (always.has(box.id)) return true
    if (isSeenOnly && !box.isValid) return false
    if (within && Math.hypot(box.center[0] - here[0], box.center[1] - here[1]) > Number(within)) return false
    if (points && box.lidarPoints !== null && box.lidarPoints + (box.radarPoints ?? 0) < points) return false
    // What no camera of the agent shows is as good as hidden.
    if (occluded && occlusionOf && !(occlusionOf(box.id) <= Number(occluded))) return false
    return !box.difficulty || levels.has(box.difficulty)
  })
}

/** How much of objects others hide in the cameras of an agent: the least of all its cameras, from its 2-D boxes. */
export class Occlusions {
  constructor(scene, agent) {
    this.path = `sensors/${agent}/boxes_2d.parquet`
    this.scene = scene
    this.isThere = scene.has(this.path)
    this.byFrame = null
  }

  async read() {
    const { columns: c, rows } = await this.scene.cache.get({ kind: 'table', ...this.scene.file(this.path), columns: ['frame', 'id', 'occlusion'] })
    if (!c.occlusion) throw new Error(`${this.path} does not say what is occluded`)
    this.byFrame = new Map()
    for (let row = 0; row < rows; row++) {
      const [frame, id, occlusion] = [c.frame.values[row], c.id.values[row], c.occlusion.values[row]]
      if (!this.byFrame.has(frame)) this.byFrame.set(frame, new Map())
      const ids = this.byFrame.get(frame)
      ids.set(id, Math.min(ids.get(id) ?? 1, occlusion))
    }
    this.frames = [...this.byFrame.keys()].sort((a, b) => a - b)
  }

  /** Occlusion of objects by id at the latest frame with pictures, 0 to 1; undefined where no camera shows one. */
  at(frame) {
    const latest = this.frames.findLast(f => f <= frame)
    const ids = this.byFrame.get(latest)
    return id => ids?.get(id)
  }
}
