// Voxel grids for looking at: only the faces that meet free space, of cells that may be merged ones.

import { pieces } from './npz.js'

/** Neighbours above, ahead, behind, left and right: undersides are not drawn. */
const SIDES = [[0, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]

/**
 * The outside faces of a frame's grid.
 *
 * `merge` cells along each axis become one, with the tag of the last occupied one in C order (the highest of its column); `reach` is how many
 * cells from the middle along x and y count. Gives `cells` (u16: place along x, y, z of the merged grid, tag + 256 times the side's number)
 * and the merged grid's `shape` and `first` cell.
 */
export async function voxelFaces(archive, { frame, merge, reach, limit, grid }) {
  const { shape, type, bytes, reader } = await archive.open(frame)
  const isSparse = shape.length === 2
  const full = isSparse ? grid : shape
  const first = [0, 1].map(axis => Math.max(0, Math.floor(full[axis] / 2) - reach))
  const past = [0, 1].map(axis => Math.min(full[axis], Math.ceil(full[axis] / 2) + reach))
  const size = [...[0, 1].map(axis => Math.ceil((past[axis] - first[axis]) / merge)), Math.ceil(full[2] / merge)]
  const tags = new Uint8Array(size[0] * size[1] * size[2])
  const put = (x, y, z, tag) => {
    if (x < first[0] || x >= past[0] || y < first[1] || y >= past[1]) return
    tags[(Math.floor((x - first[0]) / merge) * size[1] + Math.floor((y - first[1]) / merge)) * size[2] + Math.floor(z / merge)] = tag
  }
  if (isSparse) await scatterCells(pieces(bytes, reader), type, put)
  else await scatterGrid(pieces(bytes, reader), full, put)
  return { ...facesOf(tags, size, limit), shape: size, first: [...first, 0], merge }
}

async function scatterGrid(parts, [, across, up], put) {
  let at = 0
  for await (const part of parts) {
    // Most of a grid is free: four cells are looked at at once.
    const words = part.byteOffset % 4 ? null : new Uint32Array(part.buffer, part.byteOffset, part.length >> 2)
    for (let i = 0; i < part.length; i++) {
      if (words && i % 4 === 0) {
        let word = i >> 2
        while (word < words.length && words[word] === 0) word++
        i = word << 2
        if (i >= part.length) break
      }
      if (part[i] === 0) continue
      const cell = at + i
      const column = Math.floor(cell / up)
      put(Math.floor(column / across), column % across, cell - column * up, part[i])
    }
    at += part.length
  }
}

async function scatterCells(parts, type, put) {
  if (type !== '<u2') throw new Error(`cells of type ${type}`)
  let rest = new Uint8Array(0)
  for await (const part of parts) {
    const bytes = new Uint8Array(rest.length + part.length)
    bytes.set(rest)
    bytes.set(part, rest.length)
    const rows = Math.floor(bytes.length / 8)
    const values = new Uint16Array(bytes.buffer, 0, 4 * rows)
    for (let i = 0; i < values.length; i += 4) put(values[i], values[i + 1], values[i + 2], values[i + 3])
    rest = bytes.subarray(8 * rows)
  }
}

function facesOf(tags, [nx, ny, nz], limit) {
  let cells = new Uint16Array(4 * 65536)
  let count = 0
  let isCut = false
  let present = 0
  for (let x = 0, at = 0; x < nx; x++) {
    for (let y = 0; y < ny; y++) {
      for (let z = 0; z < nz; z++, at++) {
        const tag = tags[at]
        if (!tag) continue
        present |= 1 << tag
        for (let side = 0; side < SIDES.length; side++) {
          const [dx, dy, dz] = SIDES[side]
          const [i, j, k] = [x + dx, y + dy, z + dz]
          const inside = i >= 0 && i < nx && j >= 0 && j < ny && k < nz
          if (inside && tags[(i * ny + j) * nz + k]) continue
          // Nothing is known beyond the grid: no wall is drawn around it.
          if (!inside && dz === 0) continue
          if (count === limit) {
            isCut = true
            continue
          }
          if (4 * count === cells.length) {
            const more = new Uint16Array(2 * cells.length)
            more.set(cells)
            cells = more
          }
          cells.set([x, y, z, tag | side << 8], 4 * count++)
        }
      }
    }
  }
  return { cells: cells.slice(0, 4 * count), count, isCut, tags: present >>> 0 }
}
