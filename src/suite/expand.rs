//! From a suite to its plan.

use super::combination::{Combination, Combinations};
use super::file::{Cover, Entry, Overrides, SuiteFile};
use super::mistake::{Mistake, SuiteError};
use super::pairs;
use super::plan::{Case, Plan, Settings};
use crate::bsdf::Transport;
use crate::registry::Registry;
use std::sync::Arc;

/// More cases than this are a slip.
const MOST_CASES: usize = 1_000_000;

/// A plan, and what was left out of it.
pub struct Expanded {
    /// The cases.
    pub plan: Plan<'static>,
    /// Combinations of parameters that a model refused to build.
    pub refused: usize,
}

/// Reads a suite's text and expands it: every mistake of both at once.
pub fn load(
    source_name: &str,
    text: &str,
    registry: &Registry,
    overrides: &Overrides,
) -> Result<Expanded, SuiteError> {
    let (mut file, mistakes) = SuiteFile::read(source_name, text)?;
    file.apply(overrides);
    expand_after(&file, registry, mistakes)
}

/// Expands a suite that was read without mistakes.
pub fn expand(file: &SuiteFile, registry: &Registry) -> Result<Expanded, SuiteError> {
    expand_after(file, registry, Vec::new())
}

fn expand_after(
    file: &SuiteFile,
    registry: &Registry,
    mut mistakes: Vec<Mistake>,
) -> Result<Expanded, SuiteError> {
    let registry = &registry.limited(&file.settings.limits);
    let (mut cases, mut refused) = (Vec::new(), 0);
    for entry in &file.entries {
        let Some(combinations) = Combinations::of(registry, entry, &mut mistakes) else { continue };
        refused += combinations.refused;
        let factors = Factors::new(file, entry, &combinations);
        if factors.product().is_none_or(|n| cases.len() + n > MOST_CASES) {
            let message = format!("`{}` makes more than {MOST_CASES} cases", entry.model.get_ref());
            let help = "list fewer values, or set cover = \"pairs\"";
            mistakes.push(Mistake::new(entry.model.span(), message, "too many").help(help));
            continue;
        }
        cases.extend(factors.rows().iter().map(|row| Arc::new(factors.case(row))));
    }
    if !mistakes.is_empty() {
        return Err(file.error(mistakes));
    }
    let plan =
        Plan { suite: file.name.clone(), seed: file.seed, false_alarm: file.false_alarm, share: None, cases };
    Ok(Expanded { plan, refused })
}

const TRANSPORTS: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// What varies within an entry: its parameters, then mode of transport, polar
/// angle, side and azimuth.
struct Factors<'a> {
    file: &'a SuiteFile,
    entry: &'a Entry,
    combinations: &'a Combinations,
    theta: &'a [f64],
    phi: &'a [f64],
    levels: Vec<usize>,
}

impl<'a> Factors<'a> {
    fn new(file: &'a SuiteFile, entry: &'a Entry, combinations: &'a Combinations) -> Self {
        let theta = entry.theta.as_ref().unwrap_or(&file.theta);
        let phi = entry.phi.as_ref().unwrap_or(&file.phi);
        let mut levels = combinations.levels.clone();
        levels.extend([TRANSPORTS.len(), theta.len(), 2, phi.len()]);
        Self { file, entry, combinations, theta, phi, levels }
    }

    fn product(&self) -> Option<usize> {
        // Sides and modes are factors of every entry and rarely of its cases.
        self.levels.iter().try_fold(1usize, |n, l| n.checked_mul(*l)).map(|n| n / 4)
    }

    fn rows(&self) -> Vec<Vec<usize>> {
        match self.entry.cover.unwrap_or(self.file.cover) {
            Cover::All => pairs::product(&self.levels).filter(|row| self.admits(row)).collect(),
            Cover::Pairs => pairs::cover(&self.levels, |row| self.admits(row)),
        }
    }

    fn combination(&self, row: &[usize]) -> Option<&'a Combination> {
        let index = self.combinations.levels.iter().zip(row).fold(0, |index, (n, k)| index * n + k);
        self.combinations.all[index].as_ref()
    }

    /// Transport, theta, back, phi.
    fn place(&self, row: &[usize]) -> (Transport, f64, bool, f64) {
        let k = &row[self.combinations.levels.len()..];
        (TRANSPORTS[k[0]], self.theta[k[1]], k[2] == 1, self.phi[k[3]])
    }

    fn admits(&self, row: &[usize]) -> bool {
        let Some(combination) = self.combination(row) else { return false };
        let claims = &combination.claims;
        let (transport, theta, back, _) = self.place(row);
        let mode = match self.file.transport {
            Some(only) => only == transport,
            None => claims.transport.modes().contains(&transport),
        };
        // What has no directions is measured once, under the first of them.
        let &[.., theta_index, _, phi_index] = row else { return false };
        if !combination.kind.has_directions() && (theta_index, back, phi_index) != (0, false, 0) {
            return false;
        }
        let two_sides = self.file.sides && (claims.transmissive || claims.two_sided);
        mode && (!back || two_sides && !self.theta.contains(&(180.0 - theta)))
    }

    fn case(&self, row: &[usize]) -> Case<'static> {
        let combination = self.combination(row).expect("rows are admissible");
        let (transport, theta, back, phi) = self.place(row);
        let (file, entry) = (self.file, self.entry);
        Case {
            group: entry.label.clone().unwrap_or_else(|| entry.model.get_ref().clone()),
            spelling: combination.spelling.clone(),
            source: file.source_of(entry),
            subject: combination.subject.clone(),
            parameters: combination.parameters.clone(),
            theta_deg: if back { 180.0 - theta } else { theta },
            phi_deg: phi,
            transport,
            claims: entry.claims.clone(),
            waivers: entry.waivers.clone(),
            reference: combination.company.reference.as_ref().map(|(name, _)| name.clone()),
            company: combination.company.clone(),
            checks: file.checks.clone(),
            settings: Settings {
                samples: entry.samples.unwrap_or(file.settings.samples),
                ..file.settings.clone()
            },
        }
    }
}
