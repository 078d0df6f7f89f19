//! What is worth an alert.

use super::site::{Site, Spot};
use super::visible::{one_line, visible};
use crate::bsdf::Transport;
use crate::checks::Verdict;
use crate::comparison::Comparison;
use crate::report::json::{CheckResult, Diagnosis, Report, SubjectId};
use crate::report::wording::{direction, effect};
use std::collections::{BTreeMap, BTreeSet};

/// What a finding is about: the same of the same mistake in every run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule<'a> {
    /// A named cause of failures.
    Cause(&'a str),
    /// A check.
    Check(&'a str),
    /// The subject could not be measured.
    Unmeasured,
}

impl Rule<'_> {
    /// Its stable name.
    pub fn id(&self) -> String {
        match self {
            Self::Cause(slug) => one_line(slug),
            Self::Check(check) => format!("check/{}", one_line(check)),
            Self::Unmeasured => "unmeasured".into(),
        }
    }
}

/// Results of one subject that tell the same.
#[derive(Debug)]
pub struct Finding<'a> {
    /// Of what.
    pub subject: &'a SubjectId,
    /// What is told.
    pub rule: Rule<'a>,
    /// The verdict of all its results.
    pub verdict: Verdict,
    /// Its results, those of a check together, the clearest of each first.
    pub results: Vec<&'a CheckResult>,
    /// What is wrong, of a failure.
    pub diagnosis: Option<&'a Diagnosis>,
    /// Where to go.
    pub spot: Spot,
    /// The subject as people know it.
    pub name: String,
    /// Whether the baseline has it too; `None` where there is no baseline.
    pub known: Option<bool>,
}

/// How many times what is tolerated.
fn size(result: &CheckResult) -> f64 {
    result.effect.as_ref().map_or(0.0, |e| (e.value.0 / e.tolerance.0).abs())
}

/// The findings of a report: errors first, then failures, what is unclear, warnings, and
/// what is waived; in the report's order otherwise.
pub fn findings<'a>(report: &'a Report, site: &Site) -> Vec<Finding<'a>> {
    let told =
        [Verdict::Error, Verdict::Fail, Verdict::Warn, Verdict::Inconclusive, Verdict::Waived].into_iter();
    let mut found: Vec<Finding<'a>> = Vec::new();
    let mut places = BTreeMap::new();
    let mut diagnoses: BTreeMap<&str, &Diagnosis> = BTreeMap::new();
    for diagnosis in &report.diagnoses {
        diagnoses.entry(&diagnosis.subject).or_insert(diagnosis);
    }
    for verdict in told {
        for result in report.results.iter().filter(|r| r.verdict == verdict) {
            let subject = &result.subject;
            let diagnosis =
                diagnoses.get(subject.name.as_str()).copied().filter(|_| verdict == Verdict::Fail);
            let rule = match diagnosis.and_then(|d| d.cause.as_deref()) {
                _ if verdict == Verdict::Error => Rule::Unmeasured,
                Some(slug) => Rule::Cause(slug),
                None => Rule::Check(&result.check),
            };
            let at = *places.entry((verdict, rule, &subject.name, &subject.label)).or_insert_with(|| {
                let (spot, name) = (site.spot(report, subject), name(subject, site));
                let results = Vec::new();
                found.push(Finding { subject, rule, verdict, results, diagnosis, spot, name, known: None });
                found.len() - 1
            });
            found[at].results.push(result);
        }
    }
    for finding in &mut found {
        let known = |c: &Comparison| finding.results.iter().all(|r| c.knows(r));
        finding.known = report.comparison.as_ref().filter(|_| finding.is_wrong()).map(known);
        let order: Vec<&str> = finding.checks();
        let place = |r: &CheckResult| order.iter().position(|c| *c == r.check);
        finding.results.sort_by(|a, b| place(a).cmp(&place(b)).then(size(b).total_cmp(&size(a))));
    }
    found
}

impl<'a> Finding<'a> {
    /// Whether it fails a run that has no baseline.
    pub fn is_wrong(&self) -> bool {
        matches!(self.verdict, Verdict::Error | Verdict::Fail)
    }

    /// Whether the baseline fails so too, so that it fails no gate.
    pub fn is_known(&self) -> bool {
        self.known == Some(true)
    }

