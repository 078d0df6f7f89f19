//! The powers of cosines by which the draws of mutants differ from their pdf(), as
//! docs/diagnosis.md has them.
//!
//! `cargo run --release --example regression [SUBJECT]...`

use gonio::diagnosis::{BASES, Constant, Pooled, Regression};
use gonio::engine::{Options, run};
use gonio::registry::{Registry, Spelling, Value};
use gonio::suite::{Overrides, load};

/// One parameter more than the defaults of a mutant: what the first simulation had.
const SUBJECTS: [&str; 19] = [
    "torrance-sparrow:alpha=0.5,sampling=normals",
    "torrance-sparrow:alpha=0.5",
    "mutant-no-jacobian:sampling=normals",
    "mutant-pdf-d-without-cosine",
    "mutant-pdf-wo-n-for-wo-h:alpha=0.5",
    "mutant-pdf-of-half-vector-angle:alpha=0.5",
    "mutant-all-normals-pdf-of-visible:distribution=ggx",
    "mutant-visible-normals-pdf-of-all",
    "mutant-pdf-without-g1:alpha=0.5",
    "mutant-redrawn-below-horizon:alpha=0.5,sampling=normals",
    "mutant-cosine-said-uniform",
    "mutant-lambert-pdf-without-pi",
    "mutant-pdf-arguments-exchanged",
    "mutant-alpha-squared",
    "mutant-visible-pdf-without-d",
    "mutant-flipped-below-horizon:alpha=0.5,distribution=ggx,sampling=normals",
    "mutant-number-not-stretched",
    "mutant-half-vector-returned:sampling=normals",
    "mutant-one-share-forgotten",
];

/// Draws at each of four wo.
const DRAWS: u64 = 1 << 18;

fn pooled(subject: &str) -> Result<Pooled, Box<dyn std::error::Error>> {
    let spelling: Spelling = subject.parse()?;
    let mut text = format!(
        "[suite]\nname = \"regression\"\nsamples = \"2^14\"\ntheta = [20, 45, 60, 75]\nphi = 33\n\
         [[subject]]\nuse = \"{}\"\n",
        spelling.name
    );
    for (name, value) in &spelling.parameters {
        text += &match value {
            Value::Number(v) => format!("{name} = {v}\n"),
            Value::Text(v) => format!("{name} = \"{v}\"\n"),
        };
    }
    let only = Overrides { checks: vec!["goodness-of-fit".into()], ..Overrides::default() };
    let plan = load("regression", &text, &Registry::builtin(), &only)?.plan;
    let results = run(&plan, &Options::default(), &mut |_| {});
    Ok(Pooled::of(&results.cases.iter().collect::<Vec<_>>(), DRAWS))
}

/// The numbers of a fit, as cells of a table.
fn row(fit: &Regression) -> String {
    let constants = match &fit.constants[..] {
        [c] => c.to_string(),
        _ => "by wo".into(),
    };
    let exponents = fit.exponents.map(|e| e.map_or("–".into(), |e| e.to_string()));
    format!("{constants} | {} | {:.2}", exponents.join(" | "), fit.reduced())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let subjects = if asked.is_empty() { SUBJECTS.map(String::from).to_vec() } else { asked };
    println!("| subject | c | {} | red. χ² |\n|---|{}", BASES.join(" | "), "---|".repeat(7));
    for subject in subjects {
        let pooled = pooled(&subject)?;
        for constant in [Constant::One, Constant::EachWo] {
            if let Some(fit) = pooled.fit(constant) {
                println!("| {subject} | {} |", row(&fit));
            }
        }
        eprintln!("{subject}: {}", pooled.words().unwrap_or_else(|| "no fit".into()));
    }
    Ok(())
}
