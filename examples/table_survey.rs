//! What a table in WINDOW's XML gives back of each incident patch, and how far it is
//! from reciprocal, in JSON: `cargo run --example table_survey FILE`.

use gonio::measured::lbnl::{Side, Table, read};
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("the path of an XML file is needed")?;
    let table = read(&std::fs::read(&path)?)?;
    let most = |side, of: &dyn Fn(&gonio::measured::lbnl::IncidentFlux) -> f64| {
        table.incident_fluxes(side).iter().map(of).fold(0.0, f64::max)
    };
    let survey = json!({
        "name": table.name,
        "notes": table.notes,
        "most flux": {
            "front reflection": most(Side::Front, &|f| f.reflected),
            "back reflection": most(Side::Back, &|f| f.reflected),
            "front transmission": most(Side::Front, &|f| f.transmitted),
            "back transmission": most(Side::Back, &|f| f.transmitted),
        },
        "asymmetry": {
            "front reflection": asymmetry(&table, Side::Front, Side::Front),
            "back reflection": asymmetry(&table, Side::Back, Side::Back),
            "transmission": asymmetry(&table, Side::Front, Side::Back),
        },
    });
    println!("{survey:#}");
    Ok(())
}

fn asymmetry(table: &Table, from: Side, to: Side) -> Value {
    table.asymmetry(from, to).map_or(Value::Null, |a| json!([a.least, a.mean, a.most]))
}
