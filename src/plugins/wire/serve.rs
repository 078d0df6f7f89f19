//! The other end of the wire: an instance that answers frames.

use super::frames::{LONGEST, head};
use crate::bsdf::Transport;
use crate::plugins::description;
use crate::plugins::instance::{Call, Fault, Function, Instance};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::{self, Read, Write};

#[derive(Deserialize)]
struct Asked {
    call: String,
    #[serde(default)]
    handle: u64,
    #[serde(default)]
    mode: Transport,
    #[serde(default)]
    wo: [f64; 3],
    #[serde(default)]
    rows: usize,
    #[serde(default)]
    model: String,
    #[serde(default)]
    parameters: Value,
    bytes: usize,
}

/// Answers for `instance` until `input` ends.
///
/// # Errors
/// Where the pipe is broken, or the instance has no description.
pub fn serve(instance: &mut dyn Instance, mut input: impl Read, mut output: impl Write) -> io::Result<()> {
    let text = instance.describe().map_err(|fault| io::Error::other(fault.to_string()))?;
    if text.len() > LONGEST {
        let length = text.len();
        return Err(io::Error::other(format!("its description has {length} bytes; {LONGEST} at most")));
    }
    // What is wrong with it the other end says.
    let hello = description::hello(&text).ok();
    let channels = |model: &str, own: Option<&str>| {
        let model = hello.as_ref()?.models.iter().find(|m| m.name == model)?;
        Some(model.describe(&model.name, own).ok()?.0.channels.len())
    };
    // It may be spread over lines; a frame does not mind.
    output.write_all(&head(&text))?;
    output.flush()?;
    let mut channels_of: HashMap<u64, usize> = HashMap::new();
    let mut numbers: Vec<f64> = Vec::new();
    let mut answer: Vec<f64> = Vec::new();
    let mut header = Vec::new();
    loop {
        let mut length = [0; 4];
        match input.read_exact(&mut length) {
            Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => return Ok(()),
            other => other?,
        }
        header.resize((u32::from_le_bytes(length) as usize).min(LONGEST), 0);
        input.read_exact(&mut header)?;
        let asked: Asked = serde_json::from_slice(&header)?;
        numbers.resize(asked.bytes / 8, 0.0);
        input.read_exact(bytemuck::cast_slice_mut(&mut numbers))?;
        answer.clear();
        let function =
            [Function::Eval, Function::Pdf, Function::Sample].into_iter().find(|f| f.word() == asked.call);
        let reply = match (asked.call.as_str(), function) {
            (_, Some(function)) => {
                let call = Call {
                    function,
                    handle: asked.handle,
                    transport: asked.mode,
                    wo: asked.wo,
                    rows: asked.rows,
                    channels: channels_of.get(&asked.handle).copied().unwrap_or(1),
                    input: &numbers,
                };
                // What the library leaves out is no number, as it is in process.
                answer.resize(call.answer(), f64::NAN);
                instance.call(&call, &mut answer).map(|()| json!({}))
            }
            ("create", _) => instance.create(&asked.model, &asked.parameters.to_string()).map(|created| {
                let own = created.describe.as_deref();
                channels_of.insert(created.handle, channels(&asked.model, own).unwrap_or(1));
                // What is no JSON is for the other end to complain of.
                let own = own.map(|text| serde_json::from_str(text).unwrap_or_else(|_| Value::from(text)));
                json!({"handle": created.handle, "describe": own})
            }),
            ("destroy", _) => instance.destroy(asked.handle).map(|()| json!({})),
            (other, _) => Err(Fault::Refused(format!("`{other}` is no call"))),
        };
        let mut reply = reply.unwrap_or_else(|fault| {
            answer.clear();
            json!({"error": fault.to_string()})
        });
        let payload: &[u8] = bytemuck::cast_slice(&answer);
        reply["bytes"] = payload.len().into();
        output.write_all(&head(&reply.to_string()))?;
        output.write_all(payload)?;
        output.flush()?;
    }
}
