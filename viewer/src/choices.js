// What can be chosen, and what is chosen at first.

import { COMM_RANGE_M, ELEVATION_M, PARTNER_MODES } from './data/cooperation.js'
import { MODES } from './view/navigation.js'
import { COLORINGS } from './view/points.js'

export const LAYERS = ['points', 'boxes', 'labels', 'map', 'tracks', 'voxels', 'grid']
export const MARKS = ['boxes', 'boxes2d', 'masks', 'flow', 'names']
export const VIEWS = ['3d', 'cameras', 'bev']
export const BOX_COLORINGS = ['class', 'id', 'agent']
export const KINDS = ['RGB', 'SEG', 'IST', 'DPT']
/** What the page is asked: what there is, what partners add, what a model saw. */
export const QUESTIONS = ['scene', 'partners', 'model']
/** Whose cameras lie side by side: all of an agent, one of each agent, those that see the chosen object. */
export const GRIDS = ['agent', 'agents', 'object']
/** Difficulties of boxes. */
export const LEVELS = ['easy', 'medium', 'hard']
/** Boxes of which the agent's cameras hide at most such a share; empty: all. */
export const OCCLUDED = ['', '0.2', '0.5', '0.8', '1']
/** Boxes up to so far from the agent, m; empty: all. */
export const WITHIN_M = ['', '25', '50', '80', '120']
/** How voxels may be looked at: merged to cells of some metres, within some metres of the agent. */
export const VOXEL_DETAIL = { wide: { merge: 0.4, reach: 64, limit: 900_000, label: '0.4 m, all' }, near: { merge: 0.1, reach: 16, limit: 900_000, label: 'full, 16 m' } }
export const DEFAULTS = {
  view: '3d', sensor: 'LIDAR', color: 'height', size: 1.5, boxes: 'class', valid: true, layers: new Set(['points', 'boxes', 'labels', 'map', 'grid']),
  marks: new Set(['boxes']), kind: 'RGB', camera: '', mode: 'follow', voxels: 'wide', hidden: new Set(), hiddenBev: new Set(), bevBoxes: true,
  ask: 'scene', partners: 'x2x', range: COMM_RANGE_M, elevation: ELEVATION_M, heardOnly: true, score: '', threshold: 2, grid: 'agent',
  within: '', points: 0, levels: new Set(LEVELS), occluded: '', side: true,
}

export function freshChoices() {
  return { ...DEFAULTS, layers: new Set(DEFAULTS.layers), marks: new Set(DEFAULTS.marks), hidden: new Set(), hiddenBev: new Set(), levels: new Set(LEVELS) }
}

/** Takes over what a link chooses, as far as there is such a thing. */
export function takeLink(choices, link) {
  const among = {
    view: VIEWS, color: COLORINGS, boxes: BOX_COLORINGS, kind: KINDS, mode: MODES, voxels: Object.keys(VOXEL_DETAIL),
    ask: QUESTIONS, partners: PARTNER_MODES, grid: GRIDS, within: WITHIN_M, occluded: OCCLUDED,
  }
  for (const [key, list] of Object.entries(among)) if (list.includes(link[key])) choices[key] = link[key]
  for (const key of ['sensor', 'camera']) choices[key] = link[key] ?? choices[key]
  for (const key of ['valid', 'bevBoxes', 'heardOnly', 'side']) choices[key] = link[key] !== 'false'
  if (link.size >= 0.5 && link.size <= 4) choices.size = Number(link.size)
  for (const [key, most] of [['range', 1000], ['elevation', 100], ['points', 1000]]) if (link[key] >= 0 && link[key] <= most) choices[key] = Number(link[key])
  if (Number.isFinite(Number.parseFloat(link.score))) choices.score = Number(link.score)
  if ([0, 1, 2, 3].includes(Number(link.threshold))) choices.threshold = Number(link.threshold)
  for (const [key, list] of [['layers', LAYERS], ['marks', MARKS], ['levels', LEVELS]]) if (link[key]) choices[key] = new Set(link[key].filter(name => list.includes(name)))
  for (const key of ['hidden', 'hiddenBev']) choices[key] = new Set(link[key] ?? [])
}