    /// The clearest result of its first check.
    pub fn lead(&self) -> &'a CheckResult {
        self.results[0]
    }

    /// Its checks, in the report's order.
    pub fn checks(&self) -> Vec<&'a str> {
        let mut checks: Vec<&str> = Vec::new();
        for result in &self.results {
            if !checks.contains(&result.check.as_str()) {
                checks.push(&result.check);
            }
        }
        checks
    }

    /// Why the suite accepts it.
    pub fn because(&self) -> Option<String> {
        let reasons: BTreeSet<String> =
            self.results.iter().filter_map(|r| Some(one_line(r.waived_because.as_ref()?))).collect();
        (!reasons.is_empty()).then(|| reasons.into_iter().collect::<Vec<_>>().join("; "))
    }

    /// In one sentence, without the subject.
    pub fn headline(&self) -> String {
        let lead = self.lead();
        let (check, said) = (one_line(&lead.check), one_line(&lead.message));
        let reason = || in_short(lead.reason.as_ref().unwrap_or(&lead.message));
        match (self.verdict, self.diagnosis) {
            (_, Some(found)) if found.cause.is_some() => one_line(&found.statement),
            (Verdict::Error, _) => format!("could not be measured: {}", reason()),
            (Verdict::Warn, _) => format!("{check} warns: {said}"),
            (Verdict::Inconclusive, _) => format!("{check} could not decide: {}", reason()),
            (Verdict::Waived, _) => match self.because() {
                Some(because) => format!("{check} fails, which is accepted: {because}"),
                None => format!("{check} fails, which is accepted"),
            },
            _ => format!("{check} fails: {said}"),
        }
    }

    /// What speaks for the headline: repair, checks with their largest effects, and the
    /// command that reproduces the first, each on its line.
    pub fn details(&self) -> Vec<String> {
        let (lead, mut lines) = (self.lead(), Vec::new());
        if let Some(found) = self.diagnosis {
            match &found.cause {
                Some(_) => lines.extend(found.repair.iter().map(|r| format!("repair: {}", one_line(r)))),
                None => lines.push(one_line(&found.statement)),
            }
        }
        if self.verdict == Verdict::Error {
            let why = lead.reason.as_ref().unwrap_or(&lead.message);
            lines.extend(visible(why).lines().map(str::to_string));
            let checks: Vec<String> = self.checks().into_iter().map(one_line).collect();
            lines.push(format!("no result of {}", checks.join(", ")));
        }
        for check in self.checks().into_iter().filter(|_| self.verdict != Verdict::Error) {
            let of: Vec<_> = self.results.iter().filter(|r| r.check == check).collect();
            lines.push(format!("{}: {}", one_line(check), told(of[0], of.len())));
        }
        lines.push(format!("reproduce: {}", one_line(&lead.command)));
        lines
    }

    /// Names it among all findings, and in later runs: not by numbers, which a seed or
    /// more samples change.
    pub fn fingerprint(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for part in [&self.name, &self.rule.id(), self.verdict.word()] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part.as_bytes());
        }
        hasher.finalize().to_hex()[..32].to_string()
    }
}

/// A subject as people know it, the same on every machine: after its label where that is
/// another.
pub fn name(subject: &SubjectId, site: &Site) -> String {
    let spelled = one_line(&site.portable(&subject.name));
    match &subject.label {
        Some(label) if *label != subject.name => format!("{}: {spelled}", one_line(label)),
        _ => spelled,
    }
}

/// Where a case is: the direction, and the mode of transport where it is not radiance.
pub fn place(result: &CheckResult) -> String {
    let mode = (result.transport != Transport::Radiance).then(|| result.transport.to_string());
    let parts: Vec<String> = result.wo.map(direction).into_iter().chain(mode).collect();
    parts.join(" ")
}

/// Of what a program said at length, the first line and the last: a traceback ends with
/// what went wrong.
pub fn in_short(said: &str) -> String {
    let lines: Vec<&str> = said.trim().lines().collect();
    match lines[..] {
        [first, .., last] => one_line(&format!("{first} … {last}")),
        _ => one_line(said),
    }
}

fn told(clearest: &CheckResult, directions: usize) -> String {
    let at = place(clearest);
    let at = if at.is_empty() { String::new() } else { format!(" at {at}") };
    let more = match directions {
        1 => String::new(),
        n => format!(" (and {} more)", n - 1),
    };
    let what = clearest.effect.as_ref().map_or_else(|| one_line(&clearest.message), |e| one_line(&effect(e)));
    format!("{what}{at}{more}")
}

