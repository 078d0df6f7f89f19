//! results.json of PrairieLearn:
//! <https://prairielearn.readthedocs.io/en/latest/externalGrading/#grading-results>.

use super::super::{Grade, ItemKind};
use super::feedback::{Feedback, ItemTold};
use super::pictures::{Drawn, Shown};
use super::plain;
use super::points::share;
use crate::report::visible::one_line;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// The file has to be smaller: "limited to 1 MB".
const LIMIT: usize = 1_000_000;

/// Characters of a text at most, in turn, until the file is small enough.
const LONGEST: [usize; 6] = [20_000, 4_000, 1_000, 300, 80, 0];

#[derive(Serialize)]
struct Results {
    gradable: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    score: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    format_errors: Vec<String>,
    message: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    output: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    images: Vec<Image>,
    tests: Vec<Test>,
}

#[derive(Serialize)]
struct Image {
    label: String,
    url: String,
}

#[derive(Serialize)]
struct Test {
    name: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    description: String,
    points: f64,
    max_points: f64,
    message: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    output: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    images: Vec<Image>,
}

/// How much room there is.
#[derive(Clone, Copy)]
struct Room {
    /// Pictures, those of what costs most first.
    pictures: usize,
    /// Characters of a text.
    longest: usize,
}

/// The file: equal grades give equal bytes, fewer than a million. Pictures go first, those
/// of what costs least before others, then texts become shorter; the message says so.
pub fn results(grade: &Grade, feedback: &Feedback, drawn: &Drawn) -> String {
    let all = drawn.causes.len() + drawn.items.len();
    let fewer = (0..=all).rev().map(|pictures| Room { pictures, longest: LONGEST[0] });
    let shorter = LONGEST[1..].iter().map(|longest| Room { pictures: 0, longest: *longest });
    let mut text = String::new();
    for room in fewer.chain(shorter) {
        text = serde_json::to_string(&made(grade, feedback, drawn, room)).unwrap_or_default() + "\n";
        if text.len() < LIMIT {
            break;
        }
    }
    text
}

fn made(grade: &Grade, feedback: &Feedback, drawn: &Drawn, room: Room) -> Results {
    let mut left = room.pictures;
    let mut take = |shown: Option<&Shown>| -> Vec<Image> {
        let shown = shown.filter(|_| left > 0);
        left -= usize::from(shown.is_some());
        shown.into_iter().map(image).collect()
    };
    let images = feedback.causes.iter().flat_map(|c| take(drawn.causes.get(c.slug))).collect();
    // Asked in the order of what costs most, told in the rubric's.
    let mut of_items: Vec<(&str, Vec<Image>)> =
        feedback.lost.iter().map(|lost| (lost.item.id, take(drawn.items.get(lost.item.id)))).collect();
    let mut pictures_of = |id: &str| {
        of_items
            .iter_mut()
            .find(|(of, _)| *of == id)
            .map(|(_, images)| std::mem::take(images))
            .unwrap_or_default()
    };
    let tests = feedback.items.iter().map(|item| test(item, feedback, pictures_of(item.id), room)).collect();
    let mut message = plain::summary(feedback).join("\n\n");
    if room.pictures < drawn.causes.len() + drawn.items.len() {
        message += "\n\nPictures are left out here, for want of room: your feedback page has them.";
    }
    let (why, said) = feedback.broken.as_ref().map_or(("", ""), |(why, said)| (why, said));
    Results {
        gradable: feedback.broken.is_none(),
        // A bonus cannot lead beyond 1.
        score: feedback.broken.is_none().then(|| share(grade).clamp(0.0, 1.0)),
        format_errors: if feedback.broken.is_some() { vec![cut(&one_line(why), room)] } else { Vec::new() },
        message: cut(&message, room),
        output: cut(said, room),
        images,
        tests,
    }
}

fn test(item: &ItemTold, feedback: &Feedback, images: Vec<Image>, room: Room) -> Test {
    let lost = feedback.lost.iter().find(|lost| lost.item.id == item.id);
    let kind = match item.kind {
        ItemKind::Regular => "",
        ItemKind::Bonus => " (bonus)",
        ItemKind::Penalty => " (penalty)",
    };
    let found = lost.map(|lost| plain::item(lost, &feedback.causes).join("\n")).unwrap_or_default();
    let hidden = if item.hidden { "Hidden: what it measures is not told." } else { "" };
    Test {
        name: cut(&(one_line(item.title) + kind), Room { longest: room.longest.max(80), ..room }),
        description: hidden.into(),
        points: item.earned,
        // What is on top, or is taken, is no part of what can be reached.
        max_points: if item.kind == ItemKind::Regular { item.points } else { 0.0 },
        message: if item.is_lost { "Points were lost." } else { "Nothing is wrong." }.into(),
        output: cut(&found, room),
        images,
    }
}

