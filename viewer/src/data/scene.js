// A scene's tables: where agents are, which boxes there are at a frame, which ways objects go, the map's lines.

import { poseMatrix } from '../geometry.js'

const BOX_COLUMNS = ['frame', 'id', 'class', 'center_m', 'size_m', 'rpy_rad', 'velocity_mps', 'num_lidar_pts', 'num_radar_pts', 'valid_flag',
  'difficulty', 'seen_by', 'signal_state', 'opendrive_id', 'attributes', 'model', 'agent', 'distance_m']
const MAP_COLUMNS = ['kind', 'x_m', 'y_m', 'z_m', 'lane_type', 'mark_type', 'mark_color', 'is_edge', 'is_junction', 'dash_m']
/** An object that moved less than this over a scene has no track to show, m. */
const MOVED_M = 0.5

export class SceneTables {
  static async read(scene) {
    const cache = scene.cache
    const read = (path, columns) => cache.get({ kind: 'table', ...scene.file(path), columns })
    const agents = await read('agents.parquet', ['frame', 'agent', 'id', 'xyz_m', 'quaternion', 'velocity_mps'])
    const isMerged = scene.has('tracks_frames.parquet')
    const boxFile = isMerged ? 'tracks_frames.parquet' : 'boxes.parquet'
    const boxes = scene.has(boxFile) ? await read(boxFile, BOX_COLUMNS) : null
    const tables = new SceneTables(scene.info, agents)
    tables.isMerged = isMerged
    if (boxes) tables.takeBoxes(boxes)
    return tables
  }

  constructor(info, table) {
    const { frame, agent, id, xyz_m: xyz, quaternion, velocity_mps: velocity } = columnsOf(table)
    this.everyNFrames = info.label_every_n_frames ?? 1
    const order = (info.agents ?? []).map(a => a.agent)
    const names = [...new Set(agent)].sort((a, b) => (order.indexOf(a) + 1 || 1e9) - (order.indexOf(b) + 1 || 1e9))
    this.agents = names.map(name => ({ name, id: 0, model: info.agents?.find(a => a.agent === name)?.model ?? '', poses: [] }))
    this.origin = [xyz[0], xyz[1], xyz[2]]
    for (let row = 0; row < table.rows; row++) {
      const one = this.agents[names.indexOf(agent[row])]
      one.id = id[row]
      one.poses[frame[row]] = {
        matrix: poseMatrix(xyz.subarray(3 * row, 3 * row + 3), quaternion.subarray(4 * row, 4 * row + 4), this.origin),
        velocity: velocity.slice(3 * row, 3 * row + 3),
      }
    }
    this.boxRows = new Map()
    this.classes = []
  }

  takeBoxes(table) {
    this.boxes = columnsOf(table)
    this.seenStarts = table.columns.seen_by?.starts
    const { frame, id } = this.boxes
    const seen = new Set()
    for (let row = 0; row < table.rows; row++) {
      if (!this.boxRows.has(frame[row])) this.boxRows.set(frame[row], [])
      // Without merged boxes: each object once, from the first agent's list that has it.
      const key = frame[row] * 65536 + id[row]
      if (!this.isMerged && seen.has(key)) continue
      seen.add(key)
      this.boxRows.get(frame[row]).push(row)
    }
    this.classes = [...new Set(this.boxes.class)].sort()
  }

  /** The frame whose boxes are shown at a frame. */
  boxFrame(frame) {
    return frame - frame % this.everyNFrames
  }

  /** Boxes of a frame, relative to the scene's origin. */
  boxesAt(frame) {
    this.last ??= {}
    const at = this.boxFrame(frame)
    if (this.last.frame === at) return this.last.boxes
    const boxes = (this.boxRows.get(at) ?? []).map(row => this.box(row))
    this.last = { frame: at, boxes }
    return boxes
  }

  /** Ids of a frame's boxes with who saw each. */
  seenAt(frame) {
    const { id, seen_by: seen } = this.boxes
    const starts = this.seenStarts
    return (this.boxRows.get(frame) ?? []).map(row => ({ id: id[row], seenBy: starts ? seen.slice(starts[row], starts[row + 1]) : [] }))
  }

  /** Where agents are at a frame: name to x, y, z, relative to the scene's origin. */
  placesAt(frame) {
    return new Map(this.agents.map(agent => [agent.name, [12, 13, 14].map(i => this.poseAt(agent, frame).matrix.elements[i])]))
  }

