//! The JSON Schema of report.json, from its types.

use super::json::Report;

/// The schema.
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(Report).to_value()
}

/// The schema as it is committed.
pub fn schema_text() -> String {
    as_committed(&schema())
}

/// A schema indented, with a newline at its end.
pub(crate) fn as_committed(schema: &serde_json::Value) -> String {
    format!("{schema:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn describes_a_report() {
        let schema = schema();
        assert_eq!(schema["title"], "gonio report");
        assert!(schema["properties"]["results"].is_object());
        let again: serde_json::Value = serde_json::from_str(&schema_text()).unwrap();
        assert_eq!(again, schema);
        assert!(schema_text().ends_with("}\n"));
    }

    #[test]
    fn holds_a_report_and_refuses_another_thing() {
        let report = super::super::synthetic::report();
        let value = serde_json::to_value(&report).unwrap();
        let validator = jsonschema::validator_for(&schema()).unwrap();
        let errors: Vec<String> = validator.iter_errors(&value).map(|e| e.to_string()).collect();
        assert!(errors.is_empty(), "{errors:?}");
        assert!(!validator.is_valid(&serde_json::json!({ "suite": 1 })));
    }
}
