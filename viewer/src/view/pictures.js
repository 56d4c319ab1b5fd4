// Pictures of cameras with what is drawn over them: masks, boxes of the scene and of the picture, ids.

import { Vector3 } from 'three'
import { css, idColor } from '../colors.js'
import { BOX_EDGES, boxCorners, boxMatrix, poseMatrix } from '../geometry.js'
import { edgeInPicture, projector } from '../lens.js'
import { boxName } from '../ui.js'

/** Boxes farther away than this are not drawn into pictures, m. */
export const FAR_M = 120
/** Farther away than this a box is too short to reach the camera, m. */
const NEAR_M = 15
/** Arrows of flow beside one another, and the shortest that is drawn, pixels of the picture. */
const FLOW_ACROSS = 40
const FLOW_LEAST_PX = 0.5
const FLOW_COLOR = '#ffd84d'
/** What is made of the pixels of each kind of image. */
export const SHOWN_AS = { RGB: 'plain', SEG: 'plain', IST: 'instance', DPT: 'depth' }

export function pictureElement(label) {
  const figure = document.createElement('figure')
  figure.className = 'picture'
  const canvas = document.createElement('canvas')
  canvas.width = 16
  canvas.height = 9
  const caption = document.createElement('figcaption')
  caption.textContent = label
  const message = document.createElement('div')
  message.className = 'message'
  figure.append(canvas, caption, message)
  return { figure, canvas, caption, message }
}

/** Draws a camera's picture at most `width` wide. Gives false where it has been overtaken by another frame. */
export async function drawCamera(element, { scene, agent, kind, camera, frame, width, marks, boxes, colorOf, classColor, chosen, isCurrent }) {
  const { canvas, message } = element
  try {
    const about = await scene.sensor(agent.name, `${kind}-${camera}`)
    const wanted = [scene.imageRequest(agent.name, kind, camera, frame, SHOWN_AS[kind], width)]
    const withMask = marks.has('masks') && kind !== 'IST' && scene.has(`sensors/${agent.name}/IST-${camera}.parquet`)
    if (withMask) wanted.push(scene.imageRequest(agent.name, 'IST', camera, frame, 'mask', width))
    const requests = await Promise.all(wanted)
    const [image, mask] = await Promise.all(requests.map(request => scene.cache.get(request)))
    const flow = marks.has('flow') ? await flowOf(scene, agent.name, camera, frame) : null
    const inPicture = marks.has('boxes2d') ? await boxesInPicture(scene, agent.name, camera, frame - frame % (about.every_n_frames ?? 1)) : []
    if (!isCurrent()) return false
    message.textContent = ''
    const { picture } = image
    if (canvas.width !== picture.width || canvas.height !== picture.height) Object.assign(canvas, { width: picture.width, height: picture.height })
    const context = canvas.getContext('2d')
    context.setTransform(1, 0, 0, 1, 0, 0)
    context.drawImage(picture, 0, 0)
    if (mask) context.drawImage(mask.picture, 0, 0)
    const scale = picture.width / image.width
    context.setTransform(scale, 0, 0, scale, 0, 0)
    context.lineJoin = 'round'
    // A pixel of the screen in the picture's own.
    const unit = image.width / (canvas.clientWidth || picture.width)
    if (flow) drawFlow(context, flow, unit)
    if (marks.has('boxes')) drawBoxes(context, { scene, agent, about, frame, boxes, colorOf, chosen, unit, withNames: marks.has('names') })
    for (const box of inPicture) {
      context.lineWidth = 1.5 * unit
      context.setLineDash([])
      context.strokeStyle = css(marks.has('masks') ? idColor(box.id) : classColor(box.class))
      const [l, t, r, b] = box.visible
      context.strokeRect(l, t, r - l, b - t)
      if (marks.has('names') && !marks.has('boxes')) name(context, `${box.class.replaceAll('_', ' ')} ${box.id}`, l, t, unit)
    }
    return true
  } catch (error) {
    if (error.name !== 'AbortError' && isCurrent()) message.textContent = error.message
    return false
  }
}

