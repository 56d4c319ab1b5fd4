// Columns of Parquet files as typed arrays. hyparquet parses footers and pages; lists are not assembled into nested plain
// arrays, as its own reader does: values stay as they lie in the pages, which is an order of magnitude faster.

import { parquetMetadata } from 'hyparquet'
import { parquetHeader } from 'hyparquet/src/column.js'
import { decompressPage } from 'hyparquet/src/datapage.js'
import { readPlain } from 'hyparquet/src/plain.js'
import { getMaxDefinitionLevel, getSchemaPath } from 'hyparquet/src/schema.js'
import { ZSTDDecoder } from 'three/addons/libs/zstddec.module.js'
import { readPage } from './pages.js'

const TAIL_BYTES = 1 << 16
/** Columns nearer to one another than this are fetched together, bytes. */
const GAP_BYTES = 1 << 15
const zstd = new ZSTDDecoder()
const compressors = { ZSTD: unpacked }
const text = new TextDecoder()

export class ParquetFile {
  static async open(files, path, size) {
    await zstd.init()
    let tail = await files.read(path, Math.max(0, size - TAIL_BYTES), size)
    if (tail.length < 12) throw new Error(`${path}: no Parquet file`)
    const footer = new DataView(tail.buffer, tail.byteOffset).getUint32(tail.length - 8, true) + 8
    if (footer > size) throw new Error(`${path}: its footer is damaged`)
    if (footer > tail.length) tail = await files.read(path, size - footer, size)
    return new ParquetFile(files, path, parquetMetadata(tail, { geoparquet: false }))
  }

  constructor(files, path, metadata) {
    Object.assign(this, { files, path, metadata })
    this.groups = metadata.row_groups
    this.rows = Number(metadata.num_rows)
    this.columns = new Map()
    this.places = new Map()
    for (const [place, chunk] of (this.groups[0]?.columns ?? []).entries()) {
      const schemaPath = getSchemaPath(metadata.schema, chunk.meta_data.path_in_schema)
      // A list is named by its root, a field of a struct by its path.
      const { name, converted_type: kind } = schemaPath[1].element
      const full = schemaPath.length > 2 && kind !== 'LIST' ? chunk.meta_data.path_in_schema.join('.') : name
      this.columns.set(full, schemaPath)
      this.places.set(full, place)
    }
  }

  /** Names of the columns that make up a struct. */
  fieldsOf(name) {
    return [...this.columns.keys()].filter(column => column.startsWith(`${name}.`))
  }

  /** JSON texts of the file's metadata. */
  note(key) {
    const found = this.metadata.key_value_metadata?.find(entry => entry.key === key)
    return found?.value ? JSON.parse(found.value) : null
  }

  /** The row group that holds a row, and the row's place in it. */
  locate(row) {
    for (let group = 0; group < this.groups.length; group++) {
      const rows = Number(this.groups[group].num_rows)
      if (row < rows) return { group, row }
      row -= rows
    }
    throw new Error(`${this.path} has no row ${row}`)
  }

  /**
   * Columns of one row group: name to `{values, held, dictionary, definition, repetition, levels}`. Those that are not there are left
   * out. Of the `held` values of a column `values` has every `stride`-th.
   */
  async readGroup(group, names, stride = 1) {
    const chunks = names.filter(name => this.columns.has(name)).map(name => {
      const meta = this.groups[group].columns[this.places.get(name)].meta_data
      const start = Number(meta.dictionary_page_offset ?? meta.data_page_offset)
      return { name, meta, start, end: start + Number(meta.total_compressed_size) }
    })
    chunks.sort((a, b) => a.start - b.start)
    const spans = []
    for (const chunk of chunks) {
      const last = spans.at(-1)
      if (last && chunk.start - last.end < GAP_BYTES) last.end = Math.max(last.end, chunk.end)
      else spans.push({ start: chunk.start, end: chunk.end })
    }
    await Promise.all(spans.map(async span => {
      span.bytes = await this.files.read(this.path, span.start, span.end)
    }))
    const columns = {}
    for (const { name, meta, start, end } of chunks) {
      const span = spans.find(s => s.start <= start && end <= s.end)
      columns[name] = this.decode(name, meta, span.bytes.subarray(start - span.start, end - span.start), stride)
    }
    return columns
  }

