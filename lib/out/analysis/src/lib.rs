//! Statistics of a dataset: from partial counts to tables, figures and one page to read.
//!
//! The stages count while they have the data in hand ([`schema::measures`] names what). [`MeasureTotals`]
//! adds those rows up, [`compute_tables`] turns them into [`Tables`] (plain typed columns, so a caller writes
//! them as Parquet or, by [`to_csv`], as text), [`draw_figures`] draws them as SVG and [`report_html`] puts
//! everything on one page ([`GroupTotals`] for what it shows of a split or a map), [`published_html`] what
//! the published dataset has, too, on another; [`scores_html`] is the page of predictions that were held
//! against a dataset. The same counts give the same bytes.

mod card;
mod compute;
mod figures;
mod groups;
mod page;
mod report;
mod scores;
mod table;
mod text;
mod totals;

pub use card::{MadeBy, dataset_card};
pub use compute::{DatasetFacts, compute_tables};
pub use figures::{Figure, FoundBar, PrecisionCurves, draw_figures};
pub use groups::{Group, GroupTotals};
pub use report::{PUBLISHED_PAGE, SceneCard, published_html, report_html};
pub use scores::{Moment, ScorePart, scores_html};
pub use table::{Section, Table, TableColumn, Tables, Values, to_csv};
pub use totals::MeasureTotals;
