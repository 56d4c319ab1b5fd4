// The order in which the points of a reading are drawn.

const EVERY = 32

/** Numbers from 0 to `count` - 1 in an order in which each part at the front is spread evenly over all of them. */
export function spread(count) {
  const order = new Uint32Array(count)
  let next = 0
  for (let turn = 0; turn < EVERY; turn++) {
    // The five bits of a turn, the last one first: 0, 16, 8, 24, 4, ...
    let first = 0
    for (let bit = 0; bit < 5; bit++) first |= ((turn >> bit) & 1) << (4 - bit)
    for (let i = first; i < count; i += EVERY) order[next++] = i
  }
  return order
}
