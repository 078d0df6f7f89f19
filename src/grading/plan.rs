//! What a rubric measures of every submission alike.

use super::held::Held;
use super::rubric::{Item, Rubric};
use crate::bsdf::{Claims, ClaimsPatch, Precision, Subject, Transport};
use crate::checks;
use crate::evidence::Company;
use crate::registry::{Parameters, Registry, Spelling};
use crate::statistics::budget::Budget;
use crate::suite::{Case, Plan, Settings, variants};
use std::collections::HashMap;
use std::sync::Arc;

/// The reference that is the teacher's own submission.
pub const SOLUTION: &str = "solution";

/// What a rubric measures of every submission alike: items that look at the same subject at
/// the same direction on the same terms share a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Cases, those of a subject together.
    pub cases: Vec<Planned>,
    /// The cases of each item of the rubric.
    pub of_item: Vec<Vec<usize>>,
    /// The false-alarm share of each statistical test.
    pub share: f64,
    /// Statistical tests, those of hidden items included.
    pub tests: usize,
}

/// A case of any submission.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// The subject, MODEL:KEY=VALUE,….
    pub spelling: String,
    /// Polar angle of wo in degrees.
    pub theta: f64,
    /// Azimuth of wo in degrees.
    pub phi: f64,
    /// The mode of transport.
    pub transport: Transport,
    /// Ids of its checks, in the order of reports.
    pub checks: Vec<String>,
    /// What the subject is held to besides what its model is.
    pub claims: ClaimsPatch,
    /// What eval is compared with.
    pub reference: Option<String>,
    /// How loosely.
    pub within: Option<f64>,
    /// Sharpness.
    pub settings: Settings,
    /// What tells it from another case of its subject and direction.
    label: Option<String>,
}

impl Measurement {
    /// What a rubric measures. The share is that of the items that are not hidden: hidden
    /// ones are held to the same thresholds, with or without which a student measures.
    pub fn of(rubric: &Rubric) -> Self {
        let mut cases: Vec<Planned> = Vec::new();
        let mut of_item = Vec::new();
        let mut public = 0;
        for item in &rubric.items {
            let mut own = Vec::new();
            for planned in of(item) {
                let index = match cases.iter().position(|other| other.shares_with(&planned)) {
                    Some(index) => index,
                    None => {
                        let twin = cases.iter().any(|other| other.place() == planned.place());
                        let label = twin.then(|| format!("{} ({})", name_of(&planned.spelling), item.id));
                        cases.push(Planned { checks: Vec::new(), label, ..planned.clone() });
                        cases.len() - 1
                    }
                };
                cases[index].add(&planned);
                own.push(index);
            }
            of_item.push(own);
            // Hidden items stand last.
            if !item.hidden {
                public = cases.iter().map(Planned::tests).sum();
            }
        }
        let tests = cases.iter().map(Planned::tests).sum();
        let share = Budget { total: rubric.false_alarm }.share(public);
        let mut found = Self { cases, of_item, share, tests };
        found.sort();
        found
    }

    /// Cases of a subject stand together.
    fn sort(&mut self) {
        let mut first: Vec<String> = Vec::new();
        for case in &self.cases {
            if !first.contains(&case.spelling) {
                first.push(case.spelling.clone());
            }
        }
        let mut order: Vec<usize> = (0..self.cases.len()).collect();
        order.sort_by_key(|k| first.iter().position(|s| *s == self.cases[*k].spelling));
        let mut place = vec![0; order.len()];
        for (now, before) in order.iter().enumerate() {
            place[*before] = now;
        }
        self.cases = order.iter().map(|k| self.cases[*k].clone()).collect();
        self.of_item.iter_mut().flatten().for_each(|index| *index = place[*index]);
    }

    /// The probability that a correct submission loses any point: at most this.
    pub fn budget(&self) -> f64 {
        self.share * self.tests as f64
    }

