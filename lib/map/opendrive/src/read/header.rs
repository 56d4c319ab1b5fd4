//! Reads the header.

use roxmltree::Node;

use super::context::{Context, elements, text_or_empty};
use crate::model::{Header, HeaderOffset, Warning};

/// Taken where a file states no revision.
const DEFAULT_REVISION: (u32, u32) = (1, 4);

pub(super) fn header(context: &mut Context, node: Node<'_, '_>) -> Header {
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
    for child in elements(node) {
        match child.tag_name().name() {
            "geoReference" => {
                // A CDATA section and plain text may stand side by side.
                let text: String =
                    child.children().filter(|n| n.is_text()).filter_map(|n| n.text()).collect();
                header.geo_reference = Some(text.trim().to_owned()).filter(|t| !t.is_empty());
            }
            "offset" => {
                let [x_m, y_m, z_m, hdg_rad] =
                    ["x", "y", "z", "hdg"].map(|name| context.number_or_zero(child, name));
                if context.sane(child, &[x_m, y_m, z_m, hdg_rad]) {
                    header.offset = HeaderOffset { x_m, y_m, z_m, hdg_rad };
                }
            }
            _ => header.kept.extend(context.kept(child, &["license", "defaultRegulations"])),
        }
    }
    header
}

/// Gives a file without header or revision a revision, with a warning.
pub(super) fn settle_revision(context: &mut Context, header: &mut Header) {
    let (major, minor) = header.revision;
    if major == 0 {
        let message = format!("the header states no revision that is known ({major}.{minor}): taken as 1.4");
        context.note(Warning { message, ..Warning::default() });
        header.revision = DEFAULT_REVISION;
    } else if major > 1 || minor > 8 {
        let message = format!("revision {major}.{minor} is newer than this reader knows (1.8)");
        context.note(Warning { message, ..Warning::default() });
    }
}
