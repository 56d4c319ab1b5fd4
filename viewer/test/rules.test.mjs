// Rules that need no browser: who hears and sees what, what predictions found, which boxes filters leave.
//
//     node --test test/rules.test.mjs

import assert from 'node:assert/strict'
import test from 'node:test'
import { partnersOf, sightOf } from '../src/data/cooperation.js'
import { ScenePredictions, resultsOf, tally } from '../src/data/predictions.js'
import { joinSplit, picked, readRuns } from '../src/data/encodings.js'
import { flowArrows, half } from '../src/data/flow.js'
import { sightings } from '../src/data/sightings.js'
import { spread } from '../src/data/spread.js'
import { filtered } from '../src/filters.js'
import { pieces } from '../src/plots.js'
import { shareFor, strideFor } from '../src/view/detail.js'

const places = new Map([['vehicle_0', [0, 0, 0]], ['vehicle_1', [80, 0, 0]], ['vehicle_2', [80, 0, 0.1]], ['rsu_0', [10, 0, 4.8]], ['rsu_1', [10, 0, 5]]])
const limits = { range: 80, elevation: 4.8 }

test('partners are near, at about the same height, and of the mode', () => {
  const heard = partners => partnersOf('vehicle_0', places, { ...limits, partners }).filter(p => p.isHeard).map(p => p.name)
  assert.deepEqual(heard('none'), [])
  assert.deepEqual(heard('x2v'), ['vehicle_1'])
  assert.deepEqual(heard('x2i'), ['rsu_0'])
  assert.deepEqual(heard('x2x'), ['vehicle_1', 'rsu_0'])
  const reach = partnersOf('vehicle_0', places, { ...limits, partners: 'none' }).filter(p => p.isInReach).map(p => p.name)
  assert.deepEqual(reach, ['vehicle_1', 'rsu_0'])
})

test('the ego comes first among those who see', () => {
  const partners = partnersOf('vehicle_0', places, { ...limits, partners: 'x2v' })
  const sight = (...seenBy) => sightOf({ seenBy }, 'vehicle_0', partners)
  assert.equal(sight('vehicle_0', 'vehicle_1'), 'ego')
  assert.equal(sight('vehicle_1', 'rsu_0'), 'partners')
  assert.equal(sight('rsu_0', 'vehicle_2'), 'nobody')
  assert.equal(sight(), 'nobody')
})

test('events are first sights, but those of the first frame', () => {
  const seen = [
    [{ id: 1, seenBy: ['vehicle_1'] }, { id: 2, seenBy: ['vehicle_0'] }],
    [{ id: 1, seenBy: ['vehicle_1'] }, { id: 3, seenBy: ['vehicle_1'] }, { id: 4, seenBy: ['vehicle_2'] }],
    [{ id: 1, seenBy: ['vehicle_0', 'vehicle_1'] }, { id: 2, seenBy: ['vehicle_1'] }, { id: 5, seenBy: ['vehicle_0'] }],
  ]
  const tables = { boxRows: new Map(seen.map((_, frame) => [frame, []])), placesAt: () => places, seenAt: frame => seen[frame] }
  assert.deepEqual(sightings(tables, 'vehicle_0', { ...limits, partners: 'x2x' }), [
    { frame: 1, kind: 'partners', ids: [3] }, { frame: 2, kind: 'ego', ids: [1] },
  ])
})

/** Two cars and a pedestrian; one car is found within 2 m by the surer prediction, the other within 4 m. */
const told = {
  every_n_frames: 1,
  samples: [
    {
      frame: 0, agent: 'vehicle_0', mode: 'x2x', targets: [7, 9, 3], target_classes: [0, 0, 1], classes: [0, 0, 1], scores: [0.9, 0.4, 0.6],
      centers_m: [[100, 0, 0], [110, 0, 0], [130, 0, 0]], sizes_m: [[4, 2, 1], [4, 2, 1], [1, 1, 2]], yaws_rad: [0, 0, 0],
      found: [[7, 7, 7, 7], [0, 0, 0, 9], [0, 0, 0, 0]],
    },
    { frame: 1, agent: 'vehicle_0', mode: 'x2x', targets: [7], target_classes: [0], classes: [], scores: [], centers_m: [], sizes_m: [], yaws_rad: [], found: [] },
  ],
}
const predictions = new ScenePredictions(told, [100, 0, 0], ['car', 'pedestrian'])

