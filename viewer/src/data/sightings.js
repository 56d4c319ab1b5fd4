// When an ego and its partners first see objects: marks on the time line.

import { partnersOf } from './cooperation.js'

/**
 * Frames at which partners first see something that the ego has not seen yet, and frames at which the ego sees for the first time what
 * partners saw before: `[{frame, kind: 'partners' | 'ego', ids}]`. What is seen at the first frame is no event.
 */
export function sightings(tables, ego, rule) {
  const frames = [...tables.boxRows.keys()].sort((a, b) => a - b)
  const [byEgo, byPartners] = [new Set(), new Set()]
  const events = []
  for (const [i, frame] of frames.entries()) {
    const heard = new Set(partnersOf(ego, tables.placesAt(frame), rule).filter(p => p.isHeard).map(p => p.name))
    const found = { partners: [], ego: [] }
    for (const { id, seenBy } of tables.seenAt(frame)) {
      if (byEgo.has(id)) continue
      if (seenBy.includes(ego)) {
        byEgo.add(id)
        if (byPartners.has(id)) found.ego.push(id)
      } else if (!byPartners.has(id) && seenBy.some(name => heard.has(name))) {
        byPartners.add(id)
        found.partners.push(id)
      }
    }
    if (i > 0) for (const kind of ['partners', 'ego']) if (found[kind].length) events.push({ frame, kind, ids: found[kind] })
  }
  return events
}
