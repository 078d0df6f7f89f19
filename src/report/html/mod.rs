//! index.html: a report as one page that needs nothing else.
//!
//! It is made from report.json and the evidence beside it. What a person must see is
//! plain HTML; the rest is packed, and unpacked by the page's script.

mod cells;
mod changes;
mod gather;
mod head;
mod matrix;
mod names;
mod pack;
mod page;
mod pictures;
mod scales;
mod section;
mod subject;
#[cfg(test)]
mod tests;

pub(crate) use page::STYLE;
pub use page::{PAGE, page};
pub(crate) use pictures::inline;
