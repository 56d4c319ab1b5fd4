// Time: plays at a speed, waits for frames that are not there yet.

/** Longer pauses between two looks at the clock are not caught up with, s. */
const MAX_STEP_S = 0.25

export class Player {
  /** `isReady(frame)` says whether a frame may be shown; `show(frame)` shows it. */
  constructor({ periodS, isReady, show }) {
    Object.assign(this, { periodS, isReady, show })
    this.isPlaying = false
    this.speed = 1
    this.isWaiting = false
    this.owed = 0
  }

  toggle(isPlaying = !this.isPlaying) {
    this.isPlaying = isPlaying
    this.owed = 0
    this.isWaiting = false
  }

  /** The clock has gone on by some seconds; `frame` of `frames` is on the screen. */
  step(seconds, frame, frames) {
    if (!this.isPlaying || frames < 2) return
    this.owed = Math.min(this.owed + Math.min(seconds, MAX_STEP_S) * this.speed / this.periodS, 4)
    if (this.owed < 1) return
    const ahead = Math.min(Math.floor(this.owed), 4)
    // The farthest frame that is there: where decoding cannot keep up, frames are left out only if later ones are ready.
    for (let step = ahead; step > 0; step--) {
      const next = (frame + step) % frames
      if (!this.isReady(next)) continue
      this.owed -= step
      this.isWaiting = false
      this.show(next)
      return
    }
    this.isWaiting = true
  }
}