    /// The plan for a submission whose models are registered. `solution` has those of the
    /// teacher's, `more` what references name besides.
    ///
    /// # Errors
    /// What the submission does not offer, in a sentence.
    pub fn plan(
        &self,
        rubric: &Rubric,
        registry: &Registry,
        solution: Option<&Registry>,
        more: &Registry,
    ) -> Result<Plan<'static>, String> {
        let mut made: HashMap<&str, (Arc<dyn Subject>, Parameters)> = HashMap::new();
        let mut cases = Vec::new();
        for planned in &self.cases {
            let spelling: Spelling = planned.spelling.parse().map_err(said)?;
            let claims = rubric.models.get(&spelling.name).cloned().unwrap_or_default();
            let (subject, parameters) = match made.get(planned.spelling.as_str()) {
                Some(made) => made.clone(),
                None => {
                    let resolved = registry.resolve(&spelling).map_err(said)?;
                    let subject = held(resolved.subject, &claims, rubric.precision, false);
                    made.insert(&planned.spelling, (subject.clone(), resolved.parameters.clone()));
                    (subject, resolved.parameters)
                }
            };
            let reference = match &planned.reference {
                Some(text) if text == SOLUTION => match solution {
                    Some(solution) => {
                        let subject = solution.resolve(&spelling).map_err(said)?.subject;
                        Some((SOLUTION.to_string(), subject))
                    }
                    None => None,
                },
                Some(text) => {
                    let text = filled(text, &parameters);
                    let resolved = text.parse().and_then(|s: Spelling| more.resolve(&s)).map_err(said)?;
                    Some((resolved.spelling, resolved.subject))
                }
                None => None,
            };
            let reference =
                reference.map(|(name, subject)| (name, held(subject, &claims, rubric.precision, true)));
            let varies = planned.checks.iter().any(|check| check == "sensitivity");
            let model = registry.model(&spelling.name).map_err(said)?;
            cases.push(Arc::new(Case {
                group: planned.label.clone().unwrap_or_else(|| spelling.name.clone()),
                spelling: planned.spelling.clone(),
                source: None,
                subject,
                theta_deg: planned.theta,
                phi_deg: planned.phi,
                transport: planned.transport,
                claims: planned.claims.clone(),
                waivers: Vec::new(),
                reference: reference.as_ref().map(|(name, _)| name.clone()),
                company: Company {
                    variants: if varies { variants(registry, &model, &parameters) } else { Vec::new() },
                    reference,
                    within: planned.within,
                },
                parameters,
                checks: planned.checks.clone(),
                settings: planned.settings.clone(),
            }));
        }
        Ok(Plan {
            suite: rubric.title.clone(),
            seed: rubric.seed,
            false_alarm: self.budget(),
            share: Some(self.share),
            cases,
        })
    }
}

/// The model of a subject.
fn name_of(spelling: &str) -> &str {
    spelling.split(':').next().unwrap_or(spelling)
}

fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn held(
    subject: Arc<dyn Subject>,
    claims: &ClaimsPatch,
    precision: Precision,
    eval_only: bool,
) -> Arc<dyn Subject> {
    Arc::new(Held { subject, claims: claims.over(Claims::default()), precision, eval_only })
}

/// `{KEY}`s are the values of parameters.
fn filled(text: &str, parameters: &Parameters) -> String {
    let fill = |text: String, (name, value): (&String, &crate::registry::Value)| {
        text.replace(&format!("{{{name}}}"), &value.to_string())
    };
    parameters.0.iter().fold(text.to_string(), fill)
}

/// The cases of an item.
fn of(item: &Item) -> impl Iterator<Item = Planned> {
    let at = |spelling: &String, theta: f64, phi: f64| Planned {
        spelling: spelling.clone(),
        theta,
        phi,
        transport: item.transport,
        checks: item.checks.clone(),
        claims: item.claims.clone(),
        reference: item.reference.clone(),
        within: item.within,
        settings: item.settings.clone(),
        label: None,
    };
    item.subjects
        .iter()
        .flat_map(move |s| item.theta.iter().flat_map(move |t| item.phi.iter().map(move |p| at(s, *t, *p))))
}

impl Planned {
    fn place(&self) -> (&str, u64, u64, Transport) {
        (&self.spelling, self.theta.to_bits(), self.phi.to_bits(), self.transport)
    }

