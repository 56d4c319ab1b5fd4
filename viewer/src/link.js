// The choices as a URL's hash, so that a link shows what its sender saw. What is as by default is left out.

const LISTS = ['agents', 'layers', 'marks', 'hidden', 'hiddenBev', 'levels', 'pose']

export function readLink(hash) {
  const link = {}
  for (const [key, value] of new URLSearchParams(hash.replace(/^#/, ''))) {
    link[key] = LISTS.includes(key) ? value.split(',').filter(Boolean) : value
  }
  const frame = Number.parseInt(link.frame, 10)
  link.frame = Number.isFinite(frame) && frame >= 0 ? frame : undefined
  const pose = link.pose?.map(Number)
  link.pose = pose?.length === 6 && pose.every(Number.isFinite) ? pose : undefined
  return link
}

export function writeLink(choices, defaults) {
  const params = new URLSearchParams()
  for (const [key, value] of Object.entries(choices)) {
    const text = textOf(value)
    if (text !== undefined && text !== textOf(defaults[key])) params.set(key, text)
  }
  // Commas and slashes may stand in a hash; links stay readable.
  return `#${params.toString().replaceAll('%2C', ',').replaceAll('%2F', '/')}`
}

function textOf(value) {
  if (value === undefined || value === null) return undefined
  if (value instanceof Set || Array.isArray(value)) return [...value].join(',')
  return String(value)
}
