// What is said of a scene that is not finished, or not of one piece.

import { remedy } from './data/store.js'
import { make, note } from './ui.js'

const code = text => make('code', { textContent: text })

/** What has not been made of a scene, and what makes it. */
export function unmade(scene, missing) {
  if (!scene.info.imported) return note('', 'Not made yet: ', code(missing.join(', ')), '. ', code('make dataset'), ' makes what is missing.')
  const { command } = remedy(scene, 'tracks.parquet')
  const parts = command ? ['Tracks are not merged yet. Run ', code(command)] : ['The dataset that was imported is not post-processed: nobody counted what agents see of boxes, and there are no tracks. ']
  const rest = missing.filter(stage => !['postprocess-valid', 'merge-tracks'].includes(stage))
  if (rest.length) parts.push(' It has nothing of ', code(rest.join(', ')), '.')
  return note('', ...parts)
}

/** Stages that were made from another log than the one that is there. */
export function stale(stages) {
  return note('', 'Made from another log than the one that is there: ', code(stages.join(', ')), '. What they made may not fit it. ', code('make dataset'), ' makes them again.')
}
