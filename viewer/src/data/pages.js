// Data pages of Parquet files as typed arrays. Encodings that points do not lie in are left to hyparquet.

import { readDataPage } from 'hyparquet/src/datapage.js'
import { readPlain } from 'hyparquet/src/plain.js'
import { getMaxDefinitionLevel, getMaxRepetitionLevel } from 'hyparquet/src/schema.js'
import { joinSplit, picked, readRuns } from './encodings.js'

/** Bits of a code into a dictionary, at most. */
const MOST_BITS = 24
const SPLIT_TYPES = { FLOAT: Float32Array, INT32: Int32Array, DOUBLE: Float64Array }

/**
 * An unpacked page of `count` places that holds `held` values, of which every `stride`-th from number `first` on is in `values`
 * (`isCoded`: numbers of entries of the dictionary). Its levels are null where they say nothing: `definition` where no value is
 * missing, `repetition` where there are no lists.
 */
export function readPage(bytes, header, { type, element, schemaPath }, { first, stride }) {
  const { num_values: count, encoding } = header
  const isCoded = encoding.endsWith('_DICTIONARY')
  const Split = encoding === 'BYTE_STREAM_SPLIT' && SPLIT_TYPES[type]
  if (!isCoded && !Split && encoding !== 'PLAIN') {
    const { dataPage, definitionLevels, repetitionLevels } = readDataPage(bytes, header, { type, element, schemaPath })
    const levels = read => read.length ? Uint8Array.from(read) : null
    const values = picked(dataPage, first, stride)
    return { count, held: dataPage.length, values, isCoded, definition: levels(definitionLevels), repetition: levels(repetitionLevels) }
  }
  const [repetition, afterRepetition] = readLevels(bytes, 0, getMaxRepetitionLevel(schemaPath), count)
  const most = getMaxDefinitionLevel(schemaPath)
  const [levels, start] = readLevels(bytes, afterRepetition, most, count)
  let held = count
  if (levels) for (let i = 0; i < count; i++) if (levels[i] !== most) held--
  const body = bytes.subarray(start)
  let values
  if (Split) values = joinSplit(body, held, Split, first, stride)
  else if (isCoded) values = picked(readCodes(body, held), first, stride)
  else values = picked(plain(body, type, held, element.type_length), first, stride)
  return { count, held, values, isCoded, definition: held < count ? levels : null, repetition }
}

/** Levels of `count` places, null where there is but one, and where they end. */
function readLevels(bytes, at, most, count) {
  if (!most) return [null, at]
  const start = at + 4
  const end = start + new DataView(bytes.buffer, bytes.byteOffset + at, 4).getUint32(0, true)
  const levels = new Uint8Array(count)
  readRuns(bytes.subarray(start, end), 32 - Math.clz32(most), levels)
  return [levels, end]
}

function plain(bytes, type, count, width) {
  return readPlain({ view: new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), offset: 0 }, type, count, width)
}

function readCodes(bytes, count) {
  const bits = count ? bytes[0] : 0
  if (!(bits <= MOST_BITS)) throw new Error('a page is damaged')
  const codes = new (bits <= 8 ? Uint8Array : Uint32Array)(count)
  if (bits) readRuns(bytes.subarray(1), bits, codes)
  return codes
}
