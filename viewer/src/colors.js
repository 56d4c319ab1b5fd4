// Colours that pictures, points, boxes and masks share.

/** Multiplied into ids so that neighbours differ: the fractional part of the golden ratio. */
export const GOLDEN = 0.61803399

/** Viridis at nine places: even in lightness, and readable by the colour-blind. */
const RAMP = ['#440154', '#472d7b', '#3b528b', '#2c728e', '#21918c', '#28ae80', '#5ec962', '#addc30', '#fde725']

/** Lightness that stays readable: at least on dark ground, at most on light ground. */
const DARKEST = 0.4
const BRIGHTEST = 0.66

const AGENTS = ['#3987e5', '#eb6834', '#1baf7a', '#d55181', '#9085e9', '#c98500', '#20a4b8', '#8a9a3a']

/** Who sees an object. Blue and orange stay apart for the colour-blind; grey recedes. */
export const SIGHT_COLORS = { ego: '#3987e5', partners: '#f08a24', nobody: '#77808d' }
/** What came of targets (found, missed) and of predictions (right, false); `other` is no target. */
export const RESULT_COLORS = { found: '#1fae78', missed: '#f08a24', right: '#4aa3f0', false: '#e0459b', other: '#77808d' }

/** Colour of an object's id, sRGB bytes. The shaders have the same formula. */
export function idColor(id) {
  const hue = (id * GOLDEN) % 1
  const saturation = 0.55 + 0.15 * (id % 3)
  return hsv(hue, saturation, 0.95)
}

export function hsv(hue, saturation, value) {
  const channel = n => {
    const k = (n + hue * 6) % 6
    return Math.round(255 * (value - value * saturation * Math.max(0, Math.min(k, 4 - k, 1))))
  }
  return [channel(5), channel(3), channel(1)]
}

export function agentColor(index) {
  return AGENTS[index % AGENTS.length]
}

export const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`

export const bytesOf = hex => [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16))

/** The ramp for heights and intensities, 256 colours as RGBA bytes. Its darkest end is left out: points lie on dark ground, too. */
export function rampBytes() {
  const stops = RAMP.map(bytesOf)
  const out = new Uint8Array(4 * 256)
  for (let i = 0; i < 256; i++) {
    const place = (0.12 + 0.88 * i / 255) * (stops.length - 1)
    const low = Math.min(Math.floor(place), stops.length - 2)
    for (let c = 0; c < 3; c++) out[4 * i + c] = stops[low][c] + (stops[low + 1][c] - stops[low][c]) * (place - low)
    out[4 * i + 3] = 255
  }
  return out
}

export function rampCss() {
  const bytes = rampBytes()
  const stops = [0, 32, 64, 96, 128, 160, 192, 224, 255].map(i => css(bytes.slice(4 * i, 4 * i + 3)))
  return `linear-gradient(to right, ${stops.join(', ')})`
}

/** A colour that can be told from the theme's ground: too dark ones are lifted on dark ground, too bright ones darkened on light ground. */
export function readable(rgb, isDark) {
  const lightness = (Math.max(...rgb) + Math.min(...rgb)) / 510
  if (!isDark) return rgb.map(v => Math.round(v * Math.min(1, BRIGHTEST / Math.max(lightness, 1e-6))))
  // Mixed with white: dark colours of one hue stay different.
  const white = Math.max(0, (DARKEST - lightness) / (1 - lightness))
  return rgb.map(v => Math.round(v + white * (255 - v)))
}

/** Colours of boxes by detection class. */
export function classColors(names) {
  const colors = new Map(names.classes.map(c => [c.name, c.rgb]))
  return name => colors.get(name) ?? [160, 160, 160]
}
