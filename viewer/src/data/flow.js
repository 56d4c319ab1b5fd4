// Optical flow as a few arrows: the mean of each cell of pixels.

/** A 16-bit float of IEEE 754 from its two bytes, lowest first. */
export function half(bytes) {
  const bits = bytes[0] | bytes[1] << 8
  const [sign, exponent, fraction] = [bits >> 15 ? -1 : 1, bits >> 10 & 31, bits & 1023]
  if (exponent === 31) return fraction ? NaN : sign * Infinity
  return sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction)
}

/**
 * Arrows of cells of `cell` pixels a side: u, v of the cell's middle and its motion to the right and down in a frame, pixels, four
 * numbers each. `dx` and `dy` are motions to the right and up, row by row, in units of which a picture is two wide and two high.
 */
export function flowArrows({ dx, dy, width, height, cell }) {
  const [across, down] = [Math.floor(width / cell), Math.floor(height / cell)]
  const arrows = new Float32Array(4 * across * down)
  for (let row = 0; row < down; row++) {
    for (let column = 0; column < across; column++) {
      let [x, y] = [0, 0]
      for (let v = row * cell; v < (row + 1) * cell; v++) {
        for (let u = column * cell, at = v * width + u; u < (column + 1) * cell; u++, at++) {
          x += dx[at]
          y += dy[at]
        }
      }
      const pixels = cell * cell
      arrows.set([(column + 0.5) * cell, (row + 0.5) * cell, x / pixels * width / 2, -y / pixels * height / 2], 4 * (row * across + column))
    }
  }
  return arrows
}
