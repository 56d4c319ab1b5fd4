// How the view moves: around an agent, behind it, from above, or flying free.

import { MathUtils, Vector3 } from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { yawOf } from '../geometry.js'

export const MODES = ['follow', 'chase', 'top', 'fly']
const FLY_KEYS = { KeyW: [1, 0, 0], KeyS: [-1, 0, 0], KeyA: [0, 1, 0], KeyD: [0, -1, 0], KeyQ: [0, 0, -1], KeyE: [0, 0, 1] }
const FLY_MPS = 25

export class Navigation {
  constructor(camera, element, changed) {
    Object.assign(this, { camera, changed })
    this.controls = new OrbitControls(camera, element)
    this.controls.enableDamping = false
    this.controls.maxDistance = 1500
    this.controls.minDistance = 1
    this.controls.screenSpacePanning = false
    this.controls.addEventListener('change', changed)
    this.mode = 'follow'
    this.anchor = null
    this.held = new Set()
  }

  /** The agent has moved: what hangs on it moves along. */
  anchorAt(matrix) {
    const place = new Vector3().setFromMatrixPosition(matrix)
    const yaw = yawOf(matrix)
    if (!this.anchor) {
      this.anchor = { place, yaw }
      this.home()
      return
    }
    const moved = place.clone().sub(this.anchor.place)
    const turned = this.mode === 'chase' ? MathUtils.euclideanModulo(yaw - this.anchor.yaw + Math.PI, 2 * Math.PI) - Math.PI : 0
    this.anchor = { place, yaw }
    if (this.mode === 'fly') return
    const { target } = this.controls
    target.add(moved)
    this.camera.position.add(moved)
    if (turned) {
      const up = new Vector3(0, 0, 1)
      this.camera.position.sub(place).applyAxisAngle(up, turned).add(place)
      target.sub(place).applyAxisAngle(up, turned).add(place)
    }
    this.controls.update()
  }

  setMode(mode) {
    const was = this.mode
    this.mode = mode
    if (!this.anchor) return
    if (mode === 'fly') {
      // Turn about a point close ahead, as a head does.
      const ahead = this.controls.target.clone().sub(this.camera.position).setLength(8)
      this.controls.target.copy(this.camera.position).add(ahead)
      this.controls.update()
    } else if (mode !== was) {
      this.home()
    }
  }

  /** The mode's own view of the agent. */
  home() {
    const { place, yaw } = this.anchor
    const back = (distance, height) => new Vector3(-distance * Math.cos(yaw), -distance * Math.sin(yaw), height)
    const look = { chase: back(14, 6), top: back(0.5, 95), follow: back(34, 24), fly: back(34, 24) }[this.mode]
    const ahead = this.mode === 'chase' ? back(-8, 1) : new Vector3(0, 0, 0.5)
    this.controls.target.copy(place).add(ahead)
    this.camera.position.copy(place).add(look)
    this.controls.update()
    this.changed()
  }

  key(code, isDown) {
    if (!FLY_KEYS[code] || this.mode !== 'fly') return false
    if (isDown) this.held.add(code)
    else this.held.delete(code)
    this.changed()
    return true
  }

  release() {
    this.held.clear()
  }

  /** Moves by held keys; true while it does. */
  step(seconds, isFast) {
    if (!this.held.size || this.mode !== 'fly') return false
    const ahead = this.controls.target.clone().sub(this.camera.position).normalize()
    const left = new Vector3(0, 0, 1).cross(ahead).normalize()
    const move = new Vector3()
    for (const code of this.held) {
      const [forward, sideways, up] = FLY_KEYS[code]
      move.addScaledVector(ahead, forward).addScaledVector(left, sideways).add(new Vector3(0, 0, up))
    }
    move.setLength(FLY_MPS * (isFast ? 3 : 1) * Math.min(seconds, 0.1))
    if (!Number.isFinite(move.x)) return true
    this.camera.position.add(move)
    this.controls.target.add(move)
    this.controls.update()
    return true
  }

  /** Turns to a place and stays as far from it as from what was looked at before, 60 m at most. */
  lookAt(place) {
    const { target } = this.controls
    const back = this.camera.position.clone().sub(target).clampLength(8, 60)
    target.set(...place)
    this.camera.position.copy(target).add(back)
    this.controls.update()
    this.changed()
  }

  /** Where the view stands, for links: camera and target relative to the scene's origin, m. */
  get pose() {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()].map(v => Math.round(v * 10) / 10)
  }

  set pose(values) {
    this.camera.position.fromArray(values)
    this.controls.target.fromArray(values, 3)
    this.controls.update()
  }
}
