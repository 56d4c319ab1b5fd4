//! Statistics by hand-made numbers, and the pages in a browser.

mod browser;
mod card;
mod tables;
