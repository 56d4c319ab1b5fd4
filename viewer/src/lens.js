// Where a point before a camera lands in its picture: pinhole, Brown's lens, Kannala and Brandt's fisheye.

/** Nearer than this nothing is drawn, m. */
const NEAR_M = 0.1

/** A function from a point in the optical frame (x right, y down, z ahead, m) to `[u, v]` in pixels, or null where the lens shows nothing. */
export function projector(about) {
  const [[fx, , cx], [, fy, cy]] = about.intrinsics
  const { model = 'pinhole', k = [], p = [] } = about.lens ?? {}
  if (model === 'fisheye') {
    return ({ x, y, z }) => {
      const across = Math.hypot(x, y)
      const theta = Math.atan2(across, z)
      if (theta > 0.97 * Math.PI) return null
      const t2 = theta * theta
      const bent = theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))))
      const scale = across > 1e-9 ? bent / across : 0
      return [cx + fx * scale * x, cy + fy * scale * y]
    }
  }
  // Beyond the picture's corner Brown's polynomial may fold back; such points are outside anyway.
  const limit = 1.3 * Math.hypot(Math.max(cx, about.width - cx) / fx, Math.max(cy, about.height - cy) / fy)
  return ({ x, y, z }) => {
    if (z < NEAR_M) return null
    const [a, b] = [x / z, y / z]
    if (model !== 'brown') return [cx + fx * a, cy + fy * b]
    const r2 = a * a + b * b
    if (Math.sqrt(r2) > 2 * limit) return null
    const radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]))
    return [
      cx + fx * (a * radial + 2 * p[0] * a * b + p[1] * (r2 + 2 * a * a)),
      cy + fy * (b * radial + p[0] * (r2 + 2 * b * b) + 2 * p[1] * a * b),
    ]
  }
}

/** A straight edge as the picture shows it: polylines of `[u, v]`; cut at the near plane, bent by the lens. */
export function edgeInPicture(project, from, to, { isStraight, behindIsSeen }) {
  let [a, b] = [from, to]
  if (!behindIsSeen) {
    if (a.z < NEAR_M && b.z < NEAR_M) return []
    const cut = (p, q) => p.clone().lerp(q, (NEAR_M + 1e-6 - p.z) / (q.z - p.z))
    if (a.z < NEAR_M) a = cut(a, b)
    else if (b.z < NEAR_M) b = cut(b, a)
  }
  const steps = isStraight ? 1 : 12
  const lines = []
  let line = []
  for (let i = 0; i <= steps; i++) {
    const at = project(a.clone().lerp(b, i / steps))
    if (at) line.push(at)
    else if (line.length) lines.push(line.splice(0))
  }
  if (line.length > 1) lines.push(line)
  return lines
}
