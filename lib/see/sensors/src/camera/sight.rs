//! What images are made of.

use render::VisibilityBuffer;

use render::CameraView;
use shading::Picture;

/// What one camera saw at one frame: all its images are read from this.
#[derive(Clone, Debug, PartialEq)]
pub struct Sight {
    /// The camera.
    pub view: CameraView,
    /// Which surface each pixel shows.
    pub seen: VisibilityBuffer,
    /// The same in colour, if that was wanted.
    pub picture: Option<Picture>,
}
