// Points of one sensor reading; colours are chosen on the graphics card.

import { BufferAttribute, BufferGeometry, DataTexture, LineBasicMaterial, LineSegments, NearestFilter, Points, Quaternion, ShaderMaterial, Vector2, Vector3 } from 'three'
import { GOLDEN, bytesOf, rampBytes, readable } from '../colors.js'

export const COLORINGS = ['height', 'tag', 'id', 'intensity', 'agent', 'plain']

const VERTEX = `
uniform int coloring;
uniform float size;
uniform vec2 heights;
uniform vec3 agentColor;
uniform vec3 plain;
uniform sampler2D ramp;
uniform sampler2D tags;
attribute vec4 facts;
varying vec3 color;

vec3 hsv(float hue, float saturation, float value) {
  vec3 k = mod(vec3(5.0, 3.0, 1.0) + hue * 6.0, 6.0);
  return value - value * saturation * clamp(min(k, 4.0 - k), 0.0, 1.0);
}

void main() {
  vec4 place = modelMatrix * vec4(position, 1.0);
  vec4 seen = viewMatrix * place;
  gl_Position = projectionMatrix * seen;
  gl_PointSize = clamp(size * 60.0 / max(-seen.z, 0.1), size, 3.0 * size);
  if (coloring == 0) {
    float t = clamp((place.z - heights.x) / (heights.y - heights.x), 0.0, 1.0);
    color = texture2D(ramp, vec2(t * 0.996 + 0.002, 0.5)).rgb;
  } else if (coloring == 1) {
    color = texture2D(tags, vec2((facts.y + 0.5) / 32.0, 0.5)).rgb;
  } else if (coloring == 2) {
    float id = facts.z + 256.0 * facts.w;
    color = id < 0.5 ? vec3(0.5) : hsv(fract(id * ${GOLDEN}), 0.55 + 0.15 * mod(id, 3.0), 0.95);
  } else if (coloring == 3) {
    color = texture2D(ramp, vec2(sqrt(facts.x / 255.0) * 0.996 + 0.002, 0.5)).rgb;
  } else if (coloring == 4) {
    color = agentColor;
  } else {
    color = plain;
  }
}`

const FRAGMENT = `
varying vec3 color;
void main() {
  vec2 from = gl_PointCoord - 0.5;
  if (dot(from, from) > 0.25) discard;
  gl_FragColor = vec4(color, 1.0);
}`

function texture(bytes, width) {
  const made = new DataTexture(bytes, width, 1)
  made.minFilter = made.magFilter = NearestFilter
  made.needsUpdate = true
  return made
}

/** Radar readings of what moves slower than this over ground along their ray have no line, m/s: the radar's own turning is left out. */
const SLOW_MPS = 1
/** Towards the radar, and away from it. */
const TOWARDS = [0.96, 0.42, 0.2]
const AWAY = [0.3, 0.6, 0.95]

/** Settings that all points share: `set` changes them everywhere. */
export class PointStyle {
  constructor(tags) {
    this.tags = tags
    this.shared = {
      coloring: { value: 0 }, size: { value: 1.5 }, heights: { value: new Vector2(-2, 8) },
      ramp: { value: texture(rampBytes(), 256) }, tags: { value: null }, plain: { value: new Vector3() },
    }
    this.setTheme(true)
  }

  setTheme(isDark) {
    const bytes = new Uint8Array(4 * 32)
    this.tags.forEach(({ rgb }, tag) => bytes.set([...readable(rgb, isDark), 255], 4 * tag))
    this.shared.tags.value?.dispose()
    this.shared.tags.value = texture(bytes, 32)
    this.shared.plain.value.setScalar(isDark ? 0.42 : 0.62)
  }
}

export class PointCloud {
  constructor(style, color) {
    this.capacity = 0
    this.count = 0
    this.total = 0
    const material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT,
      uniforms: { ...style.shared, agentColor: { value: new Vector3(...bytesOf(color).map(v => v / 255)) } },
    })
    this.object = new Points(new BufferGeometry(), material)
    this.object.frustumCulled = false
    this.object.matrixAutoUpdate = false
    this.rays = null
    this.shown = null
  }

  /** Shows a reading at a pose. Buffers are kept and grow with the greatest reading. */
  show(reading, matrix, velocity) {
    this.object.visible = true
    this.object.matrix.copy(matrix)
    this.object.matrixWorldNeedsUpdate = true
    if (reading === this.shown) return
    this.shown = reading
    if (reading.count > this.capacity) this.grow(Math.ceil(1.1 * reading.count))
    const { position, facts } = this.object.geometry.attributes
    for (const [attribute, values] of [[position, reading.position], [facts, reading.facts]]) {
      attribute.array.set(values)
      attribute.clearUpdateRanges()
      attribute.addUpdateRange(0, values.length)
      attribute.needsUpdate = true
    }
    this.count = reading.count
    this.total = reading.total
    this.showSpeeds(reading, matrix, velocity)
  }

  /** Draws a share of all points, as far as they are here: those at the front of a reading are spread over all of it. */
  draw(share) {
    this.object.geometry.setDrawRange(0, Math.min(this.count, Math.ceil(share * this.total)))
  }

  /** Lines along a radar's rays, as long as a second's way over ground; `velocity` is the agent's in the world, m/s. */
  showSpeeds({ count, position, speed }, matrix, velocity) {
    if (!speed?.length && !this.rays) return
    if (!this.rays) {
      this.rays = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true }))
      this.rays.frustumCulled = false
      this.object.add(this.rays)
    }
    const own = new Vector3(...velocity).applyQuaternion(new Quaternion().setFromRotationMatrix(matrix).invert())
    const [places, colors] = [[], []]
    for (let i = 0; speed && i < count; i++) {
      const at = position.subarray(3 * i, 3 * i + 3)
      const distance = Math.hypot(...at)
      if (!(distance > 0)) continue
      // What is measured is relative to the radar.
      const overGround = speed[i] + (own.x * at[0] + own.y * at[1] + own.z * at[2]) / distance
      if (Math.abs(overGround) < SLOW_MPS) continue
      const along = 1 + overGround / distance
      places.push(...at, along * at[0], along * at[1], along * at[2])
      const color = overGround < 0 ? TOWARDS : AWAY
      colors.push(...color, ...color)
    }
    this.rays.geometry.dispose()
    const geometry = new BufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(places), 3))
    geometry.setAttribute('color', new BufferAttribute(new Float32Array(colors), 3))
    this.rays.geometry = geometry
  }

  grow(capacity) {
    this.capacity = capacity
    this.object.geometry.dispose()
    const geometry = new BufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(3 * capacity), 3))
    geometry.setAttribute('facts', new BufferAttribute(new Uint8Array(4 * capacity), 4))
    this.object.geometry = geometry
  }

  hide() {
    this.object.visible = false
  }

  dispose() {
    this.rays?.geometry.dispose()
    this.rays?.material.dispose()
    this.object.geometry.dispose()
    this.object.material.dispose()
    this.object.removeFromParent()
  }
}
