//! Statistics tables, figures and report.
