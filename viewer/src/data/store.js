// The store as the page sees it: scenes, which files they have, and requests for their contents.

import { MissingFile } from './files.js'
import { SceneTables } from './scene.js'

/** Stages by what they write in a scene's folder; whatever else lies there is the simulation's. */
const STAGES = {
  sensors: 'render-sensors',
  bev: 'bev-gt',
  bev_paint: 'bev-gt',
  bev_ids: 'bev-gt',
  bev_heights: 'bev-gt',
  occupancy: 'occupancy-gt',
  occupancy_cells: 'occupancy-gt',
  occupancy_ids: 'occupancy-gt',
  occupancy_flow: 'occupancy-gt',
  occupancy_filled: 'postprocess-valid',
  occupancy_observed: 'postprocess-valid',
  'boxes_valid.parquet': 'postprocess-valid',
  'tracks.parquet': 'merge-tracks',
  'tracks_frames.parquet': 'merge-tracks',
  'tracks_agents.parquet': 'merge-tracks',
  'tracks_windows.parquet': 'merge-tracks',
}

/** The stage that writes a file of a scene. */
export function stageOf(path) {
  return STAGES[path.split('/')[0]] ?? 'simulate-and-log'
}

/** What to do about a file of a scene that is not there: the stage that writes it, and how to run it; or why nothing can be done. */
export function remedy(scene, path) {
  const stage = stageOf(path)
  if (scene.store.index.excerpt) return { why: 'This excerpt has none.' }
  if (scene.info.imported && !(stage === 'merge-tracks' && scene.has('boxes_valid.parquet'))) return { why: 'The dataset that was imported has none.' }
  return { stage, command: `make stage STAGE=${stage} SCENES=${Number(scene.folder)}` }
}

export class StoreView {
  /** `readJson(path)` reads what the server (or the page itself) says of the store. */
  constructor(readJson, cache) {
    Object.assign(this, { readJson, cache })
  }

  async open() {
    const [names, index] = await Promise.all([this.readJson('api/names.json'), this.readJson('api/store.json')])
    Object.assign(this, { names, index })
    return this
  }

  async scene(folder) {
    const listing = await this.readJson(`api/scenes/${folder}.json`)
    const scene = new Scene(this, folder, listing)
    await scene.open()
    return scene
  }
}

/** One scene: its facts, agents and sensors, and requests for frames of them. */
export class Scene {
  constructor(store, folder, listing) {
    Object.assign(this, { store, folder, listing, cache: store.cache })
    this.files = new Map(listing.files.map(([path, bytes]) => [path, bytes]))
    this.info = listing.info
    this.about = new Map()
    /** Which of `occupancy_filled`, `occupancy` and `occupancy_cells` are there, best first. */
    this.voxelKinds = ['occupancy_filled', 'occupancy', 'occupancy_cells'].filter(kind => [...this.files.keys()].some(f => f.startsWith(`${kind}/`)))
  }

  get frames() {
    return this.info.frames
  }

  has(path) {
    return this.files.has(path)
  }

  /** The part of a request that names a file of this scene. */
  file(path) {
    if (!this.files.has(path)) throw new MissingFile(path)
    return { path: `scenes/${this.folder}/${path}`, size: this.files.get(path) }
  }

  async open() {
    this.tables = await SceneTables.read(this)
    this.agents = this.tables.agents
  }

  /** Names of the tables of an agent's sensors, without the ending. */
  sensors(agent) {
    const start = `sensors/${agent}/`
    return [...this.files.keys()].filter(f => f.startsWith(start) && f.endsWith('.parquet')).map(f => f.slice(start.length, -8))
  }

  /** What gives points: lidars, semantic lidars, radars. */
  pointSensors(agent) {
    return this.sensors(agent).filter(s => !/^(RGB|SEG|IST|DPT|FLW)-CAM|^(GNSS|IMU|visible|boxes_2d)$/.test(s) && !this.isImage(agent, s))
  }

  isImage(agent, sensor) {
    return /^(RGB|IST|DPT|FLW)-/.test(sensor) || (sensor.startsWith('SEG-') && ['RGB', 'IST', 'DPT'].some(kind => this.has(`sensors/${agent}/${kind}-${sensor.slice(4)}.parquet`)))
  }

  /** Cameras of an agent with the kinds of images that each has. */
  cameras(agent) {
    const cameras = new Map()
    for (const sensor of this.sensors(agent)) {
      if (!this.isImage(agent, sensor) || sensor.startsWith('FLW-')) continue
      const [kind, name] = [sensor.slice(0, 3), sensor.slice(4)]
      cameras.set(name, [...(cameras.get(name) ?? []), kind])
    }
    return cameras
  }

  /** What a sensor's table says of itself; asked once. `known` tells whether its points say something (`tag`, `intensity`). */
  async sensor(agent, sensor) {
    const path = `sensors/${agent}/${sensor}.parquet`
    if (!this.about.has(path)) {
      const { sensor: about, rows, columns, zeros } = await this.cache.get({ kind: 'about', ...this.file(path) })
      this.about.set(path, { ...about, rows, known: column => columns.includes(column) && !zeros.includes(column) })
    }
    return this.about.get(path)
  }

  /** The request for a frame of a sensor, with the row of the latest reading at or before it. */
  async reading(agent, sensor, frame) {
    const about = await this.sensor(agent, sensor)
    const row = Math.min(Math.floor(frame / (about.every_n_frames ?? 1)), about.rows - 1)
    return { ...this.file(`sensors/${agent}/${sensor}.parquet`), row }
  }

  /** Of the points of a frame each one, or every `stride`-th. */
  async pointsRequest(agent, sensor, frame, stride = 1) {
    return { kind: 'points', ...await this.reading(agent, sensor, frame), stride }
  }

  async imageRequest(agent, kind, camera, frame, show, width) {
    return { kind: 'image', ...await this.reading(agent, `${kind}-${camera}`, frame), show, width }
  }

  async flowRequest(agent, camera, frame, across) {
    return { kind: 'flow', ...await this.reading(agent, `FLW-${camera}`, frame), across }
  }

  async archive(path) {
    if (!this.about.has(path)) this.about.set(path, await this.cache.get({ kind: 'archive', ...this.file(path) }))
    return this.about.get(path)
  }

  async bevRequest(agent, frame, hidden) {
    const path = `bev/${agent}.npz`
    const about = await this.archive(path)
    const names = about.classes ?? this.store.names.bev.map(c => c.name)
    const colors = names.map(name => hidden.has(name) ? null : this.store.names.bev.find(c => c.name === name)?.rgb ?? [200, 200, 200])
    return { kind: 'bev', ...this.file(path), frame: frame - frame % (about.every_n_frames ?? 1), colors }
  }

  async voxelRequest(agent, kind, frame, { merge, reach, limit }) {
    const path = `${kind}/${agent}.npz`
    const about = await this.archive(path)
    const { grid, voxel_m: cell } = gridOf(about)
    return {
      kind: 'voxels', ...this.file(path), frame: frame - frame % (about.every_n_frames ?? 1), grid,
      merge: Math.max(1, Math.round(merge / cell)), reach: Math.round(reach / cell), limit,
    }
  }
}

/** The shape of a grid, its cell and its lower end, from what its archive says. */
export function gridOf(about) {
  return { grid: about.shape, voxel_m: about.voxel_m, range_m: about.range_m, lower_m: about.lower_m }
}
