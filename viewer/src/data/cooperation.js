// Who hears whom, and who sees what: the rule of `evaluate` and of the Python package (lib/out/evaluation/src/mode.rs).

/** With whom the ego works together: nobody, vehicles, RSUs, both. */
export const PARTNER_MODES = ['none', 'x2v', 'x2i', 'x2x']
/** How far away, and how much higher or lower, a partner's origin may be, m. */
export const COMM_RANGE_M = 80
export const ELEVATION_M = 4.8

const isRsu = name => name.startsWith('rsu')
const isVehicle = name => name.startsWith('vehicle')

/** Whether two agents at some places may work together. */
export function isInReach(here, there, { range, elevation }) {
  const away = [0, 1, 2].map(i => there[i] - here[i])
  return Math.hypot(...away) <= range && Math.abs(away[2]) <= elevation
}

/** All other agents: `{name, distance, isInReach, isHeard}`. `places` is name to x, y, z, m; `isHeard` also asks for the mode. */
export function partnersOf(ego, places, { partners: mode, range, elevation }) {
  const here = places.get(ego)
  return [...places].filter(([name]) => name !== ego).map(([name, place]) => {
    const near = isInReach(here, place, { range, elevation }) && (isRsu(name) || isVehicle(name))
    const isWanted = mode === 'x2x' || (mode === 'x2v' && isVehicle(name)) || (mode === 'x2i' && isRsu(name))
    return { name, distance: Math.hypot(...place.map((v, i) => v - here[i])), isInReach: near, isHeard: near && isWanted }
  })
}

/** Who sees a box: `ego` (whoever else does), `partners` (only some that are heard), `nobody` of these. */
export function sightOf(box, ego, partners) {
  if (box.seenBy.includes(ego)) return 'ego'
  return partners.some(p => p.isHeard && box.seenBy.includes(p.name)) ? 'partners' : 'nobody'
}