  decode(name, meta, bytes, stride) {
    const schemaPath = this.columns.get(name)
    const { element } = schemaPath.at(-1)
    const decoder = { type: meta.type, element, schemaPath, codec: meta.codec, compressors }
    const reader = { view: new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), offset: 0 }
    const pages = []
    let dictionary = null
    let held = 0
    while (reader.offset < bytes.length - 1) {
      const header = parquetHeader(reader)
      const body = bytes.subarray(reader.offset, reader.offset + header.compressed_page_size)
      reader.offset += header.compressed_page_size
      if (header.type === 'DICTIONARY_PAGE') {
        const page = decompressPage(body, header.uncompressed_page_size, meta.codec, compressors)
        const at = { view: new DataView(page.buffer, page.byteOffset, page.byteLength), offset: 0 }
        dictionary = readPlain(at, meta.type, header.dictionary_page_header.num_values, element.type_length)
      } else if (header.type === 'DATA_PAGE') {
        const page = decompressPage(body, header.uncompressed_page_size, meta.codec, compressors)
        const first = (stride - held % stride) % stride
        pages.push(readPage(page, header.data_page_header, decoder, { first, stride }))
        held += pages.at(-1).held
      } else {
        throw new Error(`${this.path}: column ${name} has pages of kind ${header.type}`)
      }
    }
    return { held, ...joined(pages, dictionary, meta.type, getMaxDefinitionLevel(schemaPath)) }
  }
}

function unpacked(bytes, size) {
  const page = zstd.decode(bytes, size)
  // It says nothing of what is damaged.
  if (page.length !== size) throw new Error('a compressed page is damaged')
  return page
}

/** Pages of a column as one: numbers in a typed array, texts as codes into a dictionary, other bytes in a plain array. */
function joined(pages, dictionary, type, levels) {
  const length = pages.reduce((sum, page) => sum + page.values.length, 0)
  const isBytes = type === 'BYTE_ARRAY' || type === 'FIXED_LEN_BYTE_ARRAY'
  let values
  if (isBytes && dictionary && pages.every(page => page.isCoded)) {
    values = new Uint32Array(length)
  } else if (isBytes) {
    values = new Array(length)
  } else {
    values = new { FLOAT: Float32Array, DOUBLE: Float64Array, BOOLEAN: Uint8Array, INT32: Int32Array, INT64: Float64Array }[type](length)
  }
  let at = 0
  for (const page of pages) {
    if (isBytes && !(values instanceof Uint32Array)) {
      for (const value of page.values) values[at++] = page.isCoded ? dictionary[value] : value
    } else {
      const part = page.values
      if (type === 'INT64') for (const value of part) values[at++] = Number(page.isCoded ? dictionary[value] : value)
      else if (page.isCoded && !isBytes) decodeInto(values, at, part, dictionary), at += part.length
      else values.set(part, at), at += part.length
    }
  }
  const collect = key => {
    if (pages.every(page => !page[key])) return null
    const all = new Uint8Array(pages.reduce((sum, page) => sum + page.count, 0))
    let to = 0
    for (const page of pages) {
      if (page[key]) all.set(page[key], to)
      else all.fill(levels, to, to + page.count)
      to += page.count
    }
    return all
  }
  return { values, dictionary: values instanceof Uint32Array ? dictionary : null, definition: collect('definition'), repetition: collect('repetition'), levels, isFlag: type === 'BOOLEAN' }
}

function decodeInto(values, at, codes, dictionary) {
  for (let i = 0; i < codes.length; i++) values[at + i] = dictionary[codes[i]]
}

/** Values of a flat column with a place for each row; nulls as the given value (texts: null). */
export function flat(column, rows, empty = NaN) {
  const strings = column.dictionary ? column.dictionary.map(bytes => text.decode(bytes)) : null
  const get = strings ? i => strings[column.values[i]]
    : Array.isArray(column.values) ? i => text.decode(column.values[i]) : null
  if (!column.definition && !get) return column.values
  const out = get ? new Array(rows).fill(null) : new Float64Array(rows).fill(empty)
  let at = 0
  for (let row = 0; row < rows; row++) {
    if (column.definition && column.definition[row] !== column.levels) continue
    out[row] = get ? get(at) : column.values[at]
    at++
  }
  return out
}

/** Where the list of each row begins among the values, and where the last one ends. */
export function offsets(column, rows) {
  const starts = new Uint32Array(rows + 1)
  if (!column.repetition) {
    starts[rows] = column.values.length
    if (rows !== 1) for (let row = 0; row <= rows; row++) starts[row] = row
    return starts
  }
  let row = -1
  let value = 0
  for (let i = 0; i < column.repetition.length; i++) {
    if (column.repetition[i] === 0) starts[++row] = value
    if (!column.definition || column.definition[i] === column.levels) value++
  }
  starts[rows] = value
  return starts
}
