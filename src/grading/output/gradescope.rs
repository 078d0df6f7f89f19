//! results.json of Gradescope: <https://gradescope-autograders.readthedocs.io/en/latest/specs/>.

use super::super::ItemKind;
use super::feedback::{Feedback, ItemTold};
use super::plain;
use crate::report::visible::{one_line, visible};
use serde::Serialize;

#[derive(Serialize)]
struct Results {
    score: f64,
    output: String,
    output_format: &'static str,
    test_output_format: &'static str,
    test_name_format: &'static str,
    stdout_visibility: &'static str,
    tests: Vec<Test>,
    extra_data: Extra,
}

#[derive(Serialize)]
struct Test {
    name: String,
    number: String,
    score: f64,
    max_score: f64,
    status: &'static str,
    output: String,
    visibility: &'static str,
}

/// What programs may read: nothing that students may not.
#[derive(Serialize)]
struct Extra {
    gonio: &'static str,
    submission: String,
    causes: Vec<String>,
}

/// The file: equal feedback gives equal bytes. Texts are plain, as what Gradescope keeps
/// of HTML is not documented.
pub fn results(feedback: &Feedback) -> String {
    let mut tests: Vec<Test> =
        feedback.items.iter().enumerate().map(|(n, item)| test(n + 1, item, feedback)).collect();
    tests.extend(floor(feedback));
    let results = Results {
        score: feedback.score,
        output: plain::summary(feedback).join("\n\n"),
        output_format: "text",
        test_output_format: "text",
        test_name_format: "text",
        stdout_visibility: "hidden",
        tests,
        extra_data: Extra {
            gonio: env!("CARGO_PKG_VERSION"),
            submission: visible(feedback.id),
            causes: feedback.causes.iter().map(|c| visible(c.slug)).collect(),
        },
    };
    serde_json::to_string_pretty(&results).unwrap_or_default() + "\n"
}

/// Hidden items appear when the teacher publishes: else each upload would measure them.
fn visibility(item: &ItemTold) -> &'static str {
    if item.hidden { "after_published" } else { "visible" }
}

fn test(number: usize, item: &ItemTold, feedback: &Feedback) -> Test {
    let lost = feedback.lost.iter().find(|lost| lost.item.id == item.id);
    let kind = match item.kind {
        ItemKind::Regular => "",
        ItemKind::Bonus => " (bonus)",
        ItemKind::Penalty => " (penalty)",
    };
    Test {
        name: one_line(item.title) + kind,
        number: number.to_string(),
        score: item.earned,
        // What is on top, or is taken, is no part of what can be reached.
        max_score: if item.kind == ItemKind::Regular { item.points } else { 0.0 },
        status: if item.is_lost { "failed" } else { "passed" },
        output: lost.map_or(String::new(), |lost| plain::item(lost, &feedback.causes).join("\n")),
        visibility: visibility(item),
    }
}

/// What makes the tests sum up to a score that penalties would take below 0.
fn floor(feedback: &Feedback) -> Option<Test> {
    let sum: f64 = feedback.items.iter().map(|item| item.earned).sum();
    let missing = feedback.score - sum;
    // Rounding aside.
    (missing.abs() > 1e-9).then(|| Test {
        name: "A score is at least 0".into(),
        number: (feedback.items.len() + 1).to_string(),
        score: missing,
        max_score: 0.0,
        status: "passed",
        output: "Penalties take no more than there is.".into(),
        visibility: "visible",
    })
}

#[cfg(test)]
mod tests {
    use super::super::examples::{SEED, broken, hostile, whole};
    use super::*;
    use crate::grading::Grade;
    use serde_json::Value;

    const SCHEMA: &str = include_str!("../../../tests/data/grading/gradescope.schema.json");

    fn of(grade: &Grade) -> Value {
        let value =
            serde_json::from_str(&results(&Feedback::of(grade, "gonio grade --self rubric.toml ."))).unwrap();
        let schema: Value = serde_json::from_str(SCHEMA).unwrap();
        let validator = jsonschema::validator_for(&schema).unwrap();
        let errors: Vec<String> =
            validator.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{errors:?}");
        value
    }

    fn sum(value: &Value) -> f64 {
        value["tests"].as_array().unwrap().iter().map(|t| t["score"].as_f64().unwrap()).sum()
    }

    #[test]
    fn tests_sum_up_to_the_score() {
        let grade = whole("");
        let value = of(&grade);
        assert!(
            (sum(&value) - grade.score).abs() < 1e-12
                && (value["score"].as_f64().unwrap() - grade.score).abs() < 1e-12
        );
        let max: f64 =
            value["tests"].as_array().unwrap().iter().map(|t| t["max_score"].as_f64().unwrap()).sum();
        assert_eq!(max, grade.max, "a bonus and a penalty are no part of the maximum");
        let below = Grade { score: 0.0, items: vec![grade.items[5].clone()], ..grade };
        let value = of(&below);
        assert_eq!((sum(&value), value["tests"][1]["score"].as_f64()), (0.0, Some(0.5)));
    }

    #[test]
    fn items_tell_what_their_page_tells() {
        let value = of(&whole(""));
        let test = |n: usize| &value["tests"][n];
        assert_eq!((test(0)["status"].as_str(), test(0)["output"].as_str()), (Some("passed"), Some("")));
        assert!(test(1)["output"].as_str().unwrap().contains("gonio explain half-vector-jacobian"));
        assert_eq!(test(4)["name"], "Title of grazing (bonus)");
        assert_eq!(test(6)["visibility"], "after_published");
        assert_eq!(test(6)["output"], "Text of secret.");
        assert_eq!(value["extra_data"]["causes"], serde_json::json!(["half-vector-jacobian"]));
        assert!(!value.to_string().contains(&SEED.to_string()));
    }

    #[test]
    fn what_does_not_build_and_what_is_hostile_is_a_file_too() {
        assert!(of(&broken())["output"].as_str().unwrap().contains("unknown type name"));
        of(&hostile(""));
        of(&Grade { items: Vec::new(), ..whole("") });
    }
}
