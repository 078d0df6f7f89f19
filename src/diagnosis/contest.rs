//! Ranks claims.

use super::counted;
use super::explanation::{self, Claim, Explanation};
use super::profile::Profile;
use super::textbook::Textbook;
use super::view::View;
use crate::cause::Cause;
use crate::engine::CaseResult;
use crate::registry::Parameters;

/// By how many nats a claim must beat those of other causes to be named with
/// confidence.
pub const MARGIN: f64 = 5.0;

/// What a failed check costs that a claim does not explain.
const UNEXPLAINED: f64 = 20.0;

/// Below this nothing fits.
const NOTHING_FITS: f64 = -70.0;

/// Above this price a claim says too little to be named with confidence.
const SAYS_LITTLE: f64 = 17.0;

/// The outcome of a contest.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Claims, best first, one a cause.
    pub ranked: Vec<(f64, Claim)>,
    /// Whether the first is named with confidence.
    pub confident: bool,
    /// Failed checks that the first does not explain: another bug's.
    pub unexplained: Vec<&'static str>,
    /// What may be that other bug.
    pub another: Option<Claim>,
    /// The published model that was recognised.
    pub textbook: Option<String>,
    /// The counts beside pdf(), where the first is about pdf() or sample().
    pub profile: Option<Profile>,
}

impl Verdict {
    /// The cause named first.
    pub fn cause(&self) -> Option<Cause> {
        self.ranked.first().map(|(_, c)| c.cause)
    }
}

/// Explains why the cases of one subject failed; `None` where none did. `more` are
/// explanations besides those that come with gonio, `parameters` what the subject
/// declares of itself.
pub fn diagnose<'a, 's: 'a>(
    cases: &[&'a CaseResult<'s>],
    more: &[Box<dyn Explanation>],
    parameters: &Parameters,
) -> Option<Verdict> {
    let view = View::gather(cases, parameters)?;
    let books = Textbook::of(&view);
    let all = explanation::all();
    let explained = |book: Option<&Textbook>| -> Vec<Claim> {
        all.iter().chain(more).flat_map(|e| e.claims(&view, book)).collect()
    };
    let mut claims: Vec<(f64, Claim)> = match books.is_empty() {
        true => explained(None),
        false => books.iter().flat_map(|b| explained(Some(b))).collect(),
    }
    .into_iter()
    .filter(|c| c.covers.iter().any(|check| view.failed.contains(check)))
    .map(|c| (score(&c, &view), c))
    .filter(|(score, _)| *score > NOTHING_FITS)
    .collect();
    claims.sort_by(|a, b| b.0.total_cmp(&a.0));
    let unexplained: Vec<&'static str> = match claims.first() {
        Some((_, first)) => view.failed.iter().copied().filter(|c| !first.covers.contains(c)).collect(),
        None => Vec::new(),
    };
    let another = another(&claims, &unexplained);
    let mut ranked: Vec<(f64, Claim)> = Vec::new();
    for claim in claims {
        if !ranked.iter().any(|(_, c)| c.cause == claim.1.cause) {
            ranked.push(claim);
        }
    }
    let confident = match &ranked[..] {
        [] => false,
        [(_, only)] => only.price < SAYS_LITTLE,
        [(a, first), (b, _), ..] => a - b >= MARGIN && first.price < SAYS_LITTLE,
    };
    let profile = ranked.first_mut().and_then(|(_, first)| counted::tell(&view, &books, first));
    Some(Verdict {
        ranked,
        confident,
        unexplained,
        another,
        textbook: books.into_iter().next().map(|b| b.name),
        profile,
    })
}

/// The best claim of another cause that explains all that the first does not.
fn another(claims: &[(f64, Claim)], unexplained: &[&str]) -> Option<Claim> {
    let (_, first) = claims.first()?;
    let fits =
        |c: &&Claim| c.cause != first.cause && unexplained.iter().all(|check| c.covers.contains(check));
    let own = |c: &Claim| c.ln_likelihood - c.price;
    let others = claims.iter().map(|(_, c)| c).filter(fits).filter(|c| c.price < SAYS_LITTLE);
    others.max_by(|a, b| own(a).total_cmp(&own(b))).filter(|_| !unexplained.is_empty()).cloned()
}

fn score(claim: &Claim, view: &View) -> f64 {
    let unexplained = view.failed.iter().filter(|check| !claim.covers.contains(check)).count();
    claim.ln_likelihood - claim.price - UNEXPLAINED * unexplained as f64
}
