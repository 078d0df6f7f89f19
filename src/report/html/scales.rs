//! Colours and limits that the page's script shares with the pictures.

use super::super::plots::{Scale, colours, disc_scale};
use super::pack::inert_json;
use serde::Serialize;

#[derive(Serialize)]
struct Scales {
    sequential: Vec<colours::Rgb>,
    diverging: Vec<colours::Rgb>,
    nothing: colours::Rgb,
    unknown: colours::Rgb,
    ink: colours::Rgb,
    paper: colours::Rgb,
    #[serde(flatten)]
    limits: Scale,
}

/// As JSON for a script element.
pub fn scales() -> String {
    inert_json(&Scales {
        sequential: colours::SEQUENTIAL.to_vec(),
        diverging: colours::DIVERGING.to_vec(),
        nothing: colours::NOTHING,
        unknown: colours::UNKNOWN,
        ink: colours::INK,
        paper: colours::PAPER,
        limits: disc_scale(),
    })
}
