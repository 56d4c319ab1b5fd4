// The map's lines and the ways of objects.

import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments, ShaderMaterial } from 'three'

/** Kinds of map lines, in the order of the legend: colours for dark and light ground. */
export const MAP_KINDS = [
  { name: 'lane centre', dark: '#33506b', light: '#b8cfe6', of: e => e.kind === 'lane_centreline' && e.laneType === 'Driving' },
  { name: 'marking', dark: '#b9b9b0', light: '#6f6f68', of: e => e.kind === 'divider' },
  { name: 'kerb, edge', dark: '#7a6a58', light: '#a08a70', of: e => e.kind === 'kerb' || (e.kind === 'lane_boundary' && e.isEdge) },
  { name: 'crosswalk', dark: '#4fb3a5', light: '#1d8577', of: e => e.kind === 'crosswalk' },
  { name: 'stop line', dark: '#e06666', light: '#c62f2f', of: e => e.kind === 'stop_line' },
  { name: 'sidewalk', dark: '#6b4f80', light: '#c3a5d8', of: e => e.kind === 'sidewalk' },
  { name: 'junction', dark: '#3b4654', light: '#c9d2dc', of: e => e.kind === 'junction' },
]
/** Lines lie so far above the road that points on it do not hide them, m. */
const LIFT_M = 0.03

export function mapLines(elements, isDark) {
  const [places, colors] = [[], []]
  for (const element of elements) {
    const kind = MAP_KINDS.find(k => k.of(element))
    if (!kind) continue
    const color = new Color(isDark ? kind.dark : kind.light)
    for (const [a, b] of dashed(element)) {
      places.push(a[0], a[1], a[2] + LIFT_M, b[0], b[1], b[2] + LIFT_M)
      colors.push(color.r, color.g, color.b, color.r, color.g, color.b)
    }
  }
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(places), 3))
  geometry.setAttribute('color', new BufferAttribute(new Float32Array(colors), 3))
  return new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }))
}

/** The painted pieces of an element. */
export function* dashed({ points, dash }) {
  let way = 0
  for (let i = 0; i + 1 < points.length; i++) {
    const [a, b] = [points[i], points[i + 1]]
    if (!dash) {
      yield [a, b]
      continue
    }
    const length = Math.hypot(b[0] - a[0], b[1] - a[1])
    const period = dash[0] + dash[1]
    const at = t => a.map((v, axis) => v + (b[axis] - v) * t / length)
    for (let start = Math.floor(way / period) * period - way; start < length; start += period) {
      const [from, to] = [Math.max(start, 0), Math.min(start + dash[0], length)]
      if (from < to) yield [at(from), at(to)]
    }
    way += length
  }
}

/** Where objects were (bright, fading with time) and where they will be (faint). */
export class TrackLines {
  constructor() {
    const material = new ShaderMaterial({
      uniforms: { now: { value: 0 } },
      vertexShader: `
        uniform float now;
        attribute float frame;
        attribute vec3 color;
        varying vec4 shown;
        void main() {
          float age = now - frame;
          float strength = age < 0.0 ? 0.4 : max(0.35, 1.0 - age / 80.0);
          shown = vec4(color, strength);
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        }`,
      fragmentShader: `
        varying vec4 shown;
        void main() { gl_FragColor = shown; }`,
      transparent: true,
      depthTest: false,
      depthWrite: false,
    })
    this.object = new LineSegments(new BufferGeometry(), material)
    this.object.frustumCulled = false
  }

  set(tracks, colorOf) {
    const [places, colors, frames] = [[], [], []]
    for (const track of tracks) {
      const color = colorOf(track).map(v => v / 255)
      for (let i = 0; i + 1 < track.points.length; i++) {
        places.push(...track.points[i], ...track.points[i + 1])
        colors.push(...color, ...color)
        frames.push(track.frames[i], track.frames[i + 1])
      }
    }
    this.object.geometry.dispose()
    const geometry = new BufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(places), 3))
    geometry.setAttribute('color', new BufferAttribute(new Float32Array(colors), 3))
    geometry.setAttribute('frame', new BufferAttribute(new Float32Array(frames), 1))
    this.object.geometry = geometry
  }

  setFrame(frame) {
    this.object.material.uniforms.now.value = frame
  }
}
