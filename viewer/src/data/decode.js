// What workers do: one function for each kind of request, plain values and transferable buffers out.

import { idColor } from '../colors.js'
import { flowArrows, half } from './flow.js'
import { Npz } from './npz.js'
import { ParquetFile, flat, offsets } from './parquet.js'
import { spread } from './spread.js'
import { voxelFaces } from './voxels.js'

/** Footers and directories of files that were opened last. */
const OPEN_FILES = 64
/** Tags of things that move or are put up one by one: instance masks show these. */
const MASKED_TAGS = new Set([7, 8, 12, 13, 14, 15, 16, 18, 19, 30, 31])
const DEPTH_SHOWN_M = 100

export class Decoder {
  constructor(files) {
    this.files = files
    this.opened = new Map()
  }

  /** Runs a request `{kind, path, size, ...}`; gives `[result, transfer]`. */
  run(request) {
    return this[request.kind](request)
  }

  open(type, { path, size }) {
    const key = `${path} ${size}`
    let file = this.opened.get(key)
    this.opened.delete(key)
    if (!file) {
      file = type.open(this.files, path, size)
      file.catch(() => this.opened.delete(key))
    }
    this.opened.set(key, file)
    if (this.opened.size > OPEN_FILES) this.opened.delete(this.opened.keys().next().value)
    return file
  }

  /** Rows, columns, and what a sensor's table says of itself; `zeros` are columns that hold no readings. */
  async about(request) {
    const file = await this.open(ParquetFile, request)
    return [{ rows: file.rows, columns: [...file.columns.keys()], sensor: file.note('sensor'), zeros: file.note('zero_columns') ?? [] }, []]
  }

  /** What an archive of arrays says of itself. */
  async archive(request) {
    const archive = await this.open(Npz, request)
    return [{ ...archive.about(), frames: archive.members.size }, []]
  }

  /** Whole columns of a table: name to `{values, starts}`; `starts` where a row is a list. Structs are JSON texts. */
  async table(request) {
    const file = await this.open(ParquetFile, request)
    const parts = []
    for (let group = 0; group < file.groups.length; group++) parts.push(await file.readGroup(group, request.columns.flatMap(name => [name, ...file.fieldsOf(name)])))
    const columns = {}
    for (const name of request.columns) {
      const fields = file.fieldsOf(name)
      if (fields.length) {
        columns[name] = concatenated(parts.map((part, i) => ({ values: structTexts(name, fields, part, Number(file.groups[i].num_rows)) })))
      }
      if (!file.columns.has(name)) continue
      const isList = file.columns.get(name).length > 2
      const groups = parts.map((part, i) => {
        const rows = Number(file.groups[i].num_rows)
        const column = part[name]
        if (!isList) return { values: flat(column, rows) }
        const starts = offsets(column, rows)
        return { starts, values: flat({ ...column, definition: null }, column.values.length) }
      })
      columns[name] = groups.length === 1 ? groups[0] : concatenated(groups)
    }
    const transfer = Object.values(columns).flatMap(c => [c.values, c.starts]).filter(ArrayBuffer.isView).map(a => a.buffer)
    return [{ rows: file.rows, columns, sensor: file.note('sensor') }, [...new Set(transfer)]]
  }

