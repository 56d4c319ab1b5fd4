// Tools over the view: a search by id, measuring, saving a picture.

import { Film, canFilm } from './film.js'
import { $, make, note } from './ui.js'

/** Saves a file. */
function download(blob, name) {
  const url = URL.createObjectURL(blob)
  make('a', { href: url, download: name }).click()
  setTimeout(() => URL.revokeObjectURL(url), 10_000)
}

export class Tools {
  constructor(app, panels) {
    Object.assign(this, { app, panels })
    $('measure').addEventListener('click', () => this.measure())
    $('picture').addEventListener('click', () => this.savePicture())
    $('film').hidden = !canFilm()
    $('film').addEventListener('click', () => this.toggleFilm())
    $('search').addEventListener('submit', e => {
      e.preventDefault()
      this.search($('search-id').value.trim())
    })
  }

  /** Measuring begins or ends. */
  measure(isOn) {
    const { app } = this
    app.view.measure.toggle(isOn)
    $('measure').setAttribute('aria-pressed', app.view.measure.isOn)
    $('view-3d').classList.toggle('measures', app.view.measure.isOn)
    app.update()
  }

  /** Chooses an object by its id, at the nearest frame that has it. */
  search(text) {
    const { app } = this
    if (!/^\d{1,5}$/.test(text)) return app.setNote('search', note('', 'An id is a number of up to five digits.'))
    const id = Number(text)
    const frame = app.scene.tables.frameOf(id, app.frame)
    if (frame === null) return app.setNote('search', note('', `No list of this scene has object ${id}.`))
    app.setNote('search', null)
    if (frame !== app.scene.tables.boxFrame(app.frame)) app.setFrame(frame)
    const box = app.scene.tables.boxesAt(app.frame).find(b => b.id === id)
    this.panels.choose(box)
    app.view.navigation.lookAt(box.center)
  }

  /** Saves what the 3-D view shows, the first camera's picture, or the BEV. */
  async savePicture() {
    const { app } = this
    const { view } = app.choices
    const canvas = view === 'bev' ? app.bev.canvas : [...app.grid.pictures.values()][0]?.element.canvas
    const blob = view === '3d' ? await app.view.picture() : await new Promise(done => canvas ? canvas.toBlob(done, 'image/png') : done(null))
    if (!blob) return
    download(blob, `${this.fileName()}-${view}.png`)
  }

  fileName() {
    const { app } = this
    return `convoy-${app.scene.folder}-${String(this.panels.first + app.frame).padStart(4, '0')}`
  }

  /** Records the 3-D view while it plays, until the button is pressed again, another view is chosen, or the scene ends. */
  toggleFilm() {
    const { app, panels } = this
    const { view } = app
    if (view.film) return this.endFilm()
    this.filmName = `${this.fileName()}.webm`
    view.film = new Film(view.renderer.domElement)
    $('film').setAttribute('aria-pressed', true)
    app.isDirty = true
    if (!app.player.isPlaying) panels.play(true)
  }

  async endFilm() {
    const { app, panels } = this
    const { film } = app.view
    if (!film) return
    app.view.film = null
    $('film').setAttribute('aria-pressed', false)
    if (app.player.isPlaying) panels.play(false)
    try {
      download(await film.end(), this.filmName)
      app.setNote('film', null)
    } catch (error) {
      app.fail('film', error)
    }
  }
}