  /** The frame nearest to another one whose lists have an object, or null. */
  frameOf(id, near) {
    let best = null
    for (const [frame, rows] of this.boxRows) {
      if (best !== null && Math.abs(best - near) <= Math.abs(frame - near)) continue
      if (rows.some(row => this.boxes.id[row] === id)) best = frame
    }
    return best
  }

  /** What an object does over the scene, seen from an agent: `[{frame, speed, distance, lidarPoints, seers}]`; null is not known. */
  history(id, agent) {
    const found = []
    for (const [frame, rows] of this.boxRows) {
      const row = rows.find(r => this.boxes.id[r] === id)
      if (row === undefined) continue
      const { center, speed, lidarPoints, seenBy } = this.box(row)
      const e = this.poseAt(agent, frame).matrix.elements
      found.push({ frame, speed, distance: Math.hypot(...center.map((v, i) => v - e[12 + i])), lidarPoints, seers: this.isMerged ? seenBy.length : null })
    }
    return found.sort((a, b) => a.frame - b.frame)
  }

  box(row) {
    const b = this.boxes
    const triple = column => [column[3 * row], column[3 * row + 1], column[3 * row + 2]]
    const center = triple(b.center_m).map((v, i) => v - this.origin[i])
    const get = name => b[name]?.[row] ?? null
    const velocity = triple(b.velocity_mps)
    return {
      row, id: b.id[row], class: b.class[row], center, size: triple(b.size_m), rpy: triple(b.rpy_rad), velocity,
      speed: Math.hypot(...velocity), lidarPoints: get('num_lidar_pts'), radarPoints: get('num_radar_pts'),
      isValid: b.valid_flag ? b.valid_flag[row] === 1 : true, difficulty: get('difficulty'), signalState: get('signal_state'),
      opendriveId: get('opendrive_id'), model: get('model'), attributes: get('attributes'),
      seenBy: this.seenStarts ? b.seen_by.slice(this.seenStarts[row], this.seenStarts[row + 1]) : [],
    }
  }

  /** Ways of objects that moved: `[{id, class, frames, points}]`, points relative to the origin. */
  tracks() {
    if (this.ways) return this.ways
    const ways = new Map()
    if (this.boxes) {
      for (const frame of [...this.boxRows.keys()].sort((a, b) => a - b)) {
        for (const row of this.boxRows.get(frame)) {
          const id = this.boxes.id[row]
          if (!ways.has(id)) ways.set(id, { id, class: this.boxes.class[row], frames: [], points: [] })
          const way = ways.get(id)
          way.frames.push(frame)
          way.points.push([0, 1, 2].map(i => this.boxes.center_m[3 * row + i] - this.origin[i] - (i === 2 ? 0.5 * this.boxes.size_m[3 * row + 2] - 0.1 : 0)))
        }
      }
    }
    const moved = ({ points }) => points.some(p => Math.hypot(p[0] - points[0][0], p[1] - points[0][1]) > MOVED_M)
    this.ways = [...ways.values()].filter(moved)
    return this.ways
  }

  poseAt(agent, frame) {
    return agent.poses[frame] ?? agent.poses.at(-1)
  }
}

/** The map's elements that have lines: `[{kind, points, ...}]`, relative to the origin. */
export async function mapElements(scene) {
  const path = `maps/${scene.info.map}.vector.parquet`
  const size = scene.listing.map_bytes
  if (!size) return []
  const table = await scene.cache.get({ kind: 'table', path, size, columns: MAP_COLUMNS })
  const columns = columnsOf(table)
  const starts = table.columns.x_m.starts
  const origin = scene.tables.origin
  const elements = []
  for (let row = 0; row < table.rows; row++) {
    const points = []
    for (let i = starts[row]; i < starts[row + 1]; i++) points.push([columns.x_m[i] - origin[0], columns.y_m[i] - origin[1], columns.z_m[i] - origin[2]])
    const dashed = table.columns.dash_m.starts[row + 1] > table.columns.dash_m.starts[row]
    elements.push({
      kind: columns.kind[row], points, laneType: columns.lane_type?.[row], markColor: columns.mark_color?.[row], isEdge: columns.is_edge?.[row] === 1,
      dash: dashed ? [...columns.dash_m.subarray(table.columns.dash_m.starts[row], table.columns.dash_m.starts[row + 1])] : null,
    })
  }
  return elements
}

function columnsOf(table) {
  return Object.fromEntries(Object.entries(table.columns).map(([name, column]) => [name, column.values]))
}
