// The layout of the page that was open last. Only pages that were opened without a link take it over: a link shows what its sender saw.

import { DEFAULTS, takeLink } from './choices.js'
import { readLink, writeLink } from './link.js'

const KEY = 'convoy-layout'
const KEPT = ['size', 'layers', 'marks', 'mode', 'kind', 'voxels', 'boxes', 'side', 'grid']

export function recall(choices) {
  try {
    const text = localStorage.getItem(KEY)
    if (text) takeLink(choices, readLink(text))
  } catch {
    // Pages from files may not be allowed to remember.
  }
}

export function remember(choices) {
  try {
    localStorage.setItem(KEY, writeLink(Object.fromEntries(KEPT.map(key => [key, choices[key]])), DEFAULTS))
  } catch {
    // As above.
  }
}
