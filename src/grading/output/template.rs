//! Text with places to fill: `Participant {number}`.

use crate::registry::nearest;

/// A text with named places. `{{` and `}}` are braces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template {
    parts: Vec<Part>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Place(String),
}

impl Template {
    /// Reads a text whose places are among `known`; says what is wrong, with the known
    /// ones.
    pub fn parse(text: &str, known: &[String]) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut plain = String::new();
        let mut rest = text;
        while let Some(at) = rest.find(['{', '}']) {
            plain.push_str(&rest[..at]);
            let brace = &rest[at..=at];
            rest = &rest[at + 1..];
            if let Some(after) = rest.strip_prefix(brace) {
                plain.push_str(brace);
                rest = after;
                continue;
            }
            let end = rest.find('}').filter(|_| brace == "{");
            let Some(end) = end else {
                return Err(format!(
                    "`{text}` has a {brace} without its partner; write {brace}{brace} for a brace"
                ));
            };
            let name = &rest[..end];
            if !known.iter().any(|k| k == name) {
                return Err(unknown(text, name, known));
            }
            parts.push(Part::Text(std::mem::take(&mut plain)));
            parts.push(Part::Place(name.into()));
            rest = &rest[end + 1..];
        }
        plain.push_str(rest);
        parts.push(Part::Text(plain));
        parts.retain(|part| *part != Part::Text(String::new()));
        Ok(Self { parts })
    }

    /// The text with each place filled.
    pub fn fill(&self, mut value: impl FnMut(&str) -> String) -> String {
        let filled = self.parts.iter().map(|part| match part {
            Part::Text(text) => text.clone(),
            Part::Place(name) => value(name),
        });
        filled.collect()
    }
}

fn unknown(text: &str, name: &str, known: &[String]) -> String {
    let meant = nearest(name, known.iter().map(String::as_str));
    let meant = meant.map_or(String::new(), |n| format!("; did you mean {{{n}}}?"));
    let all: Vec<String> = known.iter().map(|k| format!("{{{k}}}")).collect();
    let there =
        if all.is_empty() { "there are none here".into() } else { format!("there are {}", all.join(", ")) };
    format!("`{text}`: there is no {{{name}}}{meant}; {there}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known() -> Vec<String> {
        ["id", "score", "items.pdf"].map(String::from).into()
    }

    #[test]
    fn places_are_filled_and_the_rest_stays() {
        let filled = |text: &str| Template::parse(text, &known()).unwrap().fill(|name| format!("<{name}>"));
        assert_eq!(filled("Participant {id}: {items.pdf}"), "Participant <id>: <items.pdf>");
        assert_eq!(filled("{score}{score}"), "<score><score>");
        assert_eq!(filled("{{id}} and {{{id}}}"), "{id} and {<id>}");
        assert_eq!(filled(""), "");
    }

    #[test]
    fn a_value_is_not_read_again() {
        let template = Template::parse("{id}", &known()).unwrap();
        assert_eq!(template.fill(|_| "{score}".into()), "{score}");
    }

    #[test]
    fn mistakes_are_told_with_what_there_is() {
        let wrong = |text: &str| Template::parse(text, &known()).unwrap_err();
        assert_eq!(
            wrong("{scor}"),
            "`{scor}`: there is no {scor}; did you mean {score}?; there are {id}, {score}, {items.pdf}"
        );
        assert!(wrong("{}").contains("there is no {};"), "{}", wrong("{}"));
        assert!(wrong("a {id").contains("has a { without its partner"));
        assert!(wrong("a id}").contains("has a } without its partner"));
        assert!(Template::parse("{id}", &[]).unwrap_err().ends_with("there are none here"));
    }
}
