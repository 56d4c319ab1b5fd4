// Which cameras of all agents show an object.

import { Vector3 } from 'three'
import { poseMatrix } from '../geometry.js'
import { projector } from '../lens.js'
import { FAR_M } from './pictures.js'

/** More pictures than this are not shown. */
const MOST = 12

/**
 * `{agent, camera, pixels}` of cameras that show a box, most pixels first. Where an agent has 2-D boxes, these say it. Elsewhere
 * a camera counts whose lens has the box's centre in its picture, up to 120 m, if the agent saw the object: it may be hidden there.
 */
export async function camerasThatSee(scene, box, frame) {
  const found = await Promise.all(scene.agents.filter(agent => agent.id !== box.id).map(agent => ofAgent(scene, agent, box, frame)))
  return found.flat().sort((a, b) => (b.pixels ?? 0) - (a.pixels ?? 0)).slice(0, MOST)
}

async function ofAgent(scene, agent, box, frame) {
  const cameras = scene.cameras(agent.name)
  const path = `sensors/${agent.name}/boxes_2d.parquet`
  if (scene.has(path)) {
    const { columns: c, rows } = await scene.cache.get({ kind: 'table', ...scene.file(path), columns: ['frame', 'camera', 'id', 'pixels'] })
    // Cameras may take a picture at a part of the frames: the latest one.
    const latest = new Map()
    for (let row = 0; row < rows; row++) {
      const [at, camera] = [c.frame.values[row], c.camera.values[row]]
      if (c.id.values[row] === box.id && at <= frame && cameras.has(camera)) latest.set(camera, { at, pixels: c.pixels?.values[row] ?? null })
    }
    const shown = await Promise.all([...latest].map(async ([camera, { at, pixels }]) => {
      const about = await scene.sensor(agent.name, `${cameras.get(camera)[0]}-${camera}`)
      return at === frame - frame % (about.every_n_frames ?? 1) ? { agent, camera, pixels } : null
    }))
    return shown.filter(Boolean)
  }
  if (!box.seenBy.includes(agent.name)) return []
  const pose = scene.tables.poseAt(agent, frame).matrix
  const shown = await Promise.all([...cameras].map(async ([camera, kinds]) => {
    const about = await scene.sensor(agent.name, `${kinds[0]}-${camera}`)
    const { translation, quaternion } = about.agent_from_sensor
    const at = new Vector3(...box.center).applyMatrix4(pose.clone().multiply(poseMatrix(translation, quaternion)).invert())
    const place = at.length() <= FAR_M ? projector(about)(at) : null
    return place && place[0] >= 0 && place[1] >= 0 && place[0] < about.width && place[1] < about.height ? { agent, camera, pixels: null } : null
  }))
  return shown.filter(Boolean)
}
