// The 3-D view: one three.js scene, drawn only when something has changed.

import { Color, ColorManagement, GridHelper, Group, LinearSRGBColorSpace, PerspectiveCamera, Raycaster, Scene as Graph, Vector2, WebGLRenderer } from 'three'
import { agentColor, bytesOf, idColor, readable } from '../colors.js'
import { poseMatrix, rayMeetsBox } from '../geometry.js'
import { BoxLines } from './boxes.js'
import { Detail } from './detail.js'
import { Links } from './links.js'
import { TrackLines, mapLines } from './lines.js'
import { Measure, placeUnder } from './measure.js'
import { Navigation } from './navigation.js'
import { Overlay } from './overlay.js'
import { COLORINGS, PointCloud, PointStyle } from './points.js'
import { VoxelFaces } from './voxels.js'

// Colours go to the screen as they are given.
ColorManagement.enabled = false

const THEMES = {
  dark: { ground: '#0f1319', grid: '#232a35', label: 'rgb(15 19 25 / 82%)', text: '#e8ebef' },
  light: { ground: '#f4f5f7', grid: '#dcdfe5', label: 'rgb(255 255 255 / 88%)', text: '#1c2128' },
}
const GRID_M = 400
const CELL_M = 10

export class View3d {
  constructor(host, tags, changed) {
    this.host = host
    this.isSoftware = drawsInSoftware()
    this.renderer = new WebGLRenderer({ antialias: !this.isSoftware, powerPreference: 'high-performance' })
    this.detail = new Detail(this.renderer.getContext())
    this.renderer.outputColorSpace = LinearSRGBColorSpace
    const canvas = this.renderer.domElement
    canvas.setAttribute('aria-label', '3-D view of the scene')
    canvas.setAttribute('role', 'img')
    const labels = document.createElement('canvas')
    labels.className = 'overlay'
    labels.setAttribute('aria-hidden', 'true')
    host.append(canvas, labels)
    this.overlay = new Overlay(labels)
    this.graph = new Graph()
    this.camera = new PerspectiveCamera(55, 1, 0.3, 4000)
    this.camera.up.set(0, 0, 1)
    this.camera.position.set(-30, 0, 20)
    this.navigation = new Navigation(this.camera, canvas, changed)
    this.style = new PointStyle(tags)
    this.boxes = new BoxLines({ hasThin: this.isSoftware })
    this.predicted = new BoxLines({ dashed: true, hasThin: this.isSoftware })
    this.links = new Links()
    this.measure = new Measure()
    this.tracks = new TrackLines()
    this.voxels = new VoxelFaces(this.style)
    this.clouds = new Map()
    this.static = new Group()
    this.graph.add(...this.boxes.objects, ...this.predicted.objects, ...this.links.objects, this.tracks.object, this.voxels.object, this.static)
    this.labelList = []
    /** What is recorded, if anything is. */
    this.film = null
    this.setTheme(true)
  }

  setTheme(isDark) {
    this.isDark = isDark
    this.theme = isDark ? THEMES.dark : THEMES.light
    this.graph.background = new Color(this.theme.ground)
    this.style.setTheme(isDark)
    if (this.grid) {
      this.grid.removeFromParent()
      this.grid.dispose()
    }
    this.grid = new GridHelper(GRID_M, GRID_M / CELL_M, this.theme.grid, this.theme.grid)
    this.grid.rotation.x = Math.PI / 2
    this.graph.add(this.grid)
    this.drawMap()
  }

  /** Forgets the scene before. */
  clear() {
    for (const cloud of this.clouds.values()) cloud.dispose()
    this.clouds.clear()
    this.voxels.hide()
    for (const boxes of [this.boxes, this.predicted]) boxes.show([], () => [0, 0, 0], null)
    this.links.show([], [], null)
    this.tracks.set([], () => [0, 0, 0])
    this.elements = null
    this.drawMap()
    this.navigation.anchor = null
  }

  setMap(elements) {
    this.elements = elements
    this.drawMap()
  }

  drawMap() {
    for (const old of [...this.static.children]) {
      old.geometry.dispose()
      old.material.dispose()
      old.removeFromParent()
    }
    if (this.elements) this.static.add(mapLines(this.elements, this.isDark))
  }

  setTracks(tracks, colorOf) {
    this.tracks.set(tracks, colorOf)
  }

  /** Points of an agent, each sensor one cloud: `readings` are `{reading, about}`. */
  setPoints(agent, index, { matrix: worldFromAgent, velocity }, readings) {
    readings.forEach(({ reading, about }, i) => {
      const key = `${agent}/${i}`
      let cloud = this.clouds.get(key)
      if (!cloud) {
        this.clouds.set(key, cloud = new PointCloud(this.style, agentColor(index)))
        this.graph.add(cloud.object)
      }
      const { translation, quaternion } = about.agent_from_sensor
      cloud.show(reading, worldFromAgent.clone().multiply(poseMatrix(translation, quaternion)), velocity)
    })
    this.hidePoints(agent, readings.length)
  }

  hidePoints(agent, from = 0) {
    for (const [key, cloud] of this.clouds) {
      const cut = key.lastIndexOf('/')
      if (key.slice(0, cut) === agent && Number(key.slice(cut + 1)) >= from) cloud.hide()
    }
  }

