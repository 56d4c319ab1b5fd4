// What the chosen object does over the scene: small plots over time, with the frame that is shown.

import { make } from './ui.js'

const WIDTH = 240
const HEIGHT = 46
const PLOTS = [
  ['speed', 'm/s', 1, h => h.speed],
  ['distance from the agent', 'm', 0, h => h.distance],
  ['lidar points', '', 0, h => h.lidarPoints],
  ['agents that see it', '', 0, h => h.seers],
]
const SVG = 'http://www.w3.org/2000/svg'

function shape(name, properties) {
  const element = document.createElementNS(SVG, name)
  for (const [key, value] of Object.entries(properties)) element.setAttribute(key, value)
  return element
}

/** Parts of a line: it is broken where the object is in no list. `every` is the step of lists, in frames. */
export function pieces(points, every) {
  const lines = []
  for (const [i, point] of points.entries()) {
    if (!i || point.frame - points[i - 1].frame > every) lines.push([])
    lines.at(-1).push(point)
  }
  return lines
}

export class Plots {
  /** `goTo(frame)` shows a frame. */
  constructor(goTo) {
    this.goTo = goTo
    this.element = make('div', { className: 'plots' })
    this.cursors = []
  }

  /** Draws the plots of `history`, `[{frame, speed, distance, lidarPoints, seers}]`; what nobody counted has no plot. */
  show(history, { frames, every, first }) {
    this.frames = frames
    this.cursors = []
    const plots = PLOTS.filter(([, , , value]) => history.some(h => value(h) !== null))
    this.element.replaceChildren(...plots.map(plot => this.plot(plot, history, every, first)))
  }

  plot([name, unit, digits, value], history, every, first) {
    const known = history.filter(h => value(h) !== null)
    const most = Math.max(...known.map(value))
    const x = frame => WIDTH * frame / Math.max(1, this.frames - 1)
    const y = v => HEIGHT - 2 - (HEIGHT - 6) * v / Math.max(most, 1e-6)
    const said = v => `${v.toFixed(digits)}${unit ? ` ${unit}` : ''}`
    const label = `${name}, ${said(Math.min(...known.map(value)))} to ${said(most)}, frames ${first + known[0].frame} to ${first + known.at(-1).frame}`
    const svg = shape('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: 'none', role: 'img', 'aria-label': label })
    for (const line of pieces(known, every)) {
      // A single frame is a short dash.
      const points = line.length > 1 ? line : [line[0], { ...line[0], frame: line[0].frame + 0.5 }]
      svg.append(shape('polyline', { points: points.map(h => `${x(h.frame).toFixed(1)},${y(value(h)).toFixed(1)}`).join(' ') }))
    }
    const cursor = shape('line', { y1: 0, y2: HEIGHT })
    svg.append(cursor)
    this.cursors.push(cursor)
    svg.addEventListener('click', e => {
      const area = svg.getBoundingClientRect()
      this.goTo(Math.round((e.clientX - area.left) / area.width * (this.frames - 1)))
    })
    const now = make('b')
    cursor.now = frame => {
      const at = known.find(h => h.frame === frame)
      now.textContent = at ? said(value(at)) : '–'
    }
    return make('figure', {}, make('figcaption', {}, name, make('small', { textContent: `up to ${said(most)}` }), now), svg)
  }

  /** Marks the frame that is shown; `listed` is the frame of its lists. */
  at(frame, listed) {
    const x = WIDTH * frame / Math.max(1, this.frames - 1)
    for (const cursor of this.cursors) {
      cursor.setAttribute('x1', x)
      cursor.setAttribute('x2', x)
      cursor.now(listed)
    }
  }
}
