// Poses as three.js matrices, relative to a scene's origin: maps reach kilometres, the screen's numbers are 32-bit.

import { Matrix4, Quaternion, Vector3 } from 'three'

/** `to_from_body` of a translation and a quaternion w, x, y, z, less an origin. */
export function poseMatrix([x, y, z], [qw, qx, qy, qz], origin = [0, 0, 0]) {
  const translation = new Vector3(x - origin[0], y - origin[1], z - origin[2])
  return new Matrix4().compose(translation, new Quaternion(qx, qy, qz, qw), new Vector3(1, 1, 1))
}

/** Rz(yaw) Ry(pitch) Rx(roll), at a place. */
export function boxMatrix(center, [roll, pitch, yaw]) {
  const turn = new Quaternion()
    .setFromAxisAngle(new Vector3(0, 0, 1), yaw)
    .multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), pitch))
    .multiply(new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), roll))
  return new Matrix4().compose(new Vector3(...center), turn, new Vector3(1, 1, 1))
}

/** Heading of a body about the world's z axis, rad. */
export function yawOf(matrix) {
  const e = matrix.elements
  return Math.atan2(e[1], e[0])
}

/** The eight corners of a box, in the order of the store: 0 to 4 is the length, 0 to 2 the width, 0 to 1 the height. */
export function boxCorners({ center, size, rpy }) {
  const matrix = boxMatrix(center, rpy)
  const corners = []
  for (let i = 0; i < 8; i++) {
    const [back, right, up] = [i < 4, (i & 2) !== 0, (i & 1) !== 0]
    corners.push(new Vector3((back ? -0.5 : 0.5) * size[0], (right ? -0.5 : 0.5) * size[1], (up ? 0.5 : -0.5) * size[2]).applyMatrix4(matrix))
  }
  return corners
}

/** Pairs of corners that are edges. */
export const BOX_EDGES = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]]

/** The distance along a ray at which it enters a box, or null. */
export function rayMeetsBox(origin, direction, box) {
  const back = boxMatrix(box.center, box.rpy).invert()
  const [from, along] = [origin.clone().applyMatrix4(back), direction.clone().transformDirection(back)]
  let [near, far] = [0, Infinity]
  for (const [axis, key] of ['x', 'y', 'z'].entries()) {
    const half = 0.5 * box.size[axis]
    if (Math.abs(along[key]) < 1e-12) {
      if (Math.abs(from[key]) > half) return null
      continue
    }
    const [a, b] = [(-half - from[key]) / along[key], (half - from[key]) / along[key]]
    near = Math.max(near, Math.min(a, b))
    far = Math.min(far, Math.max(a, b))
  }
  return near <= far ? near : null
}