    /// Whether another item's case can be measured along with this one.
    fn shares_with(&self, other: &Self) -> bool {
        let compared = |case: &Self| case.reference.clone().map(|r| (r, case.within.map(f64::to_bits)));
        let one = match (compared(self), compared(other)) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        };
        one && self.place() == other.place() && self.claims == other.claims && self.settings == other.settings
    }

    fn add(&mut self, other: &Self) {
        if self.reference.is_none() {
            self.reference.clone_from(&other.reference);
            self.within = other.within;
        }
        self.checks.extend(other.checks.iter().cloned());
        self.checks.sort_by_key(|id| checks::all().iter().position(|c| c.id() == id));
        self.checks.dedup();
    }

    /// Statistical tests, were all of them to apply: no submission has other thresholds than
    /// its neighbour.
    fn tests(&self) -> usize {
        self.checks.iter().filter(|id| checks::find(id).is_some_and(|c| c.is_statistical())).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grading::load;

    const RUBRIC: &str = r#"
[rubric]
hidden = "hidden.toml"
false_alarm = 1e-4
theta = [30, 70]
[[language]]
when = "x"
wasm = "x.wasm"
[model.lambert]
[[item]]
id = "builds"
points = 1
[[item]]
id = "pdf"
points = 1
subject = ["lambert", "lambert:reflectance=0.2"]
checks = ["normalization", "sanity"]
[[item]]
id = "fit"
points = 1
subject = "lambert"
checks = "goodness-of-fit"
[[item]]
id = "other-terms"
points = 1
subject = "lambert"
checks = "goodness-of-fit"
samples = "2^15"
theta = 70
"#;

    const HIDDEN: &str = "seed = 9\n[[item]]\nid = 'more'\npoints = 1\nsubject = 'lambert'\nchecks = ['mis', 'albedo']\ntheta = [30, 10]\n";

    fn measurement(hidden: bool) -> (Rubric, Measurement) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("rubric.toml"), RUBRIC).unwrap();
        std::fs::write(folder.path().join("hidden.toml"), HIDDEN).unwrap();
        let rubric = load(&folder.path().join("rubric.toml"), hidden).unwrap();
        let measurement = Measurement::of(&rubric);
        (rubric, measurement)
    }

    #[test]
    fn items_share_cases_and_students_have_the_same_thresholds() {
        let (_, own) = measurement(false);
        let (rubric, all) = measurement(true);
        let names: Vec<_> =
            all.cases.iter().map(|c| (c.spelling.as_str(), c.theta, c.checks.join(" "))).collect();
        let many = "sanity goodness-of-fit normalization albedo mis";
        assert_eq!(
            names,
            [
                ("lambert", 30.0, many.to_string()),
                ("lambert", 70.0, "sanity goodness-of-fit normalization".into()),
                ("lambert", 70.0, "goodness-of-fit".into()),
                ("lambert", 10.0, "albedo mis".into()),
                ("lambert:reflectance=0.2", 30.0, "sanity normalization".into()),
                ("lambert:reflectance=0.2", 70.0, "sanity normalization".into()),
            ]
        );
        assert_eq!(all.of_item, [vec![], vec![0, 1, 4, 5], vec![0, 1], vec![2], vec![0, 3]]);
        assert_eq!(own.share, all.share);
        assert!(own.budget() <= 1e-4 && own.budget() > 0.999e-4, "{}", own.budget());
        let tests = |m: &Measurement| m.tests as f64;
        assert!((all.budget() / own.budget() - tests(&all) / tests(&own)).abs() < 1e-12);
        let plan = all.plan(&rubric, &Registry::builtin(), None, &Registry::builtin()).unwrap();
        assert_eq!((plan.seed, plan.share), (9, Some(all.share)));
        let groups: Vec<&str> = plan.cases.iter().map(|c| c.group.as_str()).collect();
        assert_eq!(groups[1..3], ["lambert", "lambert (other-terms)"], "told apart where they lie");
    }

    #[test]
    fn what_is_not_offered_is_told() {
        let (rubric, measurement) = measurement(false);
        let none = measurement.plan(&rubric, &Registry::empty(), None, &Registry::empty());
        assert!(none.err().unwrap().contains("lambert"));
    }

    #[test]
    fn a_reference_takes_the_parameters_of_its_subject() {
        let parameters = Parameters([("alpha".to_string(), crate::registry::Value::Number(0.25))].into());
        assert_eq!(
            filled("torrance-sparrow:alpha={alpha},masking=smith", &parameters),
            "torrance-sparrow:alpha=0.25,masking=smith"
        );
    }
}