test('what was found follows from score and threshold', () => {
  const sample = predictions.at(0, 'vehicle_0', 'x2x')
  assert.deepEqual(sample.boxes[1].center, [10, 0, 0])
  const all = rule => tally([sample], rule).all
  assert.deepEqual(all({ score: 0, threshold: 2 }), { found: 1, missed: 2, false: 2 })
  assert.deepEqual(all({ score: 0, threshold: 3 }), { found: 2, missed: 1, false: 1 })
  assert.deepEqual(all({ score: 0.5, threshold: 3 }), { found: 1, missed: 2, false: 1 })
  assert.deepEqual(all({ score: 0.95, threshold: 3 }), { found: 0, missed: 3, false: 0 })
  const { targets, predictions: boxes } = resultsOf(sample, { score: 0, threshold: 2 })
  assert.deepEqual([...targets], [[7, 'found'], [9, 'missed'], [3, 'missed']])
  assert.deepEqual(boxes.map(b => b.result), ['right', 'false', 'false'])
  assert.deepEqual(tally([sample], { score: 0, threshold: 2 }).byClass.get('pedestrian'), { found: 0, missed: 1, false: 1 })
})

test('the worst frames come first, and the best score is that of the best F1', () => {
  const worst = predictions.worst('x2x', { score: 0, threshold: 2 }, 5)
  assert.deepEqual(worst.map(w => [w.sample.frame, w.missed, w.false]), [[0, 2, 2], [1, 1, 0]])
  assert.deepEqual(predictions.worst('none', { score: 0, threshold: 2 }, 5), [])
  // One of four right from 0.9 on: F1 = 2/5. With all three and 4 m: 4/7.
  assert.equal(predictions.bestScore('x2x', 2), 0.9)
  assert.equal(predictions.bestScore('x2x', 3), 0.4)
  assert.equal(predictions.at(5, 'vehicle_0', 'x2x'), undefined)
})

test('filters leave the chosen one', () => {
  const box = { id: 1, class: 'car', center: [30, 40, 0], lidarPoints: 3, radarPoints: 1, difficulty: 'hard', isValid: false }
  const choices = { hidden: new Set(), valid: false, ask: 'scene', within: '', points: 0, levels: new Set(['hard']) }
  const passes = (change, always = []) => filtered([box], { ...choices, ...change }, { here: [0, 0], always: new Set(always) }).length === 1
  assert.ok(passes({}))
  assert.ok(!passes({ hidden: new Set(['car']) }))
  assert.ok(passes({ within: '50' }) && !passes({ within: '25' }) && passes({ within: '25' }, [1]))
  assert.ok(passes({ points: 4 }) && !passes({ points: 5 }))
  assert.ok(!passes({ levels: new Set(['easy']) }))
  const isLeft = share => filtered([box], { ...choices, occluded: '0.5' }, { here: [0, 0], always: new Set(), occlusionOf: () => share }).length === 1
  assert.ok(isLeft(0.5) && !isLeft(0.6) && !isLeft(undefined))
  // Only where a question wants to know what nobody saw.
  assert.ok(!passes({ valid: true }) && passes({ valid: true, ask: 'partners' }))
})

test('each front part of a reading is spread over all of it', () => {
  for (const count of [0, 1, 31, 32, 1000, 65_537]) {
    const order = spread(count)
    assert.deepEqual([...order].sort((a, b) => a - b), Array.from({ length: count }, (_, i) => i))
    for (const part of [1 / 16, 1 / 8, 1 / 4, 1 / 2]) {
      const front = [...order.subarray(0, Math.ceil(part * count))].sort((a, b) => a - b)
      const gaps = front.slice(1).map((v, i) => v - front[i])
      assert.ok(gaps.every(gap => gap <= 2 / part), `${count}, ${part}: a gap of ${Math.max(...gaps)}`)
    }
  }
})

test('as many points are drawn as there is time for', () => {
  assert.equal(shareFor(1, 20), 1)
  assert.equal(shareFor(1, 80), 1)
  assert.equal(shareFor(1, 320), 0.25)
  assert.equal(shareFor(1, 1e6), 1 / 32)
  // Times vary: more points come in steps of a quarter.
  assert.equal(shareFor(0.25, 10), 0.3125)
  assert.equal(shareFor(0.9, 10), 1)
})

test('a plot is broken where an object is in no list', () => {
  const at = frames => frames.map(frame => ({ frame }))
  assert.deepEqual(pieces(at([0, 2, 4, 8, 10]), 2).map(line => line.map(p => p.frame)), [[0, 2, 4], [8, 10]])
  assert.deepEqual(pieces([], 1), [])
})

test('16-bit floats are read as IEEE 754 says', () => {
  for (const [bytes, value] of [[[0, 0x3c], 1], [[0, 0xc0], -2], [[0xff, 0x7b], 65504], [[1, 0], 2 ** -24], [[0x55, 0x35], 0.333251953125], [[0, 0x7c], Infinity]]) {
    assert.equal(half(bytes), value)
  }
  assert.ok(Number.isNaN(half([1, 0x7c])))
})

