// Which boxes are shown: by class, distance from the agent, points, difficulty, and whether anybody saw them.

/** The boxes of a list that pass; the chosen one and agents always do. */
export function filtered(boxes, choices, { here, always }) {
  const { hidden, valid, ask, within, points, levels } = choices
  // Who asks what partners add or a model saw wants to see what nobody saw, too.
  const isSeenOnly = valid && ask === 'scene'
  return boxes.filter(box => {
    if (hidden.has(box.class)) return false
    if (always.has(box.id)) return true
    if (isSeenOnly && !box.isValid) return false
    if (within && Math.hypot(box.center[0] - here[0], box.center[1] - here[1]) > Number(within)) return false
    if (points && box.lidarPoints !== null && box.lidarPoints + (box.radarPoints ?? 0) < points) return false
    return !box.difficulty || levels.has(box.difficulty)
  })
}
