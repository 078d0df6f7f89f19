//! The confusion matrix of diagnoses in words.

use super::confusion::{Confusion, Diagnosed, Named};
use super::part::{Part, PartId, Picture};
use crate::cause::Cause;
use std::collections::BTreeMap;

/// What diagnoses must reach: the right cause first, among the first two, and a wrong
/// one with confidence at most.
const FIRST: f64 = 0.90;
const FIRST_TWO: f64 = 0.97;
const CONFIDENTLY_WRONG: f64 = 0.01;

/// All trials of some mutants together.
fn sum<'r>(rows: impl Iterator<Item = &'r Named>) -> Named {
    rows.fold(Named::default(), |mut sum, n| {
        sum.confirmed += n.confirmed;
        sum.first += n.first;
        sum.first_two += n.first_two;
        sum.confidently_wrong += n.confidently_wrong;
        sum.none += n.none;
        for (cause, times) in &n.causes {
            *sum.causes.entry(cause.clone()).or_default() += times;
        }
        sum
    })
}

fn percent(part: usize, of: usize) -> String {
    format!("{:.1} %", 100.0 * part as f64 / of.max(1) as f64)
}

fn told(n: &Named) -> String {
    format!(
        "the right cause first in {} of {} diagnoses ({}), among the first two in {} ({}), a wrong one with confidence in {} ({}), none in {}",
        n.first,
        n.confirmed,
        percent(n.first, n.confirmed),
        n.first_two,
        percent(n.first_two, n.confirmed),
        n.confidently_wrong,
        percent(n.confidently_wrong, n.confirmed),
        n.none
    )
}

impl Confusion {
    fn table(&self, which: fn(&Diagnosed) -> &Named) -> Vec<String> {
        let mut by: BTreeMap<Cause, Vec<&Diagnosed>> = BTreeMap::new();
        for row in &self.rows {
            by.entry(row.cause).or_default().push(row);
        }
        let mut lines = vec![
            "| cause | mutants | diagnoses | right first | in the first two | confidently wrong | none | named instead |".to_string(),
            "|:--|--:|--:|--:|--:|--:|--:|:--|".into(),
        ];
        for (cause, rows) in by {
            let n = sum(rows.iter().map(|r| which(r)));
            let mut others: Vec<(&String, &usize)> =
                n.causes.iter().filter(|(c, _)| *c != cause.slug()).collect();
            others.sort_by_key(|(_, times)| usize::MAX - **times);
            let others: Vec<String> = others.iter().map(|(c, times)| format!("{c} {times}")).collect();
            lines.push(format!(
                "| {} | {} | {} | {} | {} | {} | {} | {} |",
                cause.slug(),
                rows.len(),
                n.confirmed,
                percent(n.first, n.confirmed),
                percent(n.first_two, n.confirmed),
                n.confidently_wrong,
                n.none,
                others.join(", ")
            ));
        }
        lines
    }
}

impl Part for Confusion {
    fn id(&self) -> PartId {
        PartId::Confusion
    }

    fn markdown(&self) -> String {
        let (declared, undeclared) =
            (sum(self.rows.iter().map(|r| &r.declared)), sum(self.rows.iter().map(|r| &r.undeclared)));
        let mut lines = vec![
            "## Diagnoses\n".to_string(),
            format!(
                "{} mutants, {} sets of random parameters and seeds each, at most {} draws a direction; only trials in which a check failed.\n",
                self.rows.len(),
                self.trials,
                self.samples
            ),
            format!("Where the model's parameters are declared: {}.\n", told(&declared)),
        ];
        lines.extend(self.table(|r| &r.declared));
        if undeclared.confirmed > 0 {
            lines.push(format!("\nWhere nothing is declared: {}.\n", told(&undeclared)));
            lines.extend(self.table(|r| &r.undeclared));
        }
        lines.push("\nCauses that no measurement tells apart count as one:\n".into());
        for row in self.rows.iter().filter(|r| !r.equivalent.is_empty()) {
            for (cause, why) in &row.equivalent {
                lines.push(format!("- {}: {} or {}: {why}.", row.mutant, row.cause.slug(), cause.slug()));
            }
        }
        lines.push("\nWhere the right cause was not named first:\n".into());
        for row in &self.rows {
            let mut say = |n: &Named, kind: &str| {
                if let Some(wrong) = &n.wrong {
                    let times = n.confirmed - n.first;
                    lines.push(format!(
                        "- {} [{}]{kind}: {times} of {}: {wrong}",
                        row.mutant,
                        row.cause.slug(),
                        n.confirmed
                    ));
                }
            };
            say(&row.declared, "");
            say(&row.undeclared, " (undeclared)");
        }
        lines.join("\n") + "\n"
    }

    fn pictures(&self) -> Vec<Picture> {
        Vec::new()
    }

    fn errors(&self) -> Vec<String> {
        let n = sum(self.rows.iter().map(|r| &r.declared));
        let share = |part: usize| part as f64 / n.confirmed.max(1) as f64;
        let mut errors = Vec::new();
        if share(n.first) < FIRST
            || share(n.first_two) < FIRST_TWO
            || share(n.confidently_wrong) > CONFIDENTLY_WRONG
        {
            errors.push(format!("diagnoses: {}", told(&n)));
        }
        errors
    }

    fn summary(&self) -> Vec<String> {
        let named = |which: fn(&Diagnosed) -> &Named| sum(self.rows.iter().map(which));
        let (declared, undeclared) = (named(|r| &r.declared), named(|r| &r.undeclared));
        let mut lines = vec![format!("diagnoses: {}", told(&declared))];
        if undeclared.confirmed > 0 {
            lines.push(format!("  without declared parameters: {}", told(&undeclared)));
        }
        lines
    }
}
