//! Tabulated BSDFs and their file formats.

pub mod lbnl;
