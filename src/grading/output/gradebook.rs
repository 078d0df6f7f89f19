//! gradebook.csv: a row for each submission, for the teacher.

use super::super::{Grade, Incident};
use super::cells::csv;
use super::points::number;
use std::collections::BTreeSet;

/// The file of the gradebook.
pub const GRADEBOOK: &str = "gradebook.csv";

/// The grades by id.
pub fn sorted(grades: &[Grade]) -> Vec<&Grade> {
    let mut sorted: Vec<&Grade> = grades.iter().collect();
    sorted.sort_by(|a, b| a.id.cmp(&b.id));
    sorted
}

/// Ids of all items, in the rubric's order.
pub fn item_ids<'a>(grades: &[&'a Grade]) -> Vec<&'a str> {
    let mut ids: Vec<&str> = Vec::new();
    for item in grades.iter().flat_map(|grade| &grade.items) {
        if !ids.contains(&item.id.as_str()) {
            ids.push(&item.id);
        }
    }
    ids
}

/// Slugs of the causes of a submission, each once, and whether one of its subjects names
/// it with confidence; those that are come first.
pub fn causes(grade: &Grade) -> Vec<(&str, bool)> {
    let mut causes: Vec<(&str, bool)> = Vec::new();
    for sure in [true, false] {
        for slug in grade.diagnoses.iter().filter(|d| d.confident == sure).filter_map(|d| d.cause.as_deref())
        {
            if !causes.iter().any(|(known, _)| *known == slug) {
                causes.push((slug, sure));
            }
        }
    }
    causes
}

/// The same in words: what is not certain has a question mark.
pub fn causes_in_words(grade: &Grade) -> Vec<String> {
    let word = |(slug, sure): (&str, bool)| format!("{slug}{}", if sure { "" } else { "?" });
    causes(grade).into_iter().map(word).collect()
}

/// Points earned of an item, if the submission has that.
pub fn earned(grade: &Grade, id: &str) -> String {
    grade.items.iter().find(|item| item.id == id).map_or(String::new(), |item| number(item.earned))
}

fn told(incident: &Incident) -> String {
    match incident.times {
        0 | 1 => incident.what.clone(),
        times => format!("{} ({times} times)", incident.what),
    }
}

/// The file. Equal grades in any order give equal bytes.
pub fn gradebook(grades: &[Grade]) -> Vec<u8> {
    let grades = sorted(grades);
    let names: BTreeSet<&str> = grades.iter().flat_map(|g| g.names.keys()).map(String::as_str).collect();
    let items = item_ids(&grades);
    let head = ["id"].into_iter().chain(names.iter().copied()).chain(["language", "score", "max"]);
    let tail = ["causes", "broken", "incidents", "review"];
    let header: Vec<String> = head.chain(items.iter().copied()).chain(tail).map(String::from).collect();
    let row = |grade: &&Grade| {
        let mut row = vec![grade.id.clone()];
        row.extend(names.iter().map(|name| grade.names.get(*name).cloned().unwrap_or_default()));
        row.extend([grade.language.clone().unwrap_or_default(), number(grade.score), number(grade.max)]);
        row.extend(items.iter().map(|id| earned(grade, id)));
        let incidents: Vec<String> = grade.incidents.iter().map(told).collect();
        row.extend([
            causes_in_words(grade).join("; "),
            grade.broken.as_ref().map(|b| b.why.clone()).unwrap_or_default(),
            incidents.join("; "),
            grade.review.join("; "),
        ]);
        row
    };
    csv(std::iter::once(header).chain(grades.iter().map(row)))
}

#[cfg(test)]
mod tests {
    use super::super::examples::{broken, grade, hostile, whole};
    use super::*;

    fn rows(bytes: &[u8]) -> Vec<Vec<String>> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes);
        reader.records().map(|r| r.unwrap().iter().map(Into::into).collect()).collect()
    }

    #[test]
    fn has_a_row_for_each_submission_by_id() {
        let bytes = gradebook(&[broken(), whole("")]);
        assert_eq!(
            String::from_utf8(bytes.clone()).unwrap(),
            "id,name,number,language,score,max,builds,pdf,values,sampling,grazing,nan,secret,causes,broken,incidents,review\n\
             1042,Ada Lovelace,1042,C++,4.1667,10,1,0.6667,3,0,0,-0.5,0,half-vector-jacobian; masking?,,opened ../rubric.toml (3 times),albedo could not decide at θo 77°\n\
             1043,Ada Lovelace,1043,C++,0,3,0,0,,,,,,,it does not build: clang++ ended with 1,,\n"
        );
        assert_eq!(gradebook(&[whole(""), broken()]), bytes, "in any order");
    }

    #[test]
    fn no_name_is_a_formula_and_no_text_breaks_a_row() {
        let rows = rows(&gradebook(&[hostile(""), Grade { id: "=1+1".into(), ..grade() }]));
        assert_eq!(rows.len(), 3);
        assert!(rows.iter().all(|row| row.len() == rows[0].len()));
        assert!(rows[1..].iter().any(|row| row[0] == "'=1+1"), "{rows:?}");
        let formula = |cell: &String| cell.starts_with(['=', '+', '@', '\t', '\r']) || cell.starts_with("-c");
        assert!(!rows.iter().flatten().any(formula));
    }
}
