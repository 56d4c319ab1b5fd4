//! Cameras: one look at the scene, and the images that are made of it.

mod boxes_2d;
mod colour;
mod depth;
mod encode;
mod flow;
mod image;
mod labels;
mod mounted;
mod visible;

use schema::ImageKind;
use schema::images::{Depth, Flow, Instance, Semantic};
use settings::Rig;

use crate::sensor::{SensorContext, SensorVisitor};
pub(crate) use boxes_2d::Boxes2d;
use colour::ColourImages;
pub use depth::decode_depth_m;
use flow::HalfFlow;
pub use image::Image;
use image::Images;
pub use labels::pixel_counts;
pub use mounted::{Camera, Cameras};
pub(crate) use visible::VisibleObjects;

/// Shows a visitor the images of every camera of a rig. A kind and the type that makes it have one name, and
/// a kind that is missing here does not compile.
macro_rules! visit_kinds {
    ($($kind:ident),+ $(,)?) => {
        pub(crate) fn visit_images<V: SensorVisitor>(
            rig: &Rig,
            carrier: &SensorContext,
            visitor: &mut V,
        ) -> Result<(), V::Error> {
            for camera in 0..rig.cameras.len() {
                for kind in rig.camera.images.iter() {
                    match kind {
                        ImageKind::Rgb => visitor.visit(ColourImages::new(rig, camera, carrier))?,
                        // The one kind that is kept in two ways.
                        ImageKind::Flow if rig.camera.flow_half => {
                            visitor.visit(Images::<HalfFlow>::new(rig, camera))?;
                        }
                        $( ImageKind::$kind => visitor.visit(Images::<$kind>::new(rig, camera))?, )+
                    }
                }
            }
            Ok(())
        }
    };
}

visit_kinds!(Semantic, Instance, Depth, Flow);
