//! What images are made of.

use render::{CameraView, RenderError, Scene, ViewQuery, VisibilityBuffer, render_views};
use schema::ImageKind;

use crate::picture::Picture;

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

impl Sight {
    /// What cameras see, all looking at once; none in colour.
    ///
    /// # Errors
    /// The renderer failed.
    pub fn all(scene: &dyn Scene, views: Vec<CameraView>) -> Result<Vec<Self>, RenderError> {
        let queries: Vec<ViewQuery<'_>> = views.iter().map(ViewQuery::of).collect();
        let seen = render_views(scene, &queries)?;
        Ok(views.into_iter().zip(seen).map(|(view, seen)| Self { view, seen, picture: None }).collect())
    }
}

/// Whether a camera's picture is wanted in colour.
#[must_use]
pub fn wants_colour(view: &CameraView) -> bool {
    view.settings.images.has(ImageKind::Rgb)
}
