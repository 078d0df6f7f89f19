//! Tables for learning systems, by a mapping of columns.

use super::super::Grade;
use super::cells::csv;
use super::feedback::Feedback;
use super::gradebook::{earned, sorted};
use super::markdown::{as_cell, markdown};
use super::points::{number, percent};
use super::template::Template;
use std::path::{Component, Path};

/// What every column may have, besides `items.ID` and the named parts of submissions.
const KNOWN: [&str; 6] = ["id", "score", "max", "percent", "feedback", "cause"];

/// Before the id of an item.
const ITEM: &str = "items.";

/// A file of the rubric's `[[export]]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Export {
    file: String,
    columns: Vec<(String, Template)>,
}

/// Every place that a column may have: of a rubric with these items, whose submissions
/// are named by these parts.
pub fn placeholders<'a>(
    items: impl IntoIterator<Item = &'a str>,
    names: impl IntoIterator<Item = &'a str>,
) -> Vec<String> {
    let known = KNOWN.into_iter().map(String::from);
    let items = items.into_iter().map(|id| format!("{ITEM}{id}"));
    let names = names.into_iter().filter(|name| !KNOWN.contains(name)).map(String::from);
    known.chain(items).chain(names).collect()
}

impl Export {
    /// A file with these columns, in their order: name and template. Says what is wrong
    /// with a name or a template, with what there is.
    pub fn new<'a>(
        file: &str,
        columns: impl IntoIterator<Item = (&'a str, &'a str)>,
        known: &[String],
    ) -> Result<Self, String> {
        let mut parts = Path::new(file).components();
        let plain = matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None));
        if !plain || file.contains(['/', '\\']) {
            return Err(format!(
                "`{file}` is no name of a file in the folder of the grades: write one as moodle.csv"
            ));
        }
        let read = |(name, template): (&str, &str)| {
            let template =
                Template::parse(template, known).map_err(|why| format!("column `{name}`: {why}"))?;
            Ok((name.to_string(), template))
        };
        let columns: Vec<(String, Template)> =
            columns.into_iter().map(read).collect::<Result<_, String>>()?;
        match columns.is_empty() {
            true => Err(format!("`{file}` has no columns: write columns = {{ Grade = \"{{score}}\" }}")),
            false => Ok(Self { file: file.into(), columns }),
        }
    }

    /// The name of the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The file of a class; students may see each cell. Equal grades in any order give
    /// equal bytes.
    pub fn csv(&self, grades: &[Grade], again: &str) -> Vec<u8> {
        let header = self.columns.iter().map(|(name, _)| name.clone()).collect();
        let rows = sorted(grades).into_iter().map(|grade| {
            let feedback = Feedback::of(grade, again);
            let value = |place: &str| value(place, grade, &feedback);
            self.columns.iter().map(|(_, template)| template.fill(value)).collect()
        });
        csv(std::iter::once(header).chain(rows))
    }
}

fn value(place: &str, grade: &Grade, feedback: &Feedback) -> String {
    match place {
        "id" => grade.id.clone(),
        "score" => number(grade.score),
        "max" => number(grade.max),
        "percent" => number(percent(grade)),
        "feedback" => as_cell(&markdown(feedback)),
        // Those that a student may see.
        "cause" => feedback.causes.iter().map(|c| c.slug).collect::<Vec<_>>().join("; "),
        _ => match place.strip_prefix(ITEM) {
            Some(id) => earned(grade, id),
            None => grade.names.get(place).cloned().unwrap_or_default(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{SEED, broken, hostile, whole};
    use super::*;

    fn known() -> Vec<String> {
        placeholders(["builds", "pdf"], ["name", "number", "score"])
    }

    fn moodle() -> Export {
        let columns = [
            ("Identifier", "Participant {number}"),
            ("Full name", "{name}"),
            ("Grade", "{score}"),
            ("Maximum Grade", "{max}"),
            ("Share", "{percent}"),
            ("pdf", "{items.pdf}"),
            ("Cause", "{cause}"),
            ("Feedback comments", "{feedback}"),
        ];
        Export::new("moodle.csv", columns, &known()).unwrap()
    }

    fn rows(bytes: &[u8]) -> Vec<Vec<String>> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes);
        reader.records().map(|r| r.unwrap().iter().map(Into::into).collect()).collect()
    }

    #[test]
    fn columns_come_in_their_order_with_one_cell_each() {
        let rows = rows(&moodle().csv(&[broken(), whole("")], "gonio grade --self rubric.toml ."));
        assert_eq!(rows[0][..3], ["Identifier", "Full name", "Grade"]);
        assert_eq!(
            rows[1][..7],
            ["Participant 1042", "Ada Lovelace", "4.1667", "10", "41.6667", "0.6667", "half-vector-jacobian"]
        );
        assert!(rows[1][7].starts_with("# 4.17 of 10 points\n\nAssignment 2"), "{}", rows[1][7]);
        assert_eq!((rows.len(), rows[2][2].as_str()), (3, "0"));
    }

    #[test]
    fn students_see_nothing_of_hidden_items() {
        let text = String::from_utf8(moodle().csv(&[whole("")], "")).unwrap();
        for part in [SEED.to_string().as_str(), "0.7734", "a hidden message", "masking"] {
            assert!(!text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn hostile_cells_are_neither_formulas_nor_tags() {
        let mut grade = hostile("");
        grade.names.insert("name".into(), "=HYPERLINK(\"http://x\")".into());
        let rows = rows(&moodle().csv(&[grade], ""));
        assert_eq!(rows[1][1], "'=HYPERLINK(\"http://x\")");
        assert!(!rows[1][7].contains('<'), "{}", rows[1][7]);
    }

    #[test]
    fn mistakes_are_told_when_the_rubric_is_read() {
        let wrong = |file: &str, columns: &[(&str, &str)]| {
            Export::new(file, columns.iter().copied(), &known()).unwrap_err()
        };
        let told = wrong("m.csv", &[("Grade", "{points}")]);
        assert!(told.starts_with("column `Grade`: `{points}`: there is no {points}"), "{told}");
        assert!(told.ends_with("there are {id}, {score}, {max}, {percent}, {feedback}, {cause}, {items.builds}, {items.pdf}, {name}, {number}"), "{told}");
        assert!(wrong("m.csv", &[]).contains("has no columns"));
        for file in ["../m.csv", "/m.csv", "a/b.csv", "..", "", "a\\b"] {
            assert!(wrong(file, &[("Grade", "{score}")]).contains("is no name of a file"), "{file}");
        }
    }
}
