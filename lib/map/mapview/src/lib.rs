//! Road networks from above: a map sheet as SVG or PNG.
//!
//! [`draw`] turns an [`opendrive::Map`] into a [`Picture`]: surfaces by what they are for, markings with
//! their colours and dashes, crosswalks, stop lines, signals and signs, decks above what they cross, tunnels
//! dashed; with name, scale bar, north arrow and a legend of what occurs. Where a pixel covers more than
//! [`COARSE_FROM_M_PER_PX`] metres, roads become lines coloured by their kind. The picture is written by
//! [`Picture::to_svg`] or [`Picture::to_png`].
//!
//! ```
//! let network = town::generate(&town::named("convoy/demo").unwrap_or_default())?;
//! let map = opendrive::Map::new(network);
//! let picture = mapview::draw(&map, &mapview::ViewOptions::default());
//! assert!(picture.to_svg().starts_with("<svg"));
//! # Ok::<(), town::TownError>(())
//! ```

mod coarse;
mod film;
mod fine;
mod frame;
mod letters;
mod levels;
mod marks;
mod page;
mod picture;
mod raster;
mod sheet;
mod stretch;
mod style;
mod svg;
mod symbols;
mod things;

pub use film::{ActorStyle, Film, Light, MapActor, StopBar, frame_png};
pub use page::{COARSE_FROM_M_PER_PX, ViewOptions, Window};
pub use picture::Picture;
pub use raster::RasterError;

use opendrive::Map;
use page::Page;
use picture::{Paint, Shape};

/// Draws a map, or the part of it that the options name.
#[must_use]
pub fn draw(map: &Map, options: &ViewOptions) -> Picture {
    draw_with(map, options, |_, _| {})
}

/// Draws a map, and something more on it.
fn draw_with(map: &Map, options: &ViewOptions, more: impl Fn(&Page, &mut Picture)) -> Picture {
    let page = Page::new(map, options);
    let mut picture = Picture::new();
    picture.shape(Shape::rectangle(page.origin_px, page.map_px, Paint::fill(style::GROUND)));
    let legend = if page.is_coarse() {
        coarse::draw(map, &page, &mut picture)
    } else {
        fine::draw(map, &page, &mut picture)
    };
    more(&page, &mut picture);
    frame::draw(map, &page, options, &legend, &mut picture);
    picture
}