#[cfg(test)]
mod tests {
    use super::super::examples::{report, site};
    use super::*;
    use crate::comparison::compare;

    #[test]
    fn a_cause_stands_for_all_failures_of_its_subject() {
        let mut report = report();
        let mut other = report.results[2].clone();
        other.check = "mis".into();
        report.results.push(other);
        let found = findings(&report, &site());
        let rules: Vec<String> = found.iter().map(|f| f.rule.id()).collect();
        assert_eq!(rules, ["half-vector-jacobian", "check/albedo"]);
        assert_eq!(found[0].checks(), ["goodness-of-fit", "mis"]);
        assert_eq!(found[0].lead().wo.unwrap().theta_deg, 60.0, "the clearest leads");
        assert_eq!(found[0].headline(), "pdf() lacks the factor 1/(4 wo·h)");
        let details = found[0].details();
        assert_eq!(details[0], "repair: divide by 4 wo·h");
        assert!(
            details[1].starts_with("goodness-of-fit: √D = 1.20 %") && details[1].ends_with("(and 1 more)")
        );
        assert!(details.last().unwrap().starts_with("reproduce: gonio check ggx:alpha=0.5"));
        assert_eq!(found[1].headline(), "albedo could not decide: would only have seen an error of 5 %");
    }

    #[test]
    fn without_a_cause_each_check_is_told() {
        let mut report = report();
        report.diagnoses[0].cause = None;
        report.diagnoses[0].statement = "none of the explanations fits".into();
        let found = findings(&report, &site());
        assert_eq!(found[0].rule.id(), "check/goodness-of-fit");
        assert!(found[0].headline().starts_with("goodness-of-fit fails: samples are off"));
        assert_eq!(found[0].details()[0], "none of the explanations fits");
        report.diagnoses.clear();
        assert_eq!(findings(&report, &site())[0].rule.id(), "check/goodness-of-fit");
    }

    #[test]
    fn errors_of_a_subject_are_one_and_verdicts_are_apart() {
        let mut report = report();
        for result in &mut report.results[..2] {
            result.verdict = Verdict::Error;
            result.reason = Some("the program\nit\nended".into());
        }
        report.results[3].verdict = Verdict::Waived;
        report.results[3].waived_because = Some("coat".into());
        let found = findings(&report, &site());
        assert_eq!((found[0].rule, found[0].results.len()), (Rule::Unmeasured, 2));
        assert_eq!(found[0].headline(), "could not be measured: the program … ended");
        assert_eq!(found[0].details()[..3], ["the program", "it", "ended"]);
        let waived = found.last().unwrap();
        assert_eq!(waived.headline(), "goodness-of-fit fails, which is accepted: coat");
        assert_eq!(waived.rule, Rule::Check("goodness-of-fit"), "a cause is told of failures alone");
    }

    #[test]
    fn what_the_baseline_has_too_is_known() {
        let known = |before: &Report| {
            let mut after = report();
            after.comparison = Some(compare(before, &after));
            findings(&after, &site()).iter().map(|f| f.known).collect::<Vec<_>>()
        };
        assert_eq!(known(&report()), [Some(true), None]);
        let mut sound = report();
        sound.results[3].verdict = Verdict::Pass;
        assert_eq!(known(&sound), [Some(false), None]);
        assert_eq!(findings(&report(), &site())[0].known, None);
    }

    #[test]
    fn fingerprints_are_the_same_in_a_run_of_other_numbers_and_differ_otherwise() {
        let first = report();
        let mut second = report();
        second.seed = 99;
        second.results.reverse();
        for result in &mut second.results {
            result.message = "other words".into();
            result.log10_p = None;
            result.command = "gonio check --seed 99".into();
        }
        second.diagnoses[0].statement = "pdf() lacks 1/(4 wo·h) at 99 places".into();
        let of = |report: &Report| -> BTreeSet<String> {
            findings(report, &site()).iter().map(Finding::fingerprint).collect()
        };
        assert_eq!(of(&first), of(&second));
        assert_eq!(of(&first).len(), 2);
        second.results.iter_mut().for_each(|r| r.subject.name.push('!'));
        assert!(of(&first).is_disjoint(&of(&second)));
    }
}