function drawBoxes(context, { scene, agent, about, frame, boxes, colorOf, chosen, unit, withNames }) {
  const { translation, quaternion } = about.agent_from_sensor
  const pose = scene.tables.poseAt(agent, frame).matrix
  const cameraFromWorld = pose.clone().multiply(poseMatrix(translation, quaternion)).invert()
  const eye = new Vector3().setFromMatrixPosition(cameraFromWorld.clone().invert())
  const project = projector(about)
  const model = about.lens?.model ?? 'pinhole'
  const rule = { isStraight: model === 'pinhole', behindIsSeen: model === 'fisheye' }
  const seen = []
  for (const box of boxes) {
    if (box.id === agent.id) continue
    const corners = boxCorners(box).map(corner => corner.applyMatrix4(cameraFromWorld))
    const middle = corners[0].clone().add(corners[7]).multiplyScalar(0.5)
    const distance = middle.length()
    if (distance > FAR_M || (!rule.behindIsSeen && corners.every(c => c.z < 0.1))) continue
    if (distance < NEAR_M && isInside(eye, box)) continue
    seen.push({ box, corners, distance })
  }
  seen.sort((a, b) => b.distance - a.distance)
  for (const { box, corners } of seen) {
    const isChosen = box.id === chosen
    context.strokeStyle = css(colorOf(box))
    context.setLineDash(box.isPrediction ? [6 * unit, 4 * unit] : [])
    context.lineWidth = (isChosen ? 3.5 : 1.6) * unit
    context.beginPath()
    let top = null
    const add = (a, b) => {
      for (const line of edgeInPicture(project, a, b, rule)) {
        line.forEach(([u, v], i) => {
          if (!top || v < top[1]) top = [u, v]
          if (i) context.lineTo(u, v)
          else context.moveTo(u, v)
        })
      }
    }
    for (const [a, b] of BOX_EDGES) add(corners[a], corners[b])
    // A cross on the front face.
    add(corners[4], corners[7])
    add(corners[5], corners[6])
    context.stroke()
    if (top && (withNames || isChosen)) name(context, boxName(box), top[0], top[1], unit)
  }
}

/** Whether a camera stands in a box, or on it: then that is its own vehicle, as somebody predicted it. */
function isInside(eye, box) {
  const at = eye.clone().applyMatrix4(boxMatrix(box.center, box.rpy).invert())
  return [at.x, at.y, at.z].every((v, i) => Math.abs(v) < 0.5 * box.size[i] + 0.5)
}

function name(context, text, u, v, unit) {
  context.font = `${12 * unit}px system-ui, sans-serif`
  const wide = context.measureText(text).width
  context.fillStyle = 'rgb(12 15 20 / 72%)'
  context.fillRect(u - 3 * unit, v - 17 * unit, wide + 6 * unit, 16 * unit)
  context.fillStyle = '#fff'
  context.textBaseline = 'middle'
  context.fillText(text, u, v - 8.5 * unit)
}

/** Arrows of the flow that is at hand, or null. */
async function flowOf(scene, agent, camera, frame) {
  if (!scene.has(`sensors/${agent}/FLW-${camera}.parquet`)) return null
  return (await scene.cache.get(await scene.flowRequest(agent, camera, frame, FLOW_ACROSS))).arrows
}

/** Lines from where what is seen was a frame ago, with a dot where it is. */
function drawFlow(context, arrows, unit) {
  context.setLineDash([])
  context.lineWidth = 1.4 * unit
  context.strokeStyle = context.fillStyle = FLOW_COLOR
  context.beginPath()
  for (let i = 0; i < arrows.length; i += 4) {
    const [u, v, du, dv] = arrows.subarray(i, i + 4)
    if (!(Math.hypot(du, dv) > FLOW_LEAST_PX)) continue
    context.moveTo(u - du, v - dv)
    context.lineTo(u, v)
    context.fillRect(u - 1.5 * unit, v - 1.5 * unit, 3 * unit, 3 * unit)
  }
  context.stroke()
}

async function boxesInPicture(scene, agent, camera, frame) {
  const path = `sensors/${agent}/boxes_2d.parquet`
  if (!scene.has(path)) return []
  const columns = ['frame', 'camera', 'id', 'class', 'visible_px']
  const { columns: c, rows } = await scene.cache.get({ kind: 'table', ...scene.file(path), columns })
  const found = []
  for (let row = 0; row < rows; row++) {
    if (c.frame.values[row] !== frame || c.camera.values[row] !== camera) continue
    found.push({ id: c.id.values[row], class: c.class.values[row], visible: c.visible_px.values.subarray(4 * row, 4 * row + 4) })
  }
  return found
}

