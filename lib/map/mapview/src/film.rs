//! Things that move over a map, frame by frame.

use frames::math::sin_cos;
use nalgebra::Point3;
use opendrive::Map;
use tiny_skia::Pixmap;

use crate::page::{Page, ViewOptions};
use crate::picture::{Anchor, Colour, Paint, Picture, Shape, Text};
use crate::raster::{self, RasterError};
use crate::style;
use crate::symbols::disc;

/// Least length and width of a thing on the sheet, pixels.
const LEAST_PX: [f64; 2] = [4.0, 2.4];
/// Corners of a walker.
const ROUND: u32 = 10;
/// How wide a light's bar at a stop line is, metres, and its least width, pixels.
const BAR_M: f64 = 0.9;
const BAR_PX: f64 = 2.6;
const LABEL_PX: f64 = 12.0;
const CAPTION_PX: f64 = 14.0;
const AGENT: Colour = [24, 96, 222, 255];
const STATION: Colour = [140, 40, 170, 255];
const WALKER: Colour = [214, 60, 120, 255];
const GLASS: Colour = [30, 36, 44, 255];
const PLATE: Colour = [253, 253, 251, 215];
const WARNING: Colour = [235, 110, 20, 255];

/// What a thing is, as far as its picture tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActorStyle {
    /// A vehicle of the traffic.
    Vehicle,
    /// A vehicle of the traffic whose driver breaks rules.
    Careless,
    /// A vehicle with sensors.
    Agent,
    /// A road-side unit.
    Station,
    /// A walker.
    Walker,
    /// A building.
    Building,
    /// A tree or a bush.
    Plant,
    /// A fence, a wall, street furniture.
    Furniture,
    /// A cone, a barrier, a thing on the road.
    Obstacle,
}

/// A thing on the map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapActor {
    /// What it is.
    pub style: ActorStyle,
    /// Its middle, metres east and north.
    pub at_m: [f64; 2],
    /// Its direction, radians from east, counter-clockwise.
    pub heading_rad: f64,
    /// Its length and width, metres.
    pub size_m: [f64; 2],
    /// Its colour, sRGB; walkers, agents and stations have colours of their own.
    pub rgb: [u8; 3],
    /// Whether it is under a deck: then only its outline shows.
    pub covered: bool,
    /// Whether it brakes.
    pub brakes: bool,
    /// Whether it blinks to the left and to the right.
    pub blinks: [bool; 2],
    /// A name beside it.
    pub label: Option<String>,
}

/// What a traffic light shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// Stop.
    Red,
    /// Stop soon, or go soon.
    Yellow,
    /// Go.
    Green,
    /// Nothing.
    Off,
}

/// Where a traffic light holds the vehicles of a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopBar {
    /// The lane's middle, metres east and north.
    pub at_m: [f64; 2],
    /// Direction of travel, radians from east, counter-clockwise.
    pub heading_rad: f64,
    /// Width of the lane, metres.
    pub width_m: f64,
    /// What the light shows.
    pub light: Light,
}

/// A map with the objects on it: the backdrop of every frame.
///
/// ```
/// use mapview::{Film, ViewOptions, frame_png};
///
/// let map = opendrive::Map::new(opendrive::Network::default());
/// let film = Film::new(&map, &ViewOptions { size_px: 120.0, ..ViewOptions::default() }, &[])?;
/// let png = frame_png(&film.frame(&[], &[], "0.10 s"), film.size_px())?;
/// assert!(png.starts_with(b"\x89PNG"));
/// # Ok::<(), mapview::RasterError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Film {
    page: Page,
    backdrop: Pixmap,
}