  /** Everything that follows from choices and the frame, points and voxels apart. */
  update({ coloring, pointSize, layers, frame, groundZ, place, boxes, colorOf, chosen, labels, links, pairs, ring }) {
    const { shared } = this.style
    this.setColoring(coloring)
    shared.size.value = pointSize * this.renderer.getPixelRatio()
    shared.heights.value.set(groundZ - 1, groundZ + 7)
    this.grid.visible = layers.has('grid')
    this.grid.position.set(Math.round(place.x / CELL_M) * CELL_M, Math.round(place.y / CELL_M) * CELL_M, groundZ - 0.05)
    this.static.visible = layers.has('map')
    this.tracks.object.visible = layers.has('tracks')
    this.tracks.setFrame(frame)
    this.shownBoxes = boxes
    this.boxes.show(boxes.filter(b => !b.isPrediction), colorOf, chosen)
    this.predicted.show(boxes.filter(b => b.isPrediction), colorOf, chosen)
    this.groundZ = groundZ
    const { text } = this.theme
    this.links.show(links, pairs, ring, this.measure.line(bytesOf(text)))
    this.labelList = [...this.measure.labels(text), ...labels]
  }

  /** A click while measuring. */
  measureAt(clientX, clientY) {
    const area = this.renderer.domElement.getBoundingClientRect()
    this.measure.click(placeUnder({ camera: this.camera, area, clientX, clientY, clouds: this.clouds.values(), groundZ: this.groundZ }))
  }

  setColoring(coloring) {
    this.style.shared.coloring.value = COLORINGS.indexOf(coloring)
  }

  /** The box under a place on the screen, or null. */
  pick(clientX, clientY) {
    const area = this.renderer.domElement.getBoundingClientRect()
    const at = new Vector2((clientX - area.left) / area.width * 2 - 1, 1 - (clientY - area.top) / area.height * 2)
    const caster = new Raycaster()
    caster.setFromCamera(at, this.camera)
    let best = null
    for (const box of this.shownBoxes ?? []) {
      const distance = rayMeetsBox(caster.ray.origin, caster.ray.direction, box)
      if (distance !== null && (!best || distance < best.distance)) best = { distance, box }
    }
    return best?.box ?? null
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.host
    if (!width || !height) return false
    const ratio = this.isSoftware ? 1 : Math.min(devicePixelRatio, 2)
    this.renderer.setPixelRatio(ratio)
    this.renderer.setSize(width, height)
    this.overlay.resize(width, height, ratio)
    for (const lines of [this.boxes, this.predicted, this.links]) lines.setSize(width, height)
    this.camera.aspect = width / height
    this.camera.updateProjectionMatrix()
    return true
  }

  /** The picture on the screen with its labels, as PNG. */
  picture() {
    this.render()
    const { domElement } = this.renderer
    const canvas = Object.assign(document.createElement('canvas'), { width: domElement.width, height: domElement.height })
    const context = canvas.getContext('2d')
    context.drawImage(domElement, 0, 0)
    context.drawImage(this.overlay.canvas, 0, 0, canvas.width, canvas.height)
    return new Promise(resolve => canvas.toBlob(resolve, 'image/png'))
  }

  /** Draws what has changed, or what was left out of a moving picture; whether it did. */
  tick(now, isDirty, isPlaying) {
    const next = this.detail.next(now, isDirty, isPlaying)
    if (!next) return false
    const isThin = this.isSoftware && !next.isStill
    this.render(next.share, isThin)
    this.detail.drawn(now, next.share, next.share === 1 && !isThin)
    return true
  }

  /** Draws now, with a share of the points, and with boxes of thin lines or as they are. */
  render(share = 1, isThin = false) {
    for (const cloud of this.clouds.values()) cloud.draw(share)
    for (const boxes of [this.boxes, this.predicted]) boxes.setThin(isThin)
    this.renderer.render(this.graph, this.camera)
    this.overlay.draw(this.camera, this.navigation.controls.target, this.labelList, this.theme)
    this.film?.take(this.renderer.domElement, this.overlay.canvas)
  }
}

/** Whether the browser has no graphics card to draw with. */
function drawsInSoftware() {
  const context = document.createElement('canvas').getContext('webgl2')
  const names = context?.getExtension('WEBGL_debug_renderer_info')
  const name = context?.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER) ?? ''
  context?.getExtension('WEBGL_lose_context')?.loseContext()
  return /swiftshader|llvmpipe|softpipe|basic render/i.test(name)
}

/** Colour of a box by the chosen rule. */
export function boxColor(rule, classColor, agents, isDark) {
  if (rule === 'id') return box => idColor(box.id)
  if (rule === 'agent') {
    const colors = new Map(agents.map((agent, i) => [agent.name, bytesOf(agentColor(i))]))
    const own = new Map(agents.map((agent, i) => [agent.id, bytesOf(agentColor(i))]))
    return box => own.get(box.id) ?? (box.seenBy.length === 1 ? colors.get(box.seenBy[0]) : box.seenBy.length ? [150, 158, 170] : [90, 96, 106])
  }
  return box => readable(classColor(box.class), isDark)
}

