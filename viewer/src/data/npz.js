// Members of numpy archives: the directory by a range at the end, each member by a range of its own, inflated as a stream.

const TAIL_BYTES = 1 << 17
const END = 0x06054b50
const END_64 = 0x06064b50
const END_64_LOCATOR = 0x07064b50
const ENTRY = 0x02014b50
const LOCAL = 0x04034b50
const DEFLATED = 8
const text = new TextDecoder()

export class Npz {
  static async open(files, path, size) {
    const from = Math.max(0, size - TAIL_BYTES)
    const tail = await files.read(path, from, size)
    const view = new DataView(tail.buffer, tail.byteOffset, tail.byteLength)
    let end = tail.length - 22
    while (end >= 0 && !(view.getUint32(end, true) === END && end + 22 + view.getUint16(end + 20, true) === tail.length)) end--
    if (end < 0) throw new Error(`${path}: no zip archive`)
    const comment = text.decode(tail.subarray(end + 22))
    let entries = view.getUint16(end + 10, true)
    let length = view.getUint32(end + 12, true)
    let start = view.getUint32(end + 16, true)
    const locator = end - 20
    if (locator >= 0 && view.getUint32(locator, true) === END_64_LOCATOR) {
      const at = Number(view.getBigUint64(locator + 8, true)) - from
      if (at < 0 || view.getUint32(at, true) !== END_64) throw new Error(`${path}: its directory is damaged`)
      entries = Number(view.getBigUint64(at + 32, true))
      length = Number(view.getBigUint64(at + 40, true))
      start = Number(view.getBigUint64(at + 48, true))
    }
    if (start + length > size) throw new Error(`${path}: its directory is damaged`)
    const directory = start >= from ? tail.subarray(start - from, start - from + length) : await files.read(path, start, start + length)
    return new Npz(files, path, size, directoryOf(directory, entries, path), comment)
  }

  constructor(files, path, size, members, comment) {
    Object.assign(this, { files, path, size, members, comment })
  }

  /** What the archive says of itself. */
  about() {
    return this.comment ? JSON.parse(this.comment) : {}
  }

  has(frame) {
    return this.members.has(memberName(frame))
  }

  /** `{shape, type, bytes, reader}` of a frame's array: `pieces(bytes, reader)` are the bytes of its values. */
  async open(frame) {
    const name = memberName(frame)
    const member = this.members.get(name)
    if (!member) throw new Error(`${this.path} has no frame ${frame}`)
    const head = await this.files.read(this.path, member.offset, member.offset + 30)
    const view = new DataView(head.buffer, head.byteOffset, head.byteLength)
    if (view.getUint32(0, true) !== LOCAL) throw new Error(`${this.path}: ${name} is damaged`)
    const start = member.offset + 30 + view.getUint16(26, true) + view.getUint16(28, true)
    const packed = await this.files.read(this.path, start, start + member.packed)
    let stream = new Blob([packed]).stream()
    if (member.method === DEFLATED) stream = stream.pipeThrough(new DecompressionStream('deflate-raw'))
    else if (member.method !== 0) throw new Error(`${this.path}: ${name} is packed in a way unknown here`)
    return arrayOf(stream, `${this.path}: ${name}`)
  }

  /** The values of a frame's array as bytes. */
  async read(frame) {
    const { shape, type, bytes, reader } = await this.open(frame)
    const width = Number(type.slice(2))
    const all = new Uint8Array(shape.reduce((a, b) => a * b, 1) * width)
    let at = 0
    for await (const part of pieces(bytes, reader)) {
      all.set(part.subarray(0, all.length - at), at)
      at += part.length
    }
    if (at < all.length) throw new Error(`${this.path}: frame ${frame} is cut off`)
    return { shape, type, data: all }
  }
}

const memberName = frame => `${String(frame).padStart(4, '0')}.npy`

function directoryOf(bytes, entries, path) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  const members = new Map()
  let at = 0
  for (let entry = 0; entry < entries; entry++) {
    if (at + 46 > bytes.length || view.getUint32(at, true) !== ENTRY) throw new Error(`${path}: its directory is damaged`)
    const [names, extra, remark] = [28, 30, 32].map(o => view.getUint16(at + o, true))
    const name = text.decode(bytes.subarray(at + 46, at + 46 + names))
    let packed = view.getUint32(at + 20, true)
    let size = view.getUint32(at + 24, true)
    let offset = view.getUint32(at + 42, true)
    for (let field = at + 46 + names; field + 4 <= at + 46 + names + extra; field += 4 + view.getUint16(field + 2, true)) {
      if (view.getUint16(field, true) !== 1) continue
      let value = field + 4
      const next = () => Number(view.getBigUint64((value += 8) - 8, true))
      if (size === 0xffffffff) size = next()
      if (packed === 0xffffffff) packed = next()
      if (offset === 0xffffffff) offset = next()
    }
    members.set(name, { packed, offset, method: view.getUint16(at + 10, true) })
    at += 46 + names + extra + remark
  }
  return members
}

/** The header of a `.npy` and what of the values came with it. */
async function arrayOf(stream, place) {
  const reader = stream.getReader()
  let head = new Uint8Array(0)
  const need = async length => {
    while (head.length < length) {
      const { done, value } = await reader.read()
      if (done) throw new Error(`${place} is cut off`)
      const longer = new Uint8Array(head.length + value.length)
      longer.set(head)
      longer.set(value, head.length)
      head = longer
    }
  }
  await need(12)
  const view = new DataView(head.buffer)
  const wide = head[6] > 1
  const length = wide ? view.getUint32(8, true) : view.getUint16(8, true)
  const start = (wide ? 12 : 10) + length
  await need(start)
  const header = text.decode(head.subarray(wide ? 12 : 10, start))
  const type = /'descr':\s*'([^']+)'/.exec(header)?.[1]
  const shape = /'shape':\s*\(([^)]*)\)/.exec(header)?.[1].split(',').filter(s => s.trim()).map(Number)
  if (!type || !shape || /'fortran_order':\s*True/.test(header)) throw new Error(`${place}: no array in C order`)
  return { type, shape, bytes: head.subarray(start), reader }
}

/** The rest of the values, piece by piece. */
export async function* pieces(bytes, reader) {
  if (bytes.length) yield bytes
  for (;;) {
    const { done, value } = await reader.read()
    if (done) return
    yield value
  }
}
