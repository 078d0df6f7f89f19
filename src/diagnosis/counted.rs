//! What the counts say, beside a claim about pdf() or sample().

use super::counts::{CountTest, Counts};
use super::explanation::Claim;
use super::pdf;
use super::profile::Profile;
use super::regression::{FEWEST_WO, Pooled};
use super::textbook::Textbook;
use super::view::View;

/// Fewer draws on wo's side than this say nothing of exponents.
const FEWEST: u64 = 2048;

/// Adds to the evidence of such a claim how the counts are tested before and after the
/// repair, and by which powers of cosines they are off; the picture of that.
pub fn tell(view: &View, books: &[Textbook], claim: &mut Claim) -> Option<Profile> {
    let counted = ["goodness-of-fit", "normalization", "jacobian"];
    if !claim.covers.contains(&"goodness-of-fit") || !view.fails_any(&counted) {
        return None;
    }
    let counts: Vec<&(usize, Counts)> =
        pdf::counts(view).iter().filter(|(_, c)| c.own.len() == c.leaves.len()).collect();
    if counts.is_empty() {
        return None;
    }
    let tests: Vec<CountTest> = counts.iter().map(|(_, c)| c.test(&c.own, 0)).collect();
    let before = tests.iter().copied().fold(CountTest::default(), CountTest::and);
    let after = claim.ln_p.map_or(String::new(), |p| format!(", and {} after the repair", ln_p(p)));
    claim.evidence.push(format!("the counts have {} under pdf() as it is{after}", ln_p(before.ln_p())));
    if let Some(words) = pooled(view, &counts).and_then(|p| p.words()) {
        let place = if view.description.claims.transmissive { "in reflection, " } else { "" };
        claim.evidence.push(format!("{place}{words}"));
    }
    let off = |k: usize| tests[k].x2() / counts[k].1.draws as f64;
    let worst = (0..counts.len()).max_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    let case = &counts[worst].0;
    // Of a sampler's mistake the textbook's density predicts nothing.
    let of_pdf = claim.statement.contains("pdf(") && !claim.statement.contains("sample()");
    // Of two the second is the one that draws as the subject does.
    let book = books.iter().rev().find(|b| of_pdf && !b.agrees.by_pdf());
    Profile::of(view, &view.cases[*case], book)
}

/// Of as many cases with different θ as a fit takes: these counts, and then further ones.
fn pooled(view: &View, counts: &[&(usize, Counts)]) -> Option<Pooled> {
    let mut pooled = Pooled::default();
    for (k, counts) in counts {
        if !pooled.has(view.cases[*k].wo) {
            pooled.add(view.cases[*k].wo, counts);
        }
    }
    for seen in &view.cases {
        if pooled.directions() >= FEWEST_WO {
            break;
        }
        if pooled.has(seen.wo) {
            continue;
        }
        if let Some(more) = Counts::of(seen.evidence, |wi| view.pdf(seen.wo, wi, seen.transport)) {
            pooled.add(seen.wo, &more);
        }
    }
    (pooled.counted() >= FEWEST).then_some(pooled)
}

fn ln_p(ln_p: f64) -> String {
    let text = match ln_p {
        p if p == f64::NEG_INFINITY => return "p = 0".into(),
        p if p > -1000.0 => format!("{p:.1}"),
        p => format!("{p:.1e}"),
    };
    format!("ln p = {}", text.replace("-0.0", "0").replace('-', "−"))
}