impl Film {
    /// Draws the backdrop.
    ///
    /// # Errors
    /// [`RasterError`] where there is no memory for the pixels.
    pub fn new(map: &Map, options: &ViewOptions, standing: &[MapActor]) -> Result<Self, RasterError> {
        let page = Page::new(map, options);
        let mut backdrop = raster::pixels(&crate::draw_with(map, options, |page, picture| {
            standing.iter().for_each(|thing| draw(page, thing, picture));
        }))?;
        // What is translucent would show in the differences between frames.
        backdrop.data_mut().iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = 255);
        Ok(Self { page, backdrop })
    }

    /// Width and height of a frame, pixels.
    #[must_use]
    pub fn size_px(&self) -> [u32; 2] {
        [self.backdrop.width(), self.backdrop.height()]
    }

    /// Where a place in the world (metres east and north) is on a frame: pixels from its left and top edge.
    #[must_use]
    pub fn at_px(&self, [east_m, north_m]: [f64; 2]) -> [f64; 2] {
        self.page.at(&Point3::new(east_m, north_m, 0.0))
    }

    /// A frame: red, green, blue, opacity for each pixel, by row from the top.
    #[must_use]
    pub fn frame(&self, bars: &[StopBar], things: &[MapActor], caption: &str) -> Vec<u8> {
        let mut picture = Picture::new();
        for bar in bars {
            stop_bar(&self.page, bar, &mut picture);
        }
        for thing in things {
            draw(&self.page, thing, &mut picture);
        }
        let [x, y] = self.page.origin_px;
        let at = [x + 8.0, y + 20.0];
        picture.text(Text {
            at,
            anchor: Anchor::Start,
            size_px: CAPTION_PX,
            bold: true,
            colour: style::INK,
            text: caption.to_owned(),
        });
        let mut pixels = self.backdrop.clone();
        raster::paint_all(&mut pixels, &picture);
        self.restore_margins(&mut pixels);
        pixels.take()
    }

    /// Takes back what was painted beyond the map.
    fn restore_margins(&self, pixels: &mut Pixmap) {
        let width = self.backdrop.width() as usize;
        let [left, top] = self.page.origin_px.map(|v| v.ceil() as usize);
        let [right, bottom] = [0, 1].map(|k| (self.page.origin_px[k] + self.page.map_px[k]).floor() as usize);
        let rows =
            pixels.data_mut().chunks_exact_mut(4 * width).zip(self.backdrop.data().chunks_exact(4 * width));
        for (y, (row, still)) in rows.enumerate() {
            if y < top || y >= bottom {
                row.copy_from_slice(still);
            } else {
                row[..4 * left].copy_from_slice(&still[..4 * left]);
                row[4 * right..].copy_from_slice(&still[4 * right..]);
            }
        }
    }
}

/// The corner of a rectangle around a thing: shares of its half length and half width.
fn corner(page: &Page, thing: &MapActor, size_px: [f64; 2], [along, across]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = sin_cos(thing.heading_rad);
    let [x, y] = page.at(&Point3::new(thing.at_m[0], thing.at_m[1], 0.0));
    let (a, b) = (0.5 * along * size_px[0], 0.5 * across * size_px[1]);
    // On the sheet y runs down.
    [x + a * cos - b * sin, y - a * sin - b * cos]
}

fn draw(page: &Page, thing: &MapActor, picture: &mut Picture) {
    let size_px = [0, 1].map(|k| page.px_min(thing.size_m[k], LEAST_PX[k]));
    let middle = corner(page, thing, size_px, [0.0, 0.0]);
    let reach = 0.5 * (size_px[0] + size_px[1]);
    let (low, high) = (page.origin_px, [0, 1].map(|k| page.origin_px[k] + page.map_px[k]));
    if (0..2).any(|k| middle[k] < low[k] - reach || middle[k] > high[k] + reach) {
        return;
    }
    let quad = |shares: [[f64; 2]; 4]| shares.map(|s| corner(page, thing, size_px, s)).to_vec();
    let part = |from: f64, to: f64, half: f64| quad([[from, -half], [to, -half], [to, half], [from, half]]);
    let [r, g, b] = thing.rgb;
    let own = [r, g, b, 255];
    let body = match thing.style {
        ActorStyle::Agent => AGENT,
        ActorStyle::Station => STATION,
        ActorStyle::Walker => WALKER,
        ActorStyle::Building => style::BUILDING,
        ActorStyle::Plant => style::GREENERY,
        ActorStyle::Furniture => style::BARRIER,
        ActorStyle::Obstacle => WARNING,
        ActorStyle::Vehicle | ActorStyle::Careless => own,
    };
    let outline = |colour: Colour, width: f64| Paint { fill: Some(body), ..Paint::line(colour, width) };
    match thing.style {
        ActorStyle::Walker => {
            let paint = outline(style::WHITE, 0.6);
            picture.shape(Shape::ring(disc(middle, page.px_min(0.35, 2.2), ROUND), paint));
        }
        ActorStyle::Plant => {
            picture.shape(Shape::ring(
                disc(middle, page.px_min(0.3 * thing.size_m[0], 1.5), ROUND),
                Paint::fill(body),
            ));
        }
        ActorStyle::Building | ActorStyle::Furniture | ActorStyle::Obstacle => {
            picture.shape(Shape::ring(part(-1.0, 1.0, 1.0), outline(style::KERB, 0.8)));
        }
        ActorStyle::Station => {
            picture.shape(Shape::ring(disc(middle, page.px_min(0.8, 5.0), 4), outline(style::WHITE, 1.2)));
        }
        ActorStyle::Vehicle | ActorStyle::Careless | ActorStyle::Agent => {
            if thing.covered {
                picture.shape(Shape::ring(part(-1.0, 1.0, 1.0), Paint::dashed(body, 1.2, [3.0, 2.0])));
            } else {
                let edge =
                    if thing.style == ActorStyle::Careless { (style::RED, 1.6) } else { (style::INK, 0.8) };
                picture.shape(Shape::ring(part(-1.0, 1.0, 1.0), outline(edge.0, edge.1)));
                lamps(thing, &part, &quad, picture);
            }
        }
    }
    if let Some(label) = &thing.label {
        let at = [middle[0] + reach * 0.6 + 3.0, middle[1] - 5.0];
        // On asphalt and lawn alike it is read before paper.
        let length_px = typeface::length_px(label, LABEL_PX, typeface::Weight::Bold);
        let plate = ([at[0] - 3.0, at[1] - LABEL_PX], [length_px + 6.0, LABEL_PX + 4.0]);
        picture.shape(Shape::rectangle(plate.0, plate.1, Paint::fill(PLATE)));
        picture.text(Text {
            at,
            anchor: Anchor::Start,
            size_px: LABEL_PX,
            bold: true,
            colour: body,
            text: label.clone(),
        });
    }
}

