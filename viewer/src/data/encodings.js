// How numbers lie in the pages of Parquet files.

/** Fills `out` from runs of one number, and of numbers of `bits` bits each (Parquet's hybrid of both). */
export function readRuns(bytes, bits, out) {
  const mask = (1 << bits) - 1
  let [at, seen] = [0, 0]
  while (seen < out.length) {
    let [header, shift] = [0, 0]
    do {
      header |= (bytes[at] & 127) << shift
      shift += 7
    } while (bytes[at++] & 128)
    // Twice the length of a run, or twice the groups of eight packed numbers and one.
    const length = header >>> 1
    if (header & 1) {
      const start = at
      const last = Math.min(out.length, seen + 8 * length)
      let [waiting, held] = [0, 0]
      for (; seen < last; seen++) {
        while (held < bits) {
          waiting |= bytes[at++] << held
          held += 8
        }
        out[seen] = waiting & mask
        waiting >>>= bits
        held -= bits
      }
      // The bytes of the last group may be cut short.
      if (seen < out.length) at = start + bits * length
    } else {
      let value = 0
      for (let byte = 0; byte < bits; byte += 8) value |= bytes[at++] << byte
      out.fill(value, seen, seen + length)
      seen += length
    }
    if (!length || at > bytes.length) throw new Error('the runs of a page are damaged')
  }
}

/**
 * Numbers of which first all lowest bytes lie there, then all second ones, and so on, in the order of the type of the array (four or
 * eight bytes each): of `count` every `stride`-th one from number `first` on.
 */
export function joinSplit(bytes, count, Type, first = 0, stride = 1) {
  const words = Type.BYTES_PER_ELEMENT / 4
  if (bytes.length < 4 * words * count) throw new Error('a page is too short')
  const out = new Uint32Array(words * countPicked(count, first, stride))
  for (let word = 0; word < words; word++) {
    const [a, b, c, d] = [0, 1, 2, 3].map(byte => bytes.subarray((4 * word + byte) * count, (4 * word + byte + 1) * count))
    for (let i = first, to = word; i < count; i += stride, to += words) out[to] = a[i] | b[i] << 8 | c[i] << 16 | d[i] << 24
  }
  return new Type(out.buffer)
}

/** Every `stride`-th of some values from number `first` on. */
export function picked(values, first, stride) {
  if (stride === 1 && !first) return values
  const out = new values.constructor(countPicked(values.length, first, stride))
  for (let i = first, to = 0; i < values.length; i += stride) out[to++] = values[i]
  return out
}

function countPicked(count, first, stride) {
  return Math.max(0, Math.ceil((count - first) / stride))
}