fn image(shown: &Shown) -> Image {
    let url = format!("data:image/svg+xml;base64,{}", STANDARD.encode(&shown.svg));
    Image { label: one_line(&shown.title), url }
}

/// Says so where a text is cut.
fn cut(text: &str, room: Room) -> String {
    match text.char_indices().nth(room.longest) {
        None => text.into(),
        Some((at, _)) => format!("{}… (shortened: your feedback page has all)", &text[..at]),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{Hints, ItemGrade};
    use super::super::examples::{SEED, broken, evidence_in, grade, hostile, item, lost, report, whole};
    use super::super::pictures::{Desk, drawn};
    use super::*;
    use serde_json::Value;
    use std::path::Path;

    const SCHEMA: &str = include_str!("../../../tests/data/grading/prairielearn.schema.json");

    fn with(grade: &Grade, drawn: &Drawn) -> Value {
        let feedback = Feedback::of(grade, "gonio grade --self rubric.toml .");
        let text = results(grade, &feedback, drawn);
        assert!(text.len() < LIMIT, "{} bytes", text.len());
        let value = serde_json::from_str(&text).unwrap();
        let schema: Value = serde_json::from_str(SCHEMA).unwrap();
        let validator = jsonschema::validator_for(&schema).unwrap();
        let errors: Vec<String> =
            validator.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{errors:?}");
        value
    }

    fn of(grade: &Grade, folder: &Path) -> Value {
        with(
            grade,
            &drawn(&mut Desk::new(folder), Some(&report(&["metal:alpha=0.1"])), &Feedback::of(grade, "")),
        )
    }

    #[test]
    fn scores_are_shares_and_pictures_are_inline() {
        let folder = tempfile::tempdir().unwrap();
        let grade = whole(&evidence_in(folder.path()));
        let value = of(&grade, folder.path());
        assert!((value["score"].as_f64().unwrap() - grade.score / 10.0).abs() < 1e-12);
        assert!(value["gradable"].as_bool().unwrap() && value["format_errors"].is_null());
        let url = value["tests"][1]["images"][0]["url"].as_str().unwrap();
        let svg = STANDARD.decode(url.strip_prefix("data:image/svg+xml;base64,").unwrap()).unwrap();
        assert!(svg.starts_with(b"<svg ") && !value["images"][0]["label"].as_str().unwrap().is_empty());
        assert_eq!(value["tests"][6]["output"], "Text of secret.");
        assert!(!value.to_string().contains(&SEED.to_string()) && !value.to_string().contains("0.7734"));
        let points: f64 =
            value["tests"].as_array().unwrap().iter().map(|t| t["points"].as_f64().unwrap()).sum();
        assert!((points - grade.score).abs() < 1e-12);
    }

    #[test]
    fn a_bonus_does_not_lead_beyond_one() {
        let all = Grade { score: 11.0, max: 10.0, ..grade() };
        assert_eq!(of(&all, Path::new("nowhere"))["score"], 1.0);
    }

    #[test]
    fn what_does_not_build_is_not_gradable() {
        let value = of(&broken(), Path::new("nowhere"));
        assert_eq!(value["gradable"], false);
        assert!(value["score"].is_null());
        assert_eq!(value["format_errors"][0], "it does not build: clang++ ended with 1");
        assert!(value["output"].as_str().unwrap().contains("unknown type name"));
        of(&hostile(""), Path::new("nowhere"));
    }

    fn many(items: usize, cases: usize, subject: &str) -> Grade {
        let made = (0..items).map(|n| ItemGrade {
            hints: Hints::Full,
            lost: (0..cases)
                .map(|k| lost(&format!("{subject}{k}"), "normalization", k as f64 / 3.0))
                .collect(),
            ..item(&format!("item-{n}"), 1.0)
        });
        Grade { items: made.collect(), ..grade() }
    }

    #[test]
    fn pictures_go_before_words_and_what_costs_least_goes_first() {
        let grade = many(4, 200, "metal:alpha=");
        let svg = "x".repeat(300_000);
        let shown = |n: usize| (format!("item-{n}"), Shown { title: "t".into(), svg: svg.clone() });
        let drawn = Drawn { items: (0..4).map(shown).collect(), ..Drawn::default() };
        let value = with(&grade, &drawn);
        let pictures: Vec<usize> =
            (0..4).map(|n| value["tests"][n]["images"].as_array().map_or(0, Vec::len)).collect();
        assert_eq!(pictures, [1, 1, 0, 0], "of equal items the first");
        assert!(value["message"].as_str().unwrap().contains("Pictures are left out here"));
        assert!(value["tests"][0]["output"].as_str().unwrap().contains("must hold"));
    }

    #[test]
    fn two_hundred_lost_cases_of_long_names_fit() {
        let value = of(&many(60, 200, &"metal-with-a-very-long-name-".repeat(300)), Path::new("nowhere"));
        let text = value["tests"][0]["output"].as_str().unwrap();
        assert!(text.contains("shortened: your feedback page has all"), "{text}");
    }
}