  /**
   * One reading of a lidar or radar, its points in the order of `spread`: `position` (x, y, z in the sensor's frame, m), `facts`
   * (intensity, tag, id low, id high), a radar's `speed` (m/s). With a `stride` it is each so-manieth point alone; `total` counts all.
   */
  async points(request) {
    const file = await this.open(ParquetFile, request)
    const isRadar = file.columns.has('depth')
    const { group, row } = file.locate(request.row)
    const rows = Number(file.groups[group].num_rows)
    const wanted = isRadar ? ['depth', 'altitude', 'azimuth', 'velocity', 'id', 'tag'] : ['x', 'y', 'z', 'intensity', 'id', 'tag']
    const columns = await file.readGroup(group, wanted, rows === 1 ? request.stride : 1)
    const { values, held } = columns[wanted[0]]
    const [from, to] = rows === 1 ? [0, values.length] : offsets(columns[wanted[0]], rows).subarray(row, row + 2)
    const total = rows === 1 ? held : to - from
    const count = to - from
    const position = new Float32Array(3 * count)
    const facts = new Uint8Array(4 * count)
    const order = spread(count)
    const take = name => columns[name]?.values.subarray(from, to)
    if (isRadar) {
      const [depth, altitude, azimuth] = ['depth', 'altitude', 'azimuth'].map(take)
      for (let i = 0; i < count; i++) {
        const at = order[i]
        const across = depth[at] * Math.cos(altitude[at])
        position[3 * i] = across * Math.cos(azimuth[at])
        position[3 * i + 1] = across * Math.sin(azimuth[at])
        position[3 * i + 2] = depth[at] * Math.sin(altitude[at])
      }
    } else {
      const [x, y, z] = ['x', 'y', 'z'].map(take)
      for (let i = 0; i < count; i++) {
        const at = order[i]
        position[3 * i] = x[at]
        position[3 * i + 1] = y[at]
        position[3 * i + 2] = z[at]
      }
    }
    const [intensity, id, tag] = ['intensity', 'id', 'tag'].map(take)
    let tags = 0
    for (let i = 0; i < count; i++) {
      const at = order[i]
      facts[4 * i] = intensity ? 255 * intensity[at] : 255
      if (tag) {
        facts[4 * i + 1] = tag[at]
        tags |= 1 << tag[at]
      }
      if (id) {
        facts[4 * i + 2] = id[at] & 255
        facts[4 * i + 3] = id[at] >> 8
      }
    }
    // A copy: what lies in the page of the file is not handed over.
    const velocity = isRadar ? take('velocity') ?? [] : null
    const speed = velocity && Float32Array.from(velocity, (_, i) => velocity[order[i]])
    const transfer = [position.buffer, facts.buffer, ...speed ? [speed.buffer] : []]
    return [{ count, total, position, facts, speed, tags: tags >>> 0, bytes: (speed ? 20 : 16) * count }, transfer]
  }

  /** One picture: as it is, or what `show` makes of it (`mask`: things by id, transparent elsewhere; `instance`, `depth`). */
  async image(request) {
    const file = await this.open(ParquetFile, request)
    const { group, row } = file.locate(request.row)
    const { values, dictionary } = (await file.readGroup(group, ['image'])).image
    const bytes = dictionary ? dictionary[values[row]] : values[row]
    // Without conversions: in all but RGB the numbers count.
    const exact = { colorSpaceConversion: 'none', premultiplyAlpha: 'none' }
    let picture = await createImageBitmap(new Blob([bytes]), request.show === 'plain' ? {} : exact)
    const [width, height] = [picture.width, picture.height]
    if (request.show !== 'plain') picture = await recolored(picture, request.show)
    if (request.width && request.width < width) {
      const small = await createImageBitmap(picture, { resizeWidth: request.width, resizeHeight: Math.round(request.width * height / width), resizeQuality: 'medium' })
      picture.close()
      picture = small
    }
    return [{ picture, width, height, bytes: 4 * picture.width * picture.height }, [picture]]
  }

  /** Optical flow as arrows, see `flowArrows`: about `across` of them beside one another. */
  async flow(request) {
    const file = await this.open(ParquetFile, request)
    const { group, row } = file.locate(request.row)
    const columns = await file.readGroup(group, ['width', 'height', 'dx', 'dy'])
    const rows = Number(file.groups[group].num_rows)
    const [width, height] = [flat(columns.width, rows)[row], flat(columns.height, rows)[row]]
    const [dx, dy] = [columns.dx, columns.dy].map(column => {
      const starts = offsets(column, rows)
      const [from, to] = [starts[row], starts[row + 1]]
      // 16-bit floats lie there as bytes, most of them by their number in a dictionary.
      if (!column.dictionary && !Array.isArray(column.values)) return column.values.subarray(from, to)
      const bytes = i => column.dictionary ? column.dictionary[column.values[i]] : column.values[i]
      return Float32Array.from({ length: to - from }, (_, i) => half(bytes(from + i)))
    })
    const arrows = flowArrows({ dx, dy, width, height, cell: Math.max(4, Math.round(width / request.across)) })
    return [{ arrows, bytes: arrows.byteLength }, [arrows.buffer]]
  }