/** Draws an agent's BEV masks, on request with boxes over them. */
export async function drawBev(element, { scene, agent, frame, hidden, boxes, colorOf, withBoxes, theme, isCurrent }) {
  const { canvas, message } = element
  try {
    const request = await scene.bevRequest(agent.name, frame, hidden)
    const about = await scene.archive(request.path.slice(`scenes/${scene.folder}/`.length))
    const masks = await scene.cache.get(request)
    if (!isCurrent()) return null
    message.textContent = ''
    const side = Math.max(320, Math.round(canvas.clientWidth * Math.min(devicePixelRatio, 2)))
    Object.assign(canvas, { width: side, height: side })
    const context = canvas.getContext('2d')
    context.fillStyle = theme.bev
    context.fillRect(0, 0, side, side)
    context.imageSmoothingEnabled = false
    context.drawImage(masks.picture, 0, 0, side, side)
    const pixelsPerMeter = side / (masks.rows * about.cell_m)
    const pose = scene.tables.poseAt(agent, frame).matrix
    if (withBoxes) bevBoxes(context, { pose, boxes, colorOf, side, pixelsPerMeter, text: theme.text })
    bevAgent(context, side, pixelsPerMeter, theme)
    return { masks, about }
  } catch (error) {
    if (error.name !== 'AbortError' && isCurrent()) message.textContent = error.message
    return null
  }
}

function bevBoxes(context, { pose, boxes, colorOf, side, pixelsPerMeter, text }) {
  // The masks turn with the agent's yaw only.
  const e = pose.elements
  const yaw = Math.atan2(e[1], e[0])
  const [sin, cos] = [Math.sin(yaw), Math.cos(yaw)]
  const width = Math.max(1, side / 700)
  for (const box of boxes) {
    // Masks have the classes' colours already: boxes are coloured only where something else is asked.
    context.strokeStyle = colorOf ? css(colorOf(box)) : text
    context.lineWidth = colorOf ? 2 * width : width
    context.setLineDash(box.isPrediction ? [5 * width, 3 * width] : [])
    const corners = boxCorners(box)
    context.beginPath()
    for (const [i, corner] of [0, 2, 6, 4].entries()) {
      const [dx, dy] = [corners[corner].x - e[12], corners[corner].y - e[13]]
      const [x, y] = [cos * dx + sin * dy, -sin * dx + cos * dy]
      const [u, v] = [side / 2 - y * pixelsPerMeter, side / 2 - x * pixelsPerMeter]
      if (i) context.lineTo(u, v)
      else context.moveTo(u, v)
    }
    context.closePath()
    context.stroke()
  }
  context.setLineDash([])
}

/** The agent in the middle, and a scale. */
function bevAgent(context, side, pixelsPerMeter, theme) {
  const [c, s] = [side / 2, Math.max(5, side / 80)]
  context.fillStyle = theme.text
  context.strokeStyle = theme.bev
  context.lineWidth = 1.5
  context.beginPath()
  context.moveTo(c, c - 1.3 * s)
  context.lineTo(c + 0.8 * s, c + s)
  context.lineTo(c, c + 0.55 * s)
  context.lineTo(c - 0.8 * s, c + s)
  context.closePath()
  context.fill()
  context.stroke()
  const length = side > 500 ? 20 : 50
  const wide = length * pixelsPerMeter
  const unit = Math.min(devicePixelRatio, 2)
  const [x, y] = [12 * unit, side - 12 * unit]
  context.font = `600 ${12 * unit}px system-ui, sans-serif`
  context.textBaseline = 'alphabetic'
  const label = `${length} m`
  context.fillStyle = theme.plate
  context.fillRect(x - 5 * unit, y - 23 * unit, Math.max(wide, 34 * unit) + 10 * unit, 29 * unit)
  context.fillStyle = context.strokeStyle = theme.text
  context.lineWidth = 2 * unit
  context.beginPath()
  context.moveTo(x, y)
  context.lineTo(x + wide, y)
  context.stroke()
  context.fillText(label, x, y - 7 * unit)
}