/// Windscreen, brake lamps and blinkers: which way a vehicle points, and what it is about to do.
fn lamps(
    thing: &MapActor,
    part: &impl Fn(f64, f64, f64) -> Vec<[f64; 2]>,
    quad: &impl Fn([[f64; 2]; 4]) -> Vec<[f64; 2]>,
    picture: &mut Picture,
) {
    picture.shape(Shape::ring(part(0.3, 0.55, 0.75), Paint::fill(GLASS)));
    if thing.brakes {
        picture.shape(Shape::ring(part(-1.0, -0.8, 1.0), Paint::fill(style::RED)));
    }
    for (on, side) in thing.blinks.into_iter().zip([1.0, -1.0]) {
        if on {
            let ends = [[1.0, side], [0.75, side], [0.75, 0.5 * side], [1.0, 0.5 * side]];
            picture.shape(Shape::ring(quad(ends), Paint::fill(style::AMBER)));
        }
    }
}

fn stop_bar(page: &Page, bar: &StopBar, picture: &mut Picture) {
    let colour = match bar.light {
        Light::Red => style::RED,
        Light::Yellow => style::AMBER,
        Light::Green => style::GO,
        Light::Off => style::FAINT_INK,
    };
    let (sin, cos) = sin_cos(bar.heading_rad);
    let [x, y] = bar.at_m;
    let half = 0.42 * bar.width_m;
    let end = |side: f64| page.at(&Point3::new(x - side * half * sin, y + side * half * cos, 0.0));
    let line = vec![end(-1.0), end(1.0)];
    if line
        .iter()
        .all(|p| (0..2).all(|k| p[k] > page.origin_px[k] && p[k] < page.origin_px[k] + page.map_px[k]))
    {
        picture.shape(Shape::chain(line, Paint::line(colour, page.px_min(BAR_M, BAR_PX))));
    }
}

/// One frame as a PNG file.
///
/// # Errors
/// The pixels are not of that size.
pub fn frame_png(frame: &[u8], size_px: [u32; 2]) -> Result<Vec<u8>, RasterError> {
    raster::encode(frame, size_px)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Window;

    fn film() -> Film {
        let network = town::generate(&town::named("convoy/demo").expect("has a name")).expect("builds");
        let window = Some(Window { centre_m: [10.0, -20.0], radius_m: 50.0 });
        let options = ViewOptions { size_px: 200.0, window, title: None };
        Film::new(&Map::new(network), &options, &[]).expect("fits")
    }

    fn car(at_m: [f64; 2], heading_rad: f64) -> MapActor {
        MapActor {
            style: ActorStyle::Vehicle,
            at_m,
            heading_rad,
            size_m: [12.0, 4.0],
            rgb: [10, 200, 250],
            covered: false,
            brakes: false,
            blinks: [false; 2],
            label: None,
        }
    }

    #[test]
    fn things_cover_the_ground_that_they_stand_on() {
        let film = film();
        let width = film.size_px()[0] as usize;
        let thing = car([18.0, -35.0], 0.6);
        let frame = film.frame(&[], std::slice::from_ref(&thing), "");
        let plain = film.frame(&[], &[], "");
        // Half a metre a pixel, north up, inside the edge of the sheet.
        let edge = crate::page::EDGE_PX as usize;
        for row in 0..200 {
            for column in 0..200 {
                let (x, y) = (-40.0 + 0.5 * (column as f64 + 0.5), 30.0 - 0.5 * (row as f64 + 0.5));
                let (dx, dy) = (x - 18.0, y + 35.0);
                let (sin, cos) = sin_cos(0.6);
                let (along, across) = ((dx * cos + dy * sin).abs(), (dy * cos - dx * sin).abs());
                let i = 4 * ((row + edge) * width + column + edge);
                if along > 7.0 || across > 3.0 {
                    assert_eq!(frame[i..i + 4], plain[i..i + 4], "{x} {y}");
                } else if along < 1.5 && across < 1.5 {
                    assert_eq!(frame[i..i + 4], [10, 200, 250, 255], "{x} {y}");
                }
            }
        }
        // Nothing is painted beyond the map.
        assert_eq!(film.frame(&[], &[car([59.0, -20.0], 0.0)], "")[..4 * width], plain[..4 * width]);
        assert_eq!(film.frame(&[], &[car([600.0, -20.0], 0.0)], ""), plain);
    }
}
