//! Reads OpenDRIVE files.

mod check;
mod context;
mod furniture;
mod lanes;
mod road;

use std::fmt;
use std::io::Read;

use roxmltree::{Document, Node};

use crate::model::{Header, HeaderOffset, Network};
use context::{Context, text_or_empty};

/// Files that unpack to more than this are refused.
const MAX_TEXT_BYTES: u64 = 1 << 31;

/// Why a file cannot be used at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// Not well-formed XML.
    #[error("line {line}, column {column}: not XML: {message}")]
    Xml {
        /// Line, from 1.
        line: u32,
        /// Column, from 1.
        column: u32,
        /// What the XML parser says.
        message: String,
    },
    /// Bytes that are neither UTF-8 text nor gzip of it.
    #[error("not text: {message}")]
    Bytes {
        /// What is wrong.
        message: String,
    },
    /// An element that cannot be understood, though it must be.
    #[error("line {line}{}: {message}", road.as_ref().map(|r| format!(", road {r}")).unwrap_or_default())]
    Content {
        /// Line, from 1.
        line: u32,
        /// Id of the road it is in.
        road: Option<String>,
        /// What is wrong.
        message: String,
    },
}

/// Something wrong in a file that the reader put up with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Warning {
    /// Line, from 1; 0 where no single line is to blame.
    pub line: u32,
    /// Id of the road it is in.
    pub road: Option<String>,
    /// Metres along that road.
    pub s: Option<f64>,
    /// What is wrong, and what was done about it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}", self.line)?;
        if let Some(road) = &self.road {
            write!(f, ", road {road}")?;
        }
        if let Some(s) = self.s {
            write!(f, ", s {s:.3}")?;
        }
        write!(f, ": {}", self.message)
    }
}

impl Network {
    /// Reads an OpenDRIVE file (revisions 1.1 to 1.8; any XML namespace).
    ///
    /// Faults that leave the rest usable become [`Network::warnings`]; elements that are not understood
    /// are skipped and counted there.
    ///
    /// # Errors
    /// Where the text is not XML, its root is not `OpenDRIVE`, or an element lacks a number without which
    /// it has no place or meaning.
    pub fn parse(xml: &str) -> Result<Self, ReadError> {
        let document = Document::parse(xml).map_err(|e| xml_error(&e, xml))?;
        let mut context = Context::new(xml);
        let root = document.root_element();
        if root.tag_name().name() != "OpenDRIVE" {
            return Err(
                context.error(root, format!("the root is <{}>, not <OpenDRIVE>", root.tag_name().name()))
            );
        }
        let mut network = Network::default();
        for node in root.children() {
            match node.tag_name().name() {
                "header" => network.header = header(&mut context, node),
                "road" => {
                    context.road = node.attribute("id").map(str::to_owned);
                    if let Some(road) = road::road(&mut context, node)? {
                        network.roads.push(road);
                    }
                    context.road = None;
                }
                "junction" => network.junctions.push(furniture::junction(&mut context, node)?),
                "controller" => network.controllers.push(furniture::controller(&mut context, node)?),
                "userData" => {}
                _ => context.unknown(node),
            }
        }
        check::check(&mut context, &network);
        network.warnings = context.into_warnings();
        Ok(network)
    }
}

/// Where the XML parser gave up. It knows no place for a text that ends too early: that is the end.
fn xml_error(error: &roxmltree::Error, xml: &str) -> ReadError {
    let (line, column) = match error {
        roxmltree::Error::UnexpectedEndOfStream | roxmltree::Error::UnclosedRootNode => {
            let last = xml.lines().last().unwrap_or_default();
            (xml.lines().count().max(1), last.chars().count() + 1)
        }
        _ => (error.pos().row as usize, error.pos().col as usize),
    };
    let (line, column) = (u32::try_from(line).unwrap_or(u32::MAX), u32::try_from(column).unwrap_or(u32::MAX));
    ReadError::Xml { line, column, message: error.to_string() }
}

/// Reads an OpenDRIVE file from its bytes, plain or gzip.
///
/// # Errors
/// As [`Network::parse`], and where the bytes are no text.
pub fn read_bytes(bytes: &[u8]) -> Result<Network, ReadError> {
    let not_text = |message: String| ReadError::Bytes { message };
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut text = String::new();
        let mut unpacked = flate2::read::MultiGzDecoder::new(bytes).take(MAX_TEXT_BYTES + 1);
        unpacked.read_to_string(&mut text).map_err(|e| not_text(e.to_string()))?;
        if text.len() as u64 > MAX_TEXT_BYTES {
            return Err(not_text(format!("unpacks to more than {MAX_TEXT_BYTES} bytes")));
        }
        return Network::parse(text.trim_start_matches('\u{feff}'));
    }
    let text = std::str::from_utf8(bytes).map_err(|e| not_text(e.to_string()))?;
    Network::parse(text.trim_start_matches('\u{feff}'))
}

fn header(context: &mut Context, node: Node<'_, '_>) -> Header {
    let revision = |name| node.attribute(name).and_then(|t| t.trim().parse().ok()).unwrap_or(0);
    let mut header = Header {
        revision: (revision("revMajor"), revision("revMinor")),
        name: text_or_empty(node, "name"),
        version: text_or_empty(node, "version"),
        date: text_or_empty(node, "date"),
        vendor: text_or_empty(node, "vendor"),
        ..Header::default()
    };
    let bounds = ["north", "south", "east", "west"].map(|name| context.maybe_number(node, name));
    if let [Some(north), Some(south), Some(east), Some(west)] = bounds {
        header.bounds_m = Some([north, south, east, west]);
    }
    for child in node.children() {
        match child.tag_name().name() {
            "geoReference" => {
                // A CDATA section and plain text may stand side by side.
                let text: String = child.children().filter_map(|n| n.text()).collect();
                header.geo_reference = Some(text.trim().to_owned()).filter(|t| !t.is_empty());
            }
            "offset" => {
                header.offset = HeaderOffset {
                    x_m: context.number_or_zero(child, "x"),
                    y_m: context.number_or_zero(child, "y"),
                    z_m: context.number_or_zero(child, "z"),
                    hdg_rad: context.number_or_zero(child, "hdg"),
                };
            }
            "userData" => {}
            _ => context.unknown(child),
        }
    }
    header
}
