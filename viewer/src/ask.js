// The two questions that people open the page for: what do partners add, and what did the model see? What is asked decides how boxes
// are coloured, which boxes there are, and what is counted.

import { isInReach, partnersOf, sightOf } from './data/cooperation.js'
import { ScenePredictions, resultsOf, tally } from './data/predictions.js'
import { sightings } from './data/sightings.js'
import { RESULT_COLORS, SIGHT_COLORS, agentColor, bytesOf, readable } from './colors.js'
import { note } from './ui.js'

const NO_EVENTS = []
/** So many of the worst frames are listed. */
export const WORST_FRAMES = 12

export class Ask {
  constructor(app) {
    this.app = app
    this.predictions = null
  }

  /** What the store says of predictions, or null. */
  get about() {
    return this.app.store.index.predictions ?? null
  }

  get question() {
    return this.app.choices.ask
  }

  /** Reads a scene's predictions; null where there are none. The page goes on without them where they cannot be had. */
  async read(scene) {
    if (!this.about?.scenes.includes(Number(scene.folder))) return null
    try {
      const told = await this.app.store.readJson(`api/predictions/${scene.folder}.json`)
      return new ScenePredictions(told, scene.tables.origin, this.app.names.classes.map(c => c.name))
    } catch (error) {
      this.app.setNote('predictions', note('bad', `No predictions are shown: ${error.message}`))
      return null
    }
  }

  /** A scene is opened, with what `read` gave of it. */
  openScene(predictions) {
    this.predictions = predictions
    this.cached = null
    if (!this.about && this.question === 'model') this.app.choices.ask = 'scene'
  }

  /** The mode as the predictions' file calls it: the chosen one, or its last one where it has not that. */
  get mode() {
    const { modes } = this.about
    return modes.includes(this.app.choices.partners) ? this.app.choices.partners : modes.at(-1)
  }

  get rule() {
    const { score, threshold } = this.app.choices
    return { score: score === '' ? this.bestScore() : Number(score), threshold }
  }

  /** Where the slider stands before anybody has moved it. */
  bestScore() {
    const key = `${this.mode} ${this.app.choices.threshold}`
    if (this.best?.key !== key || this.best.of !== this.predictions) {
      this.best = { key, of: this.predictions, score: this.predictions?.bestScore(this.mode, this.app.choices.threshold) ?? 0 }
    }
    return this.best.score
  }

  /** What is to be shown at the frame: `{partners, links, sample, results, counts}`, as far as it was asked for. */
  look() {
    const { app } = this
    const { scene, frame, choices: c, ego } = app
    const key = JSON.stringify([scene.folder, frame, ego, c.ask, c.partners, c.range, c.elevation, c.score, c.threshold])
    if (this.cached?.key === key && this.cached.of === this.predictions) return this.cached
    const seen = { key, of: this.predictions, partners: [], links: [], sample: null, results: null }
    if (c.ask === 'partners') {
      const places = scene.tables.placesAt(frame)
      seen.partners = partnersOf(ego, places, c)
      seen.links = this.links(places, seen.partners)
    }
    if (c.ask === 'model') {
      seen.sample = this.predictions?.at(scene.tables.boxFrame(frame), ego, this.mode) ?? null
      seen.results = seen.sample && resultsOf(seen.sample, this.rule)
    }
    this.cached = seen
    return seen
  }

  /** Lines between agents: strong ones from the ego to who is heard, faint ones between others in reach. */
  links(places, partners) {
    const { scene, choices: c, ego } = this.app
    const index = name => scene.agents.findIndex(a => a.name === name)
    const names = [...places.keys()]
    const links = []
    for (const [i, a] of names.entries()) {
      for (const b of names.slice(i + 1)) {
        const other = a === ego ? b : b === ego ? a : null
        const isHeard = other !== null && partners.find(p => p.name === other).isHeard
        if (!isHeard && (other !== null || c.partners === 'none' || !isInReach(places.get(a), places.get(b), c))) continue
        links.push({ from: places.get(a), to: places.get(b), isStrong: isHeard, color: isHeard ? bytesOf(agentColor(index(other))) : [125, 135, 150] })
      }
    }
    return links
  }

  /** The boxes that are shown, of those that the choices leave. */
  boxes(boxes) {
    const { question, app } = this
    if (question !== 'model') return boxes
    const { sample, results } = this.look()
    if (!sample) return boxes
    const { hidden } = app.choices
    const wanted = boxes.filter(b => results.targets.has(b.id) || b.id === app.chosen)
    return [...wanted, ...results.predictions.filter(b => !hidden.has(b.class))]
  }

  /** The colour of a box, sRGB bytes, or null where nothing is asked that colours boxes. */
  colorOf() {
    const { app, question } = this
    if (question === 'partners') {
      const { partners } = this.look()
      const own = new Map(app.scene.agents.map((agent, i) => [agent.id, bytesOf(agentColor(i))]))
      return box => own.get(box.id) ?? readable(bytesOf(SIGHT_COLORS[sightOf(box, app.ego, partners)]), app.isDark)
    }
    if (question === 'model' && this.look().sample) {
      const { results } = this.look()
      return box => readable(bytesOf(RESULT_COLORS[box.isPrediction ? box.result : results.targets.get(box.id) ?? 'other']), app.isDark)
    }
    return null
  }

  /** How many boxes who sees: `{ego, partners, nobody}`, and for each agent how many it sees and how many only partners alone. */
  sights(boxes) {
    const { app } = this
    const { partners } = this.look()
    const agents = new Set(app.scene.agents.map(a => a.id))
    const counts = { ego: 0, partners: 0, nobody: 0 }
    const each = new Map(app.scene.agents.map(a => [a.name, { sees: 0, adds: 0 }]))
    for (const box of boxes) {
      if (agents.has(box.id)) continue
      const sight = sightOf(box, app.ego, partners)
      counts[sight]++
      for (const name of box.seenBy) {
        const one = each.get(name)
        if (!one) continue
        one.sees++
        if (sight === 'partners' && partners.find(p => p.name === name)?.isHeard) one.adds++
      }
    }
    return { counts, each }
  }

  /** When partners or the ego first see things, in the whole scene. */
  events() {
    const { app } = this
    const { choices: c, scene } = app
    if (c.ask !== 'partners' || !scene.tables.isMerged) return NO_EVENTS
    const key = JSON.stringify([scene.folder, app.ego, c.partners, c.range, c.elevation])
    if (this.seen?.key !== key) this.seen = { key, events: sightings(scene.tables, app.ego, c) }
    return this.seen.events
  }

  /** Found, missed and false: at the frame, and in the whole scene for the ego. */
  counts() {
    const { sample } = this.look()
    const { rule, predictions, mode, app } = this
    const key = JSON.stringify([mode, rule])
    if (this.total?.key !== key || this.total.of !== predictions) {
      this.total = { key, of: predictions, egos: new Map(), worst: predictions.worst(mode, rule, WORST_FRAMES) }
    }
    const { egos, worst } = this.total
    if (!egos.has(app.ego)) egos.set(app.ego, tally(predictions.of(mode, app.ego), rule).all)
    return { frame: sample && tally([sample], rule), scene: egos.get(app.ego), worst }
  }
}