test('arrows of flow are means of cells, in pixels, down positive', () => {
  // What turns about a place (3, 2) by a small angle moves across its radius.
  const [width, height, cell] = [16, 8, 4]
  const dx = Float32Array.from({ length: width * height }, (_, i) => ((Math.floor(i / width) + 0.5) - 2) * 2 / width)
  const dy = Float32Array.from({ length: width * height }, (_, i) => ((i % width + 0.5) - 3) * 2 / height)
  const arrows = flowArrows({ dx, dy, width, height, cell })
  assert.equal(arrows.length, 4 * 4 * 2)
  for (let i = 0; i < arrows.length; i += 4) {
    const [u, v, du, dv] = arrows.subarray(i, i + 4)
    assert.ok(Math.abs(du - (v - 2)) < 1e-5 && Math.abs(dv + (u - 3)) < 1e-5, `${[u, v, du, dv]}`)
  }
})

/** Numbers as runs of Parquet's hybrid encoding: as `[count, value]`, or packed eight by eight. */
function asRuns(parts, bits) {
  const bytes = []
  const header = n => {
    for (; n > 127; n >>>= 7) bytes.push(n & 127 | 128)
    bytes.push(n)
  }
  for (const part of parts) {
    if (!part.packed) {
      header(2 * part.count)
      for (let shift = 0; shift < bits; shift += 8) bytes.push(part.value >>> shift & 255)
      continue
    }
    header(2 * part.packed.length / 8 + 1)
    const text = part.packed.map(v => [...v.toString(2).padStart(bits, '0')].reverse().join('')).join('')
    for (let i = 0; i < text.length; i += 8) bytes.push(parseInt([...text.slice(i, i + 8)].reverse().join(''), 2))
  }
  return Uint8Array.from(bytes)
}

test('runs and packed numbers of all widths are read', () => {
  for (let bits = 1; bits <= 24; bits++) {
    const some = count => Array.from({ length: count }, (_, i) => (i * 2654435761 >>> 3) % 2 ** bits)
    const parts = [{ packed: some(8) }, { count: 1000, value: 2 ** bits - 1 }, { packed: some(2056) }, { count: 3, value: 0 }, { packed: some(16) }]
    const all = parts.flatMap(part => part.packed ?? Array(part.count).fill(part.value))
    // The last group has places that are not asked for.
    const out = new Uint32Array(all.length - 5)
    readRuns(asRuns(parts, bits), bits, out)
    assert.deepEqual([...out], all.slice(0, -5), `${bits} bits`)
  }
})

test('runs that end too early, or say nothing, are damage', () => {
  const bytes = asRuns([{ packed: [1, 0, 1, 1, 0, 1, 0, 1] }, { count: 8, value: 1 }], 1)
  readRuns(bytes, 1, new Uint8Array(16))
  for (const length of [17, 1000]) assert.throws(() => readRuns(bytes, 1, new Uint8Array(length)), /damaged/)
  for (let length = 0; length < bytes.length; length++) assert.throws(() => readRuns(bytes.subarray(0, length), 1, new Uint8Array(16)), /damaged/)
  assert.throws(() => readRuns(Uint8Array.of(0, 1, 0, 1), 1, new Uint8Array(4)), /damaged/)
})

test('numbers whose bytes lie apart are put together', () => {
  const apart = (numbers, width) => {
    const together = new Uint8Array(numbers.buffer)
    return Uint8Array.from(together, (_, i) => together[i % numbers.length * width + Math.floor(i / numbers.length)])
  }
  const floats = Float32Array.of(0, -1.5, 3.25e7, 1e-40, Infinity)
  assert.deepEqual(joinSplit(apart(floats, 4), 5, Float32Array), floats)
  const doubles = Float64Array.of(Math.PI, -0.1, 2 ** 60)
  assert.deepEqual(joinSplit(apart(doubles, 8), 3, Float64Array), doubles)
  assert.throws(() => joinSplit(apart(doubles, 8).subarray(1), 3, Float64Array), /too short/)
  // Every so-manieth alone, as from numbers that are whole.
  const many = Float32Array.from({ length: 100 }, (_, i) => i / 7)
  for (const stride of [1, 2, 3, 8, 200]) {
    for (const first of [0, 1, 7, 100]) {
      const wanted = many.filter((_, i) => i >= first && (i - first) % stride === 0)
      assert.deepEqual(joinSplit(apart(many, 4), 100, Float32Array, first, stride), wanted)
      assert.deepEqual(picked(many, first, stride), wanted)
    }
  }
})

test('of points that are not drawn most are not read', () => {
  assert.deepEqual([1, 0.6, 0.5, 0.3, 0.25, 0.2, 0.125, 1 / 32].map(strideFor), [1, 1, 2, 2, 4, 4, 8, 8])
})
