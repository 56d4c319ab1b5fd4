//! Reads OpenDRIVE files.

mod check;
mod context;
mod error;
mod header;
mod junctions;
mod lanes;
mod limits;
mod objects;
mod records;
mod road;
mod signals;
mod structures;

use std::io::Read;

use roxmltree::Document;

use crate::model::Network;
use check::Lines;
use context::{Context, elements};
pub use error::ReadError;

impl Network {
    /// Reads an OpenDRIVE file (revisions 1.1 to 1.8; any XML namespace).
    ///
    /// Faults that leave the rest usable become [`Network::warnings`]. Elements that are not understood are
    /// counted in [`Network::unknown_elements`] and, where the model has a place for them, kept; `userData`
    /// is passed over.
    ///
    /// # Errors
    /// Where the text is not XML, its root is not `OpenDRIVE`, an element lacks a number without which it has
    /// no place or meaning, or there is more of something than any real file has (1 GiB of text, 16 million
    /// elements, nesting 100 deep).
    pub fn parse(xml: &str) -> Result<Self, ReadError> {
        limits::check(xml)?;
        let document = Document::parse(xml).map_err(|e| xml_error(&e, xml))?;
        let mut context = Context::new(xml);
        let root = document.root_element();
        if root.tag_name().name() != "OpenDRIVE" {
            return Err(
                context.error(root, format!("the root is <{}>, not <OpenDRIVE>", root.tag_name().name()))
            );
        }
        let mut network = Network::default();
        let mut lines = Lines::default();
        for node in elements(root) {
            match node.tag_name().name() {
                "header" => network.header = header::header(&mut context, node),
                "road" => {
                    context.road = node.attribute("id").map(str::to_owned);
                    if let Some((road, road_lines)) = road::road(&mut context, node)? {
                        network.roads.push(road);
                        lines.roads.push(road_lines);
                    }
                    context.road = None;
                }
                "junction" => {
                    let (junction, junction_lines) = junctions::junction(&mut context, node)?;
                    network.junctions.push(junction);
                    lines.junctions.push(junction_lines);
                }
                "controller" => {
                    network.controllers.push(signals::controller(&mut context, node)?);
                    lines.controllers.push(context.line(node));
                }
                "junctionGroup" => network.junction_groups.push(junctions::group(&mut context, node)?),
                "station" => network.stations.push(structures::station(&mut context, node)?),
                _ => network.kept.extend(context.kept(node, &["signalGroup", "vmsGroup"])),
            }
        }
        header::settle_revision(&mut context, &mut network.header);
        check::check(&mut context, &network, &lines);
        (network.warnings, network.unknown_elements) = context.finish();
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
/// As [`Network::parse`], and where the bytes are no text, or a small compressed file unpacks to a huge one.
pub fn read_bytes(bytes: &[u8]) -> Result<Network, ReadError> {
    let not_text = |message: String| ReadError::Bytes { message };
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let limit = limits::unpacked_limit(bytes.len());
        let mut unpacked = Vec::new();
        let mut reader = flate2::read::MultiGzDecoder::new(bytes).take(limit + 1);
        reader.read_to_end(&mut unpacked).map_err(|e| not_text(e.to_string()))?;
        if unpacked.len() as u64 > limit {
            let message = format!("{} compressed bytes unpack to more than {limit}", bytes.len());
            return Err(not_text(message));
        }
        return parse_bytes(&unpacked);
    }
    parse_bytes(bytes)
}

fn parse_bytes(bytes: &[u8]) -> Result<Network, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|e| ReadError::Bytes { message: e.to_string() })?;
    Network::parse(text.trim_start_matches('\u{feff}'))
}
