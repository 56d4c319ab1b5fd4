// What a model found in a scene. The server holds predictions against boxes by the evaluator's own code (lib/out/evaluation/src/pairs.rs):
// per class the surest choose first, each the nearest target that is free by the distance of centres, and find it up to a threshold.
// Surer ones choose first, so a higher least score changes nothing in what the others found: here it is only counted.

export class ScenePredictions {
  /** `told` is the server's list of the scene; places become relative to the scene's origin. */
  constructor(told, origin, classes) {
    this.samples = new Map()
    for (const sample of told.samples) {
      const boxes = sample.scores.map((score, i) => ({
        // Negative: objects of the store have ids from 1 on.
        id: -1 - i, isPrediction: true, class: classes[sample.classes[i]], score, found: sample.found[i],
        center: sample.centers_m[i].map((v, axis) => v - origin[axis]), size: sample.sizes_m[i], rpy: [0, 0, sample.yaws_rad[i]],
        velocity: [0, 0, 0], speed: 0, seenBy: [], isValid: true,
      }))
      const targets = sample.targets.map((id, i) => ({ id, class: classes[sample.target_classes[i]] }))
      this.samples.set(keyOf(sample), { ...sample, targets, boxes })
    }
    this.frames = [...new Set(told.samples.map(s => s.frame))].sort((a, b) => a - b)
    const scores = told.samples.flatMap(s => s.scores)
    /** Least and greatest score. */
    this.range = scores.length ? [scores.reduce((a, b) => Math.min(a, b)), scores.reduce((a, b) => Math.max(a, b))] : [0, 0]
  }

  /** What was predicted for an ego at a frame, or undefined where nobody asked. */
  at(frame, agent, mode) {
    return this.samples.get(keyOf({ frame, agent, mode }))
  }

  /** Samples of a mode, of one ego or of all. */
  of(mode, agent) {
    return [...this.samples.values()].filter(s => s.mode === mode && (!agent || s.agent === agent))
  }

  /** Samples with most that is missed or false, the worst first, of equally bad ones the earlier. */
  worst(mode, rule, count) {
    const counted = this.of(mode).map(sample => ({ sample, ...tally([sample], rule).all })).filter(c => c.missed + c.false > 0)
    const earlier = (a, b) => a.sample.frame - b.sample.frame || a.sample.agent.localeCompare(b.sample.agent)
    return counted.sort((a, b) => b.missed + b.false - a.missed - a.false || earlier(a, b)).slice(0, count)
  }

  /** The score from which on precision and recall of all classes together have the best harmonic mean. */
  bestScore(mode, threshold) {
    const samples = this.of(mode)
    const targets = samples.reduce((sum, s) => sum + s.targets.length, 0)
    const all = samples.flatMap(s => s.boxes.map(b => [b.score, b.found[threshold] !== 0])).sort((a, b) => b[0] - a[0])
    let [right, best, score] = [0, 0, this.range[0]]
    for (const [i, [value, isRight]] of all.entries()) {
      right += isRight ? 1 : 0
      const f1 = 2 * right / (i + 1 + targets)
      // Those of one score count together.
      if (f1 > best && all[i + 1]?.[0] !== value) [best, score] = [f1, value]
    }
    return score
  }
}

/** What a sample's boxes are: predictions from a score on as `right` or `false`, targets by id as `found` or `missed`. */
export function resultsOf(sample, { score, threshold }) {
  const boxes = sample.boxes.filter(b => b.score >= score)
  const found = new Map(boxes.filter(b => b.found[threshold]).map(b => [b.found[threshold], b]))
  return {
    predictions: boxes.map(b => ({ ...b, result: b.found[threshold] ? 'right' : 'false', foundId: b.found[threshold] || null })),
    targets: new Map(sample.targets.map(t => [t.id, found.has(t.id) ? 'found' : 'missed'])),
    foundBy: found,
  }
}

/** Found, missed and false ones of samples: together, and by class. */
export function tally(samples, rule) {
  const byClass = new Map()
  const all = { found: 0, missed: 0, false: 0 }
  const count = (name, what) => {
    if (!byClass.has(name)) byClass.set(name, { found: 0, missed: 0, false: 0 })
    byClass.get(name)[what]++
    all[what]++
  }
  for (const sample of samples) {
    const { predictions, targets } = resultsOf(sample, rule)
    for (const { id, class: name } of sample.targets) count(name, targets.get(id))
    for (const { class: name, result } of predictions) if (result === 'false') count(name, 'false')
  }
  return { all, byClass: new Map([...byClass].sort(([a], [b]) => a.localeCompare(b))) }
}

const keyOf = ({ frame, agent, mode }) => `${frame} ${agent} ${mode}`
