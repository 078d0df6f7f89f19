//! JSON lines: the same objects as in frames, the arrays within them.

use super::reply::shown;
use super::{Reply, Request};
use crate::plugins::instance::{Call, Function};
use serde_json::{Value, json};

/// The longest line: 4096 rows of 16 channels are 2 MiB.
const LONGEST: usize = 64 << 20;

pub(super) fn ask(request: &Request) -> Vec<u8> {
    let mut object = request.object();
    if let Request::Call(call) = request {
        let (name, columns) = match call.function {
            Function::Eval | Function::Pdf => ("wi", 3),
            Function::Sample => ("u", call.input.len() / call.rows.max(1)),
        };
        let rows = |columns| call.input.chunks_exact(columns).map(|row| json!(row)).collect();
        object[name] = Value::Array(if columns == 0 { vec![json!([]); call.rows] } else { rows(columns) });
    }
    let mut line = object.to_string();
    line.push('\n');
    line.into_bytes()
}

/// The first line, if it is there.
pub(super) fn take_line(read: &mut Vec<u8>) -> Result<Option<String>, String> {
    // Blank lines say nothing.
    let blank = read.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(read.len());
    read.drain(..blank);
    let Some(end) = read.iter().position(|b| *b == b'\n') else {
        return if read.len() > LONGEST {
            Err(format!("it wrote a line of more than {LONGEST} bytes, which begins with `{}`", shown(read)))
        } else {
            Ok(None)
        };
    };
    let line = String::from_utf8_lossy(&read[..end]).into_owned();
    read.drain(..=end);
    if !line.trim_start().starts_with('{') {
        let line = shown(line.as_bytes());
        return Err(format!(
            "it wrote `{line}` to standard output, where its answers go; it should print to standard error"
        ));
    }
    Ok(Some(line))
}

pub(super) fn take(
    read: &mut Vec<u8>,
    request: &Request,
    answer: &mut [f64],
) -> Result<Option<Reply>, String> {
    let Some(line) = take_line(read)? else { return Ok(None) };
    let reply = Reply::read(&line)?;
    if let (None, Request::Call(call)) = (&reply.error, request) {
        let object: Value = serde_json::from_str(&line).map_err(|e| e.to_string())?;
        numbers(call, &object, answer)?;
    }
    Ok(Some(reply))
}

fn numbers(call: &Call, object: &Value, answer: &mut [f64]) -> Result<(), String> {
    let names: &[(&str, Option<usize>)] = match call.function {
        Function::Eval => &[("f", Some(call.channels))],
        Function::Pdf => &[("pdf", None)],
        Function::Sample => {
            &[("wi", Some(3)), ("weight", Some(call.channels)), ("pdf", None), ("flags", None)]
        }
    };
    let mut rest = answer;
    for (name, columns) in names {
        let (part, others) = rest.split_at_mut(call.rows * columns.unwrap_or(1));
        column(object, name, *columns, call.rows, part)?;
        rest = others;
    }
    Ok(())
}

/// The array `name`, of `rows` numbers, or of rows with `columns` of them.
fn column(
    object: &Value,
    name: &str,
    columns: Option<usize>,
    rows: usize,
    out: &mut [f64],
) -> Result<(), String> {
    let list = object[name].as_array().ok_or_else(|| format!("its answer has no array `{name}`"))?;
    if list.len() != rows {
        return Err(format!("it answered with {} rows of `{name}` where {rows} are due", list.len()));
    }
    let width = columns.unwrap_or(1);
    for (k, (row, out)) in list.iter().zip(out.chunks_exact_mut(width)).enumerate() {
        let values = match (row.as_array(), columns) {
            (Some(values), Some(_)) => values.as_slice(),
            // A channel alone needs no list.
            (None, None | Some(1)) => std::slice::from_ref(row),
            _ => return Err(format!("row {k} of `{name}` is {row}, not {width} numbers in a list")),
        };
        if values.len() != width {
            return Err(format!("row {k} of `{name}` has {} numbers where {width} are due", values.len()));
        }
        for (value, out) in values.iter().zip(out) {
            *out = number(value)
                .ok_or_else(|| format!("row {k} of `{name}` has {value}, which is no number"))?;
        }
    }
    Ok(())
}

/// A number, also one that JSON lacks.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(n) => n.as_f64(),
        Value::Null => Some(f64::NAN),
        Value::String(s) => match s.as_str() {
            "NaN" => Some(f64::NAN),
            "Infinity" => Some(f64::INFINITY),
            "-Infinity" => Some(f64::NEG_INFINITY),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Transport;

    fn call(function: Function, input: &[f64]) -> Call<'_> {
        let wo = [0.0, 0.0, 1.0];
        Call { function, handle: 1, transport: Transport::Radiance, wo, rows: 2, channels: 1, input }
    }

    #[test]
    fn a_call_is_a_line() {
        let line = ask(&Request::Call(&call(Function::Sample, &[0.5, 0.25, 0.75, 1.0])));
        let object: Value = serde_json::from_slice(&line).unwrap();
        assert_eq!(object["u"], json!([[0.5, 0.25], [0.75, 1.0]]));
        assert_eq!((object["call"].as_str(), object["mode"].as_str()), (Some("sample"), Some("radiance")));
        assert_eq!(line.iter().filter(|b| **b == b'\n').count(), 1);
    }

    #[test]
    fn answers_are_read_and_mistakes_told() {
        let sample = call(Function::Sample, &[0.5, 0.5]);
        let read = |line: &str| {
            let mut answer = [0.0; 12];
            let mut bytes = format!("{line}\n").into_bytes();
            take(&mut bytes, &Request::Call(&sample), &mut answer).map(|reply| (reply.is_some(), answer))
        };
        let good = r#"{"wi":[[0,0,1],[0,1,0]],"weight":[[0.5],"NaN"],"pdf":[1,null],"flags":[5,0]}"#;
        let (done, answer) = read(good).unwrap();
        assert!(done && answer[7].is_nan() && answer[9].is_nan());
        assert_eq!((answer[2], answer[6], answer[10]), (1.0, 0.5, 5.0));
        for (line, part) in [
            (r#"{"wi":[[0,0,1]],"weight":[],"pdf":[],"flags":[]}"#, "1 rows of `wi` where 2 are due"),
            (r#"{"wi":[[0,0],[0,0,1]]}"#, "row 0 of `wi` has 2 numbers where 3"),
            (r#"{"pdf":[1,2]}"#, "no array `wi`"),
            (r#"{"wi":[[0,0,"x"],[0,0,1]]}"#, "no number"),
            ("debug: 3", "standard output"),
            (r#"{"wi":NaN}"#, "wi"),
        ] {
            let error = read(line).err().unwrap_or_else(|| panic!("{line}"));
            assert!(error.contains(part), "{line}: {error}");
        }
    }
}