  /** A frame's BEV masks as one picture: later channels over earlier ones, hidden ones left out. */
  async bev(request) {
    const archive = await this.open(Npz, request)
    const { shape: [channels, rows, columns], data } = await archive.read(request.frame)
    const out = new ImageData(columns, rows)
    const cells = rows * columns
    let present = 0
    for (let channel = 0; channel < channels; channel++) {
      const color = request.colors[channel]
      let any = false
      for (let cell = 0, at = channel * cells; cell < cells; cell++, at++) {
        if (!data[at]) continue
        any = true
        if (!color) continue
        out.data.set(color, 4 * cell)
        out.data[4 * cell + 3] = 255
      }
      if (any) present |= 1 << channel
    }
    const picture = await createImageBitmap(out)
    return [{ picture, rows, columns, present, bytes: 4 * cells }, [picture]]
  }

  /** The outside faces of a frame's voxels: see `voxelFaces`. */
  async voxels(request) {
    const archive = await this.open(Npz, request)
    const faces = await voxelFaces(archive, request)
    return [{ ...faces, bytes: faces.cells.byteLength }, [faces.cells.buffer]]
  }
}

/** Structs as the JSON texts that tables of format 1 have in their place: fields without a value are left out. */
function structTexts(name, fields, part, rows) {
  const objects = Array.from({ length: rows }, () => ({}))
  for (const field of fields) {
    const values = flat(part[field], rows)
    const key = field.slice(name.length + 1)
    for (let row = 0; row < rows; row++) {
      const value = values[row]
      if (value === null || Number.isNaN(value)) continue
      if (key === 'other') Object.assign(objects[row], JSON.parse(value))
      else objects[row][key] = part[field].isFlag ? value === 1 : value
    }
  }
  return objects.map(object => JSON.stringify(object))
}

function concatenated(groups) {
  const length = groups.reduce((sum, g) => sum + g.values.length, 0)
  const plain = groups.some(g => Array.isArray(g.values))
  const values = plain ? new Array(length) : new groups[0].values.constructor(length)
  const starts = groups[0].starts ? new Uint32Array(groups.reduce((sum, g) => sum + g.starts.length - 1, 1)) : undefined
  let [at, row] = [0, 0]
  for (const group of groups) {
    for (let i = 0; i < group.values.length; i++) values[at + i] = group.values[i]
    if (starts) for (const start of group.starts.subarray(0, -1)) starts[row++] = at + start
    at += group.values.length
  }
  if (starts) starts[row] = at
  return { values, starts }
}

async function recolored(picture, show) {
  const canvas = new OffscreenCanvas(picture.width, picture.height)
  const context = canvas.getContext('2d', { willReadFrequently: true })
  context.drawImage(picture, 0, 0)
  picture.close()
  const image = context.getImageData(0, 0, canvas.width, canvas.height)
  const pixels = new Uint32Array(image.data.buffer)
  const paint = show === 'depth' ? depthPaint() : idPaint(show === 'mask')
  let [last, color] = [-1, 0]
  for (let i = 0; i < pixels.length; i++) {
    const rgb = pixels[i] & 0xffffff
    if (rgb !== last) color = paint(last = rgb)
    pixels[i] = color
  }
  context.putImageData(image, 0, 0)
  return canvas.transferToImageBitmap()
}

/** Instance images: red the tag, green and blue the id. */
function idPaint(onlyThings) {
  const seen = new Map()
  return rgb => {
    let color = seen.get(rgb)
    if (color === undefined) {
      const [tag, id] = [rgb & 255, rgb >> 8]
      if (onlyThings && !MASKED_TAGS.has(tag)) color = 0
      else {
        const [r, g, b] = id ? idColor(id) : [96, 96, 96]
        color = ((onlyThings ? 125 : 255) << 24 | b << 16 | g << 8 | r) >>> 0
      }
      seen.set(rgb, color)
    }
    return color
  }
}

/** Depth images: 24 bits, red lowest, 1000 m at the greatest. Near is bright, on a logarithmic scale. */
function depthPaint() {
  return rgb => {
    const depth = rgb / 0xffffff * 1000
    const shade = Math.max(0, Math.min(255, Math.round(255 * (1 - Math.log(Math.max(depth, 1)) / Math.log(DEPTH_SHOWN_M)))))
    return (0xff000000 | shade << 16 | shade << 8 | shade) >>> 0
  }
}
