//! The page of predictions that were held against a dataset.

use maud::html;

use crate::figures::{FoundBar, PrecisionCurves, found_figure, precision_figure};
use crate::page::{Page, figures, how, numbers};
use crate::table::Table;
use crate::text::grouped;

/// A frame of an ego.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Moment {
    /// Number of the scene.
    pub scene: u32,
    /// Frame number.
    pub frame: u32,
    /// The ego.
    pub ego: String,
    /// Targets that were found, that were missed, and predictions of nothing.
    pub found_missed_wrong: [u64; 3],
}

/// What is shown of one model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScorePart {
    /// Its name.
    pub title: String,
    /// Tables of scores.
    pub tables: Vec<Table>,
    /// Curves of classes.
    pub curves: Vec<PrecisionCurves>,
    /// How it is decided what was found, in a sentence.
    pub found_note: String,
    /// What was found at which distance.
    pub found: Vec<FoundBar>,
    /// The worst frames.
    pub worst: Vec<Moment>,
}

/// The page of an evaluation: self-contained like the report. Its frames lead to the viewer where that serves
/// the page, from a file in the store's folder.
#[must_use]
pub fn scores_html(name: &str, about: &str, parts: &[ScorePart]) -> String {
    let heading = html! {
        h1 { (name) ": predictions" }
        p { (about) }
    };
    let contents = html! {
        @for (i, part) in parts.iter().enumerate() {
            a href={ "#part-" (i) } { (part.title) } "\n"
        }
    };
    let body = html! {
        @for (i, part) in parts.iter().enumerate() {
            section id={ "part-" (i) } {
                h2 { (part.title) }
                div class="part" { (part_html(part)) }
            }
        }
        (how("this page with links to every frame, if it lies in the store's folder"))
    };
    Page { title: &format!("{name}: predictions"), heading, contents, body }.html()
}

fn part_html(part: &ScorePart) -> maud::Markup {
    let drawn: Vec<(&str, String)> =
        part.curves.iter().map(|curves| (&*curves.title, precision_figure(curves))).collect();
    let drawn: Vec<(&str, &str)> = drawn.iter().map(|(title, svg)| (*title, &**svg)).collect();
    html! {
        @for table in &part.tables {
            div class="wide" {
                h3 { (table.title) }
                (numbers(table))
            }
        }
        @if !drawn.is_empty() { (figures("Precision over recall", &drawn)) }
        @if !part.found.is_empty() {
            @let title = "Targets by class and distance from the ego";
            div {
                h3 { "Found, missed and false by distance" }
                p { (part.found_note) }
                (figures("", &[(title, &found_figure(title, &part.found))]))
            }
        }
        @if !part.worst.is_empty() {
            div {
                h3 { "Frames with the most errors" }
                (worst(&part.worst))
            }
        }
    }
}

fn worst(moments: &[Moment]) -> maud::Markup {
    html! {
        div class="scroll" {
            table {
                thead {
                    tr {
                        th class="name" { "frame" }
                        @for head in ["targets", "found", "missed", "false"] { th { (head) } }
                    }
                }
                tbody {
                    @for moment in moments {
                        @let scene = format!("{:04}", moment.scene);
                        @let [found, missed, wrong] = moment.found_missed_wrong;
                        tr {
                            td class="name" {
                                a class="moment" href="#" data-scene=(scene) data-frame=(moment.frame) data-ego=(moment.ego) {
                                    "scene " (scene) ", frame " (moment.frame) ", " (moment.ego)
                                }
                            }
                            @for count in [found + missed, found, missed, wrong] { td { (grouped(&count.to_string())) } }
                        }
                        "\n"
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_what_it_is_given_and_nothing_else() {
        let part = ScorePart {
            title: "Cooperation <x2x>".into(),
            curves: vec![PrecisionCurves {
                title: "car".into(),
                curves: vec![("2 m".into(), vec![[0.1, 1.0], [0.8, 0.5]])],
            }],
            worst: vec![Moment {
                scene: 7,
                frame: 40,
                ego: "vehicle_1".into(),
                found_missed_wrong: [1200, 3, 4],
            }],
            ..ScorePart::default()
        };
        let page = scores_html("tiny", "20 samples", &[part]);
        assert!(page.contains("Cooperation &lt;x2x&gt;") && page.contains("2 m"), "{page}");
        let link = "<a class=\"moment\" href=\"#\" data-scene=\"0007\" data-frame=\"40\" data-ego=\"vehicle_1\">scene 0007, frame 40, vehicle_1</a>";
        assert!(page.contains(link) && page.contains("<td>1,203</td>"), "{page}");
        assert!(!page.contains("by distance"), "{page}");
    }
}
