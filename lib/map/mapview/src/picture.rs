//! A picture as a list of shapes and texts, in painting order.

/// Red, green, blue, opacity.
pub(crate) type Colour = [u8; 4];

/// Width in pixels, and how a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: Colour,
    pub(crate) width_px: f64,
    /// Drawn and blank pixels.
    pub(crate) dash_px: Option<[f64; 2]>,
    /// Round ends and corners instead of cut ones.
    pub(crate) round: bool,
}

/// How a shape is painted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Paint {
    pub(crate) fill: Option<Colour>,
    pub(crate) stroke: Option<Stroke>,
}

impl Paint {
    pub(crate) fn fill(colour: Colour) -> Self {
        Self { fill: Some(colour), stroke: None }
    }

    /// Filled a little beyond its edge, so that no ground shines through between neighbours.
    pub(crate) fn sealed(colour: Colour) -> Self {
        Self { fill: Some(colour), ..Self::line(colour, SEAL_PX) }
    }

    pub(crate) fn line(colour: Colour, width_px: f64) -> Self {
        Self { fill: None, stroke: Some(Stroke { colour, width_px, dash_px: None, round: false }) }
    }

    pub(crate) fn round_line(colour: Colour, width_px: f64) -> Self {
        Self { fill: None, stroke: Some(Stroke { colour, width_px, dash_px: None, round: true }) }
    }

    pub(crate) fn dashed(colour: Colour, width_px: f64, dash_px: [f64; 2]) -> Self {
        Self { fill: None, stroke: Some(Stroke { colour, width_px, dash_px: Some(dash_px), round: false }) }
    }
}

/// Width of the line around sealed shapes, pixels.
const SEAL_PX: f64 = 0.5;

/// Chains of points that share a paint. Rings are filled where the winding number is not zero.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shape {
    /// In pixels, x to the right, y down.
    pub(crate) chains: Vec<Vec<[f64; 2]>>,
    /// Whether the last point of each chain joins the first.
    pub(crate) closed: bool,
    pub(crate) paint: Paint,
}

impl Shape {
    pub(crate) fn rectangle([x, y]: [f64; 2], [w, h]: [f64; 2], paint: Paint) -> Self {
        let ring = vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
        Self { chains: vec![ring], closed: true, paint }
    }

    pub(crate) fn ring(ring: Vec<[f64; 2]>, paint: Paint) -> Self {
        Self { chains: vec![ring], closed: true, paint }
    }

    pub(crate) fn chain(chain: Vec<[f64; 2]>, paint: Paint) -> Self {
        Self { chains: vec![chain], closed: false, paint }
    }
}

/// Which point of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Text {
    /// On the baseline, pixels.
    pub(crate) at: [f64; 2],
    pub(crate) anchor: Anchor,
    pub(crate) size_px: f64,
    pub(crate) bold: bool,
    pub(crate) colour: Colour,
    pub(crate) text: String,
}

/// One thing to paint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Item {
    Shape(Shape),
    Text(Text),
}

/// A finished map sheet, ready to be written.
///
/// ```
/// let map = opendrive::Map::new(opendrive::Network::default());
/// let options = mapview::ViewOptions { size_px: 120.0, ..mapview::ViewOptions::default() };
/// let picture = mapview::draw(&map, &options);
/// assert!(picture.to_svg().starts_with("<svg") && picture.to_png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), mapview::RasterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub(crate) width_px: f64,
    pub(crate) height_px: f64,
    pub(crate) title: String,
    pub(crate) items: Vec<Item>,
}

impl Picture {
    pub(crate) fn new() -> Self {
        Self { width_px: 0.0, height_px: 0.0, title: String::new(), items: Vec::new() }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size_px(&self) -> [f64; 2] {
        [self.width_px, self.height_px]
    }

    /// Adds a shape, unless it has no points; one with the paint of the shape before it joins that one.
    pub(crate) fn shape(&mut self, mut shape: Shape) {
        shape.chains.retain(|chain| chain.len() > 1);
        if shape.chains.is_empty() {
            return;
        }
        // Where paint is translucent, joined shapes would not darken each other.
        let solid =
            |p: &Paint| p.fill.is_none_or(|c| c[3] == 255) && p.stroke.is_none_or(|s| s.colour[3] == 255);
        match self.items.last_mut() {
            Some(Item::Shape(last))
                if last.closed == shape.closed && last.paint == shape.paint && solid(&shape.paint) =>
            {
                last.chains.append(&mut shape.chains);
            }
            _ => self.items.push(Item::Shape(shape)),
        }
    }

    pub(crate) fn text(&mut self, text: Text) {
        self.items.push(Item::Text(text));
    }
}
