//! The rules of SARIF: what can be found, whether or not it was.

use super::findings::{Finding, Rule};
use super::manual::{HOME, cause_page, checks_page};
use super::sarif::{Help, Message};
use super::visible::one_line;
use crate::cause::Cause;
use crate::checks;
use serde::Serialize;
use std::collections::BTreeSet;

/// A rule (SARIF 2.1.0, §3.49).
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Descriptor {
    /// Stable.
    pub id: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    short_description: Message,
    full_description: Message,
    help_uri: String,
    help: Help,
    default_configuration: Configuration,
    properties: Properties,
}

#[derive(Debug, Serialize)]
struct Configuration {
    level: &'static str,
}

/// What GitHub reads beside the standard's own.
#[derive(Debug, Serialize)]
struct Properties {
    tags: [&'static str; 2],
    precision: &'static str,
    #[serde(rename = "problem.severity")]
    severity: &'static str,
}

/// `half-vector-jacobian` to `HalfVectorJacobian`; `None` where that says nothing more than
/// the id, which validators do not like.
fn pascal(id: &str) -> Option<String> {
    let words: Vec<&str> = id.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
    };
    (words.len() > 1).then(|| words.into_iter().map(capital).collect())
}

fn descriptor(id: String, short: String, full: String, uri: String, help: Help) -> Descriptor {
    Descriptor {
        name: pascal(&id),
        id,
        short_description: Message::new(&short),
        full_description: Message::new(&full),
        help_uri: uri,
        help,
        default_configuration: Configuration { level: "error" },
        properties: Properties { tags: ["bsdf", "correctness"], precision: "very-high", severity: "error" },
    }
}

fn of_cause(cause: Cause) -> Descriptor {
    let slug = cause.slug();
    // `# half-vector-jacobian: from half vectors to directions`
    let title = cause.page().lines().next().unwrap_or_default().trim_start_matches("# ");
    let help = Help { text: cause.page().into(), markdown: cause.page().into() };
    let uri = cause_page(slug).unwrap_or_default();
    descriptor(slug.into(), title.into(), cause.statement().into(), uri, help)
}

/// A rule whose help is one sentence.
fn brief(id: String, short: String, full: String) -> Descriptor {
    let help = Help { text: full.clone(), markdown: super::markdown_text::text(&full) };
    descriptor(id, short, full, checks_page(), help)
}

fn of_check(id: &str, hypothesis: &str) -> Descriptor {
    brief(
        Rule::Check(id).id(),
        format!("{} fails, and no cause is named", one_line(id)),
        format!("What must hold: {hypothesis}."),
    )
}

/// All rules that gonio has, and those that only these findings know: of a check or a
/// cause of another version.
pub fn rules(findings: &[Finding]) -> Vec<Descriptor> {
    let mut rules: Vec<Descriptor> = Cause::ALL.into_iter().map(of_cause).collect();
    rules.extend(checks::all().iter().map(|check| of_check(check.id(), check.hypothesis())));
    rules.push(brief(
        Rule::Unmeasured.id(),
        "A subject could not be measured".into(),
        "A subject crashed, hung, ran out of memory or broke the protocol; the message has the last that it said."
            .into(),
    ));
    let known: BTreeSet<String> = rules.iter().map(|rule| rule.id.clone()).collect();
    let others: BTreeSet<Rule> =
        findings.iter().map(|f| f.rule).filter(|rule| !known.contains(&rule.id())).collect();
    let mut added = BTreeSet::new();
    for rule in others {
        let id = rule.id();
        if added.insert(id.clone()) {
            let full = format!("This version of gonio ({HOME}) does not know it.");
            rules.push(brief(id.clone(), id, full));
        }
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cause_and_check_has_a_rule_and_ids_are_distinct() {
        let rules = rules(&[]);
        assert_eq!(rules.len(), Cause::ALL.len() + checks::all().len() + 1);
        let ids: BTreeSet<&str> = rules.iter().map(|r| r.id.as_str()).collect();
        assert_eq!(ids.len(), rules.len());
        for id in ["half-vector-jacobian", "normalization", "check/normalization", "unmeasured"] {
            assert!(ids.contains(id), "{id}");
        }
        let first = &rules[1];
        assert_eq!(first.name.as_deref(), Some("HalfVectorJacobian"));
        assert!(first.help_uri.ends_with("/docs/causes/half-vector-jacobian.md"));
        assert!(rules.iter().all(|r| r.help_uri.starts_with("https://")));
        assert!(rules.iter().all(|r| r.name.as_ref().is_none_or(|name| !name.eq_ignore_ascii_case(&r.id))));
    }
}
